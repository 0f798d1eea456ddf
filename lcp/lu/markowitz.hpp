// SPDX-License-Identifier: Apache-2.0
#pragma once
/// LU with the pivots of Markowitz' rule (Management Science 3 (1957) 255): of the entries that are large enough in
/// their column the one with the least product of other entries in its row and its column, looked for in a few of the
/// shortest lines (Zlatev, SIAM J. Numer. Anal. 17 (1980) 18). Jacobians of models and bases have zero diagonals, and
/// orders that take no account of values lose what they saved to pivots beside the diagonal. What is left at last is
/// mostly full, and factored as a full matrix. Private to lcp/lu/.
#include <vector>

#include "lcp/lu/lu_factors.hpp"

namespace perp::lcp {

class Markowitz {
 public:
  /// R A = P' L U Q'. False if the matrix is singular, structurally or by an exact zero; then there are no factors.
  /// The factors may hold infinities and NaN, where a pivot is as small as that.
  bool factor(const SpMat& A, const Vec& R);
  /// The same with the pivots and the pattern of the last factor() that was true, for another matrix of its pattern.
  /// False, and no factors, where these pivots are too small for it.
  bool factor_again(const SpMat& A, const Vec& R);

  // Of the last of them, if that was true; R and the inverse permutations are not among them.
  Triangle L;  ///< its rows are steps
  Triangle U;
  std::vector<double> diagonal;
  std::vector<int> P, Q;  ///< step k eliminates row P[k] with column Q[k]

 private:
  /// Rows or columns, by the number of their entries.
  class Lines {
   public:
    void clear(std::size_t lines);
    void insert(int line, int entries);
    void remove(int line);
    void move(int line, int entries) {
      if (entries_[at(line)] == entries) return;
      remove(line);
      insert(line, entries);
    }
    int first(int entries) const { return head_[at(entries)]; }
    int after(int line) const { return next_[at(line)]; }

   private:
    std::vector<int> head_, next_, previous_, entries_;
  };
  /// Where a line's entries are in the array of all.
  struct Slot {
    std::size_t start = 0;
    int size = 0;
    int room = 0;
  };
  struct Pivot {
    int row = -1;
    int column = -1;
  };

  void load(const SpMat& A, const Vec& R);
  void begin();
  bool mostly_full(std::size_t steps) const;
  double largest(int column);
  void look_at_column(int column, double& best, Pivot& pivot);
  void look_at_row(int row, double& best, Pivot& pivot);
  Pivot choose();
  void take_pivot_column(const Pivot& pivot);
  void eliminate(const Pivot& pivot);
  void update(int column, double u);
  void append(int column, int row, double value);
  void forget_in_row(int row, int column);
  bool finish_full();
  void number_by_steps();

  Index n_ = 0;
  std::size_t entries_ = 0;  // of the part that is left
  std::vector<Slot> columns_, rows_;
  std::vector<int> row_of_;  // by columns, with value_
  std::vector<double> value_;
  std::vector<int> column_of_;   // by rows
  std::vector<double> largest_;  // by columns; < 0: not known
  Lines short_columns_, short_rows_;
  std::vector<double> multiplier_;   // l of the present step by rows
  std::vector<int> has_multiplier_;  // the last step in which this row had one, from 1
  std::vector<int> met_;             // the last update that met this row
  int updates_ = 0;
  std::size_t pivot_column_ = 0;  // begin of the present step in L
  std::vector<int> step_of_row_, step_of_column_;
  Triangle U_rows_;           // the rows of U, with the columns of A
  std::vector<double> work_;  // by steps, 0 between two columns
};

}  // namespace perp::lcp
