// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Random sparse nonlinear complementarity problems of known class, of any size, with a planted solution, the same on
/// every platform but for the last digits of exp and atan. All are
///     F(x) = M x + A g(x) + q,   g(x) = (g_1(x_1), .., g_n(x_n)) increasing,   J(x) = M + A diag(g'(x)).
/// The class is certain by construction; the arguments stand with the functions. Notation as in random_lcps.hpp: B
/// sparse, about two entries a row, uniform in [-1, 1]; W = C - C' skew, about one entry a row of C.
///
/// A solution x is planted by the choice of q: unless said otherwise, each index has x_i in [1/2, 2] and F_i = 0, or
/// x_i = 0 and F_i in [1/2, 2], with equal chances. Starts: 0, e, 10 e, and (0, 2, 0, 2, ..). All throw
/// std::invalid_argument, naming the argument, for n below the stated least.
#include "collection/base/entry.hpp"

namespace perp::ncp::collection {

/// M = B B' + W, B n x n/2, A = diag(d), d in [1/2, 2], g in turn arctan(x), x^3 + x, exp(x / 4): J + J' = 2 B B' + 2 A
/// diag(g') is positive definite, for g' > 0: F is strictly monotone, and the solution the only one. In the manner of
/// Harker & Pang 1990. n >= 2.
Problem random_monotone_ncp_own(Index n, unsigned seed);

/// M = 0, A = H with H_ii = sum_{j != i} |H_ij| in every other row and more than that in the rest, g in turn x + x^3,
/// x^3, arctan(x): J = H diag(g'), g' >= 0, is P0, for its principal minors are those of H, nonnegative, times products
/// of g'. H_11 = H_12 = 9, H_21 = H_22 = 1 are all there is in two rows, g_1 = g_2 = x + x^3: F is not monotone, as v =
/// (-1, 2, 0, ..) has v'J(0)v = 9 - 20 + 4 < 0, and J(0) is singular, also where x_i = 0 for a cube. There may be more
/// solutions. n >= 4.
Problem random_p0_ncp_own(Index n, unsigned seed);

/// As random_monotone_ncp_own, with x_i = F_i = 0 at every index with the chance 1/2: the solution is the only one, and
/// strict complementarity fails there. n >= 2.
Problem random_degenerate_ncp_own(Index n, unsigned seed);

/// F(x) = S f(S x), S = diag(10^s), s in [-2, 2] and both ends taken, f as in random_monotone_ncp_own but with g in
/// turn arctan(y), y^3 + y: v'J v = (S v)'f'(S v) > 0, the solution the only one; entries of J from 1e-4 to 1e4, x from
/// 1e-2 to 1e2. n >= 2.
Problem random_ill_conditioned_ncp_own(Index n, unsigned seed);

/// F as in random_monotone_ncp_own in a box: in turn x >= 0, -1 <= x <= 1, x free, x <= 1, x = 1/2. Planted: inside
/// with F_i = 0, at a lower bound with F_i > 0, at an upper one with F_i < 0. The solution is the only one. The starts
/// lie outside for some. n >= 2.
Problem random_boxed_ncp_own(Index n, unsigned seed);

/// M = W + I / 10, A = diag(d), d in [1/2, 2], g = exp(5 x_i): strictly monotone, the solution is the only one. F is
/// not defined where x_i > 141; Newton steps from 0 lead far beyond, and from 10 e each step gains 1/5. n >= 2.
Problem random_exponential_ncp_own(Index n, unsigned seed);

}  // namespace perp::ncp::collection
