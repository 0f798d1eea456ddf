// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Small random problems of many classes - degenerate, infeasible, of integers, badly scaled - for campaigns over
/// methods.
#include <cmath>

#include "support/matrices.hpp"

namespace perp::support {

/// A dense P-matrix: positive definite plus skew.
inline SpMat dense_p(Index n, Random& random) {
  const Dense A = random.normals(n, n);
  const Dense S = random.normals(n, n);
  return sparse(A * A.transpose() + 0.1 * Dense::Identity(n, n) + S - S.transpose());
}

/// One small problem of a class chosen by k; names in the order of the cases.
inline AffineMcp campaign_problem(int k, Random& random) {
  const Index n = random.integer(1, 8);
  AffineMcp p{SpMat(n, n), random.normals(n), Box::nonnegative(n)};
  switch (k % 8) {
    case 0:  // any matrix
      p.M = sparse(random.normals(n, n));
      break;
    case 1:
      p.M = dense_p(n, random);
      break;
    case 2:  // integers: ties, singular cells
      p.M = sparse(Dense::NullaryExpr(n, n, [&](Index, Index) { return random.integer(-2, 2); }));
      p.q = Vec::NullaryExpr(n, [&](Index) { return random.integer(-2, 2); });
      break;
    case 3:  // skew with integers: linear programs, often infeasible or unbounded
      p.M = sparse(Dense::NullaryExpr(n, n, [&](Index, Index) { return random.integer(-1, 1); }));
      p.M = SpMat(p.M - SpMat(p.M.transpose()));
      p.q = Vec::NullaryExpr(n, [&](Index) { return random.integer(-2, 1); });
      break;
    case 4:  // badly scaled rows and columns of a P-matrix
    case 5: {
      const auto scales = [&] {
        return Vec(Vec::NullaryExpr(n, [&](Index) { return std::pow(10, random.uniform(-8, 8)); }));
      };
      const Vec rows = scales();
      p.M =
          rows.asDiagonal() * (k % 8 == 4 ? dense_p(n, random) : sparse(random.normals(n, n))) * scales().asDiagonal();
      p.q = rows.asDiagonal() * p.q;
      break;
    }
    case 6:  // rank one or zero
      p.M = sparse(random.integer(0, 2) * random.normals(n, 1) * random.normals(1, n));
      break;
    default:  // dependent rows, with a q that may contradict them
      p.M = sparse(random.normals(n, 2) * random.normals(2, n));
      if (random.chance(0.5)) p.q = -(p.M * random.normals(n).cwiseMax(0));
  }
  if (random.chance(0.5)) p.box = mixed_box(n, random);
  return p;
}

}  // namespace perp::support
