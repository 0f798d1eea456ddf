// SPDX-License-Identifier: Apache-2.0
#include "contact/classics/cylinder.hpp"

#include <algorithm>
#include <cmath>

#include "contact/classics/gauss_seidel.hpp"
#include "contact/classics/trial.hpp"
#include "contact/model/unit_cone.hpp"

namespace perp::contact {
namespace {

/// Sweeps that move r by less than this part of it are rounding.
constexpr double rounding_share = 1e-15;

}  // namespace

CylinderSweeps::CylinderSweeps(Trial& trial, const Scaled& problem)
    : trial_(trial), problem_(problem), contacts_(local_problems<3>(problem)) {
  for (const LocalProblem<3>& contact : contacts_) {
    const double norm = contact.W().bottomRightCorner<2, 2>().cwiseAbs().rowwise().sum().maxCoeff();
    rho_T_.push_back(norm > 0 ? 1 / norm : 0);
  }
}

double CylinderSweeps::sweep(CylinderPart part, const Vec& theta, const Vec& r, MovingImpulses& moving) const {
  double change = 0;
  for (std::size_t a = 0; a < contacts_.size(); ++a) {
    const Scaled::Block& block = problem_.blocks[a];
    const Eigen::Vector3d before = block.of(r);
    Eigen::Vector3d after = before;
    Eigen::Vector3d velocity = moving.velocity<3>(block);
    const Eigen::Matrix3d& W = contacts_[a].W();
    if (part != CylinderPart::Tangential && W(0, 0) > 0) {
      after[0] = std::max(0.0, before[0] - velocity[0] / W(0, 0));
      velocity += W.col(0) * (after[0] - before[0]);
    }
    if (part != CylinderPart::Normal) {
      after.tail<2>() -= rho_T_[a] * velocity.tail<2>();
      after = project_onto_disk(after, theta[static_cast<Index>(a)]);
    }
    change += moving.set<3>(block, after);
  }
  return std::sqrt(change);
}

void CylinderSweeps::solve(CylinderPart part, const Vec& theta, const CylinderLimits& limits, Vec& r, Vec& u) {
  u = problem_.W * r + problem_.q;
  MovingImpulses moving(problem_, r, u);
  for (int k = 0; k < limits.sweeps && !trial_.over(); ++k) {
    const double change = sweep(part, theta, r, moving);
    ++trial_.stats.sweeps;
    if (!(change > std::max(limits.change, rounding_share * r.norm()))) break;
  }
  moving.finish();
}

Vec disk_radii(const Scaled& problem, const Vec& r) {
  Vec theta(static_cast<Index>(problem.blocks.size()));
  for (Index a = 0; a < theta.size(); ++a) theta[a] = std::max(0.0, r[problem.blocks[at(a)].first]);
  return theta;
}

}  // namespace perp::contact
