/// GlockerNcp: any method of ncp/ on Glocker's NCP, with delta continued where the disk row has one.
#include <algorithm>
#include <cmath>
#include <utility>

#include "contact/referee.hpp"

namespace perp::contact {
namespace {

constexpr double first_delta = 0.1;
/// The methods' tolerance, in scaled units; what the stages before the last are solved to.
constexpr double loose_tol = 1e-6;

}  // namespace

void run_ncp(Referee& referee, const Scaled& problem, const GlockerNcp& method, const Vec& start) {
  GlockerOptions formulation = method.formulation;
  const bool continued = method.stages > 1 && formulation.row == DiskRow::Normalised && start.size() == 0;
  const int stages = continued ? method.stages : 1;
  const double last_delta = formulation.delta;
  if (stages > 1) formulation.delta = std::max(first_delta, last_delta);
  Glocker mcp(problem, formulation);
  Vec z = start.size() > 0 ? mcp.start_at(start) : mcp.start();
  ++referee.stats().attempts;
  for (int stage = 0; stage < stages; ++stage) {
    const double share = stages > 1 ? static_cast<double>(stage) / (stages - 1) : 1;
    if (stages > 1)
      mcp.set_smoothing(formulation.delta * std::pow(last_delta / formulation.delta, share), formulation.eps);
    ncp::Method run = method.method;
    ncp::Stop& stop = ncp::stop(run);
    stop.tol = stage + 1 < stages ? std::max(loose_tol, stop.tol) : stop.tol;
    stop.max_time = std::min(stop.max_time, std::chrono::duration<double>(std::max(0.0, referee.seconds_left())));
    stop.interrupt = referee.interrupt();
    auto* interior = std::get_if<ncp::InteriorPoint>(&run);
    if (interior != nullptr && !interior->follow && formulation.row == DiskRow::Normalised)
      interior->follow = [&mcp, last_delta](double tau) {
        mcp.set_smoothing(std::clamp(0.1 * tau, std::min(1e-13, last_delta), 1.0), 0.1 * tau);
      };
    // The exact law decides, and not the NCP's own residual.
    bool over = false;
    const ncp::Observer judge = [&](const ncp::Iteration& it) {
      if (it.x == nullptr || it.problem != &mcp) return ncp::Next::Continue;
      over =
          referee.judge(mcp.impulses(lcp::project(mcp.box(), *it.x)), {.kind = it.kind, .tau = it.mu, .step = it.step});
      return over ? ncp::Next::Stop : ncp::Next::Continue;
    };
    const ncp::Result result = ncp::solve(mcp, z, run, judge);
    referee.stats().iterations += result.stats.iterations;
    referee.stats().factorizations += result.stats.factorizations;
    z = result.x;
    if (over || referee.judge(mcp.impulses(z), {.kind = 'C'})) return;
  }
}

}  // namespace perp::contact
