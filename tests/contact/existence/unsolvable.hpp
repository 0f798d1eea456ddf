// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Contact problems without a solution, by construction: a certificate y >= 0 with -W'(y e_N) in K* and q_N.y < 0
/// (contact/existence/infeasible.hpp) is planted first, and all numbers are dyadic with few bits, so that products and
/// sums of doubles are exact. Private to tests/.
#include <algorithm>
#include <string>
#include <vector>

#include "contact/model/problem.hpp"
#include "support/matrices.hpp"

namespace perp::contact::test {

using support::Dense;
using support::Random;

struct Unsolvable {
  Problem problem{};
  Vec y{};  ///< planted
  std::string family{};
};

inline constexpr int unsolvable_families = 8;

namespace unsolvable {

inline double power(Random& random, int most) { return std::ldexp(1.0, random.integer(-most, most)); }
inline double dyadic_mu(Random& random) { return random.integer(1, 8) / 4.0; }

/// A signed permutation: the rotations (and reflections) whose entries are dyadic.
inline Dense turn(int d, Random& random) {
  Dense Q = Dense::Zero(d, d);
  std::vector<int> columns{0, 1, 2};
  columns.resize(static_cast<std::size_t>(d));
  for (int i = d - 1; i > 0; --i)
    std::swap(columns[static_cast<std::size_t>(i)], columns[static_cast<std::size_t>(random.integer(0, i))]);
  for (int i = 0; i < d; ++i) Q(i, columns[static_cast<std::size_t>(i)]) = random.chance(0.5) ? 1 : -1;
  return Q;
}

/// W = H'M^-1 H with entries of H whole and M of powers of two.
inline SpMat delassus(const Dense& H, const Vec& inverse_masses) {
  SpMat W = Dense(H.transpose() * inverse_masses.asDiagonal() * H).sparseView();
  W.makeCompressed();
  return W;
}

/// H of n contacts on m coordinates with H_N y = 0 for the weights of `squeezed` contacts: the last takes up the rest.
inline Dense squeezing(int d, Index n, Index m, Index squeezed, Vec& y, Random& random) {
  Dense H = Dense::Zero(m, d * n);
  for (Index j = 0; j < d * n; ++j)
    for (Index i = 0; i < m; ++i)
      if (random.chance(0.6)) H(i, j) = random.integer(-3, 3);
  y = Vec::Zero(n);
  Vec sum = Vec::Zero(m);
  for (Index a = 0; a + 1 < squeezed; ++a) {
    y[a] = random.integer(1, 4);
    sum += y[a] * H.col(d * a);
  }
  y[squeezed - 1] = 1;
  H.col(d * (squeezed - 1)) = -sum;
  return H;
}

/// One body between walls: unit normals that are opposite, on one line; arms whole numbers, so that W_TT and W_NT are
/// not diagonal; further contacts anywhere on it.
inline Dense between_walls(int d, Index n, Random& random) {
  const int turning = d == 2 ? 1 : 3;
  Dense H = Dense::Zero(d + turning, d * n);
  const Dense Q = turn(d, random);
  for (Index a = 0; a < n; ++a) {
    const Dense R = a < 2 ? Q : turn(d, random);
    Vec arm = Vec::NullaryExpr(3, [&] { return static_cast<double>(random.integer(-2, 2)); });
    if (a < 2) {  // on the line of the normals
      arm.setZero();
      arm.head(d) = (a == 0 ? -1 : random.integer(1, 3)) * R.row(0).transpose();
    }
    for (int k = 0; k < d; ++k) {
      Vec direction = Vec::Zero(3);
      direction.head(d) = (a == 1 && k == 0 ? -1 : 1) * R.row(k).transpose();
      H.block(0, d * a + k, d, 1) = direction.head(d);
      const Eigen::Vector3d moment = Eigen::Vector3d(arm).cross(Eigen::Vector3d(direction));
      if (d == 3)
        H.block(d, d * a + k, 3, 1) = moment;
      else
        H(d, d * a + k) = moment[2];
    }
  }
  return H;
}

/// q = H'v and separating or approaching by some eighths; then q_N of a contact in y so that q_N.y is negative.
inline void set_velocities(Problem& problem, const Vec& y, Random& random) {
  for (double& value : problem.q) value = random.integer(-8, 8) / 8.0;
  const int d = problem.dimension;
  Index last = 0;
  double sum = 0;
  for (Index a = 0; a < y.size(); ++a) {
    sum += y[a] * problem.q[d * a];
    if (y[a] > 0) last = a;
  }
  if (sum >= 0) problem.q[d * last] -= std::ceil((sum + random.integer(1, 4) / 4.0) / y[last]);
}

/// `other`, which does not touch it and is solvable by itself, beside the problem.
inline void append_solvable(Problem& problem, Vec& y, Random& random) {
  const int d = problem.dimension;
  const Index before = problem.q.size();
  const Index more = random.integer(1, 3);
  Dense W = Dense::Zero(before + d * more, before + d * more);
  W.topLeftCorner(before, before) = Dense(problem.W.matrix());
  W.bottomRightCorner(d * more, d * more).diagonal().setConstant(power(random, 3));
  Vec q(before + d * more);
  q.head(before) = problem.q;
  for (Index i = before; i < q.size(); ++i) q[i] = random.integer(-4, 4) / 4.0;
  Vec mu(problem.mu.size() + more);
  mu.head(problem.mu.size()) = problem.mu;
  for (Index a = problem.mu.size(); a < mu.size(); ++a) mu[a] = dyadic_mu(random);
  y.conservativeResize(mu.size());
  y.tail(more).setZero();
  problem.W = W.sparseView();
  problem.W.given().makeCompressed();
  problem.q = q;
  problem.mu = mu;
}

/// Row of the last contact in y changed so that -W'(y e_N) is in K*, on its border where `border` (2D only: |g_T| is
/// dyadic there), by eighths inside else. y of that contact is 1.
inline void push_into_cone(Dense& W, const Problem& problem, const Vec& y, Index last, bool border, Random& random) {
  const int d = problem.dimension;
  for (Index b = 0; b < problem.contacts(); ++b) {
    Vec g = Vec::Zero(d);
    for (Index a = 0; a < y.size(); ++a)
      for (int k = 0; k < d; ++k) g[k] += y[a] * W(d * a, d * b + k);
    const double tangential = d == 2 ? std::abs(g[1]) : std::abs(g[1]) + std::abs(g[2]);  // at least |g_T|
    const double room = border ? 0 : random.integer(1, 8) / 8.0;
    W(d * last, d * b) -= g[0] + problem.mu[b] * tangential + room;
  }
}

}  // namespace unsolvable

/// The k-th problem of the seed: families in turn, 2D and 3D, 1 to 30 contacts.
inline Unsolvable make_unsolvable(int k, Random& random) {
  using namespace unsolvable;
  Unsolvable out;
  Problem& problem = out.problem;
  const int family = k % unsolvable_families;
  const int d = problem.dimension = random.chance(0.5) ? 2 : 3;
  const Index n = family == 0          ? random.integer(1, 6)
                  : random.chance(0.3) ? random.integer(2, 30)
                                       : random.integer(2, 8);
  problem.mu = Vec::NullaryExpr(n, [&] { return random.chance(0.2) ? 0.0 : dyadic_mu(random); });
  problem.q = Vec::Zero(d * n);
  const auto masses = [&](Index m, int most) { return Vec(Vec::NullaryExpr(m, [&] { return power(random, most); })); };
  switch (family) {
    case 0: {  // contacts that nothing moves
      out.family = "W = 0";
      Dense W = Dense::Zero(d * n, d * n);
      const Index still = random.integer(0, static_cast<int>(n) - 1);
      if (random.chance(0.5))
        for (Index i = 0; i < d * n; ++i)
          if (i / d != still) W(i, i) = power(random, 4);
      problem.W = W.sparseView();
      problem.W.given().makeCompressed();
      out.y = Vec::Unit(n, still);
      break;
    }
    case 1: {
      out.family = "between walls";
      const Dense H = between_walls(d, n, random);
      Vec inverse = masses(H.rows(), 10);
      inverse.head(d).setConstant(inverse[0]);
      problem.W = delassus(H, inverse);
      out.y = Vec::Zero(n);
      out.y.head(2).setOnes();
      break;
    }
    case 2: {
      out.family = "squeezed by several, mass ratios";
      const Index squeezed = random.integer(2, static_cast<int>(std::min<Index>(n, 6)));
      const Index m = random.integer(2, static_cast<int>(d * n));
      problem.W = delassus(squeezing(d, n, m, squeezed, out.y, random), masses(m, 8));
      break;
    }
    case 3: {
      out.family = "no friction";
      const Index m = random.integer(1, static_cast<int>(d * n));
      problem.W = delassus(squeezing(d, n, m, n, out.y, random), masses(m, 3));
      problem.mu.setZero();
      break;
    }
    case 4: {  // W of rank one or two, q out of its range
      out.family = "low rank";
      const Index m = random.integer(1, 2);
      problem.W = delassus(squeezing(d, n, m, std::min<Index>(n, m + 1), out.y, random), masses(m, 2));
      break;
    }
    case 5:
    case 6: {
      const bool border = family == 6 && d == 2;
      out.family = border ? "unsymmetric, on the border of K*" : "unsymmetric";
      Dense W =
          Dense::NullaryExpr(d * n, d * n, [&] { return random.chance(0.5) ? random.integer(-2, 3) / 2.0 : 0.0; });
      out.y = Vec::Zero(n);
      const Index used = random.integer(1, static_cast<int>(std::min<Index>(n, 10)));
      for (Index a = 0; a < used; ++a) out.y[a] = random.integer(1, 3);
      out.y[used - 1] = 1;
      push_into_cone(W, problem, out.y, used - 1, border, random);
      problem.W = W.sparseView();
      problem.W.given().makeCompressed();
      break;
    }
    case 7: {  // contact a pushes bodies a - 1 and a apart; the first and the last are walls
      out.family = "a row of bodies between walls";
      Dense H = Dense::Zero(d * (n - 1), d * n);
      const Dense Q = turn(d, random);
      for (Index a = 0; a < n; ++a) {
        if (a > 0) H.block(d * (a - 1), d * a, d, d) = -Q;
        if (a + 1 < n) H.block(d * a, d * a, d, d) = Q;
      }
      Vec inverse(H.rows());
      for (Index body = 0; body + 1 < n; ++body) inverse.segment(d * body, d).setConstant(power(random, 10));
      problem.W = delassus(H, inverse);
      out.y = Vec::Ones(n);
      break;
    }
    default:
      break;
  }
  set_velocities(problem, out.y, random);
  if (random.chance(0.25)) append_solvable(problem, out.y, random);
  problem.name = out.family + " " + std::to_string(k);
  return out;
}

}  // namespace perp::contact::test
