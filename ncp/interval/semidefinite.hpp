// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Positive semidefiniteness without rounding: what floating point leaves open where a matrix is singular.
#include "lcp/types.hpp"

namespace perp::ncp {

/// Whether the symmetric B, its entries taken as they are, is surely positive semidefinite. Each connected component of
/// its graph is diagonally dominant, by sums that are rounded outward, or has an L D L' with D >= 0 in rational
/// arithmetic (where a pivot is 0, so is its row). That takes components of at most `exact_to` rows: the digits grow.
/// False: it is not, or that is not known. Pre: B has finite entries.
bool surely_semidefinite(const lcp::SpMat& B, lcp::Index exact_to = 24);

}  // namespace perp::ncp
