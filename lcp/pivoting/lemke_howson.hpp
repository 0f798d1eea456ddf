// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Paths of Lemke & Howson's kind for LCP-like problems (every variable bounded below only): all complementarity
/// conditions hold on the path but that of one label k,
///     M z + q - mu e_k = w,   z, w >= 0,   z_i w_i = 0 for all i, but for mu > 0 that goes to 0.
/// The path begins on the ray where z_k alone covers the negative entries of q it can, z_k = s = max_i -q_i / M_ik with
/// the maximum at i = j, and z_j is large: for the LCP of a bimatrix game,
///     0 <= x _|_ A y - e >= 0,   0 <= y _|_ B'x - e >= 0,   A, B > 0,
/// in exact arithmetic a ray of solutions, hence every label's path ends in an equilibrium (Lemke & Howson 1964; CPS
/// 1992, section 4.4), where Lemke's method with a covering vector d > 0 ends on a ray at once. For other matrices it
/// is one more start, followed by lemke() from the cell it lies in.
/// References: Lemke & Howson, J. SIAM 12 (1964) 413. Cottle, Pang & Stone 1992.
#include "lcp/judge/result.hpp"
#include "lcp/pivoting/lemke.hpp"

namespace perp::lcp {

struct LemkeHowson {
  int labels = 20;  ///< labels tried in turn, spread evenly over all
  LemkeOptions options{.max_pivots = 10'000, .perturbation = 1e-9};
};
void describe(LemkeHowson& method, Fields& fields);

/// iterations: pivots of all labels. Stalled if no label's path ends in a solution. NotApplicable unless all lower
/// bounds are finite and all upper ones infinite.
Result lemke_howson(const AffineMcp& problem, In start, const LemkeHowson& options = {}, const Limits& limits = {});

/// The start of label k in the normal map's coordinates; empty if no entry of column k covers anything.
Vec howson_start(const AffineMcp& problem, Index k);

}  // namespace perp::lcp
