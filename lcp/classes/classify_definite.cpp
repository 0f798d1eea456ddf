// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <sstream>
#include <vector>

#include "lcp/cholesky/cholesky.hpp"
#include "lcp/classes/classify_parts.hpp"
#include "lcp/dense_factors.hpp"
#include "lcp/linalg/blocks.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {
namespace {

std::string form_reason(long double value, const char* relation) {
  return text_of("v'Mv = ", static_cast<double>(value), relation);
}

void refute(Property& property, const Vec& v, long double value) {
  property = {.answer = Answer::No, .reason = form_reason(value, value < 0 ? " < 0" : ""), .vector = v};
}

/// Takes what v says: a negative form refutes both, an exact zero definiteness. Whether semidefiniteness fell.
bool try_direction(const SpMat& S, const Vec& v, double tol, Diagnosis& d) {
  if (v.size() != S.rows() || !v.allFinite() || v.isZero(0)) return false;
  const Form form = quadratic_form(S, v, tol);
  if (form.not_positive() && !d.positive_definite.no()) refute(d.positive_definite, v, form.value);
  if (form.negative()) refute(d.positive_semidefinite, v, form.value);
  return form.negative();
}

/// D S D with unit diagonal but for a factor in [1, 4): D of powers of two, so without rounding. Pre: S_ii > 0.
Vec unit_scaling(const SpMat& S) {
  const Vec diagonal = S.diagonal();
  return Vec::NullaryExpr(S.rows(),
                          [&](Index i) { return diagonal[i] > 0 ? std::ldexp(1, -std::ilogb(diagonal[i]) / 2) : 1.0; });
}

SpMat scaled(const SpMat& S, const Vec& D) {
  SpMat A = S;
  for (Index j = 0; j < A.cols(); ++j)
    for (SpMat::InnerIterator it(A, j); it; ++it) it.valueRef() *= D[it.row()] * D[j];
  return A;
}

/// What a diagonal entry <= 0 says. Whether semidefiniteness is refuted.
bool diagonal_refutes(const SpMat& S, double tol, Diagnosis& d) {
  const Vec diagonal = S.diagonal();
  const Index n = S.rows();
  for (Index i = 0; i < n; ++i) {
    if (diagonal[i] > 0) continue;
    const bool known = diagonal[i] == 0 && d.positive_definite.no();  // many rows: the vectors would cost n^2
    if (!known && try_direction(S, Vec::Unit(n, i), tol, d)) return true;
    for (SpMat::InnerIterator it(S, i); it; ++it) {
      if (it.row() == i || it.value() == 0) continue;
      // S_ii = 0: (a e_i + e_j)'S(a e_i + e_j) = 2 a S_ij + S_jj.
      Vec v = Vec::Unit(n, it.row());
      v[i] = -(diagonal[it.row()] / std::abs(it.value()) + 1) * (it.value() > 0 ? 1 : -1);
      if (try_direction(S, v, tol, d)) return true;
    }
  }
  return false;
}

void accept_semidefinite(Diagnosis& d, std::string reason, bool rounded = false) {
  if (rounded) reason.insert(0, to_rounding);
  d.positive_semidefinite = {.answer = Answer::Yes, .reason = std::move(reason), .to_rounding = rounded};
}
void accept_definite(Diagnosis& d, const std::string& reason) {
  d.positive_definite = {.answer = Answer::Yes, .reason = reason};
  accept_semidefinite(d, reason);
}

/// Dominance, and whether each component has a strictly dominant row: Gershgorin's theorem, Taussky's corollary.
bool by_dominance(const SpMat& M, const SpMat& Mt, const SpMat& S, const ClassifyOptions& options, Diagnosis& d) {
  const Dominance dominance = dominance_of_columns(S, options.tol);
  if (!dominance.weak) return false;
  if (dominance.strict) {
    accept_definite(d, "M + M' is strictly diagonally dominant with positive diagonal");
    return true;
  }
  const std::string reason = "M + M' is diagonally dominant with nonnegative diagonal";
  const bool surely = dominance.exactly_weak && exact_sum(M, Mt, S);
  accept_semidefinite(d, reason, !surely);
  if (surely && chained(dominance, S)) {
    d.positive_definite = {.answer = Answer::Yes,
                           .reason =
                               "M + M' is irreducibly diagonally dominant (strictly in one row of each "
                               "component) with positive diagonal"};
    return true;
  }
  return false;
}

void by_cholesky(const SpMat& S, const ClassifyOptions& options, Diagnosis& d) {
  const Vec D = unit_scaling(S);
  SpMat A = scaled(S, D);
  const SpMat unshifted = A;
  const double shift = options.tol * static_cast<double>(std::max<Index>(S.rows(), 10));
  Cholesky cholesky;
  const auto factor = [&](double sign) {
    A = unshifted;
    for (Index i = 0; i < A.rows(); ++i) A.coeffRef(i, i) += sign * shift;
    return cholesky.factor(A);
  };
  std::ostringstream reason;
  reason << "Cholesky's factorization of M + M' exists, even with " << shift << " of the diagonal taken away";
  CholeskyStatus status = factor(-1);
  if (status == CholeskyStatus::Ok) return accept_definite(d, reason.str());
  if (status == CholeskyStatus::NotPositiveDefinite) {
    const Vec v = cholesky.failed_direction();
    if (v.size() == S.rows() && try_direction(S, D.cwiseProduct(v), options.tol, d)) return;
    status = factor(1);
    if (status == CholeskyStatus::Ok) {
      reason.str("");
      reason << "Cholesky's factorization of M + M' exists with " << shift << " of the diagonal added";
      if (!d.positive_definite.no()) d.positive_definite.reason = "M + M' is singular to rounding";
      return accept_semidefinite(d, reason.str(), true);
    }
    if (status == CholeskyStatus::NotPositiveDefinite) {
      const Vec w = cholesky.failed_direction();
      if (w.size() == S.rows() && try_direction(S, D.cwiseProduct(w), options.tol, d)) return;
    }
  }
  const std::string why = status == CholeskyStatus::OutOfMemory ? "no memory for Cholesky's factorization of M + M'"
                                                                : "rounding hides the sign of v'Mv";
  for (Property* property : {&d.positive_definite, &d.positive_semidefinite})
    if (property->answer == Answer::NotDecided) property->reason = why;
}

}  // namespace

Form quadratic_form(const SpMat& S, const Vec& v, double tol) {
  long double value = 0;
  long double terms = 0;
  for (Index j = 0; j < S.cols(); ++j) {
    if (v[j] == 0) continue;
    for (SpMat::InnerIterator it(S, j); it; ++it) {
      const long double term =
          static_cast<long double>(it.value()) * static_cast<long double>(v[it.row()]) * static_cast<long double>(v[j]);
      value += term;
      terms += std::abs(term);
    }
  }
  return {value / 2, static_cast<long double>(tol) * terms / 2};
}

void dense_definite(const SpMat& S, double tol, Property& definite, Property& semidefinite) {
  Diagnosis d;
  const Vec D = unit_scaling(S);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(Eigen::MatrixXd(scaled(S, D)));
  const Vec& lambda = solver.eigenvalues();
  const double zero = tol * static_cast<double>(std::max<Index>(S.rows(), 10)) * lambda.cwiseAbs().maxCoeff();
  std::ostringstream reason;
  reason << "the eigenvalues of D(M + M')D, D = diag(M + M')^-1/2 to a power of two, are at least " << lambda[0];
  if (solver.info() != Eigen::Success) {
    definite.reason = semidefinite.reason = "the eigenvalues of M + M' were not found";
    return;
  }
  if (lambda[0] > zero) {
    accept_definite(d, reason.str());
  } else {
    const Vec v = D.cwiseProduct(Vec(solver.eigenvectors().col(0)));
    d.positive_definite.reason = "M + M' is singular to rounding";
    if (!try_direction(S, v, tol, d)) {
      // Kernels of small integer matrices are often small integers: their form is exactly zero.
      Index largest = 0;
      const double scale = v.cwiseAbs().maxCoeff(&largest);
      for (int k = 1; k <= 4; ++k) try_direction(S, (v * (k / scale)).array().round().matrix(), tol, d);
      if (lambda[0] >= -zero && !d.positive_semidefinite.no())
        accept_semidefinite(d, reason.str(), true);
      else if (!d.positive_semidefinite.no())
        d.positive_semidefinite.reason = "rounding hides the sign of v'Mv";
    }
  }
  if (definite.answer == Answer::NotDecided) definite = d.positive_definite;
  if (semidefinite.answer == Answer::NotDecided) semidefinite = d.positive_semidefinite;
}

void classify_definite(const SpMat& M, const SpMat& Mt, const SpMat& S, const ClassifyOptions& options, Diagnosis& d) {
  if (S.rows() == 0) return accept_definite(d, "n = 0");
  if (diagonal_refutes(S, options.tol, d)) return;
  if (by_dominance(M, Mt, S, options, d)) return;
  if (S.diagonal().minCoeff() > 0) {
    const std::vector<int> one(static_cast<std::size_t>(S.rows()), 0);
    const JacobiRadius radius = jacobi_radius(S, one, options.sweeps, options.tol);
    if (radius.upper[0] < 1 - options.tol) return accept_definite(d, "M + M' is an H-matrix with positive diagonal");
  }
  if (S.rows() <= options.dense_to) return dense_definite(S, options.tol, d.positive_definite, d.positive_semidefinite);
  if (S.rows() <= options.factor_to && S.diagonal().minCoeff() > 0) return by_cholesky(S, options, d);
  if (S.rows() <= options.factor_to) {
    // Indices with a zero diagonal have zero rows (diagonal_refutes); Cholesky is asked about the others.
    std::vector<int> place(static_cast<std::size_t>(S.rows()), -1);
    std::vector<Index> kept;
    const Vec diagonal = S.diagonal();
    for (Index i = 0; i < S.rows(); ++i)
      if (diagonal[i] > 0) {
        place[static_cast<std::size_t>(i)] = static_cast<int>(kept.size());
        kept.push_back(i);
      }
    std::vector<Eigen::Triplet<double>> entries;
    for (const Index j : kept)
      for (SpMat::InnerIterator it(S, j); it; ++it)
        if (place[static_cast<std::size_t>(it.row())] >= 0)
          entries.emplace_back(place[static_cast<std::size_t>(it.row())], place[static_cast<std::size_t>(j)],
                               it.value());
    SpMat part(static_cast<Index>(kept.size()), static_cast<Index>(kept.size()));
    part.setFromTriplets(entries.begin(), entries.end());
    Diagnosis inner;
    if (!kept.empty()) by_cholesky(part, options, inner);
    d.positive_semidefinite = inner.positive_semidefinite;
    if (kept.empty()) accept_semidefinite(d, "M + M' = 0");
    if (inner.positive_semidefinite.no()) {
      Vec v = Vec::Zero(S.rows());
      for (std::size_t k = 0; k < kept.size(); ++k)
        v[kept[k]] = inner.positive_semidefinite.vector[static_cast<Index>(k)];
      d.positive_semidefinite.vector = v;
    }
    return;
  }
  for (Property* property : {&d.positive_definite, &d.positive_semidefinite})
    if (property->answer == Answer::NotDecided)
      property->reason = "the cheap tests do not decide, and n is beyond factor_to";
}

namespace {

/// The variables that are not fixed, and in whose rows M + M' has an entry but zero.
std::vector<Index> with_forms(const AffineMcp& problem) {
  const SpMat& M = problem.M;
  const SpMat Mt = M.transpose();
  std::vector<char> has(at(M.rows()), 0);
  for (Index j = 0; j < M.cols(); ++j) {
    if (problem.box.is_fixed(j)) continue;
    SpMat::InnerIterator it(M, j), back(Mt, j);
    while (it || back) {
      const Index i = !back || (it && it.row() < back.row()) ? it.row() : back.row();
      double sum = 0;
      if (it && it.row() == i) sum = it.value(), ++it;
      if (back && back.row() == i) sum += back.value(), ++back;
      if (sum != 0 && !problem.box.is_fixed(i)) has[at(i)] = has[at(j)] = 1;
    }
  }
  std::vector<Index> which;
  for (Index i = 0; i < M.rows(); ++i)
    if (has[at(i)] != 0) which.push_back(i);
  return which;
}

}  // namespace

Property positive_semidefinite(const AffineMcp& problem, const ClassifyOptions& options) {
  SpMat M = principal_block(problem.M, with_forms(problem));
  if (M.rows() == 0) return {.answer = Answer::Yes, .reason = "M + M' = 0"};
  if (const Exponents e = exponents(M); e.extreme()) M = centred(M, e);
  const SpMat Mt = M.transpose();
  Diagnosis d;
  classify_definite(M, Mt, M + Mt, options, d);
  take_back_rounded_zeros(M, options.tol, d);
  return d.positive_semidefinite;
}

}  // namespace perp::lcp
