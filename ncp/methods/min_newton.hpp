// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lcp/lu/sparse_lu.hpp"
#include "ncp/run/options.hpp"

namespace perp::ncp {

/// Newton-type methods on the nonsmooth equations  Phi(x) = x - mid(l, x - F(x), u) = 0  (min(x, F(x)) = 0 for the
/// NCP, F(x) = 0 for free variables), damped on their own merit  theta(x) = 1/2 ||Phi(x)||^2  (Pang 1990). The iterates
/// stay in [l, u]. With the rows split by the piece that is active at x,
///     L = {x_i - l_i < F_i},   U = {x_i - u_i > F_i},   I = the rest (and ties by a generic direction),
/// an element H of the B-subdifferential of Phi has the rows e_i' (i in L, U) and F_i'(x) (i in I). Two directions d:
///
///  * Newton:  H d = -Phi(x),  which is  d_L = l_L - x_L,  d_U = u_U - x_U,  J_II d_I = -F_I - J_IA d_A  (A = L and U):
///    one sparse factorization of the inactive block. x+ = pi(x + t d), pi the projection on the box. Where J_II is
///    singular or no t is found, Levenberg-Marquardt steps: the convex QP below with nu/2 ||d||^2 added, nu growing.
///    Base of PROXI (Billups 1995).
///  * ConvexQp:  d solves the convex quadratic program
///        min_d  1/2 ||Phi(x) + H d||^2   over   l <= x + d <= u,
///    the linearised equations in the sense of least squares among the feasible steps; x+ = x + t d. It always has a
///    solution, H singular or not (then one near the least-norm step is taken, nu > 0). With z = 1/2 ||H d||^2,
///    feasibility of d = 0 gives  Phi'H d <= -2 z,  and since Phi_i >= 0 at ties with l_i and <= 0 at ties with u_i in
///    the box,  theta'(x; d) <= Phi'H d  for every choice of H: d descends. NE/SQP (Pang & Gabriel 1993), whose QP and
///    whose theorem are those of the NCP; two-sided boxes and free variables as above (Billups & Ferris 1997).
///
/// Test of a step:  theta(x + t d) <= R + sigma t Phi'H d,  t = 1, beta, beta^2, ...,  R the largest of the last
/// `search.memory` merits. With memory = 1 it implies Pang & Gabriel's  theta(x + t d) - theta(x) <= -2 sigma t z.
///
/// Both converge q-quadratically to solutions where all H are nonsingular (and J is Lipschitz). Every accumulation
/// point of NE/SQP that is "s-regular" is a solution; at other points the QP's d vanishes while theta > 0, and the run
/// ends as StationaryPoint: theta is not differentiable and may have descent directions there that no single H shows.
///
/// References: Pang, Math. Oper. Res. 15 (1990) 311. Pang & Gabriel, Math. Prog. 60 (1993) 295. Billups, thesis,
/// Wisconsin 1995. Billups & Ferris, Math. Prog. 76 (1997) 533.
struct MinNewton {
  enum class Direction { Newton, ConvexQp };

  Stop stop{};
  Direction direction = Direction::Newton;
  Armijo search{};
  lcp::LuBackend lu = lcp::LuBackend::General;  ///< of the Newton steps
};

void describe(MinNewton& method, Fields& fields);
inline std::string_view name_of(const MinNewton& method) {
  return method.direction == MinNewton::Direction::Newton ? "newton-min" : "nesqp";
}
void iterate(Run& run, const MinNewton& method, Point point);

}  // namespace perp::ncp
