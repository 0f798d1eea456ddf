// SPDX-License-Identifier: Apache-2.0
#include "lcp/pivoting/principal_pivoting.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>
#include <utility>

#include "lcp/equilibrate.hpp"
#include "lcp/judge/cell.hpp"
#include "lcp/judge/shared_options.hpp"
#include "lcp/lu/basis_factor.hpp"
#include "lcp/pivoting/standard_form.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {
namespace {

/// Values above minus this, of equilibrated data, are not negative: rounding.
constexpr double not_negative = 1e-11;
/// Entries within this x the largest of their column are zero.
constexpr double smallest_pivot = 1e-9;

/// The system w - M z = q with one basic and one nonbasic variable a pair. The basis matrix has the columns e_k of
/// basic w_k and M_.k of basic z_k, whose unknowns are therefore w_k and -z_k.
class Tableau {
 public:
  Tableau(const StandardForm& form, LuBackend lu)
      : form_(form), factor_(form.M, {.lu = lu}), z_basic_(at(form.size())), position_(at(form.size())) {}

  /// Basic z_k where `inside`, the nonbasic variables at zero. Singular also where that is only hidden by rounding.
  LuStatus start(const std::vector<char>& inside) {
    z_basic_ = inside;
    nonbasic = Vec::Zero(form_.size());
    basis_.resize(inside.size());
    for (Index k = 0; k < form_.size(); ++k) {
      position_[at(k)] = k;
      basis_[at(k)] = column(k, z_basic_[at(k)] != 0);
    }
    const LuStatus status = refactor();
    return status == LuStatus::Ok && factor_.rcond() < 1e-13 ? LuStatus::Singular : status;
  }

  LuStatus refactor() { return factor_.factor(basis_); }
  bool fresh() const { return factor_.updates() == 0; }

  /// The basic values at the present nonbasic ones.
  void evaluate() {
    Vec b = form_.q;
    for (Index k = 0; k < form_.size(); ++k) {
      if (nonbasic[k] == 0) continue;
      if (z_basic_[at(k)] != 0)
        b[k] -= nonbasic[k];
      else
        b += nonbasic[k] * form_.M.col(k);
    }
    basic = by_pair(solve(b));
  }

  /// Column r of the tableau: the growth of the basic variables with n_r.
  Vec column_of(Index r) const {
    const Vec x = solve(dense_column(column(r, z_basic_[at(r)] == 0)));
    return by_pair(z_basic_[at(r)] != 0 ? Vec(-x) : x);
  }

  /// <b_s, n_s>: the nonbasic value of s is to be set by the caller.
  LuStatus pivot(Index s) {
    const Index enters = column(s, z_basic_[at(s)] == 0);
    const LuStatus status = put(position_[at(s)], enters);
    z_basic_[at(s)] ^= 1;
    return status;
  }

  /// <b_s, n_r>, <b_r, n_s>.
  LuStatus pivot(Index s, Index r) {
    for (const auto& [leaves, enters] : {std::pair{s, r}, {r, s}})
      if (const LuStatus status = put(position_[at(leaves)], column(enters, z_basic_[at(enters)] == 0));
          status != LuStatus::Ok && leaves == r)
        return status;
    std::swap(position_[at(s)], position_[at(r)]);
    for (const Index k : {s, r}) z_basic_[at(k)] ^= 1;
    return LuStatus::Ok;
  }

  /// y with  y'w - y'M z = y'q  the row of the tableau of b_r, coefficient +1.
  Vec row_multipliers(Index r) const {
    Vec b = Vec::Unit(form_.size(), position_[at(r)]);
    Vec y(form_.size());
    factor_.btran(b, y);
    for (Index p = 0; p < b.size(); ++p) {
      const Index q = basis_[at(p)];
      b[p] -= q < form_.size() ? form_.M.col(q).dot(y) : y[q - form_.size()];
    }
    Vec dy(form_.size());
    factor_.btran(b, dy);
    if (dy.allFinite()) y += dy;
    return z_basic_[at(r)] != 0 ? Vec(-y) : y;
  }

  /// z of the present values.
  Vec z() const {
    return Vec::NullaryExpr(form_.size(), [this](Index k) { return z_basic_[at(k)] != 0 ? basic[k] : nonbasic[k]; });
  }
  const std::vector<char>& z_basic() const { return z_basic_; }
  int factorizations() const { return factor_.factorizations(); }

  Vec basic;     ///< b_k
  Vec nonbasic;  ///< n_k

 private:
  Index column(Index k, bool z) const { return z ? k : form_.size() + k; }

  Vec dense_column(Index q) const {
    const Index n = form_.size();
    return q < n ? Vec(form_.M.col(q)) : Vec(Vec::Unit(n, q - n));
  }

  /// B^-1 b, refined once.
  Vec solve(const Vec& b) const {
    Vec x(b.size());
    factor_.ftran(b, x);
    Vec dx(b.size());
    factor_.ftran(factor_.residual(b, x), dx);
    return dx.allFinite() ? Vec(x + dx) : x;
  }

  Vec by_pair(const Vec& x) const {
    return Vec::NullaryExpr(form_.size(), [&](Index k) {
      const double value = x[position_[at(k)]];
      return z_basic_[at(k)] != 0 ? -value : value;
    });
  }

  LuStatus put(Index position, Index enters) {
    Vec x(form_.size());
    if (!broken_) factor_.ftran(dense_column(enters), x);
    basis_[at(position)] = enters;
    const bool updated = !broken_ && factor_.replace(position, enters, x) == BasisFactor::Update::Ok;
    if (updated && !factor_.stale()) return LuStatus::Ok;
    const LuStatus status = refactor();
    broken_ = status != LuStatus::Ok;
    return status;
  }

  const StandardForm& form_;
  BasisFactor factor_;
  std::vector<char> z_basic_;
  std::vector<Index> position_;  ///< of b_k in the basis
  std::vector<Index> basis_;
  bool broken_ = false;  ///< between the two halves of a 2 x 2 pivot
};

class PrincipalRun {
 public:
  PrincipalRun(const AffineMcp& problem, In start, const PrincipalPivoting& options, const Limits& limits,
               bool split_free)
      : problem_(problem),
        options_(options),
        limits_(limits),
        scaling_(equilibrate(problem)),
        scaled_(scaling_.apply(problem)),
        form_(scaled_, split_free),
        tableau_(form_, options.lu),
        best_(problem, start) {}

  /// False if the block of the free variables is singular.
  bool enter(In start) {
    const Vec x = form_.to_x(project(problem_.box, start).cwiseQuotient(scaling_.columns));
    std::vector<char> inside = form_.free;
    for (Index k = 0; k < x.size(); ++k)
      if (x[k] > 0) inside[at(k)] = 1;
    entry_ = tableau_.start(inside);
    if (entry_ == LuStatus::Singular) entry_ = tableau_.start(form_.free);
    return entry_ != LuStatus::Singular;
  }

  Result run() {
    if (entry_ != LuStatus::Ok) return singular();
    for (;;) {
      tableau_.evaluate();
      best_.offer(point());
      const Index r = next_pair();
      if (r < 0) return end(Status::Stalled, "no value is negative, but the residual is above the tolerance");
      if (auto stopped = major_cycle(r)) return *stopped;
    }
  }

 private:
  bool negative(double value) const { return value < -not_negative; }
  bool driven_from_below(Index r) const { return negative(tableau_.nonbasic[r]); }  // (B)

  Index next_pair() const {
    for (Index k = 0; k < form_.size(); ++k)
      if (form_.free[at(k)] == 0 && (negative(tableau_.basic[k]) || negative(tableau_.nonbasic[k]))) return k;
    return -1;
  }

  std::optional<Result> major_cycle(Index r) {
    lambda_ = 2 * std::min({-1.0, tableau_.basic.minCoeff(), tableau_.nonbasic.minCoeff()});
    std::unordered_set<std::uint64_t> seen;
    for (bool below = driven_from_below(r);;) {
      if (pivots_ >= options_.max_iterations) return end(Status::IterationLimit, "values are still negative");
      if (const auto reached = limits_.reached()) return end(*reached, "values are still negative");
      const Vec rate = tableau_.column_of(r);
      if (!rate.allFinite() || !tableau_.basic.allFinite()) return end(Status::Singular, "the basis is singular");
      const double zero = smallest_pivot * std::max(1.0, rate.lpNorm<Eigen::Infinity>());
      const auto [s, step] = block(r, below, rate, zero);
      if ((rate[r] < -zero || s < 0) && !tableau_.fresh()) {  // nothing is concluded from updated factors
        if (tableau_.refactor() != LuStatus::Ok) return singular();
        tableau_.evaluate();
        continue;
      }
      if (rate[r] < -zero) return not_sufficient(r);
      if (s < 0) return no_solution(r);
      if (step > 1e-13 * (1 + std::abs(tableau_.nonbasic[r]))) seen.clear();
      if (!seen.insert(key_of(cells())).second) return end(Status::Stalled, "not_negative pivots cycle");
      tableau_.nonbasic[r] += step;
      if (s == r) {
        tableau_.nonbasic[r] = below ? 0 : tableau_.nonbasic[r];
        return below ? std::nullopt : exchange(r);
      }
      const bool at_lambda = negative(tableau_.basic[s]);
      const Vec column = tableau_.column_of(s);
      const double small = smallest_pivot * std::max(1.0, column.lpNorm<Eigen::Infinity>());
      if (column[s] < -small || (column[s] <= small && column[r] <= 0)) {
        if (tableau_.fresh()) return not_sufficient(s);
        tableau_.nonbasic[r] -= step;
        if (tableau_.refactor() != LuStatus::Ok) return singular();
        tableau_.evaluate();
        seen.erase(key_of(cells()));
        continue;
      }
      std::optional<Result> stopped;
      if (column[s] > small) {
        stopped = exchange(s);
      } else {
        stopped = exchange(s, r, tableau_.basic[r] + step * rate[r]);
        below = !below;
      }
      if (stopped) return stopped;
      tableau_.nonbasic[s] = at_lambda ? lambda_ : 0;
      tableau_.evaluate();
      best_.offer(point());
    }
  }

  struct Block {
    Index pair;  ///< -1: none
    double step;
  };
  Block block(Index r, bool below, const Vec& rate, double zero) const {
    Block found{-1, infinity};
    const auto offer = [&](Index k, double step) {
      const double tie = 1e-12 * (1 + step);
      if (found.pair < 0 || step < found.step - tie) found = {k, step};
    };
    if (below)
      offer(r, -tableau_.nonbasic[r]);
    else if (rate[r] > zero)
      offer(r, std::max(0.0, -tableau_.basic[r] / rate[r]));
    for (Index k = 0; k < form_.size(); ++k) {
      if (k == r || form_.free[at(k)] != 0 || rate[k] >= -zero) continue;
      const double value = tableau_.basic[k];
      if (negative(value))
        offer(k, (value - lambda_) / -rate[k]);
      else
        offer(k, std::max(0.0, value) / -rate[k]);
    }
    return found;
  }

  std::optional<Result> exchange(Index s) {
    ++pivots_;
    const LuStatus status = tableau_.pivot(s);
    if (status != LuStatus::Ok) return singular();
    tableau_.nonbasic[s] = 0;
    return std::nullopt;
  }
  std::optional<Result> exchange(Index s, Index r, double leaving) {
    ++pivots_;
    const LuStatus status = tableau_.pivot(s, r);
    if (status != LuStatus::Ok) return singular();
    tableau_.nonbasic[r] = leaving;
    return std::nullopt;
  }

  Result no_solution(Index r) {
    Vec y = tableau_.row_multipliers(r);
    const double rounding = 1e-12 * y.lpNorm<Eigen::Infinity>();
    for (Index k = 0; k < y.size(); ++k)
      if (std::abs(y[k]) <= rounding || (y[k] < 0 && form_.free[at(k)] == 0)) y[k] = 0;
    const Vec certificate =
        exact_certificate(problem_, form_.to_certificate(y).cwiseProduct(scaling_.rows), limits_.tol);
    if (certificate.size() == 0)
      return end(Status::Ray,
                 "the driving variable grows without bound, but its row is no certificate: M is not "
                 "sufficient, or rounding");
    Result result = end(Status::Infeasible, "the driving variable grows without bound");
    if (result.status == Status::Infeasible) result.certificate = certificate;
    return result;
  }

  Result not_sufficient(Index k) {
    return end(Status::NotApplicable,
               text_of("M is not sufficient (so neither P nor positive semidefinite): the pivots of pair ", k + 1,
                       " of the standard form have the wrong sign"));
  }

  Result singular() { return end(Status::Singular, "a basis is singular"); }

  Vec point() const { return form_.to_z(tableau_.z()).cwiseProduct(scaling_.columns); }

  Cells cells() const {
    Cells key(at(form_.size()));
    for (std::size_t k = 0; k < key.size(); ++k) {
      const bool lambda = tableau_.nonbasic[static_cast<Index>(k)] == lambda_;
      key[k] = static_cast<Cell>((tableau_.z_basic()[k] != 0 ? 1 : 0) + (lambda ? 2 : 0));
    }
    return key;
  }

  Result end(Status status, const std::string& what) {
    // The last cell afresh, with refined solves: the pivots' rounding does not matter.
    CellSolver cell(problem_, options_.lu, not_negative);
    if (tableau_.basic.size() == form_.size() && tableau_.basic.allFinite() && status != Status::Singular)
      if (cell.solve(cells_of(problem_.box, point())) == LuStatus::Ok) best_.offer(cell.z());
    Result result = judged(problem_, best_.z(), limits_, status, what);
    result.iterations = pivots_;
    result.factorizations = tableau_.factorizations() + cell.factorizations();
    return result;
  }

  const AffineMcp& problem_;
  const PrincipalPivoting& options_;
  const Limits& limits_;
  Scaling scaling_;
  AffineMcp scaled_;
  StandardForm form_;
  Tableau tableau_;
  Best best_;
  LuStatus entry_ = LuStatus::Ok;
  double lambda_ = 0;
  long pivots_ = 0;
};

}  // namespace

void describe(PrincipalPivoting& m, Fields& f) {
  describe_iterations(m.max_iterations, f);
  describe_lu(m.lu, f);
}

Result principal_pivoting(const AffineMcp& problem, In start, const PrincipalPivoting& options, const Limits& limits) {
  check_input("principal_pivoting", problem, start, limits);
  refuse_invalid("principal_pivoting", options);
  PrincipalRun run(problem, start, options, limits, false);
  if (run.enter(start)) return run.run();
  PrincipalRun split(problem, start, options, limits, true);
  split.enter(start);  // the basis of unit columns at the latest
  return split.run();
}

}  // namespace perp::lcp
