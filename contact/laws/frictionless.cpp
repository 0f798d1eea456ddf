// SPDX-License-Identifier: Apache-2.0
#include "contact/laws/frictionless.hpp"

#include <cmath>

#include "contact/laws/encoding_builder.hpp"
#include "lcp/words.hpp"

namespace perp::contact {
namespace {

EncodingBuilder frictionless_rows(const Problem& problem, const EncodingOptions& options) {
  EncodingBuilder b(problem, options);
  for (Index a = 0; a < problem.contacts(); ++a) b.next_contact(a);
  return b;
}

}  // namespace

Problem with_newton_impact(Problem problem, In e, In before) {
  check(problem);
  const Index n = problem.contacts();
  if (e.size() != n || before.size() != n)
    refuse_input("Newton's impact: ", e.size(), " coefficients and ", before.size(), " velocities for ", n,
                 " contacts");
  for (Index a = 0; a < n; ++a) {
    if (!(e[a] >= 0 && e[a] <= 1) || !std::isfinite(before[a]))
      refuse_input("Newton's impact: contact ", a, " has the coefficient ", e[a], " and the velocity ", before[a],
                   " before the impact");
    problem.q[problem.dimension * a] += e[a] * before[a];
  }
  return problem;
}

Problem without_friction(Problem problem) {
  problem.mu.setZero();
  problem.mu_r.setZero();
  return problem;
}

Frictionless::Frictionless(const Problem& problem, const EncodingOptions& options)
    : AffineEncoding(problem, frictionless_rows(problem, options)) {}

}  // namespace perp::contact
