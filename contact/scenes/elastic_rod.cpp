// SPDX-License-Identifier: Apache-2.0
#include "contact/scenes/elastic_rod.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace perp::contact {
namespace {

void check(const ElasticRod& rod, const Motion& at) {
  const auto field = [](const char* name, double value, bool valid, const char* range) {
    check_field("elastic rod", name, value, valid, range);
  };
  field("nodes", static_cast<double>(rod.nodes), rod.nodes >= 2, "at least 2");
  for (const auto& [name, value] : {std::pair{"length", rod.length}, {"mass", rod.mass}, {"h", rod.h}})
    field(name, value, value > 0, "positive");
  for (const auto& [name, value] : {std::pair{"stretching", rod.stretching},
                                    {"hardening", rod.hardening},
                                    {"bending", rod.bending},
                                    {"damping", rod.damping},
                                    {"mu", rod.mu}})
    field(name, value, value >= 0, "at least 0");
  for (const auto& [name, value] : {std::pair{"gravity", rod.gravity}, {"press", rod.press}, {"push", rod.push.sum()}})
    field(name, value, true, "finite");
  field("theta", rod.theta, rod.theta >= 0.5 && rod.theta <= 1, "in [1/2, 1]");
  check_motion("elastic rod", at, 3 * rod.nodes);
}

/// R of the header.
struct RodDynamics {
  ElasticRod rod;
  Motion at;
  Vec force;  // F

  template <class T>
  void operator()(std::span<const T> v, std::span<T> R) const {
    const std::size_t n = v.size();
    std::vector<T> x(n);
    for (std::size_t i = 0; i < n; ++i) {
      const auto k = static_cast<Index>(i);
      const T v_theta = rod.theta * v[i] + (1 - rod.theta) * at.v[k];
      x[i] = at.x[k] + rod.theta * rod.h * v_theta;
      R[i] = rod.mass * (v[i] - at.v[k]) + rod.h * (rod.damping * v_theta - force[k]);
    }
    for (std::size_t i = 0; i + 3 < n; i += 3) stretch<T>(i, x, R);
    for (std::size_t i = 0; i + 6 < n; i += 3) bend<T>(i, x, R);
  }

 private:
  /// h E' of the segment whose first node begins at entry i.
  template <class T>
  void stretch(std::size_t i, const std::vector<T>& x, std::span<T> R) const {
    const double l2 = rod.length * rod.length;
    const std::array<T, 3> d{x[i + 3] - x[i], x[i + 4] - x[i + 1], x[i + 5] - x[i + 2]};
    const T eps = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - l2) / (2 * l2);
    const T tension = rod.h * rod.stretching / rod.length * (eps + rod.hardening * eps * eps * eps);
    for (std::size_t c = 0; c < 3; ++c) {
      R[i + c] = R[i + c] - tension * d[c];
      R[i + 3 + c] = R[i + 3 + c] + tension * d[c];
    }
  }
  /// That of the two segments from there.
  template <class T>
  void bend(std::size_t i, const std::vector<T>& x, std::span<T> R) const {
    const double stiffness = rod.h * rod.bending / (rod.length * rod.length * rod.length);
    for (std::size_t c = i; c < i + 3; ++c) {
      const T moment = stiffness * (x[c] - 2.0 * x[c + 3] + x[c + 6]);
      R[c] = R[c] + moment;
      R[c + 3] = R[c + 3] - 2.0 * moment;
      R[c + 6] = R[c + 6] + moment;
    }
  }
};

}  // namespace

Motion ElasticRod::straight(double height) const {
  Motion at{.x = Vec::Zero(3 * nodes), .v = Vec::Zero(3 * nodes)};
  for (Index i = 0; i < nodes; ++i) at.x.segment<3>(3 * i) = Vec3(length * static_cast<double>(i), 0, height);
  return at;
}

NonlinearProblem ElasticRod::step(const Motion& at, Derivative derivative) const {
  check(*this, at);
  Vec force = Vec::Zero(3 * nodes);
  for (Index i = 0; i < nodes; ++i) force[3 * i + 2] = -mass * gravity - press;
  force.head<3>() += push;
  std::vector<Eigen::Triplet<double>> entries;
  int column = 0;
  for (int i = 0; i < static_cast<int>(nodes); ++i) {
    const double fall = h * h * std::max(0.0, -force[3 * i + 2]) / mass;
    if (at.x[3 * i + 2] + h / 2 * at.v[3 * i + 2] > closed_gap * fall) continue;
    entries.emplace_back(3 * i + 2, column, 1);
    entries.emplace_back(3 * i, column + 1, 1);
    entries.emplace_back(3 * i + 1, column + 2, 1);
    column += 3;
  }
  NonlinearProblem problem{.dimension = 3, .name = "elastic rod"};
  problem.scale = h * force.cwiseAbs();
  problem.R = make_dynamics(RodDynamics{*this, at, std::move(force)}, 3 * nodes, derivative, "elastic rod");
  problem.H = SpMat(3 * nodes, column);
  problem.H.setFromTriplets(entries.begin(), entries.end());
  problem.w = Vec::Zero(column);
  problem.mu = Vec::Constant(column / 3, mu);
  return problem;
}

Motion ElasticRod::moved(const Motion& at, In v) const { return moved_by(at, v, h, theta); }

double ElasticRod::elastic_energy(const Motion& at) const {
  double energy = 0;
  Vec3 last = Vec3::Zero();
  for (Index i = 0; i + 1 < nodes; ++i) {
    const Vec3 d = at.x.segment<3>(3 * i + 3) - at.x.segment<3>(3 * i);
    const double eps = (d.squaredNorm() / (length * length) - 1) / 2;
    energy += stretching * length * (eps * eps / 2 + hardening * eps * eps * eps * eps / 4);
    if (i > 0) energy += bending * (d - last).squaredNorm() / (2 * length * length * length);
    last = d;
  }
  return energy;
}

}  // namespace perp::contact
