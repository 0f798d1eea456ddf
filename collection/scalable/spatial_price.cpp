// SPDX-License-Identifier: Apache-2.0
/// Spatial price equilibrium: one good, regions on a grid, trade with the neighbours.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "collection/base/model_mcp.hpp"
#include "collection/base/random.hpp"
#include "collection/scalable/generators.hpp"

namespace perp::ncp::collection {

namespace {

constexpr double fade = 10;  // the price at which demand has fallen by e

/// z = (x, p): shipments on the arcs, prices in the regions.
struct Trade {
  static constexpr bool affine = false;

  struct Arc {
    Index from, to;
    double t, k;  ///< a unit costs t + k x^2
  };
  std::vector<Arc> arcs;                   ///< sorted by `from`
  std::vector<Index> first;                ///< of each region: where its arcs begin
  std::vector<std::vector<Index>> inward;  ///< of each region: arcs that end there, ascending
  Vec s, d;                                ///< a region supplies s p and demands d exp(-p / fade)

  Index regions() const { return s.size(); }
  Index count() const { return static_cast<Index>(arcs.size()); }
  const Arc& arc(Index a) const { return arcs[static_cast<std::size_t>(a)]; }
  template <class T>
  T demand(Index i, const T& p) const {
    using std::exp;
    return d[i] * exp(-p / fade);
  }

  template <class Z, class Y>
  void excess(const Z& z, Y&& F) const {
    const auto p = z.tail(regions());
    auto market = F.tail(regions());
    for (Index i = 0; i < regions(); ++i) market[i] = s[i] * p[i] - demand(i, p[i]);
    for (Index a = 0; a < count(); ++a) {
      F[a] = p[arc(a).from] + arc(a).t + arc(a).k * z[a] * z[a] - p[arc(a).to];
      market[arc(a).from] -= z[a];
      market[arc(a).to] += z[a];
    }
  }

  template <class Visit>
  void slopes(In z, Visit visit) const {
    for (Index a = 0; a < count(); ++a) {
      const auto [low, high] = std::minmax(arc(a).from, arc(a).to);
      visit(a, a, 2 * arc(a).k * z[a], false);
      visit(count() + low, a, low == arc(a).to ? 1 : -1, true);
      visit(count() + high, a, high == arc(a).to ? 1 : -1, true);
    }
    for (Index i = 0; i < regions(); ++i) {
      const Index column = count() + i;
      Index out = first[static_cast<std::size_t>(i)];
      const Index end = first[static_cast<std::size_t>(i) + 1];
      for (const Index in : inward[static_cast<std::size_t>(i)]) {
        for (; out < end && out < in; ++out) visit(out, column, 1, true);
        visit(in, column, -1, true);
      }
      for (; out < end; ++out) visit(out, column, 1, true);
      visit(column, column, s[i] + demand(i, z[column]) / fade, false);
    }
  }

  std::string named(Index i, const char* arcs_name, const char* regions_name) const {
    if (i >= count()) return element(regions_name, std::to_string(i - count() + 1));
    return element(arcs_name, std::to_string(arc(i).from + 1).append(",").append(std::to_string(arc(i).to + 1)));
  }
  std::string variable(Index i) const { return named(i, "x", "p"); }
  std::string equation(Index i) const { return named(i, "loss", "market"); }
};

/// Both directions between neighbours on a grid with ceil(sqrt(regions)) columns, the last row left incomplete.
void lay_arcs(Trade& trade, Index regions) {
  const auto columns = static_cast<Index>(std::ceil(std::sqrt(static_cast<double>(regions))));
  trade.inward.resize(static_cast<std::size_t>(regions));
  for (Index i = 0; i < regions; ++i) {
    trade.first.push_back(trade.count());
    const auto link = [&](Index to, bool exists) {
      if (!exists || to < 0 || to >= regions) return;
      trade.inward[static_cast<std::size_t>(to)].push_back(trade.count());
      trade.arcs.push_back({i, to, 0, 0});
    };
    link(i - columns, true);
    link(i - 1, i % columns > 0);
    link(i + 1, (i + 1) % columns > 0);
    link(i + columns, true);
  }
  trade.first.push_back(trade.count());
}

/// Costs under which the shipments are right at the prices p: an arc upwards in price is used with probability 0.7, and
/// just not worth it with probability 0.1; congestion is 10 to 50 % of the cost of a used one.
Vec plant_shipments(Trade& trade, const Vec& p, Random& random) {
  Vec x = Vec::Zero(trade.count());
  for (Index a = 0; a < trade.count(); ++a) {
    Trade::Arc& arc = trade.arcs[static_cast<std::size_t>(a)];
    const double gain = p[arc.to] - p[arc.from];
    const double chance = random.uniform(0, 1), part = random.uniform(0.1, 0.5);
    const double load = random.uniform(1, 5), margin = random.uniform(0.5, 2);
    arc.t = std::max(gain, 0.0) + margin;
    arc.k = part / (load * load);
    if (gain < 0.2 || chance > 0.8) continue;
    x[a] = chance < 0.7 ? load : 0;
    arc.t = chance < 0.7 ? (1 - part) * gain : gain;
    arc.k *= gain;
  }
  return x;
}

}  // namespace

Problem spatial_price_own(Index regions, unsigned seed) {
  require_between("spatial-price-own", "regions", regions, 2, 10'000'000);
  Random random(seed);
  Trade trade{.arcs = {}, .first = {}, .inward = {}, .s = Vec(regions), .d = Vec(regions)};
  lay_arcs(trade, regions);
  Vec p(regions);
  for (double& price : p) price = random.uniform(5, 15);
  const Vec x = plant_shipments(trade, p, random);
  Vec net = Vec::Zero(regions);  // exports less imports
  for (Index a = 0; a < trade.count(); ++a) {
    net[trade.arc(a).from] += x[a];
    net[trade.arc(a).to] -= x[a];
  }
  for (Index i = 0; i < regions; ++i) {
    const double consumed = std::max(0.0, -net[i]) + random.uniform(5, 15);
    trade.d[i] = consumed * std::exp(p[i] / fade);
    trade.s[i] = (consumed + net[i]) / p[i];
  }

  Problem made;
  const Index n = trade.count() + regions;
  Vec autarky = Vec::Zero(n);
  autarky.tail(regions).setConstant(fade);
  made.starts = {std::move(autarky), Vec::Zero(n), Vec::Ones(n)};
  made.solutions = {{"planted", joined({x, p}), 1e-12}};
  made.solutions_complete = true;
  made.mcp = make_model("spatial-price-own", Box::nonnegative(n), std::move(trade));
  return made;
}

}  // namespace perp::ncp::collection
