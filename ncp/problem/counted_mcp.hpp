// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Evaluations counted and guarded. Private to ncp/.
#include <utility>

#include "ncp/problem/mcp.hpp"

namespace perp::ncp {

/// Counts evaluations, turns a NaN or an infinity into "not defined here", and refuses a J that left its pattern.
class CountedMcp {
 public:
  explicit CountedMcp(const Mcp& mcp) : mcp_(mcp) {}
  const Mcp& mcp() const { return mcp_; }
  bool eval(In x, Vec& F);
  /// Throws std::invalid_argument, naming equation and variable, if J comes back with other entries than its pattern.
  bool jacobian(In x, SpMat& J);
  int F_evals() const { return F_evals_; }
  int J_evals() const { return J_evals_; }

 private:
  const Mcp& mcp_;
  int F_evals_ = 0;
  int J_evals_ = 0;
};

/// A point with F and J there.
struct Point {
  Point() = default;
  ~Point() = default;
  Point(const Point&) = default;
  Point& operator=(const Point&) = default;
  // Eigen 3.4 copies sparse matrices instead of moving them.
  Point(Point&& other) : Point() { *this = std::move(other); }
  Point& operator=(Point&& other) noexcept {
    x.swap(other.x);
    F.swap(other.F);
    J.swap(other.J);
    return *this;
  }

  Vec x, F;
  SpMat J;
};

}  // namespace perp::ncp
