// SPDX-License-Identifier: Apache-2.0
#include "contact/model/scaling.hpp"

#include <algorithm>
#include <cmath>

#include "contact/model/natural_map.hpp"
#include "contact/model/units.hpp"

namespace perp::contact {
namespace {

/// What W~ is made with: where a row of W is in W~ (or -1), the diagonal of M, s.
struct Coordinates {
  std::vector<Scaled::Block> blocks;
  std::vector<Index> rows;
  std::vector<int> place;
  std::vector<double> weight;
  double s = 1;
};

/// W~ with whole blocks: where a column has an entry in the rows of a contact it has all of them, and its own
/// contact's.
SpMat fill(const SpMat& W, const Coordinates& to) {
  const auto& [blocks, rows, place, weight, s] = to;
  std::vector<int> owner;
  for (std::size_t a = 0; a < blocks.size(); ++a) owner.insert(owner.end(), at(blocks[a].size), static_cast<int>(a));
  const auto size = static_cast<Index>(rows.size());
  SpMat out(size, size);
  out.reserve(W.nonZeros() + 9 * size);
  std::vector<double> column(rows.size(), 0.0);
  std::vector<char> touched(blocks.size(), 0);
  std::vector<int> contacts;
  for (Index j = 0; j < size; ++j) {
    contacts.assign(1, owner[at(j)]);
    touched[at(owner[at(j)])] = 1;
    for (SpMat::InnerIterator it(W, rows[at(j)]); it; ++it) {
      const int row = place[at(it.row())];
      if (row < 0) continue;
      const int a = owner[at(row)];
      if (touched[at(a)] == 0) contacts.push_back(a);
      touched[at(a)] = 1;
      column[at(row)] += weight[at(row)] * weight[at(j)] * it.value() / s;
    }
    std::sort(contacts.begin(), contacts.end());
    out.startVec(j);
    for (const int a : contacts) {
      touched[at(a)] = 0;
      const Scaled::Block& block = blocks[at(a)];
      for (Index i = block.first; i < block.first + block.size; ++i) {
        out.insertBack(i, j) = column[at(i)];
        column[at(i)] = 0;
      }
    }
  }
  out.finalize();
  return out;
}

/// W~ = (H diag(weight))' (s M)^-1 H diag(weight), in these columns of H; null where M has no factors.
std::shared_ptr<const DelassusParts> parts_of(const Global& global, const Coordinates& to) {
  auto inertia = Inertia::of(global.M);
  if (!inertia) return nullptr;
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(at(global.H.nonZeros()));
  for (std::size_t k = 0; k < to.rows.size(); ++k)
    for (SpMat::InnerIterator it(global.H, to.rows[k]); it; ++it)
      entries.emplace_back(static_cast<int>(it.row()), static_cast<int>(k), to.weight[k] * it.value());
  SpMat H(global.H.rows(), static_cast<Index>(to.rows.size()));
  H.setFromTriplets(entries.begin(), entries.end());
  return std::make_shared<const DelassusParts>(std::move(inertia), to.s, std::move(H));
}

SpMat with_whole_blocks(const SpMat& W, const std::vector<Scaled::Block>& blocks) {
  Coordinates same{.blocks = blocks, .rows = {}, .place = {}, .weight = {}};
  for (Index i = 0; i < W.rows(); ++i) {
    same.rows.push_back(i);
    same.place.push_back(static_cast<int>(i));
    same.weight.push_back(1);
  }
  return fill(W, same);
}

/// Whether W is what these parts make, by its product with one vector: who changes W may leave the parts as they were.
bool made_of(const SpMat& W, const DelassusParts& parts, const Coordinates& to) {
  constexpr double same = 1e-9;
  const auto size = static_cast<Index>(to.rows.size());
  Vec r(size);
  Vec whole = Vec::Zero(W.cols());
  double largest = 0;
  for (Index k = 0; k < size; ++k) {
    r[k] = std::cos(static_cast<double>(k + 1));
    whole[to.rows[at(k)]] = to.weight[at(k)] * r[k];
    largest = std::max(largest, parts.near(k, k));
  }
  const Vec u = parts.product(r);
  const Vec given = W * whole;
  for (Index k = 0; k < size; ++k)
    if (!(std::abs(u[k] - to.weight[at(k)] * given[to.rows[at(k)]] / to.s) <= same * (largest + std::abs(u[k]))))
      return false;
  return true;
}

}  // namespace

Vec Scaled::expand(In r) const {
  Vec out = Vec::Zero(whole);
  for (Index k = 0; k < size(); ++k) out[rows[at(k)]] = impulse[k] * r[k];
  return out;
}

Vec Scaled::reduce(In r) const {
  return Vec::NullaryExpr(size(), [&](Index k) { return r[rows[at(k)]] / impulse[k]; });
}

Scaled scaled(const Problem& problem, bool scale) {
  const int d = problem.dimension;
  const Index n = problem.contacts();
  Scaled out;
  out.whole = d * n;
  const Units units = scale ? Units::of(problem.W, problem.q) : Units::none();

  Coordinates to;
  to.place.assign(at(d * n), -1);
  to.s = units.W;
  for (Index a = 0; a < n; ++a) {
    const int size = problem.mu[a] > 0 ? d : 1;
    out.blocks.push_back({static_cast<Index>(out.rows.size()), size});
    for (int k = 0; k < size; ++k) {
      to.place[at(d * a + k)] = static_cast<int>(out.rows.size());
      out.rows.push_back(d * a + k);
      to.weight.push_back(k == 0 ? 1 : problem.mu[a]);
    }
  }
  to.blocks = out.blocks;
  to.rows = out.rows;
  const auto m = static_cast<Index>(out.rows.size());
  out.q = Vec(m);
  out.impulse = Vec(m);
  for (Index k = 0; k < m; ++k) {
    out.q[k] = to.weight[at(k)] * problem.q[out.rows[at(k)]] / units.velocity;
    out.impulse[k] = units.impulse * to.weight[at(k)];
  }
  std::shared_ptr<const DelassusParts> parts;
  if (problem.global && problem.global->G.cols() == 0 && problem.global->H.cols() == d * n)
    parts = parts_of(*problem.global, to);
  if (parts && made_of(problem.W, *parts, to))
    out.W = Delassus(parts, [parts, blocks = out.blocks] { return with_whole_blocks(parts->form(), blocks); });
  else
    out.W = fill(problem.W, to);
  return out;
}

double natural_map(const Scaled& problem, In r) { return natural_map(problem, r, r, 0); }

double natural_map(const Scaled& problem, In r, In centre, double alpha) {
  const Vec u = problem.W * r + problem.q + alpha * (r - centre);
  double worst = 0;
  for (const Scaled::Block& block : problem.blocks) {
    const double part = natural_map(block.of(r), block.of(u), 1).norm();
    if (!(part <= worst)) worst = part;
  }
  if (std::isnan(worst)) return lcp::infinity;
  return worst;
}

}  // namespace perp::contact
