// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The frictionless problem 0 <= r_N _|_ W_NN r_N + q_N >= 0 of a part of the contacts, for symmetric semidefinite W:
/// it has a solution, or else weights y >= 0 with W (y e_N) = 0, q_N.y < 0. Principal pivoting answers for few
/// contacts. For many, where W has entries, the QP; and where it has parts interior points on the bodies' own problem,
///     M v = H_N r_N,   0 <= r_N _|_ H_N' v + q_N >= 0,
/// which forms no W_NN. Private to contact/.
#include <vector>

#include "contact/model/problem.hpp"
#include "lcp/judge/result.hpp"

namespace perp::contact {

struct FrictionlessAnswer {
  bool solved = false;  ///< by impulses that are not huge
  Vec y{};              ///< one a contact of the part, a candidate; empty: none
};

/// Contacts of a part up to which pivoting is asked.
inline constexpr Index pivoting_to = 60;

/// `unit` of each contact of the part makes W_NN near one: 1 / sqrt(W_NN). May throw what lcp::solve throws.
FrictionlessAnswer frictionless_answer(const Problem& problem, const std::vector<Index>& part, const Vec& unit,
                                       const lcp::Limits& limits);

}  // namespace perp::contact
