// SPDX-License-Identifier: Apache-2.0
/// Traffic on a ring of five nodes, Bertsekas & Gafni's example, in three forms.
#include <algorithm>
#include <array>

#include "collection/base/build.hpp"
#include "collection/models/problems.hpp"

namespace perp::ncp::collection {

namespace {

constexpr int ring_nodes = 5;
constexpr double coupling = 0.5;                                   // gamma: what the delay of a merging stream adds
constexpr std::array ring_demand{0.1, 0.2, 0.3, 0.4, 0.5};         // from node i to the third node after it
constexpr std::array recorded_loads{0.0, 0.5, 100.0, 0.0, 0.0};    // of x and z at the recorded starts
constexpr std::array recorded_times{0.0, 0.5, 100.0, 100.0, 1.0};  // of y

template <class T>
using Streams = std::array<T, ring_nodes>;

/// Of a link, by its flow.
template <class T>
T delay(const T& flow) {
  return 1 + flow + flow * flow;
}

/// The delays of the ways that go `links` links of the highway forwards (turn = 1) or backwards (turn = -1): on a ramp
/// to it, past the ramps of the nodes between by a bypass, off at the end.
template <class T>
Streams<T> delays(const Streams<T>& flow, int turn, int links) {
  const auto from = [&](int node) -> const T& {
    return flow[static_cast<std::size_t>((node + 2 * ring_nodes) % ring_nodes)];
  };
  // The ways that come through a node, with those that begin there where first = 0.
  const auto through = [&](int node, int first) {
    T sum = 0;
    for (int k = first; k < links; ++k) sum += from(node - turn * k);
    return sum;
  };
  Streams<T> found{};
  for (int i = 0; i < ring_nodes; ++i) {
    T& sum = found[static_cast<std::size_t>(i)];
    sum = delay(from(i)) + coupling * delay(through(i, 1)) + delay(from(i));
    for (int k = 0; k < links; ++k) {
      const int node = i + turn * k;
      if (k > 0) sum += delay(through(node, 1));
      sum += 10 * delay(through(node, 0)) + 2 * coupling * delay(from(node + turn * (1 - links)));
    }
  }
  return found;
}

template <class T>
Streams<T> outside(const Streams<T>& flow) {
  return delays(flow, 1, 3);
}
template <class T>
Streams<T> inside(const Streams<T>& flow) {
  return delays(flow, -1, 2);
}

/// Flows meet flows on the same loop, and rows and columns of y are those of the demands.
SpMat pattern_with_times() {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < ring_nodes; ++i)
    for (const int first : {0, ring_nodes}) {
      for (int j = 0; j < ring_nodes; ++j) entries.emplace_back(first + i, first + j, 1);
      entries.emplace_back(first + i, 2 * ring_nodes + i, 1);
      entries.emplace_back(2 * ring_nodes + i, first + i, 1);
    }
  SpMat pattern(3 * ring_nodes, 3 * ring_nodes);
  pattern.setFromTriplets(entries.begin(), entries.end());
  return pattern;
}

/// Recomputed to all digits; no source prints any.
Vec equilibrium() { return vec({0, 0, 0.014118309789567797, 0.14418479145297025, 0.10365731855340576}); }

/// Both flows and the times y as unknowns.
Problem with_times(std::string name, double least_time) {
  Box box = Box::nonnegative(3 * ring_nodes);
  box.lower.tail(ring_nodes).setConstant(least_time);
  Problem p;
  p.mcp = make_problem(
      {std::move(name), box, joined({indexed("x", ring_nodes), indexed("z", ring_nodes), indexed("y", ring_nodes)}),
       joined({indexed("outside", ring_nodes), indexed("inside", ring_nodes), indexed("demand", ring_nodes)}),
       pattern_with_times()},
      [](const auto& all, const auto& F) {
        using T = Number<decltype(F)>;
        Streams<T> x{};
        Streams<T> z{};
        std::copy_n(all.begin(), ring_nodes, x.begin());
        std::copy_n(all.begin() + ring_nodes, ring_nodes, z.begin());
        const Streams<T> out = outside(x);
        const Streams<T> in = inside(z);
        for (int i = 0; i < ring_nodes; ++i) {
          const auto k = static_cast<std::size_t>(i);
          F[i] = out[k] - all[2 * ring_nodes + i];
          F[ring_nodes + i] = in[k] - all[2 * ring_nodes + i];
          F[2 * ring_nodes + i] = x[k] + z[k] - ring_demand[k];
        }
      });
  for (std::size_t k = 0; k < recorded_loads.size(); ++k)
    p.starts.push_back(
        joined({Vec::Constant(2 * ring_nodes, recorded_loads[k]), Vec::Constant(ring_nodes, recorded_times[k])}));
  const Vec total = Eigen::Map<const Vec>(ring_demand.data(), ring_nodes);
  const Vec times =
      vec({37.62698738872189, 38.13104211743379, 43.023276427969435, 46.741174145313, 46.080386233798976});
  p.solutions = {{"equilibrium", joined({equilibrium(), total - equilibrium(), times}), 1e-14}};
  p.solutions_complete = true;
  return p;
}

}  // namespace

/// 0 <= x_i _|_ (delay outside)_i - y_i,   0 <= z_i _|_ (delay inside)_i - y_i,   0 <= y_i _|_ x_i + z_i - demand_i.
Problem bertsekas() { return with_times("bertsekas", 0); }

/// The same with y free: all of the demand is met, and nothing more.
Problem freebert() { return with_times("freebert", -infinity); }

/// The same without y and z = demand - x: 0 <= x_i <= demand_i _|_ (delay outside - delay inside)_i.
/// J is affine and positive definite at the corners of the box, hence in all of it: there is one solution, and with it
/// one of the forms above, where every y_i is the shorter delay, as every demand is positive.
Problem gafni() {
  Box box{Vec::Zero(ring_nodes), Eigen::Map<const Vec>(ring_demand.data(), ring_nodes)};
  Problem p;
  p.starts = {box.lower, box.upper / 2, box.upper};
  p.mcp = make_problem({"gafni", box, indexed("x", ring_nodes)}, [](const auto& all, const auto& F) {
    using T = Number<decltype(F)>;
    Streams<T> x{};
    Streams<T> z{};
    for (int i = 0; i < ring_nodes; ++i) {
      x[static_cast<std::size_t>(i)] = all[i];
      z[static_cast<std::size_t>(i)] = ring_demand[static_cast<std::size_t>(i)] - all[i];
    }
    const Streams<T> out = outside(x);
    const Streams<T> in = inside(z);
    for (int i = 0; i < ring_nodes; ++i) F[i] = out[static_cast<std::size_t>(i)] - in[static_cast<std::size_t>(i)];
  });
  p.solutions = {{"equilibrium", equilibrium(), 1e-15}};
  p.solutions_complete = true;
  return p;
}

}  // namespace perp::ncp::collection
