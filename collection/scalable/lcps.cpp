// SPDX-License-Identifier: Apache-2.0
/// Linear complementarity problems 0 <= z _|_ M z + q >= 0 of the literature.
#include <cmath>

#include "collection/base/build.hpp"
#include "collection/models/problems.hpp"
#include "collection/scalable/generators.hpp"

namespace perp::ncp::collection {

namespace {

/// LCP(q, M) with M_ij = entry(i, j), zeros left out; q = -e if none is given.
template <class Entry>
Problem lcp(const std::string& name, Index n, Entry entry, const Vec& q = {}) {
  require_at_least(name, "n", n, 1);
  std::vector<Eigen::Triplet<double>> entries;
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      if (const double value = entry(i, j); value != 0) entries.emplace_back(i, j, value);
  SpMat M(n, n);
  M.setFromTriplets(entries.begin(), entries.end());
  Problem p;
  p.mcp = make_affine({name, Box::nonnegative(n), indexed("z", n)}, M, q.size() == n ? q : Vec(-Vec::Ones(n)));
  p.starts = {Vec::Zero(n), Vec::Ones(n), Vec::Constant(n, 10)};
  return p;
}

Problem with_unique(Problem p, std::string label, Vec solution, double tol) {
  p.solutions = {{std::move(label), std::move(solution), tol}};
  p.solutions_complete = true;
  return p;
}

/// M = tridiag(below, 4, above), a P-matrix; if M z = e has a positive solution it is the one of the LCP.
Problem tridiagonal(const std::string& name, Index n, double below, double above) {
  require_at_least(name, "n", n, 1);
  std::vector<Eigen::Triplet<double>> entries;
  for (Index i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 4.0);
    if (i > 0) entries.emplace_back(i, i - 1, below);
    if (i + 1 < n) entries.emplace_back(i, i + 1, above);
  }
  SpMat M(n, n);
  M.setFromTriplets(entries.begin(), entries.end());
  // Thomas' algorithm; diagonally dominant, so stable without pivoting.
  Vec diagonal = Vec::Constant(n, 4), z = Vec::Ones(n);
  for (Index i = 1; i < n; ++i) {
    diagonal[i] -= below * above / diagonal[i - 1];
    z[i] -= below * z[i - 1] / diagonal[i - 1];
  }
  for (Index i = n - 1; i >= 0; --i) z[i] = (z[i] - (i + 1 < n ? above * z[i + 1] : 0)) / diagonal[i];
  Problem p;
  p.mcp = make_affine({name, Box::nonnegative(n), indexed("z", n)}, M, -Vec::Ones(n));
  p.starts = {Vec::Zero(n), Vec::Ones(n), Vec::Constant(n, 10)};
  return with_unique(std::move(p), "M z = e", std::move(z), 1e-14);
}

}  // namespace

Problem murty(Index n) {
  return with_unique(lcp("murty", n, [](Index i, Index j) { return i == j  ? 1
                                                                   : i < j ? 2
                                                                           : 0; }), "e_n",
                     Vec::Unit(n, n - 1), 0);
}

Problem murty_lower(Index n) {
  return with_unique(lcp("murty-lower", n, [](Index i, Index j) { return i == j  ? 1
                                                                         : i > j ? 2
                                                                                 : 0; }), "e_1",
                     Vec::Unit(n, 0), 0);
}

Problem murty_exp(Index n) {
  require_at_least("murty-exp", "n", n, 1);
  require_at_least("murty-exp", "50 - n", 50 - n, 0);
  Vec q(n);
  double sum = 0;
  for (Index i = 0; i < n; ++i) q[i] = -(sum += std::ldexp(1, static_cast<int>(n - i)));
  Problem p = lcp(
      "murty-exp", n, [](Index i, Index j) { return i == j  ? 1
                                                    : i > j ? 2
                                                            : 0; }, q);
  return with_unique(std::move(p), "2^n e_1", std::ldexp(1, static_cast<int>(n)) * Vec::Unit(n, 0), 0);
}

Problem fathi(Index n) {
  // (L L')_ij = 4 (min(i, j) - 1) + 2 off the diagonal and 4 (i - 1) + 1 on it, counted from 1.
  Problem p =
      lcp("fathi", n, [](Index i, Index j) { return 4 * static_cast<double>(std::min(i, j)) + (i == j ? 1 : 2); });
  return with_unique(std::move(p), "e_1", Vec::Unit(n, 0), 0);
}

Problem ahn(Index n) { return tridiagonal("ahn", n, 1, -2); }
Problem geiger_kanzow(Index n) { return tridiagonal("geiger-kanzow", n, -1, -1); }

/// M = [0 0 -1 -1; 0 0 1 -2; 1 -1 2 -2; 1 2 -2 4], q = (2, 2, -2, -6): the optimality conditions of a convex quadratic
/// program; M is positive semidefinite, not symmetric.
Problem cottle4() {
  const double entries[4][4] = {{0, 0, -1, -1}, {0, 0, 1, -2}, {1, -1, 2, -2}, {1, 2, -2, 4}};
  SpMat M(4, 4);
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i)
      if (entries[i][j] != 0) M.insert(i, j) = entries[i][j];
  Problem p;
  p.mcp = make_affine({"cottle4", Box::nonnegative(4), indexed("z", 4)}, M, vec({2, 2, -2, -6}));
  p.starts = {Vec::Zero(4), Vec::Ones(4), Vec::Constant(4, 10)};
  p.solutions = {{"optimum", vec({2.8, 0, 0.8, 1.2}), 1e-15}};
  return p;
}

/// M = [2 1; 1 2], q = (-5, -6): both rows are active at (4/3, 7/3).
Problem cottle2() {
  Problem p = lcp(
      "cottle2", 2, [](Index i, Index j) { return i == j ? 2 : 1; }, vec({-5, -6}));
  return with_unique(std::move(p), "unique", vec({4.0 / 3, 7.0 / 3}), 1e-15);
}

Problem obstacle_bump_own(Index N) {
  require_at_least("obstacle-bump-own", "N", N, 1);
  constexpr double load = -1e-6;
  const Index n = N * N;
  const double h = 1 / static_cast<double>(N + 1);
  std::vector<Eigen::Triplet<double>> entries;
  Names names;
  Box box = Box::nonnegative(n);
  for (Index j = 0; j < N; ++j)
    for (Index i = 0; i < N; ++i) {
      const Index k = j * N + i;
      entries.emplace_back(k, k, 4.0);
      if (i > 0) entries.emplace_back(k, k - 1, -1.0);
      if (i + 1 < N) entries.emplace_back(k, k + 1, -1.0);
      if (j > 0) entries.emplace_back(k, k - N, -1.0);
      if (j + 1 < N) entries.emplace_back(k, k + N, -1.0);
      const double x = h * static_cast<double>(i + 1) - 0.5;
      const double y = h * static_cast<double>(j + 1) - 0.5;
      box.lower[k] = 0.1 - x * x - y * y;
      names.push_back(element("v", std::to_string(i + 1) + "," + std::to_string(j + 1)));
    }
  SpMat M(n, n);
  M.setFromTriplets(entries.begin(), entries.end());
  Problem p;
  p.starts = {box.lower.cwiseMax(0), Vec::Ones(n), box.lower};
  p.mcp = make_affine({"obstacle-bump-own", box, names}, M, Vec::Constant(n, -load * h * h));
  return p;
}

/// M = [1 -1; -1 1], q = (-1, 1/2): F_1 + F_2 = -1/2 everywhere. M is positive semidefinite, hence copositive-plus.
Problem infeasible_own() {
  Problem p = lcp(
      "infeasible-own", 2, [](Index i, Index j) { return i == j ? 1 : -1; }, vec({-1, 0.5}));
  p.solutions_complete = true;
  p.no_solution = "F_1 + F_2 = -1/2 for all z: certificate y = (1, 1)";
  return p;
}

/// 0 <= x  _|_  (-exp(-x_2), 1 + x_1^2) >= 0.
Problem infeasible_ncp_own() {
  Problem p;
  p.mcp = make_problem({"infeasible-ncp-own", Box::nonnegative(2), indexed("x", 2)}, [](const auto& x, const auto& F) {
    using std::exp;
    F[0] = -exp(-x[1]);
    F[1] = 1 + x[0] * x[0];
  });
  p.starts = {Vec::Zero(2), Vec::Ones(2)};
  p.solutions_complete = true;
  p.no_solution = "F_1 < 0 for all x; F_1 fades as x_2 grows, where F_2 > 0 forbids it";
  return p;
}

Problem of_random(std::string name, RandomLcp made, bool unique, std::string why_none) {
  const Index n = made.problem.size();
  Problem p;
  p.mcp = make_affine({std::move(name), made.problem.box, indexed("z", n)}, made.problem.M, made.problem.q);
  p.starts = {Vec::Zero(n), Vec::Ones(n)};
  if (made.solution.size() > 0) p.solutions = {{"planted", std::move(made.solution), 1e-12}};
  p.no_solution = std::move(why_none);
  p.solutions_complete = unique || !p.no_solution.empty();
  return p;
}

Problem random_bimatrix_own(Index m, Index n, unsigned seed) {
  return of_random("random-bimatrix-own", random_bimatrix(m, n, seed), false);
}
Problem random_copositive_own(Index n, unsigned seed) {
  return of_random("random-copositive-own", random_copositive(n, seed), false);
}
Problem random_copositive_plus_own(Index n, unsigned seed) {
  return of_random("random-copositive-plus-own", random_copositive_plus(n, seed), false);
}
Problem random_degenerate_own(Index n, unsigned seed) {
  return of_random("random-degenerate-own", random_degenerate(n, seed), false);
}
Problem random_p_own(Index n, unsigned seed) { return of_random("random-p-own", random_p_matrix(n, seed), true); }
Problem random_pd_own(Index n, unsigned seed) {
  return of_random("random-pd-own", random_positive_definite(n, seed), true);
}
Problem random_psd_own(Index n, unsigned seed) {
  return of_random("random-psd-own", random_semidefinite(n, seed), false);
}
Problem random_strictly_copositive_own(Index n, unsigned seed) {
  return of_random("random-strictly-copositive-own", random_strictly_copositive(n, seed), false);
}
Problem random_z_own(Index n, unsigned seed) { return of_random("random-z-own", random_z_matrix(n, seed), false); }
Problem infeasible_monotone_own(Index n, unsigned seed) {
  return of_random("infeasible-monotone-own", random_infeasible(n, seed), false, "y = e_1 + e_2 has M'y = 0, q'y = -1");
}
Problem infeasible_row_own(Index n, unsigned seed) {
  return of_random("infeasible-row-own", random_infeasible_row(n, seed), false, "F_1 <= -1 for all z >= 0");
}

}  // namespace perp::ncp::collection
