#include "contact/outer_faceting.hpp"

#include <Eigen/LU>
#include <cmath>
#include <utility>
#include <vector>

#include "contact/encoding_builder.hpp"

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

EncodingBuilder mixed(const Problem& problem, const Polygons& polygons, const EncodingOptions& options) {
  check("outer faceting", problem, polygons);
  EncodingBuilder b(problem, options);
  for (Index a = 0; a < problem.contacts(); ++a) {
    const Index r_N = b.next_contact(a);
    const double mu = problem.mu[a];
    if (mu == 0) continue;
    const auto& C = of_contact(polygons, a).normals();
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
  return b;
}

EncodingBuilder reduced(const Problem& problem, const Polygons& polygons, const EncodingOptions& options) {
  check("outer faceting", problem, polygons);
  EncodingBuilder b(problem, options);
  for (Index a = 0; a < problem.contacts(); ++a) {
    const Index r_N = b.next_contact(a);
    const double mu = problem.mu[a];
    if (mu == 0) continue;
    const auto& C = of_contact(polygons, a).normals();
    const std::vector<Index> basis = basis_edges(C);
    const Index T = C.rows();
    Polygon::Matrix C1(T, T);
    for (Index k = 0; k < T; ++k) C1.col(k) = C.col(basis[static_cast<std::size_t>(k)]);
    const Polygon::Matrix inverse = C1.inverse();  // 1 x 1 or 2 x 2

    for (Index k = 0; k < T; ++k) {  // kappa_k = -(C_1^-1 u_T)_k - .., r_T = C_1^-T (mu r_N 1 - s)
      const Index s = b.nonnegative();
      for (Index t = 0; t < T; ++t) {
        b.velocity_row(s, t + 1, -inverse(k, t));
        b.impulse_column(s, t + 1, -inverse(k, t));
        b.impulse_column(r_N, t + 1, mu * inverse(k, t));
      }
    }
    for (Index i = 0; i < C.cols(); ++i) {
      bool in_basis = false;
      for (const Index j : basis) in_basis = in_basis || i == j;
      if (in_basis) continue;
      const Index kappa = b.nonnegative();
      const Eigen::VectorXd m = inverse * C.col(i);  // c_i = C_1 m: c_i'r_T = m'(mu r_N 1 - s)
      b.local(kappa, r_N, mu * (1 - m.sum()));
      for (Index k = 0; k < T; ++k) {
        b.local(kappa, r_N + 1 + k, m[k]);
        b.local(r_N + 1 + k, kappa, -m[k]);
      }
    }
  }
  return b;
}

}  // namespace

OuterFaceting::OuterFaceting(const Problem& problem, const Polygons& polygons, const EncodingOptions& options)
    : AffineEncoding(problem, options.form == Form::Mixed ? mixed(problem, polygons, options)
                                                          : reduced(problem, polygons, options)) {}

}  // namespace perp::contact
