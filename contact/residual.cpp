#include "contact/residual.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace perp::contact {
namespace {

/// Divisors are not below this.
constexpr double least_scale = 1e-300;

struct Parts {
  double N;  ///< normal
  double T;  ///< size of the tangential part
};

Parts parts(In v, Index a, int d) {
  return {v[d * a], d == 2 ? std::abs(v[d * a + 1]) : std::hypot(v[d * a + 1], v[d * a + 2])};
}

double size(const Parts& p) { return std::hypot(p.N, p.T); }

/// The larger, NaN if there is one.
double larger(double a, double b) { return b <= a ? a : b; }

/// No metric is NaN: what cannot be computed is no solution.
double told(double metric) {
  if (std::isfinite(metric)) return metric;
  return lcp::infinity;
}

/// 1 / mean(diag W), the unit kg of r / u; 1 where W has no positive trace.
double unit(const SpMat& W) {
  const double trace = W.diagonal().sum();
  const double rho = static_cast<double>(W.rows()) / trace;
  return trace > 0 && std::isfinite(rho) ? rho : 1;
}

void check_impulses(const Problem& problem, In r) {
  std::ostringstream why;
  if (r.size() != problem.q.size()) {
    why << "r has " << r.size() << " entries, not " << problem.q.size();
    throw std::invalid_argument(why.str());
  }
  for (Index i = 0; i < r.size(); ++i)
    if (!std::isfinite(r[i])) {
      why << "r[" << i << "] is " << r[i];
      throw std::invalid_argument(why.str());
    }
}

/// e_rho(r) = r - P_K(r - rho uhat), contact by contact.
Vec natural_map(const Problem& problem, In r, const Vec& u, double rho) {
  const int d = problem.dimension;
  Vec e(r.size());
  Vec y(d);
  Vec projected(d);
  for (Index a = 0; a < problem.contacts(); ++a) {
    y = r.segment(d * a, d) - rho * u.segment(d * a, d);
    y[0] -= rho * problem.mu[a] * parts(u, a, d).T;
    project_onto_cone(y, problem.mu[a], projected);
    e.segment(d * a, d) = r.segment(d * a, d) - projected;
  }
  return e;
}

}  // namespace

/// Beyond both cones the point lies on the boundary, at the foot of the perpendicular from (y_N, |y_T|) to the line
/// (c, s) with c = 1 / sqrt(1 + mu^2), s = mu c.
void project_onto_cone(In y, double mu, lcp::Out out) {
  const Index d = y.size();
  const double T = d == 2 ? std::abs(y[1]) : std::hypot(y[1], y[2]);
  if (T <= mu * y[0]) {
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

Residual residual(const Problem& problem, In r) {
  check_impulses(problem, r);
  const int d = problem.dimension;
  const Vec u = problem.W * r + problem.q;
  const double rho = unit(problem.W);
  Residual out;
  const Vec e = natural_map(problem, r, u, rho);
  double worst = -1;
  for (Index a = 0; a < problem.contacts(); ++a) {
    const Parts force = parts(r, a, d);
    const Parts velocity = parts(u, a, d);
    const double mu = problem.mu[a];
    const double power = r.segment(d * a + 1, d - 1).dot(u.segment(d * a + 1, d - 1));
    out.cone = larger(out.cone, larger(force.T - mu * force.N, -force.N));
    out.normal = larger(out.normal, std::abs(std::min(force.N, rho * velocity.N)));
    out.slip = larger(out.slip, std::abs(velocity.T * mu * force.N + power));
    const double part = told(e.segment(d * a, d).stableNorm());
    if (part > worst) {
      worst = part;
      out.worst = a;
    }
  }
  const double q = problem.q.stableNorm();
  const double natural = natural_map(problem, r, u, 1).stableNorm();
  const double sizes = std::max({q, r.stableNorm(), u.stableNorm()});
  const double scaled_sizes = std::max({r.stableNorm(), rho * u.stableNorm(), rho * q});
  out.natural = told(natural);
  out.siconos = told(natural / std::max(sizes, least_scale));
  out.rr9118 = told(natural / std::max(q, least_scale));
  out.scaled = told(e.stableNorm() / std::max(scaled_sizes, least_scale));
  out.cone = told(out.cone);
  out.normal = told(out.normal);
  out.slip = told(out.slip);
  return out;
}

std::vector<ContactState> states(const Problem& problem, In r, double tol) {
  check_impulses(problem, r);
  const int d = problem.dimension;
  const Vec u = problem.W * r + problem.q;
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
