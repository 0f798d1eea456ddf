// SPDX-License-Identifier: Apache-2.0
#include "contact/model/scaling.hpp"

#include <algorithm>
#include <cmath>

#include "contact/model/forms.hpp"
#include "contact/model/natural_map.hpp"
#include "contact/model/unit_cone.hpp"
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

SpMat with_whole_blocks(const SpMat& W, const std::vector<Scaled::Block>& blocks) {
  Coordinates same{.blocks = blocks, .rows = {}, .place = {}, .weight = {}};
  for (Index i = 0; i < W.rows(); ++i) {
    same.rows.push_back(i);
    same.place.push_back(static_cast<int>(i));
    same.weight.push_back(1);
  }
  return fill(W, same);
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

Scaled scaled(const Problem& problem, bool scale, WForm form) {
  const int d = problem.dimension;
  const Index n = problem.contacts();
  Scaled out;
  out.whole = d * n;
  const int width = problem.disk_width();
  const Units units = scale ? Units::of(problem.W, problem.q) : Units::none();

  Coordinates to;
  to.place.assign(at(d * n), -1);
  to.s = units.W;
  for (Index a = 0; a < n; ++a) {
    Scaled::Block& block =
        out.blocks.emplace_back(Scaled::Block{.first = static_cast<Index>(out.rows.size()), .size = 0});
    int disks = 0;
    const auto take = [&](int from, int count, double weight) {
      for (int k = from; k < from + count; ++k) {
        to.place[at(d * a + k)] = static_cast<int>(out.rows.size());
        out.rows.push_back(d * a + k);
        to.weight.push_back(weight);
      }
      block.size += count;
    };
    const auto take_disk = [&](int from, double mu) {
      if (!(mu > 0)) return;
      take(from, width, mu);
      ++disks;
    };
    take(0, 1, 1);
    take_disk(1, problem.mu[a]);
    if (problem.rolls()) take_disk(1 + width, problem.mu_r[a]);
    if (disks == 2) block.width = width;
    out.rolls = out.rolls || disks == 2;
  }
  if (out.rolls) form = WForm::Entries;
  to.blocks = out.blocks;
  to.rows = out.rows;
  const auto m = static_cast<Index>(out.rows.size());
  out.q = Vec(m);
  out.impulse = Vec(m);
  for (Index k = 0; k < m; ++k) {
    out.q[k] = to.weight[at(k)] * problem.q[out.rows[at(k)]] / units.velocity;
    out.impulse[k] = units.impulse * to.weight[at(k)];
  }
  if (const DelassusParts* of = problem.W.whole_parts()) {
    const auto parts = std::make_shared<const DelassusParts>(*of, to.s, to.rows, to.weight);
    const bool entries = form == WForm::Entries || (form == WForm::Cheaper && entries_take_less(*parts, out.blocks));
    const auto make = [parts, blocks = out.blocks] { return with_whole_blocks(parts->form(), blocks); };
    out.W = entries ? Delassus(make()) : Delassus(parts, make);
  } else {
    out.W = fill(problem.W.matrix(), to);
  }
  return out;
}

Vec corrected(const Scaled& problem, Vec u) {
  with_size(problem, [&]<int Size>() {
    for (const Scaled::Block& block : problem.blocks)
      u[block.first] = corrected<Size>(block.of<Size>(u), block.width)[0];
  });
  return u;
}

Vec project_onto_cones(const Scaled& problem, Vec y) {
  with_size(problem, [&]<int Size>() {
    for (const Scaled::Block& block : problem.blocks)
      y.segment(block.first, block.size) =
          project_onto_unit_cone<Size>(block.of<Size>(y), block.width).head(block.size);
  });
  return y;
}

double natural_map(const Scaled& problem, In r) { return natural_map(problem, r, r, 0); }

double natural_map(const Scaled& problem, In r, In centre, double alpha) {
  const Vec u = problem.W * r + problem.q + alpha * (r - centre);
  return with_size(problem, [&]<int Size>() {
    Frictions<Size> mu;
    mu.fill(1);
    double worst = 0;
    for (const Scaled::Block& block : problem.blocks) {
      const double part = natural_map<Size>(block.of<Size>(r), block.of<Size>(u), mu, 1, block.width).norm();
      if (!(part <= worst)) worst = part;
    }
    return std::isnan(worst) ? lcp::infinity : worst;
  });
}

}  // namespace perp::contact
