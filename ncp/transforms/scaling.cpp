// SPDX-License-Identifier: Apache-2.0
#include "ncp/transforms/scaling.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "lcp/words.hpp"

namespace perp::ncp {
namespace {

constexpr int max_sweeps = 20;
constexpr double settled = 0.05;     // in log2 of the factors
constexpr double negligible = 1e-8;  // of the largest entry of the row and of the column
constexpr double largest = 40;       // log2 of a factor

/// Entries that count, by their log2.
struct Entry {
  Index row, column;
  double log;
};

/// Smallest and largest of the logarithms of a row or column.
struct Range {
  double low = infinity, high = -infinity;
  void add(double log) {
    low = std::min(low, log);
    high = std::max(high, log);
  }
  bool empty() const { return low > high; }
  double middle() const { return 0.5 * (low + high); }
};

std::vector<Entry> entries_of(const Mcp& mcp, const SpMat& J) {
  const Index n = mcp.size();
  if (J.rows() != n || J.cols() != n)
    refuse_input(mcp.name(), ": scaling: the Jacobian is ", J.rows(), " x ", J.cols(), " for ", n, " variables");
  const auto fixed = [&](Index i) { return mcp.box().lower[i] == mcp.box().upper[i]; };
  Vec row_max = Vec::Zero(J.rows()), column_max = Vec::Zero(J.cols());
  std::vector<Entry> all;
  for (Index j = 0; j < J.cols(); ++j)
    for (SpMat::InnerIterator it(J, j); it; ++it) {
      const double a = std::abs(it.value());
      if (!std::isfinite(a))
        refuse_input(mcp.name(), ": scaling: the derivative of equation ", mcp.equation_name(it.row()),
                     " with respect to variable ", mcp.variable_name(j), " is ", it.value());
      if (a == 0 || fixed(it.row()) || fixed(j)) continue;
      all.push_back({it.row(), j, a});
      row_max[it.row()] = std::max(row_max[it.row()], a);
      column_max[j] = std::max(column_max[j], a);
    }
  std::erase_if(all,
                [&](const Entry& e) { return e.log < negligible * std::min(row_max[e.row], column_max[e.column]); });
  for (Entry& e : all) e.log = std::log2(e.log);
  return all;
}

template <class Log>
double spread(const std::vector<Entry>& entries, Log log) {
  Range all;
  for (const Entry& e : entries) all.add(log(e));
  return all.empty() ? 1 : std::exp2(all.high - all.low);
}
double spread(const std::vector<Entry>& entries) {
  return spread(entries, [](const Entry& e) { return e.log; });
}

/// Centres the entries of all rows (or columns) on 0; how much the factors changed.
double centre(const std::vector<Entry>& entries, Vec& rows, Vec& columns, bool by_row) {
  Vec& factors = by_row ? rows : columns;
  std::vector<Range> ranges(static_cast<std::size_t>(factors.size()));
  for (const Entry& e : entries)
    ranges[static_cast<std::size_t>(by_row ? e.row : e.column)].add(e.log + rows[e.row] + columns[e.column]);
  double change = 0;
  for (Index i = 0; i < factors.size(); ++i) {
    const Range& range = ranges[static_cast<std::size_t>(i)];
    if (range.empty()) continue;
    factors[i] -= range.middle();
    change = std::max(change, std::abs(range.middle()));
  }
  return change;
}

/// Whether every bound is as finite, and as far from 0 and from the other one, as before: with powers of two that is
/// so unless something overflows or underflows.
bool keeps_bounds(const Box& box, const Vec& columns) {
  for (Index i = 0; i < box.size(); ++i)
    for (const double bound : {box.lower[i], box.upper[i]})
      if (bound / columns[i] * columns[i] != bound || std::isfinite(bound / columns[i]) != std::isfinite(bound))
        return false;
  return true;
}

/// Of entries with this spread.
Scaling scaling_of(const Mcp& mcp, const std::vector<Entry>& entries, double before) {
  const Index n = mcp.size();
  Vec rows = Vec::Zero(n), columns = Vec::Zero(n);  // log2 of the factors
  Scaling result{.rows = Vec::Ones(n), .columns = Vec::Ones(n), .before = before, .after = before};
  double change = infinity;
  for (int k = 0; k < max_sweeps && change > settled; ++k)
    change = std::max(centre(entries, rows, columns, true), centre(entries, rows, columns, false));
  const double mean = n > 0 ? columns.mean() : 0;
  columns.array() -= mean;
  rows.array() += mean;
  const auto round = [](Vec& logs) {
    logs = logs.unaryExpr([](double log) { return std::clamp(std::round(log), -largest, largest); });
  };
  round(rows);
  round(columns);
  for (Index i = 0; i < n; ++i)
    if (mcp.box().lower[i] == mcp.box().upper[i]) rows[i] = columns[i] = 0;
  const Vec C = columns.unaryExpr([](double log) { return std::exp2(log); });
  if (!keeps_bounds(mcp.box(), C)) return result;
  result.rows = rows.unaryExpr([](double log) { return std::exp2(log); });
  result.columns = C;
  result.after = spread(entries, [&](const Entry& e) { return e.log + rows[e.row] + columns[e.column]; });
  return result;
}

}  // namespace

Scaling scaling(const Mcp& mcp, const SpMat& J) {
  const std::vector<Entry> entries = entries_of(mcp, J);
  return scaling_of(mcp, entries, spread(entries));
}

ScaledMcp::ScaledMcp(const Mcp& base, const Scaling& scaling)
    : base_(base), R_(scaling.rows), C_(scaling.columns), x_(base.size()) {
  for (const Vec* factors : {&R_, &C_}) {
    const char* which = factors == &R_ ? "row" : "column";
    if (factors->size() != base.size())
      refuse_input(base.name(), ": scaling: ", factors->size(), ' ', which, " factors for ", base.size(), " variables");
    for (Index i = 0; i < factors->size(); ++i)
      if (!((*factors)[i] > 0 && std::isfinite((*factors)[i])))
        refuse_input(base.name(), ": scaling: ", which, " factor ", i + 1, " is ", (*factors)[i]);
  }
  box_ = {to_scaled(base.box().lower), to_scaled(base.box().upper)};
}

double ScaledMcp::tolerance(double tol) const {
  return size() > 0 ? tol / std::max(C_.maxCoeff(), 1 / R_.minCoeff()) : tol;
}

bool ScaledMcp::eval(In x, Out F) const {
  x_ = x.cwiseProduct(C_);
  const bool defined = base_.eval(x_, F);
  F.array() *= R_.array();
  return defined;
}

bool ScaledMcp::jacobian(In x, SpMat& J) const {
  x_ = x.cwiseProduct(C_);
  if (!base_.jacobian(x_, J)) return false;
  if (J.rows() != size() || J.cols() != size()) return true;  // the caller sees that it left its pattern
  for (Index j = 0; j < J.cols(); ++j)
    for (SpMat::InnerIterator it(J, j); it; ++it) it.valueRef() *= R_[it.row()] * C_[j];
  return true;
}

}  // namespace perp::ncp
