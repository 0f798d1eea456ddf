// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "lcp/classes/classify_parts.hpp"
#include "lcp/dense_factors.hpp"

namespace perp::lcp {
namespace {

using Dense = Eigen::MatrixXd;

/// The recursion of Tsatsomeros & Li: A is P iff a_11 > 0 and both A without its first row and column and the Schur
/// complement A / a_11 are P. E bounds the terms that A's entries are the sums of.
class PTest {
 public:
  PTest(double tol, Index n) : tol_(tol), taken_(static_cast<std::size_t>(n), 0) {}

  /// False ends the search: a minor <= 0 was found.
  bool run(const Dense& A, const Dense& E, Index first) {
    const Index n = A.rows();
    const double pivot = A(0, 0);
    if (!std::isfinite(pivot) || !std::isfinite(E(0, 0))) {
      hidden_ = true;
      return true;
    }
    if (pivot <= tol_ * E(0, 0)) {
      if (pivot != 0 && pivot >= -tol_ * E(0, 0)) {
        hidden_ = true;
        return true;
      }
      for (Index i = 0; i < first; ++i)
        if (taken_[static_cast<std::size_t>(i)]) found.alpha.push_back(i);
      found.alpha.push_back(first);
      found.zero = pivot == 0;
      return false;
    }
    if (n == 1) return true;
    if (!run(A.bottomRightCorner(n - 1, n - 1), E.bottomRightCorner(n - 1, n - 1), first + 1)) return false;
    const Dense update = A.bottomLeftCorner(n - 1, 1) * A.topRightCorner(1, n - 1) / pivot;
    taken_[static_cast<std::size_t>(first)] = 1;
    const bool rest = run(A.bottomRightCorner(n - 1, n - 1) - update,
                          E.bottomRightCorner(n - 1, n - 1) + update.cwiseAbs(), first + 1);
    taken_[static_cast<std::size_t>(first)] = 0;
    return rest;
  }

  bool hidden() const { return hidden_; }
  MinorTest found;

 private:
  double tol_;
  std::vector<char> taken_;
  bool hidden_ = false;  ///< a pivot whose sign rounding hides, or that overflowed
};

/// Rows and columns scaled by powers of two (one and the same: the minors keep their signs) to a diagonal near one.
Dense balanced(const Dense& A) {
  Vec D = Vec::Ones(A.rows());
  for (Index i = 0; i < A.rows(); ++i)
    if (A(i, i) > 0) D[i] = std::ldexp(1, -std::ilogb(A(i, i)) / 2);
  return D.asDiagonal() * A * D.asDiagonal();
}

std::vector<Index> members(std::uint32_t set) {
  std::vector<Index> alpha;
  for (; set != 0; set &= set - 1) alpha.push_back(std::countr_zero(set));
  return alpha;
}

}  // namespace

MinorTest p_by_minors(const Dense& A, double tol) {
  if (A.rows() == 0) return {.answer = Answer::Yes};
  PTest test(tol, A.rows());
  const Dense B = balanced(A);
  const bool positive = test.run(B, B.cwiseAbs(), 0);
  test.found.answer = !positive ? Answer::No : test.hidden() ? Answer::NotDecided : Answer::Yes;
  return test.found;
}

MinorTest p0_by_minors(const Dense& A, double tol) {
  const Dense B = balanced(A);
  MinorTest found{.answer = Answer::Yes};
  for (std::uint32_t set = 1; set < (1U << static_cast<unsigned>(B.rows())); ++set) {
    const std::vector<Index> alpha = members(set);
    const Eigen::PartialPivLU<Dense> lu(B(alpha, alpha));
    // The determinant against Hadamard's bound, whose rounding it may carry.
    double hadamard = 1;
    for (const Index i : alpha) hadamard *= B.row(i)(alpha).norm();
    const bool zero_row = std::ranges::any_of(alpha, [&](Index i) { return B.row(i)(alpha).isZero(0); });
    if (!std::isfinite(hadamard) || (hadamard < 1e-290 && !zero_row)) return {};
    const double minor = lu.determinant();
    if (minor < -tol * hadamard) return {.answer = Answer::No, .alpha = alpha};
    found.to_rounding = found.to_rounding || (minor < tol * hadamard && !zero_row);
  }
  return found;
}

namespace {

/// One principal submatrix after the other, for the three copositive classes. With S_aa y = e:
///  * S is not copositive iff some S_aa is nonsingular with y < 0: a set alpha minimal with min v'Sv < 0 over the
///    simplex has its minimum inside, where S_aa v = mu e, mu < 0; conversely v = -y has v'Sv = e'y < 0.
///  * A copositive S is not strictly so iff some S_aa has a kernel vector > 0 (the same with mu = 0).
///  * The zeros of a copositive form are sums of minimal zeros, and those are the vectors v > 0 of one-dimensional
///    kernels of S_aa (Hildebrand 2014): S is copositive-plus iff S v = 0 for each of them.
class Copositivity {
 public:
  Copositivity(const SpMat& S, double tol, Diagnosis& d) : S_(S), dense_(S), tol_(tol), d_(d) {}

  void run() {
    for (std::uint32_t set = 1; set < (1U << static_cast<unsigned>(dense_.rows())); ++set)
      if (!look(members(set))) return;
    const std::string checked = "by all principal submatrices";
    if (!near_zero_) settle(d_.strictly_copositive, Answer::Yes, checked);
    for (Property* property : {&d_.copositive, &d_.copositive_plus}) {
      if (property->answer != Answer::NotDecided || (hidden_ && property == &d_.copositive_plus)) continue;
      settle(*property, Answer::Yes, near_zero_ ? std::string(to_rounding) + checked : checked);
      property->to_rounding = near_zero_;
    }
    for (Property* property : {&d_.strictly_copositive, &d_.copositive_plus})
      if (property->answer == Answer::NotDecided) property->reason = "rounding hides whether v'Mv = 0 for a v >= 0";
  }

 private:
  static void settle(Property& property, Answer answer, const std::string& reason, const Vec& v = {}) {
    if (property.answer == Answer::NotDecided) property = {.answer = answer, .reason = reason, .vector = v};
  }

  /// False: not copositive.
  bool look(const std::vector<Index>& alpha) {
    const Dense A = dense_(alpha, alpha);
    Eigen::FullPivLU<Dense> lu(A);
    lu.setThreshold(tol_ * static_cast<double>(A.rows()));
    if (lu.isInvertible()) {
      const Vec y = lu.solve(Vec::Ones(A.rows()));
      if (y.maxCoeff() >= 0) return true;
      const Vec v = whole(alpha, -y / y.cwiseAbs().maxCoeff());
      const Form form = quadratic_form(S_, v, tol_);
      if (form.negative()) {
        for (Property* property : {&d_.copositive, &d_.strictly_copositive, &d_.copositive_plus})
          settle(*property, Answer::No, "v'Mv < 0 for a v >= 0", v);
        return false;
      }
      near_zero_ = hidden_ = true;
      return true;
    }
    const Dense kernel = lu.kernel();
    if (kernel.cols() != 1) return true;
    Index largest = 0;
    kernel.col(0).cwiseAbs().maxCoeff(&largest);
    const Vec v = kernel.col(0) / kernel(largest, 0);
    if (v.minCoeff() <= tol_) return true;
    zero(whole(alpha, v));
    return true;
  }

  /// v >= 0 is a zero of the form, up to rounding.
  void zero(const Vec& v) {
    near_zero_ = true;
    if (quadratic_form(S_, v, tol_).value == 0) settle(d_.strictly_copositive, Answer::No, "v'Mv = 0 for a v >= 0", v);
    const Vec Sv = S_ * v;
    if (Sv.cwiseAbs().maxCoeff() > 1e3 * tol_ * dense_.cwiseAbs().maxCoeff())
      settle(d_.copositive_plus, Answer::No, "v'Mv = 0 but (M + M')v != 0 for a v >= 0", v);
  }

  Vec whole(const std::vector<Index>& alpha, const Vec& part) const {
    Vec v = Vec::Zero(dense_.rows());
    v(alpha) = part;
    return v;
  }

  const SpMat& S_;
  Dense dense_;
  double tol_;
  Diagnosis& d_;
  bool near_zero_ = false;  ///< the form is zero, or nearly, for some v >= 0
  bool hidden_ = false;     ///< its sign is not known there
};

}  // namespace

void copositive_by_submatrices(const SpMat& S, const ClassifyOptions& options, Diagnosis& d) {
  // D S D with a diagonal near one is in the same classes; the witnesses are D v.
  const Vec diagonal = S.diagonal();
  Vec D = Vec::Ones(S.rows());
  for (Index i = 0; i < S.rows(); ++i)
    if (diagonal[i] > 0) D[i] = std::ldexp(1, -std::ilogb(diagonal[i]) / 2);
  SpMat A = S;
  for (Index j = 0; j < A.cols(); ++j)
    for (SpMat::InnerIterator it(A, j); it; ++it) it.valueRef() *= D[it.row()] * D[j];
  Diagnosis found;
  Copositivity(A, options.tol, found).run();
  for (const auto property : {&Diagnosis::copositive, &Diagnosis::strictly_copositive, &Diagnosis::copositive_plus}) {
    if ((d.*property).answer != Answer::NotDecided) continue;
    d.*property = found.*property;
    if ((found.*property).no()) (d.*property).vector = D.cwiseProduct((found.*property).vector);
  }
}

}  // namespace perp::lcp
