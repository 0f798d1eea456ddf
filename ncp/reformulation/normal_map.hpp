// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The normal map F_+(x) = F(pi(x)) + x - pi(x), pi the projection onto the box (Robinson 1992): F_+(x) = 0 iff
/// z = pi(x) solves the MCP. Its linearised problem, and ways between its points. Private to ncp/.
#include <vector>

#include "lcp/pivoting/lemke.hpp"
#include "ncp/problem/counted_mcp.hpp"

namespace perp::ncp {

/// The point x with pi(x) = z whose ||F_+(x)|| is least: x_i = z_i - max(F_i, 0) at a lower bound, z_i + max(-F_i, 0)
/// at an upper one.
Vec normal_point(const Box& box, In z, In F);

/// The cells of a point of the box: at a bound it touches, else inside.
std::vector<lcp::Cell> cells_at(const Box& box, In z);

/// A + lambda I.
SpMat plus_diagonal(const SpMat& A, double lambda);

/// MCP(l, u, F(z^k) + (J + lambda I)(. - z^k)).
lcp::AffineMcp linearised(const Box& box, const Point& point, double lambda);

/// ||J||_F / sqrt(n): the size of lambda = 1.
double size_of(const SpMat& J);

/// From z^k (T = 0) to where a linearised problem led (T = 1), in the coordinates of the normal map.
class Way {
 public:
  Way() = default;
  /// z^k + T (pi(end) - z^k).
  static Way line(const Box& box, In z, In end);
  /// x^k + T (end - x^k), which the projection bends.
  static Way arc(In x, In end);
  /// The point of the piecewise-linear path where t first comes to T t_end, t_end that of `end`, the last or best
  /// point. The path begins at a point near x, the perturbed start; that error shrinks with 1 - T, so that T = 0 is x
  /// itself.
  static Way path(In x, std::vector<lcp::Breakpoint> kinks, In end, double t_end);

  Vec at(double T) const;
  const Vec& end() const { return end_; }
  const std::vector<lcp::Breakpoint>& kinks() const { return kinks_; }
  /// Where at() turns: the kinks without the error of the start; begin and end of a straight way.
  std::vector<lcp::Breakpoint> corners() const;

 private:
  Vec begin_, end_;
  std::vector<lcp::Breakpoint> kinks_;  // empty: straight
  double t_end_ = 1;
};

}  // namespace perp::ncp
