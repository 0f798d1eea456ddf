// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "ncp/problem/counted_mcp.hpp"

namespace perp::ncp {
namespace {

/// Differences of F around x.
class Differences {
 public:
  Differences(CountedMcp& mcp, In x, In F) : mcp_(mcp), x_(x), F_(F) {}

  /// D := the difference quotient of F in direction e_j; false if F is not defined on either side.
  bool column(Index j, double h, Vec& D) {
    Vec at = x_;
    at[j] = x_[j] + h;
    const double up = at[j];  // x_j + h as the machine has it
    const bool has_forward = mcp_.eval(at, forward_);
    at[j] = x_[j] - h;
    const double down = at[j];
    const bool has_backward = mcp_.eval(at, backward_);
    if (has_forward && has_backward)
      D = (forward_ - backward_) / (up - down);
    else if (has_forward)
      D = (forward_ - F_) / (up - x_[j]);
    else if (has_backward)
      D = (F_ - backward_) / (x_[j] - down);
    return has_forward || has_backward;
  }

 private:
  CountedMcp& mcp_;
  const Vec x_, F_;
  Vec forward_, backward_;
};

/// A longer step tells rounding in F from a mismatch; shorter ones tell curvature, and the border of the domain.
constexpr double other_steps[] = {1e2, 1e-2, 1e-4};
constexpr double suspicious = 1e-6;

double relative(double gap, double a, double b) {
  const double error = gap / std::max({1.0, std::abs(a), std::abs(b)});
  if (std::isnan(error)) return infinity;
  return error;
}

/// D and the errors of one column with the step h; where they do not match, the closest of other steps.
bool compare_column(Differences& differences, In F, In given, Index j, double h, Vec& D, Vec& errors) {
  if (!differences.column(j, h, D)) return false;
  for (Index i = 0; i < D.size(); ++i) {
    // Rounding in F limits what a difference can tell: F_i eps / h is no mismatch.
    const double noise = 4 * std::abs(F[i]) * std::numeric_limits<double>::epsilon() / h;
    const double gap = std::abs(given[i] - D[i]);
    errors[i] = relative(gap > noise ? gap - noise : 0, given[i], D[i]);
  }
  Vec other(D.size());
  for (const double factor : other_steps) {
    if (errors.size() == 0 || errors.maxCoeff() <= suspicious) break;
    if (!differences.column(j, factor * h, other)) continue;
    for (Index i = 0; i < D.size(); ++i) {
      const double error = relative(std::abs(given[i] - other[i]), given[i], other[i]);
      if (error >= errors[i]) continue;
      errors[i] = error;
      D[i] = other[i];
    }
  }
  return true;
}

}  // namespace

JacobianCheck check_jacobian(const Mcp& mcp, In x, double step, Index max_columns) {
  const Index n = mcp.size();
  if (x.size() != n)
    throw std::invalid_argument(mcp.name() + ": check_jacobian at a point of " + std::to_string(x.size()) +
                                " entries for " + std::to_string(n) + " variables");
  JacobianCheck check;
  CountedMcp guarded(mcp);
  Vec F(n);
  SpMat J = mcp.jacobian_pattern();
  if (!guarded.eval(x, F) || !guarded.jacobian(x, J)) {
    check.defined = false;
    return check;
  }
  const Index columns = max_columns < 0 ? n : std::min(n, max_columns);
  Differences differences(guarded, x, F);
  Vec D(n);
  Vec given(n);
  Vec in_pattern(n);
  Vec errors(n);
  for (Index c = 0; c < columns; ++c) {
    const Index j = c * n / columns;
    given.setZero();
    in_pattern.setZero();
    for (SpMat::InnerIterator it(J, j); it; ++it) {
      given[it.row()] = it.value();
      in_pattern[it.row()] = 1;
    }
    if (!compare_column(differences, F, given, j, step * std::max(1.0, std::abs(x[j])), D, errors)) continue;
    ++check.columns;
    Index i = 0;
    const double worst = errors.maxCoeff(&i);
    if (!(worst > check.worst)) continue;
    check.worst = worst;
    check.row = i;
    check.col = j;
    check.given = given[i];
    check.difference = D[i];
    check.outside_pattern = in_pattern[i] == 0;
  }
  check.defined = n == 0 || check.columns > 0;
  return check;
}

std::string describe(const Mcp& mcp, const JacobianCheck& check, double tol) {
  std::ostringstream text;
  if (!check.defined) return "F or its Jacobian is not defined at the point of the derivative check";
  if (check.worst <= tol) return "";
  text.precision(8);
  const bool differences = mcp.jacobian_work().by == JacobianWork::By::Differences;
  text << (differences ? "the Jacobian, taken by differences, does not match F: the derivative"
                       : "the Jacobian does not match F: the derivative")
       << " of equation " << mcp.equation_name(check.row) << " with respect to variable "
       << mcp.variable_name(check.col) << " is ";
  if (check.outside_pattern)
    text << "missing from the pattern";
  else
    text << (differences ? "found as " : "given as ") << check.given;
  text << ", differences of F say " << check.difference;
  if (differences && !check.outside_pattern) text << "; see whether F is noisy or steps over a kink, or give J";
  return text.str();
}

}  // namespace perp::ncp
