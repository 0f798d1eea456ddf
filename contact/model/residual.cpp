// SPDX-License-Identifier: Apache-2.0
#include "contact/model/residual.hpp"

#include <algorithm>
#include <cmath>

#include "contact/model/natural_map.hpp"
#include "contact/model/velocities.hpp"
#include "lcp/words.hpp"

namespace perp::contact {
namespace {

/// Divisors are not below this.
constexpr double least_scale = 1e-300;

using Eigen::Vector2d;
using Eigen::Vector3d;

struct Parts {
  double N;  ///< normal
  double T;  ///< size of the tangential part
};

Parts parts(In v, Index a, int d) {
  return {v[d * a], d == 2 ? std::abs(v[d * a + 1]) : std::hypot(v[d * a + 1], v[d * a + 2])};
}

/// (N, T1, T2) of contact a, T2 = 0 in 2D.
Vector3d part(In v, Index a, int d) { return {v[d * a], v[d * a + 1], d == 3 ? v[d * a + 2] : 0}; }

double size(const Parts& p) { return std::hypot(p.N, p.T); }

/// The larger, NaN if there is one.
double larger(double a, double b) { return b <= a || std::isnan(a) ? a : b; }

/// No metric is NaN: what cannot be computed is no solution.
double told(double metric) {
  if (std::isfinite(metric)) return metric;
  return lcp::infinity;
}

/// 1 / mean(diag W), the unit kg of r / u; 1 where W has no positive trace.
double unit(const Delassus& W) {
  const double trace = W.diagonal().sum();
  const double rho = static_cast<double>(W.rows()) / trace;
  return trace > 0 && std::isfinite(rho) ? rho : 1;
}

void check_velocities(const Problem& problem, In u) {
  if (u.size() != problem.q.size()) refuse_input("u has ", u.size(), " entries, not ", problem.q.size());
}

void check_impulses(const Problem& problem, In r) {
  if (r.size() != problem.q.size()) refuse_input("r has ", r.size(), " entries, not ", problem.q.size());
  for (Index i = 0; i < r.size(); ++i)
    if (!std::isfinite(r[i])) refuse_input("r[", i, "] is ", r[i]);
}

/// x in units of what it is compared with.
double share(double x, double scale) {
  if (x == 0) return 0;
  return scale > 0 ? x / scale : std::copysign(lcp::infinity, x);
}

/// Adds contact a's shares to the largest so far.
void add_shares(Residual& out, const Vector3d& r, const Vector3d& u, double mu, double V, double w) {
  const double r_size = r.stableNorm();
  const double R = w > 0 ? std::max(r_size, V / w) : r_size;
  out.cone_share = larger(out.cone_share, share(natural_map(r, Vector3d::Zero(), mu).stableNorm(), R));
  out.normal_share = larger(out.normal_share, std::abs(std::min(share(r[0], R), share(u[0], V))));
  const Vector2d r_T(share(r[1], R), share(r[2], R));
  const Vector2d u_T(share(u[1], V), share(u[2], V));
  const double most = std::max(mu * share(r[0], R), 0.0);
  const Vector2d y = r_T - u_T;
  const double Y = y.stableNorm();
  const double slip = Y <= most ? u_T.stableNorm() : (r_T - most / Y * y).stableNorm();
  out.slip_share = larger(out.slip_share, slip);
}

}  // namespace

/// Beyond both cones the point lies on the boundary, at the foot of the perpendicular from (y_N, |y_T|) to the line
/// (c, s) with c = 1 / sqrt(1 + mu^2), s = mu c.
void project_onto_cone(In y, double mu, lcp::Out out) {
  const Index d = y.size();
  const double T = d == 2 ? std::abs(y[1]) : std::hypot(y[1], y[2]);
  if (y[0] >= 0 && T <= mu * y[0]) {
    out = y;
    return;
  }
  const double c = 1 / std::hypot(1, mu);
  const double s = mu * c;
  const double along = c * y[0] + s * T;
  if (!(along > 0)) {
    out.setZero();
    // A NaN stays one.
    if (std::isnan(along)) out.setConstant(along);
    return;
  }
  out[0] = c * along;
  for (Index k = 1; k < d; ++k) out[k] = T > 0 ? s * along * (y[k] / T) : 0;
}

double Residual::largest() const { return std::max({siconos, rr9118, cone_share, normal_share, slip_share}); }

bool accepted(const Residual& residual, double tol) { return residual.largest() <= tol; }

Judge::Judge(const Problem& problem) : problem_(problem), rho_(unit(problem.W)), coupled_(coupled_velocities(problem)) {
  const Vec diagonal = problem.W.diagonal();
  for (Index a = 0; a < problem.contacts(); ++a)
    diagonal_.push_back(diagonal.segment(problem.dimension * a, problem.dimension).mean());
}

Residual Judge::operator()(In r) const {
  check_impulses(problem_, r);
  const int d = problem_.dimension;
  const Velocities at_r = exact_velocities(problem_, r, coupled_);
  const Vec Wr = at_r.u - problem_.q;
  Residual out;
  double worst = -1;
  Vec natural(problem_.contacts());
  Vec e_rho(problem_.contacts());
  for (Index a = 0; a < problem_.contacts(); ++a) {
    const Vector3d force = part(r, a, d);
    const Vector3d velocity = part(at_r.u, a, d);
    const double mu = problem_.mu[a];
    const double T = std::hypot(force[1], force[2]);
    const double power = force[1] * velocity[1] + force[2] * velocity[2];
    out.cone = larger(out.cone, larger(T - mu * force[0], -force[0]));
    out.normal = larger(out.normal, std::abs(std::min(force[0], rho_ * velocity[0])));
    out.slip = larger(out.slip, std::abs(std::hypot(velocity[1], velocity[2]) * mu * force[0] + power));
    const auto size_of = [&](const Vec& v) { return v.segment(d * a, d).stableNorm(); };
    const double V = std::max({size_of(problem_.q), size_of(Wr), std::min(size_of(at_r.terms), coupled_[at(a)])});
    add_shares(out, force, velocity, mu, V, diagonal_[at(a)]);
    natural[a] = told(natural_map(force, velocity, mu).stableNorm());
    e_rho[a] = told(natural_map(force, velocity, mu, rho_).stableNorm());
    if (e_rho[a] > worst) {
      worst = e_rho[a];
      out.worst = a;
    }
  }
  const double q = problem_.q.stableNorm();
  const double u = told(at_r.u.stableNorm());
  const double sizes = std::max({q, r.stableNorm(), u});
  const double scaled_sizes = std::max({r.stableNorm(), rho_ * u, rho_ * q});
  out.natural = told(natural.stableNorm());
  out.siconos = told(out.natural / std::max(sizes, least_scale));
  out.rr9118 = told(out.natural / std::max(q, least_scale));
  out.scaled = told(e_rho.stableNorm() / std::max(scaled_sizes, least_scale));
  for (double* metric : {&out.cone, &out.normal, &out.slip, &out.cone_share, &out.normal_share, &out.slip_share})
    *metric = told(*metric);
  return out;
}

Residual residual(const Problem& problem, In r) { return Judge(problem)(r); }

std::vector<ContactState> states(const Problem& problem, In r, double tol) {
  check_impulses(problem, r);
  return states(problem, {.r = r, .u = velocities(problem, r)}, tol);
}

std::vector<ContactState> states(const Problem& problem, const Solution& at, double tol) {
  check_impulses(problem, at.r);
  check_velocities(problem, at.u);
  const int d = problem.dimension;
  const auto& [r, u] = at;
  double largest_r = 0;
  double largest_u = 0;
  for (Index a = 0; a < problem.contacts(); ++a) {
    largest_r = std::max(largest_r, size(parts(r, a, d)));
    largest_u = std::max({largest_u, size(parts(u, a, d)), size(parts(problem.q, a, d))});
  }
  std::vector<ContactState> out(static_cast<std::size_t>(problem.contacts()));
  for (Index a = 0; a < problem.contacts(); ++a) {
    const Parts force = parts(r, a, d);
    const Parts velocity = parts(u, a, d);
    const double most = problem.mu[a] * force.N;
    ContactState& state = out[static_cast<std::size_t>(a)];
    if (size(force) <= tol * largest_r)
      state = {State::Open, velocity.N};
    else if (force.T >= (1 - tol) * most && velocity.T > tol * largest_u)
      state = {State::Slip, velocity.T};
    else
      state = {State::Stick, most - force.T};
  }
  return out;
}

const char* name(State state) {
  switch (state) {
    case State::Open:
      return "open";
    case State::Stick:
      return "stick";
    case State::Slip:
      return "slip";
  }
  return "?";
}

}  // namespace perp::contact
