// SPDX-License-Identifier: Apache-2.0
#include "lcp/iterative/newton_search.hpp"

#include <algorithm>

namespace perp::lcp {

bool SafeStep::operator()(const AffineMcp& problem, NewtonSystem& system, const Equations& at, double reference,
                          Vec& z) const {
  const Vec g = system.gradient(at);
  // A gradient within rounding of the terms it is the sum of is zero.
  Equations sizes{.Phi = at.Phi.cwiseAbs(), .Da = at.Da.cwiseAbs(), .Db = at.Db.cwiseAbs()};
  const Vec terms =
      sizes.Da.cwiseProduct(sizes.Phi) + SpMat(problem.M.cwiseAbs()).transpose() * sizes.Db.cwiseProduct(sizes.Phi);
  if (!g.allFinite() || (g.cwiseAbs() - 1e-12 * terms).maxCoeff() <= 0) return false;
  const auto merit = [&](const Vec& point) { return fb_equations(problem, point).merit(); };
  const auto take = [&](const Vec& d) {
    const double slope = -armijo * g.dot(d);
    if (!(slope > 0)) return false;
    const double t = backtrack(merit, z, d, reference, slope, shortest);
    if (t == 0) return false;
    z += t * d;
    return true;
  };
  const double size = at.Da.squaredNorm() + (at.Db.asDiagonal() * problem.M).squaredNorm();
  double nu = std::min(1.0, at.Phi.norm()) * std::max(1e-8, 1e-6 * size / static_cast<double>(problem.size()));
  Vec d;
  for (int k = 0; k < 4; ++k, nu *= 1e3)
    if (system.levenberg_marquardt(at, nu, d) && take(d)) return true;
  // Cauchy's step along -g: the minimum of ||Phi - s H g||.
  const Vec Hg = at.Da.cwiseProduct(g) + at.Db.cwiseProduct(problem.M * g);
  return take(-(g.squaredNorm() / std::max(Hg.squaredNorm(), 1e-300)) * g);
}

void describe_steps(double& armijo, double& shortest, Fields& f) {
  f.add("newton_armijo", &armijo, strictly_between(0, 0.5), "line search: required share of the predicted decrease");
  f.add("newton_shortest", &shortest, above_up_to(0, 1), "step length below which a direction is given up");
}

}  // namespace perp::lcp
