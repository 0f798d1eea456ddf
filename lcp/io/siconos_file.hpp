// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Readers of the `.dat` files with which Siconos tests its LCP and MLCP solvers. All numbers are separated by blanks
/// or line ends.
///
/// LCP(q, M):
///     n
///     MATRIX                         n x n
///     q_1 .. q_n
/// MLCP:
///     s1 s2                          1 if the problem is given as (M, q), as (A, B, C, D, a, b); or both
///     n m                            unknowns u, v
///     if s1:  0 r_1 .. n + m         first rows (from 0) of the blocks of M, and their end
///             c_1 ..                 0: the block's rows are equations, 1: complementarity conditions
///             MATRIX                 (n + m) x (n + m)
///             q_1 .. q_{n+m}
///     if s2:  A B C D a b            dense, by ROWS
/// MATRIX is
///     storage rows columns           storage 0: dense
///     rows columns                   again
///     entries by COLUMNS             lcp_CPS_2.dat, which looks as if printed by rows, is example 4.4.7 of the book
///                                    that way
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
///     number, entries by COLUMNS     of each block, numbered from 0
/// or
///     storage rows columns           storage 2: compressed, as CSparse prints it
///     2                              1: triplets, 2: columns
///     CSparse Version ..
///     ROWS-by-COLUMNS, nzmax: N nnz: N, 1-norm: X
///     col 0 : locations 0 to 1       of each column its entries, row : value
///     0 : 856.713
///     ..
/// The third line of triplets is "triplet: ROWS-by-COLUMNS, nzmax: N nnz: N", and each entry row column : value.
///
/// Blocks may come in any number and order; u and v gather the unknowns of the equations and of the conditions. After
/// the problem may stand the known solution (z, w) or (v, w), or on a new line any text that does not begin with a
/// number.
///
/// Nothing is trusted: counts, shapes, values that are not finite, a file that ends too early or has numbers left over,
/// M, q that contradict A .. b are refused, by FileError with line and reason; so are rectangular MLCPs, with more
/// equations than free unknowns.
#include <string>
#include <string_view>
#include <vector>

#include "lcp/io/file_error.hpp"
#include "lcp/solve/mlcp.hpp"

namespace perp::lcp {

struct SiconosLcp {
  AffineMcp problem;
  Vec z{};  ///< the file's known solution, unjudged, if it has one
  Vec w{};
};

struct SiconosMlcp {
  Mlcp mlcp;
  std::vector<Index> equations{};   ///< rows and columns of M that are u, in order
  std::vector<Index> conditions{};  ///< those that are v
  Vec v{};                          ///< the file's known solution, unjudged, if it has one
  Vec w{};
};

// Throw FileError.
SiconosLcp read_siconos_lcp(const std::string& path);
SiconosMlcp read_siconos_mlcp(const std::string& path);
// The same from the text of a file; `name` is for the errors.
SiconosLcp parse_siconos_lcp(std::string_view text, const std::string& name);
SiconosMlcp parse_siconos_mlcp(std::string_view text, const std::string& name);

}  // namespace perp::lcp
