// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Which of the matrix classes of complementarity theory M (n x n, any) belongs to, with a reason or a witness, and
/// what follows from it. With S = M + M' and for all v != 0 or all index sets alpha:
///     symmetric                M = M'
///     dominant                 M_ii >= sum_j |M_ij| in all rows, or the like in all columns (strictly: >)
///     Z                        M_ij <= 0 off the diagonal
///     H+                       M_ii > 0 and the comparison matrix (M_ii, -|M_ij|) a nonsingular M-matrix
///     M (K)                    Z and P: a nonsingular M-matrix
///     positive definite        v'Mv > 0                         (semidefinite: >= 0)
///     P                        det M_aa > 0                     (P0: >= 0)
///     copositive               v'Mv >= 0 for v >= 0             (strictly: > 0)
///     copositive-plus          copositive, and v >= 0, v'Mv = 0 => S v = 0
/// No and Yes are proofs up to rounding: a quantity (a row's dominance, a pivot, a minor) that is within `tol` times
/// the terms it is computed from of zero counts as "zero to rounding"; such a matrix is semidefinite, P0, copositive
/// "to rounding" (the reason says so, and that of what follows), and whether it is definite, P, strictly copositive is
/// NotDecided unless the value is known to be exactly zero. Strict dominance is decided exactly. Of entries near the
/// ends of the numbers a multiple of M is looked at; where entries are of too many magnitudes (800 powers of two), what
/// their products would decide is NotDecided.
///
/// References: Cottle, Pang & Stone 1992 (CPS), chapter 3. Tsatsomeros & Li, BIT 40 (2000) 796: P in O(2^n).
/// Hadeler, Linear Algebra Appl. 49 (1983) 79; Cottle, Habetler & Lemke, same journal 3 (1970) 295: copositivity by
/// principal submatrices. Hildebrand, same journal 459 (2014) 154: minimal zeros. Alanelli & Hadjidimos, SIAM J. Matrix
/// Anal. Appl. 28 (2006) 470: H by diagonal scaling. Higham 2002, theorem 10.7: what Cholesky proves.
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lcp/linalg/equation_order.hpp"

namespace perp::lcp {

enum class Answer { No, Yes, NotDecided };
std::string_view to_string(Answer);

struct Property {
  Answer answer = Answer::NotDecided;
  std::string reason{};  ///< of a Yes or No, in words; of NotDecided, what stopped the test
  /// Of a No: the place (i, j) of an entry, or the alpha of a minor that is negative (zero, for P). From 0.
  std::vector<Index> indices{};
  /// Of a No: v with v'Mv < 0 (<= 0 for definiteness and strict copositivity; v >= 0 for the copositive classes; v'Mv =
  /// 0 but S v != 0 for copositive-plus); for P, v != 0 with v_i (Mv)_i <= 0 for all i.
  Vec vector{};
  bool to_rounding = false;  ///< of a Yes, whose reason begins with these words
  bool yes() const { return answer == Answer::Yes; }
  bool no() const { return answer == Answer::No; }
};

struct ClassifyOptions {
  /// A sum counts as zero within tol times its terms. In (0, 1).
  double tol = 1e-13;
  /// Cholesky factors S, or an LU the comparison matrix, up to this n where the cheap tests do not decide.
  Index factor_to = 50'000;
  Index dense_to = 200;      ///< eigenvalues of S up to this n: O(n^3)
  Index minors_to = 20;      ///< P for strongly connected blocks up to this size: O(2^n)
  Index p0_to = 12;          ///< P0 where P fails, the same: O(2^n n^3)
  Index copositive_to = 14;  ///< the copositive classes: O(2^n n^3)
  int sweeps = 30;           ///< of the power method that bounds the spectral radius for H+: O(entries) each
};

/// A statement on LCP(q, M) (or the affine MCP) that follows, and where it is from.
struct Guarantee {
  std::string statement;
  std::string source;
};

struct Diagnosis {
  Index size = 0;
  Property symmetric, strictly_dominant, dominant, z, h_plus, m, positive_definite, positive_semidefinite, p, p0,
      copositive, strictly_copositive, copositive_plus;
  // The box, where there is one (R^n_+ for a matrix alone), of the variables that are not fixed:
  bool cone = true;      ///< every variable has exactly one finite bound: an LCP after shifts and reflections
  bool bounded = false;  ///< every variable has two
  /// The equations stand in this order: row i of M is its row i. Nothing: as they were given.
  std::optional<EquationOrder> order{};

  /// The properties with their names, as in the list at the top.
  std::array<std::pair<std::string_view, const Property*>, 13> all() const;
  /// What the classes guarantee: existence, uniqueness, which methods end with an answer.
  std::vector<Guarantee> guarantees() const;
};

/// Throws std::invalid_argument if M is not square, holds a value that is not finite, or an option is out of range.
/// Where the cheap tests decide, time and memory are a small multiple of M's entries.
Diagnosis classify(const SpMat& M, const ClassifyOptions& options = {});
/// Diagnosis::positive_semidefinite of M alone, whose tests cost less than all.
Property positive_semidefinite(const SpMat& M, const ClassifyOptions& options = {});

/// The classes of the matrix that counts: rows and columns of fixed variables left out (indices and vectors of the
/// witnesses are still those of the problem, with zeros there), those of variables with only an upper bound reflected
/// (z_i -> -z_i, which changes the signs of row and column i and matters for Z and the copositive classes), and the
/// equations of free variables in the order that equation_order() finds.
Diagnosis classify(const AffineMcp& problem, const ClassifyOptions& options = {});
/// Decides whether v'Mv >= 0 for all v that vanish at fixed variables, as classify() does, and no other class. Indices
/// and vector are of the rows in which M + M' has entries.
Property positive_semidefinite(const AffineMcp& problem, const ClassifyOptions& options = {});

}  // namespace perp::lcp
