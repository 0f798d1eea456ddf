// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Random contact problems for the tests of Glocker's law.
#include <utility>

#include "contact/model/problem.hpp"
#include "support/matrices.hpp"

namespace perp::contact::test {

using support::Random;

/// W = H'H of m rows (rank at most m), q = H'v + w with w inside the dual cone, so that a solution exists (Acary &
/// Cadoux 2013); `frictionless` of the contacts have mu = 0.
inline Problem solvable_problem(int dimension, Index contacts, Index m, Random& random, double frictionless = 0) {
  const Index n = dimension * contacts;
  support::Dense H = support::Dense::Zero(m, n);
  for (Index i = 0; i < m; ++i)
    for (Index j = 0; j < n; ++j)
      if (random.chance(0.5)) H(i, j) = random.normal();
  Problem problem{.dimension = dimension, .W = {}, .q = H.transpose() * random.normals(m), .mu = Vec(contacts)};
  problem.W = support::Dense(H.transpose() * H).sparseView();
  problem.W.given().makeCompressed();
  for (Index a = 0; a < contacts; ++a) {
    problem.mu[a] = random.chance(frictionless) ? 0 : random.uniform(0.1, 1);
    problem.q[dimension * a] += random.uniform(0.01, 0.5);
  }
  problem.name = "random";
  return problem;
}

/// One contact with W = I: open for q_N >= 0; else r_N = -q_N, and r_T = -q_T if that is in the cone, or
/// -mu r_N q_T / |q_T|, for u_T is along q_T.
inline Problem one_contact(const Vec& q, double mu) {
  Problem problem{.dimension = static_cast<int>(q.size()), .W = SpMat(q.size(), q.size()), .q = q, .mu = Vec(1)};
  problem.W.given().setIdentity();
  problem.mu[0] = mu;
  return problem;
}
inline Vec one_contact_solution(const Vec& q, double mu) {
  Vec r = Vec::Zero(q.size());
  if (q[0] >= 0) return r;
  r[0] = -q[0];
  const Vec q_T = q.tail(q.size() - 1);
  r.tail(q.size() - 1) = -q_T * std::min(1.0, mu * r[0] / std::max(q_T.norm(), 1e-300));
  return r;
}

}  // namespace perp::contact::test
