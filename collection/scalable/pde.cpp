// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "collection/base/build.hpp"
#include "collection/scalable/generators.hpp"

namespace perp::ncp::collection {
namespace {

/// F(v) = A v + q - s exp(v) on the interior points (i, j) of a grid, i = 1 .. N fastest, j = 1 .. M. Names are made
/// when they are asked for: there may be millions.
class GridMcp final : public Mcp {
 public:
  GridMcp(std::string name, Index columns, Box box, SpMat A, Vec q, double s)
      : name_(std::move(name)), columns_(columns), box_(std::move(box)), A_(std::move(A)), q_(std::move(q)), s_(s) {
    if (s_ == 0) return;
    diagonal_.reserve(static_cast<std::size_t>(A_.cols()));
    for (Index k = 0; k < A_.cols(); ++k)
      for (int at = A_.outerIndexPtr()[k]; at < A_.outerIndexPtr()[k + 1]; ++at)
        if (A_.innerIndexPtr()[at] == k) diagonal_.push_back(at);
  }

  const Box& box() const override { return box_; }
  const SpMat& jacobian_pattern() const override { return A_; }
  bool is_affine() const override { return s_ == 0; }
  std::string name() const override { return name_; }
  std::string variable_name(Index k) const override { return element("v", place(k)); }
  std::string equation_name(Index k) const override { return element("F", place(k)); }

  std::optional<Expressions> expressions() const override {
    const auto f = [&](const auto& v, auto& F) {
      F = product(A_, v);
      for (Index k = 0; k < v.size(); ++k) F[k] = F[k] + q_[k] - s_ * exp(v[k]);
    };
    return s_ == 0 ? std::nullopt : written_down(on_vectors(size(), f), static_cast<int>(size()));
  }
  bool eval(In v, Out F) const override {
    F = q_;
    F.noalias() += A_ * v;
    if (s_ != 0) F.array() -= s_ * v.array().exp();
    return all_finite(F);
  }
  bool jacobian(In v, SpMat& J) const override {
    std::copy_n(A_.valuePtr(), A_.nonZeros(), J.valuePtr());
    for (std::size_t k = 0; k < diagonal_.size(); ++k)
      J.valuePtr()[diagonal_[k]] -= s_ * std::exp(v[static_cast<Index>(k)]);
    return all_finite(Eigen::Map<const Vec>(J.valuePtr(), J.nonZeros()));
  }
  std::vector<bool> linear_entries() const override {
    std::vector<bool> linear(static_cast<std::size_t>(A_.nonZeros()), true);
    for (const int at : diagonal_) linear[static_cast<std::size_t>(at)] = false;
    return linear;
  }

 private:
  std::string place(Index k) const {
    return std::to_string(k % columns_ + 1).append(",").append(std::to_string(k / columns_ + 1));
  }

  std::string name_;
  Index columns_;
  Box box_;
  SpMat A_;
  Vec q_;
  double s_;
  std::vector<int> diagonal_;  // where A's diagonal is among its values; empty if s = 0
};

struct Grid {
  Index M, N;
  double hx, hy;
  Index size() const { return M * N; }
  double x(Index i) const { return hx * static_cast<double>(i); }
  double y(Index j) const { return hy * static_cast<double>(j); }
};

Grid grid(std::string_view problem, Index M, Index N, double width, double height) {
  require_at_least(problem, "M", M, 1);
  require_at_least(problem, "N", N, 1);
  constexpr Index most = 20'000;  // 5 entries a point: A is indexed by int
  if (const Index larger = std::max(M, N); larger > most)
    throw std::invalid_argument(
        std::string(problem).append(": a side of the grid has ").append(std::to_string(larger)) +
        " points; it may have 20000");
  return {.M = M, .N = N, .hx = width / static_cast<double>(N + 1), .hy = height / static_cast<double>(M + 1)};
}

/// f(i, j) at all points.
template <class F>
Vec values(const Grid& g, F f) {
  Vec v(g.size());
  for (Index j = 1; j <= g.M; ++j)
    for (Index i = 1; i <= g.N; ++i) v[(j - 1) * g.N + i - 1] = f(i, j);
  return v;
}

/// The matrix of a five-point stencil: in the row of point (i, j) the entry of its neighbour (i + a, j + b) is
/// weight(i, j, a, b), its own weight(i, j, 0, 0).
template <class W>
SpMat five_points(const Grid& g, W weight) {
  SpMat A(g.size(), g.size());
  A.reserve(Eigen::VectorXi::Constant(g.size(), 5));
  for (Index j = 1; j <= g.M; ++j)
    for (Index i = 1; i <= g.N; ++i) {
      const Index k = (j - 1) * g.N + i - 1;
      // Column k, from the top: the rows of the points that have this one as a neighbour.
      if (j > 1) A.insert(k - g.N, k) = weight(i, j - 1, 0, 1);
      if (i > 1) A.insert(k - 1, k) = weight(i - 1, j, 1, 0);
      A.insert(k, k) = weight(i, j, 0, 0);
      if (i < g.N) A.insert(k + 1, k) = weight(i + 1, j, -1, 0);
      if (j < g.M) A.insert(k + g.N, k) = weight(i, j + 1, 0, -1);
    }
  A.makeCompressed();
  return A;
}

/// hx hy times -Laplace: linear finite elements, and the five-point stencil.
SpMat laplace(const Grid& g) {
  const double wx = g.hy / g.hx;
  const double wy = g.hx / g.hy;
  return five_points(g, [=](Index, Index, int a, int b) { return a != 0 ? -wx : b != 0 ? -wy : 2 * wx + 2 * wy; });
}

Problem grid_problem(std::string name, const Grid& g, Box box, SpMat A, Vec q, double s, Vec start) {
  Problem p;
  p.starts = {std::move(start), box.lower, Vec::Constant(g.size(), 1)};
  p.mcp = std::make_unique<GridMcp>(std::move(name), g.N, std::move(box), std::move(A), std::move(q), s);
  return p;
}

}  // namespace

Problem obstacle(Index M, Index N) {
  const Grid g = grid("obstacle", M, N, 1, 1);
  const auto bump = [&](Index i, Index j) { return std::sin(9.2 * g.x(i)) * std::sin(9.3 * g.y(j)); };
  Box box{values(g, [&](Index i, Index j) { return std::pow(bump(i, j), 3); }),
          values(g, [&](Index i, Index j) { return std::pow(bump(i, j), 2) + 0.2; })};
  Vec start = box.lower.cwiseMax(0);
  return grid_problem("obstacle", g, std::move(box), laplace(g), Vec::Constant(g.size(), -g.hx * g.hy), 0,
                      std::move(start));
}

Problem bratu_own(Index M, Index N) {
  constexpr double lambda = 6;
  const Grid g = grid("bratu-own", M, N, 1, 1);
  const Index n = g.size();
  return grid_problem("bratu-own", g, {Vec::Zero(n), Vec::Constant(n, 4)}, laplace(g), Vec::Zero(n),
                      lambda * g.hx * g.hy, Vec::Zero(n));
}

Problem journal_bearing(Index M, Index N) {
  constexpr double ecc = 0.1;
  constexpr double b = 10;
  const Grid g = grid("journal-bearing", M, N, 2 * std::numbers::pi, 2 * b);
  const auto w = [&](Index i) { return std::pow(1 + ecc * std::cos(g.x(i)), 3); };
  // Linear finite elements on triangles, w by the mean of the three corners: the coefficients of the edges.
  const auto along_x = [&](Index i) { return 0.5 * (w(i) + w(i + 1)) * g.hy / g.hx; };               // to (i + 1, j)
  const auto along_y = [&](Index i) { return (w(i - 1) + 4 * w(i) + w(i + 1)) / 6 * g.hx / g.hy; };  // to (i, j + 1)
  SpMat A = five_points(g, [&](Index i, Index, int to_x, int to_y) {
    if (to_x != 0) return -along_x(to_x > 0 ? i : i - 1);
    if (to_y != 0) return -along_y(i);
    return along_x(i - 1) + along_x(i) + 2 * along_y(i);
  });
  Vec q = values(g, [&](Index i, Index) { return -ecc * g.hx * g.hy * std::sin(g.x(i)); });
  Vec start = values(g, [&](Index i, Index) { return std::max(std::sin(g.x(i)), 0.0); });
  return grid_problem("journal-bearing", g, Box::nonnegative(g.size()), std::move(A), std::move(q), 0,
                      std::move(start));
}

Problem torsion(Index M, Index N) {
  constexpr double c = 5;
  const Grid g = grid("torsion", M, N, 1, 1);
  Vec distance = values(g, [&](Index i, Index j) {
    return std::min(g.hx * static_cast<double>(std::min(i, g.N + 1 - i)),
                    g.hy * static_cast<double>(std::min(j, g.M + 1 - j)));
  });
  return grid_problem("torsion", g, {-distance, distance}, laplace(g), Vec::Constant(g.size(), -c * g.hx * g.hy), 0,
                      distance);
}

Problem american_put_own(Index steps, Index N) {
  constexpr double sigma = 0.2;
  constexpr double rate = 0.06;
  constexpr double years = 1;
  constexpr double reach = 1;
  require_at_least("american-put-own", "steps", steps, 1);
  Grid g = grid("american-put-own", steps, N, 2 * reach, 1);
  const double dt = years / static_cast<double>(steps);
  const double spread = dt * 0.5 * sigma * sigma / (g.hx * g.hx);
  const double drift = dt * 0.5 * (rate - 0.5 * sigma * sigma) / g.hx;
  const auto payoff = [&](Index i) { return std::max(0.0, 1 - std::exp(g.x(i) - reach)); };
  SpMat A = five_points(g, [=](Index, Index, int a, int b) {
    if (b != 0) return b < 0 ? -1.0 : 0.0;  // the step before; the step after is not asked
    return a == 0 ? 1 + 2 * spread + rate * dt : a > 0 ? -spread - drift : -spread + drift;
  });
  A.prune([](Index, Index, double value) { return value != 0; });
  A.makeCompressed();
  Vec q = values(
      g, [&](Index i, Index j) { return (j == 1 ? -payoff(i) : 0) + (i == 1 ? (drift - spread) * payoff(0) : 0); });
  Vec lower = values(g, [&](Index i, Index) { return payoff(i); });
  Vec start = lower;
  Box box{std::move(lower), Vec::Constant(g.size(), infinity)};
  return grid_problem("american-put-own", g, std::move(box), std::move(A), std::move(q), 0, std::move(start));
}

}  // namespace perp::ncp::collection
