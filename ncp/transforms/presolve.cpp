// SPDX-License-Identifier: Apache-2.0
#include "ncp/transforms/presolve.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "ncp/transforms/presolve_reducer.hpp"
#include "ncp/transforms/reduced_mcp.hpp"

namespace perp::ncp {
namespace {

/// A solution t of  l <= t <= u  _|_  F + a (t - here); see Presolved for when there is one.
double scalar_solution(double a, double F, double here, double lower, double upper) {
  const double root = a != 0 ? here - F / a : here;
  if (a > 0 || (a < 0 && lower == -infinity && upper == infinity))
    return std::isfinite(root) ? std::min(std::max(root, lower), upper) : here;
  return F + a * (lower - here) >= 0 ? lower : upper;  // a <= 0: F is no larger at the upper bound
}

void expect_size(const Mcp& mcp, const char* what, Index given, Index expected) {
  if (given != expected)
    throw std::invalid_argument(mcp.name() + ": " + what + " of a point with " + std::to_string(given) +
                                " entries for " + std::to_string(expected) + " variables");
}

}  // namespace

Vec Presolved::reduce(In x) const {
  expect_size(*original_, "reduction", x.size(), original_->size());
  return Vec::NullaryExpr(static_cast<Index>(columns_.size()), [&](Index k) { return x[columns_[at(k)]]; });
}

// A postponed variable is in its own row and in rows that went before: the last one is computed first. Rounding of one
// pass is taken out by the second.
Vec Presolved::postsolve(In x) const {
  expect_size(*original_, "postsolve", x.size(), static_cast<Index>(columns_.size()));
  Vec full = base_;
  for (Index k = 0; k < x.size(); ++k) full[columns_[at(k)]] = x[k];
  if (postponed_.empty()) return full;
  const Box& box = original_->box();
  Vec F(original_->size());
  CountedMcp counted(*original_);
  for (int pass = 0; pass < 2; ++pass) {
    if (!counted.eval(full, F)) return full;
    for (std::size_t k = postponed_.size(); k-- > 0;) {
      const auto& [row, c, a] = postponed_[k];
      const double value = scalar_solution(a, F[row], full[c], box.lower[c], box.upper[c]);
      const double step = value - full[c];
      full[c] = value;
      for (SpMat::InnerIterator it(J_, c); it; ++it) F[it.row()] += it.value() * step;
    }
  }
  return full;
}

Presolved presolve(const Mcp& mcp, In x0) {
  Presolved p;
  p.original_ = &mcp;
  auto reducer = std::make_unique<Reducer>(mcp, x0);
  reducer->run(true);
  p.F_evals_ = reducer->F_evals();
  p.J_evals_ = reducer->J_evals();
  if (reducer->infeasible.empty() && !reducer->defined()) {
    // F is defined at x0, but not where presolve would start: x0 is worth more.
    reducer = std::make_unique<Reducer>(mcp, x0);
    reducer->run(false);
  }
  p.infeasible_ = std::move(reducer->infeasible);
  p.notes_ = std::move(reducer->notes);
  p.counts_ = reducer->counts;
  p.postponed_ = std::move(reducer->postponed);
  p.base_ = reducer->x();
  if (!p.postponed_.empty()) p.J_ = reducer->J();
  p.columns_.reserve(at(mcp.size()));
  p.rows_.reserve(at(mcp.size()));
  for (Index c = 0; c < mcp.size(); ++c) {
    if (!reducer->kept(c)) continue;
    p.columns_.push_back(c);
    p.rows_.push_back(reducer->row_of(c));
  }
  p.start_ = p.reduce(p.base_);
  if (p.counts_.total() > 0) p.reduced_ = std::make_unique<ReducedMcp>(mcp, reducer->evaluated(), p.columns_, p.rows_);
  return p;
}

}  // namespace perp::ncp
