// SPDX-License-Identifier: Apache-2.0
#include "contact/laws/bilateral.hpp"

#include <new>
#include <stdexcept>
#include <vector>

#include "contact/model/checks.hpp"
#include "lcp/solve/schur.hpp"
#include "lcp/words.hpp"

namespace perp::contact {
namespace {

/// [A B; C D] of sparse blocks.
SpMat blocks(const SpMat& A, const SpMat& B, const SpMat& C, const SpMat& D) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(A.nonZeros() + B.nonZeros() + C.nonZeros() + D.nonZeros()));
  const auto add = [&entries](const SpMat& X, Index row, Index column) {
    for (Index j = 0; j < X.cols(); ++j)
      for (SpMat::InnerIterator it(X, j); it; ++it)
        entries.emplace_back(static_cast<int>(row + it.row()), static_cast<int>(column + j), it.value());
  };
  add(A, 0, 0);
  add(B, 0, A.cols());
  add(C, A.rows(), 0);
  add(D, A.rows(), A.cols());
  SpMat result(A.rows() + C.rows(), A.cols() + B.cols());
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

/// Rows and columns from .. from + size - 1.
SpMat part(const SpMat& S, Index row, Index rows, Index column, Index columns) {
  return S.middleCols(column, columns).middleRows(row, rows);
}

}  // namespace

BilateralContact::BilateralContact(const Global& global, int dimension, Unknowns unknowns)
    : global_(global), dimension_(dimension), unknowns_(unknowns) {
  check_dimension(dimension);
  if (global.H.cols() % dimension != 0) {
    refuse_input("bilateral contact: H has ", global.H.cols(), " columns, no multiple of the dimension ", dimension);
  }
  check(global, global.H.cols());
  H_N_ = normal_columns(global.H, dimension);
  w_N_ = Vec(H_N_.cols());
  for (Index a = 0; a < w_N_.size(); ++a) w_N_[a] = global.w[dimension * a];
  if (unknowns == Unknowns::Velocities)
    in_velocities();
  else
    in_multipliers();
}

void BilateralContact::in_velocities() {
  const Index m = global_.M.rows();
  const Index k = global_.G.cols();
  const Index n = H_N_.cols();
  mlcp_.A = blocks(global_.M, -global_.G, global_.G.transpose(), SpMat(k, k));
  mlcp_.B = SpMat(n, n);
  mlcp_.C = blocks(-H_N_, SpMat(m, 0), SpMat(k, n), SpMat(k, 0));
  mlcp_.D = blocks(H_N_.transpose(), SpMat(n, k), SpMat(0, m), SpMat(0, k));
  mlcp_.a.resize(m + k);
  mlcp_.a << -global_.f, global_.b;
  mlcp_.b = w_N_;
}

void BilateralContact::in_multipliers() {
  const Index k = global_.G.cols();
  const Index n = H_N_.cols();
  const SpMat GH = blocks(global_.G, H_N_, SpMat(0, k), SpMat(0, n));
  lcp::Schur schur = lcp::schur(global_.M, GH, global_.f, 0);
  if (lu_.factor(global_.M) == lcp::LuStatus::OutOfMemory) throw std::bad_alloc();
  if (!schur.regular()) {
    refuse_input("bilateral contact: the inertia M is singular (", lcp::to_string(schur.K->status()),
                 ", reciprocal condition number ", schur.K->rcond(), ")");
  }
  mlcp_.A = part(schur.S, 0, k, 0, k);
  mlcp_.C = part(schur.S, 0, k, k, n);
  mlcp_.D = part(schur.S, k, n, 0, k);
  mlcp_.B = part(schur.S, k, n, k, n);
  mlcp_.a = global_.G.transpose() * schur.x + global_.b;
  mlcp_.b = H_N_.transpose() * schur.x + w_N_;
}

BilateralContact::Point BilateralContact::recover(const lcp::MlcpPoint& point) const {
  if (point.u.size() != mlcp_.a.size() || point.v.size() != mlcp_.b.size()) {
    refuse_input("bilateral contact: the point has ", point.u.size(), " + ", point.v.size(), " entries, not ",
                 mlcp_.a.size(), " + ", mlcp_.b.size());
  }
  Point result;
  result.lambda = point.u.tail(global_.G.cols());
  result.contact.r = Vec::Zero(global_.H.cols());
  for (Index a = 0; a < point.v.size(); ++a) result.contact.r[dimension_ * a] = point.v[a];
  if (unknowns_ == Unknowns::Velocities) {
    result.v = point.u.head(global_.M.rows());
  } else {
    result.v.resize(global_.M.rows());
    lu_.solve_refined(global_.f + global_.G * result.lambda + H_N_ * point.v, result.v);
  }
  result.contact.u = global_.H.transpose() * result.v + global_.w;
  return result;
}

}  // namespace perp::contact
