// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Random contact problems, and a judge of the polygon's law that knows no encoding of it.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "contact/laws/inner_faceting.hpp"
#include "contact/laws/outer_faceting.hpp"
#include "contact/model/problem.hpp"
#include "lcp/solve/solve.hpp"
#include "support/matrices.hpp"

namespace perp::contact {

/// One contact whose normal and tangents act on each other.
inline Problem coupled_contact() {
  return {.dimension = 3,
          .W = support::matrix({{2, 0.5, -0.25}, {0.5, 1, 0.125}, {-0.25, 0.125, 3}}),
          .q = support::vec({-1, 0.75, -0.5}),
          .mu = support::vec({0.5})};
}

/// W = X'X + shift I for a random X of `rank` rows, q and mu random; every fourth contact is frictionless.
inline Problem random_problem(std::mt19937& random, Index contacts, int dimension, Index rank, double shift) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0.05, 1.2);
  const Index n = dimension * contacts;
  Eigen::MatrixXd X(rank, n);
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < rank; ++i) X(i, j) = normal(random);
  Problem p{.dimension = dimension,
            .W = SpMat((X.transpose() * X + shift * Eigen::MatrixXd::Identity(n, n)).sparseView()),
            .q = Vec(n),
            .mu = Vec(contacts)};
  for (Index i = 0; i < n; ++i) p.q[i] = normal(random);
  for (Index a = 0; a < contacts; ++a) p.mu[a] = a % 4 == 3 ? 0 : uniform(random);
  p.W.given().makeCompressed();
  return p;
}

/// A polygon of 3 to 9 corners on an ellipse with one corner in each sector, so that the origin is inside.
inline Polygon random_polygon(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(0, 1);
  const int K = 3 + static_cast<int>(random() % 7);
  Polygon::Matrix d(2, K);
  const double first = 2 * std::numbers::pi * uniform(random);
  for (int j = 0; j < K; ++j) {
    const double angle = first + 2 * std::numbers::pi * (j + 0.4 * uniform(random)) / K;
    d(0, j) = (0.5 + first / 10) * std::cos(angle);
    d(1, j) = std::sin(angle);
  }
  return Polygon::of_vertices(d);
}

/// The largest violation, over the contacts, of
///     min(r_N, u_N) = 0,  r_T in mu r_N P  (half-planes left of the sides),  -u_T'r_T = mu r_N max_j d_j'(-u_T)
/// (the last is maximal dissipation, the definition of the normal cone).
inline double polygon_law_error(const Problem& p, const Polygons& polygons, In r) {
  const Vec u = p.W * r + p.q;
  double worst = 0;
  for (Index a = 0; a < p.contacts(); ++a) {
    const Index at = p.dimension * a;
    const Index T = p.dimension - 1;
    const auto& d = polygons[polygons.size() == 1 ? 0 : static_cast<std::size_t>(a)].vertices();
    const double reach = p.mu[a] * r[at];
    const Vec r_T = r.segment(at + 1, T);
    const Vec u_T = u.segment(at + 1, T);
    worst = std::max(worst, std::abs(std::min(r[at], u[at])));
    if (T == 1) worst = std::max(worst, std::abs(r_T[0]) - reach * d.maxCoeff());
    for (Index j = 0; T == 2 && j < d.cols(); ++j) {
      const Vec side = d.col((j + 1) % d.cols()) - d.col(j);
      const Vec from = r_T - reach * d.col(j);
      worst = std::max(worst, -(side[0] * from[1] - side[1] * from[0]) / side.norm());
    }
    worst = std::max(worst, std::abs(u_T.dot(r_T) + reach * (-d.transpose() * u_T).maxCoeff()));
  }
  return worst;
}

/// The four encodings of one problem.
struct NamedEncoding {
  std::string name;
  AffineEncoding encoding;
};
inline std::vector<NamedEncoding> encodings(const Problem& p, const Polygons& outer, const Polygons& inner,
                                            bool scaled = true) {
  const EncodingOptions mixed{.form = Form::Mixed, .scaled = scaled};
  const EncodingOptions reduced{.form = Form::Reduced, .scaled = scaled};
  return {{"outer mixed", OuterFaceting(p, outer, mixed)},
          {"outer reduced", OuterFaceting(p, outer, reduced)},
          {"inner mixed", InnerFaceting(p, inner, mixed)},
          {"inner reduced", InnerFaceting(p, inner, reduced)}};
}

/// contact::solve to the tolerance that all tests ask for: the methods stop at tol (1 + ||q||_inf) <= 2 tol.
inline lcp::Result solved(const AffineEncoding& encoding) { return solve(encoding, {.tol = 5e-10}); }

}  // namespace perp::contact
