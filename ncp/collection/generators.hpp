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
/// A problem of random_lcps.hpp under a name; why_none: why there is no solution, where it has a certificate.
Problem of_random(std::string name, RandomLcp made, bool unique, std::string why_none = "");

}  // namespace perp::ncp::collection
