// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the pattern of a sparse matrix A (m x n) alone says: maximum matchings, the structural rank, and the coarse
/// Dulmage-Mendelsohn decomposition. Rows and columns are the two sides of a bipartite graph with an edge where A has
/// an entry; a matching pairs rows with columns along edges, each at most once. The size of the largest one is the
/// structural rank: the most that rank(A) can be whatever the values of the entries, and what it is for almost all.
///
/// By alternating paths from the rows and columns that a maximum matching leaves alone, rows and columns fall into
///                   columns:  under   square   over
///     rows  under           [  A_u      *       *   ]     fewer rows than columns: too many unknowns
///           square          [   0      A_s      *   ]     as many: A_s has structurally full rank
///           over            [   0       0      A_o  ]     more rows than columns: too many equations
/// which does not depend on the matching. A square matrix is structurally singular exactly if `under` and `over` are
/// not empty; the rows of `over` are then the smallest set of suspects: each of them is left alone by some maximum
/// matching, and no row outside is. The same holds for the columns of `under`.
///
/// References: Hopcroft & Karp, SIAM J. Comput. 2 (1973) 225. Duff, ACM TOMS 7 (1981) 315. Dulmage & Mendelsohn,
/// Canad. J. Math. 10 (1958) 517. Pothen & Fan, ACM TOMS 16 (1990) 303.
#include <vector>

#include "lcp/types.hpp"

namespace perp::lcp {

/// What counts as an entry.
enum class Entries {
  Stored,   ///< what the matrix stores, zeros included: for patterns
  NonZero,  ///< stored entries other than 0 (a NaN is one)
};

struct Matching {
  std::vector<Index> column_of_row;  ///< -1: the row is left alone
  std::vector<Index> row_of_column;  ///< -1: the column is left alone
  Index size = 0;                    ///< number of pairs
};

/// A maximum matching by Hopcroft and Karp's algorithm: time O(entries sqrt(m + n)) at worst, about proportional to the
/// entries as a rule; memory proportional to m + n + entries. The diagonal is matched first.
Matching maximum_matching(const SpMat& A, Entries entries = Entries::NonZero);

Index structural_rank(const SpMat& A, Entries entries = Entries::NonZero);

/// Row and column indices in ascending order.
struct StructurePart {
  std::vector<Index> rows;
  std::vector<Index> columns;
  bool empty() const { return rows.empty() && columns.empty(); }
};

struct Structure {
  Index rank = 0;        ///< structural
  StructurePart under;   ///< structural rank rows.size() < columns.size(); may have no rows (empty columns)
  StructurePart square;  ///< rows.size() == columns.size()
  StructurePart over;    ///< structural rank columns.size() < rows.size(); may have no columns (empty rows)
  Matching matching{};   ///< within the parts
};

/// The coarse decomposition; time and memory as maximum_matching().
Structure dulmage_mendelsohn(const SpMat& A, Entries entries = Entries::NonZero);

/// Small sets of rows with fewer columns than rows: of each row that a maximum matching leaves alone, at most `most` of
/// them, it and the rows that alternating paths from it reach. All columns of the set but one row's are needed: without
/// any one of the rows it can be matched. Ascending by size.
std::vector<StructurePart> overdetermined_parts(const SpMat& A, std::size_t most, Entries entries = Entries::NonZero);

}  // namespace perp::lcp
