// SPDX-License-Identifier: Apache-2.0
/// Cadoux' fixed point F(s) = s. The convex problem of each s by ADMM (Boyd et al., Found. Trends Mach. Learn. 3 (2011)
/// 1), which is Douglas & Rachford's splitting of W r + q + s e_N and the normal cone of K: W may be singular, and
/// unsymmetric as long as it is monotone.
#include <algorithm>
#include <cmath>
#include <vector>

#include "contact/classics/classics.hpp"
#include "contact/classics/trial.hpp"
#include "contact/model/contact_system.hpp"

namespace perp::contact {
namespace {

/// The penalty is changed by this factor where one residual is so many times the other (Boyd et al., 3.4.1), at most
/// every so many iterations: that costs a factorization.
constexpr double penalty_factor = 4;
constexpr double unbalanced = 10;
constexpr int balanced_every = 20;
constexpr double largest_penalty = 1e8;  // 1 over the least
constexpr double least_inner = 1e-14;

/// x = z - y / rho - (W + rho I)^-1 ..., z = P_K, y the scaled multiplier: kept from one s to the next.
class ConvexContact {
 public:
  ConvexContact(Trial& trial, const Scaled& problem, const Cadoux& method)
      : trial_(trial),
        problem_(problem),
        method_(method),
        vi_(problem),
        system_(problem, lcp::LuBackend::General),
        rho_(method.penalty) {}

  /// Towards the solution for q_s, from z, until both residuals are at most `tol`; false if it cannot go on.
  bool solve(const Vec& q_s, double tol, Vec& z) {
    if (y_.size() == 0) y_ = Vec::Zero(z.size());
    Vec x(z.size());
    for (int k = 1; k <= method_.inner_iterations; ++k) {
      if (trial_.over() || (!factored_ && !factor())) return false;
      ++trial_.stats.sweeps;
      solve(rho_ * (z - y_) - q_s, x);
      const Vec mixed = method_.relaxation * x + (1 - method_.relaxation) * z;
      const Vec before = z;
      z = vi_.project(mixed + y_);
      y_ += mixed - z;
      const double primal = (x - z).norm();
      const double dual = rho_ * (z - before).norm();
      if (!std::isfinite(primal + dual)) return false;
      if (std::max(primal, dual) <= tol) return true;
      if (k % balanced_every == 0) balance(primal, dual);
    }
    return true;
  }

 private:
  /// W + rho I: with factors of the bodies' size where W is by its parts.
  bool factor() {
    const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
    const std::size_t contacts = problem_.blocks.size();
    ++trial_.stats.factorizations;
    factored_ = system_.factor(std::vector<Eigen::Matrix3d>(contacts, rho_ * I),
                               std::vector<Eigen::Matrix3d>(contacts, I / rho_));
    return factored_;
  }

  /// The matrix that was factored by contacts has a little more on its diagonal.
  void solve(const Vec& c, Vec& x) {
    system_.solve(c, x);
    if (system_.form() == ContactSystem::Form::Bodies) return;
    Vec dx(x.size());
    system_.solve(c - problem_.W * x - rho_ * x, dx);
    x += dx;
  }

  void balance(double primal, double dual) {
    const double before = rho_;
    if (primal > unbalanced * dual) rho_ = std::min(largest_penalty, rho_ * penalty_factor);
    if (dual > unbalanced * primal) rho_ = std::max(1 / largest_penalty, rho_ / penalty_factor);
    if (rho_ == before) return;
    y_ *= before / rho_;
    factored_ = false;
  }

  Trial& trial_;
  const Scaled& problem_;
  const Cadoux& method_;
  ContactVi vi_;
  ContactSystem system_;
  double rho_;
  Vec y_;
  bool factored_ = false;
};

}  // namespace

void describe(Cadoux& m, Fields& f) {
  f.add("inner_share", &m.inner_share, strictly_between(0, 1), "ADMM ends at this part of the last outer change");
  f.add("inner_iterations", &m.inner_iterations, at_least(1), "of ADMM, at most");
  f.add("penalty", &m.penalty, above(0), "rho of ADMM in the beginning");
  f.add("relaxation", &m.relaxation, strictly_between(0, 2), "of ADMM");
  describe_loop(m.max_iterations, m.scaling, f);
}

void iterate(Trial& trial, const Scaled& problem, const Cadoux& method, const Vec& start) {
  const ContactVi vi(problem);
  ConvexContact convex(trial, problem, method);
  Vec r = vi.project(start_or_zero(problem, start));
  double tol = method.inner_share * problem.q.norm();
  for (int k = 0; k < method.max_iterations; ++k) {
    const Vec s_e_N = vi.F(r) - (problem.W * r + problem.q);
    const Vec before = r;
    const bool goes_on = convex.solve(problem.q + s_e_N, std::max(least_inner, tol), r);
    if (!r.allFinite() || trial.step(r, {}) || !goes_on) return;
    const double change = (r - before).norm();
    if (change == 0 && tol < least_inner) return;
    tol = method.inner_share * (change > 0 ? change : tol);  // ADMM may have found nothing to do at this tolerance
  }
}

}  // namespace perp::contact
