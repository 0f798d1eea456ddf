// SPDX-License-Identifier: Apache-2.0
#include "contact/solvers/places.hpp"

#include <algorithm>
#include <cmath>

#include "contact/model/velocities.hpp"

namespace perp::contact {
namespace {

double length(In v, Index first, int width) { return v.segment(first, width).stableNorm(); }

}  // namespace

Place place(const Problem& problem, In r, In u, Index a, In diagonal, double tol) {
  const int d = problem.dimension;
  const int width = problem.disk_width();
  const Index N = d * a;
  const double arm = lever(problem, a);
  const Vec arms = levers(problem, arm);
  const auto velocity = [&](const auto& v) { return v.segment(N, d).cwiseProduct(arms).stableNorm(); };
  const double V = std::max(velocity(problem.q), velocity(u - problem.q));
  const double w = diagonal.segment(N, d).cwiseProduct(arms.cwiseAbs2()).mean();
  const double size = r.segment(N, d).cwiseQuotient(arms).stableNorm();
  const double R = w > 0 ? std::max(size, V / w) : size;
  const auto share = [](double x, double of) { return of > 0 ? x / of : 0.0; };
  // Friction may be mu times as large as what presses.
  const double impulse = share(std::max(1.0, problem.mu[a]) * r[N], R);
  const double parting = share(std::abs(u[N]), V);
  Place out;
  if (impulse <= tol && parting <= tol)
    out.normal = Place::Normal::Touching;
  else
    out.normal = impulse > parting ? Place::Normal::Closed : Place::Normal::Open;
  for (int j = 0; j < (problem.rolls() ? 2 : 1); ++j) {
    Disk disk{.first = N + 1 + j * width, .mu = (j == 0 ? problem.mu : problem.mu_r)[a], .r_N = std::max(r[N], 0.0)};
    disk.speed = length(u, disk.first, width);
    const double slips = share(disk.speed * (j == 0 ? 1 : arm), V);
    disk.rests = slips <= tol;
    const double most = disk.mu * disk.r_N;
    const double force = length(r, disk.first, width);
    const double rest = most > 0 ? 1 - force / most : 0;
    if (disk.mu == 0 || out.normal != Place::Normal::Closed)
      disk.move = disk.rests ? Move::Stick : Move::Slip;
    else if (disk.rests && rest <= tol)
      disk.move = Move::Edge;
    else
      disk.move = slips > rest ? Move::Slip : Move::Stick;
    if (disk.move == Move::Slip)
      disk.along.head(width) = u.segment(disk.first, width) / disk.speed;
    else if (disk.move == Move::Edge)
      disk.along.head(width) = r.segment(disk.first, width) / force;
    out.disks.push_back(disk);
  }
  return out;
}

}  // namespace perp::contact
