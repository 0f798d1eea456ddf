// SPDX-License-Identifier: Apache-2.0
#pragma once
/// One step of nonlinear dynamics with contact, (P_MNL) of Acary's lecture 3, Aussois 2010; without friction its (41):
///     R(v) = H r,   u = H'v + w,   K*_mu > u + mu |u_T| e_N  _|_  r in K_mu
/// contact by contact, for v and r. d = `dimension`, n contacts, m degrees of freedom:
///     v   m, velocities at the end of the step [m/s, 1/s of angles]
///     r   d n, impulses [N s]; block a is (N, T1[, T2]) of contact a, r_N >= 0 pushes apart
///     R   R^m -> R^m [N s, N m s]: what the forces other than contact's leave over, M(q(v)) (v - v_k) - h F(q(v), v)
///     H   m x d n, of the positions at which the contacts were found: it does not change with v
///     w   d n [m/s]: e U_N,k of Newton's impact law in the normal parts
/// Newton's method outside: with A = R'(v_k) and W = H' A^-1 H the step to t in (0, 1] solves
///     R_k + A (v - v_k) - H r = (1 - t) (R_k - H r_k)   with the law,                                        (*)
/// which is contact::Problem(W, q), q = H'(v_k - A^-1 (t R_k + (1 - t) H r_k)) + w, for any method. Along t the law
/// holds at every point, so |R - H r| alone says whether a step is good (docs/contact/nonlinear.md).
///
/// What is solved is said of the point (v, r) alone, with A = R'(v) and W there: contact::accepted() of u = H'v + w and
/// r, in the scales of W, and
///     |D^-1 (R - H r)| <= tol max(|D^-1 |H| |r||, |D^-1 |A| |v||, |D^-1 s|),   D = sqrt(|diag A|),
/// s = `scale`. D makes a number without units of rows in N s and in N m s.
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "contact/model/problem.hpp"
#include "contact/model/residual.hpp"
#include "contact/solvers/run.hpp"
#include "contact/solvers/variant.hpp"
#include "ncp/problem/mcp.hpp"

namespace perp::contact {

struct NonlinearProblem {
  int dimension = 3;  ///< d: 2 or 3
  /// R as the F of a problem without bounds: ncp::make_mcp(Functions), with a derivative or by coloured differences,
  /// ncp::make_autodiff_mcp, or an AMPL model.
  std::shared_ptr<const ncp::Mcp> R{};
  SpMat H{};  ///< m x d n
  Vec w{};    ///< d n
  Vec mu{};   ///< n
  /// m or empty: the size of the terms that add up to each entry of R, where they cancel though v and r are small, as
  /// at rest under forces that balance.
  Vec scale{};
  std::string name{};

  Index contacts() const { return mu.size(); }
  Index size() const { return R ? R->size() : 0; }  ///< m
};

/// Throws std::invalid_argument that names the part, its place and the value: no R, bounds on v, sizes that differ, an
/// entry that is not finite, mu < 0, scale < 0, a v that has not m finite entries, or R or R' that is not defined or
/// not finite at v.
void check(const NonlinearProblem& problem, In v);

/// One point (v, r).
struct NonlinearRecord {
  int k = 0;              ///< Newton steps so far
  double dynamics = 0;    ///< |D^-1 (R - H r)| over its scale
  double law = 0;         ///< Residual::largest()
  double step = 0;        ///< t, 0 at the start
  long inner_solves = 0;  ///< for this step
  long inner_steps = 0;   ///< contact::Run::steps() of them
};

struct NonlinearOptions {
  double tol = 1e-8;            ///< of the law and of the dynamics
  Variant inner{};              ///< law and method of the problems (*); only Coulomb's own law can end as Solved
  double inner_share = 0.1;     ///< their tolerance over `tol`
  int max_iterations = 50;      ///< Newton steps
  bool search = true;           ///< shorter t where t = 1 does not decrease |R - H r|
  double decrease = 1e-4;       ///< c: |R - H r| must fall to 1 - c t of what it was
  double shortest_step = 1e-6;  ///< t below which the search gives up
  std::chrono::duration<double> max_time{30};
  const std::atomic<bool>* interrupt = nullptr;  ///< may be null; outlives the solve
  Vec start{};                                   ///< r to begin with, d n; empty: 0
  std::function<void(const NonlinearRecord&)> observer{};
};
void describe(NonlinearOptions& options, ncp::Fields& fields);
/// Says why the options make no sense, if they do not.
std::optional<std::string> invalid(const NonlinearOptions& options);

struct NonlinearStats {
  int iterations = 0;       ///< Newton steps
  long inner_solves = 0;    ///< problems (*)
  long inner_steps = 0;     ///< of their methods
  long R_evals = 0;         ///< without those for R'
  long J_evals = 0;         ///< R'
  long J_R_evals = 0;       ///< evaluations of R for R' by differences
  long factorizations = 0;  ///< of A; the inner methods count their own
  std::chrono::duration<double> time{0};
};

struct NonlinearResult {
  Status status = Status::NoProgress;
  std::string message{};
  Vec v{};              ///< the accepted point, or the last one
  Solution solution{};  ///< r, and u = H'v + w
  Residual residual{};  ///< of Coulomb's law there
  double dynamics = 0;  ///< of R - H r there, relative as above
  NonlinearStats stats{};
  std::vector<NonlinearRecord> history{};
  bool solved() const { return status == Status::Solved; }
};

/// Solves the problem from v. Throws std::invalid_argument for what check() or invalid() refuses and for a start that
/// has not d n finite entries.
NonlinearResult solve(const NonlinearProblem& problem, In v, const NonlinearOptions& options = {});

}  // namespace perp::contact
