// SPDX-License-Identifier: Apache-2.0
#include "lcp/classes/classify.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "lcp/classes/classify_parts.hpp"
#include "lcp/exact_sum.hpp"
#include "lcp/linalg/block_triangular.hpp"
#include "lcp/lu/sparse_lu.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {
namespace {

Property yes(std::string reason, bool rounded = false) {
  if (rounded) reason.insert(0, to_rounding);
  return {.answer = Answer::Yes, .reason = std::move(reason), .to_rounding = rounded};
}
Property no(std::string reason, std::vector<Index> indices = {}, Vec vector = {}) {
  return {
      .answer = Answer::No, .reason = std::move(reason), .indices = std::move(indices), .vector = std::move(vector)};
}
/// What a class follows from; to rounding if that is.
Property follows(const Property& from, std::string reason) { return yes(std::move(reason), from.to_rounding); }
void settle(Property& property, Property found) {
  if (property.answer == Answer::NotDecided) property = std::move(found);
}
std::string place(Index i, Index j) { return "(" + std::to_string(i + 1) + ", " + std::to_string(j + 1) + ")"; }

constexpr const char* magnitudes = "the entries of M are of too many magnitudes";

/// Everything about one matrix, in the order from cheap to costly.
class Classifier {
 public:
  Classifier(const SpMat& M, const ClassifyOptions& options, bool wide, Diagnosis& d)
      : M_(M),
        options_(options),
        d_(d),
        n_(M.rows()),
        Mt_(M.transpose()),
        S_(M_ + Mt_),
        diagonal_(M.diagonal()),
        wide_(wide) {}

  void run() {
    symmetric();
    z();
    dominant();
    components();
    h_plus();
    classify_definite(M_, Mt_, S_, options_, d_);
    p();
    m();
    copositive();
    p0();
  }

 private:
  void symmetric() {
    const SpMat D = M_ - Mt_;
    bool exactly = true;
    for (Index j = 0; j < n_; ++j)
      for (SpMat::InnerIterator it(D, j); it; ++it) {
        if (it.value() == 0) continue;
        exactly = false;
        const Index i = it.row();
        const double size = std::max({std::abs(M_.coeff(i, j)), std::abs(M_.coeff(j, i)),
                                      std::sqrt(std::abs(diagonal_[i])) * std::sqrt(std::abs(diagonal_[j]))});
        if (std::abs(it.value()) > options_.tol * size) {
          d_.symmetric = no("M differs from M' at " + place(i, j), {i, j});
          return;
        }
      }
    d_.symmetric = yes(exactly ? "exactly" : "to rounding");
    d_.symmetric.to_rounding = !exactly;
  }

  void z() {
    for (Index j = 0; j < n_; ++j)
      for (SpMat::InnerIterator it(M_, j); it; ++it)
        if (it.row() != j && it.value() > 0) {
          d_.z = no("M is positive at " + place(it.row(), j), {it.row(), j});
          return;
        }
    d_.z = yes("no positive entry off the diagonal");
  }

  void dominant() {
    rows_ = dominance_of_columns(Mt_, options_.tol);
    columns_ = dominance_of_columns(M_, options_.tol);
    const auto tell = [&](bool Dominance::*holds, Index Dominance::*row) {
      if (rows_.*holds) return yes("in rows");
      if (columns_.*holds) return yes("in columns");
      if (rows_.overflow || columns_.overflow) return Property{.reason = magnitudes};
      const Index i = rows_.*row;
      return no("neither in row " + std::to_string(i + 1) + " nor in every column", {i});
    };
    d_.strictly_dominant = tell(&Dominance::exactly_strict, &Dominance::not_strict);
    d_.dominant = tell(&Dominance::weak, &Dominance::violated);
    if (d_.dominant.yes() && !rows_.exactly_weak && columns_.exactly_weak) d_.dominant = yes("in columns");
    if (d_.dominant.yes() && !exactly_dominant()) d_.dominant = yes(d_.dominant.reason, true);
  }

  bool exactly_dominant() const { return rows_.exactly_weak || columns_.exactly_weak; }

  void components() {
    parts_ = strong_components({.M = M_, .q = Vec::Zero(n_), .box = Box::free(n_)});
    component_.assign(at(n_), 0);
    for (Index k = 0; k < parts_.count(); ++k)
      for (Index s = parts_.first[at(k)]; s < parts_.first[at(k + 1)]; ++s)
        component_[at(parts_.order[at(s)])] = static_cast<int>(k);
  }

  void h_plus() {
    Index worst = 0;
    if (n_ > 0 && diagonal_.minCoeff(&worst) <= 0) {
      d_.h_plus = no("the diagonal entry " + std::to_string(worst + 1) + " is not positive", {worst});
      return;
    }
    if (rows_.exactly_strict || columns_.exactly_strict) {
      d_.h_plus = yes("strictly diagonally dominant with positive diagonal");
    } else if ((rows_.exactly_weak && chained(rows_, M_)) || (columns_.exactly_weak && chained(columns_, Mt_))) {
      d_.h_plus = yes("irreducibly (or weakly chained) diagonally dominant with positive diagonal");
    } else if (wide_) {
      d_.h_plus.reason = magnitudes;
    } else {
      by_jacobi_radius();
      if (d_.h_plus.answer == Answer::NotDecided) by_comparison_matrix();
    }
  }

  void by_jacobi_radius() {
    radius_ = jacobi_radius(M_, component_, options_.sweeps, options_.tol);
    bool all_below = true;
    for (Index k = 0; k < parts_.count(); ++k) {
      const double lower = radius_.lower[at(k)];
      all_below = all_below && radius_.upper[at(k)] < 1 - options_.tol;
      if (lower != 1 && lower <= 1 + options_.tol) continue;
      Vec v = Vec::Zero(n_);
      for (Index s = parts_.first[at(k)]; s < parts_.first[at(k + 1)]; ++s)
        v[parts_.order[at(s)]] = radius_.x[parts_.order[at(s)]];
      d_.h_plus = no("M_ii v_i <= sum_j |M_ij| v_j for all i and a v >= 0", {}, v);
      return;
    }
    if (all_below) d_.h_plus = yes("strictly diagonally dominant after column scaling, with positive diagonal");
  }

  /// C = (M_ii, -|M_ij|) is a nonsingular M-matrix iff C x = e has a solution x > 0.
  void by_comparison_matrix() {
    if (n_ > options_.factor_to) {
      d_.h_plus.reason = "the cheap tests do not decide, and n is beyond factor_to";
      return;
    }
    SpMat C = M_;
    for (Index j = 0; j < n_; ++j)
      for (SpMat::InnerIterator it(C, j); it; ++it)
        it.valueRef() = it.row() == j ? it.value() : -std::abs(it.value()) / diagonal_[it.row()];
    for (Index i = 0; i < n_; ++i) C.coeffRef(i, i) = 1;
    SparseLu lu;
    Vec x = Vec::Zero(n_);
    if (lu.factor(C) == LuStatus::Ok) lu.solve_refined(Vec::Ones(n_), x);
    if (x.allFinite() && n_ > 0 && x.minCoeff() > 0 &&
        (C * x).minCoeff() > options_.tol * static_cast<double>(n_) * x.maxCoeff())
      d_.h_plus = yes("strictly diagonally dominant after column scaling, with positive diagonal");
    else if (x.allFinite() && x.minCoeff() < 0 && lu.rcond() > 1e-12)
      d_.h_plus = no("the comparison matrix has no nonnegative inverse");
    else
      d_.h_plus.reason = "the comparison matrix is singular to rounding";
  }

  void p() {
    if (!small_minors()) return;
    if (d_.positive_definite.yes())
      d_.p = yes("positive definite");
    else if (d_.h_plus.yes())
      d_.p = yes("an H-matrix with positive diagonal");
    else if (d_.z.yes() && d_.h_plus.no())
      d_.p = no("Z but not a nonsingular M-matrix", {}, d_.h_plus.vector);
    else
      by_components();
  }

  /// Minors of one and two rows. False: one refutes P.
  bool small_minors() {
    const auto refute = [&](std::vector<Index> alpha, long double minor, bool negative) {
      if (d_.p.no() && (!negative || d_.p0.no())) return;
      std::ostringstream reason;
      reason << "a principal minor is " << minor;
      settle(d_.p, no(reason.str(), alpha));
      if (negative) settle(d_.p0, no(reason.str(), alpha));
    };
    for (Index i = 0; i < n_; ++i)
      if (diagonal_[i] <= 0) refute({i}, diagonal_[i], diagonal_[i] < 0);
    for (Index j = 0; j < n_; ++j)
      for (SpMat::InnerIterator a(M_, j), b(Mt_, j); a && b;) {  // M_ij and M_ji
        if (a.row() < b.row()) {
          ++a;
        } else if (b.row() < a.row()) {
          ++b;
        } else {
          if (a.row() < j) {
            const auto [one, two] = products(diagonal_[j], diagonal_[a.row()], a.value(), b.value());
            const auto allowance = options_.tol * (std::abs(one) + std::abs(two));
            ExactSum minor;  // where rounding may decide
            if (one - two <= allowance) {
              minor.add_product(diagonal_[j], diagonal_[a.row()]);
              minor.add_product(-a.value(), b.value());
            }
            const bool beyond = one - two < -allowance;
            if (beyond || (one - two <= allowance && minor.exact() && minor.sign() <= 0))
              refute({a.row(), j}, one - two, beyond);
          }
          ++a;
          ++b;
        }
      }
    return d_.p.answer == Answer::NotDecided;
  }

  /// a b and c d, in extended precision only where they may leave the range of numbers, or vanish.
  std::pair<long double, long double> products(double a, double b, double c, double d) const {
    if (wide_) return {static_cast<long double>(a) * b, static_cast<long double>(c) * d};
    return {a * b, c * d};
  }

  /// The principal minors of M are products of those of its strongly connected diagonal blocks.
  void by_components() {
    bool hidden = false;
    for (Index k = 0; k < parts_.count(); ++k) {
      const std::vector<Index> alpha = members(k);
      if (alpha.size() == 1) continue;  // a positive diagonal entry
      if (!radius_.upper.empty() && radius_.upper[at(k)] < 1 - options_.tol) continue;
      const auto size = static_cast<Index>(alpha.size());
      if (size > options_.dense_to && size > options_.minors_to) {
        d_.p.reason = "a strongly connected block of " + std::to_string(size) + " rows is beyond minors_to";
        return;
      }
      const Eigen::MatrixXd A = block(alpha);
      Property definite;
      Property semidefinite;
      dense_definite(SpMat((A + A.transpose()).sparseView()), options_.tol, definite, semidefinite);
      if (definite.yes()) continue;
      if (size > options_.minors_to) {
        d_.p.reason = "a strongly connected block of " + std::to_string(size) + " rows is beyond minors_to";
        return;
      }
      const MinorTest test = p_by_minors(A, options_.tol);
      if (test.answer == Answer::No) return refute_by(test, alpha);
      hidden = hidden || test.answer == Answer::NotDecided;
    }
    if (hidden)
      d_.p.reason = "rounding hides the sign of a principal minor";
    else
      d_.p = yes("every strongly connected diagonal block is P");
  }

  void refute_by(const MinorTest& test, const std::vector<Index>& alpha) {
    std::vector<Index> minor;
    minor.reserve(test.alpha.size());
    for (const Index i : test.alpha) minor.push_back(alpha[at(i)]);
    settle(d_.p, no(test.zero ? "a principal minor is 0" : "a principal minor is negative", minor));
    if (!test.zero) settle(d_.p0, no("a principal minor is negative", minor));
  }

  void m() {
    if (d_.z.no())
      d_.m = no("not Z", d_.z.indices);
    else if (d_.p.no())
      d_.m = no("not P", d_.p.indices, d_.p.vector);
    else if (d_.p.yes())
      d_.m = yes("Z and P");
    else
      d_.m.reason = d_.p.reason;
  }

  void p0() {
    if (d_.p0.no()) return;
    if (d_.p.yes()) return settle(d_.p0, yes("P"));
    if (d_.positive_semidefinite.yes())
      return settle(d_.p0, follows(d_.positive_semidefinite, "positive semidefinite"));
    if (d_.dominant.yes()) return settle(d_.p0, follows(d_.dominant, "diagonally dominant with nonnegative diagonal"));
    const bool singular_m = !radius_.upper.empty() &&
                            std::all_of(radius_.upper.begin(), radius_.upper.end(), [](double u) { return u <= 1; });
    if (singular_m) return settle(d_.p0, yes("the comparison matrix is an M-matrix", true));
    bool rounded = false;
    for (Index k = 0; k < parts_.count(); ++k) {
      const std::vector<Index> alpha = members(k);
      if (static_cast<Index>(alpha.size()) > options_.p0_to) {
        d_.p0.reason = "a strongly connected block of " + std::to_string(alpha.size()) + " rows is beyond p0_to";
        return;
      }
      const MinorTest test = p0_by_minors(block(alpha), options_.tol);
      if (test.answer == Answer::No) return refute_by(test, alpha);
      if (test.answer == Answer::NotDecided) {
        d_.p0.reason = magnitudes;
        return;
      }
      rounded = rounded || test.to_rounding;
    }
    d_.p0 = yes("by all principal minors of the strongly connected blocks", rounded);
  }

  void copositive() {
    const auto refute = [&](const Vec& v) {
      const Form form = quadratic_form(S_, v, options_.tol);
      if (form.negative())
        for (Property* property : {&d_.copositive, &d_.strictly_copositive, &d_.copositive_plus})
          settle(*property, no("v'Mv < 0 for a v >= 0", {}, v));
      else if (form.value == 0)
        settle(d_.strictly_copositive, no("v'Mv = 0 for a v >= 0", {}, v));
      if (form.value == 0 && !(S_ * v).isZero(0))
        settle(d_.copositive_plus, no("v'Mv = 0 but (M + M')v != 0 for a v >= 0", {}, v));
    };
    if (d_.positive_definite.yes()) settle(d_.strictly_copositive, yes("positive definite"));
    if (d_.positive_semidefinite.yes())
      settle(d_.copositive_plus, follows(d_.positive_semidefinite, "positive semidefinite"));
    for (const Property* property : {&d_.positive_definite, &d_.positive_semidefinite})
      if (const Vec& v = property->vector; property->no() && v.size() == n_) {
        if (v.minCoeff() >= 0) refute(v);
        if (v.maxCoeff() <= 0) refute(-v);
      }
    for (Index i = 0; i < n_ && d_.copositive.answer == Answer::NotDecided; ++i) {
      const bool known = diagonal_[i] == 0 && d_.strictly_copositive.no() &&  // e_i'M e_i = 0 is news once
                         (d_.copositive_plus.answer != Answer::NotDecided || S_.col(i).squaredNorm() == 0);
      if (diagonal_[i] <= 0 && !known) refute(Vec::Unit(n_, i));
      if (diagonal_[i] < 0) continue;
      for (SpMat::InnerIterator it(S_, i); it; ++it) {  // the minimum over v_i e_i + v_j e_j where M_ij + M_ji < 0
        const Index j = it.row();
        const double a = 2 * diagonal_[i];
        const double b = 2 * diagonal_[j];
        if (j <= i || b < 0 || it.value() >= 0) continue;
        if (const auto [square, both] = products(it.value(), it.value(), a, b); square < both) continue;
        Vec v = Vec::Zero(n_);
        v[i] = b > 0 ? b : -it.value();
        v[j] = b > 0 ? -it.value() : a - it.value();
        refute(v);
      }
    }
    const bool nonnegative = std::all_of(S_.valuePtr(), S_.valuePtr() + S_.nonZeros(), [](double s) { return s >= 0; });
    if (nonnegative) settle(d_.copositive, yes("M + M' has no negative entry"));
    if (nonnegative && n_ > 0 && diagonal_.minCoeff() > 0)
      settle(d_.strictly_copositive, yes("M + M' has no negative entry and a positive diagonal"));
    if (d_.strictly_copositive.yes()) settle(d_.copositive_plus, yes("strictly copositive"));
    if (d_.copositive_plus.yes()) settle(d_.copositive, follows(d_.copositive_plus, "copositive-plus"));
    const bool open = d_.copositive.answer == Answer::NotDecided || d_.copositive_plus.answer == Answer::NotDecided ||
                      d_.strictly_copositive.answer == Answer::NotDecided;
    if (!open) return;
    if (n_ <= options_.copositive_to && !wide_) return copositive_by_submatrices(S_, options_, d_);
    for (Property* property : {&d_.copositive, &d_.strictly_copositive, &d_.copositive_plus})
      if (property->answer == Answer::NotDecided)
        property->reason = wide_ ? magnitudes : "n is beyond copositive_to, and the cheap tests do not decide";
  }

  std::vector<Index> members(Index k) const {
    return {parts_.order.begin() + parts_.first[at(k)], parts_.order.begin() + parts_.first[at(k + 1)]};
  }

  Eigen::MatrixXd block(const std::vector<Index>& alpha) {
    for (std::size_t k = 0; k < alpha.size(); ++k) number_[at(alpha[k])] = static_cast<Index>(k);
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(static_cast<Index>(alpha.size()), static_cast<Index>(alpha.size()));
    for (const Index j : alpha)
      for (SpMat::InnerIterator it(M_, j); it; ++it)
        if (component_[at(it.row())] == component_[at(j)]) A(number_[at(it.row())], number_[at(j)]) = it.value();
    return A;
  }

  const SpMat& M_;
  const ClassifyOptions& options_;
  Diagnosis& d_;
  Index n_;
  SpMat Mt_;
  SpMat S_;
  Vec diagonal_;
  bool wide_;  ///< products of entries may overflow, or vanish
  Dominance rows_, columns_;
  Components parts_;
  std::vector<int> component_;
  std::vector<Index> number_ = std::vector<Index>(at(n_));
  JacobiRadius radius_;
};

void check(const SpMat& M, const ClassifyOptions& options) {
  if (M.rows() != M.cols()) refuse_input("classify: M is ", M.rows(), " x ", M.cols(), ", not square");
  for (Index j = 0; j < M.cols(); ++j)
    for (SpMat::InnerIterator it(M, j); it; ++it)
      if (!std::isfinite(it.value())) refuse_input("classify: M of row ", it.row(), ", column ", j, " is ", it.value());
  if (!(options.tol > 0 && options.tol < 1)) refuse_input("classify: tol is ", options.tol, ", not in (0, 1)");
  for (const auto& [name, value] :
       {std::pair{"minors_to", options.minors_to}, {"p0_to", options.p0_to}, {"copositive_to", options.copositive_to}})
    if (value > 30) {
      refuse_input("classify: ", name, " is ", value, "; 2^n minors are too many beyond 30");
    }
}

}  // namespace

std::string_view to_string(Answer answer) {
  using enum Answer;
  static constexpr std::pair<Answer, std::string_view> words[] = {
      {No, "no"}, {Yes, "yes"}, {NotDecided, "not decided"}};
  return word_of(answer, words);
}

Property positive_semidefinite(const SpMat& M, const ClassifyOptions& options) {
  check(M, options);
  const Exponents e = exponents(M);
  const SpMat A = e.extreme() ? centred(M, e) : M;
  const SpMat At = A.transpose();
  const SpMat S = A + At;
  const bool skew = std::all_of(S.valuePtr(), S.valuePtr() + S.nonZeros(), [](double s) { return s == 0; });
  if (skew && M.rows() > 0) return yes("M + M' is diagonally dominant with nonnegative diagonal");
  Diagnosis d;
  classify_definite(A, At, S, options, d);
  return d.positive_semidefinite;
}

Diagnosis classify(const SpMat& M, const ClassifyOptions& options) {
  check(M, options);
  const Exponents e = exponents(M);
  SpMat compressed = e.extreme() ? centred(M, e) : M;
  compressed.makeCompressed();
  Diagnosis d;
  d.size = M.rows();
  Classifier(compressed, options, e.wide(), d).run();
  take_back_rounded_zeros(compressed, options.tol, d);
  if (e.extreme())  // which of the reasons have numbers in them is not known here
    for (const auto& [name, view] : d.all())
      if (view->no()) const_cast<Property*>(view)->reason += text_of(" (in M 2^", centring(e), ")");
  return d;
}

namespace {

Diagnosis classify_in_order(const AffineMcp& problem, const ClassifyOptions& options) {
  const Box& box = problem.box;
  std::vector<Index> kept;
  std::vector<int> number(at(problem.size()), -1);
  Vec sign = Vec::Ones(problem.size());
  bool cone = true;
  bool bounded = true;
  for (Index i = 0; i < problem.size(); ++i) {
    if (box.lower[i] == box.upper[i]) continue;
    number[at(i)] = static_cast<int>(kept.size());
    kept.push_back(i);
    const bool below = std::isfinite(box.lower[i]);
    const bool above = std::isfinite(box.upper[i]);
    if (above && !below) sign[i] = -1;
    cone = cone && below != above;
    bounded = bounded && below && above;
  }
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(at(problem.M.nonZeros()));
  for (const Index j : kept)
    for (SpMat::InnerIterator it(problem.M, j); it; ++it)
      if (const int i = number[at(it.row())]; i >= 0)
        entries.emplace_back(i, number[at(j)], sign[it.row()] * sign[j] * it.value());
  SpMat M(static_cast<Index>(kept.size()), static_cast<Index>(kept.size()));
  M.setFromTriplets(entries.begin(), entries.end());
  Diagnosis d = classify(M, options);
  d.cone = cone;
  d.bounded = bounded;
  for (const auto& [name, view] : d.all()) {
    auto* property = const_cast<Property*>(view);  // of d, which is not const
    for (Index& i : property->indices) i = kept[at(i)];
    if (property->vector.size() != M.rows()) continue;
    Vec v = Vec::Zero(problem.size());
    for (std::size_t k = 0; k < kept.size(); ++k) v[kept[k]] = sign[kept[k]] * property->vector[static_cast<Index>(k)];
    property->vector = std::move(v);
  }
  return d;
}

}  // namespace

Diagnosis classify(const AffineMcp& problem, const ClassifyOptions& options) {
  if (const auto why = problem.invalid()) refuse_input("classify: ", *why);
  std::optional<EquationOrder> order = equation_order(problem.M, problem.box);
  if (!order) return classify_in_order(problem, options);
  Diagnosis d = classify_in_order(order->apply(problem), options);
  d.order = std::move(order);
  return d;
}

}  // namespace perp::lcp
