// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Matrices made of others: principal blocks, and the system of a damped least-squares problem.
#include <vector>

#include "lcp/lu/sparse_lu.hpp"

namespace perp::lcp {

/// M_II, its rows and columns in the order of I. Pre: M is square, I ascending or not, without repetition.
SpMat principal_block(const SpMat& M, const std::vector<Index>& I);

/// [I H; H' -nu I], quasi-definite for nu > 0.
SpMat least_squares_system(const SpMat& H, double nu);

/// d that minimises ||H d - b||^2 + nu ||d||^2, from  r + H d = b, H'r = nu d,  which does not square H's condition.
/// False if the system is singular to working precision or d not finite. Pre: nu > 0; b has H's rows.
bool damped_least_squares(SparseLu& lu, const SpMat& H, In b, double nu, Vec& d);

}  // namespace perp::lcp
