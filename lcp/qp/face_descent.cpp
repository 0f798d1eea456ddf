// SPDX-License-Identifier: Apache-2.0
#include "lcp/qp/face_descent.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace perp::lcp {
namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();
// Of |A| |z| + |q|: below it a residual is rounding. Rows of five entries leave one or two eps.
constexpr double rounding = 4 * eps;
// Of p'D p, D the diagonal: below it p'A p is taken for 0. The smoothest mode of a million unknowns in a row has 1e-11.
constexpr double flat = 1e-13;

double mid(double l, double z, double u) { return z < l ? l : z > u ? u : z; }

class Run {
 public:
  Run(const BoxQp& qp, FacePreconditioner& B, Vec& z, Descent& control)
      : qp_(qp), A_(*qp.A), d_(*qp.diagonal), n_(z.size()), B_(B), z_(z), control_(control) {
    for (Vec* v : {&g_, &size_, &step_, &r_, &y_, &p_, &Ap_}) *v = Vec::Zero(n_);
    free_.resize(at(n_));
  }
  Descent::End descend();

 private:
  enum class Step { Whole, Projected, Refused };
  enum class Cg { Converged, NegativeCurvature, Flat, Limit };

  void sweep();
  void relax(Index i);
  void gradient();
  bool find_face();
  Cg conjugate_gradients(bool tight);
  double curvature();
  Step project_step();
  void step_to_first_bound();
  Descent::End descend_on_face(bool changed, bool tight, bool& met);
  double change(const Vec& dz);
  bool at_rounding(bool settled_and_tight);
  template <class Use>
  void row(Index i, Use use) const {
    const int end = A_.start[at(i) + 1];
    for (int s = A_.start[at(i)]; s < end; ++s) use(A_.column[at(s)], A_.value[at(s)]);
  }

  const BoxQp& qp_;
  const SparseRows& A_;
  const Vec& d_;
  Index n_;
  FacePreconditioner& B_;
  Vec& z_;
  Descent& control_;
  Mask free_;
  Vec g_;     // A z + q
  Vec size_;  // |A| |z| + |q|
  Vec step_;
  Vec r_;
  Vec y_;
  Vec p_;
  Vec Ap_;
  double best_omega_ = infinity;
  int solves_without_progress_ = 0;
  int steps_without_progress_ = 0;
};

void Run::relax(Index i) {
  if (!(d_[i] > 0)) return;
  double sum = qp_.q[i];
  row(i, [&](int j, double a) { sum += a * z_[j]; });
  z_[i] = mid(qp_.lower[i], z_[i] - sum / d_[i], qp_.upper[i]);
}

void Run::sweep() {
  for (Index i = 0; i < n_; ++i) relax(i);
  for (Index i = n_ - 1; i >= 0; --i) relax(i);
}

void Run::gradient() {
  double omega = 0;
  for (Index i = 0; i < n_; ++i) {
    double sum = qp_.q[i];
    double size = std::abs(sum);
    row(i, [&](int j, double a) {
      const double term = a * z_[j];
      sum += term;
      size += std::abs(term);
    });
    g_[i] = sum;
    size_[i] = size;
    if (!std::isfinite(sum) || !std::isfinite(size)) omega = infinity;
    if (!(d_[i] > 0) || size == 0) continue;
    const double moved = std::abs(z_[i] - mid(qp_.lower[i], z_[i] - sum / d_[i], qp_.upper[i]));
    omega = std::max(omega, moved * d_[i] / size);
  }
  control_.omega = omega;
}

/// Whether the face is another than before.
bool Run::find_face() {
  bool changed = false;
  for (Index i = 0; i < n_; ++i) {
    const double slack = rounding * size_[i];
    const bool held = !(d_[i] > 0) || qp_.lower[i] == qp_.upper[i] || (z_[i] <= qp_.lower[i] && g_[i] >= -slack) ||
                      (z_[i] >= qp_.upper[i] && g_[i] <= slack);
    const char now = held ? 0 : 1;
    changed = changed || free_[at(i)] != now;
    free_[at(i)] = now;
  }
  return changed;
}

/// Ap = A p on the face; p'A p.
double Run::curvature() {
  double sum = 0;
  for (Index i = 0; i < n_; ++i) {
    if (!free_[at(i)]) continue;
    double Ap = 0;
    row(i, [&](int j, double a) { Ap += a * p_[j]; });
    Ap_[i] = Ap;
    sum += p_[i] * Ap;
  }
  return sum;
}

/// Preconditioned conjugate gradients for A_FF d_F = -g_F (Hestenes & Stiefel 1952), d in step_.
Run::Cg Run::conjugate_gradients(bool tight) {
  step_.setZero();
  Ap_.setZero();
  for (Index i = 0; i < n_; ++i) r_[i] = free_[at(i)] ? -g_[i] : 0;
  B_.apply(r_, y_);
  p_ = y_;
  double rho = r_.dot(y_);
  const double enough = tight ? 0 : control_.loose * control_.loose * rho;
  for (long k = 0; k < control_.cg_limit; ++k) {
    if (!(rho > 0) || rho <= enough) return Cg::Converged;
    if (control_.limits && control_.limits->reached()) return Cg::Converged;
    ++control_.cg_iterations;
    const double curvature_p = curvature();
    const double scale = p_.cwiseAbs2().dot(d_);
    if (!(curvature_p > flat * scale)) {
      control_.direction = p_;
      return curvature_p < -flat * scale ? Cg::NegativeCurvature : Cg::Flat;
    }
    const double alpha = rho / curvature_p;
    double worst = 0;
    for (Index i = 0; i < n_; ++i) {
      step_[i] += alpha * p_[i];
      r_[i] -= alpha * Ap_[i];
      if (std::abs(r_[i]) > 0.5 * eps * size_[i]) worst = 1;
    }
    if (worst == 0) return Cg::Converged;
    B_.apply(r_, y_);
    const double rho_next = r_.dot(y_);
    p_ = y_ + (rho_next / rho) * p_;
    rho = rho_next;
  }
  return Cg::Limit;
}

/// The objective at z + dz less that at z.
double Run::change(const Vec& dz) {
  double sum = 0;
  for (Index i = 0; i < n_; ++i) {
    if (dz[i] == 0) continue;
    double Adz = 0;
    row(i, [&](int j, double a) { Adz += a * dz[j]; });
    sum += dz[i] * (g_[i] + 0.5 * Adz);
  }
  return sum;
}

/// z <- mid(l, z + t d, u) with t = 1, 1/2, 1/4, 1/8, if that lowers the objective enough.
Run::Step Run::project_step() {
  bool met = false;
  for (Index i = 0; i < n_ && !met; ++i)
    met = step_[i] != 0 && (z_[i] + step_[i] < qp_.lower[i] || z_[i] + step_[i] > qp_.upper[i]);
  if (!met) {
    z_ += step_;
    return Step::Whole;
  }
  constexpr double part = 1e-4;  // of the decrease that the slope promises (Armijo)
  double t = 1;
  for (int halvings = 0; halvings < 4; ++halvings, t /= 2) {
    for (Index i = 0; i < n_; ++i) y_[i] = mid(qp_.lower[i], z_[i] + t * step_[i], qp_.upper[i]) - z_[i];
    const double slope = g_.dot(y_);
    if (!(slope < 0) || !(change(y_) <= part * slope)) continue;
    for (Index i = 0; i < n_; ++i) z_[i] = mid(qp_.lower[i], z_[i] + t * step_[i], qp_.upper[i]);
    return Step::Projected;
  }
  return Step::Refused;
}

/// Moves along d to the first bound, and holds there what is at a bound and would leave the box.
void Run::step_to_first_bound() {
  double t = 1;
  const auto ratio = [&](Index i) {
    const double bound = step_[i] < 0 ? qp_.lower[i] : qp_.upper[i];
    return std::max(0.0, (bound - z_[i]) / step_[i]);
  };
  for (Index i = 0; i < n_; ++i)
    if (step_[i] != 0) t = std::min(t, ratio(i));
  for (Index i = 0; i < n_; ++i) {
    if (step_[i] == 0) continue;
    if (ratio(i) <= t * (1 + 1e-12)) {
      z_[i] = step_[i] < 0 ? qp_.lower[i] : qp_.upper[i];
      free_[at(i)] = 0;
    } else {
      z_[i] = mid(qp_.lower[i], z_[i] + t * step_[i], qp_.upper[i]);
    }
  }
}

/// Whether omega has not fallen to half its best for some steps: three tight solves on a settled face, or ten near the
/// level of rounding, where signs of rounding may make the face flicker.
bool Run::at_rounding(bool settled_and_tight) {
  constexpr double near = 1e-11;
  if (control_.omega < 0.5 * best_omega_) {
    best_omega_ = control_.omega;
    solves_without_progress_ = steps_without_progress_ = 0;
    return false;
  }
  if (settled_and_tight) ++solves_without_progress_;
  ++steps_without_progress_;
  return solves_without_progress_ >= 3 || (best_omega_ <= near && steps_without_progress_ >= 10);
}

/// Steps 3 and 4. Where no projected step lowers the objective it goes to the first bound and on from there on the
/// smaller face, as active set methods do: it ends at the smallest value on some face, and the sweep that follows
/// lowers it or that was the solution, so that no face comes twice. Settled, or why it could not be done; whether a
/// bound was met.
Descent::End Run::descend_on_face(bool changed, bool tight, bool& met) {
  met = false;
  for (;;) {
    if (changed) {
      const FaceStatus status = B_.set_free(free_);
      if (status == FaceStatus::OutOfMemory) return Descent::End::OutOfMemory;
      if (status == FaceStatus::NegativeCurvature) {
        control_.direction = B_.direction;
        return Descent::End::NegativeCurvature;
      }
    }
    const Cg cg = conjugate_gradients(tight);
    if (cg == Cg::NegativeCurvature) return Descent::End::NegativeCurvature;
    if (cg == Cg::Flat) return Descent::End::Flat;
    const Step step = project_step();
    met = met || step != Step::Whole;
    if (cg == Cg::Limit) return Descent::End::Slow;
    if (step != Step::Refused) return Descent::End::Settled;
    if (control_.limits && control_.limits->reached()) return Descent::End::Stopped;
    step_to_first_bound();
    gradient();
    changed = true;
  }
}

Descent::End Run::descend() {
  bool met = true;
  bool tight = false;
  for (control_.steps = 0; control_.steps < control_.step_limit; ++control_.steps) {
    if (control_.limits && control_.limits->reached()) return Descent::End::Stopped;
    sweep();
    gradient();
    if (!std::isfinite(control_.omega)) return Descent::End::Limit;
    if (control_.omega <= rounding) return Descent::End::Solved;
    const bool changed = find_face();
    const bool settled = !changed && !met;
    if (settled && control_.settle_only) return Descent::End::Settled;
    if (at_rounding(settled && tight)) return Descent::End::Solved;
    tight = settled;
    const Descent::End end = descend_on_face(changed, tight, met);
    if (end != Descent::End::Settled) return end;
  }
  return Descent::End::Limit;
}

}  // namespace

Descent::End Descent::run(const BoxQp& qp, FacePreconditioner& B, Vec& z) {
  cg_iterations = steps = 0;
  direction.resize(0);
  return Run(qp, B, z, *this).descend();
}

}  // namespace perp::lcp
