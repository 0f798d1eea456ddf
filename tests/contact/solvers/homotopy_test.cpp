// SPDX-License-Identifier: Apache-2.0
/// The homotopy beside the same steps without its reduction.
#include "contact/solvers/homotopy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "contact/cones/predictor_corrector.hpp"
#include "contact/contact_support.hpp"
#include "contact/laws/glocker.hpp"
#include "contact/laws/glocker_support.hpp"
#include "lcp/dense_factors.hpp"

namespace perp::contact {
namespace {

using support::Random;
using test::solvable_problem;

/// The steps of Homotopy on encoding A with all unknowns, none of them eliminated: F(x) - w = 0, (x_i - l_i) w_i = tau
/// where there is a bound.
class Unreduced {
 public:
  struct Direction {
    Vec x, w;
  };

  Unreduced(Glocker& mcp, const HomotopyOptions& options) : mcp_(mcp), options_(options), x_(mcp.start()) {
    evaluate(1);
    w_ = Vec::Zero(x_.size());
    for (Index i = 0; i < x_.size(); ++i)
      if (bounded(i)) w_[i] = std::max(F_[i], 1.0);
  }

  const Vec& x() const { return x_; }
  void step() {
    const Direction stay{Vec::Zero(x_.size()), Vec::Zero(x_.size())};
    const double tau = mean_after(stay, 0);
    evaluate(tau);
    const Direction d = predictor_corrector(*this, tau, options_.least_centring, last_).direction;
    last_ = std::min(1.0, options_.to_boundary * reach(d));
    for (int k = 0; k < 6 && !central(d, last_); ++k) last_ *= 0.8;
    x_ += last_ * d.x;
    w_ += last_ * d.w;
  }

  Direction direction(double target, const Direction* affine) const {
    Vec c = Vec::Zero(x_.size());
    Vec rhs = w_ - F_;
    for (Index i = 0; i < x_.size(); ++i) {
      if (!bounded(i)) continue;
      c[i] = target - s(i) * w_[i] - (affine != nullptr ? affine->x[i] * affine->w[i] : 0);
      rhs[i] += c[i] / s(i);
    }
    Direction d{lu_.solve(rhs), Vec::Zero(x_.size())};
    for (Index i = 0; i < x_.size(); ++i)
      if (bounded(i)) d.w[i] = (c[i] - w_[i] * d.x[i]) / s(i);
    return d;
  }
  double reach(const Direction& d) const {
    double alpha = 1;
    for (Index i = 0; i < x_.size(); ++i) {
      if (!bounded(i)) continue;
      if (d.x[i] < 0) alpha = std::min(alpha, -s(i) / d.x[i]);
      if (d.w[i] < 0) alpha = std::min(alpha, -w_[i] / d.w[i]);
    }
    return alpha;
  }
  double mean_after(const Direction& d, double alpha) const {
    const Vec all = products(d, alpha);
    return all.mean();
  }

 private:
  bool bounded(Index i) const { return mcp_.box().lower[i] > -lcp::infinity; }
  double s(Index i) const { return x_[i] - mcp_.box().lower[i]; }
  Vec products(const Direction& d, double alpha) const {
    std::vector<double> all;
    for (Index i = 0; i < x_.size(); ++i)
      if (bounded(i)) all.push_back((s(i) + alpha * d.x[i]) * (w_[i] + alpha * d.w[i]));
    return Eigen::Map<Vec>(all.data(), static_cast<Index>(all.size()));
  }
  bool central(const Direction& d, double alpha) const {
    const Vec all = products(d, alpha);
    return all.minCoeff() >= options_.neighbourhood * all.mean();
  }
  /// F and the factors of J + diag(w / s), with delta and eps tied to tau as those of Homotopy.
  void evaluate(double tau) {
    mcp_.set_smoothing(std::clamp(options_.delta_share * tau, 1e-13, 1.0), options_.eps_share * tau);
    F_.resize(x_.size());
    SpMat J = mcp_.jacobian_pattern();
    ASSERT_TRUE(mcp_.eval(x_, F_) && mcp_.jacobian(x_, J));
    Eigen::MatrixXd K = J;
    for (Index i = 0; i < x_.size(); ++i)
      if (bounded(i) && w_.size() > 0) K(i, i) += w_[i] / s(i);
    lu_.compute(K);
  }

  Glocker& mcp_;
  HomotopyOptions options_;
  Vec x_, w_, F_;
  Eigen::PartialPivLU<Eigen::MatrixXd> lu_;
  double last_ = 1;
};

// The reduction to three unknowns a contact is exact: the iterates are those on encoding A with all seven, from the
// same start and with delta and eps tied to tau in the same way. Catches every error in the Schur complement, in the
// recovery of the multipliers and in the step lengths.
TEST(Homotopy, IsTheUnreducedInteriorPoint) {
  Random random(1);
  for (const int dimension : {2, 3})
    for (int k = 0; k < 6; ++k) {
      const Problem problem = solvable_problem(dimension, 4, 14, random, 0.25);
      const Scaled coordinates = scaled(problem);
      ContactSystem system(coordinates);
      Homotopy reduced(coordinates, system);
      Glocker mcp(coordinates, {.encoding = Encoding::A, .delta = 0.1, .eps = 0.1});
      Unreduced whole(mcp, {});
      for (int step = 1; step <= 5; ++step) {
        ASSERT_TRUE(reduced.step());
        whole.step();
        const Vec r = mcp.impulses(whole.x());
        EXPECT_LE((r - reduced.r()).norm(), 1e-7 * (1 + r.norm())) << dimension << "D, step " << step;
      }
    }
}

}  // namespace
}  // namespace perp::contact
