// SPDX-License-Identifier: Apache-2.0
#include "contact/laws/inner_faceting.hpp"

#include "contact/laws/encoding_builder.hpp"

namespace perp::contact {
namespace {

EncodingBuilder inner_rows(const Problem& problem, const Polygons& polygons, const EncodingOptions& options) {
  check("inner faceting", problem, polygons);
  EncodingBuilder b(problem, options);
  const bool mixed = options.form == Form::Mixed;
  for (Index a = 0; a < problem.contacts(); ++a) {
    const Index r_N = b.next_contact(a);
    const double mu = problem.mu[a];
    if (mu == 0) continue;
    const auto& D = of_contact(polygons, a).vertices();
    const Index T = D.rows();
    const Index r_T = r_N + 1;
    const Index u_T = r_T + T;
    for (Index t = 0; mixed && t < 2 * T; ++t) b.free();
    for (Index t = 0; mixed && t < T; ++t) {
      b.impulse_column(r_T + t, t + 1, 1);
      b.velocity_row(r_T + t, t + 1, 1);
      b.local(r_T + t, u_T + t, -1);
      b.local(u_T + t, r_T + t, 1);
    }
    const Index beta = mixed ? u_T + T : r_T;
    const Index lambda = beta + D.cols();
    for (Index j = 0; j < D.cols(); ++j) {
      b.nonnegative();
      for (Index t = 0; t < T; ++t)
        if (mixed) {
          b.local(beta + j, u_T + t, D(t, j));
          b.local(u_T + t, beta + j, -D(t, j));
        } else {
          b.velocity_row(beta + j, t + 1, D(t, j));
          b.impulse_column(beta + j, t + 1, D(t, j));
        }
      b.local(beta + j, lambda, 1);
      b.local(lambda, beta + j, -1);
    }
    b.nonnegative();
    b.local(lambda, r_N, mu);
  }
  return b;
}

}  // namespace

InnerFaceting::InnerFaceting(const Problem& problem, const Polygons& polygons, const EncodingOptions& options)
    : AffineEncoding(problem, inner_rows(problem, polygons, options)) {}

}  // namespace perp::contact
