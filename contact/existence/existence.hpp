// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Decides, before a solve is given up, whether a solution exists, as far as this can be proven.
///
/// *None*: infeasible.hpp, for any W.
///
/// *Exists*: for symmetric positive semidefinite W, if some velocities that impulses (of any sign) can bring about are
/// inside the dual cones,
///     u' = W r' + q,   u'_N > mu |u'_T| in every contact   (rolling: u'_N > mu |u'_T| + mu_r |w'_R|)             (*)
/// (Acary, Cadoux, Lemarechal & Malick, ZAMM 91 (2011) 155, whose H'v + w in int K* it is, since H' and W have one
/// range). The proof turns convex problems min 1/2 r'W r + (q + mu s e_N).r over K into a continuous map of s = |u_T|
/// with bounded range. It asks of K no more than that it is a closed convex cone with e_N in K*: with rolling friction
/// s = (|u_T|, |w_R|), and q + (mu s_T + mu_r s_R) e_N. For unsymmetric W nothing is said.
///
/// W counts as symmetric only if it is so bit by bit. Rounding would decide whether a singular matrix of doubles is
/// semidefinite. The proof therefore shows that S = D W D, D = diag(W_ii^-1/2), has no eigenvalue below -shift:
///  * W_ii >= 0, and rows with W_ii = 0 are zero.
///  * The Cholesky factorization of S + shift / 2 I in doubles succeeds. It fails if this matrix has an eigenvalue
///    below -gamma, gamma = (m + 8) eps m for m rows (Higham 2002, theorem 10.3; Rump, BIT 46 (2006) 433). shift is
///    4 gamma.
///  * The margin of (*) is larger than the change of it by shift D^-2 r'. (*) then holds for W + shift D^-2, too, which
///    is certainly semidefinite.
/// The statement is exact for W + shift D^-2. Its solutions solve the given problem up to shift D^-2 r in u. Where W
/// and q were condensed the margin is larger than what Problem::rounding says of W r' + q, too.
///
/// W = H' M^-1 H by its parts is semidefinite itself, where such a factorization shows M to be positive definite: shift
/// is 0. u' is then H' v' + q of v' near M^-1 H r', without rounding, and no entry of W is formed. Of constrained
/// bodies it is W r' + q by a refined solution, with a bound of what that may be wrong by, which the margin is larger
/// than.
#include <string>

#include "contact/existence/infeasible.hpp"

namespace perp::contact {

enum class Existence { Undecided, Exists, None };
std::string_view to_string(Existence);

struct Witness {
  Vec r{};  ///< r' of (*), d n
  Vec v{};  ///< v' near M^-1 H r', of which the proof is: u' = H' v' + q. Empty but of bodies without constraints
  double margin = 0;  ///< least u'_N - mu |u'_T| - what shift changes, rounded down [m/s]
  double shift = 0;   ///< relative to the diagonal of W
};

/// Computes the margin that r' proves, rounded down. Returns it if W passes the test above and the margin is positive.
/// Throws std::invalid_argument if r' has not d n entries.
std::optional<Witness> examine_witness(const Problem& problem, In r);

/// Searches for r': on the line to the velocities nearest to e_N, then by ADMM for min 1/2 r'W r + (q - m e_N).r over
/// K, m = |q|_inf, .. , |q|_inf / 1000: one sparse factorization, of the bodies' size where W is by its parts.
std::optional<Witness> find_witness(const Problem& problem, const SearchLimits& limits = {});

struct Verdict {
  Existence existence = Existence::Undecided;
  Vec certificate{};      ///< of None: y
  double radius = 0;      ///< of None
  Witness witness{};      ///< of Exists
  std::string message{};  ///< one clause, of what there is to say
};

/// Looks for a certificate, and then for a witness, each with `limits`.
Verdict existence(const Problem& problem, const SearchLimits& limits = {});
/// Looks for a witness only. The answer is Exists or Undecided.
Verdict verdict_without_certificate(const Problem& problem, const SearchLimits& limits = {});
/// Describes a certificate in words: the contacts, y.u_N, the radius.
Verdict verdict_of(const Problem& problem, Infeasible proof);

}  // namespace perp::contact
