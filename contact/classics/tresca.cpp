// SPDX-License-Identifier: Apache-2.0
/// Tresca's friction: a fixed point on the threshold, and Panagiotopoulos' alternation, whose inner problems are parts
/// of the same.
#include "contact/classics/classics.hpp"
#include "contact/classics/cylinder.hpp"
#include "contact/classics/trial.hpp"

namespace perp::contact {
namespace {

/// inner(r, u, limits) once an iteration, whose sweeps end at a part of the change of r in the iteration before.
template <class Method, class Inner>
void fixed_point_on_friction(Trial& trial, const Scaled& problem, const Method& method, Vec r, const Inner& inner) {
  Vec u = problem.W * r + problem.q;
  double change = lcp::infinity;
  for (int k = 0; k < method.max_iterations; ++k) {
    const Vec before = r;
    const double share = std::isfinite(change) ? change : problem.q.norm();
    inner(CylinderLimits{.sweeps = method.inner_sweeps, .change = method.inner_share * share}, r, u);
    change = (r - before).norm();
    if (!r.allFinite() || trial.cheap_step(r, {})) return;
    if (change == 0) break;
  }
  trial.judge_iterate(r, {});
}

template <class Method>
void describe_inner(Method& m, Fields& f) {
  f.add("inner_share", &m.inner_share, strictly_between(0, 1), "sweeps end at this part of the last outer change");
  f.add("inner_sweeps", &m.inner_sweeps, at_least(1), "of one inner problem, at most");
  describe_loop(m.max_iterations, m.scaling, f);
}

}  // namespace

void describe(Tresca& m, Fields& f) { describe_inner(m, f); }
void describe(Panagiotopoulos& m, Fields& f) { describe_inner(m, f); }

void iterate(Trial& trial, const Scaled& problem, const Tresca& method, const Vec& start) {
  CylinderSweeps cylinder(trial, problem);
  const auto inner = [&](const CylinderLimits& limits, Vec& r, Vec& u) {
    cylinder.solve(CylinderPart::Both, disk_radii(problem, r), limits, r, u);
  };
  fixed_point_on_friction(trial, problem, method, start_or_zero(problem, start), inner);
}

void iterate(Trial& trial, const Scaled& problem, const Panagiotopoulos& method, const Vec& start) {
  CylinderSweeps cylinder(trial, problem);
  const auto inner = [&](const CylinderLimits& limits, Vec& r, Vec& u) {
    cylinder.solve(CylinderPart::Normal, {}, limits, r, u);
    cylinder.solve(CylinderPart::Tangential, disk_radii(problem, r), limits, r, u);
  };
  fixed_point_on_friction(trial, problem, method, start_or_zero(problem, start), inner);
}

}  // namespace perp::contact
