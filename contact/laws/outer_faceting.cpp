// SPDX-License-Identifier: Apache-2.0
#include "contact/laws/outer_faceting.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "contact/laws/encoding_builder.hpp"
#include "lcp/dense_factors.hpp"

namespace perp::contact {
namespace {

/// The edges whose normals stand for the tangent plane: those of the largest |det C_1|; the first one in the plane.
std::vector<Index> basis_edges(const Polygon::Matrix& C) {
  if (C.rows() == 1) return {0};
  std::vector<Index> best{0, 1};
  double largest = 0;
  for (Index i = 0; i < C.cols(); ++i)
    for (Index j = i + 1; j < C.cols(); ++j) {
      const double determinant = std::abs(C(0, i) * C(1, j) - C(1, i) * C(0, j));
      if (determinant > largest * (1 + 1e-9)) {  // among equal ones the first, whatever the rounding
        largest = determinant;
        best = {i, j};
      }
    }
  return best;
}

/// C_1^-1, 1 x 1 or 2 x 2.
Polygon::Matrix inverse(const Polygon::Matrix& C, const std::vector<Index>& basis) {
  Polygon::Matrix C1(C.rows(), C.rows());
  for (Index k = 0; k < C.rows(); ++k) C1.col(k) = C.col(basis[static_cast<std::size_t>(k)]);
  return C1.inverse();
}

/// A contact with friction, r_N its first unknown and C its normals, in the mixed form.
void add_mixed(EncodingBuilder& b, Index r_N, double mu, const Polygon::Matrix& C) {
  const Index r_T = r_N + 1;
  for (Index t = 0; t < C.rows(); ++t) {
    const Index i = b.free();
    b.velocity_row(i, t + 1, 1);
    b.impulse_column(i, t + 1, 1);
  }
  for (Index i = 0; i < C.cols(); ++i) {
    const Index kappa = b.nonnegative();
    b.local(kappa, r_N, mu);
    for (Index t = 0; t < C.rows(); ++t) {
      b.local(kappa, r_T + t, -C(t, i));
      b.local(r_T + t, kappa, C(t, i));
    }
  }
}

void add_reduced(EncodingBuilder& b, Index r_N, double mu, const Polygon::Matrix& C) {
  const std::vector<Index> basis = basis_edges(C);
  const Index T = C.rows();
  const Polygon::Matrix C1_inverse = inverse(C, basis);
  for (Index k = 0; k < T; ++k) {  // kappa_k = -(C_1^-1 u_T)_k - .., r_T = C_1^-T (mu r_N 1 - s)
    const Index s = b.nonnegative();
    for (Index t = 0; t < T; ++t) {
      b.velocity_row(s, t + 1, -C1_inverse(k, t));
      b.impulse_column(s, t + 1, -C1_inverse(k, t));
      b.impulse_column(r_N, t + 1, mu * C1_inverse(k, t));
    }
  }
  for (Index i = 0; i < C.cols(); ++i) {
    if (std::ranges::find(basis, i) != basis.end()) continue;
    const Index kappa = b.nonnegative();
    const Eigen::VectorXd m = C1_inverse * C.col(i);  // c_i = C_1 m: c_i'r_T = m'(mu r_N 1 - s)
    b.local(kappa, r_N, mu * (1 - m.sum()));
    for (Index k = 0; k < T; ++k) {
      b.local(kappa, r_N + 1 + k, m[k]);
      b.local(r_N + 1 + k, kappa, -m[k]);
    }
  }
}

EncodingBuilder outer_rows(const Problem& problem, const Polygons& polygons, const EncodingOptions& options) {
  check("outer faceting", problem, polygons);
  EncodingBuilder b(problem, options);
  for (Index a = 0; a < problem.contacts(); ++a) {
    const Index r_N = b.next_contact(a);
    if (problem.mu[a] == 0) continue;
    const auto add = options.form == Form::Mixed ? add_mixed : add_reduced;
    add(b, r_N, problem.mu[a], of_contact(polygons, a).normals());
  }
  return b;
}

}  // namespace

OuterFaceting::OuterFaceting(const Problem& problem, const Polygons& polygons, const EncodingOptions& options)
    : AffineEncoding(problem, outer_rows(problem, polygons, options)) {
  if (options.form == Form::Mixed) begin_lemke_at(mixed_start(problem, polygons));
}

/// x of the normal map with z = project(x) = (0, 0, kappa of the pair) and, at a distance z0 that covers all of them,
/// u_N + z0 > 0, kappa = -C_1^-1 q_T + z0 > 0 for the pair and sigma + z0 > 0 for the other edges.
Vec OuterFaceting::mixed_start(const Problem& problem, const Polygons& polygons) const {
  const Vec& q = affine().q;
  Vec x = Vec::Zero(q.size());
  for (Index a = 0; a < problem.contacts(); ++a) {
    const Index r_N = first(a);
    x[r_N] = -q[r_N];
    if (problem.mu[a] == 0) continue;
    const auto& C = of_contact(polygons, a).normals();
    const Index T = C.rows();
    const std::vector<Index> basis = basis_edges(C);
    const Vec kappa = -inverse(C, basis) * q.segment(r_N + 1, T);
    for (Index k = 0; k < T; ++k) x[r_N + 1 + T + basis[static_cast<std::size_t>(k)]] = kappa[k];
  }
  const double z0 = 1 + 2 * (x.size() > 0 ? x.lpNorm<Eigen::Infinity>() : 0);
  for (Index a = 0; a < problem.contacts(); ++a) {
    const Index r_N = first(a);
    x[r_N] -= z0;
    if (problem.mu[a] == 0) continue;
    const auto& C = of_contact(polygons, a).normals();
    const std::vector<Index> basis = basis_edges(C);
    const Index kappa = r_N + 1 + C.rows();
    x.segment(kappa, C.cols()).array() -= z0;
    for (const Index i : basis) x[kappa + i] += 2 * z0;
  }
  return x;
}

}  // namespace perp::contact
