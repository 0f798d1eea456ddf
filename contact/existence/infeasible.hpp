// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Contact problems without a solution, and the proof. Let y >= 0 have one number a contact, y e_N = y_a in the normal
/// place of contact a, and g = W'(y e_N). For impulses r in K
///     y.u_N = (y e_N).(W r + q) = r.g + q_N.y,     r.g <= |r| |P_K(g)|   (Moreau: g - P_K(g) in -K*),
/// so if q_N.y < 0 no r in K with
///     |r| < R(y) = -q_N.y / |P_K(g)|                                                              (radius, [N s])
/// has u_N >= 0, and if -g in K* contact by contact, that is g_N + mu |g_T| <= 0, R is infinite and no r solves at all.
/// With rolling friction that is g_N + mu |g_T| + mu_r |g_R| <= 0, and |r| has its parts in N s and in N m s.
/// Nothing is asked of W: not symmetry, not semidefiniteness. For symmetric positive semidefinite W, -g in K* is
/// W (y e_N) = 0. Bodies squeezed between walls have such y: weights of contacts that cannot all stop approaching.
///
/// Of bodies, W = H' M^-1 H, that is H (y e_N) = 0: no entry of W is formed, and what is left of H (y e_N), body by
/// body in the norm of M^-1, bounds |g|; of bodies that constraints hold, H (y e_N) = G lambda for some doubles lambda,
/// or a refined W (y e_N) with its bound. A q that was condensed is known to its roundings only (Problem::rounding): so
/// much is taken from -q_N.y. W counts as it is, unless nothing is known of q.
///
/// The same y serves every law whose impulses are in K: polygons inside the disk, no friction. Polygons about the disk
/// reach 1 / cos(pi / K) further: theirs is the problem with mu larger by that.
///
/// The search: max R(y) over y is the least |r| of r in K with (W r + q)_N >= 0 (strong duality). It is made as
///     min over y >= 0, z in K* of |W'(y e_N) + z|^2 + (q_N.y + 1)^2,     of bodies |H (y e_N)|^2 + (q_N.y + 1)^2
/// by nonnegative least squares (conic_nnls.hpp), part by part where contacts fall into parts that do not act on each
/// other: the minimum is 0 where there is a certificate, else the residual (rho, rho_0) gives r = rho / rho_0, which is
/// in K and has u_N >= 0, so that there is none.
/// References: Farkas' lemma for cones (Boyd & Vandenberghe 2004, 5.8); Lawson & Hanson 1974, ch. 23.
#include <atomic>
#include <chrono>
#include <optional>

#include "contact/model/problem.hpp"

namespace perp::contact {

/// R(y), never larger than it is for the given doubles: sums are exact (contact/existence/expansion.hpp), what is
/// rounded is rounded down. Infinite exactly where -W'(y e_N) in K* holds for the given doubles. 0 where y proves
/// nothing: an entry is negative or not finite, q_N.y >= 0, or numbers overflow. Throws std::invalid_argument if y has
/// not n entries.
double infeasibility_radius(const Problem& problem, In y);

/// Whether y proves that there is no solution: R is infinite; or
///  * R >= 1e12 max(1, |q|_inf / |W|_max): no impulses of this world, and
///  * what keeps R finite is rounding: in every contact (g_N + mu |g_T|)+ <= 8 (k + 2) eps t, k the entries that meet
///    there, t = (1 + mu) sum_i y_i max(|W_ij|, sqrt(W_ii W_jj)) the size of what cancels; of bodies, what is left of
///    H (y e_N), or of W (y e_N), is so small beside what cancels. Without this diag(1, 1e-20), q_N = (-1, -1), solved
///    by r_N = (1, 1e20), would be refused.
bool proves_infeasible(const Problem& problem, In y);

struct Infeasible {
  Vec y{};            ///< n, proves_infeasible()
  double radius = 0;  ///< R(y)
};

/// What may stop a search.
struct SearchLimits {
  std::chrono::duration<double> max_time{1};
  const std::atomic<bool>* interrupt = nullptr;  ///< may be null
};
/// Limits of a search after a solve that has `spent` so much of its time: as much again, of what is left, and a tenth
/// of a second at least.
SearchLimits search_after(std::chrono::duration<double> spent, std::chrono::duration<double> of,
                          const std::atomic<bool>* interrupt);

/// Searches for a certificate with few contacts in it, in small whole numbers where those make it exact. Nothing: there
/// is none, none was found, or a limit was reached. Memory is that of W, or of M and H and, with constraints, of at
/// most 5 million entries of K^-1 H, and a dense matrix of at most 600 rows.
std::optional<Infeasible> find_infeasibility(const Problem& problem, const SearchLimits& limits = {});

}  // namespace perp::contact
