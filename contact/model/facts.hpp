// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What is known of a problem's Delassus operator before it is solved. In exact mechanics W is symmetric, positive
/// semidefinite, and of rank d n unless contacts are redundant (four feet on a floor). All is measured on
///     S = D W D,  D = diag(|W_ii|^-1/2)  (1 where W_ii = 0),
/// whose diagonal is 1 whatever the units, and whose entries then are within [-1, 1].
#include "contact/model/problem.hpp"

namespace perp::contact {

struct FactsOptions {
  Index dense_limit = 1000;  ///< eigenvalues are computed where no part has more rows: O(limit^3), 1 s at about 1,000
  double rank_tol = 1e-10;   ///< eigenvalues below this part of the largest are none
};

struct Facts {
  double asymmetry = 0;  ///< max |S_ij - S_ji|; up to 0.02 in recorded data. Of M where W is not formed
  bool known = false;    ///< whether the rest is: every part has at most dense_limit rows
  Index rank = 0;        ///< of (S + S') / 2
  double least = 0;      ///< eigenvalue of (S + S') / 2, and the largest; least < 0 beyond rounding: not semidefinite
  double largest = 0;
  Index parts = 0;         ///< contacts that do not act on each other, however indirectly, are in different parts
  Index largest_part = 0;  ///< rows of it
};

/// Throws std::invalid_argument where check(problem) does.
Facts facts(const Problem& problem, const FactsOptions& options = {});

}  // namespace perp::contact
