// SPDX-License-Identifier: Apache-2.0
#include "lcp/iterative/projected_sor.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "lcp/judge/shared_options.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {
namespace {

constexpr Index largest_block = 6;
using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, largest_block, largest_block>;
using SmallVec = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, largest_block, 1>;
using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// A few variables' affine MCP, solved by going through its cells: each variable lower, upper or inside.
class SmallMcp {
 public:
  Small M;
  SmallVec q, lower, upper;
  SmallVec terms;  ///< the sizes of the numbers that q is the sum of

  /// Sets z to a solution, up to rounding; false if there is none. The cell `first` (of the last solution) is tried
  /// first, and becomes the solution's.
  bool solve(SmallVec& z, long& first) const {
    long cells = 1;
    for (Index i = 0; i < q.size(); ++i) cells *= 3;
    if (holds(first, z)) return true;
    for (long cell = 0; cell < cells; ++cell)
      if (cell != first && holds(cell, z)) {
        first = cell;
        return true;
      }
    return false;
  }

 private:
  /// Whether the point of the cell (its digits base 3: 0 inside, 1 lower, 2 upper) solves.
  bool holds(long cell, SmallVec& z) const {
    const Index b = q.size();
    Small A = Small::Identity(b, b);
    SmallVec rhs(b);
    std::array<bool, largest_block> inside{};
    for (Index i = 0; i < b; ++i, cell /= 3) {
      const bool fixed = lower[i] == upper[i];
      const long where = fixed ? 1 : cell % 3;
      if (fixed && cell % 3 != 0) return false;
      inside[static_cast<std::size_t>(i)] = where == 0;
      if (where == 0)
        A.row(i) = M.row(i), rhs[i] = -q[i];
      else
        rhs[i] = where == 1 ? lower[i] : upper[i];
      if (!std::isfinite(rhs[i])) return false;
    }
    const Eigen::PartialPivLU<Small> lu(A);
    SmallVec point = lu.solve(rhs);
    if (!point.allFinite()) return false;
    for (Index i = 0; i < b; ++i) {
      if (!inside[static_cast<std::size_t>(i)]) point[i] = rhs[i];  // not a rounding beside its bound
      const double reach = 1e-12 * (1 + std::abs(point[i]));
      if (point[i] < lower[i] - reach || point[i] > upper[i] + reach) return false;
      point[i] = std::clamp(point[i], lower[i], upper[i]);
    }
    for (Index i = 0; i < b; ++i) {
      const double F = M.row(i).dot(point) + q[i];
      const double zero = 1e-12 * (M.row(i).cwiseAbs().dot(point.cwiseAbs()) + terms[i]);
      if (lower[i] == upper[i]) continue;
      if (F < -zero && point[i] < upper[i]) return false;
      if (F > zero && point[i] > lower[i]) return false;
    }
    z = point;
    return true;
  }
};

class Sor {
 public:
  Sor(const AffineMcp& problem, In start, const ProjectedSor& options, const Limits& limits)
      : problem_(problem),
        options_(options),
        limits_(limits),
        M_(problem.M),
        diagonal_(problem.M.diagonal()),
        z_(project(problem.box, start)),
        cell_(static_cast<std::size_t>((problem.size() + options.block - 1) / options.block), 0) {}

  Result run() {
    if (const Index i = unfit(); i >= 0) {
      return end(Status::NotApplicable, text_of("M has the diagonal entry ", diagonal_[i], " at index ", i + 1));
    }
    best_ = z_;
    best_residual_ = natural_residual(problem_, z_);
    const double hopeless = 1e12 * (1 + best_residual_);
    double milestone = best_residual_;  // and the sweep it was reached in
    long milestone_sweep = 0;
    while (!solves(problem_, best_, limits_.tol)) {
      if (sweeps_ >= options_.max_sweeps) return end(Status::IterationLimit, "the limit of sweeps is reached");
      for (int k = 0; k < options_.check_every; ++k) {
        if (const auto stop = limits_.reached()) return end(*stop, "stopped between two sweeps");
        if (!sweep(true) || (options_.symmetric && !sweep(false)))
          return end(Status::NotApplicable, "the block at index " + std::to_string(failed_ + 1) + " has no solution");
      }
      const double residual = natural_residual(problem_, z_);
      if (residual < best_residual_) {
        best_residual_ = residual;
        best_ = z_;
      }
      if (!(residual < hopeless)) return end(Status::Stalled, "diverges: the residual is " + text(residual));
      if (best_residual_ <= 0.99 * milestone) {
        milestone = best_residual_;
        milestone_sweep = sweeps_;
      } else if (sweeps_ - milestone_sweep >= options_.patience) {
        return end(Status::Stalled, "the residual has not fallen by a hundredth in " +
                                        std::to_string(sweeps_ - milestone_sweep) +
                                        " sweeps; the last one moved z by " + text(step_));
      }
    }
    return end(Status::Stalled, "");
  }

 private:
  static std::string text(double value) { return text_of(value); }

  /// A variable whose one-variable problem is not uniquely solvable; -1 if there is none.
  Index unfit() const {
    if (options_.block > 1) return -1;  // the blocks' own problems tell
    for (Index i = 0; i < problem_.size(); ++i) {
      if (!problem_.box.is_fixed(i) && !(diagonal_[i] > 0 || (problem_.box.is_free(i) && diagonal_[i] < 0))) return i;
    }
    return -1;
  }

  bool sweep(bool forward) {
    ++sweeps_;
    step_ = 0;
    const Index n = problem_.size();
    const Index b = options_.block;
    const Index blocks = (n + b - 1) / b;
    for (Index k = 0; k < blocks; ++k) {
      const Index block = forward ? k : blocks - 1 - k;
      if (b == 1)
        relax(block);
      else if (!relax_block(block * b, std::min(b, n - block * b), cell_[static_cast<std::size_t>(block)]))
        return false;
    }
    return true;
  }

  double F(Index i) const {
    double F = problem_.q[i];
    for (Rows::InnerIterator it(M_, i); it; ++it) F += it.value() * z_[it.col()];
    return F;
  }

  void move(Index i, double to) {
    const double z = project(problem_.box, i, to);
    step_ = std::max(step_, std::abs(z - z_[i]));
    z_[i] = z;
  }

  void relax(Index i) {
    if (!problem_.box.is_fixed(i)) move(i, z_[i] - options_.omega * F(i) / diagonal_[i]);
  }

  bool relax_block(Index first, Index b, long& cell) {
    small_.M.setZero(b, b);
    small_.q.resize(b);
    small_.terms.resize(b);
    small_.lower = problem_.box.lower.segment(first, b);
    small_.upper = problem_.box.upper.segment(first, b);
    for (Index i = 0; i < b; ++i) {
      double q = problem_.q[first + i];
      double terms = std::abs(q);
      for (Rows::InnerIterator it(M_, first + i); it; ++it) {
        const Index j = it.col() - first;
        if (j >= 0 && j < b) {
          small_.M(i, j) = it.value();
        } else {
          q += it.value() * z_[it.col()];
          terms += std::abs(it.value() * z_[it.col()]);
        }
      }
      small_.q[i] = q;
      small_.terms[i] = terms;
    }
    SmallVec solution(b);
    if (!small_.solve(solution, cell)) {
      if (!small_.q.allFinite()) return true;  // diverges: said at the next look at the residual
      failed_ = first;
      return false;
    }
    for (Index i = 0; i < b; ++i) move(first + i, z_[first + i] + options_.omega * (solution[i] - z_[first + i]));
    return true;
  }

  Result end(Status status, std::string message) const {
    Result result = judged(problem_, best_.size() > 0 ? best_ : z_, limits_, status, std::move(message));
    result.iterations = sweeps_;
    return result;
  }

  const AffineMcp& problem_;
  const ProjectedSor& options_;
  const Limits& limits_;
  Rows M_;
  Vec diagonal_;
  Vec z_;
  std::vector<long> cell_;  ///< of each block's last solution
  SmallMcp small_;
  Vec best_;
  double best_residual_ = infinity;
  double step_ = 0;  ///< largest move of the last sweep
  long sweeps_ = 0;
  Index failed_ = -1;
};

}  // namespace

void describe(ProjectedSor& m, Fields& f) {
  f.add("psor_omega", &m.omega, strictly_between(0, 2), "relaxation factor; 1: Gauss-Seidel sweeps");
  f.add("psor_symmetric", &m.symmetric, "sweep forth and back; counts as two sweeps");
  f.add("psor_block", &m.block, between(1, largest_block), "variables of a block, solved together");
  f.add("psor_sweep_limit", &m.max_sweeps, at_least(0), "sweeps after which to give up");
  f.add("psor_check_every", &m.check_every, at_least(1), "sweeps between two looks at the residual");
  f.add("patience", &m.patience, at_least(1), "sweeps in which the residual must fall by 1 %");
}

Result projected_sor(const AffineMcp& problem, In start, const ProjectedSor& options, const Limits& limits) {
  check_input("projected_sor", problem, start, limits);
  refuse_invalid("projected_sor", options);
  return Sor(problem, start, options, limits).run();
}

}  // namespace perp::lcp
