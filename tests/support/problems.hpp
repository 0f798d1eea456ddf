// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Nonlinear MCPs for the tests, written from their papers and not taken from collection, and a judge of solutions
/// that shares nothing with the library's.
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ncp/problem/mcp.hpp"
#include "support/matrices.hpp"

namespace perp::support {

using ncp::In;
using ncp::Mcp;
using ncp::Out;
using Problem = std::unique_ptr<Mcp>;

/// A small problem with dense J. Undefined where F or J holds a NaN or an infinity.
inline ncp::Functions dense(std::string name, Box box, std::function<Vec(const Vec&)> F,
                            std::function<Dense(const Vec&)> J) {
  const Index n = box.size();
  return {.name = std::move(name),
          .box = std::move(box),
          .pattern = ncp::dense_pattern(n),
          .F =
              [F = std::move(F)](In x, Out out) {
                out = F(x);
                return out.allFinite();
              },
          .J =
              [J = std::move(J)](In x, SpMat& out) {
                const Dense value = J(x);
                Eigen::Map<Dense>(out.valuePtr(), value.rows(), value.cols()) = value;
                return value.allFinite();
              }};
}

/// One equation or complementarity condition.
inline ncp::Functions scalar(double lower, double upper, std::function<double(double)> F,
                             std::function<double(double)> J) {
  return dense(
      "scalar", {vec({lower}), vec({upper})}, [F = std::move(F)](const Vec& x) { return vec({F(x[0])}); },
      [J = std::move(J)](const Vec& x) { return Dense::Constant(1, 1, J(x[0])); });
}

/// F(x) = M x + q.
inline ncp::Functions affine(const AffineMcp& problem) {
  SpMat M = problem.M;
  M.makeCompressed();
  return {.name = "affine",
          .box = problem.box,
          .pattern = M,
          .F =
              [M, q = problem.q](In x, Out F) {
                F = M * x + q;
                return true;
              },
          .J =
              [M](In, SpMat& J) {
                J = M;
                return true;
              }};
}

/// Kojima & Shindo 1986 (`josephy` = false), solutions (sqrt6/2, 0, 0, 1/2), where x_3 and F_3 are both 0, and (1, 0,
/// 3, 0); Josephy 1979, solution (sqrt6/2, 0, 0, 1/2).
inline ncp::Functions kojima_shindo(bool josephy = false) {
  const double c = josephy ? 3 : 10;
  const double d = josephy ? 3 : 9;
  const double e = josephy ? 1 : 9;
  return dense(
      josephy ? "josephy" : "kojima-shindo", Box::nonnegative(4),
      [=](const Vec& z) {
        return vec({3 * z[0] * z[0] + 2 * z[0] * z[1] + 2 * z[1] * z[1] + z[2] + 3 * z[3] - 6,
                    2 * z[0] * z[0] + z[0] + z[1] * z[1] + c * z[2] + 2 * z[3] - 2,
                    3 * z[0] * z[0] + z[0] * z[1] + 2 * z[1] * z[1] + 2 * z[2] + d * z[3] - e,
                    z[0] * z[0] + 3 * z[1] * z[1] + 2 * z[2] + 3 * z[3] - 3});
      },
      [=](const Vec& z) {
        Dense J(4, 4);
        J << 6 * z[0] + 2 * z[1], 2 * z[0] + 4 * z[1], 1, 3,  //
            4 * z[0] + 1, 2 * z[1], c, 2,                     //
            6 * z[0] + z[1], z[0] + 4 * z[1], 2, d,           //
            2 * z[0], 6 * z[1], 2, 3;
        return J;
      });
}

/// The starts that papers on the two use.
inline std::vector<Vec> kojima_shindo_starts() {
  return {Vec::Zero(4),      Vec::Ones(4),      Vec::Constant(4, 100), vec({1, 0, 1, 0}),
          vec({1, 0, 0, 0}), vec({0, 1, 1, 0}), vec({0, 1, 0, 1}),     vec({1.25, 0, 0, 0.5})};
}

/// Billups 1995: 0 <= x _|_ (x - 1)^2 - 1.01 >= 0. Solution 1 + sqrt(1.01); the merit functions have a local minimum
/// near 0 that is none.
inline ncp::Functions billups() {
  return scalar(
      0, infinity, [](double x) { return (x - 1) * (x - 1) - 1.01; }, [](double x) { return 2 * (x - 1); });
}

/// The Nash-Cournot game of ten firms (Harker 1988): with Q = sum q, p = (5000 / Q)^(1 / gamma),
/// F_i = c_i + (L q_i)^(1 / beta_i) - p + q_i p / (gamma Q). Undefined for q_i < 0, and F' is infinite at q_i = 0.
inline ncp::Functions nash10() {
  const Vec c = vec({5, 3, 8, 5, 1, 3, 7, 4, 6, 3});
  const Vec b = vec({1.2, 1, 0.9, 0.6, 1.5, 1, 0.7, 1.1, 0.95, 0.75}).cwiseInverse();
  constexpr double L = 10;
  constexpr double gamma = 1.2;
  const auto price = [](double Q) { return std::pow(5000 / Q, 1 / gamma); };
  return dense(
      "nash10", Box::nonnegative(10),
      [=](const Vec& q) {
        const double Q = q.sum();
        const double p = price(Q);
        return Vec(Vec::NullaryExpr(
            10, [&](Index i) { return c[i] + std::pow(L * q[i], b[i]) - p + q[i] * p / (gamma * Q); }));
      },
      [=](const Vec& q) {
        const double Q = q.sum();
        const double p = price(Q);
        const double dp = -p / (gamma * Q);
        // d/dq_j of -p + q_i p / (gamma Q), the same for all j but for the factor q_i.
        Dense J = Dense::NullaryExpr(
            10, 10, [&](Index i, Index) { return -dp + q[i] * (dp / (gamma * Q) - p / (gamma * Q * Q)); });
        for (Index i = 0; i < 10; ++i) J(i, i) += p / (gamma * Q) + L * b[i] * std::pow(L * q[i], b[i] - 1);
        return J;
      });
}

inline Vec nash10_solution() {
  return vec({7.4415467, 4.09781045, 2.59064375, 0.93538577, 17.94895234, 4.09781045, 1.30472576, 5.59008254,
              3.22217945, 1.67709432});
}

/// The obstacle problem of the unit square with N x N unknowns v_ij, h = 1 / (N + 1), v = 0 around (MINPACK-2; Dirkse &
/// Ferris 1995): F = 4 v_ij - its four neighbours - load h^2, l = s^3 and u = s^2 + 0.2 with s = sin(9.2 x) sin(9.3 y).
inline ncp::Functions obstacle(int N, double load = 1) {
  const Index n = static_cast<Index>(N) * N;
  const double h = 1.0 / (N + 1);
  AffineMcp problem{.M = five_point(N, 4), .q = Vec::Constant(n, -load * h * h), .box = Box::free(n)};
  for (int j = 0; j < N; ++j)
    for (int i = 0; i < N; ++i) {
      const int k = j * N + i;
      const double s = std::sin(9.2 * h * (i + 1)) * std::sin(9.3 * h * (j + 1));
      problem.box.lower[k] = s * s * s;
      problem.box.upper[k] = s * s + 0.2;
    }
  return affine(problem);
}

/// Hock & Schittkowski's problem 34 with its multipliers: minimize -x_1 over e^x_1 <= x_2, e^x_2 <= x_3, 0 <= x <=
/// (100, 100, 10). Solution (ln ln 10, ln 10, 10; 1 / ln 10, 1 / (10 ln 10)), where x_3 is at its upper bound.
inline ncp::Functions hs34() {
  return dense(
      "hs34", {Vec::Zero(5), vec({100, 100, 10, infinity, infinity})},
      [](const Vec& z) {
        return vec({-1 + z[3] * std::exp(z[0]), -z[3] + z[4] * std::exp(z[1]), -z[4], z[1] - std::exp(z[0]),
                    z[2] - std::exp(z[1])});
      },
      [](const Vec& z) {
        const double a = std::exp(z[0]);
        const double b = std::exp(z[1]);
        Dense J(5, 5);
        J << z[3] * a, 0, 0, a, 0,  //
            0, z[4] * b, 0, -1, b,  //
            0, 0, 0, 0, -1,         //
            -a, 1, 0, 0, 0,         //
            0, -b, 1, 0, 0;
        return J;
      });
}

inline Vec hs34_solution() {
  const double ln10 = std::log(10);
  return vec({std::log(ln10), ln10, 10, 1 / ln10, 0.1 / ln10});
}

struct Planted {
  ncp::Functions functions;
  Vec solution;
};

/// F(x) = M x + x^3 + q, M row diagonally dominant, in a box with every kind of interval. F is a P-function, so the
/// solution planted is the only one. Each bounded variable is at a bound or inside; at a bound, F_i is 0 with
/// probability `degenerate` (no strict complementarity there).
inline Planted planted(Index n, double degenerate, Random& random) {
  const Box box = mixed_box(n, random);
  const SpMat M = h_plus(n, 2, random);
  const Vec solution = lcp::project(box, random.normals(n));
  Vec q = -(M * solution) - solution.array().cube().matrix();
  for (Index i = 0; i < n; ++i) {
    const double F = random.chance(degenerate) ? 0 : random.uniform(0.1, 2);
    const bool fixed = box.lower[i] == box.upper[i];
    if (fixed ? random.chance(0.5) : solution[i] == box.upper[i])
      q[i] -= F;
    else if (solution[i] == box.lower[i])
      q[i] += F;
  }
  return {{.name = "planted",
           .box = box,
           .pattern = M,
           .F =
               [M, q](In x, Out F) {
                 F = M * x + q + x.array().cube().matrix();
                 return true;
               },
           .J =
               [M](In x, SpMat& J) {
                 J = M;
                 for (Index i = 0; i < x.size(); ++i) J.coeffRef(i, i) += 3 * x[i] * x[i];
                 return true;
               }},
          solution};
}

/// Counts what is asked of a problem.
class Counting final : public Mcp {
 public:
  explicit Counting(const Mcp& base) : base_(base) {}
  const Box& box() const override { return base_.box(); }
  const SpMat& jacobian_pattern() const override { return base_.jacobian_pattern(); }
  bool eval(In x, Out F) const override {
    ++F_evals;
    return base_.eval(x, F);
  }
  bool jacobian(In x, SpMat& J) const override {
    ++J_evals;
    return base_.jacobian(x, J);
  }
  mutable int F_evals = 0;
  mutable int J_evals = 0;

 private:
  const Mcp& base_;
};

/// How far x is from the definition of a solution, without a projection:
///     max_i max(l - x, x - u, min(F+, x - l), min(F-, u - x));  +inf where F is not defined.
inline double violation(const Box& box, const Vec& x, const Vec& F) {
  double worst = 0;
  for (Index i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(F[i])) return infinity;
    const double above_lower = x[i] - box.lower[i];
    const double below_upper = box.upper[i] - x[i];
    worst = std::max({worst, -above_lower, -below_upper, std::min(std::max(F[i], 0.0), above_lower),
                      std::min(std::max(-F[i], 0.0), below_upper)});
  }
  return worst;
}

inline double violation(const Mcp& mcp, const Vec& x) {
  Vec F(x.size());
  return mcp.eval(x, F) ? violation(mcp.box(), x, F) : infinity;
}

}  // namespace perp::support
