// SPDX-License-Identifier: Apache-2.0
// The reductions that look at one row or one column.
#include <algorithm>
#include <cmath>
#include <limits>

#include "lcp/words.hpp"
#include "ncp/transforms/presolve_reducer.hpp"

namespace perp::ncp {
namespace {

constexpr double noise = 1e-12;        // relative to the terms of a sum
constexpr double zero = 1e-13;         // relative to the terms of a row: nothing but rounding
constexpr double inside = 1e-9;        // relative: how far from its bounds a variable is between them
constexpr double smallest = 1e-12;     // coefficients below are not divided by
constexpr int max_looks = 20;          // at the range of one row
constexpr double useless_bound = 1e8;  // implied bounds beyond say nothing
constexpr double progress = 1e-3;      // relative: what an implied bound has to improve by

std::string text(double value) { return text_of(value); }

}  // namespace

double Reducer::verdict(Index row) const {
  double coefficients = 0;
  for (const Entry& e : rows_[at(row)])
    if (e.linear) coefficients += std::abs(e.a);
  return std::max({trust, trust * coefficients, 10 * rounding(row)});
}

// Why F_row may not have this sign, if its variable cannot be at the bound that would go with it.
std::string Reducer::objection(Index row, double sign) const {
  const Index j = set_by_[at(row)];
  if (j >= 0) return "has to be 0, for other equations make " + mcp_.variable_name(j) + " = " + text(x_[j]);
  if (column_of_[at(row)] != row || is_free(row)) return "has to be 0";
  const std::string has_to_be = std::string("has to be ") + (sign > 0 ? "at most" : "at least") + " 0";
  if (mcp_.variable_name(row) == mcp_.equation_name(row)) return has_to_be;  // a side condition, whose variable is ours
  return has_to_be + ", as variable " + mcp_.variable_name(row) + " has no " + (sign > 0 ? "lower" : "upper") +
         " bound";
}

void Reducer::examine_row(Index row) {
  if (!is_affine(row)) return;
  if (unfixed_[at(row)] == 0) return empty_row(row);
  if (unfixed_[at(row)] == 1 && singleton_row(row)) return;
  range_row(row);
  if (row_kept_[at(row)] != 0) push_column(column_of_[at(row)]);
}

void Reducer::empty_row(Index row) {
  const double F = F_[row];
  if (std::abs(F) > rounding(row)) return force(row, F, F, {});
  push_column(column_of_[at(row)]);  // which may be free to be anything
}

// F_row = a (x_j - value).
bool Reducer::singleton_row(Index row) {
  const auto entry =
      std::find_if(rows_[at(row)].begin(), rows_[at(row)].end(), [&](const Entry& e) { return kept(e.index); });
  const Index j = entry->index;
  const double a = entry->a;
  const double value = x_[j] - F_[row] / a;
  if (std::abs(a) < smallest || !std::isfinite(value)) return false;
  if (column_of_[at(row)] != j) return is_equation(row) && set_by_equation(row, j, a, value);
  if (a < 0 && !is_free(j)) return false;  // more than one solution, or none
  const double nearest = lcp::project(box(), j, value);
  if (nearest == value) set_.push_back({row, j, a});
  fix(j, nearest);
  drop(row);
  ++counts.singleton_rows;
  return true;
}

// The equation makes x_column = value; its own variable takes over the row of x_column.
bool Reducer::set_by_equation(Index row, Index column, double a, double value) {
  const double outside = std::abs(value - lcp::project(box(), column, value));
  if (std::abs(a) * outside > verdict(row)) {
    const bool below = value < box().lower[column];
    infeasible =
        equation(row) + " makes " + mcp_.variable_name(column) + " = " + text(value) + ", but its " +
        (below ? "lower bound is " + text(box().lower[column]) : "upper bound is " + text(box().upper[column]));
    return true;
  }
  const double margin = inside * (1 + std::abs(value));
  if (!(value - box().lower[column] > margin && box().upper[column] - value > margin)) return false;
  const Index freed = column_of_[at(row)];
  const Index orphan = row_of_[at(column)];
  set_.push_back({row, column, a});
  fix(column, value);
  drop(row);
  set_by_[at(orphan)] = column;
  pair(orphan, freed);
  ++counts.singleton_rows;
  return true;
}

Reducer::Term Reducer::term(const Entry& e) const {
  const Index j = e.index;
  const double low = e.a * ((e.a > 0 ? implied_lower_ : implied_upper_)[j] - x_[j]);
  const double high = e.a * ((e.a > 0 ? implied_upper_ : implied_lower_)[j] - x_[j]);
  return {low, high, lower_by_[at(j)] >= 0 || upper_by_[at(j)] >= 0};
}

Reducer::Activity Reducer::activity(Index row) const {
  Activity r{.low = F_[row], .high = F_[row]};
  for (const Entry& e : rows_[at(row)]) {
    if (!kept(e.index)) continue;
    const Term t = term(e);
    if (t.low == -infinity)
      ++r.low_infinite;
    else
      r.low += t.low, r.size += std::abs(t.low);
    if (t.high == infinity)
      ++r.high_infinite;
    else
      r.high += t.high, r.size += std::abs(t.high);
    r.implied |= t.implied;
  }
  return r;
}

// The sign of F_row throughout the box; what an equation implies for its variables.
void Reducer::range_row(Index row) {
  if (++looks_[at(row)] > max_looks) return;
  const Activity r = activity(row);
  const double margin = rounding(row) + noise * r.size + (r.implied ? trust : 0);
  if (r.above(margin)) return force(row, 1, r.low, r);
  if (r.below(margin)) return force(row, -1, r.high, r);
  if (is_equation(row)) tighten(row, r);
}

// F_row has a sign; `nearest` is its value closest to 0.
void Reducer::force(Index row, double sign, double nearest, const Activity& activity) {
  const Index column = column_of_[at(row)];
  const double bound = sign > 0 ? box().lower[column] : box().upper[column];
  if (std::isfinite(bound)) {
    fix(column, bound);
    drop(row);
    ++counts.forced;
    return;
  }
  if (std::abs(nearest) <= verdict(row) + 10 * noise * activity.size) return;
  const bool settled = unfixed_[at(row)] == 0;
  infeasible = equation(row) + " is " +
               (settled    ? ""
                : sign > 0 ? "at least "
                           : "at most ") +
               text(nearest) +
               (rows_[at(row)].empty() ? " everywhere"
                : settled              ? " where its variables have to be"
                : activity.implied     ? " where other equations hold"
                                       : " within the bounds") +
               ", but " + objection(row, sign);
}

// F_row = 0 and the bounds of all other variables leave each variable an interval.
void Reducer::tighten(Index row, const Activity& r) {
  for (const Entry& e : rows_[at(row)]) {
    const Index j = e.index;
    if (!kept(j) || std::abs(e.a) < smallest) continue;
    const Term t = term(e);
    const bool up = e.a > 0;
    // The sum of the other terms' least (largest) values; NaN if there is none.
    const auto others = [](double sum, int infinite, double own) {
      const bool is_infinite = !std::isfinite(own);
      if (infinite > (is_infinite ? 1 : 0)) return std::numeric_limits<double>::quiet_NaN();
      return is_infinite ? sum : sum - own;
    };
    const double low = others(r.low, r.low_infinite, t.low);
    const double high = others(r.high, r.high_infinite, t.high);
    const double slack = (trust + noise * (size_[row] + r.size)) / std::abs(e.a);
    if (std::isfinite(low)) {  // a (x_j - here) <= -low
      const double bound = x_[j] - low / e.a;
      if (imply(j, !up, up ? bound + slack : bound - slack, row)) return;
    }
    if (std::isfinite(high)) {  // a (x_j - here) >= -high
      const double bound = x_[j] - high / e.a;
      if (imply(j, up, up ? bound - slack : bound + slack, row)) return;
    }
  }
}

// True: the implied bounds contradict each other.
bool Reducer::imply(Index column, bool lower, double bound, Index row) {
  Vec& bounds = lower ? implied_lower_ : implied_upper_;
  const double old = bounds[column];
  if (!(std::abs(bound) < useless_bound)) return false;
  if (std::isfinite(old) && !((lower ? bound - old : old - bound) > progress * (1 + std::abs(old)))) return false;
  bounds[column] = bound;
  (lower ? lower_by_ : upper_by_)[at(column)] = row;
  for (const Entry& e : columns_[at(column)]) push_row(e.index);
  const double gap = implied_lower_[column] - implied_upper_[column];
  if (!(gap > trust * (1 + std::abs(bound)))) return false;
  const auto source = [&](Index by, double value) {
    return text(value) + " by " + (by < 0 ? "its bound" : equation(by));
  };
  infeasible = "nothing is left for variable " + mcp_.variable_name(column) + ": it has to be at least " +
               source(lower_by_[at(column)], implied_lower_[column]) + " and at most " +
               source(upper_by_[at(column)], implied_upper_[column]);
  return true;
}

void Reducer::examine_column(Index column) {
  if (!kept(column) || linear_column_[at(column)] == 0 || kept_rows_[at(column)] > 1) return;
  const auto& entries = columns_[at(column)];
  const auto entry =
      std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return row_kept_[at(e.index)] != 0; });
  const Index row = row_of_[at(column)];
  const double a = entry == entries.end() ? 0 : entry->a;
  if (a != 0 && std::abs(a) < smallest) return;
  if (a != 0 && entry->index != row) {  // a free variable that an equation alone has is what that equation is for
    const Index other = column_of_[at(entry->index)];
    if (!is_free(column) || !is_free(other)) return;
    postpone(entry->index, column, a);
    return pair(row, other);
  }
  const int finite = (std::isfinite(box().lower[column]) ? 1 : 0) + (std::isfinite(box().upper[column]) ? 1 : 0);
  if (a > 0 || finite == 2 || (a < 0 && finite == 0)) return postpone(row, column, a);
  if (!is_affine(row) || !harmless_at_bound(row, column, a)) return;
  drop(row);
  ++counts.empty;
}

// A variable that is in no other row, with one bound or none: is it at that bound a solution of its row, whatever the
// others? Fixes it there if so.
bool Reducer::harmless_at_bound(Index row, Index column, double a) {
  const double tiny = std::min(zero * size_[row], 1e-12);
  if (is_free(column)) {  // a = 0
    if (unfixed_[at(row)] > 0 || std::abs(F_[row]) > tiny) return false;
    fix(column, x_[column]);
    return true;
  }
  const bool lower = std::isfinite(box().lower[column]);
  const double bound = lower ? box().lower[column] : box().upper[column];
  Activity r{.low = F_[row], .high = F_[row]};
  for (const Entry& e : rows_[at(row)]) {
    if (!kept(e.index) || e.index == column) continue;
    const Term t = term(e);
    r.low += t.low;  // infinite if one is
    r.high += t.high;
  }
  const double own = a * (bound - x_[column]);
  if (!(lower ? r.low + own >= -tiny : r.high + own <= tiny)) return false;
  fix(column, bound);
  return true;
}

}  // namespace perp::ncp
