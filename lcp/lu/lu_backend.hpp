// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The seam between SparseLu and the libraries that factor; private to lcp/.
#include <memory>
#include <string_view>

#include "lcp/lu/lu_factors.hpp"
#include "lcp/lu/sparse_lu.hpp"

namespace perp::lcp {

/// With pivots that are taken again (SparseLu::reuse_pivots); where U grows beyond this, others are looked for.
inline constexpr double most_growth_again = 1000;

/// The cost of a numeric factorization, estimated from the analysis of the pattern; 0 where nothing is known.
struct FactorCost {
  double flops = 0;
  double bytes = 0;
};

class LuLibrary {
 public:
  LuLibrary() = default;
  LuLibrary(const LuLibrary&) = delete;
  LuLibrary& operator=(const LuLibrary&) = delete;
  virtual ~LuLibrary() = default;

  // Pre of all: A is square, compressed, not empty, finite; analyze() before factor() before the solves.
  virtual LuStatus analyze(const SpMat& A) = 0;
  /// Of factor(), after analyze().
  virtual FactorCost cost() const { return {}; }
  virtual LuStatus factor(const SpMat& A) = 0;
  /// SparseLu::reuse_pivots(), where the library looks for pivots in each matrix anew.
  virtual void reuse_pivots() {}
  virtual void solve(const SpMat& A, In b, Out x, bool transposed) const = 0;
  /// Of the last factor() that was Ok: min |U_ii| / max |U_ii|; 0 where the library does not tell.
  virtual double pivot_ratio() const { return 0; }
  /// Copies the factors of the last factor() that was Ok or Singular; false if the library does not give them.
  virtual bool factors(LuFactors&) const { return false; }
  virtual bool gives_factors() const { return true; }  ///< false: factors() never does
};

// One of two files: lu_umfpack.cpp, or lu_mixed.cpp where PERP_GPL=OFF.
std::unique_ptr<LuLibrary> make_general();
std::string_view general_lu();  ///< its name

std::unique_ptr<LuLibrary> make_klu();
std::unique_ptr<LuLibrary> make_eigen();
std::unique_ptr<LuLibrary> make_dense();
std::unique_ptr<LuLibrary> make_definite();  // or general where the matrix is not

}  // namespace perp::lcp
