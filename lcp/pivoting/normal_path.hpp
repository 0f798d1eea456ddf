// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The path G(x) = (1 - t) r of lemke.hpp and the basis that represents its present segment; private to lcp/.
///
/// Unknowns, by number: x_0 .. x_{n-1};  n: tau = s t <= s, s = ||r||_inf, with column r / s;  n + 1 + i: the
/// artificial of row i, in [0, 0], with column e_i. One of them, the driver, is nonbasic and moves; n others are basic,
/// head_[p] at position p; the rest wait.
#include <optional>

#include "lcp/equilibrate.hpp"
#include "lcp/pivoting/last_piece.hpp"
#include "lcp/pivoting/lemke.hpp"
#include "lcp/pivoting/mersenne.hpp"

namespace perp::lcp {

class NormalPath final : public LastPiece {
 public:
  NormalPath(const AffineMcp& problem, In start, const LemkeOptions& options);

  /// Chooses the start cell and factors it. False if that cannot be done.
  bool begin(PivotResult& result);
  /// One segment: ratio test, move, pivot. False at the end of the path; result.end says which, if not t = 1.
  bool advance(PivotResult& result);
  /// Fills in the point reached and judges it.
  PivotResult finish(PivotResult result);

  /// The variables that artificials stand in for, in ascending order.
  std::vector<Index> waiting() const;

  /// At t = 1: the basis is that of all x_i, and there are factors of it.
  bool whole() const { return driver_ == n_ && !distrusted_; }
  /// lemke.hpp's; needs nothing of the problem and the options that the path was made with. Pre: whole().
  Vec chord_step(In r) const override;

  double t() const { return tau_ >= scale_ ? 1 : tau_ / scale_; }
  Vec x() const { return to_original(x_); }  ///< in the units of the problem given
  const Vec& equilibrated_x() const { return x_; }
  Vec to_original(const Vec& x) const { return scaling_.to_original(problem_.box, x); }  ///< an equilibrated x
  void make_original(Vec& x) const { scaling_.make_original(problem_.box, x); }          ///< the same

 private:
  NormalPath(const AffineMcp& problem, Equilibrated&& scaled, In start, const LemkeOptions& options);

  static constexpr Index none = -1;
  struct Block {  // what a ratio test finds
    Index position = none;
    double step = infinity;
  };

  bool inside(Index i) const { return cells_[static_cast<std::size_t>(i)] == Cell::Inside; }
  Index column(Index i) const { return i >= n_ || inside(i) ? i : n_ + 1 + i; }
  bool artificial(Index i) const { return i > n_; }
  double value(Index i) const { return i < n_ ? x_[i] : i == n_ ? tau_ : 0; }
  void move(Index i, double by) {
    if (i < n_)
      x_[i] += by;
    else if (i == n_)
      tau_ += by;
  }
  double low(Index i) const { return i < n_ ? low_[i] : i == n_ ? -infinity : 0; }
  double high(Index i) const { return i < n_ ? high_[i] : i == n_ ? scale_ : 0; }
  Index& head(Index p) { return head_[static_cast<std::size_t>(p)]; }
  Index head(Index p) const { return head_[static_cast<std::size_t>(p)]; }
  double generic() {
    if (!random_) random_.emplace(options_.seed);
    return 0.5 + random_->uniform();
  }

  /// Where a path could go on in two directions with equal right.
  struct Fork {
    Vec x, low, high;
    double tau = 0;
    std::vector<Cell> cells;
    std::vector<Index> head, waiting;
    Index driver = 0;
    double other_direction = 1;
  };

  Vec covering();
  void choose_cells();
  void set_interval(Index i);
  void perturb();
  void place_outside();
  void set_residual_column();
  Vec constant() const;
  bool factor_start(PivotResult& result);
  LuStatus factor_basis();
  bool refactor();
  bool drive();
  bool t_moves(double rate);
  void set_column_largest();
  /// The size of the largest entry of unknown i's column.
  double column_largest(Index i) const {
    const Index j = column(i);
    return j >= n_ ? 1 : column_largest_[j];  // the largest of r / s is 1, too
  }
  double room(Index i, double rate) const;
  Block ratio_test();
  bool doubtful(const Block& block) const;
  bool accurate(const Block& block) const;
  void step(double length);
  void end_on_ray(PivotResult& result);
  void enter(Index p);
  void leave_artificial(Index row);
  bool take_other_branch();
  void cross(Index i, double direction);
  bool back_at_start(PivotResult& result);
  Vec corrected(const Vec& x, In G) const;
  Vec refined(const Vec& x) const;
  Vec piece(In x) const;
  Vec refined_exactly(const Vec& x) const;
  void polish();
  double judge(In x) const;
  double judge_exactly(In x) const;

  const AffineMcp& original_;
  Scaling scaling_;
  AffineMcp problem_;  // equilibrated: that is what makes the tolerances mean the same for every unknown
  const LemkeOptions& options_;
  Index n_;
  std::optional<Mersenne> random_;  // once a number is asked for
  Vec x_;
  Vec low_;  // of the present cells
  Vec high_;
  double tau_ = 0;
  double scale_ = 1;  // s
  std::vector<Cell> cells_;
  std::vector<Cell> start_;
  Index away_ = 0;       // how many unknowns are in another cell than at the start
  double best_tau_ = 0;  // largest met, at best_x_
  Vec best_x_;
  Index pivots_at_best_ = 0;
  SpMat A_;             // [M, r / s]
  Vec column_largest_;  // of M, once asked for
  BasisFactor factor_;
  std::vector<Index> head_;
  std::vector<Index> waiting_;  // the variable an artificial stands in for, by row; none
  Index driver_ = 0;
  double direction_ = 1;
  SparseVector d_;  // B^-1 a of the driver: the basic unknowns move by -direction d a unit step
  double d_largest_ = 0;
  bool driven_ = false;  // d_ is the driver's
  std::vector<Block> candidates_;
  std::optional<Fork> fork_;
  bool distrusted_ = false;  // the last update was unstable or refused: factor afresh before the next solve
};

}  // namespace perp::lcp
