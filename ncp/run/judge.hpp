// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What may be called solved, for every method, and in one place: a point of the box whose natural residual, with F
/// evaluated afresh, is at most the tolerance. F of affine problems is summed without rounding errors for that. A run
/// on another form of the problem, whose solution will be judged on the problem itself, may take a point for one by the
/// F it has. Private to ncp/.
#include <memory>
#include <optional>
#include <vector>

#include "lcp/judge/judge.hpp"
#include "ncp/problem/mcp.hpp"
#include "ncp/problem/residual.hpp"
#include "ncp/run/options.hpp"

namespace perp::ncp {

class CountedMcp;
struct Result;

/// A point of the box, F there, and their residual: +inf if F is not defined there.
struct Judged {
  Vec x, F;
  Residual residual;
};

/// F of an affine problem, summed without rounding errors; that of the last point is remembered.
class ExactValues {
 public:
  /// The problem outlives them.
  explicit ExactValues(const Mcp& mcp) : mcp_(mcp) {}
  /// Null if it is not affine.
  const lcp::AffineMcp* problem();
  /// Pre: there is a problem.
  const Vec& F(const Vec& x);

 private:
  const Mcp& mcp_;
  std::shared_ptr<const lcp::AffineMcp> affine_;
  bool affine_known_ = false;
  Vec x_, F_;
};

class Judge {
 public:
  enum class Word { Last, Preliminary };  ///< whether what is solved here is judged once more elsewhere
  /// Both outlive the judge. `exact`: those of the problem.
  Judge(CountedMcp& counted, const Stop& stop, std::shared_ptr<ExactValues> exact, Word word = Word::Last)
      : counted_(counted), stop_(stop), exact_(std::move(exact)), word_(word) {}
  const std::shared_ptr<ExactValues>& exact() const { return exact_; }

  /// Whether the point is a solution to the tolerance. Then F is the fresh one, and entries that are at a bound but for
  /// the tolerance are moved there, where the point stays a solution. With J there, if it is known, a preliminary word
  /// on affine problems needs no exact sums where rounding could not matter.
  bool solved(Judged& point, const SpMat* J = nullptr);
  /// The same of a point whose F is not known yet.
  bool solved_at(Judged& point);
  /// Of points that are none: whether every row's residual is within the rounding of its terms
  /// (lcp::Accuracy::to_rounding), and the point may be a solution of the linearised problem rounded to doubles
  /// (lcp::rounds_a_solution). One evaluation of J, none for affine problems, and a factorization.
  bool to_rounding(const Judged& point);
  /// Affine problems near a solution: a step to the point of the cell that this one points to, if that is nearer.
  void refine(Judged& point);

 private:
  bool meets(const Judged& point) const { return point.residual.natural <= stop_.tol; }
  bool meets_without_doubt(const Judged& point, const SpMat* J) const;
  bool snapped(Judged& point);
  void evaluate(Judged& point);
  bool moved_to_bounds(Judged& point, const std::vector<Index>& which, int& tries);
  bool balanced(const Judged& point);

  CountedMcp& counted_;
  const Stop& stop_;
  std::shared_ptr<ExactValues> exact_;
  Word word_;
};

/// The result of another form of the problem, its x mapped back, judged on the problem itself: sets F, the residual
/// and, of what was accepted there, the status: NoProgress where the problem's own residual does not confirm it.
void judge_here(const Mcp& mcp, const Stop& stop, Result& result, std::shared_ptr<ExactValues> exact);

}  // namespace perp::ncp
