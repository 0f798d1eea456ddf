// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Families of test problems of any size. Those with a seed are made of our own random data around a planted solution,
/// reproducible on every platform. All throw std::invalid_argument, naming the argument, for sizes below the stated
/// least.
#include "collection/base/entry.hpp"
#include "collection/random/random_lcps.hpp"

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

/// Linear-quadratic control over T >= 1 stages: x_t = A x_{t-1} + B u_t, A = [1 .1; -.2 .95], B = (0, .1), x_0 = (1,
/// .5), |u_t| <= 0.3, min sum_{t=1..T} (x_t'x_t + 0.05 u_t^2) / 2. 5 T unknowns by stages (x_t, u_t, l_t), l_{T+1} = 0:
///     x_t free:   x_t - l_t + A'l_{t+1} = 0
///     u_t:        0.05 u_t + B'l_t            complements the box
///     l_t free:   x_t - A x_{t-1} - B u_t = 0.
/// M is positive semidefinite and banded. The only solution is given (the program is strictly convex, the adjoints
/// follow from the states): Riccati recursions with the controls at a bound held there. Starts: 0; the states without
/// control; 1.
Problem lq_control_own(Index T);
/// Van der Pol's oscillator x' = f(x) + (0, u), f(x) = (x2, (1 - x1^2) x2 - x1), x(0) = (1, 0), along a reference r for
/// ten units of time in T >= 40 steps h = 10 / T of explicit Euler: min h sum_t (|x_t - r_t|^2 + 0.05 u_t^2) / 2 with
/// |u| <= 0.75. 5 T unknowns by stages as in lq_control_own, in the scale of the differential equations:
///     x_t free:   x_t - r_t - (l_t - l_{t+1}) / h + f'(x_t)'l_{t+1} = 0
///     u_t:        0.05 u_t + l_t,2            complements the box
///     l_t free:   (x_t - x_{t-1}) / h - f(x_{t-1}) - (0, u_t) = 0.
/// r is made for a planted solution, a strict local minimum; there may be more. Starts: 0; the reference; the states
/// without control.
Problem vanderpol_own(Index T);

/// Pressure p and gap h in a lubricated line contact (Kostreva 1984) at 3 <= N <= 10000 points, dx = 5 / N. Unknowns k,
/// free, and p_1 .. p_N >= 0, p_0 = p_{N+1} = 0; dense:
///     F_k = 1 - (2 dx / pi) sum_i w_i p_i
///     F_i = (lambda / dx) (h_i - h_{i-1}) - (Q_i - Q_{i-1}) / dx^2,  Q_j = h_j^3 (p_{j+1} - p_j) / e^{alpha m_j}
///     h_j = y_j^2 + 1 + k + (1 / pi) sum_{i=0..N} w_i d_ij ln|d_ij| (p_{i+1} [i < N] - p_{i-1} [i > 1])
/// with y_j = -3 + (j + 1/2) dx, d_ij = (i - j - 1/2) dx, m_j = (p_{j+1} + p_j) / 2, w_0 = w_N = 1/2, the others 1;
/// alpha = 2.832, lambda = 6.057. Starts, at k = 1.6: p a roof over (-3, 1); the dry contact's sqrt(1 - x^2).
Problem ehl_kost(Index N);

/// Spatial price equilibrium (Samuelson 1952; Takayama & Judge 1964; congestion as in Nagurney 1993): regions >= 2 on a
/// grid with ceil(sqrt(regions)) columns, arcs both ways between neighbours. Shipments x >= 0, prices p >= 0:
///     x_a, from i to j:  p_i + t_a + k_a x_a^2 - p_j
///     p_i:               s_i p_i - d_i exp(-p_i / 10) + shipments in - out.
/// About 5 regions unknowns, sparse. Strictly monotone: the planted solution is the only one. A tenth of the arcs that
/// lead to a dearer region are degenerate there. Starts: x = 0, p = 10; 0; 1.
Problem spatial_price_own(Index regions, unsigned seed);

/// Traffic in Wardrop's equilibrium by destinations (Aashtiani & Magnanti 1981) on M x N nodes, 2 <= M, N <= 4000, with
/// streets both ways between neighbours and four destinations k. Flows v_ak >= 0, times pi_ik >= 0 from node i to k (0
/// at k), d_ik > 0 trips:
///     v_ak, a from i to j:  c_a(sum_k v_ak) + pi_jk - pi_ik
///     pi_ik:                flow to k out of i - flow in - d_ik
/// with c_a(v) = t_a (1 + 0.15 (v / capacity_a)^4) (Bureau of Public Roads). 4 (arcs + nodes - 1) unknowns, about 20 M
/// N, sparse. Monotone: every solution has the planted total flows and times, but the flows by destination may differ,
/// and then J is singular; at 0 it always is. Some shortest ways are unused: degenerate. Starts: all on shortest ways
/// of the empty streets; 0; 1.
Problem traffic_own(Index M, Index N, unsigned seed);

/// A problem of collection/random/random_lcps.hpp under a name; why_none: why there is no solution, where it has a
/// certificate.
Problem of_random(std::string name, RandomLcp made, bool unique, std::string why_none = "");

// The families of collection/random/random_lcps.hpp as problems. Starts: 0; 1.
Problem random_bimatrix_own(Index m, Index n, unsigned seed);
Problem random_copositive_own(Index n, unsigned seed);
Problem random_copositive_plus_own(Index n, unsigned seed);
Problem random_degenerate_own(Index n, unsigned seed);
Problem random_p_own(Index n, unsigned seed);
Problem random_pd_own(Index n, unsigned seed);
Problem random_psd_own(Index n, unsigned seed);
Problem random_strictly_copositive_own(Index n, unsigned seed);
Problem random_z_own(Index n, unsigned seed);
Problem infeasible_monotone_own(Index n, unsigned seed);
Problem infeasible_row_own(Index n, unsigned seed);

}  // namespace perp::ncp::collection
