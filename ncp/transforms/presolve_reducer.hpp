// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The reductions of presolve.hpp on rows and columns. Private to ncp/.
///
/// Invariants: kept rows and kept columns are paired one to one. The bounds of the column decide what its row has to
/// be; a row paired with a free column is an equation, and stays one until it goes, satisfied at every point that
/// postsolve can return. All that is concluded from equations is therefore true there. F_ is F at the point x_ as long
/// as a row is not `stale`.
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "ncp/problem/counted_mcp.hpp"
#include "ncp/transforms/presolve.hpp"

namespace perp::ncp {

inline constexpr double trust = 1e-6;  ///< what equations are taken to hold to at a solution that somebody accepted

class Reducer {
 public:
  /// x0 is projected onto the box.
  Reducer(const Mcp& mcp, In x0);
  /// Fixed variables only, or everything.
  void run(bool everything);
  /// Is F defined at x()? Known after run(true) if it was at x0.
  bool defined() const { return !blocked_; }

  // What came out, as in Presolved.
  std::string infeasible{};
  std::vector<std::string> notes{};
  PresolveCounts counts{};
  std::vector<Postponed> postponed{};
  const Vec& x() const { return x_; }
  const SpMat& J() const { return J_; }
  /// x(), and F and J there if they were evaluated there and are no use here any more.
  Point evaluated();
  bool kept(Index column) const { return column_state_[at(column)] == State::Kept; }
  Index row_of(Index column) const { return row_of_[at(column)]; }
  int F_evals() const { return counted_.F_evals(); }
  int J_evals() const { return counted_.J_evals(); }

 private:
  enum class State : char { Kept, Fixed, Postponed };
  struct Entry {
    double a;     ///< the constant derivative
    int index;    ///< of the column, in a row; of the row, in a column
    bool linear;  ///< is it one?
  };
  using Entries = std::span<const Entry>;
  /// The entries of all rows, or of all columns, in one array.
  struct Lists {
    std::vector<std::size_t> start{};
    std::vector<Entry> entry{};
    Entries operator[](std::size_t i) const { return {entry.data() + start[i], entry.data() + start[i + 1]}; }
  };
  /// First in, first out.
  class Queue {
   public:
    bool empty() const { return next_ == items_.size(); }
    void reserve(std::size_t most) { items_.reserve(most); }
    void push_back(Index i) { items_.push_back(i); }
    Index take() {
      const Index i = items_[next_++];
      if (empty()) items_.clear(), next_ = 0;
      return i;
    }

   private:
    std::vector<Index> items_{};
    std::size_t next_ = 0;
  };
  /// Range of an affine row over the box, implied bounds included.
  struct Activity {
    double low = 0, high = 0;  ///< the finite parts
    int low_infinite = 0, high_infinite = 0;
    double size = 0;       ///< of the terms
    bool implied = false;  ///< a bound that is not the box's took part
    bool above(double margin) const { return low_infinite == 0 && low > margin; }
    bool below(double margin) const { return high_infinite == 0 && high < -margin; }
  };
  struct Term {
    double low, high;  ///< of a (x_j - x_j at the point)
    bool implied;
  };

  const Box& box() const { return mcp_.box(); }
  bool is_free(Index c) const { return box().is_free(c); }
  bool is_equation(Index row) const { return is_free(column_of_[at(row)]); }
  /// Kept, affine in what is not fixed, with F_ at x_.
  bool is_affine(Index row) const {
    return row_kept_[at(row)] != 0 && nonlinear_[at(row)] == 0 && stale_[at(row)] == 0;
  }

  // presolve_reducer.cpp
  bool know_values();
  void list_entries(const std::vector<bool>& linear);
  void count_entries();
  void fix(Index column, double value);
  void drop(Index row);
  void pair(Index row, Index column);
  void postpone(Index row, Index column, double a);
  void push_row(Index row);
  void push_column(Index column);
  void drain();
  bool reevaluate(bool at_the_end);
  void polish();

  // presolve_rows.cpp
  void examine_row(Index row);
  void empty_row(Index row);
  bool singleton_row(Index row);
  bool set_by_equation(Index row, Index column, double a, double value);
  void range_row(Index row);
  void force(Index row, double sign, double nearest, const Activity& activity);
  Activity activity(Index row) const;
  Term term(const Entry& entry) const;
  void tighten(Index row, const Activity& activity);
  bool imply(Index column, bool lower, double bound, Index row);
  void examine_column(Index column);
  bool harmless_at_bound(Index row, Index column, double a);

  // presolve_parallel.cpp
  std::vector<Index> alike() const;
  bool parallel_rows();
  void compare(Index equation, Index row);

  // Tolerances.
  double rounding(Index row) const { return 1e-11 * size_[row]; }
  double verdict(Index row) const;
  std::string equation(Index row) const { return "equation " + mcp_.equation_name(row); }
  std::string objection(Index row, double sign) const;

  const Mcp& mcp_;
  CountedMcp counted_;
  Vec x_, F_;
  SpMat J_;
  Lists rows_, columns_;  // constant zeros left out
  std::vector<State> column_state_;
  std::vector<char> row_kept_, stale_, linear_column_;
  std::vector<Index> row_of_, column_of_;
  std::vector<int> unfixed_, nonlinear_;  // entries of a row in kept columns; those of them that are not constant
  std::vector<int> kept_rows_;            // of a column: entries in kept rows
  std::vector<int> looks_;                // at the activity of a row
  Vec size_;                              // of the terms of a row: what its rounding errors are relative to
  Vec implied_lower_, implied_upper_;
  std::vector<Index> lower_by_, upper_by_;  // the equation that implies the bound, or -1
  std::vector<Postponed> set_;              // variables set by equations of their own
  std::vector<Index> set_by_;               // of a row: the column whose being set made it an equation, or -1
  Queue row_queue_, column_queue_;
  std::vector<char> row_queued_, column_queued_;
  bool moved_ = false;
  bool blocked_ = false;  // F is not defined at x_ any more
};

}  // namespace perp::ncp
