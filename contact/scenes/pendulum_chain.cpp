// SPDX-License-Identifier: Apache-2.0
#include "contact/scenes/pendulum_chain.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace perp::contact {
namespace {

void check(const PendulumChain& chain, const Motion& at) {
  const auto field = [](const char* name, double value, bool valid, const char* range) {
    check_field("pendulum chain", name, value, valid, range);
  };
  field("links", static_cast<double>(chain.links), chain.links >= 1, "at least 1");
  for (const auto& [name, value] : {std::pair{"length", chain.length}, {"mass", chain.mass}, {"h", chain.h}})
    field(name, value, value > 0, "positive");
  for (const auto& [name, value] : {std::pair{"floor", chain.floor}, {"gravity", chain.gravity}})
    field(name, value, true, "finite");
  field("mu", chain.mu, chain.mu >= 0, "at least 0");
  field("e", chain.e, chain.e >= 0 && chain.e <= 1, "in [0, 1]");
  field("theta", chain.theta, chain.theta >= 0.5 && chain.theta <= 1, "in [1/2, 1]");
  check_motion("pendulum chain", at, chain.links);
}

/// R of the header.
struct ChainDynamics {
  PendulumChain chain;
  Motion at;

  template <class T>
  void operator()(std::span<const T> v, std::span<T> R) const {
    using std::cos;
    using std::sin;
    const auto n = static_cast<std::size_t>(chain.links);
    const double theta = chain.theta;
    const double ml2 = chain.mass * chain.length * chain.length;
    std::vector<T> a(n);
    std::vector<T> rate(n);
    for (std::size_t i = 0; i < n; ++i) {
      const auto k = static_cast<Index>(i);
      rate[i] = theta * v[i] + (1 - theta) * at.v[k];
      a[i] = at.x[k] + theta * chain.h * rate[i];
    }
    for (std::size_t i = 0; i < n; ++i) {
      R[i] = chain.h * ml2 * chain.gravity / chain.length * static_cast<double>(n - i) * sin(a[i]);
      for (std::size_t j = 0; j < n; ++j) {
        const double m_ij = ml2 * static_cast<double>(n - std::max(i, j));
        const T gained = v[j] - at.v[static_cast<Index>(j)];
        R[i] = R[i] + m_ij * (cos(a[i] - a[j]) * gained + chain.h * sin(a[i] - a[j]) * rate[j] * rate[j]);
      }
    }
  }
};

}  // namespace

Motion PendulumChain::straight(double angle) const { return {.x = Vec::Constant(links, angle), .v = Vec::Zero(links)}; }

double PendulumChain::height(const Motion& at, Index i) const { return -length * at.x.head(i + 1).array().cos().sum(); }

NonlinearProblem PendulumChain::step(const Motion& at, Derivative derivative) const {
  check(*this, at);
  const Vec up = length * at.x.array().sin();
  const Vec along = length * at.x.array().cos();
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<double> w;
  for (Index i = 0; i < links; ++i) {
    const double U_N = up.head(i + 1).dot(at.v.head(i + 1));
    if (height(at, i) - floor + h / 2 * U_N > closed_gap * h * h * std::max(0.0, gravity)) continue;
    const int column = static_cast<int>(w.size());
    for (int j = 0; j <= static_cast<int>(i); ++j) {
      entries.emplace_back(j, column, up[j]);
      entries.emplace_back(j, column + 1, along[j]);
    }
    w.insert(w.end(), {e * U_N, 0});
  }
  NonlinearProblem problem{.dimension = 2, .name = "pendulum chain"};
  problem.R = make_dynamics(ChainDynamics{*this, at}, links, derivative, "pendulum chain");
  problem.w = Eigen::Map<const Vec>(w.data(), static_cast<Index>(w.size()));
  problem.mu = Vec::Constant(problem.w.size() / 2, mu);
  problem.H = SpMat(links, problem.w.size());
  problem.H.setFromTriplets(entries.begin(), entries.end());
  problem.scale = Vec::Constant(links, h * mass * std::abs(gravity) * length);
  return problem;
}

Motion PendulumChain::moved(const Motion& at, In v) const { return moved_by(at, v, h, theta); }

double PendulumChain::energy(const Motion& at) const {
  double sum = 0;
  double vx = 0;
  double vz = 0;
  for (Index i = 0; i < links; ++i) {
    vx += length * std::cos(at.x[i]) * at.v[i];
    vz += length * std::sin(at.x[i]) * at.v[i];
    sum += mass * (0.5 * (vx * vx + vz * vz) + gravity * height(at, i));
  }
  return sum;
}

}  // namespace perp::contact
