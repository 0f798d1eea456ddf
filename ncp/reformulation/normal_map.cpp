// SPDX-License-Identifier: Apache-2.0
#include "ncp/reformulation/normal_map.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace perp::ncp {

Vec normal_point(const Box& box, In z, In F) {
  Vec x = z;
  for (Index i = 0; i < z.size(); ++i) {
    if (z[i] == box.lower[i]) x[i] -= std::max(F[i], 0.0);
    if (z[i] == box.upper[i]) x[i] += std::max(-F[i], 0.0);
  }
  return x;
}

std::vector<lcp::Cell> cells_at(const Box& box, In z) {
  std::vector<lcp::Cell> cells(static_cast<std::size_t>(z.size()));
  for (Index i = 0; i < z.size(); ++i)
    cells[static_cast<std::size_t>(i)] = box.lower[i] == box.upper[i] ? lcp::Cell::Fixed
                                         : z[i] <= box.lower[i]       ? lcp::Cell::Below
                                         : z[i] >= box.upper[i]       ? lcp::Cell::Above
                                                                      : lcp::Cell::Inside;
  return cells;
}

SpMat plus_diagonal(const SpMat& A, double lambda) {
  SpMat B(A.rows(), A.cols());
  B.reserve(A.nonZeros() + A.rows());
  for (Index j = 0; j < A.cols(); ++j) {
    bool on_diagonal = false;
    const auto put_diagonal = [&](double a) {
      B.insertBack(j, j) = a + lambda;
      on_diagonal = true;
    };
    B.startVec(j);
    for (SpMat::InnerIterator it(A, j); it; ++it) {
      if (it.row() > j && !on_diagonal) put_diagonal(0);
      if (it.row() == j)
        put_diagonal(it.value());
      else
        B.insertBack(it.row(), j) = it.value();
    }
    if (!on_diagonal) put_diagonal(0);
  }
  B.finalize();
  return B;
}

lcp::AffineMcp linearised(const Box& box, const Point& point, double lambda) {
  lcp::AffineMcp problem{.M = lambda > 0 ? plus_diagonal(point.J, lambda) : point.J, .q = {}, .box = box};
  problem.q = point.F - problem.M * point.x;
  return problem;
}

double size_of(const SpMat& J) {
  return J.rows() == 0 ? 1 : std::max(1e-8, J.norm() / std::sqrt(static_cast<double>(J.rows())));
}

Way Way::line(const Box& box, In z, In end) {
  Way way;
  way.begin_ = z;
  way.end_ = lcp::project(box, end);
  return way;
}

Way Way::arc(In x, In end) {
  Way way;
  way.begin_ = x;
  way.end_ = end;
  return way;
}

Way Way::path(In x, std::vector<lcp::Breakpoint> kinks, In end, double t_end) {
  Way way = arc(x, end);
  way.kinks_ = std::move(kinks);
  way.t_end_ = t_end;
  return way;
}

Vec Way::at(double T) const {
  if (T >= 1) return end_;
  if (kinks_.size() < 2) return begin_ + T * (end_ - begin_);
  const double t = T * t_end_;
  std::size_t k = 1;
  while (k + 1 < kinks_.size() && kinks_[k].t < t) ++k;
  const lcp::Breakpoint& a = kinks_[k - 1];
  const lcp::Breakpoint& b = kinks_[k];
  const double share = b.t > a.t ? std::clamp((t - a.t) / (b.t - a.t), 0.0, 1.0) : 1;
  return a.x + share * (b.x - a.x) + (1 - T) * (begin_ - kinks_.front().x);
}

std::vector<lcp::Breakpoint> Way::corners() const {
  if (kinks_.size() < 2) return {{.t = 0, .x = begin_}, {.t = 1, .x = end_}};
  std::vector<lcp::Breakpoint> corners = kinks_;
  const Vec error = begin_ - kinks_.front().x;
  for (lcp::Breakpoint& corner : corners) corner.x += (1 - corner.t / t_end_) * error;
  return corners;
}

}  // namespace perp::ncp
