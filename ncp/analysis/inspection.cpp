// SPDX-License-Identifier: Apache-2.0
#include "ncp/analysis/inspection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "lcp/lu/sparse_lu.hpp"
#include "ncp/problem/affine.hpp"
#include "ncp/problem/counted_mcp.hpp"
#include "ncp/run/undefined_start.hpp"

namespace perp::ncp {

namespace {

constexpr double degenerate_within = 1e-8;  // the default tolerance of the methods
constexpr Index check_all_columns = 200;    // derivatives: every column up to this n,
constexpr Index checked_columns = 50;       // else so many
constexpr Index factor_to = 50'000;         // condition: beyond, an LU may take minutes and the memory
constexpr Index classify_functions_to = 20'000;
constexpr std::size_t extremes_shown = 3;  // of rows, and of columns

VariableKinds kinds_of(const Box& box) {
  VariableKinds kinds;
  for (Index i = 0; i < box.size(); ++i) {
    const bool below = std::isfinite(box.lower[i]);
    const bool above = std::isfinite(box.upper[i]);
    if (box.is_fixed(i))
      kinds.fixed.push_back(i);
    else
      ++(below && above ? kinds.boxed : below ? kinds.lower : above ? kinds.upper : kinds.free);
  }
  return kinds;
}

/// The rows and columns of A that are kept (ascending), and nothing else.
SpMat principal(const SpMat& A, const Indices& kept) {
  std::vector<int> number(at(A.rows()), -1);
  for (std::size_t k = 0; k < kept.size(); ++k) number[at(kept[k])] = static_cast<int>(k);
  std::vector<Eigen::Triplet<double>> entries;
  for (const Index j : kept)
    for (SpMat::InnerIterator it(A, j); it; ++it)
      if (const int i = number[at(it.row())]; i >= 0) entries.emplace_back(i, number[at(j)], it.value());
  SpMat B(static_cast<Index>(kept.size()), static_cast<Index>(kept.size()));
  B.setFromTriplets(entries.begin(), entries.end());
  return B;
}

Indices not_fixed(const Box& box) {
  Indices kept;
  for (Index i = 0; i < box.size(); ++i)
    if (!box.is_fixed(i)) kept.push_back(i);
  return kept;
}

/// Back to the problem's indices.
Indices of_problem(const Indices& indices, const Indices& kept) {
  Indices out;
  for (const Index i : indices) out.push_back(kept[at(i)]);
  return out;
}

/// Pre: J has the rows and columns `kept`.
StructureFindings structure_of(const SpMat& J, const Box& box, const Indices& kept, lcp::Entries count) {
  StructureFindings found{.size = J.cols()};
  std::vector<char> met(at(J.rows()), 0);
  for (Index j = 0; j < J.cols(); ++j) {
    bool empty = true;
    for (SpMat::InnerIterator it(J, j); it; ++it) {
      if (count == lcp::Entries::NonZero && it.value() == 0) continue;
      empty = false;
      met[at(it.row())] = 1;
    }
    if (empty) found.empty_columns.push_back(kept[at(j)]);
  }
  for (Index i = 0; i < J.rows(); ++i)
    if (met[at(i)] == 0) found.empty_rows.push_back(kept[at(i)]);

  lcp::Structure parts = lcp::dulmage_mendelsohn(J, count);
  found.rank = found.rank_with_bounds = parts.rank;
  if (found.full()) return found;
  std::vector<Eigen::Triplet<double>> entries;
  for (Index j = 0; j < J.cols(); ++j) {
    if (!box.is_free(kept[at(j)])) entries.emplace_back(static_cast<int>(j), static_cast<int>(j), 1);
    for (SpMat::InnerIterator it(J, j); it; ++it)
      if (count == lcp::Entries::Stored || it.value() != 0) entries.emplace_back(it.row(), it.col(), 1);
  }
  SpMat with_bounds(J.rows(), J.cols());
  with_bounds.setFromTriplets(entries.begin(), entries.end());
  lcp::Structure parts_with_bounds = lcp::dulmage_mendelsohn(with_bounds, lcp::Entries::Stored);
  found.rank_with_bounds = parts_with_bounds.rank;
  if (found.singular()) parts = std::move(parts_with_bounds);
  found.over = {of_problem(parts.over.rows, kept), of_problem(parts.over.columns, kept)};
  found.under = {of_problem(parts.under.rows, kept), of_problem(parts.under.columns, kept)};
  return found;
}

void judge_values(const Box& box, StartFindings& start) {
  for (Index i = 0; i < start.F.size(); ++i) {
    const double F = std::abs(start.F[i]);
    if (!std::isfinite(F)) {
      start.F_undefined.push_back(i);
      start.F_defined = false;
    }
    if (box.is_fixed(i) || !std::isfinite(F)) continue;
    if (F == 0) {
      ++start.zeros_in_F;
    } else {
      if (start.smallest_F == 0 || F < start.smallest_F) start.smallest_F = F;
      if (start.largest_F < 0 || F > std::abs(start.F[start.largest_F])) start.largest_F = i;
    }
    if (lcp::cell_of(box, i, start.x[i], degenerate_within) != lcp::Cell::Inside && F <= degenerate_within)
      start.degenerate.push_back(i);
  }
}

std::string why_not_defined(const Mcp& mcp, const StartFindings& start) {
  CountedMcp counted(mcp);
  if (std::optional<MovedStart> moved = moved_start(counted, start.x)) return std::move(moved->note);
  return undefined_start(mcp, start.x, start.F, start.F_defined ? &start.J : nullptr);
}

StartFindings start_of(const Mcp& mcp, const Vec& x0, const Indices& kept) {
  const Box& box = mcp.box();
  StartFindings start{.x = lcp::project(box, x0), .F = Vec::Zero(mcp.size()), .J = mcp.jacobian_pattern()};
  for (Index i = 0; i < mcp.size(); ++i)
    if (start.x[i] != x0[i]) start.outside.push_back(i);
  start.F_defined = mcp.eval(start.x, start.F);
  const bool said_undefined = !start.F_defined;
  judge_values(box, start);
  if (said_undefined && start.F_undefined.empty()) {  // no row was marked: F says nothing
    start.largest_F = -1;
    start.zeros_in_F = 0;
    start.degenerate.clear();
  } else {
    start.residual = residual(box, start.x, start.F);
  }
  start.J_defined = mcp.jacobian(start.x, start.J);
  for (Index j = 0; j < start.J.cols(); ++j)
    for (SpMat::InnerIterator it(start.J, j); it; ++it)
      if (!std::isfinite(it.value())) start.J_undefined.emplace_back(it.row(), j);
  start.J_defined = start.J_defined && start.J_undefined.empty();
  if (!start.F_defined || !start.J_defined) start.undefined = why_not_defined(mcp, start);
  if (start.J_defined) start.rank = lcp::structural_rank(principal(start.J, kept));
  return start;
}

/// The few largest and smallest of the positive values.
void extremes(const Vec& values, const Indices& kept, std::vector<Extreme>& large, std::vector<Extreme>& small) {
  std::vector<Extreme> all;
  for (Index k = 0; k < values.size(); ++k)
    if (values[k] > 0) all.push_back({kept[at(k)], values[k]});
  const auto first = [&](auto before) {
    const std::size_t few = std::min(extremes_shown, all.size());
    std::partial_sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(few), all.end(), before);
    return std::vector<Extreme>(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(few));
  };
  large = first(
      [](const Extreme& a, const Extreme& b) { return std::pair(-a.value, a.index) < std::pair(-b.value, b.index); });
  small = first(
      [](const Extreme& a, const Extreme& b) { return std::pair(a.value, a.index) < std::pair(b.value, b.index); });
}

/// Pre: J has the rows and columns `kept`.
ScalingFindings scaling_of(const SpMat& J, const Indices& kept) {
  ScalingFindings found;
  Vec rows = Vec::Zero(J.rows());
  Vec columns = Vec::Zero(J.cols());
  for (Index j = 0; j < J.cols(); ++j)
    for (SpMat::InnerIterator it(J, j); it; ++it) {
      const double a = std::abs(it.value());
      if (a == 0) ++found.zeros;
      if (a == 0 || !std::isfinite(a)) continue;
      const std::pair place{kept[at(it.row())], kept[at(j)]};
      if (found.entries == 0 || a < found.smallest) found.smallest = a, found.smallest_at = place;
      if (found.entries == 0 || a > found.largest) found.largest = a, found.largest_at = place;
      ++found.entries;
      rows[it.row()] = std::max(rows[it.row()], a);
      columns[j] = std::max(columns[j], a);
    }
  extremes(rows, kept, found.large_rows, found.small_rows);
  extremes(columns, kept, found.large_columns, found.small_columns);
  return found;
}

std::optional<double> rcond(const SpMat& A) {
  lcp::SparseLu lu;
  switch (lu.factor(A)) {
    case lcp::LuStatus::Ok:
      return lu.rcond();
    case lcp::LuStatus::Singular:
      return 0.0;
    case lcp::LuStatus::NotFinite:
      break;
  }
  return std::nullopt;
}

ConditionFindings condition_of(const Box& box, const StartFindings& start, const Indices& kept) {
  ConditionFindings found;
  if (!start.F_defined || !start.J_defined) {
    found.why_not = "F or its Jacobian is not defined at the start";
    return found;
  }
  Indices active;
  for (const Index i : kept)  // where mid(x - u, F, x - l) is F
    if (start.F[i] >= start.x[i] - box.upper[i] && start.F[i] <= start.x[i] - box.lower[i]) active.push_back(i);
  found.active_size = static_cast<Index>(active.size());
  if (static_cast<Index>(kept.size()) > factor_to) {
    found.why_not = fmt::format("not estimated beyond {} rows", factor_to);
    return found;
  }
  if (kept.empty()) return found;
  found.all = rcond(principal(start.J, kept));
  if (active.size() == kept.size())
    found.active = found.all;
  else if (!active.empty())
    found.active = rcond(principal(start.J, active));
  if (!found.all) found.why_not = "its factors do not fit in memory";
  return found;
}

}  // namespace

double ScalingFindings::spread() const {
  const auto ratio = [](const std::vector<Extreme>& large, const std::vector<Extreme>& small) {
    return large.empty() ? 1 : large[0].value / small[0].value;
  };
  return std::max(ratio(large_rows, small_rows), ratio(large_columns, small_columns));
}

Inspection inspect(const Mcp& mcp, In x0, const std::atomic<bool>* interrupt) {
  const Box& box = mcp.box();
  check_input(mcp, x0);
  const auto stop = [&](Inspection& inspection, const char* what) {
    if (interrupt != nullptr && *interrupt)
      inspection.interrupted += fmt::format("{}{}", inspection.interrupted.empty() ? "" : ", ", what);
    return !inspection.interrupted.empty();
  };
  Inspection inspection{.problem = &mcp, .kinds = kinds_of(box)};
  const Index n = mcp.size();
  // First: it refuses a Jacobian that does not keep its pattern.
  if (!stop(inspection, "derivatives"))
    inspection.derivatives =
        check_jacobian(mcp, lcp::project(box, x0), 1e-6, n <= check_all_columns ? n : checked_columns);
  const Indices kept = not_fixed(box);
  const auto affine = affine_part(mcp);
  inspection.structure = affine
                             ? structure_of(principal(affine->M, kept), box, kept, lcp::Entries::NonZero)
                             : structure_of(principal(mcp.jacobian_pattern(), kept), box, kept, lcp::Entries::Stored);
  inspection.start = start_of(mcp, x0, kept);
  inspection.scaling = scaling_of(principal(inspection.start.J, kept), kept);
  if (!stop(inspection, "condition")) inspection.condition = condition_of(box, inspection.start, kept);
  if (affine && !affine->invalid() && !stop(inspection, "matrix classes")) inspection.classes = lcp::classify(*affine);
  if (!affine && n <= classify_functions_to && !stop(inspection, "classes of F"))
    inspection.function_classes = function_classes(mcp, lcp::project(box, x0));
  return inspection;
}

}  // namespace perp::ncp
