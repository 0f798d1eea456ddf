// SPDX-License-Identifier: Apache-2.0
#include "contact/scenes/shaken_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "lcp/words.hpp"

namespace perp::contact {
namespace {

/// Block by block: 3 x 3 of each body's translation and rotation.
SpMat inverse_of_blocks(const SpMat& M) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Index i = 0; i < M.rows(); i += 3) {
    const Mat3 block = Mat3(M.block(i, i, 3, 3)).inverse();
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column)
        if (block(row, column) != 0)
          entries.emplace_back(static_cast<int>(i) + row, static_cast<int>(i) + column, block(row, column));
  }
  SpMat inverse(M.rows(), M.cols());
  inverse.setFromTriplets(entries.begin(), entries.end());
  return inverse;
}

}  // namespace

ShakenScene::ShakenScene(const Scene& scene, const Shaking& shaking)
    : shaking_(shaking), first_(scene.problem()), h_(scene.step) {
  if (!std::isfinite(shaking.amplitude)) refuse_input("shaking: the amplitude is ", shaking.amplitude);
  if (!(shaking.frequency >= 0) || !std::isfinite(shaking.frequency))
    refuse_input("shaking: the frequency is ", shaking.frequency, "; it must be at least 0");
  if (!(std::abs(shaking.direction.norm() - 1) < 1e-12))
    refuse_input("shaking: the direction has the length ", shaking.direction.norm(), ", not 1");
  const auto& bodies = scene.bodies.bodies();
  const Index m = 6 * static_cast<Index>(bodies.size());
  weight_ = masses_ = v_ = Vec::Zero(m);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Index at = 6 * static_cast<Index>(i);
    masses_.segment<3>(at).setConstant(bodies[i].mass);
    weight_.segment<3>(at) = h_ * bodies[i].mass * scene.gravity;
    v_.segment<3>(at) = bodies[i].velocity;
    v_.segment<3>(at + 3) = bodies[i].spin;
  }
  M_inverse_ = inverse_of_blocks(first_.global->M);
  gaps_ = Vec::Zero(first_.contacts());
}

Vec ShakenScene::impulse_of_forces() const {
  const double a = shaking_.amplitude * std::sin(2 * std::numbers::pi * shaking_.frequency * (time() + h_ / 2));
  Vec impulse = first_.global->M * v_ + weight_;
  for (Index i = 0; i < impulse.size(); i += 3) impulse.segment<3>(i) += h_ * a * masses_[i] * shaking_.direction;
  return impulse;
}

Problem ShakenScene::problem() const {
  Problem problem = first_;
  problem.global.reset();  // its f is the first step's
  problem.rounding = {};
  problem.q = first_.global->H.transpose() * (M_inverse_ * impulse_of_forces());
  for (Index a = 0; a < gaps_.size(); ++a) problem.q[3 * a] += gaps_[a] / h_;
  return problem;
}

void ShakenScene::advance(In r) {
  const Vec v = M_inverse_ * (impulse_of_forces() + first_.global->H * r);
  const Vec U = first_.global->H.transpose() * v;
  for (Index a = 0; a < gaps_.size(); ++a) gaps_[a] = std::max(0.0, gaps_[a] + h_ * U[3 * a]);
  v_ = v;
  ++steps_;
}

}  // namespace perp::contact
