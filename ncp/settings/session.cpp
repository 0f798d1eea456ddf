// SPDX-License-Identifier: Apache-2.0
#include "ncp/settings/session.hpp"

#include <chrono>
#include <string>
#include <utility>

#include "lcp/judge/refutation.hpp"
#include "ncp/problem/affine.hpp"
#include "ncp/problem/lifted_vi.hpp"
#include "ncp/problem/words.hpp"
#include "ncp/settings/model_notes.hpp"

namespace perp::settings {
namespace {

constexpr double wrong_derivative = 1e-4;  // as ncp::describe

const lcp::Enumeration* enumeration_of(const ncp::Method& method) {
  const auto* affine = std::get_if<ncp::Affine>(&method);
  return affine != nullptr ? std::get_if<lcp::Enumeration>(&affine->method) : nullptr;
}

void check_sides(const Session& session) {
  if (session.settings.sideineq != 2 || session.model == nullptr || session.model->side_inequalities() == 0) return;
  const ncp::Index sides = session.model->side_inequalities();
  throw ncp::ampl::ModelError(side_inequalities_refused,
                              session.mcp.name() + ": the model has " + std::to_string(sides) + " side " +
                                  (sides == 1 ? "inequality" : "inequalities") + ", refused by sideineq = 2");
}

/// ncp::solve would refuse a wrong Jacobian, but not say how good a right one is.
ncp::JacobianCheck checked_derivatives(const Session& session) {
  ncp::check_input(session.mcp, session.x0);
  ncp::JacobianCheck check = ncp::check_jacobian(session.mcp, lcp::project(session.mcp.box(), session.x0));
  if (const std::string wrong = ncp::describe(session.mcp, check, wrong_derivative); !wrong.empty())
    throw InputError(session.mcp.name() + ": " + wrong);
  return check;
}

/// Shows the records up to the first of deflation.
ncp::Observer first_solve_only(ncp::Observer observer) {
  const bool ways = observer.ways;
  ncp::Observer first = [observer = std::move(observer), over = false](const ncp::Iteration& it) mutable {
    over = over || it.attempt.starts_with("deflation");
    return over ? ncp::Next::Continue : observer(it);
  };
  first.ways = ways;
  return first;
}

/// The proof that a variational inequality has no solution, whose certificate is of the problem with multipliers or of
/// the polyhedron alone. Bound 0: none.
ncp::Infeasibility proof_of(const ncp::Mcp& mcp, const lcp::ViResult& vi) {
  const lcp::Polyhedron& C = *mcp.polyhedron();
  const auto affine = ncp::affine_part(mcp);
  ncp::SpMat identity(C.size(), C.size());
  identity.setIdentity();
  const lcp::AffineMcp known = affine ? *affine : lcp::lifted({identity, ncp::Vec::Zero(C.size()), C});
  lcp::Refutation proof = lcp::refutation_by(known, vi.certificate);
  if (!(proof.tolerance > 0)) return {};
  return {.residual_bound = proof.tolerance,
          .certificate = std::make_shared<const lcp::Refutation>(std::move(proof)),
          .multipliers = vi.certificate};
}

/// Gives the result of the problem with multipliers, which there is none of where F is affine, the point and the
/// verdict of the variational inequality. False: that there is no solution has no proof here.
bool judge_by_projection(const ncp::Mcp& mcp, const ncp::Vec& x0, const lcp::ViResult& vi, const ncp::Stop& stop,
                         ncp::Result& result) {
  const lcp::Polyhedron& C = *mcp.polyhedron();
  const bool judged = vi.x.size() == C.size();
  const bool has_multipliers = vi.multipliers.size() == C.A.rows();
  const bool infeasible = vi.status == ncp::Status::Infeasible;
  if (infeasible && result.status == vi.status && result.proof.residual_bound > 0) return true;
  result.x = judged ? ncp::lifted_point(mcp, vi.x, has_multipliers ? vi.multipliers : ncp::Vec::Zero(C.A.rows()))
                    : lcp::project(mcp.box(), x0);
  result.F = ncp::Vec::Zero(mcp.size());
  mcp.eval(result.x, result.F);
  result.residual = ncp::residual(mcp.box(), result.x, result.F);
  if (judged) {
    result.residual.natural = vi.residual;
    result.residual.worst = vi.worst;
  }
  const lcp::Accuracy accuracy = ncp::accuracy(mcp, result.x);
  result.relative = accuracy.relative;
  result.relative_row = accuracy.worst;
  result.stats.iterations = static_cast<int>(vi.iterations);
  result.status = vi.status;
  result.message = vi.message;
  if (result.accepted() && accuracy.relative > stop.tol_relative) {
    result.status = ncp::Status::Stalled;
    result.message += "; the tolerance is met, but |F_i| <= tol_relative t_i is not, off the bounds";
  }
  if (result.accepted()) result.advice.clear();
  if (infeasible) {
    result.notes.clear();
    result.proof = proof_of(mcp, vi);
  }
  return !infeasible || result.proof.residual_bound > 0;
}

}  // namespace

Outcome Session::run() const {
  check_sides(*this);
  if (settings.solutions && enumeration_of(settings.method) != nullptr)
    throw InputError("several solutions: method enumeration lists all of them by itself");
  if (settings.solutions && mcp.polyhedron() != nullptr)
    throw InputError(
        "several solutions: of a variational inequality each x has many multipliers; they are not told apart");
  Outcome outcome;
  ncp::Method method = settings.method;
  ncp::Stop& stop = ncp::stop(method);
  stop.interrupt = interrupt;
  if (std::exchange(stop.check_derivatives, false)) outcome.derivatives = checked_derivatives(*this);
  std::vector<ncp::Observer> observers{ncp::record(outcome.iterations)};
  if (observer) observers.push_back(observer);
  const ncp::Observer shown = ncp::all(std::move(observers));
  ncp::Result& result = outcome.result;
  if (settings.solutions) {
    outcome.several = ncp::solve_all(mcp, x0, method, {.solutions = *settings.solutions}, first_solve_only(shown),
                                     settings.method_name);
    result = outcome.several->found.empty() ? outcome.several->first : outcome.several->found.front().result;
  } else {
    const auto solve = [&] { return result = ncp::solve(mcp, x0, method, shown, settings.basis); };
    if (mcp.polyhedron() == nullptr) {
      solve();
    } else {
      const auto begin = std::chrono::steady_clock::now();
      outcome.vi = ncp::solve_vi(mcp, solve, ncp::vi_limits(stop));
      result.stats.time = std::chrono::steady_clock::now() - begin;
      // An enumeration, say, leaves no multipliers: the methods of the problem with multipliers find their own proof.
      if (!judge_by_projection(mcp, x0, *outcome.vi, stop, result) && solve().status != ncp::Status::Infeasible) {
        result.status = ncp::Status::Stalled;
        result.message = outcome.vi->message + "; no certificate was found";
      }
    }
  }
  if (model != nullptr) add_model_notes(mcp, *model, x0, method, result);

  const lcp::Enumeration* enumeration = result.solved() ? enumeration_of(method) : nullptr;
  const bool verifies = settings.verify && result.accepted();
  if (found && (enumeration != nullptr || verifies)) found(outcome);
  if (enumeration != nullptr) {
    lcp::Limits limits{.tol = stop.tol};
    if (interrupt != nullptr) limits.interrupted = [this] { return interrupt->load(); };
    outcome.all_solutions = lcp::enumerate(*ncp::affine_part(mcp), *enumeration, limits);
  }
  if (verifies) outcome.verified = ncp::verify(mcp, stop.tol, result);
  return outcome;
}

}  // namespace perp::settings
