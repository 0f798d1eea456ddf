// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The tests behind classify(). Private to lcp/.
#include "lcp/classes/classify.hpp"

namespace perp::lcp {

/// The exponents of the entries that are not zero: 2^least <= |M_ij| < 2^(most + 1).
struct Exponents {
  int least = 0;
  int most = 0;
  /// Products of a few entries may overflow, or vanish.
  bool extreme() const { return most > 80 || least < -80; }
  /// They may do so for every multiple of M.
  bool wide() const { return most - least > 800; }
};
Exponents exponents(const SpMat& M);
/// M 2^k, with the exponents about zero: in the same classes.
int centring(const Exponents& e);  ///< k
SpMat centred(const SpMat& M, const Exponents& e);

/// v'Sv / 2, and tol times the terms it is the sum of: within that it counts as zero.
struct Form {
  long double value = 0;  // no product of three entries leaves its range, or vanishes in it
  long double error = 0;
  bool negative() const { return value < -error; }
  bool not_positive() const { return negative() || value == 0; }
};
Form quadratic_form(const SpMat& S, const Vec& v, double tol);

/// Begins the reason of a Yes that rounding may have made.
inline constexpr std::string_view to_rounding = "to rounding: ";

/// Sets positive_definite and positive_semidefinite. Pre: S = M + Mt, Mt = M'.
void classify_definite(const SpMat& M, const SpMat& Mt, const SpMat& S, const ClassifyOptions& options, Diagnosis& d);
bool exact_sum(const SpMat& M, const SpMat& Mt, const SpMat& S);  ///< S = M + Mt without rounding

/// Takes back what a computed zero claims and exact arithmetic does not: forms v'Mv, minors, M_ii v_i - sum |M_ij| v_j.
void take_back_rounded_zeros(const SpMat& M, double tol, Diagnosis& d);

/// The dense test of S alone: Yes or No for both, by eigenvalues; NotDecided where rounding decides.
void dense_definite(const SpMat& S, double tol, Property& definite, Property& semidefinite);

/// Diagonal dominance of the columns of A with nonnegative diagonal.
struct Dominance {
  bool weak = true;                    ///< in all columns, up to rounding
  bool strict = true;                  ///< in all columns, beyond rounding
  bool exactly_weak = true;            ///< in all columns, in exact arithmetic
  bool exactly_strict = true;          ///< the same
  bool overflow = false;               ///< of a column's sum: all of this is unknown
  Index violated = -1;                 ///< a column that is not weakly dominant, beyond rounding
  Index not_strict = -1;               ///< a column that is not strictly dominant, exactly
  std::vector<char> strict_columns{};  ///< exactly
};
Dominance dominance_of_columns(const SpMat& A, double tol);
/// Whether from every column j of A one comes to a strictly dominant one along entries A_kj != 0 (Shivakumar & Chew
/// 1974: then an exactly weakly dominant A is an H-matrix). Pre: B = A'.
bool chained(const Dominance& dominance, const SpMat& B);

/// How the spectral radius rho of D^-1 |M - D| stands to one, D the diagonal (pre: positive), in every strongly
/// connected component: lower <= rho <= upper from x > 0 (Collatz & Wielandt), after at most `sweeps` steps.
struct JacobiRadius {
  std::vector<double> lower{};
  std::vector<double> upper{};
  Vec x{};
};
JacobiRadius jacobi_radius(const SpMat& M, const std::vector<int>& component, int sweeps, double tol);

/// P by Tsatsomeros & Li for a small dense matrix.
struct MinorTest {
  Answer answer = Answer::NotDecided;
  std::vector<Index> alpha{};  ///< of a minor <= 0
  bool zero = false;           ///< that minor is computed as 0
  bool to_rounding = false;    ///< the Yes: a minor may be negative by rounding
};
MinorTest p_by_minors(const Eigen::MatrixXd& A, double tol);
/// P0 by all principal minors.
MinorTest p0_by_minors(const Eigen::MatrixXd& A, double tol);

/// Sets the three copositive classes from dense S by all principal submatrices.
void copositive_by_submatrices(const SpMat& S, const ClassifyOptions& options, Diagnosis& d);

}  // namespace perp::lcp
