// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "ncp/analysis/no_solution.hpp"
#include "ncp/interval/enclosure.hpp"

namespace perp::ncp {
namespace {

/// Entries of J whose ranges are taken in all, less than a second's work.
constexpr double most_entries = 5e5;
/// Each narrows a part by a tenth in some variable at least.
constexpr int most_rounds_of_a_part = 10;
constexpr double narrower = 0.9;
/// A part as narrow as this, relative to 1 + |x|, that cannot be refuted has a solution, or nearly.
constexpr double narrow = 1e-5;

using Part = std::vector<Interval>;

double middle(const Interval& a) { return std::midpoint(a.lower, a.upper); }
double width(const Interval& a) { return a.upper - a.lower; }

class Parts {
 public:
  Parts(const Mcp& mcp, const Enclosure& enclosure, double tol)
      : mcp_(mcp),
        box_(mcp.box()),
        enclosure_(enclosure),
        tol_(tol),
        n_(at(mcp.size())),
        J_(at(mcp.jacobian_pattern().nonZeros())),
        F_(n_),
        F_middle_(n_),
        known_(n_),
        rows_(n_) {
    std::size_t k = 0;
    for (Index j = 0; j < mcp.size(); ++j)
      for (SpMat::InnerIterator it(mcp.jacobian_pattern(), j); it; ++it, ++k) rows_[at(it.row())].push_back({at(j), k});
  }

  /// How many parts were refuted, all of the box; 0: there was one that was not.
  int run(lcp::Deadline deadline);

 private:
  struct Entry {
    std::size_t column, place;
  };

  bool signs(Part& X);
  bool contract(Part& X);
  bool refuted(Part& X);
  std::size_t widest(const Part& X) const;
  /// Where x_i may be if F_i > tol, and if F_i < -tol.
  Interval at_lower(std::size_t i) const { return Interval(box_.lower[static_cast<Index>(i)]) + Interval(0, tol_); }
  Interval at_upper(std::size_t i) const { return Interval(box_.upper[static_cast<Index>(i)]) + Interval(-tol_, 0); }
  /// Whether x_i is off its bounds on all of the part, so that |F_i| <= tol.
  bool equation(const Part& X, std::size_t i) const {
    const auto k = static_cast<Index>(i);
    return (box_.lower[k] == -infinity || X[i].lower > at_lower(i).upper) &&
           (box_.upper[k] == infinity || X[i].upper < at_upper(i).lower);
  }

  const Mcp& mcp_;
  const Box& box_;
  const Enclosure& enclosure_;
  double tol_;
  std::size_t n_;
  std::vector<Interval> J_, F_, F_middle_;
  std::vector<char> known_;
  std::vector<std::vector<Entry>> rows_;
  double entries_ = 0;
};

/// What the sign of F_i on all of X leaves of X_i. False: nothing.
bool Parts::signs(Part& X) {
  enclosure_.values(X, F_);
  for (std::size_t i = 0; i < n_; ++i) {
    const auto k = static_cast<Index>(i);
    if (F_[i].is_empty()) return false;
    const bool positive = F_[i].lower > tol_;
    if (box_.lower[k] == box_.upper[k] || !(positive || F_[i].upper < -tol_)) continue;
    if (std::isinf(positive ? box_.lower[k] : box_.upper[k])) return false;
    X[i] = intersection(X[i], positive ? at_lower(i) : at_upper(i));
    if (X[i].is_empty()) return false;
  }
  return true;
}

/// Of each equation  0 in F_i(m) + [-tol, tol] + sum_j J_ij (X_j - m_j),  m the middle of X:  what it leaves of every
/// X_j. False: nothing of one of them.
bool Parts::contract(Part& X) {
  enclosure_.jacobian(X, J_, known_);
  entries_ += static_cast<double>(J_.size() + n_);
  Part m(n_);
  for (std::size_t j = 0; j < n_; ++j) {
    m[j] = X[j].bounded() ? middle(X[j]) : std::clamp(0.0, X[j].lower, X[j].upper);
  }
  enclosure_.values(m, F_middle_);
  std::vector<Interval> term, before;
  for (std::size_t i = 0; i < n_; ++i) {
    if (known_[i] == 0 || F_middle_[i].is_empty() || !equation(X, i)) continue;
    const std::vector<Entry>& row = rows_[i];
    const auto zero = [&](const Entry& e) { return J_[e.place] == Interval(0); };
    term.assign(row.size(), Interval(0));
    before.assign(row.size() + 1, F_middle_[i] + Interval(-tol_, tol_));
    for (std::size_t k = 0; k < row.size(); ++k) {
      if (!zero(row[k])) term[k] = J_[row[k].place] * (X[row[k].column] - m[row[k].column]);
      before[k + 1] = before[k] + term[k];
    }
    if (!before.back().contains(0)) return false;
    Interval after = 0;
    for (std::size_t k = row.size(); k-- > 0; after += term[k]) {
      const Interval slope = J_[row[k].place];
      const std::size_t j = row[k].column;
      if (slope.contains(0)) continue;
      const Interval rest = before[k] + after;
      if (!rest.bounded()) continue;
      const Interval left = intersection(X[j], m[j] - rest / slope);
      if (left.is_empty()) return false;
      X[j] = left;
    }
  }
  return true;
}

bool Parts::refuted(Part& X) {
  for (int round = 0; round < most_rounds_of_a_part; ++round) {
    const Part before = X;
    if (!signs(X) || !contract(X)) return true;
    const auto narrowed = [&](std::size_t j) { return width(X[j]) < narrower * width(before[j]); };
    bool any = false;
    for (std::size_t j = 0; j < n_ && !any; ++j) any = narrowed(j);
    if (!any) return false;
  }
  return false;
}

/// The variable that makes most of an equation uncertain; n_: none that can be halved.
std::size_t Parts::widest(const Part& X) const {
  std::size_t best = n_;
  double most = 0;
  // Halves of what multiplies an unbounded variable decide nothing.
  const auto bounded = [&](const Entry& e) {
    return J_[e.place] == Interval(0) || (J_[e.place].bounded() && X[e.column].bounded());
  };
  for (std::size_t i = 0; i < n_; ++i) {
    if (known_[i] == 0 || !equation(X, i) || !std::ranges::all_of(rows_[i], bounded)) continue;
    for (const Entry& e : rows_[i]) {
      const Interval& x = X[e.column];
      if (width(x) <= narrow * (1 + x.magnitude())) continue;
      if (!x.bounded()) continue;
      const double smear = width(J_[e.place]) * width(x);  // what is linear is contracted as well unhalved
      if (smear > most) most = smear, best = e.column;
    }
  }
  return best;
}

int Parts::run(lcp::Deadline deadline) {
  Part whole(n_);
  for (std::size_t i = 0; i < n_; ++i)
    whole[i] = {box_.lower[static_cast<Index>(i)], box_.upper[static_cast<Index>(i)]};
  std::vector<Part> left{std::move(whole)};
  int parts = 0;
  while (!left.empty()) {
    Part X = std::move(left.back());
    left.pop_back();
    if (refuted(X)) {
      ++parts;
      continue;
    }
    const std::size_t j = widest(X);
    if (j == n_ || entries_ > most_entries || std::chrono::steady_clock::now() >= deadline) return 0;
    const double half = middle(X[j]);
    Part upper = X;
    upper[j].lower = half;
    X[j].upper = half;
    left.push_back(std::move(upper));
    left.push_back(std::move(X));
  }
  return parts;
}

}  // namespace

int no_solution_in_parts(const Mcp& mcp, double tol, lcp::Deadline deadline) {
  const Enclosure* enclosure = mcp.enclosure();
  return enclosure == nullptr || mcp.size() == 0 ? 0 : Parts(mcp, *enclosure, tol).run(deadline);
}

}  // namespace perp::ncp
