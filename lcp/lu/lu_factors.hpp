// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The factors of one square matrix,  L U = (R A)(P, Q),  R diagonal, in a form that solves with sparse right-hand
/// sides in time proportional to the arithmetic (Gilbert & Peierls, SIAM J. Sci. Stat. Comput. 9 (1988) 862).
/// Private to lcp/.
#include <span>
#include <vector>

#include "lcp/lu/sparse_vector.hpp"

namespace perp::lcp {

/// A triangular matrix by columns, without its diagonal.
struct Triangle {
  std::vector<int> start{0};
  std::vector<int> row;
  std::vector<double> value;

  Index size() const { return static_cast<Index>(start.size()) - 1; }
  Triangle transpose() const;
  // To fill it, column by column.
  void push(int i, double v) {
    row.push_back(i);
    value.push_back(v);
  }
  void end_column() { start.push_back(static_cast<int>(row.size())); }
};

struct LuFactors {
  Triangle L;  ///< unit lower
  Triangle U;  ///< upper
  Triangle L_transposed;
  Triangle U_transposed;  ///< left out until a transposed solve asks for it
  Vec diagonal;           ///< of U
  std::vector<int> P, Q;  ///< step k eliminates row P[k] with column Q[k]
  std::vector<int> P_inverse, Q_inverse;
  Vec R;

  Index size() const { return diagonal.size(); }
  Index nonzeros() const { return size() + static_cast<Index>(L.row.size() + U.row.size()); }
  void finish();  ///< fills the inverse permutations
};

/// Solves with one LuFactors. Holds workspace: one thread at a time.
class LuSolver {
 public:
  LuSolver() = default;
  explicit LuSolver(LuFactors factors);

  Index size() const { return factors_.size(); }
  const LuFactors& factors() const { return factors_; }
  void solve(const SparseVector& b, SparseVector& x);             ///< A  x = b; x is overwritten
  void solve_transposed(const SparseVector& b, SparseVector& x);  ///< A' x = b

 private:
  void eliminate(const Triangle& T, bool ascending, const Vec* diagonal, double& density);
  bool reach(const Triangle& T);

  LuFactors factors_;
  SparseVector work_;
  std::vector<int> order_;  // topological order of the places reached
  std::vector<int> stack_;
  std::vector<int> next_;
  std::vector<char> seen_;
  // The part of the entries that lately came out nonzero, triangle by triangle: where it is large, looking for the
  // reach costs more than it saves.
  double dense_L_ = 0, dense_U_ = 0, dense_Ut_ = 0, dense_Lt_ = 0;
};

}  // namespace perp::lcp
