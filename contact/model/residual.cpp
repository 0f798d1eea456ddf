// SPDX-License-Identifier: Apache-2.0
#include "contact/model/residual.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "contact/model/natural_map.hpp"
#include "contact/model/velocities.hpp"
#include "lcp/words.hpp"

namespace perp::contact {
namespace {

/// Divisors are not below this.
constexpr double least_scale = 1e-300;

using Eigen::Vector2d;

struct Parts {
  double N;      ///< normal
  double T;      ///< size of the tangential part
  double R = 0;  ///< of the rolling part, times or over the contact's lever
};

/// `per_lever`: what the rolling part is multiplied by.
Parts parts(const Problem& problem, In v, Index a, double per_lever) {
  const int width = problem.disk_width();
  const auto length = [&v, width](Index i) { return width == 1 ? std::abs(v[i]) : std::hypot(v[i], v[i + 1]); };
  const Index N = problem.dimension * a;
  return {v[N], length(N + 1), problem.rolls() ? per_lever * length(N + 1 + width) : 0};
}

/// Contact a's part of v, with zeros after it; rolling multiplied by this.
template <int Size>
ContactVector<Size> part(const Problem& problem, In v, Index a, double per_lever) {
  const int d = problem.dimension;
  ContactVector<Size> out = ContactVector<Size>::Zero();
  for (int k = 0; k < d; ++k) out[k] = v[d * a + k];
  if constexpr (disks<Size> == 2) out.tail(Size - 1 - problem.disk_width()) *= per_lever;
  return out;
}

template <int Size>
Frictions<Size> frictions(const Problem& problem, Index a, double lever) {
  if constexpr (disks<Size> == 1)
    return {problem.mu[a]};
  else
    return {problem.mu[a], problem.mu_r[a] / lever};
}

double size(const Parts& p) { return p.R == 0 ? std::hypot(p.N, p.T) : std::hypot(p.N, p.T, p.R); }

/// The larger, NaN if there is one.
double larger(double a, double b) { return b <= a || std::isnan(a) ? a : b; }

/// No metric is NaN: what cannot be computed is no solution.
double told(double metric) {
  if (std::isfinite(metric)) return metric;
  return lcp::infinity;
}

/// 1 / mean(diag W), the unit kg of r / u; 1 where W has no positive trace.
double unit(In diagonal) {
  const double trace = diagonal.sum();
  const double rho = static_cast<double>(diagonal.size()) / trace;
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
template <int Size>
void add_shares(Residual& out, const ContactVector<Size>& r, const ContactVector<Size>& u, const Frictions<Size>& mu,
                int width, double V, double w) {
  const double r_size = r.stableNorm();
  const double R = w > 0 ? std::max(r_size, V / w) : r_size;
  const ContactVector<Size> none = ContactVector<Size>::Zero();
  out.cone_share = larger(out.cone_share, share(natural_map<Size>(r, none, mu, 1, width).stableNorm(), R));
  out.normal_share = larger(out.normal_share, std::abs(std::min(share(r[0], R), share(u[0], V))));
  for (int j = 0; j < disks<Size>; ++j) {
    const Vector2d r_T = disk<Size>(r, j, width).unaryExpr([R](double x) { return share(x, R); });
    const Vector2d u_T = disk<Size>(u, j, width).unaryExpr([V](double x) { return share(x, V); });
    const double most = std::max(mu[at(j)] * share(r[0], R), 0.0);
    const Vector2d y = r_T - u_T;
    const double Y = y.stableNorm();
    const double slip = Y <= most ? u_T.stableNorm() : (r_T - most / Y * y).stableNorm();
    out.slip_share = larger(out.slip_share, slip);
  }
}

}  // namespace

double Residual::largest() const { return std::max({siconos, rr9118, cone_share, normal_share, slip_share}); }

bool accepted(const Residual& residual, double tol) { return residual.largest() <= tol; }

Judge::Judge(const Problem& problem) : problem_(problem), coupled_(coupled_velocities(problem)) {
  Vec diagonal = problem.W.diagonal();
  largest_diagonal_ = diagonal.size() > 0 ? diagonal.maxCoeff() : 0;
  const int d = problem.dimension;
  for (Index a = 0; a < problem.contacts(); ++a) {
    lever_.push_back(lever(problem, a));
    if (problem.rolls()) diagonal.segment(d * a, d).array() *= levers(problem, lever_.back()).array().square();
    diagonal_.push_back(diagonal.segment(d * a, d).mean());
  }
  rho_ = unit(diagonal);
}

Residual Judge::operator()(In r) const {
  Vec u;
  return (*this)(r, u);
}

Residual Judge::operator()(In r, Vec& u) const {
  check_impulses(problem_, r);
  Velocities at_r = exact_velocities(problem_, r, coupled_);
  const Residual out = problem_.rolls() ? judged<5>(r, at_r) : judged<3>(r, at_r);
  u = std::move(at_r.u);
  return out;
}

/// Bounds |W_ij| of a semidefinite W by the largest entry of its diagonal.
std::optional<Residual> Judge::far(In r, double tol) const {
  constexpr double surely = 1e3;
  constexpr double eps = std::numeric_limits<double>::epsilon();
  const Vec u = problem_.W * r + problem_.q;
  Residual out;
  out.natural = told(problem_.rolls() ? natural<5>(r, u) : natural<3>(r, u));
  const double q = problem_.q.stableNorm();
  out.siconos = told(out.natural / std::max({q, r.stableNorm(), told(u.stableNorm()), least_scale}));
  out.rr9118 = told(out.natural / std::max(q, least_scale));
  const auto entries = static_cast<double>(r.size());
  const double rounding = entries * eps * (largest_diagonal_ * r.lpNorm<1>() + q);
  const bool sure =
      std::max(out.siconos, out.rr9118) > surely * tol && out.natural > 10 * std::sqrt(entries) * rounding;
  if (!sure) return {};
  return out;
}

/// Measures in the problem's own units, as the published metrics do.
template <int Size>
double Judge::natural(In r, In u) const {
  const int width = disks<Size> == 1 ? 2 : problem_.disk_width();
  Vec out(problem_.contacts());
  for (Index a = 0; a < problem_.contacts(); ++a)
    out[a] = told(natural_map<Size>(part<Size>(problem_, r, a, 1), part<Size>(problem_, u, a, 1),
                                    frictions<Size>(problem_, a, 1), 1, width)
                      .stableNorm());
  return out.stableNorm();
}

template <int Size>
Residual Judge::judged(In r, const Velocities& at_r) const {
  const Vec Wr = at_r.u - problem_.q;
  const int width = disks<Size> == 1 ? 2 : problem_.disk_width();
  Residual out;
  double worst = -1;
  Vec e_rho(problem_.contacts());
  // r, u and q of all contacts, at their levers.
  Vec sizes_r(problem_.contacts());
  Vec sizes_u(problem_.contacts());
  Vec sizes_q(problem_.contacts());
  for (Index a = 0; a < problem_.contacts(); ++a) {
    const double arm = lever_[at(a)];
    const ContactVector<Size> force = part<Size>(problem_, r, a, 1 / arm);
    const ContactVector<Size> velocity = part<Size>(problem_, at_r.u, a, arm);
    const Frictions<Size> mu = frictions<Size>(problem_, a, arm);
    out.cone = larger(out.cone, -force[0]);
    out.normal = larger(out.normal, std::abs(std::min(force[0], rho_ * velocity[0])));
    for (int j = 0; j < disks<Size>; ++j) {
      const Vector2d r_T = disk<Size>(force, j, width);
      const Vector2d u_T = disk<Size>(velocity, j, width);
      const double most = mu[at(j)] * force[0];
      out.cone = larger(out.cone, std::hypot(r_T[0], r_T[1]) - most);
      out.slip = larger(out.slip, std::abs(std::hypot(u_T[0], u_T[1]) * most + (r_T[0] * u_T[0] + r_T[1] * u_T[1])));
    }
    const auto size_of = [&](const Vec& v) { return part<Size>(problem_, v, a, arm).stableNorm(); };
    sizes_r[a] = force.stableNorm();
    sizes_u[a] = velocity.stableNorm();
    sizes_q[a] = size_of(problem_.q);
    const double V = std::max({sizes_q[a], size_of(Wr), std::min(size_of(at_r.terms), coupled_[at(a)])});
    add_shares<Size>(out, force, velocity, mu, width, V, diagonal_[at(a)]);
    e_rho[a] = told(natural_map<Size>(force, velocity, mu, rho_, width).stableNorm());
    if (e_rho[a] > worst) {
      worst = e_rho[a];
      out.worst = a;
    }
  }
  const double q = problem_.q.stableNorm();
  const double u = told(at_r.u.stableNorm());
  const double sizes = std::max({q, r.stableNorm(), u});
  const double scaled_sizes =
      std::max({sizes_r.stableNorm(), rho_ * told(sizes_u.stableNorm()), rho_ * sizes_q.stableNorm()});
  out.natural = told(natural<Size>(r, at_r.u));
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
  const auto& [r, u] = at;
  double largest_r = 0;
  double largest_u = 0;
  for (Index a = 0; a < problem.contacts(); ++a) {
    const double arm = lever(problem, a);
    largest_r = std::max(largest_r, size(parts(problem, r, a, 1 / arm)));
    largest_u = std::max({largest_u, size(parts(problem, u, a, arm)), size(parts(problem, problem.q, a, arm))});
  }
  std::vector<ContactState> out(static_cast<std::size_t>(problem.contacts()));
  for (Index a = 0; a < problem.contacts(); ++a) {
    const double arm = lever(problem, a);
    const Parts force = parts(problem, r, a, 1 / arm);
    const Parts velocity = parts(problem, u, a, arm);
    const double most = problem.mu[a] * force.N;
    const double most_rolling = problem.rolls() ? problem.mu_r[a] / arm * force.N : 0;
    ContactState& state = out[static_cast<std::size_t>(a)];
    if (size(force) <= tol * largest_r)
      state = {State::Open, velocity.N};
    else if (force.T >= (1 - tol) * most && velocity.T > tol * largest_u)
      state = {State::Slip, velocity.T};
    else if (problem.rolls() && force.R >= (1 - tol) * most_rolling && velocity.R > tol * largest_u)
      state = {State::Roll, velocity.R / arm};
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
    case State::Roll:
      return "roll";
  }
  return "?";
}

}  // namespace perp::contact
