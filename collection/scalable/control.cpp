// SPDX-License-Identifier: Apache-2.0
/// Discrete-time optimal control: two states, one control in a box.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "collection/base/model_mcp.hpp"
#include "collection/scalable/generators.hpp"

namespace perp::ncp::collection {

namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

/// min s^-1 sum_{t=1..T} ( |x_t - r_t|^2 + R u_t^2 ) / 2,  x_t = g(x_{t-1}) + (0, b) u_t,  |u_t| <= limit. Stationary
/// where, with adjoints l_t, l_{T+1} = 0, and the rows times s,
///     x_t free:      x_t - r_t - s l_t + s g'(x_t)' l_{t+1} = 0
///     u_t in box:    R u_t + s b l_t,2
///     l_t free:      s (x_t - g(x_{t-1}) - (0, b) u_t) = 0.
/// System: g, linear(i): is g_i linear? its slope g'(x), and curvature(x, l), the Hessian of l'g. Unknowns by stages:
/// x_t, u_t, l_t.
template <class System>
struct Control {
  static constexpr bool affine = System::affine;
  static constexpr Index width = 5;  ///< unknowns of a stage

  System system;
  double s, b, R, limit;
  Vector2d x0;
  Eigen::Matrix2Xd r;  ///< a column a stage

  Index stages() const { return r.cols(); }
  Index size() const { return width * stages(); }
  template <class Z>
  static auto x(Z& z, Index t) {
    return z.template segment<2>(width * t);
  }
  template <class Z>
  static auto& u(Z& z, Index t) {
    return z[width * t + 2];
  }
  template <class Z>
  static auto l(Z& z, Index t) {
    return z.template segment<2>(width * t + 3);
  }
  template <class T>
  Eigen::Matrix<T, 2, 1> next(const Eigen::Matrix<T, 2, 1>& from, const T& control) const {
    return system.g(from) + Eigen::Matrix<T, 2, 1>(T(0), b * control);
  }

  template <class Z, class Y>
  void excess(const Z& z, Y&& F) const {
    using T = typename Z::Scalar;
    using Pair = Eigen::Matrix<T, 2, 1>;
    const T scale(s);
    Pair before = x0.cast<T>();
    for (Index t = 0; t < stages(); ++t) {
      const Pair now = x(z, t);
      const Pair later = t + 1 < stages() ? Pair(l(z, t + 1)) : Pair(T(0), T(0));
      x(F, t) = now - r.col(t).template cast<T>() - scale * (l(z, t) - system.slope(now).transpose() * later);
      F[width * t + 2] = R * z[width * t + 2] + s * b * l(z, t)[1];
      l(F, t) = scale * (now - next(before, T(z[width * t + 2])));
      before = now;
    }
  }

  template <class Visit>
  void slopes(In z, Visit visit) const {
    Matrix2d slope_before = Matrix2d::Zero();  // g'(x_{t-1})
    for (Index t = 0; t < stages(); ++t) {
      const Index row = width * t;
      const Vector2d now = x(z, t);
      const bool last = t + 1 == stages();
      const Matrix2d slope = system.slope(now);
      const Matrix2d curvature = last ? Matrix2d(Matrix2d::Zero()) : system.curvature(now, l(z, t + 1));
      for (Index k = 0; k < 2; ++k) {  // x_t
        for (Index i = 0; i < 2; ++i)
          if (!affine || i == k) visit(row + i, row + k, (i == k ? 1 : 0) + s * curvature(i, k), affine || last);
        visit(row + 3 + k, row + k, s, true);
        if (last) continue;
        for (Index i = 0; i < 2; ++i) visit(row + width + 3 + i, row + k, -s * slope(i, k), System::linear(i));
      }
      visit(row + 2, row + 2, R, true);  // u_t
      visit(row + 4, row + 2, -s * b, true);
      for (Index k = 0; k < 2; ++k) {  // l_t
        for (Index i = 0; t > 0 && i < 2; ++i)
          visit(row - width + i, row + 3 + k, s * slope_before(k, i), System::linear(k));
        visit(row + k, row + 3 + k, -s, true);
        if (k == 1) visit(row + 2, row + 4, s * b, true);
      }
      slope_before = slope;
    }
  }

  static std::string named(Index i, const char* states, const char* controls, const char* adjoints) {
    const std::string t = std::to_string(i / width + 1);
    const Index k = i % width;
    if (k == 2) return element(controls, t);
    return element(k < 2 ? states : adjoints, t + (k == 0 || k == 3 ? ",1" : ",2"));
  }
  std::string variable(Index i) const { return named(i, "x", "u", "lambda"); }
  std::string equation(Index i) const { return named(i, "adjoint", "gradient", "state"); }

  Box box() const {
    Box made{Vec::Constant(size(), -infinity), Vec::Constant(size(), infinity)};
    for (Index t = 0; t < stages(); ++t) {
      u(made.lower, t) = -limit;
      u(made.upper, t) = limit;
    }
    return made;
  }
  /// The states under the controls of z, written into z.
  void simulate(Vec& z) const {
    Vector2d now = x0;
    for (Index t = 0; t < stages(); ++t) x(z, t) = now = next(now, u(z, t));
  }
};

struct Linear {
  static constexpr bool affine = true;
  static constexpr bool linear(Index) { return true; }
  Matrix2d A;
  Vector2d g(const Vector2d& x) const { return A * x; }
  Matrix2d slope(const Vector2d&) const { return A; }
  Matrix2d curvature(const Vector2d&, const Vector2d&) const { return Matrix2d::Zero(); }
};

/// Explicit Euler, step h, for x1' = x2, x2' = (1 - x1^2) x2 - x1.
struct VanDerPol {
  static constexpr bool affine = false;
  static constexpr bool linear(Index i) { return i == 0; }
  double h;
  template <class T>
  Eigen::Matrix<T, 2, 1> g(const Eigen::Matrix<T, 2, 1>& x) const {
    return {x[0] + h * x[1], x[1] + h * ((1 - x[0] * x[0]) * x[1] - x[0])};
  }
  template <class T>
  Eigen::Matrix<T, 2, 2> slope(const Eigen::Matrix<T, 2, 1>& x) const {
    Eigen::Matrix<T, 2, 2> made;
    made << T(1), T(h), -h * (1 + 2 * x[0] * x[1]), 1 + h * (1 - x[0] * x[0]);
    return made;
  }
  Matrix2d curvature(const Vector2d& x, const Vector2d& l) const {
    return -2 * h * l[1] * (Matrix2d() << x[1], x[0], x[0], 0).finished();
  }
};

/// Controls with those at a bound held there and the others free: the value after stage t is x'P_t x / 2 + p_t'x, from
/// the last stage down (Riccati), and the states and adjoints P_t x_t + p_t follow from x_0 on.
Vec riccati(const Control<Linear>& lq, const std::vector<int>& side) {
  const Index T = lq.stages();
  const Matrix2d& A = lq.system.A;
  const Vector2d B(0, lq.b);
  std::vector<Matrix2d> P(static_cast<std::size_t>(T));
  std::vector<Vector2d> p(static_cast<std::size_t>(T)), K(p);
  Vec k(T);
  Matrix2d P_t = Matrix2d::Identity();
  Vector2d p_t = Vector2d::Zero();
  for (Index t = T - 1; t >= 0; --t) {
    const auto at = static_cast<std::size_t>(t);
    P[at] = P_t;
    p[at] = p_t;
    const double curvature = lq.R + B.dot(P_t * B);
    K[at] = side[at] == 0 ? Vector2d(A.transpose() * P_t * B / curvature) : Vector2d(0, 0);
    k[t] = side[at] == 0 ? B.dot(p_t) / curvature : -side[at] * lq.limit;  // u_t = -K'x_{t-1} - k
    p_t = A.transpose() * (p_t - P_t * B * k[t]);
    P_t = Matrix2d::Identity() + A.transpose() * P_t * (A - B * K[at].transpose());
  }
  Vec z(lq.size());
  Vector2d now = lq.x0;
  for (Index t = 0; t < T; ++t) {
    const auto at = static_cast<std::size_t>(t);
    lq.u(z, t) = -K[at].dot(now) - k[t];
    lq.x(z, t) = now = lq.next(now, lq.u(z, t));
    lq.l(z, t) = P[at] * now + p[at];
  }
  return z;
}

/// The solution, by the primal-dual active set method on the controls, a Riccati recursion a step.
std::optional<Vec> clamped_regulator(const Control<Linear>& lq) {
  const Index T = lq.stages();
  std::vector<int> side(static_cast<std::size_t>(T), 0);  // of the box: -1, 0 (inside), 1
  for (int step = 0; step < 100; ++step) {
    Vec z = riccati(lq, side);
    bool settled = true;
    for (Index t = 0; t < T; ++t) {
      const double wanted = -lq.b * lq.l(z, t)[1] / lq.R;
      const int now = wanted > lq.limit ? 1 : wanted < -lq.limit ? -1 : 0;
      settled = settled && now == std::exchange(side[static_cast<std::size_t>(t)], now);
    }
    if (settled) return z;
  }
  return std::nullopt;
}

}  // namespace

Problem lq_control_own(Index T) {
  require_between("lq-control-own", "T", T, 1, 10'000'000);
  const Control<Linear> lq{.system = {(Matrix2d() << 1, 0.1, -0.2, 0.95).finished()},
                           .s = 1,
                           .b = 0.1,
                           .R = 0.05,
                           .limit = 0.3,
                           .x0 = {1, 0.5},
                           .r = Eigen::Matrix2Xd::Zero(2, T)};
  Problem p;
  Vec uncontrolled = Vec::Zero(lq.size());
  lq.simulate(uncontrolled);
  p.starts = {Vec::Zero(lq.size()), std::move(uncontrolled), Vec::Ones(lq.size())};
  if (std::optional<Vec> z = clamped_regulator(lq)) p.solutions = {{"regulator", *std::move(z), 1e-12}};
  p.solutions_complete = !p.solutions.empty();
  p.mcp = make_model("lq-control-own", lq.box(), lq);
  return p;
}

/// Planted: the adjoints are 0.1 (cos 1.3 tau, sin 0.9 tau) (1 - tau / 10) at time tau, the controls follow from them,
/// the states from the controls; then the reference is what makes the adjoint equations hold.
Problem vanderpol_own(Index T) {
  require_between("vanderpol-own", "T", T, 40, 10'000'000);
  constexpr double horizon = 10;
  const double h = horizon / static_cast<double>(T);
  Control<VanDerPol> oscillator{
      .system = {h}, .s = 1 / h, .b = h, .R = 0.05, .limit = 0.75, .x0 = {1, 0}, .r = Eigen::Matrix2Xd::Zero(2, T)};
  using C = Control<VanDerPol>;
  Vec planted(oscillator.size());
  for (Index t = 0; t < T; ++t) {
    const double tau = h * static_cast<double>(t + 1);
    C::l(planted, t) = 0.1 * (1 - tau / horizon) * Vector2d(std::cos(1.3 * tau), std::sin(0.9 * tau));
    C::u(planted, t) = std::clamp(-C::l(planted, t)[1] / oscillator.R, -oscillator.limit, oscillator.limit);
  }
  oscillator.simulate(planted);
  Vec F(oscillator.size());
  oscillator.excess(planted, F);
  for (Index t = 0; t < T; ++t) oscillator.r.col(t) = C::x(F, t);

  Problem p;
  Vec on_reference = Vec::Zero(oscillator.size());
  for (Index t = 0; t < T; ++t) C::x(on_reference, t) = oscillator.r.col(t);
  Vec uncontrolled = Vec::Zero(oscillator.size());
  oscillator.simulate(uncontrolled);
  p.starts = {Vec::Zero(oscillator.size()), std::move(on_reference), std::move(uncontrolled)};
  p.solutions = {{"planted", std::move(planted), 1e-12}};
  const Box box = oscillator.box();
  p.mcp = make_model("vanderpol-own", box, std::move(oscillator));
  return p;
}

}  // namespace perp::ncp::collection
