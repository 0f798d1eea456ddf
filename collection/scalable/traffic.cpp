// SPDX-License-Identifier: Apache-2.0
/// Wardrop's user equilibrium of traffic on a grid of streets, by destinations.
#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

#include "collection/base/model_mcp.hpp"
#include "collection/base/random.hpp"
#include "collection/scalable/generators.hpp"

namespace perp::ncp::collection {

namespace {

constexpr Index K = 4;  // destinations

/// z = (v, pi): v_ak the flow on arc a to destination k, by arcs; pi_ik the time from node i to it, by destinations.
struct Traffic {
  static constexpr bool affine = false;

  struct Arc {
    Index from, to;
    double t = 0, capacity = 1;  ///< takes t (1 + 0.15 (v / capacity)^4) at the total flow v
  };
  Index rows, columns;                      ///< of nodes
  std::vector<Arc> arcs;                    ///< sorted by `from`
  std::vector<std::vector<Index>> touches;  ///< of each node: the arcs that begin or end there, ascending
  std::vector<Index> destinations;          ///< K nodes
  std::vector<double> demand;               ///< from node i to destination k: demand[i K + k]

  Index nodes() const { return rows * columns; }
  Index count() const { return static_cast<Index>(arcs.size()); }
  Index size() const { return K * (count() + nodes() - 1); }
  const Arc& arc(Index a) const { return arcs[static_cast<std::size_t>(a)]; }
  const std::vector<Index>& at(Index node) const { return touches[static_cast<std::size_t>(node)]; }
  Index destination(Index k) const { return destinations[static_cast<std::size_t>(k)]; }
  /// Where pi_ik is among the unknowns; -1 at the destination, where it is 0.
  Index potential(Index node, Index k) const {
    if (node == destination(k)) return -1;
    return K * count() + k * (nodes() - 1) + node - (node > destination(k) ? 1 : 0);
  }

  template <class T>
  T time(Index a, const T& v) const {
    using std::pow;
    return arc(a).t * (1 + 0.15 * pow(v / arc(a).capacity, 4));
  }
  double slope(Index a, double v) const { return arc(a).t * 0.6 * std::pow(v / arc(a).capacity, 3) / arc(a).capacity; }

  template <class Z, class Y>
  void excess(const Z& z, Y&& F) const {
    using T = typename Z::Scalar;
    const auto pi = [&](Index node, Index k) {
      const Index at = potential(node, k);
      return at < 0 ? T(0) : T(z[at]);
    };
    for (Index i = 0; i < nodes(); ++i)
      for (Index k = 0; k < K; ++k)
        if (const Index row = potential(i, k); row >= 0) F[row] = -demand[static_cast<std::size_t>(i * K + k)];
    for (Index a = 0; a < count(); ++a) {
      const auto flows = z.segment(K * a, K);
      const T now = time(a, T(flows.sum()));
      for (Index k = 0; k < K; ++k) {
        F[K * a + k] = now + pi(arc(a).to, k) - pi(arc(a).from, k);
        if (const Index row = potential(arc(a).from, k); row >= 0) F[row] += flows[k];
        if (const Index row = potential(arc(a).to, k); row >= 0) F[row] -= flows[k];
      }
    }
  }

  template <class Visit>
  void slopes(In z, Visit visit) const {
    for (Index a = 0; a < count(); ++a) {
      const double rate = slope(a, z.segment(K * a, K).sum());
      const auto [low, high] = std::minmax(arc(a).from, arc(a).to);
      for (Index k = 0; k < K; ++k) {
        for (Index other = 0; other < K; ++other) visit(K * a + other, K * a + k, rate, false);
        for (const Index node : {low, high})
          if (const Index row = potential(node, k); row >= 0) visit(row, K * a + k, node == arc(a).from ? 1 : -1, true);
      }
    }
    for (Index k = 0; k < K; ++k)
      for (Index i = 0; i < nodes(); ++i)
        if (const Index column = potential(i, k); column >= 0)
          for (const Index a : at(i)) visit(K * a + k, column, i == arc(a).to ? 1 : -1, true);
  }

  std::string place(Index node) const {
    return std::to_string(node / columns + 1).append(",").append(std::to_string(node % columns + 1));
  }
  std::string named(Index i, const char* flows, const char* potentials) const {
    if (i < K * count()) {
      const Arc& on = arc(i / K);
      return element(flows, place(on.from) + "-" + place(on.to) + ";" + std::to_string(i % K + 1));
    }
    const Index k = (i - K * count()) / (nodes() - 1), left = (i - K * count()) % (nodes() - 1);
    return element(potentials, place(left + (left >= destination(k) ? 1 : 0)) + ";" + std::to_string(k + 1));
  }
  std::string variable(Index i) const { return named(i, "v", "pi"); }
  std::string equation(Index i) const { return named(i, "detour", "balance"); }
};

Traffic streets(Index rows, Index columns) {
  Traffic made{.rows = rows, .columns = columns, .arcs = {}, .touches = {}, .destinations = {}, .demand = {}};
  made.touches.resize(static_cast<std::size_t>(made.nodes()));
  for (Index i = 0; i < made.nodes(); ++i) {
    const auto link = [&](Index to, bool exists) {
      if (!exists) return;
      for (const Index end : {i, to}) made.touches[static_cast<std::size_t>(end)].push_back(made.count());
      made.arcs.push_back({i, to});
    };
    link(i - columns, i >= columns);
    link(i - 1, i % columns > 0);
    link(i + 1, (i + 1) % columns > 0);
    link(i + columns, i + columns < made.nodes());
  }
  return made;
}

/// The least time from every node to destination k if arc a takes times[a] (Dijkstra), and the nodes by it, nearest
/// first.
std::pair<Vec, std::vector<Index>> distances(const Traffic& net, const Vec& times, Index k) {
  Vec least = Vec::Constant(net.nodes(), std::numeric_limits<double>::infinity());
  std::vector<bool> done(static_cast<std::size_t>(net.nodes()), false);
  std::vector<Index> order;
  using Found = std::pair<double, Index>;
  std::priority_queue<Found, std::vector<Found>, std::greater<>> open;
  open.emplace(0, net.destination(k));
  least[net.destination(k)] = 0;
  while (!open.empty()) {
    const Index node = open.top().second;
    open.pop();
    if (done[static_cast<std::size_t>(node)]) continue;
    done[static_cast<std::size_t>(node)] = true;
    order.push_back(node);
    for (const Index a : net.at(node)) {
      const Index from = net.arc(a).from;
      if (from == node || !(least[node] + times[a] < least[from])) continue;
      least[from] = least[node] + times[a];
      open.emplace(least[from], from);
    }
  }
  return {std::move(least), std::move(order)};
}

/// Everybody on shortest ways at those times: flows and potentials. From each node the traffic goes along its tight
/// arcs by weight(): equal weights share it.
template <class Weight>
Vec assign(const Traffic& net, const Vec& times, Weight weight) {
  Vec z = Vec::Zero(net.size());
  std::vector<std::pair<Index, double>> shares;
  for (Index k = 0; k < K; ++k) {
    const auto [least, order] = distances(net, times, k);
    Vec through(net.nodes());
    for (Index i = 0; i < net.nodes(); ++i) {
      through[i] = net.demand[static_cast<std::size_t>(i * K + k)];
      if (const Index at = net.potential(i, k); at >= 0) z[at] = least[i];
    }
    for (std::size_t next = order.size(); next-- > 1;) {  // farthest first; order[0] is the destination
      const Index node = order[next];
      shares.clear();
      double sum = 0;
      for (const Index a : net.at(node)) {
        if (net.arc(a).from != node || least[net.arc(a).to] + times[a] != least[node]) continue;
        shares.emplace_back(a, weight());
        sum += shares.back().second;
      }
      if (!(sum > 0)) sum = shares.front().second = 1;
      for (const auto& [a, share] : shares) {
        z[K * a + k] = through[node] * share / sum;
        through[net.arc(a).to] += z[K * a + k];
      }
    }
  }
  return z;
}

}  // namespace

/// Planted: times of 2, 3 or 4 units at equilibrium, so that there are many shortest ways of one length; the traffic
/// shares them at random and leaves some unused; capacities at which the flow is 50 to 150 % of them; free-flow times
/// that give the times.
Problem traffic_own(Index M, Index N, unsigned seed) {
  require_between("traffic-own", "M", M, 2, 4'000);
  require_between("traffic-own", "N", N, 2, 4'000);
  Random random(seed);
  Traffic net = streets(M, N);
  while (static_cast<Index>(net.destinations.size()) < K) {
    const Index node = random.below(net.nodes());
    if (std::ranges::find(net.destinations, node) == net.destinations.end()) net.destinations.push_back(node);
  }
  for (Index i = 0; i < net.nodes(); ++i)
    for (Index k = 0; k < K; ++k) {
      const double trips = random.uniform(0.5, 1.5) / static_cast<double>(std::max(M, N));
      net.demand.push_back(i == net.destination(k) ? 0 : trips);
    }
  Vec times(net.count());
  for (double& taken : times) taken = static_cast<double>(2 + random.below(3));
  Vec planted = assign(net, times, [&] { return random.uniform(0, 1) < 0.2 ? 0 : random.uniform(0.5, 1.5); });
  for (Index a = 0; a < net.count(); ++a) {
    Traffic::Arc& arc = net.arcs[static_cast<std::size_t>(a)];
    const double v = planted.segment(K * a, K).sum();
    const double load = random.uniform(0.5, 1.5);
    arc.capacity = v > 0 ? v / load : load;
    arc.t = v > 0 ? times[a] / (1 + 0.15 * std::pow(v / arc.capacity, 4)) : times[a];
  }
  Vec free_flow(net.count());
  for (Index a = 0; a < net.count(); ++a) free_flow[a] = net.arc(a).t;
  Vec all_or_nothing = assign(net, free_flow, [] { return 1; });

  Problem p;
  const Index n = net.size();
  p.starts = {std::move(all_or_nothing), Vec::Zero(n), Vec::Ones(n)};
  p.solutions = {{"planted", std::move(planted), 1e-12}};
  p.mcp = make_model("traffic-own", Box::nonnegative(n), std::move(net));
  return p;
}

}  // namespace perp::ncp::collection
