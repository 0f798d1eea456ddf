// SPDX-License-Identifier: Apache-2.0
#include "contact/model/scaling.hpp"

#include <algorithm>
#include <cmath>

#include "contact/model/natural_map.hpp"
#include "contact/model/units.hpp"

namespace perp::contact {
namespace {

/// W~ with whole blocks: where a column has an entry in the rows of a contact it has all of them, and its own
/// contact's.
void fill(const SpMat& W, const std::vector<int>& place, const std::vector<double>& weight, double s, Scaled& out) {
  std::vector<int> owner;
  for (std::size_t a = 0; a < out.blocks.size(); ++a)
    owner.insert(owner.end(), at(out.blocks[a].size), static_cast<int>(a));
  out.W = SpMat(out.size(), out.size());
  out.W.reserve(W.nonZeros() + 9 * out.size());
  std::vector<double> column(at(out.size()), 0.0);
  std::vector<char> touched(out.blocks.size(), 0);
  std::vector<int> contacts;
  for (Index j = 0; j < out.size(); ++j) {
    contacts.assign(1, owner[at(j)]);
    touched[at(owner[at(j)])] = 1;
    for (SpMat::InnerIterator it(W, out.rows[at(j)]); it; ++it) {
      const int row = place[at(it.row())];
      if (row < 0) continue;
      const int a = owner[at(row)];
      if (touched[at(a)] == 0) contacts.push_back(a);
      touched[at(a)] = 1;
      column[at(row)] += weight[at(row)] * weight[at(j)] * it.value() / s;
    }
    std::sort(contacts.begin(), contacts.end());
    out.W.startVec(j);
    for (const int a : contacts) {
      touched[at(a)] = 0;
      const Scaled::Block& block = out.blocks[at(a)];
      for (Index i = block.first; i < block.first + block.size; ++i) {
        out.W.insertBack(i, j) = column[at(i)];
        column[at(i)] = 0;
      }
    }
  }
  out.W.finalize();
}

/// W~ = (H diag(weight))' (s M)^-1 H diag(weight), in these columns of H.
std::shared_ptr<const Scaled::Bodies> bodies_of(const Global& global, const std::vector<Index>& columns,
                                                const std::vector<double>& weight, double s) {
  auto bodies = std::make_shared<Scaled::Bodies>(Scaled::Bodies{.M = s * global.M, .H = {}});
  bodies->M.makeCompressed();
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(at(global.H.nonZeros()));
  for (std::size_t k = 0; k < columns.size(); ++k)
    for (SpMat::InnerIterator it(global.H, columns[k]); it; ++it)
      entries.emplace_back(static_cast<int>(it.row()), static_cast<int>(k), weight[k] * it.value());
  bodies->H.resize(global.H.rows(), static_cast<Index>(columns.size()));
  bodies->H.setFromTriplets(entries.begin(), entries.end());
  return bodies;
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

  std::vector<double> weight;  // of M
  std::vector<int> place(at(d * n), -1);
  for (Index a = 0; a < n; ++a) {
    const int size = problem.mu[a] > 0 ? d : 1;
    out.blocks.push_back({static_cast<Index>(out.rows.size()), size});
    for (int k = 0; k < size; ++k) {
      place[at(d * a + k)] = static_cast<int>(out.rows.size());
      out.rows.push_back(d * a + k);
      weight.push_back(k == 0 ? 1 : problem.mu[a]);
    }
  }
  const auto m = static_cast<Index>(out.rows.size());
  out.q = Vec(m);
  out.impulse = Vec(m);
  for (Index k = 0; k < m; ++k) {
    out.q[k] = weight[at(k)] * problem.q[out.rows[at(k)]] / units.velocity;
    out.impulse[k] = units.impulse * weight[at(k)];
  }
  fill(problem.W, place, weight, units.W, out);
  if (problem.global && problem.global->G.cols() == 0 && problem.global->H.cols() == d * n)
    out.bodies = bodies_of(*problem.global, out.rows, weight, units.W);
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
