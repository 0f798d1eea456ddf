// SPDX-License-Identifier: Apache-2.0
#pragma once
/// u = W r + q and the sizes of what is added up in it, for the judge: in twice the working precision, and
/// without rounding where that is not enough, so that q is not lost beside a huge W r. O(entries of W); of W by its
/// parts v = M^-1 H r is refined to twice the precision, O(entries of M, of its factors, and of H).
/// Private to contact/.
#include <vector>

#include "contact/model/problem.hpp"

namespace perp::contact {

struct Velocities {
  /// W r + q, each entry to a few eps of itself; of parts to that of max(|u_i|, 1e-6 Q_a), and what eps^2 |H'| |v| is.
  Vec u;
  Vec terms;  ///< |W| |r| + |q|; of parts N'N |r| + |q| (DelassusParts::shares), which is not less
};
/// Infinite or NaN where a product overflows. `coupled` is that of the problem.
Velocities exact_velocities(const Problem& problem, In r, const std::vector<double>& coupled);

/// Q_a of each contact: the largest |q_b| of those it acts on, or that act on it, directly or through others. Of parts,
/// contacts of one body do.
std::vector<double> coupled_velocities(const Problem& problem);

/// What the condensed q of a problem with `global` may be wrong by, entry by entry: its roundings where W is by its
/// parts, 1e-10 Q_a where an LU factorization has made it.
Vec condensation_error(const Problem& problem);

/// H' M^-1 p + w, each entry to a few eps of itself and to eps^2 |H'| |M^-1 p|.
Vec exact_velocities(const DelassusParts& parts, In p, In w);

}  // namespace perp::contact
