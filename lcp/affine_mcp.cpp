#include "lcp/affine_mcp.hpp"

#include <cmath>
#include <sstream>

namespace perp::lcp {

std::optional<std::string> AffineMcp::invalid() const {
  std::ostringstream why;
  const Index n = q.size();
  if (M.rows() != n || M.cols() != n || box.lower.size() != n) {
    why << "M is " << M.rows() << " x " << M.cols() << ", q has " << n << " entries, the box has " << box.lower.size();
    return why.str();
  }
  if (auto bad = box.invalid()) return bad;
  for (Index i = 0; i < n; ++i)
    if (!std::isfinite(q[i])) {
      why << "q of index " << i << " is " << q[i];
      return why.str();
    }
  for (Index j = 0; j < n; ++j)
    for (SpMat::InnerIterator it(M, j); it; ++it)
      if (!std::isfinite(it.value())) {
        why << "M of row " << it.row() << ", column " << j << " is " << it.value();
        return why.str();
      }
  return std::nullopt;
}

AffineMcp standard_lcp(SpMat M, Vec q) {
  const Index n = q.size();
  return {std::move(M), std::move(q), Box::nonnegative(n)};
}

double natural_residual(const AffineMcp& problem, In z) {
  const Vec F = problem.M * z + problem.q;
  double worst = 0;
  for (Index i = 0; i < z.size(); ++i) {
    const double r = std::abs(z[i] - project(problem.box, i, z[i] - F[i]));
    if (!(r <= worst)) worst = std::isfinite(r) ? r : infinity;  // a NaN is no small residual
  }
  return worst;
}

}  // namespace perp::lcp
