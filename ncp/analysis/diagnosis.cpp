// SPDX-License-Identifier: Apache-2.0
#include "ncp/analysis/diagnosis.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "ncp/analysis/structure_report.hpp"
#include "ncp/problem/words.hpp"
#include "ncp/reformulation/merit.hpp"

namespace perp::ncp {
namespace {

/// Beyond this, relative to 1 + |start|, a variable is on its way to infinity.
constexpr double far_away = 1e6;
/// It is already here if it has grown by a factor while the residual fell to a tenth.
constexpr double on_its_way = 1e3;
constexpr double grown = 3;
/// The gradient of Psi counts as zero below this share of the terms it is the sum of.
constexpr double flat_enough = 1e-6;

/// The variables that ran off, the farthest first.
std::vector<Index> run_off(In x, In start, In earlier) {
  const double unit = 1 + start.lpNorm<Eigen::Infinity>();
  std::vector<Index> far;
  for (Index i = 0; i < x.size(); ++i) {
    const double size = std::abs(x[i]);
    const bool grows = earlier.size() == x.size() && size > grown * std::abs(earlier[i]);
    if (size > (grows ? on_its_way : far_away) * unit) far.push_back(i);
  }
  std::ranges::stable_sort(far, std::greater{}, [&](Index i) { return std::abs(x[i]); });
  return far;
}

}  // namespace

Diagnosis diagnose(const Mcp& mcp, const Point& point, In start, const Judged& earlier) {
  Diagnosis out;
  if (point.x.size() == 0) return out;
  if (const std::vector<Index> far = run_off(point.x, start, earlier.x); !far.empty()) {
    const bool one = far.size() == 1;
    const auto places = [&](In x) {
      return listed(far.size(), [&](std::size_t k) { return mcp.variable_name(far[k]) + " = " + number(x[far[k]]); });
    };
    out.unbounded = true;
    out.message =
        std::string("the iterates run off to infinity: ") + (one ? "variable " : "variables ") + places(point.x);
    if (earlier.x.size() == point.x.size())
      out.message += ", after " + places(earlier.x) + " where the residual was " + number(earlier.residual.natural);
    out.advice = std::string("the problem may have no solution: ") + (one ? "bound it" : "bound one of them") +
                 ", or look for a mistake in the model";
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
