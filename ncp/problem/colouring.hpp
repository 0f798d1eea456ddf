// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Columns of a sparse matrix in groups of which no two columns have an entry in the same row ("structurally
/// orthogonal"; a colouring of the graph of the columns that share rows). One difference of F, or one lane of dual
/// numbers, tells all columns of a group.
/// References: Curtis, Powell & Reid, On the estimation of sparse Jacobian matrices, IMA J. Appl. Math. 13 (1974) 117;
/// Coleman & More, Estimation of sparse Jacobian matrices and graph coloring problems, SIAM J. Numer. Anal. 20 (1983)
/// 187, whose largest-first order this is.
#include <vector>

#include "lcp/box.hpp"

namespace perp::ncp {

/// Returns the groups; every column is in one of them. Greedily: a column joins the first group that has none of its
/// rows; first the columns in the order of their entries, most entries first, then in their own order, and the fewer
/// groups count. No fewer groups are possible than the fullest row has entries; banded matrices, n rows or more, need
/// no more than the width of their band. `pattern`: compressed.
std::vector<std::vector<int>> column_groups(const lcp::SpMat& pattern);

}  // namespace perp::ncp
