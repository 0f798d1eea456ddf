// SPDX-License-Identifier: Apache-2.0
/// A sparse general equilibrium of any size around a planted equilibrium.
#include <algorithm>
#include <memory>

#include "collection/base/build.hpp"
#include "collection/base/random.hpp"
#include "collection/scalable/generators.hpp"

namespace perp::ncp::collection {

namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

SpMat sparse(Index rows, Index cols, const Triplets& entries) {
  SpMat made(rows, cols);
  made.setFromTriplets(entries.begin(), entries.end());
  return made;
}

struct Economy {
  SpMat a;      ///< goods x sectors: outputs positive, inputs negative
  SpMat e;      ///< goods x households: endowments
  SpMat alpha;  ///< goods x households: shares of income spent; columns sum to 1
  Vec y, p, h;  ///< the planted equilibrium

  Index goods() const { return a.rows(); }
  Index sectors() const { return a.cols(); }
  Index households() const { return e.cols(); }
  Index size() const { return goods() + sectors() + households(); }
};

/// Technologies that earn nothing at prices p if active (y > 0) and lose money if not. Sector s makes one good out of
/// three others, one of them a factor, which no sector makes.
void plant_technologies(Economy& economy, Index goods, Index sectors, Random& random) {
  const Index factors = std::max<Index>(1, goods / 4), products = goods - factors;
  Triplets entries;
  economy.y.resize(sectors);
  for (Index s = 0; s < sectors; ++s) {
    const bool active = random.uniform(0, 1) < 0.8;
    economy.y[s] = active ? random.uniform(0.5, 1.5) : 0;
    const Index output = s % products;
    entries.emplace_back(output, s, 1.0);
    const double cost = economy.p[output] * (active ? 1 : random.uniform(1.05, 1.3));
    const double first = random.uniform(0.1, 0.3), second = random.uniform(0.1, 0.3);
    const double parts[3] = {first, second, 1 - first - second};  // of the cost
    const Index inputs[3] = {(output + 1 + random.below(goods - 1)) % goods,
                             (output + 1 + random.below(goods - 1)) % goods, products + random.below(factors)};
    for (int k = 0; k < 3; ++k) entries.emplace_back(inputs[k], s, -parts[k] * cost / economy.p[inputs[k]]);
  }
  economy.a = sparse(goods, sectors, entries);  // adds up inputs of one good
}

/// Endowments of what production does not leave for consumption, of each good to about three households, and something
/// to every household. Returns the supplies e 1 + a y, all positive.
Vec plant_endowments(Economy& economy, Index households, Random& random) {
  const Index goods = economy.goods();
  const double need = static_cast<double>(households) / static_cast<double>(goods);
  const Vec net = economy.a * economy.y;
  Vec supply = net;
  std::vector<Index> owned;
  for (Index g = 0; g < goods; ++g) {
    const double consumed = random.uniform(0.5, 1.5) * need;
    if (net[g] > 0.1 * consumed) continue;
    supply[g] = consumed;
    owned.push_back(g);
  }
  std::vector<std::vector<Index>> owners(static_cast<std::size_t>(goods));
  const auto count = static_cast<Index>(owned.size());
  for (Index c = 0; c < households; ++c)
    owners[static_cast<std::size_t>(owned[static_cast<std::size_t>(c % count)])].push_back(c);
  Triplets entries;
  for (const Index g : owned) {
    auto& list = owners[static_cast<std::size_t>(g)];
    while (list.size() < 3) list.push_back(random.below(households));
    Vec weights(static_cast<Index>(list.size()));
    for (double& weight : weights) weight = random.uniform(0.5, 1.5);
    weights *= (supply[g] - net[g]) / weights.sum();
    for (std::size_t k = 0; k < list.size(); ++k) entries.emplace_back(g, list[k], weights[static_cast<Index>(k)]);
  }
  economy.e = sparse(goods, households, entries);
  economy.h = economy.e.transpose() * economy.p;
  return supply;
}

/// Shares under which the households, with incomes h, buy exactly the supplies at prices p: a transport of the incomes
/// to the values of the goods, the mean of three north-west corner solutions in random orders, hence with at most 3
/// (goods + households) entries.
void plant_demand(Economy& economy, const Vec& supply, Random& random) {
  constexpr int mixtures = 3;
  Triplets entries;
  for (int k = 0; k < mixtures; ++k) {
    const std::vector<Index> by_good = random.order(economy.goods()), by_household = random.order(economy.households());
    Vec value = supply.cwiseProduct(economy.p) / mixtures, income = economy.h / mixtures;
    std::size_t i = 0, j = 0;
    while (i < by_good.size() && j < by_household.size()) {
      const Index g = by_good[i], c = by_household[j];
      const double spent = std::min(value[g], income[c]);
      entries.emplace_back(g, c, spent / economy.h[c]);
      value[g] -= spent;
      income[c] -= spent;
      value[g] <= income[c] ? ++i : ++j;
    }
  }
  economy.alpha = sparse(economy.goods(), economy.households(), entries);
}

Economy plant(Index goods, Index sectors, Index households, unsigned seed) {
  Random random(seed);
  Economy economy;
  economy.p.resize(goods);
  for (double& price : economy.p) price = random.uniform(0.5, 2);
  economy.p[0] = 1;
  plant_technologies(economy, goods, sectors, random);
  const Vec supply = plant_endowments(economy, households, random);
  plant_demand(economy, supply, random);
  return economy;
}

/// F' with what depends on z left undone: -alpha for -diag(p)^-1 alpha, 1 for the diagonal of the markets.
SpMat jacobian_frame(const Economy& economy) {
  const Index first_p = economy.sectors(), first_h = first_p + economy.goods();
  Triplets entries;
  const auto add = [&](const SpMat& block, Index row, Index col, double sign, bool transposed) {
    for (Index j = 0; j < block.outerSize(); ++j)
      for (SpMat::InnerIterator entry(block, j); entry; ++entry) {
        const Index r = transposed ? entry.col() : entry.row(), c = transposed ? entry.row() : entry.col();
        entries.emplace_back(row + r, col + c, sign * entry.value());
      }
  };
  add(economy.a, 0, first_p, -1, true);
  add(economy.a, first_p, 0, 1, false);
  add(economy.alpha, first_p, first_h, -1, false);
  add(economy.e, first_h, first_p, -1, true);
  for (Index i = first_p; i < economy.size(); ++i) entries.emplace_back(i, i, 1.0);
  return sparse(economy.size(), economy.size(), entries);
}

template <class Z, class Y>
void excess(const Economy& economy, const Z& z, Y& F) {
  const auto y = z.head(economy.sectors()), p = z.segment(economy.sectors(), economy.goods());
  const auto h = z.tail(economy.households());
  const Vec supply = economy.e * Vec::Ones(economy.households());
  const auto made = product(economy.a, y), spent = product(economy.alpha, h);
  const auto revenue = product(economy.a.transpose(), p), earned = product(economy.e.transpose(), p);
  for (Index s = 0; s < economy.sectors(); ++s) F[s] = -revenue[s];
  for (Index g = 0; g < economy.goods(); ++g) F[economy.sectors() + g] = supply[g] + made[g] - spent[g] / p[g];
  for (Index c = 0; c < economy.households(); ++c) F[economy.sectors() + economy.goods() + c] = h[c] - earned[c];
}

bool slopes(const Economy& economy, const SpMat& frame, In z, SpMat& J) {
  const Index first_p = economy.sectors(), first_h = first_p + economy.goods();
  const auto p = z.segment(first_p, economy.goods());
  if (!(p.minCoeff() > 0)) return false;
  const Vec spent = economy.alpha * z.tail(economy.households());
  std::copy_n(frame.valuePtr(), frame.nonZeros(), J.valuePtr());
  for (Index j = first_p; j < J.outerSize(); ++j)
    for (SpMat::InnerIterator entry(J, j); entry; ++entry) {
      const Index good = entry.row() - first_p;
      if (good < 0 || entry.row() >= first_h) continue;
      if (j < first_h)
        entry.valueRef() = spent[good] / (p[good] * p[good]);
      else
        entry.valueRef() /= p[good];
    }
  return all_finite(Eigen::Map<const Vec>(J.valuePtr(), J.nonZeros()));
}

}  // namespace

Problem walras_own(Index goods, Index sectors, Index households, unsigned seed) {
  require_at_least("walras-own", "goods", goods, 4);
  require_at_least("walras-own", "sectors", sectors, 1);
  require_at_least("walras-own", "goods - sectors", goods - sectors, 1);
  require_at_least("walras-own", "households", households, 1);
  const auto shared = std::make_shared<const Economy>(plant(goods, sectors, households, seed));
  const Economy& economy = *shared;
  const auto frame = std::make_shared<const SpMat>(jacobian_frame(economy));

  Box box{Vec::Zero(economy.size()), Vec::Constant(economy.size(), infinity)};
  box.lower.segment(sectors, goods).setConstant(1e-4);
  box.lower[sectors] = box.upper[sectors] = 1;
  box.lower.tail(households).setConstant(-infinity);
  const auto names = [&](const char* y, const char* p, const char* h) {
    return joined({indexed(y, sectors), indexed(p, goods), indexed(h, households)});
  };
  Functions made = functions_of({"walras-own", box, names("y", "p", "h"), names("loss", "market", "income"), *frame});
  made.F = [shared](In z, Out F) {
    if (!(z.segment(shared->sectors(), shared->goods()).minCoeff() > 0)) return false;
    excess(*shared, z, F);
    return all_finite(F);
  };
  made.expression = on_vectors(economy.size(), [shared](const auto& z, auto& F) { excess(*shared, z, F); });
  made.J = [shared, frame](In z, SpMat& J) { return slopes(*shared, *frame, z, J); };

  Problem p;
  p.mcp = make_mcp(std::move(made));
  const Vec incomes = economy.e.transpose() * Vec::Ones(goods);
  p.starts = {joined({Vec::Zero(sectors), Vec::Ones(goods), incomes}), Vec::Ones(economy.size()),
              Vec::Constant(economy.size(), 10)};
  p.solutions = {{"planted", joined({economy.y, economy.p, economy.h}), 1e-12}};
  return p;
}

}  // namespace perp::ncp::collection
