#pragma once
/// Families of test problems of any size. Those with a seed are made of our own random data around a planted solution,
/// reproducible on every platform. All throw std::invalid_argument, naming the argument, for sizes below the stated
/// least.
#include "ncp/collection/collection.hpp"
#include "ncp/collection/random_lcps.hpp"

namespace perp::ncp::collection {

/// Nash-Cournot oligopoly of n >= 10 firms in the manner of nash10, demand scaled to their number; one firm in eight
/// stays out of the market. n unknowns, dense. The equilibrium is unique (Murphy, Sherali & Soyster 1982).
Problem nash_own(Index firms, unsigned seed);

/// Bimatrix game with positive cost matrices A, B (m x n, m, n >= 1) as the LCP of Lemke & Howson 1964 in z = (x, y),
///     0 <= x  _|_  A y - e >= 0,     0 <= y  _|_  B'x - e >= 0,
/// whose solutions other than rays are the equilibria x / e'x, y / e'y. One equilibrium is planted; there may be more.
Problem bimatrix_own(Index m, Index n, unsigned seed);

/// Walrasian production economy in z = (y, p, h): activity levels y >= 0 of the sectors, prices p >= 1e-4 of the goods
/// with p_1 = 1 as numeraire, incomes h of the households, free.
///     F_y = -a'p,   F_p = e 1 + a y - diag(p)^-1 alpha h,   F_h = h - e'p,
/// a: goods x sectors, e and alpha (endowments, Cobb-Douglas shares): goods x households, all sparse. One equilibrium
/// is planted; there may be more. goods >= 4, 1 <= sectors < goods, households >= 1.
Problem walras_own(Index goods, Index sectors, Index households, unsigned seed);

/// LCP(q, M), M = I + 2 (strict upper triangle), q = -e, n >= 1: z = e_n. A P-matrix; related right-hand sides drive
/// Lemke's method and the principal pivoting method through 2^n pivots (Murty 1978).
Problem murty(Index n);
/// The same M transposed with q_i = -(2^n + 2^(n-1) + ... + 2^(n-i+1)): z = 2^n e_1. Murty's right-hand side, for which
/// his least-index method and Lemke's take 2^n steps or nearly. 1 <= n <= 50.
Problem murty_exp(Index n);
/// M = I + 2 (strict lower triangle), q = -e: z = e_1.
Problem murty_lower(Index n);
/// M = L L', L = I + 2 (strict lower triangle), q = -e: z = e_1. Symmetric positive definite, condition growing like
/// n^4 (Fathi 1979).
Problem fathi(Index n);
/// M = tridiag(1, 4, -2) (below, on, above the diagonal), q = -e, n >= 1 (Ahn 1983): M z = e.
Problem ahn(Index n);
/// M = tridiag(-1, 4, -1), q = -e, n >= 1 (Geiger & Kanzow 1996): M z = e.
Problem geiger_kanzow(Index n);
/// A membrane under the load f = -1e-6 over the bump psi = 0.1 - (x - 1/2)^2 - (y - 1/2)^2, zero around the unit
/// square, N x N unknowns, h = 1 / (N + 1):  v_ij >= psi  _|_  4 v_ij - its four neighbours - f h^2 >= 0. Start max(0,
/// psi). A symmetric M-matrix: one solution. N >= 1.
Problem obstacle_bump_own(Index N);

// On the interior points (i, j) of a grid, i = 1 .. N along x (fastest), j = 1 .. M along y, zero on the boundary
// unless said otherwise; rows times hx hy. F = A v + q, but for bratu_own; linear finite elements. 1 <= M, N <= 20000.

/// A membrane between two obstacles, unit square: -Laplace v = 1, l = s^3 <= v <= s^2 + 0.2, s = sin(9.2 x) sin(9.3 y).
/// Start max(0, l). One solution (symmetric M-matrix).
Problem obstacle(Index M, Index N);
/// -Laplace v = 6 exp(v), 0 <= v <= 4, unit square; start 0. No bound is active at the least solution; there are more.
Problem bratu_own(Index M, Index N);
/// Pressure in a journal bearing: v >= 0 _|_ -div((1 + e cos x)^3 grad v) - e sin x >= 0 on (0, 2 pi) x (0, 2 b), e =
/// 0.1, b = 10 (MINPACK-2: Averick, Carter, More & Xue 1992, section 4.2). Start max(0, sin x). One solution.
Problem journal_bearing(Index M, Index N);
/// Elastic-plastic torsion: -Laplace v = 5, |v| <= distance from the boundary, unit square (MINPACK-2, section 4.1).
/// Start at the upper bound. One solution.
Problem torsion(Index M, Index N);
/// American put, strike 1, sigma = 0.2, r = 0.06, one year, as one problem in space and time: implicit Euler in M
/// steps, N prices x = log S in (-1, 1),  v_j >= max(0, 1 - e^x)  _|_  v_j + dt L v_j - v_{j-1} >= 0, L v = -sigma^2 /
/// 2 v'' - (r - sigma^2 / 2) v' + r v, v at the ends and v_0 the payoff; rows as they stand. Start: the payoff. One
/// solution if N >= 1 (an M-matrix, not symmetric, block triangular); v - payoff fades to 1e-8 where S > 1.
Problem american_put_own(Index steps, Index N);

/// The maker (M, N) of an entry that comes in any size, by its name; nullptr for others.
using Maker = Problem (*)(Index, Index);
Maker sized(std::string_view name);

/// A problem of random_lcps.hpp under a name; why_none: why there is no solution, where it has a certificate.
Problem of_random(std::string name, RandomLcp made, bool unique, std::string why_none = "");

}  // namespace perp::ncp::collection
