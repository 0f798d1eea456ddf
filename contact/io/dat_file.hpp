// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Reader of the `.dat` files of Siconos' friction tests: numbers separated by blanks or line ends.
///     local                          global (GFC3D)
///     d n                            d n
///     MATRIX W     d n x d n         MATRIX M     m x m
///     q            d n               MATRIX H     m x d n
///     mu           n                 f  m,   w  d n,   mu  n
///     [mu_r        n]                [mu_r  n]
/// and at the end, in some files, a flag 0 or 1 that nothing depends on. d is 2 or 3; with mu_r, of rolling friction
/// (RFC2D, RFC3D, GRFC3D), 3 or 5. MATRIX is that of
/// lcp/io/siconos_file.hpp, dense, sparse by blocks or compressed. Zeros are not stored in W, M, H. A global problem is
/// condensed (contact::condense), its G has no columns.
///
/// Nothing is trusted: counts, shapes, values that are not finite, coefficients below zero, a file that ends too early
/// or has numbers left over are refused, by lcp::FileError with line and reason.
#include <string>
#include <string_view>

#include "contact/model/problem.hpp"

namespace perp::contact {

// Throw lcp::FileError. The problem's name is the file's.
Problem read_dat(const std::string& path);
/// The same from the text of a file; `name` is for the errors.
Problem parse_dat(std::string_view text, const std::string& name);

}  // namespace perp::contact
