// SPDX-License-Identifier: Apache-2.0
/// A quasibrittle fracture problem of Tin-Loi and co-workers as an LCP with two solutions.
#include "collection/base/build.hpp"
#include "collection/models/problems.hpp"
#include "collection/models/tinloi_tables.hpp"

namespace perp::ncp::collection {

namespace {

using namespace tinloi_tables;

double at_ends_half(Index i, double number) { return i == 0 || i == nodes - 1 ? number / 2 : number; }

/// Unknowns and rows in pairs: z = (v_1, u_1, v_2, u_2, ...).
SpMat matrix() {
  std::vector<Eigen::Triplet<double>> entries;
  for (Index i = 0; i < nodes; ++i) {
    const double H = at_ends_half(i, softening);
    entries.emplace_back(2 * i, 2 * i, H);
    entries.emplace_back(2 * i, 2 * i + 1, -H);
    entries.emplace_back(2 * i + 1, 2 * i, H);
    for (Index j = 0; j < nodes; ++j) {
      const Index row = std::max(i, j), col = std::min(i, j);
      entries.emplace_back(2 * i + 1, 2 * j + 1, Z[row * (row + 1) / 2 + col]);
    }
  }
  SpMat M(2 * nodes, 2 * nodes);
  M.setFromTriplets(entries.begin(), entries.end());
  return M;
}

/// z with v = 0 and the first half of a symmetric u.
Vec mirrored(const Vec& u) {
  Vec z = Vec::Zero(2 * nodes);
  for (Index i = 0; i < nodes; ++i) z[2 * i + 1] = u[std::min<Index>(i, nodes - 1 - i)];
  return z;
}

}  // namespace

/// 0 <= v_i  _|_  H_i (v_i - u_i) + r_i >= 0,     0 <= u_i  _|_  H_i v_i + (Z u)_i + c_i >= 0,     i = 1..21.
/// u_i is the opening of the crack at node i; the cohesive traction there falls from r_i at the slope H_i until it is
/// used up and v_i = u_i - r_i / H_i takes over. Z + diag(H) is the elastic stiffness seen from the crack: positive
/// semidefinite, its kernel the rigid motions; Z has two negative eigenvalues, which lets the LCP have two solutions.
Problem tinloi42() {
  Vec q(2 * nodes);
  Names names;
  for (Index i = 0; i < nodes; ++i) {
    q[2 * i] = at_ends_half(i, strength);
    q[2 * i + 1] = c[i];
    names.push_back(element("v", std::to_string(i + 1)));
    names.push_back(element("u", std::to_string(i + 1)));
  }
  Problem p;
  p.mcp = make_affine({"tinloi42", Box::nonnegative(2 * nodes), names}, matrix(), q);
  // Both are symmetric, with v = 0: recomputed, as the literature prints no digits.
  p.solutions = {
      {"open at the ends",
       mirrored(vec({0.002317546497170575, 0.0014646724632621472, 0.000994357588205811, 0.0006618845147769903,
                     0.00042000352543747414, 0.00024135627961232017, 0.00011380853667239655, 3.082670787081813e-05, 0,
                     0, 0})),
       1e-15},
      {"open everywhere",
       mirrored(vec({0.0027571498890791297, 0.0019081452505666815, 0.0014357855259811837, 0.001098230995081924,
                     0.0008483519598382058, 0.0006584465015999385, 0.0005152271507835943, 0.0004099941059656503,
                     0.0003380874738832177, 0.0002959358842721869, 0.0002819698732087845})),
       1e-15}};
  p.starts = {Vec::Constant(2 * nodes, 0.4), Vec::Zero(2 * nodes), Vec::Constant(2 * nodes, 0.001)};
  return p;
}

}  // namespace perp::ncp::collection
