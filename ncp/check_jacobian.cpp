#include <algorithm>
#include <cmath>
#include <sstream>

#include "ncp/mcp.hpp"

namespace perp::ncp {
namespace {

/// D := the difference quotient of F in direction e_j; false if F is not defined on either side.
bool difference_column(const Mcp& mcp, In x, In F, Index j, double step, Vec& D) {
  Vec at = x;
  Vec forward(x.size());
  Vec backward(x.size());
  const double h = step * std::max(1.0, std::abs(x[j]));
  at[j] = x[j] + h;
  const double up = at[j];  // x_j + h as the machine has it
  const bool has_forward = mcp.eval(at, forward) && forward.allFinite();
  at[j] = x[j] - h;
  const double down = at[j];
  const bool has_backward = mcp.eval(at, backward) && backward.allFinite();
  if (has_forward && has_backward)
    D = (forward - backward) / (up - down);
  else if (has_forward)
    D = (forward - F) / (up - x[j]);
  else if (has_backward)
    D = (F - backward) / (x[j] - down);
  return has_forward || has_backward;
}

}  // namespace

JacobianCheck check_jacobian(const Mcp& mcp, In x, double step, Index max_columns) {
  const Index n = mcp.size();
  JacobianCheck check;
  Vec F(n);
  SpMat J = mcp.jacobian_pattern();
  if (!mcp.eval(x, F) || !F.allFinite() || !mcp.jacobian(x, J)) {
    check.defined = false;
    return check;
  }
  const Index columns = max_columns < 0 ? n : std::min(n, max_columns);
  Vec D(n);
  Vec given(n);
  Vec in_pattern(n);
  for (Index c = 0; c < columns; ++c) {
    const Index j = c * n / columns;
    if (!difference_column(mcp, x, F, j, step, D)) continue;
    ++check.columns;
    given.setZero();
    in_pattern.setZero();
    for (SpMat::InnerIterator it(J, j); it; ++it) {
      given[it.row()] = it.value();
      in_pattern[it.row()] = 1;
    }
    for (Index i = 0; i < n; ++i) {
      // Rounding in F limits what a difference can tell: F_i eps / h is no mismatch.
      const double noise =
          4 * std::abs(F[i]) * std::numeric_limits<double>::epsilon() / (step * std::max(1.0, std::abs(x[j])));
      const double gap = std::max(0.0, std::abs(given[i] - D[i]) - noise);
      const double error = gap / std::max({1.0, std::abs(given[i]), std::abs(D[i])});
      if (error > check.worst || std::isnan(error)) {
        check.worst = std::isnan(error) ? infinity : error;
        check.row = i;
        check.col = j;
        check.given = given[i];
        check.difference = D[i];
        check.outside_pattern = in_pattern[i] == 0;
      }
    }
  }
  check.defined = n == 0 || check.columns > 0;
  return check;
}

std::string describe(const Mcp& mcp, const JacobianCheck& check, double tol) {
  std::ostringstream text;
  if (!check.defined) return "F or its Jacobian is not defined at the point of the derivative check";
  if (check.worst <= tol) return "";
  text.precision(8);
  text << "the Jacobian does not match F: the derivative of equation " << mcp.equation_name(check.row)
       << " with respect to variable " << mcp.variable_name(check.col) << " is ";
  if (check.outside_pattern)
    text << "missing from the pattern";
  else
    text << "given as " << check.given;
  text << ", differences of F say " << check.difference;
  return text.str();
}

}  // namespace perp::ncp
