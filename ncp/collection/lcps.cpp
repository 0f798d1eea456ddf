/// Linear complementarity problems 0 <= z _|_ M z + q >= 0 of the literature.
#include "ncp/collection/build.hpp"
#include "ncp/collection/generators.hpp"
#include "ncp/collection/problems.hpp"

namespace perp::ncp::collection {

namespace {

/// LCP(-e, M) with M_ij = entry(i, j), zeros left out.
template <class Entry>
Problem lcp(const std::string& name, Index n, Entry entry) {
  require_at_least(name, "n", n, 1);
  std::vector<Eigen::Triplet<double>> entries;
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      if (const double value = entry(i, j); value != 0) entries.emplace_back(i, j, value);
  SpMat M(n, n);
  M.setFromTriplets(entries.begin(), entries.end());
  Problem p;
  p.mcp = make_affine({name, Box::nonnegative(n), indexed("z", n)}, M, -Vec::Ones(n));
  p.starts = {Vec::Zero(n), Vec::Ones(n)};
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
  p.starts = {Vec::Zero(n), Vec::Ones(n)};
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

Problem fathi(Index n) {
  // (L L')_ij = 4 (min(i, j) - 1) + 2 off the diagonal and 4 (i - 1) + 1 on it, counted from 1.
  return with_unique(
      lcp("fathi", n, [](Index i, Index j) { return 4 * static_cast<double>(std::min(i, j)) + (i == j ? 1 : 2); }),
      "e_1", Vec::Unit(n, 0), 0);
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
  p.starts = {Vec::Zero(4), Vec::Ones(4)};
  p.solutions = {{"optimum", vec({2.8, 0, 0.8, 1.2}), 1e-15}};
  return p;
}

}  // namespace perp::ncp::collection
