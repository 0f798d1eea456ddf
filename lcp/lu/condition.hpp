// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The condition of a matrix that is known by its solves. Private to lcp/.
#include <functional>

#include "lcp/types.hpp"

namespace perp::lcp {

/// max_j sum_i |A_ij|
double norm1(const SpMat& A);

/// Estimate of 1 / (||A||_1 ||A^-1||_1), in [0, 1]. ||A^-1||_1 by Hager's method in Higham's form (ACM TOMS 14 (1988)
/// 381, algorithm 4.1): a lower bound, rarely off by more than three, after about four solves.
double reciprocal_condition(double norm1, Index n, const std::function<void(In, Out)>& solve,
                            const std::function<void(In, Out)>& solve_transposed);

}  // namespace perp::lcp
