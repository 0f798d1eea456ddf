// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The mixed LCP in block form, MLCP(A, B, C, D, a, b): find u in R^n (free) and v in R^m with
///     A u + C v + a = 0
///     w = D u + B v + b,   0 <= v  _|_  w >= 0.
/// A is n x n, B m x m, C n x m, D m x n. (Acary's lecture 3 on contact, equation (8); its second row, printed
/// "D u + b v + b", has the matrix B.)
///
/// Two ways to solve it. Directly, as the affine MCP in z = (u, v) of
///     M = [ A  C ],   q = [ a ],   u free, v >= 0;
///         [ D  B ]        [ b ]
/// or, with A nonsingular, u = -A^-1 (C v + a) eliminated, as the LCP in v of
///     M = B - D A^-1 C,   q = b - D A^-1 a
/// (the lecture prints b for B). The direct form keeps M sparse and needs no regular A; the reduced one is smaller,
/// dense where A^-1 is, and condition(A) enters its data.
#include <optional>
#include <string>

#include "lcp/judge/result.hpp"
#include "lcp/lu/sparse_lu.hpp"

namespace perp::lcp {

struct Mlcp {
  SpMat A;
  SpMat B;
  SpMat C;
  SpMat D;
  Vec a;
  Vec b;

  /// Why the parts do not make a problem (shapes, a value that is not finite), if they do not.
  std::optional<std::string> invalid() const;
};

struct MlcpPoint {
  Vec u;
  Vec v;
  Vec w;  ///< D u + B v + b
};

/// The direct form. Throws std::invalid_argument if the problem is invalid.
AffineMcp to_affine(const Mlcp& mlcp);
/// (u, v, w) of z = (u, v). Throws std::invalid_argument if z has not n + m entries.
MlcpPoint from_affine(const Mlcp& mlcp, In z);

/// The reduced form, one solve with A a column of C that is not empty.
class SchurReduction {
 public:
  /// Throws std::invalid_argument if the problem is invalid. It must outlive *this.
  explicit SchurReduction(const Mlcp& mlcp, LuBackend lu = LuBackend::Umfpack);

  /// Whether there is a reduced problem: Singular if A is (also where rcond(A) < 1e-14), OutOfMemory; NotFinite if A^-1
  /// overflows.
  LuStatus status() const { return status_; }
  double rcond() const { return rcond_; }  ///< estimate for A (SparseLu::rcond()); 1 if n = 0
  /// LCP(b - D A^-1 a, B - D A^-1 C); pre: status() is Ok, else std::logic_error.
  const AffineMcp& problem() const;
  /// u = -A^-1 (C v + a), refined, and w from it. Throws std::invalid_argument if v has not m entries.
  MlcpPoint recover(In v) const;

 private:
  LuStatus reduce();

  const Mlcp& mlcp_;
  SparseLu lu_;
  AffineMcp reduced_;
  double rcond_ = 0;
  LuStatus status_ = LuStatus::Ok;
};

/// max of |A u + C v + a|, |w - (D u + B v + b)|, |min(v, w)|, in the infinity norm: zero exactly at the solutions.
double residual(const Mlcp& mlcp, const MlcpPoint& point);

}  // namespace perp::lcp
