// SPDX-License-Identifier: Apache-2.0
#include "lcp/iterative/newton_system.hpp"

#include <vector>

#include "lcp/fischer_burmeister.hpp"
#include "lcp/linalg/blocks.hpp"

namespace perp::lcp {

Equations fb_equations(const AffineMcp& problem, In z) {
  const Index n = problem.size();
  const Vec F = problem.M * z + problem.q;
  const Box& box = problem.box;
  const Vec degenerate = Vec::NullaryExpr(
      n, [&](Index i) { return F[i] == 0 && (z[i] == box.lower[i] || z[i] == box.upper[i]) ? 1.0 : 0.0; });
  const Vec along = problem.M * degenerate;
  Equations at{.Phi = Vec(n), .Da = Vec(n), .Db = Vec(n)};
  for (Index i = 0; i < n; ++i) {
    const auto fb = [](double a, double b, double ha, double hb) { return fischer_burmeister(a, b, ha, hb); };
    const CValue value = box_row(fb, box.lower[i], box.upper[i], z[i], F[i], degenerate[i], along[i]);
    at.Phi[i] = value.phi;
    at.Da[i] = value.da;
    at.Db[i] = value.db;
  }
  return at;
}

Places places_of(const AffineMcp& problem, In z) {
  const Vec F = problem.M * z + problem.q;
  const Box& box = problem.box;
  Places places(static_cast<std::size_t>(problem.size()), Place::Inside);
  for (Index i = 0; i < problem.size(); ++i) {
    Place& place = places[static_cast<std::size_t>(i)];
    if (box.lower[i] == box.upper[i] || F[i] > z[i] - box.lower[i])
      place = Place::Lower;
    else if (F[i] < z[i] - box.upper[i])
      place = Place::Upper;
  }
  return places;
}

Equations min_equations(const AffineMcp& problem, In z) {
  const Index n = problem.size();
  const Vec F = problem.M * z + problem.q;
  const Places places = places_of(problem, z);
  Equations at{.Phi = F, .Da = Vec::Zero(n), .Db = Vec::Zero(n)};
  for (Index i = 0; i < n; ++i) {
    const Place place = places[static_cast<std::size_t>(i)];
    if (place == Place::Inside) {
      at.Db[i] = 1;
    } else {
      at.Da[i] = 1;
      at.Phi[i] = z[i] - (place == Place::Lower ? problem.box.lower[i] : problem.box.upper[i]);
    }
  }
  return at;
}

NewtonSystem::NewtonSystem(const SpMat& M, LuBackend lu, Deadline deadline) : lu_(lu, deadline), lm_(lu, deadline) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(M.nonZeros() + M.cols()));
  for (Index j = 0; j < M.cols(); ++j) {
    for (SpMat::InnerIterator it(M, j); it; ++it)
      entries.emplace_back(static_cast<int>(it.row()), static_cast<int>(j), it.value());
    entries.emplace_back(static_cast<int>(j), static_cast<int>(j), 0.0);
  }
  M_ = SpMat(M.rows(), M.cols());
  M_.setFromTriplets(entries.begin(), entries.end());
  H_ = M_;
}

void NewtonSystem::fill(const Equations& at) {
  for (Index j = 0; j < M_.cols(); ++j)
    for (int s = M_.outerIndexPtr()[j]; s < M_.outerIndexPtr()[j + 1]; ++s) {
      const Index i = M_.innerIndexPtr()[s];
      H_.valuePtr()[s] = at.Db[i] * M_.valuePtr()[s] + (i == j ? at.Da[i] : 0);
    }
}

bool NewtonSystem::newton(const Equations& at, Vec& d) {
  fill(at);
  ++factorizations_;
  if (!lu_.try_factor(H_)) return false;
  d.resize(at.Phi.size());
  lu_.solve_refined(-at.Phi, d, 1);
  return d.allFinite();
}

bool NewtonSystem::levenberg_marquardt(const Equations& at, double nu, Vec& d) {
  fill(at);
  ++factorizations_;
  return damped_least_squares(lm_, H_, -at.Phi, nu, d);
}

Vec NewtonSystem::gradient(const Equations& at) const {
  return at.Da.cwiseProduct(at.Phi) + M_.transpose() * at.Db.cwiseProduct(at.Phi);
}

}  // namespace perp::lcp
