#include "ncp/options.hpp"

#include <cmath>

#include "ncp/refusal.hpp"

namespace perp::ncp {

std::optional<std::string> invalid(const Stop& s) {
  if (!(s.tol > 0) || std::isinf(s.tol)) return refusal("stop.tol", s.tol, "positive and finite");
  if (!(s.tol_relative > 0)) return refusal("stop.tol_relative", s.tol_relative, "positive");
  if (s.max_iterations < 0) return refusal("stop.max_iterations", s.max_iterations, "at least 0");
  if (s.max_F_evals < 1) return refusal("stop.max_F_evals", s.max_F_evals, "at least 1");
  if (!(s.max_time.count() >= 0)) return refusal("stop.max_time", s.max_time.count(), "at least 0 s");
  return std::nullopt;
}

std::optional<std::string> invalid(const Armijo& a) {
  if (!(a.sigma > 0 && a.sigma < 1)) return refusal("search.sigma", a.sigma, "in (0, 1)");
  if (!(a.beta > 0 && a.beta < 1)) return refusal("search.beta", a.beta, "in (0, 1)");
  if (a.max_backtracks < 0) return refusal("search.max_backtracks", a.max_backtracks, "at least 0");
  if (a.memory < 1) return refusal("search.memory", a.memory, "at least 1");
  return std::nullopt;
}

std::optional<std::string> invalid(const Escape& e) {
  if (e.rounds < 0) return refusal("escape.rounds", e.rounds, "at least 0");
  if (!(e.lambda > 0) || std::isinf(e.lambda)) return refusal("escape.lambda", e.lambda, "positive and finite");
  if (!(e.grow > 1) || std::isinf(e.grow)) return refusal("escape.grow", e.grow, "greater than 1 and finite");
  if (!(e.shrink > 0 && e.shrink <= 1)) return refusal("escape.shrink", e.shrink, "in (0, 1]");
  if (!(e.accept > 0 && e.accept < 1)) return refusal("escape.accept", e.accept, "in (0, 1)");
  if (e.trial_iterations < 0) return refusal("escape.trial_iterations", e.trial_iterations, "at least 0");
  if (!(e.perturbed_tol > 0) || std::isinf(e.perturbed_tol))
    return refusal("escape.perturbed_tol", e.perturbed_tol, "positive and finite");
  if (e.rescalings < 0 || e.rescalings > 2) return refusal("escape.rescalings", e.rescalings, "0, 1 or 2");
  if (e.perturbed_iterations < 1) return refusal("escape.perturbed_iterations", e.perturbed_iterations, "at least 1");
  return std::nullopt;
}

std::optional<std::string> invalid(const lcp::LemkeOptions& l) {
  if (l.max_pivots < 0) return refusal("lemke.max_pivots", l.max_pivots, "at least 0");
  if (!(l.residual_tol > 0) || std::isinf(l.residual_tol))
    return refusal("lemke.residual_tol", l.residual_tol, "positive and finite");
  if (!(l.pivot_tol > 0 && l.pivot_tol < 1)) return refusal("lemke.pivot_tol", l.pivot_tol, "in (0, 1)");
  if (!(l.feasibility_tol >= 0)) return refusal("lemke.feasibility_tol", l.feasibility_tol, "at least 0");
  if (!(l.perturbation >= 0) || std::isinf(l.perturbation))
    return refusal("lemke.perturbation", l.perturbation, "at least 0 and finite");
  if (!(l.singular_rcond >= 0 && l.singular_rcond < 1))
    return refusal("lemke.singular_rcond", l.singular_rcond, "in [0, 1)");
  if (l.basis.refactor_every < 1) return refusal("lemke.basis.refactor_every", l.basis.refactor_every, "at least 1");
  if (!(l.basis.fill_limit > 0)) return refusal("lemke.basis.fill_limit", l.basis.fill_limit, "positive");
  if (!(l.basis.unstable_tol >= 0 && l.basis.unstable_tol < 1))
    return refusal("lemke.basis.unstable_tol", l.basis.unstable_tol, "in [0, 1)");
  if (!(l.basis.singular_tol >= 0 && l.basis.singular_tol < 1))
    return refusal("lemke.basis.singular_tol", l.basis.singular_tol, "in [0, 1)");
  return std::nullopt;
}

}  // namespace perp::ncp
