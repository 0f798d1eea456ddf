// SPDX-License-Identifier: Apache-2.0
/// Elastohydrodynamic lubrication of a line contact: pressure and gap between a roller and a plane.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "collection/base/build.hpp"
#include "collection/scalable/generators.hpp"

namespace perp::ncp::collection {

namespace {

/// z = (k, p_1 .. p_N), p_0 = p_{N+1} = 0, at the points x_i = xa + i dx.
struct Contact {
  static constexpr double xa = -3, xf = 2;  ///< inlet and outlet, in half widths of the dry contact
  static constexpr double alpha = 2.832;    ///< of the viscosity exp(alpha p)
  static constexpr double lambda = 6.057;   ///< speed over load
  Index N;
  double dx;
  Eigen::MatrixXd G;  ///< h = g + k e + G p: h_j, j = 0 .. N, the gap at xa + (j + 1/2) dx
  Vec g;

  explicit Contact(Index points) : N(points), dx((xf - xa) / static_cast<double>(N)), G(N + 1, N), g(N + 1) {
    G.setZero();
    for (Index j = 0; j <= N; ++j) {
      const double x = xa + (static_cast<double>(j) + 0.5) * dx;
      g[j] = x * x + 1;
      for (Index i = 0; i <= N; ++i) {
        const double to = (static_cast<double>(i - j) - 0.5) * dx;
        const double weight = end_weight(i) * to * std::log(std::abs(to)) / std::numbers::pi;
        if (i < N) G(j, i) += weight;      // p_{i+1}
        if (i > 1) G(j, i - 2) -= weight;  // p_{i-1}
      }
    }
  }
  double end_weight(Index i) const { return i == 0 || i == N ? 0.5 : 1; }
  Vec gap(const Vec& z) const { return g.array() + z[0] + (G * z.tail(N)).array(); }
  /// On other numbers.
  template <class Z>
  Z gap(const Z& z) const {
    Z h = Z::Constant(N + 1, z[0]);
    for (Index j = 0; j <= N; ++j) {
      h[j] += g[j];
      for (Index i = 0; i < N; ++i) h[j] += G(j, i) * z[i + 1];
    }
    return h;
  }

  /// The flow h_j^3 (p_{j+1} - p_j) / exp(alpha (p_{j+1} + p_j) / 2) through gap j without its factor h_j^3, and its
  /// derivatives by p_j and p_{j+1}.
  template <class T>
  struct Flow {
    T value, by_left, by_right;
  };
  template <class Z, class T = typename Z::Scalar>
  Flow<T> flow(const Z& z, Index j) const {
    using std::exp;
    const T left = j > 0 ? T(z[j]) : T(0), right = j < N ? T(z[j + 1]) : T(0);
    const T thin = exp(-alpha * (left + right) / 2);
    const T drop = right - left;
    return {thin * drop, thin * (-1 - alpha / 2 * drop), thin * (1 - alpha / 2 * drop)};
  }

  template <class Z, class Y>
  void excess(const Z& z, Y& F) const {
    using std::pow;
    using T = typename Z::Scalar;
    const Z h = gap(z);
    F[0] = 1;
    for (Index i = 1; i <= N; ++i) F[0] -= 2 * dx / std::numbers::pi * end_weight(i) * z[i];
    T before = pow(h[0], 3) * flow(z, 0).value;
    for (Index i = 1; i <= N; ++i) {
      const T after = pow(h[i], 3) * flow(z, i).value;
      F[i] = lambda / dx * (h[i] - h[i - 1]) - (after - before) / (dx * dx);
      before = after;
    }
  }

  bool slopes(const Vec& z, SpMat& J) const {
    const Vec h = gap(z);
    Eigen::Map<Eigen::MatrixXd> dense(J.valuePtr(), N + 1, N + 1);
    dense.setZero();
    for (Index i = 1; i <= N; ++i) dense(0, i) = -2 * dx / std::numbers::pi * end_weight(i);
    for (Index j = 0; j <= N; ++j) {  // the flow through gap j leaves row j and enters row j + 1
      const Flow f = flow(z, j);
      const double by_gap = 3 * h[j] * h[j] * f.value;
      for (const Index i : {j, j + 1}) {
        if (i < 1 || i > N) continue;
        const double sign = (i == j ? -1 : 1) / (dx * dx);
        const double slope = (i == j ? 1 : -1) * lambda / dx + sign * by_gap;
        dense(i, 0) += slope;
        dense.row(i).tail(N) += slope * G.row(j);
        if (j > 0) dense(i, j) += sign * h[j] * h[j] * h[j] * f.by_left;
        if (j < N) dense(i, j + 1) += sign * h[j] * h[j] * h[j] * f.by_right;
      }
    }
    return all_finite(Eigen::Map<const Vec>(J.valuePtr(), J.nonZeros()));
  }
};

}  // namespace

Problem ehl_kost(Index N) {
  require_between("ehl-kost", "N", N, 3, 10'000);
  const auto contact = std::make_shared<const Contact>(N);  // of F and of J
  Box box = Box::nonnegative(N + 1);
  box.lower[0] = -infinity;
  Names variables{"k"}, equations{"load"};
  for (const auto& [names, letter] : {std::pair(&variables, "p"), {&equations, "reynolds"}})
    for (const std::string& name : indexed(letter, N)) names->push_back(name);
  Functions made = functions_of({"ehl-kost", std::move(box), std::move(variables), std::move(equations)});
  made.F = [contact](In z, Out F) {
    contact->excess(Vec(z), F);
    return all_finite(F);
  };
  made.expression = on_vectors(N + 1, [contact](const auto& x, auto& F) { contact->excess(x, F); });
  made.J = [contact](In z, SpMat& J) { return contact->slopes(z, J); };

  Problem p;
  p.mcp = make_mcp(std::move(made));
  Vec roof(N + 1), dry(N + 1);
  roof[0] = dry[0] = 1.6;
  for (Index i = 1; i <= N; ++i) {
    const double x = Contact::xa + static_cast<double>(i) * contact->dx;
    roof[i] = std::max(0.0, 1 - std::abs(x + 1) / 2);
    dry[i] = std::sqrt(std::max(0.0, 1 - x * x));
  }
  p.starts = {roof, dry};
  return p;
}

}  // namespace perp::ncp::collection
