// SPDX-License-Identifier: Apache-2.0
#include "ncp/analysis/diagnosis.hpp"

#include "ncp/analysis/structure_report.hpp"
#include "ncp/problem/words.hpp"
#include "ncp/reformulation/merit.hpp"

namespace perp::ncp {
namespace {

/// Beyond this, relative to 1 + |start|, a variable is on its way to infinity.
constexpr double far_away = 1e6;
/// The gradient of Psi counts as zero below this share of the terms it is the sum of.
constexpr double flat_enough = 1e-6;

}  // namespace

Diagnosis diagnose(const Mcp& mcp, const Point& point, In start) {
  Diagnosis out;
  if (point.x.size() == 0) return out;
  Index i = 0;
  const double farthest = point.x.cwiseAbs().maxCoeff(&i);
  if (farthest > far_away * (1 + start.lpNorm<Eigen::Infinity>())) {
    out.unbounded = true;
    out.message = "the iterates ran off: variable " + mcp.variable_name(i) + " has come to " + number(point.x[i]);
    out.advice =
        "the problem may have no solution: bound " + mcp.variable_name(i) + ", or look for a mistake in the model";
    return out;
  }
  Linearisation at;
  linearise(fischer_burmeister(), mcp.box(), point, at);
  if (at.stationarity <= flat_enough) {
    out.stationary = true;
    out.message = "the best point is stationary for the Fischer-Burmeister merit 1/2 ||Phi||^2, which is " +
                  number(at.merit) + " there: no step can decrease it";
    out.advice = "the problem may have no solution; otherwise try another start";
  }
  if (const std::string singular = explain_singularity(mcp, point.J, point.x, point.F); !singular.empty()) {
    out.message += (out.message.empty() ? "" : "; ") + singular;
    if (out.advice.empty()) out.advice = "look for a mistake in the equations named; otherwise try another start";
  }
  return out;
}

}  // namespace perp::ncp
