// SPDX-License-Identifier: Apache-2.0
#include "lcp/io/siconos_matrix.hpp"

#include <limits>
#include <utility>

namespace perp::lcp {
namespace {

constexpr Index most = std::numeric_limits<int>::max();

}  // namespace

SiconosMatrix::SiconosMatrix(Numbers& in, const char* name) : in_(in), name_(name) {
  storage_ = in.integer("the storage type", 0, 2);
  rows_ = in.integer("the number of rows", 0, most);
  columns_ = in.integer("the number of columns", 0, most);
}

SpMat SiconosMatrix::entries() {
  // No matrix of these files has more rows than numbers that follow it (q or f), nor columns (q or w).
  in_.expect(name_, rows_, 1);
  in_.expect(name_, columns_, 1);
  if (storage_ == 0)
    read_dense();
  else if (storage_ == 1)
    read_blocks();
  else
    read_compressed();
  SpMat A(rows_, columns_);
  A.setFromTriplets(entries_.begin(), entries_.end());
  return A;
}

void SiconosMatrix::add(Index row, Index column, double value) {
  if (value != 0) entries_.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
}

void SiconosMatrix::read_block(Index row, Index column, Index rows, Index columns) {
  for (Index j = 0; j < columns; ++j)
    for (Index i = 0; i < rows; ++i) add(row + i, column + j, in_.number(name_));
}

void SiconosMatrix::read_dense() {
  if (in_.integer("the number of rows, again,", 0, most) != rows_ ||
      in_.integer("the number of columns, again,", 0, most) != columns_)
    in_.refuse("the second pair of sizes of ", name_, " differs from the first, ", rows_, " x ", columns_);
  in_.expect(name_, rows_, columns_);
  read_block(0, 0, rows_, columns_);
}

/// The ends of the block rows or columns, with a 0 before them.
std::vector<Index> SiconosMatrix::ends(const char* what, Index blocks, Index size) {
  in_.expect(what, blocks, 1);
  std::vector<Index> end{0};
  for (Index k = 0; k < blocks; ++k) end.push_back(in_.integer(what, end.back() + 1, size));
  if (end.back() != size) in_.refuse(what, ": the last is ", end.back(), ", not ", size);
  return end;
}

void SiconosMatrix::read_blocks() {
  const Index count = in_.integer("the number of blocks", 0, most);
  const Index block_rows = in_.integer("the number of block rows", 0, rows_);
  const Index block_columns = in_.integer("the number of block columns", 0, columns_);
  const std::vector<Index> row_end = ends("the end of a block row", block_rows, rows_);
  const std::vector<Index> column_end = ends("the end of a block column", block_columns, columns_);
  const Index starts = in_.integer("the number of block rows' starts", 1, block_rows + 1);
  if (in_.integer("the number of block columns' numbers", 0, most) != count)
    in_.refuse("the number of block columns' numbers is not that of the blocks, ", count);
  in_.expect("the list of blocks", count, 1);
  std::vector<Index> start{in_.integer("the first block of a block row", 0, 0)};
  while (static_cast<Index>(start.size()) < starts)
    start.push_back(in_.integer("the first block of a block row", start.back(), count));
  if (start.back() != count) in_.refuse("the last block row ends at block ", start.back(), ", not at ", count);
  std::vector<std::size_t> block_column;
  for (Index k = 0; k < count; ++k)
    block_column.push_back(static_cast<std::size_t>(in_.integer("the block column of a block", 0, block_columns - 1)));
  std::vector<std::size_t> last(static_cast<std::size_t>(block_columns), 0);  // block row seen last in it, from 1
  for (std::size_t i = 0; i + 1 < start.size(); ++i)
    for (Index k = start[i]; k < start[i + 1]; ++k) {
      if (in_.integer("the number of a block", 0, most) != k) in_.refuse("the blocks do not follow 0, 1, ..: ", k);
      const std::size_t j = block_column[static_cast<std::size_t>(k)];
      if (std::exchange(last[j], i + 1) == i + 1)
        in_.refuse("block row ", i, " of ", name_, " has two blocks in block column ", j);
      const Index rows = row_end[i + 1] - row_end[i];
      const Index columns = column_end[j + 1] - column_end[j];
      in_.expect(name_, rows, columns);
      read_block(row_end[i], column_end[j], rows, columns);
    }
}

/// The text that CSparse prints.
void SiconosMatrix::read_compressed() {
  const bool triplets = in_.integer("the form of a compressed matrix (1: triplets, 2: columns)", 1, 2) == 1;
  in_.word("CSparse");
  in_.skip_line();
  if (triplets) in_.word("triplet:");
  in_.word(text_of(rows_, "-by-", columns_, ","));
  in_.word("nzmax:");
  in_.integer("nzmax", 0, most);
  in_.word("nnz:");
  const auto entry = [this](Index row, Index column) {
    in_.word(":");
    add(row, column, in_.number(name_));
  };
  if (triplets) {
    for (Index left = in_.integer("the number of triplets", 0, most); left > 0; --left) {
      const Index row = in_.integer("the row of a triplet", 0, rows_ - 1);
      entry(row, in_.integer("the column of a triplet", 0, columns_ - 1));
    }
    return;
  }
  in_.skip_line();  // the number of entries, which the last column tells, and the 1-norm
  Index next = 0;
  for (Index j = 0; j < columns_; ++j) {
    in_.word("col");
    in_.integer("the number of a column", j, j);
    in_.word(":");
    in_.word("locations");
    in_.integer("the place of a column's first entry", next, next);
    in_.word("to");
    const Index last = in_.integer("the place of a column's last entry", next - 1, most);
    for (; next <= last; ++next) entry(in_.integer("the row of an entry", 0, rows_ - 1), j);
  }
}

}  // namespace perp::lcp
