// SPDX-License-Identifier: Apache-2.0
/// GlockerNcp: any method of ncp/ on Glocker's NCP, with delta continued where the disk row has one.
#include <algorithm>
#include <cmath>

#include "contact/solvers/referee.hpp"

namespace perp::contact {
namespace {

/// delta and eps as shares of tau, as in the homotopy; the first delta of the stages.
constexpr HomotopyOptions shares{};
constexpr double least_stage_delta = 1e-13;
/// The methods' tolerance, in scaled units; what the stages before the last are solved to.
constexpr double loose_tol = 1e-6;
/// The methods stop at a natural residual of the NCP, which says little of the exact law: where they are done and the
/// law is not obeyed yet they go on, to this part of it.
constexpr double tightening = 1e-2;
constexpr double tightest_tol = 1e-14;

/// One call of the method from z, which becomes its end. True: the run is over.
bool run_stage(Referee& referee, const Glocker& mcp, const ncp::Method& method, Vec& z, bool& solved) {
  bool over = false;
  const ncp::Observer judge = [&](const ncp::Iteration& it) {
    if (it.x == nullptr || it.problem != &mcp) return ncp::Next::Continue;
    over = referee.judge(mcp.impulses(lcp::project(mcp.box(), *it.x)),
                         {.by = Origin::Ncp, .letter = it.kind, .tau = it.mu, .step = it.step});
    return over ? ncp::Next::Stop : ncp::Next::Continue;
  };
  const ncp::Result result = ncp::solve(mcp, z, method, judge);
  referee.stats.iterations += result.stats.iterations;
  referee.stats.factorizations += result.stats.factorizations;
  z = result.x;
  solved = result.solved();
  return over || referee.judge(mcp.impulses(z), {.by = Origin::Ncp, .letter = 'C'});
}

/// delta, and with it eps, follows the tau of interior points; they have no use for stages.
void tie(ncp::Method& method, Glocker& mcp, double last_delta) {
  auto* interior = std::get_if<ncp::InteriorPoint>(&method);
  if (interior == nullptr || interior->follow) return;
  interior->stop.tol = std::min(interior->stop.tol, tightest_tol);
  interior->follow = [&mcp, last_delta](double tau) {
    if (!std::isfinite(tau)) return;  // the method ends; no wrong option of the user's
    mcp.set_smoothing(std::clamp(shares.delta_share * tau, std::min(least_stage_delta, last_delta), 1.0),
                      shares.eps_share * tau);
  };
}

}  // namespace

void run_ncp(Referee& referee, const Scaled& problem, const GlockerNcp& method, const Vec& start) {
  GlockerOptions formulation = method.formulation;
  const bool normalised = formulation.row == DiskRow::Normalised;
  const double last_delta = formulation.delta;
  Glocker mcp(problem, formulation);
  Vec z = start.size() > 0 ? mcp.start_at(start) : mcp.start();
  ncp::Method run = method.method;
  if (normalised) tie(run, mcp, last_delta);
  const bool continued = normalised && start.size() == 0 && !std::holds_alternative<ncp::InteriorPoint>(run);
  const int stages = continued ? method.stages : 1;
  ncp::Stop& stop = ncp::stop(run);
  stop.interrupt = referee.interrupt();
  ++referee.stats.attempts;
  for (int stage = 0; stage < stages; ++stage) {
    const bool last = stage + 1 == stages;
    if (stages > 1) {
      const double share = static_cast<double>(stage) / (stages - 1);
      const double first = std::max(shares.delta_share, last_delta);
      mcp.set_smoothing(first * std::pow(last_delta / first, share), formulation.eps);
    }
    const double tol = ncp::stop(method.method).tol;
    stop.tol = std::holds_alternative<ncp::InteriorPoint>(run) ? stop.tol : last ? tol : std::max(loose_tol, tol);
    bool solved = true;
    do {
      stop.max_time = std::chrono::duration<double>(std::max(0.0, referee.seconds_left()));
      if (run_stage(referee, mcp, run, z, solved)) return;
      stop.tol *= tightening;
    } while (last && solved && stop.tol >= tightest_tol);
  }
}

}  // namespace perp::contact
