#pragma once
/// Reader of the `.dat` files of Siconos' friction tests: numbers separated by blanks or line ends.
///     local                          global (GFC3D)
///     d n                            d n
///     MATRIX W     d n x d n         MATRIX M     m x m
///     q            d n               MATRIX H     m x d n
///     mu           n                 f  m,   w  d n,   mu  n
/// and at the end, in some files, a flag 0 or 1 that nothing depends on. MATRIX is
///     storage rows columns           storage 0: dense
///     rows columns                   again
///     entries by COLUMNS             however they are broken into lines
/// or
///     storage rows columns           storage 1: sparse by blocks
///     N                              blocks
///     B C                            block rows, block columns
///     e_1 .. e_B                     rows up to the end of each block row: row of its end
///     e_1 .. e_C                     the same of the columns
///     a b                            lengths of the next two, b = N
///     k_1 .. k_a                     block row i has the blocks k_i .. k_{i+1} - 1; trailing empty ones may be
///                                    left out
///     c_1 .. c_b                     block column of each block
/// then for each block its number (from 0) and its entries by COLUMNS.
/// Zeros are not stored in W, M, H. A global problem is condensed (contact::condense), its G has no columns.
///
/// Nothing is trusted: counts, shapes, values that are not finite, coefficients below zero, a file that ends too early
/// or has numbers left over are refused, by lcp::FileError with line and reason.
#include <string>
#include <string_view>

#include "contact/problem.hpp"

namespace perp::contact {

// Throw lcp::FileError. The problem's name is the file's.
Problem read_dat(const std::string& path);
/// The same from the text of a file; `name` is for the errors.
Problem parse_dat(std::string_view text, const std::string& name);

}  // namespace perp::contact
