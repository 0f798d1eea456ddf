// SPDX-License-Identifier: Apache-2.0
#include "lcp/solve/mlcp.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "lcp/words.hpp"

namespace perp::lcp {
namespace {

void check(const char* who, const Mlcp& mlcp) {
  if (const auto why = mlcp.invalid()) refuse_input(who, ": ", *why);
}

void check_length(const char* who, const char* what, Index length, Index wanted) {
  if (length == wanted) return;
  refuse_input(who, ": ", what, " has ", length, " entries, not ", wanted);
}

double norm_inf(const Vec& v) { return v.size() > 0 ? v.lpNorm<Eigen::Infinity>() : 0; }

}  // namespace

std::optional<std::string> Mlcp::invalid() const {
  const Index n = a.size();
  const Index m = b.size();
  const struct {
    const char* name;
    const SpMat& matrix;
    Index rows;
    Index cols;
  } blocks[] = {{"A", A, n, n}, {"B", B, m, m}, {"C", C, n, m}, {"D", D, m, n}};
  for (const auto& block : blocks) {
    if (block.matrix.rows() != block.rows || block.matrix.cols() != block.cols)
      return text_of(block.name, " is ", block.matrix.rows(), " x ", block.matrix.cols(), ", not ", block.rows, " x ",
                     block.cols, " (a has ", n, " entries, b ", m, ")");
    for (Index j = 0; j < block.matrix.cols(); ++j)
      for (SpMat::InnerIterator it(block.matrix, j); it; ++it)
        if (!std::isfinite(it.value())) return text_of(block.name, "(", it.row() + 1, ", ", j + 1, ") is ", it.value());
  }
  for (const auto& [name, vector] : {std::pair<const char*, const Vec&>{"a", a}, {"b", b}})
    for (Index i = 0; i < vector.size(); ++i)
      if (!std::isfinite(vector[i])) return text_of(name, "(", i + 1, ") is ", vector[i]);
  return std::nullopt;
}

AffineMcp to_affine(const Mlcp& mlcp) {
  check("to_affine", mlcp);
  const Index n = mlcp.a.size();
  const Index m = mlcp.b.size();
  AffineMcp problem{.M = SpMat(n + m, n + m), .q = Vec(n + m), .box = Box::free(n + m)};
  problem.q << mlcp.a, mlcp.b;
  problem.box.lower.tail(m).setZero();
  problem.M.reserve(mlcp.A.nonZeros() + mlcp.B.nonZeros() + mlcp.C.nonZeros() + mlcp.D.nonZeros());
  for (Index j = 0; j < n + m; ++j) {
    const SpMat& upper = j < n ? mlcp.A : mlcp.C;
    const SpMat& lower = j < n ? mlcp.D : mlcp.B;
    const Index column = j < n ? j : j - n;
    problem.M.startVec(j);
    for (SpMat::InnerIterator it(upper, column); it; ++it) problem.M.insertBack(it.row(), j) = it.value();
    for (SpMat::InnerIterator it(lower, column); it; ++it) problem.M.insertBack(n + it.row(), j) = it.value();
  }
  problem.M.finalize();
  return problem;
}

MlcpPoint from_affine(const Mlcp& mlcp, In z) {
  check_length("from_affine", "z", z.size(), mlcp.a.size() + mlcp.b.size());
  MlcpPoint point{.u = z.head(mlcp.a.size()), .v = z.tail(mlcp.b.size()), .w = {}};
  point.w = mlcp.D * point.u + mlcp.B * point.v + mlcp.b;
  return point;
}

SchurReduction::SchurReduction(const Mlcp& mlcp, LuBackend lu) : mlcp_(mlcp), lu_(lu) {
  check("SchurReduction", mlcp);
  status_ = lu_.factor(mlcp.A);
  if (status_ != LuStatus::Ok) return;
  rcond_ = mlcp.A.rows() > 0 ? lu_.rcond() : 1;
  status_ = rcond_ < 1e-14 ? LuStatus::Singular : reduce();
}

LuStatus SchurReduction::reduce() {
  const Index n = mlcp_.a.size();
  const Index m = mlcp_.b.size();
  Vec x(n);
  lu_.solve_refined(mlcp_.a, x);
  reduced_.q = mlcp_.b - mlcp_.D * x;
  reduced_.box = Box::nonnegative(m);
  if (!reduced_.q.allFinite()) return LuStatus::NotFinite;
  reduced_.M.resize(m, m);
  Vec column(m);
  for (Index j = 0; j < m; ++j) {
    column.setZero();
    for (SpMat::InnerIterator it(mlcp_.B, j); it; ++it) column[it.row()] = it.value();
    if (SpMat::InnerIterator(mlcp_.C, j)) {
      lu_.solve_refined(Vec(mlcp_.C.col(j)), x);
      column -= mlcp_.D * x;
    }
    if (!column.allFinite()) return LuStatus::NotFinite;
    reduced_.M.startVec(j);
    for (Index i = 0; i < m; ++i)
      if (column[i] != 0) reduced_.M.insertBack(i, j) = column[i];
  }
  reduced_.M.finalize();
  return LuStatus::Ok;
}

const AffineMcp& SchurReduction::problem() const {
  if (status_ != LuStatus::Ok)
    throw std::logic_error("SchurReduction: there is no reduced problem, A is " + std::string(to_string(status_)));
  return reduced_;
}

MlcpPoint SchurReduction::recover(In v) const {
  problem();  // or throws
  check_length("SchurReduction::recover", "v", v.size(), mlcp_.b.size());
  MlcpPoint point{.u = Vec(mlcp_.a.size()), .v = v, .w = {}};
  if (mlcp_.a.size() > 0) lu_.solve_refined(-(mlcp_.C * v + mlcp_.a), point.u);
  point.w = mlcp_.D * point.u + mlcp_.B * point.v + mlcp_.b;
  return point;
}

double residual(const Mlcp& mlcp, const MlcpPoint& point) {
  const Vec equations = mlcp.A * point.u + mlcp.C * point.v + mlcp.a;
  const Vec slack = point.w - (mlcp.D * point.u + mlcp.B * point.v + mlcp.b);
  const Vec complementary = point.v.cwiseMin(point.w);
  if (!equations.allFinite() || !slack.allFinite() || !complementary.allFinite()) return infinity;
  return std::max({norm_inf(equations), norm_inf(slack), norm_inf(complementary)});
}

}  // namespace perp::lcp
