// SPDX-License-Identifier: Apache-2.0
#include "lcp/solve/enumeration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <sstream>

#include "lcp/dense_factors.hpp"
#include "lcp/equilibrate.hpp"
#include "lcp/iterative/bounded_rows.hpp"
#include "lcp/judge/cell.hpp"
#include "lcp/judge/judge.hpp"
#include "lcp/judge/shared_options.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {
namespace {

/// Values of equilibrated data within this of a bound are on it: cells are kept rather than lost.
constexpr double degenerate = 1e-9;
/// Relative threshold of the rank of M_FF and of a cell's equations.
constexpr double dependent = 1e-11;

using Eigen::MatrixXd;
using Feasibility = BoundedRows::Feasibility;

Index rank(const MatrixXd& A, double tol) {
  if (A.size() == 0) return 0;
  Eigen::FullPivLU<MatrixXd> lu(A);
  lu.setThreshold(tol);
  return lu.rank();
}

/// A polyhedron of solutions: its cell, a relative interior point (of the equilibrated data), the dimension.
struct Piece {
  Cells cells;
  Vec z;
  Vec w;
  Vec original;
  Index dimension;
};

/// None at all if equilibrating would lose digits: proofs are of the data as they are.
Scaling exact_scaling(const AffineMcp& problem) {
  Scaling scaling = equilibrate(problem);
  if (scaling.loses_nothing(problem)) return scaling;
  return {Vec::Ones(problem.size()), Vec::Ones(problem.size())};
}

class Search {
 public:
  Search(const AffineMcp& problem, const Enumeration& options, const Limits& limits)
      : problem_(problem),
        options_(options),
        limits_(limits),
        scaling_(exact_scaling(problem)),
        scaled_(scaling_.apply(problem)),
        M_(scaled_.M),
        cells_(all_inside(problem.box)),
        decided_(at(problem.size()), 0),
        cell_(problem, LuBackend::General, degenerate) {}

  Solutions run() {
    Refutation::Proof proof = search();
    if (cut_degenerate_ && out_.stopped == Status::Solved && pieces_.empty()) {
      // "None" must not rest on a w_i that is 0 up to rounding: once more without these cuts.
      skip_degenerate_ = false;
      nodes_limit_ = out_.nodes + 100'000;
      proof = search();
    }
    out_.complete = out_.stopped == Status::Solved;
    if (out_.complete && pieces_.empty()) keep(std::move(proof));
    for (Piece& piece : pieces_) out_.found.push_back({std::move(piece.original), piece.dimension});
    return std::move(out_);
  }

 private:
  Refutation::Proof search() {
    kept_ = 0;
    excluded_ = infinity;
    BoundedRows rows(M_, scaled_.q, scaled_.box, degenerate);
    for (Index i = 0; i < problem_.size(); ++i) {
      const Box& box = problem_.box;
      if (box.is_fixed(i) || box.is_free(i)) decided_[at(i)] = 1;
      if (box.is_free(i)) rows.set_bounds(rows.w(i), 0, 0);
      if (box.has_lower(i) && !box.has_upper(i)) rows.set_bounds(rows.w(i), 0, infinity);
      if (!box.has_lower(i) && box.has_upper(i)) rows.set_bounds(rows.w(i), -infinity, 0);
    }
    return visit(std::move(rows));
  }

  /// Keeps the proof for the whole problem, for the largest tolerance that all of its cells allow.
  void keep(Refutation::Proof proof) {
    if (kept_ > most_kept) return;
    out_.refutation = {.tolerance = 0, .radius = infinity, .proof = std::move(proof)};
    // Beyond half of a box at its lower bound and off its upper one is the same.
    double most = excluded_;
    for (Index i = 0; i < problem_.size() && !out_.refutation.proof.assumptions.empty(); ++i)
      if (!problem_.box.is_fixed(i)) most = std::min(most, (problem_.box.upper[i] - problem_.box.lower[i]) / 4);
    for (const double t : {most * (1 - 1e-6), most / 2, limits_.tol}) {
      out_.refutation.tolerance = t;
      if (holds(problem_, out_.refutation)) return;
    }
    out_.refutation.tolerance = 0;
  }

  /// The partial cell: decided variables are at their cells, the others anywhere between their bounds. Returns the
  /// proof that it is empty, if it is.
  Refutation::Proof visit(BoundedRows rows) {
    Refutation::Proof proof;
    if (done()) return proof;
    if (++out_.nodes > nodes_limit_) {
      stop(Status::Stalled, "rounding: cells where w is 0 throughout are too many to be examined one by one");
      return proof;
    }
    if (is_empty(rows, proof) || degenerate_in_whole(rows)) return proof;
    const Index i = farthest_from_complementary(rows);
    if (i < 0) {
      leaf(rows, proof);
      return proof;
    }
    decided_[at(i)] = 1;
    const double l = scaled_.box.lower[i];
    const double u = scaled_.box.upper[i];
    const auto branch = [&](Cell cell, double z_lower, double z_upper, double w_lower, double w_upper) {
      cells_[at(i)] = cell;
      BoundedRows next = rows;
      next.set_bounds(next.z(i), z_lower, z_upper);
      next.set_bounds(next.w(i), w_lower, w_upper);
      return visit(std::move(next));
    };
    // Off its bounds, off the lower one alone, and at it: each refuted supposes less.
    const bool has_lower = problem_.box.has_lower(i);
    if (has_lower) proof = branch(Cell::Below, l, l, 0, infinity);
    Refutation::Proof off = branch(Cell::Inside, l, u, 0, 0);
    if (problem_.box.has_upper(i)) {
      Refutation::Proof upper = branch(Cell::Above, u, u, -infinity, 0);
      off = before({.variable = i, .above = false, .refuted = std::move(off)}, std::move(upper));
    }
    decided_[at(i)] = 0;
    return has_lower ? before({.variable = i, .above = true, .refuted = std::move(off)}, std::move(proof)) : off;
  }

  static Refutation::Proof before(Refutation::Assumption assumption, Refutation::Proof proof) {
    proof.assumptions.insert(proof.assumptions.begin(), std::move(assumption));
    return proof;
  }

  /// Whether no point is within the rows' bounds; proved without rounding, or the search is not complete.
  bool is_empty(BoundedRows& rows, Refutation::Proof& proof) {
    const Feasibility answer = rows.repair();
    if (answer == Feasibility::Feasible) return false;
    TwoPartVector y;
    if (answer == Feasibility::Empty)
      y = exclusion_parts(scaled_.M, scaled_.q, rows.z_bounds(), rows.w_bounds(), rows.multipliers());
    if (y.size() == 0) {
      stop(Status::Stalled, "rounding: a partial cell could not be decided");
      return true;
    }
    y.value = y.value.cwiseProduct(scaling_.rows);
    y.rest = y.rest.cwiseProduct(scaling_.rows);
    const Box z = rows.z_bounds();
    const Exclusion there =
        exclusion(problem_.M, problem_.q,
                  {z.lower.cwiseProduct(scaling_.columns), z.upper.cwiseProduct(scaling_.columns)}, rows.w_bounds(), y);
    excluded_ = std::min(excluded_, there.wrong > 0 ? 0 : there.margin / there.size);
    for (Index i = 0; i < y.size() && kept_ <= most_kept; ++i)
      if (y.value[i] != 0) proof.y.push_back({i, y.value[i], y.rest[i]}), ++kept_;
    return true;
  }

  /// Whether some variable at a bound has w_i = 0 in the whole partial cell, up to rounding: then all of it is in the
  /// one with i inside.
  bool degenerate_in_whole(const BoundedRows& rows) {
    if (!skip_degenerate_) return false;
    const double rounding = 1e-12;
    for (Index i = 0; i < problem_.size(); ++i) {
      if (decided_[at(i)] == 0 || cells_[at(i)] == Cell::Inside || problem_.box.is_fixed(i)) continue;
      const double direction = cells_[at(i)] == Cell::Below ? 1 : -1;
      if (direction * rows.value(rows.w(i)) > rounding) continue;
      BoundedRows pushed = rows;
      if (pushed.push(rows.w(i), direction, direction * rounding)) continue;
      cut_degenerate_ = true;
      return true;
    }
    return false;
  }

  bool done() {
    if (out_.stopped != Status::Solved && out_.stopped != Status::Stalled) return true;
    if (const auto reached = limits_.reached()) {
      out_.stopped = Status::Solved;
      stop(*reached, "the enumeration was stopped");
    } else if (pieces_.size() >= options_.max_solutions) {
      stop(Status::IterationLimit, "as many solutions as asked for");
    }
    return out_.stopped != Status::Solved && out_.stopped != Status::Stalled;
  }
  void stop(Status status, const char* message) {
    out_.stopped = status;
    out_.message = message;
  }

  Index farthest_from_complementary(const BoundedRows& rows) const {
    Index found = -1;
    double worst = -1;
    for (Index i = 0; i < problem_.size(); ++i) {
      if (decided_[at(i)] != 0) continue;
      const double z = rows.value(rows.z(i));
      const double w = rows.value(rows.w(i));
      const double gap = w > 0 ? z - scaled_.box.lower[i] : scaled_.box.upper[i] - z;
      const double product = std::min(std::abs(w), gap);
      if (product <= worst) continue;
      worst = product;
      found = i;
    }
    return found;
  }

  void leaf(const BoundedRows& rows, Refutation::Proof& proof) {
    std::vector<Index> inside;
    for (Index i = 0; i < problem_.size(); ++i)
      if (cells_[at(i)] == Cell::Inside) inside.push_back(i);
    if (rank(M_(inside, inside), dependent) == static_cast<Index>(inside.size())) {
      const bool solvable = cell_.solve(cells_) == LuStatus::Ok;
      if (solvable && offer(cell_.z().cwiseQuotient(scaling_.columns), 0)) return;
      if (offer(values(rows), 0)) return;
    } else {
      const Vec z = relative_interior(rows);
      if (offer(z, dimension(z, inside)) || offer(values(rows), dimension(z, inside))) return;
    }
    // The cell's point is no solution: by a sign, though by less than the tolerance of the search, or because it is not
    // known accurately enough.
    BoundedRows strict = rows;
    strict.set_tolerance(0);
    if (!is_empty(strict, proof))
      stop(Status::Stalled, "rounding: a cell holds a point that is not accurate enough to be judged");
  }

  static Vec values(const BoundedRows& rows) {
    return Vec::NullaryExpr(rows.size(), [&](Index i) { return rows.value(rows.z(i)); });
  }

  /// The mean of points that have each inequality of the cell strict, where one has.
  Vec relative_interior(const BoundedRows& rows) const {
    Vec sum = values(rows);
    double count = 1;
    const auto push = [&](Index x, double direction) {
      BoundedRows pushed = rows;
      const double start = rows.value(x);
      if (!pushed.push(x, direction, start + direction * 10 * degenerate * (1 + std::abs(start)))) return;
      sum += values(pushed);
      count += 1;
    };
    for (Index i = 0; i < problem_.size(); ++i) {
      const Cell cell = cells_[at(i)];
      if (problem_.box.is_fixed(i)) continue;
      if (cell != Cell::Inside) {
        push(rows.w(i), cell == Cell::Below ? 1 : -1);
        continue;
      }
      if (problem_.box.has_lower(i)) push(rows.z(i), 1);
      if (problem_.box.has_upper(i)) push(rows.z(i), -1);
    }
    return sum / count;
  }

  bool zero(double value, double scale = 0) const {
    return std::isfinite(value) && std::abs(value) <= 2 * degenerate * (1 + std::abs(scale));
  }

  /// |F| less the rank of the equations that hold on the whole polyhedron: those of the cell, and the inequalities that
  /// are equations in its relative interior.
  Index dimension(const Vec& z, const std::vector<Index>& inside) const {
    const Vec w = M_ * z + scaled_.q;
    const auto columns = static_cast<Index>(inside.size());
    std::vector<Eigen::RowVectorXd> equations;
    for (Index i = 0; i < problem_.size(); ++i)
      if (!problem_.box.is_fixed(i) && (cells_[at(i)] == Cell::Inside || zero(w[i])))
        equations.emplace_back(M_(i, inside));
    for (Index k = 0; k < columns; ++k) {
      const Index i = inside[at(k)];
      if (zero(z[i] - scaled_.box.lower[i], scaled_.box.lower[i]) ||
          zero(z[i] - scaled_.box.upper[i], scaled_.box.upper[i]))
        equations.emplace_back(Eigen::RowVectorXd::Unit(columns, k));
    }
    MatrixXd A(static_cast<Index>(equations.size()), columns);
    for (std::size_t k = 0; k < equations.size(); ++k) A.row(static_cast<Index>(k)) = equations[k];
    return columns - rank(A, dependent);
  }

  /// Takes the point if it is a solution.
  bool offer(const Vec& scaled_z, Index dimension) {
    Piece piece{.cells = cells_, .z = project(scaled_.box, scaled_z), .w = {}, .original = {}, .dimension = dimension};
    piece.original = project(problem_.box, piece.z.cwiseProduct(scaling_.columns));
    if (!piece.original.allFinite()) return false;
    if (!accepts(problem_, piece.original, limits_.tol)) {
      piece.original = refined(problem_, piece.original, limits_.tol);
      if (!accepts(problem_, piece.original, limits_.tol)) return false;
    }
    piece.w = M_ * piece.z + scaled_.q;
    for (const Piece& other : pieces_)
      if (other.dimension >= dimension && contains(other, piece)) return true;
    std::erase_if(pieces_, [&](const Piece& other) { return other.dimension <= dimension && contains(piece, other); });
    pieces_.push_back(std::move(piece));
    return true;
  }

  /// Whether the polyhedron of `inner` is part of that of `outer`: its relative interior point fulfils the equations,
  /// and so do all its points, since for all of them z_i - l_i, u_i - z_i and the signed w_i are not negative.
  bool contains(const Piece& outer, const Piece& inner) const {
    const double near = 1e-6;
    if (outer.dimension == 0)
      return (outer.z - inner.z).lpNorm<Eigen::Infinity>() <= near * (1 + outer.z.lpNorm<Eigen::Infinity>());
    for (Index i = 0; i < problem_.size(); ++i) {
      if (problem_.box.is_fixed(i)) continue;
      const Cell cell = outer.cells[at(i)];
      const double bound = cell == Cell::Above ? scaled_.box.upper[i] : scaled_.box.lower[i];
      const double off = cell == Cell::Inside ? inner.w[i] : inner.z[i] - bound;
      if (std::abs(off) > near * (1 + std::abs(cell == Cell::Inside ? 0 : bound))) return false;
    }
    return true;
  }

  const AffineMcp& problem_;
  const Enumeration& options_;
  const Limits& limits_;
  Scaling scaling_;
  AffineMcp scaled_;
  MatrixXd M_;
  Cells cells_;
  std::vector<char> decided_;
  CellSolver cell_;
  bool skip_degenerate_ = true;
  bool cut_degenerate_ = false;
  long nodes_limit_ = std::numeric_limits<long>::max();
  std::vector<Piece> pieces_;
  static constexpr long most_kept = 4'000'000;  // multipliers of a certificate: 100 MB
  long kept_ = 0;
  double excluded_ = infinity;  // residuals below are, in all cells so far
  Solutions out_;
};

}  // namespace

void describe(Enumeration& m, Fields& f) {
  f.add("enumeration_limit", &m.max_bounded, at_least(0), "variables between bounds up to which cells are enumerated");
}

Solutions enumerate(const AffineMcp& problem, const Enumeration& options, const Limits& limits) {
  check_input("enumerate", problem, Vec::Zero(problem.size()), limits);
  refuse_invalid("enumeration", options);
  Index bounded = 0;
  for (Index i = 0; i < problem.size(); ++i) bounded += problem.box.is_fixed(i) || problem.box.is_free(i) ? 0 : 1;
  if (bounded > options.max_bounded) {
    return {.found = {},
            .complete = false,
            .nodes = 0,
            .stopped = Status::NotApplicable,
            .message = text_of(bounded, " variables have bounds, more than max_bounded = ", options.max_bounded)};
  }
  return Search(problem, options, limits).run();
}

Result enumeration(const AffineMcp& problem, In start, const Enumeration& options, const Limits& limits) {
  check_input("enumeration", problem, start, limits);
  const Solutions all = enumerate(problem, options, limits);
  int two = 0;
  int three = 0;
  for (Index i = 0; i < problem.size(); ++i) {
    if (problem.box.is_fixed(i) || problem.box.is_free(i)) continue;
    ++(problem.box.has_lower(i) && problem.box.has_upper(i) ? three : two);
  }
  std::ostringstream what;
  if (all.complete)
    what << "all 2^" << two << (three > 0 ? " 3^" + std::to_string(three) : "") << " cells examined: ";
  else
    what << all.message << ": ";
  what << all.found.size() << (all.found.size() == 1 ? " solution or set of them" : " solutions or sets of them");
  const Vec z = all.found.empty() ? Vec(start) : all.found.front().z;
  const bool none = all.complete && all.found.empty();
  const Status otherwise = none ? Status::Infeasible : all.complete ? Status::Stalled : all.stopped;
  Result result = judged(problem, z, limits, otherwise, what.str());
  result.message = what.str();
  result.iterations = all.nodes;
  if (result.status == Status::Infeasible) result.refutation = std::make_shared<const Refutation>(all.refutation);
  return result;
}

}  // namespace perp::lcp
