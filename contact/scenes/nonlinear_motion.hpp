// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the scenes of nonlinear dynamics have in common (contact/solvers/nonlinear.hpp).
#include <cmath>
#include <memory>
#include <utility>

#include "contact/solvers/nonlinear.hpp"
#include "lcp/words.hpp"
#include "ncp/problem/autodiff.hpp"

namespace perp::contact {

/// Coordinates [m, rad] and velocities [m/s, 1/s] at one time.
struct Motion {
  Vec x{};
  Vec v{};
};

/// After a step h that ends with the velocities v: x + h (theta v + (1 - theta) v_k).
inline Motion moved_by(const Motion& at, In v, double h, double theta) {
  return {.x = at.x + h * (theta * v + (1 - theta) * at.v), .v = v};
}

/// Refuses a field of a scene that is not in its range, and motions of another size.
inline void check_field(const char* scene, const char* field, double value, bool valid, const char* range) {
  if (!valid || !std::isfinite(value)) refuse_input(scene, ": ", field, " is ", value, "; it must be ", range);
}
inline void check_motion(const char* scene, const Motion& at, Index size) {
  for (const Vec* part : {&at.x, &at.v})
    if (part->size() != size || !part->allFinite())
      refuse_input(scene, ": the motion has ", part->size(), " entries, or some that are not finite; there must be ",
                   size);
}

/// A gap below this part of the way that forces close within a step is closed: rounding opens contacts at rest.
inline constexpr double closed_gap = 1e-3;

/// How R' is computed: by dual numbers, exact to rounding, or by differences of R, one for each colour of the pattern.
enum class Derivative { Dual, Differences };

/// R of n velocities from one function template (ncp/problem/autodiff.hpp), with either derivative.
template <class Function>
std::shared_ptr<const ncp::Mcp> make_dynamics(Function function, Index n, Derivative derivative, const char* name) {
  std::shared_ptr<const ncp::Mcp> exact =
      ncp::make_autodiff_mcp(std::move(function), {.name = name, .box = ncp::Box::free(n)});
  if (derivative == Derivative::Dual) return exact;
  return ncp::make_mcp(
      {.name = name, .box = ncp::Box::free(n), .pattern = exact->jacobian_pattern(), .F = [exact](In v, ncp::Out R) {
         return exact->eval(v, R);
       }});
}

}  // namespace perp::contact
