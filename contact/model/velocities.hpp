// SPDX-License-Identifier: Apache-2.0
#pragma once
/// u = W r + q and the sizes of what is added up in it, for the judge: in twice the working precision, and
/// without rounding where that is not enough, so that q is not lost beside a huge W r. O(entries of W); of W by its
/// parts v = M^-1 H r is refined to twice the precision, O(entries of M, of its factors, and of H).
/// Private to contact/.
#include <vector>

#include "contact/model/problem.hpp"
#include "lcp/solve/schur.hpp"

namespace perp::contact {

struct Velocities {
  /// W r + q, each entry to a few eps of itself; of parts to that of max(|u_i|, 1e-6 Q_a), and what eps^2 |H'| |v| is.
  /// Of constrained bodies and of a condensed W it is B' K^-1 B r + q (lcp::schur_image), and NaN where refinement does
  /// not converge, or where it may be wrong by 1e-9 of what the judge
  /// compares it with: beside impulses that are too large.
  Vec u;
  /// |W| |r| + |q|; of parts N'N |r| + |q| (DelassusParts::shares), which is not less; of constrained bodies, of which
  /// that may be far too much, |H|' |K^-1 H r| + |q| where this is less.
  Vec terms;
};
/// Infinite or NaN where a product overflows. `coupled` is that of the problem.
Velocities exact_velocities(const Problem& problem, In r, const std::vector<double>& coupled);

/// l_a of residual.hpp, at which rolling counts as sliding; 1 where the diagonal of W does not say, and without
/// rolling.
double lever(const Problem& problem, Index contact);
/// The factors that bring the entries of a contact's velocity to one unit: 1, and the lever.
Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 5, 1> levers(const Problem& problem, double lever);

/// Q_a of each contact: the largest |q_b| of those it acts on, or that act on it, directly or through others. Of parts,
/// contacts of one body do.
std::vector<double> coupled_velocities(const Problem& problem);

/// H' M^-1 p + w, each entry to a few eps of itself and to eps^2 |H'| |M^-1 p|; 0 below 64 times that.
Vec exact_velocities(const DelassusParts& parts, In p, In w);

/// What rounding may have changed in W = B' K^-1 B + W_0 and q = B' x + w, x = K^-1 f, by this LU factorization of K;
/// W_0 has this diagonal. An error is measured by what may have cancelled: B and x in the units in which K was
/// factored, part by part where K falls into parts, and w. It is eps / rcond of that, and no less than 1e-10; beyond
/// 1e-6 nothing is known, and it is infinite.
Rounding rounding_by_lu(const lcp::RefinedLu& K, const SpMat& B, In x, In w, In W_0);

/// The same of q = H' v + w, v = M^-1 f refined to twice the precision.
Rounding rounding_by_parts(const DelassusParts& parts, In f, In q);

}  // namespace perp::contact
