/// A quasibrittle fracture problem of Tin-Loi and co-workers as an LCP with two solutions.
#include "ncp/collection/build.hpp"
#include "ncp/collection/problems.hpp"
#include "ncp/collection/tinloi_tables.hpp"

namespace perp::ncp::collection {

namespace {

using namespace tinloi_tables;

double at_ends_half(int i, double number) { return i == 0 || i == nodes - 1 ? number / 2 : number; }

/// Unknowns and rows in pairs: z = (v_1, u_1, v_2, u_2, ...).
SpMat matrix() {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < nodes; ++i) {
    const double H = at_ends_half(i, softening);
    entries.emplace_back(2 * i, 2 * i, H);
    entries.emplace_back(2 * i, 2 * i + 1, -H);
    entries.emplace_back(2 * i + 1, 2 * i, H);
    for (int j = 0; j < nodes; ++j) {
      const int row = std::max(i, j), col = std::min(i, j);
      entries.emplace_back(2 * i + 1, 2 * j + 1, Z[static_cast<std::size_t>(row * (row + 1) / 2 + col)]);
    }
  }
  SpMat M(2 * nodes, 2 * nodes);
  M.setFromTriplets(entries.begin(), entries.end());
  return M;
}

}  // namespace

/// 0 <= v_i  _|_  H_i (v_i - u_i) + r_i >= 0,     0 <= u_i  _|_  H_i v_i + (Z u)_i + c_i >= 0,     i = 1..21.
/// u_i is the opening of the crack at node i, Z the stiffness seen from the crack and c_i the load there; beyond the
/// opening r_i / H_i the cohesive traction is used up (v_i > 0).
Problem tinloi42() {
  Vec q(2 * nodes);
  Names names;
  for (int i = 0; i < nodes; ++i) {
    q[2 * i] = at_ends_half(i, strength);
    q[2 * i + 1] = c[static_cast<std::size_t>(i)];
    names.push_back(element("v", std::to_string(i + 1)));
    names.push_back(element("u", std::to_string(i + 1)));
  }
  Problem p;
  p.mcp = make_affine({"tinloi42", Box::nonnegative(2 * nodes), names}, matrix(), q);
  p.starts = {Vec::Constant(2 * nodes, 0.4), Vec::Zero(2 * nodes)};
  return p;
}

}  // namespace perp::ncp::collection
