// SPDX-License-Identifier: Apache-2.0
#include "lcp/iterative/interior_path.hpp"

#include <algorithm>
#include <cmath>

namespace perp::lcp {
namespace {

/// The diagonal entry of a fixed variable: leaves nothing of its change.
constexpr double of_fixed = 1e20;
/// A quadratic program's delta beside a linear one's: multipliers of 1e6 (LISWET9) move by residuals over delta.
constexpr double of_quadratic = 1e-3;

}  // namespace

InteriorPath::InteriorPath(const SpMat& J, const Box& box, bool affine, double to_boundary, double proximal,
                           LuBackend lu)
    : J_(J),
      box_(box),
      to_boundary_(to_boundary),
      proximal_(proximal),
      system_(J, lu),
      delta_(proximal),
      group_(at(J.rows()), 0) {
  for (Index i = 0; i < size(); ++i) {
    if (box.is_fixed(i)) continue;
    if (box.has_lower(i)) bounds_.push_back({i, 1, box.lower[i]});
    if (box.has_upper(i)) bounds_.push_back({i, -1, box.upper[i]});
  }
  if (affine) find_groups();
}

/// Programs: M is skew between {i: group 0} and {i: group 1}, symmetric within; linear ones have M_ij = 0 there. s of
/// the one and w of the other group are the primal variables.
void InteriorPath::find_groups() {
  const Vec* rows = system_.rows();
  if (!rows) return;
  program_ = linear_ = true;
  for (Index i = 0; i < size(); ++i) group_[at(i)] = (*rows)[i] > 0 ? 0 : 1;
  for (Index j = 0; j < size() && linear_; ++j)
    for (SpMat::InnerIterator it(J_, j); it && linear_; ++it) linear_ = it.value() == 0 || group(it.row()) != group(j);
  if (!linear_) delta_ *= of_quadratic;
}

Vec InteriorPath::nearest(const Vec& z, const Vec& F) {
  Vec shift = Vec::Constant(size(), delta_);
  for (const Bound& b : bounds_) shift[b.i] += 1;
  for (Index i = 0; i < size(); ++i)
    if (box_.is_fixed(i)) shift[i] = of_fixed;
  Vec to = z, part(size());
  if (system_.factor(shift) != LuStatus::Ok) return to;
  for (const std::size_t g : {0U, 1U}) {
    if (g == 1 && !linear_) break;
    const Vec rhs = Vec::NullaryExpr(size(), [&](Index i) { return linear_ && group(i) == g ? 0 : -F[i]; });
    system_.solve(rhs, part);
    for (Index i = 0; i < size(); ++i)
      if ((!linear_ || group(i) == g) && !box_.is_fixed(i)) to[i] += part[i];
  }
  return to;
}

void InteriorPath::open(const Vec& z, const Vec& F) {
  x = {.z = z, .s = Vec(pairs()), .w = Vec(pairs())};
  for (Index p = 0; p < pairs(); ++p) {
    const Bound& b = bounds_[at(p)];
    const double w = b.sign * F[b.i];
    x.s[p] = b.sign * (z[b.i] - b.at);
    x.w[p] = box_.has_lower(b.i) && box_.has_upper(b.i) ? std::max(0.0, w) : w;
  }
  Lengths low{0, 0};
  each_value([&](double& value, std::size_t g) { low[g] = std::max(low[g], -1.5 * value); });
  each_value([&](double& value, std::size_t g) { value += low[g]; });
  Lengths sum{0, 0};
  each_value([&](double& value, std::size_t g) { sum[g] += value; });
  const double product = x.s.dot(x.w);
  const Lengths more{sum[1] > 0 && product > 0 ? product / (2 * sum[1]) : 1,
                     sum[0] > 0 && product > 0 ? product / (2 * sum[0]) : 1};
  each_value([&](double& value, std::size_t g) { value += more[g]; });
}

Vec InteriorPath::halves(const Vec& z, const Vec& F) const {
  Vec t(pairs());
  for (Index p = 0; p < pairs(); ++p) {
    const Bound& b = bounds_[at(p)];
    t[p] = b.sign * (z[b.i] - b.at - F[b.i]);
  }
  return t;
}

void InteriorPath::open_centrally(const Vec& z, const Vec& t, double mu) {
  x = {.z = z, .s = Vec(pairs()), .w = Vec(pairs())};
  for (Index p = 0; p < pairs(); ++p) {
    const double far = (std::abs(t[p]) + std::hypot(t[p], 2 * std::sqrt(mu))) / 2;
    const Bound& b = bounds_[at(p)];
    const bool two = box_.has_lower(b.i) && box_.has_upper(b.i);
    if (!two) x.z[b.i] = b.at;
    move_inside(b, t[p] > 0 ? far : mu / far);
  }
  follow_z();
  x.w = mu * x.s.cwiseInverse();
}

void InteriorPath::open_inside(const Vec& z, double margin) {
  x = {.z = z, .s = Vec(pairs()), .w = Vec(pairs())};
  for (const Bound& b : bounds_) move_inside(b, margin);
  follow_z();
}

/// Moves z_i away from the bound to a distance of at least `least`, or to the middle.
void InteriorPath::move_inside(const Bound& b, double least) {
  const double inside = std::min(least, (box_.upper[b.i] - box_.lower[b.i]) / 2);
  x.z[b.i] = b.sign > 0 ? std::max(x.z[b.i], b.at + inside) : std::min(x.z[b.i], b.at - inside);
}

void InteriorPath::follow_z() {
  for (Index p = 0; p < pairs(); ++p) {
    const Bound& b = bounds_[at(p)];
    x.s[p] = b.sign * (x.z[b.i] - b.at);
  }
}

bool InteriorPath::step_of_free(const Vec& F, Vec& dz) {
  const auto free = [&](Index i) { return box_.is_free(i); };
  if (system_.factor(Vec::NullaryExpr(size(), [&](Index i) { return free(i) ? delta_ : of_fixed; })) != LuStatus::Ok)
    return false;
  system_.solve(Vec::NullaryExpr(size(), [&](Index i) { return free(i) ? -F[i] : 0; }), dz);
  for (Index i = 0; i < size(); ++i)
    if (!free(i)) dz[i] = 0;
  return dz.allFinite();
}

/// f(value, its group) for all s and w.
template <class F>
void InteriorPath::each_value(F f) {
  for (Index p = 0; p < pairs(); ++p) f(x.s[p], group_of(p)), f(x.w[p], 1 - group_of(p));
}

Vec InteriorPath::residual(const Iterate& of, const Vec& F) const {
  Vec r = F;
  for (Index p = 0; p < pairs(); ++p) r[bounds_[at(p)].i] -= bounds_[at(p)].sign * of.w[p];
  for (Index i = 0; i < size(); ++i)
    if (box_.is_fixed(i)) r[i] = 0;
  return r;
}

LuStatus InteriorPath::factor(const Vec& F) {
  Vec theta = Vec::Constant(size(), delta_);
  stiff_.assign(at(size()), -1);
  Vec most = Vec::Ones(size());
  rho_ = Vec(pairs());
  for (Index p = 0; p < pairs(); ++p) {
    const Bound& b = bounds_[at(p)];
    const double ratio = x.w[p] / x.s[p];
    theta[b.i] += ratio;
    if (ratio > most[b.i]) most[b.i] = ratio, stiff_[at(b.i)] = p;
    rho_[p] = b.sign * (x.z[b.i] - b.at) - x.s[p];
  }
  for (Index i = 0; i < size(); ++i)
    if (box_.is_fixed(i)) theta[i] = of_fixed;
  r_ = residual(x, F);
  LuStatus status = system_.factor(theta);
  for (const double more : {1e-6, 1e-2})
    if (status != LuStatus::Ok) status = system_.factor(theta.array() + more);
  return status;
}

InteriorPath::Iterate InteriorPath::newton(double least_target) {
  const double mu = gap(x);
  const Iterate affine = direction(-x.s.cwiseProduct(x.w));
  if (pairs() == 0) return affine;
  const double sigma = std::pow(std::max(0.0, gap_after(affine, reach(affine))) / std::max(mu, 1e-300), 3);
  const double target = std::max(mu * std::min(1.0, sigma), std::min(least_target, 10 * mu));
  Vec c = target - (x.s.cwiseProduct(x.w) + affine.s.cwiseProduct(affine.w)).array();
  Iterate d = direction(c);
  if (least(reach(d)) < 0.1) {  // the corrector leads out of the interior: towards the centre instead
    const Vec centre = 0.5 * mu - x.s.cwiseProduct(x.w).array();
    const Iterate other = direction(centre);
    if (least(reach(other)) > least(reach(d))) c = centre, d = other;
  }
  correct(c, d, target);
  return d;
}

InteriorPath::Iterate InteriorPath::direction(const Vec& c) {
  Vec rhs = -r_;
  for (Index p = 0; p < pairs(); ++p) rhs[bounds_[at(p)].i] += bounds_[at(p)].sign * (c[p] - x.w[p] * rho_[p]) / x.s[p];
  Iterate d{.z = Vec(size()), .s = Vec(pairs()), .w = Vec(pairs())};
  system_.solve(rhs, d.z);
  for (Index p = 0; p < pairs(); ++p) {
    const Bound& b = bounds_[at(p)];
    d.s[p] = b.sign * d.z[b.i] + rho_[p];
    d.w[p] = (c[p] - x.w[p] * d.s[p]) / x.s[p];
  }
  // A difference of large numbers if w / s is large. The equation of the row gives it with all digits.
  Vec row = J_ * d.z + r_;
  for (Index p = 0; p < pairs(); ++p) row[bounds_[at(p)].i] -= bounds_[at(p)].sign * d.w[p];
  for (Index p = 0; p < pairs(); ++p) {
    const Bound& b = bounds_[at(p)];
    if (stiff_[at(b.i)] == p) d.w[p] += b.sign * row[b.i];
  }
  return d;
}

/// Multiple centrality correctors (Gondzio, Comput. Optim. Appl. 6 (1996) 137), more where a factorization takes many
/// solves: they bring the products that a longer step would have near `target`.
void InteriorPath::correct(Vec& c, Iterate& d, double target) {
  const double dearness = system_.dearness();
  const int most = dearness > 50 ? 3 : dearness > 30 ? 2 : dearness > 10 ? 1 : 0;
  for (int k = 0; k < most; ++k) {
    const Lengths alpha = reach(d);
    if (least(alpha) >= 0.95) return;
    Lengths longer = alpha;
    for (double& a : longer) a = std::min(1.0, a + 0.1);
    const Iterate trial = moved(d, longer);
    Vec better = c;
    for (Index p = 0; p < pairs(); ++p) {
      const double product = trial.s[p] * trial.w[p];
      better[p] += std::max(std::clamp(product, 0.1 * target, 10 * target) - product, -10 * target);
    }
    const Iterate e = direction(better);
    const Lengths now = reach(e);
    if (now[0] + now[1] < alpha[0] + alpha[1] + 0.02) return;
    c = better, d = e;
  }
}

InteriorPath::Lengths InteriorPath::reach(const Iterate& d) const {
  Lengths alpha{1, 1};
  for (Index p = 0; p < pairs(); ++p) {
    double& of_s = alpha[group_of(p)];
    double& of_w = alpha[1 - group_of(p)];
    if (d.s[p] < 0) of_s = std::min(of_s, -x.s[p] / d.s[p]);
    if (d.w[p] < 0) of_w = std::min(of_w, -x.w[p] / d.w[p]);
  }
  if (!program_) alpha[0] = alpha[1] = least(alpha);
  return alpha;
}

InteriorPath::Lengths InteriorPath::length(const Iterate& d) const {
  Lengths alpha = reach(d);
  if (pairs() == 0) return alpha;
  for (double& a : alpha) a = std::min(1.0, a * std::max(to_boundary_, 1 - std::max(gap(x), 1e-6)));
  return alpha;
}

InteriorPath::Iterate InteriorPath::moved(const Iterate& d, const Lengths& alpha) const {
  Iterate to = x;
  for (Index i = 0; i < size(); ++i) to.z[i] += alpha[group(i)] * d.z[i];
  for (Index p = 0; p < pairs(); ++p) {
    to.s[p] += alpha[group_of(p)] * d.s[p];
    to.w[p] += alpha[1 - group_of(p)] * d.w[p];
  }
  return to;
}

double InteriorPath::gap_after(const Iterate& d, const Lengths& alpha) const {
  double sum = 0;
  for (Index p = 0; p < pairs(); ++p) {
    const std::size_t g = group_of(p);
    sum += (x.s[p] + alpha[g] * d.s[p]) * (x.w[p] + alpha[1 - g] * d.w[p]);
  }
  return pairs() > 0 ? sum / static_cast<double>(pairs()) : 0;
}

void InteriorPath::adapt_proximal(double alpha, double before, double now) {
  // A step leaves the share 1 - alpha of the residual, and what the proximal term makes.
  const bool stuck = now > (1 - 0.5 * alpha) * before;
  if (!program_ && alpha < 0.1) delta_ = std::min(10 * delta_, 1e2 * proximal_);
  if ((linear_ || alpha > 0.5) && stuck) delta_ = std::max(0.1 * delta_, 1e-4 * proximal_);
}

std::vector<Index> InteriorPath::active() const {
  std::vector<Index> active(at(size()), -1);
  Vec share = Vec::Zero(size());  // of w in the bound that is kept
  for (Index p = 0; p < pairs(); ++p) {
    const Bound& b = bounds_[at(p)];
    if (x.s[p] < x.w[p] && x.w[p] > share[b.i]) active[at(b.i)] = p, share[b.i] = x.w[p];
  }
  return active;
}

}  // namespace perp::lcp
