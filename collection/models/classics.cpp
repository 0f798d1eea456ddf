// SPDX-License-Identifier: Apache-2.0
/// Further problems of the literature, and the LCPs of textbooks in the smallest form that shows each phenomenon.
#include <cmath>

#include "collection/base/build.hpp"
#include "collection/models/problems.hpp"

namespace perp::ncp::collection {

namespace {

/// LCP(q, M) with M_ij = entry(i, j).
template <class Entry>
std::unique_ptr<Mcp> small_lcp(const std::string& name, const Vec& q, Entry entry) {
  const Index n = q.size();
  SpMat M(n, n);
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i)
      if (const double value = entry(i, j); value != 0) M.insert(i, j) = value;
  M.makeCompressed();
  return make_affine({name, Box::nonnegative(n), indexed("z", n)}, M, q);
}

}  // namespace

/// Five firms: marginal costs c_i + (q_i / 5)^(1/beta_i), price p = (5000 / Q)^(1/1.1), Q = sum q:
///     F_i = c_i + (q_i / 5)^(1/beta_i) - p + q_i p / (1.1 Q).
/// Not defined for q_i < 0 or Q = 0; J is infinite at q_i = 0 where beta_i > 1. Unique (Murphy, Sherali & Soyster).
Problem nash5() {
  constexpr int firms = 5;
  Problem p;
  p.mcp = make_problem({"nash5", Box::nonnegative(firms), indexed("q", firms), indexed("marginal_loss", firms)},
                       [](const auto& q, const auto& F) {
                         using std::pow;
                         constexpr double gamma = 1.1;
                         constexpr double c[firms] = {10, 8, 6, 4, 2}, beta[firms] = {1.2, 1.1, 1, 0.9, 0.8};
                         auto Q = q[0];
                         for (int i = 0; i < firms; ++i) {
                           if (!not_below(q[i], 0)) return false;
                           if (i > 0) Q += q[i];
                         }
                         if (!above(Q, 0)) return false;
                         const auto price = pow(5000 / Q, 1 / gamma);
                         for (int i = 0; i < firms; ++i)
                           F[i] = c[i] + pow(q[i] / 5, 1 / beta[i]) - price + q[i] * price / (gamma * Q);
                         return true;
                       });
  p.starts = {Vec::Ones(firms), Vec::Constant(firms, 10), Vec::Constant(firms, 100), vec({1, 2, 3, 4, 5})};
  p.solutions = {
      {"unique",
       vec({36.932510815735753, 41.818141660437632, 43.706578522274206, 42.659239743305108, 39.178952516625024}),
       1e-11}};
  p.solutions_complete = true;
  return p;
}

/// M = [1 0 2; 2 1 0; 0 2 1], q = -e: z = e / 3, alone, as M is P. Plain Newton steps on min(z, M z + q), each the
/// solution of the equations of one active set, go round {1, 3}, {2, 3}, {1, 2} for ever.
Problem cyclic3_own() {
  Problem p;
  p.mcp = small_lcp("cyclic3-own", -Vec::Ones(3), [](Index i, Index j) {
    return i == j ? 1.0 : (i + 1) % 3 == j ? 0.0 : 2.0;
  });
  p.starts = {Vec::Zero(3), vec({1, 0, 0}), vec({1, 0, 1}), Vec::Constant(3, 10)};
  p.solutions = {{"e/3", Vec::Constant(3, 1. / 3), 1e-15}};
  p.solutions_complete = true;
  return p;
}

/// M = -I, q = e, n = 4: every z with z_i in {0, 1}, and no other.
Problem cube_vertices_own() {
  constexpr Index n = 4;
  Problem p;
  p.mcp = small_lcp("cube-vertices-own", Vec::Ones(n), [](Index i, Index j) { return i == j ? -1.0 : 0.0; });
  p.starts = {Vec::Constant(n, 0.5), vec({0.3, 0.6, 0.4, 0.9}), Vec::Constant(n, 2), Vec::Constant(n, 10)};
  for (int set = 0; set < 1 << n; ++set) {
    Vec z(n);
    std::string label;
    for (Index i = 0; i < n; ++i) {
      z[i] = set >> i & 1;
      label += z[i] > 0 ? '1' : '0';
    }
    p.solutions.push_back({label, z, 0});
  }
  p.solutions_complete = true;
  return p;
}

/// M = e e', q = -e, n = 5: every z >= 0 with sum 1. M is positive semidefinite of rank 1.
Problem simplex_own() {
  constexpr Index n = 5;
  Problem p;
  p.mcp = small_lcp("simplex-own", -Vec::Ones(n), [](Index, Index) { return 1.0; });
  p.starts = {Vec::Zero(n), Vec::Ones(n), Vec::Constant(n, 10), 5 * Vec::Unit(n, 2)};
  p.solutions = {{"centre", Vec::Constant(n, 0.2), 1e-15}, {"vertex", Vec::Unit(n, 0), 0}};
  return p;
}

/// M = [0 1; 0 0], q = (-1, 1): feasible, at z = (0, 1), but F_2 = 1 forces z_2 = 0, where F_1 = -1.
Problem feasible_unsolvable_own() {
  Problem p;
  p.mcp =
      small_lcp("feasible-unsolvable-own", vec({-1, 1}), [](Index i, Index j) { return i == 0 && j == 1 ? 1.0 : 0.0; });
  p.starts = {Vec::Zero(2), Vec::Ones(2), Vec::Constant(2, 10)};
  p.solutions_complete = true;
  p.no_solution = "F_2 = 1 forces z_2 = 0, where F_1 = -1, although z = (0, 1) is feasible";
  return p;
}

/// M_ij = 1 / (i + j - 1), Hilbert's matrix with n = 8, and a planted z = (1, 0, 1, 0, ..), F = (0, 1, 0, 1, ..):
/// positive definite with condition 10^10, so that points far from z have small residuals.
Problem hilbert_own() {
  constexpr Index n = 8;
  const auto entry = [](Index i, Index j) { return 1 / static_cast<double>(i + j + 1); };
  Vec z(n), q(n);
  for (Index i = 0; i < n; ++i) z[i] = i % 2 == 0 ? 1 : 0;
  for (Index i = 0; i < n; ++i) {
    q[i] = 1 - z[i];
    for (Index j = 0; j < n; ++j) q[i] -= entry(i, j) * z[j];
  }
  Problem p;
  p.mcp = small_lcp("hilbert-own", q, entry);
  p.starts = {Vec::Zero(n), Vec::Ones(n), Vec::Constant(n, 10)};
  p.solutions = {{"planted", z, 1e-6}};
  p.solutions_complete = true;
  return p;
}

}  // namespace perp::ncp::collection
