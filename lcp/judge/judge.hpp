// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The judge of affine problems: the natural residual of F = M z + q summed without rounding errors, so that huge terms
/// that cancel cannot hide an F_i; and what a residual is worth beside the terms it is the rest of,
///     r_i = |mid(z_i - u_i, F_i, z_i - l_i)|,   t_i = sum_j |J_ij z_j| + |F_i - sum_j J_ij z_j|   (|M||z| + |q| here),
/// with n_i the nonzeros of row i. A sum in doubles is known to about n_i eps t_i.
#include "lcp/affine_mcp.hpp"

namespace perp::lcp {

/// The terms of every row.
struct RowTerms {
  Vec size;                 ///< t_i
  Eigen::VectorXi entries;  ///< n_i
};

/// r_i against t_i.
struct Accuracy {
  double relative = infinity;  ///< max r_i / t_i, with 0 / 0 = 0
  Index worst = -1;            ///< the row of it
  /// r_i <= 8 (n_i + 2) eps t_i in every row: within what doubles round.
  bool to_rounding = false;
};
Accuracy accuracy(In row_residuals, const RowTerms& terms);
/// max_i 8 (n_i + 2) eps t_i.
double largest_rounding(const RowTerms& terms);

struct Judgement {
  Vec F;                      ///< M z + q, each the double nearest to the exact sum; empty where z is not finite
  Vec rows;                   ///< r_i; likewise
  RowTerms terms;             ///< t_i and n_i; likewise
  double natural = infinity;  ///< max r_i; +inf where something is not finite
  Index worst = -1;           ///< its row
  Accuracy accuracy;
};
/// O(nonzeros of M). Throws std::invalid_argument if z has another length than the problem.
Judgement judge(const AffineMcp& problem, In z);

/// |mid(z_i - u_i, F_i, z_i - l_i)| = |z_i - mid(l_i, z_i - F_i, u_i)|; the left side does not lose F_i beside z_i.
double row_residual(const Box& box, Index i, double z, double F);

/// Whether z may be a solution rounded to doubles: with dz = -M_II^-1 F_I, the step to the point of the cell that z
/// points to, sum_j |M_ij dz_j| <= 1e-4 t_i in every row. A z that runs off along what M nearly takes to zero has small
/// residuals beside its terms, too, also where there is no solution; this tells it. Costs a factorization of M_II.
bool rounds_a_solution(const AffineMcp& problem, In z, In F, const RowTerms& terms);

/// Whether z is no solution but near one: every r_i at most tol or 1e-6 t_i. A factorization may bring the last digits.
bool worth_refining(const Judgement& judgement, double tol);
/// The point of the cell that z points to, with steps of refinement by exact residuals, where that is better: a
/// solution to tol, or to rounding, or nearer to one; else z. Costs a factorization of the block of M inside the
/// bounds.
Vec refined(const AffineMcp& problem, In z, double tol);

}  // namespace perp::lcp
