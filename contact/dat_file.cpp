#include "contact/dat_file.hpp"

#include <limits>
#include <utility>
#include <vector>

#include "lcp/numbers.hpp"

namespace perp::contact {
namespace {

using lcp::Numbers;
using Triplets = std::vector<Eigen::Triplet<double>>;

constexpr Index most = std::numeric_limits<int>::max();

struct Shape {
  Index rows;
  Index columns;
};

/// One matrix of the file; its name is for the errors.
class Matrix {
 public:
  Matrix(Numbers& in, const char* name) : in_(in), name_(name) {
    storage_ = in.integer("the storage type", 0, 2);
    if (storage_ == 2) in.refuse("the storage type of ", name, " is 2 (compressed), only 0 and 1 are read");
    shape_.rows = in.integer("the number of rows", 0, most);
    shape_.columns = in.integer("the number of columns", 0, most);
    // No matrix of these files has more rows than numbers that follow it (q or f), nor columns (q or w).
    in.expect(name, shape_.rows, 1);
    in.expect(name, shape_.columns, 1);
  }

  Shape shape() const { return shape_; }

  SpMat entries() {
    if (storage_ == 0)
      read_dense();
    else
      read_blocks();
    SpMat A(shape_.rows, shape_.columns);
    A.setFromTriplets(entries_.begin(), entries_.end());
    return A;
  }

 private:
  void read_block(Index row, Index column, Shape block) {
    for (Index j = 0; j < block.columns; ++j)
      for (Index i = 0; i < block.rows; ++i)
        if (const double a = in_.number(name_); a != 0)
          entries_.emplace_back(static_cast<int>(row + i), static_cast<int>(column + j), a);
  }

  void read_dense() {
    if (in_.integer("the number of rows, again,", 0, most) != shape_.rows ||
        in_.integer("the number of columns, again,", 0, most) != shape_.columns)
      in_.refuse("the second pair of sizes of ", name_, " differs from the first, ", shape_.rows, " x ",
                 shape_.columns);
    in_.expect(name_, shape_.rows, shape_.columns);
    read_block(0, 0, shape_);
  }

  /// The ends of the block rows or columns, with a 0 before them.
  std::vector<Index> ends(const char* what, Index blocks, Index size) {
    in_.expect(what, blocks, 1);
    std::vector<Index> end{0};
    for (Index k = 0; k < blocks; ++k) end.push_back(in_.integer(what, end.back() + 1, size));
    if (end.back() != size) in_.refuse(what, ": the last is ", end.back(), ", not ", size);
    return end;
  }

  void read_blocks() {
    const Index count = in_.integer("the number of blocks", 0, most);
    const Index block_rows = in_.integer("the number of block rows", 0, shape_.rows);
    const Index block_columns = in_.integer("the number of block columns", 0, shape_.columns);
    const std::vector<Index> row_end = ends("the end of a block row", block_rows, shape_.rows);
    const std::vector<Index> column_end = ends("the end of a block column", block_columns, shape_.columns);
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
      block_column.push_back(
          static_cast<std::size_t>(in_.integer("the block column of a block", 0, block_columns - 1)));
    std::vector<std::size_t> last(static_cast<std::size_t>(block_columns), 0);  // block row seen last in it, from 1
    for (std::size_t i = 0; i + 1 < start.size(); ++i)
      for (Index k = start[i]; k < start[i + 1]; ++k) {
        if (in_.integer("the number of a block", 0, most) != k) in_.refuse("the blocks do not follow 0, 1, ..: ", k);
        const std::size_t j = block_column[static_cast<std::size_t>(k)];
        if (std::exchange(last[j], i + 1) == i + 1)
          in_.refuse("block row ", i, " of ", name_, " has two blocks in block column ", j);
        const Shape block{.rows = row_end[i + 1] - row_end[i], .columns = column_end[j + 1] - column_end[j]};
        in_.expect(name_, block.rows, block.columns);
        read_block(row_end[i], column_end[j], block);
      }
  }

  Numbers& in_;
  const char* name_;
  Index storage_ = 0;
  Shape shape_{};
  Triplets entries_;
};

Vec friction(Numbers& in, Index n) {
  in.expect("mu", n, 1);
  Vec mu(n);
  for (Index a = 0; a < n; ++a) {
    mu[a] = in.number("mu");
    if (mu[a] < 0) in.refuse("the coefficient of friction of contact ", a, " is ", mu[a]);
  }
  return mu;
}

void end(Numbers& in) {
  if (in.left() > 0) in.integer("the flag at the end", 0, 1);
  if (in.left() > 0) in.refuse(in.left(), " numbers too many");
}

Problem read_global(Numbers& in, Global g, Index n, int d, const std::string& name) {
  const Index m = g.M.rows();
  if (g.M.cols() != m) in.refuse("M is ", m, " x ", g.M.cols(), ", not square");
  Matrix H(in, "H");
  if (H.shape().rows != m || H.shape().columns != d * n)
    in.refuse("H is ", H.shape().rows, " x ", H.shape().columns, ", not ", m, " x ", d * n);
  g.H = H.entries();
  g.f = in.vector("f", m);
  g.w = in.vector("w", d * n);
  const Vec mu = friction(in, n);
  end(in);
  g.G = SpMat(m, 0);
  g.b = Vec(0);
  try {
    return condense(std::move(g), mu, d, name);
  } catch (const std::invalid_argument& error) {
    in.refuse(error.what());
  }
}

}  // namespace

Problem parse_dat(std::string_view text, const std::string& name) {
  Numbers in(text, name);
  const auto d = static_cast<int>(in.integer("the dimension", 2, 3));
  const Index n = in.integer("the number of contacts", 0, most / 3);
  in.expect("mu", n, 1);
  Matrix first(in, "the first matrix, W or M,");
  const Shape shape = first.shape();
  SpMat A = first.entries();
  // A global problem has more to come: at least the head of H, f and w.
  if (in.left() > d * n + n + 1 || shape.rows != d * n) {
    Global g;
    g.M.swap(A);
    return read_global(in, std::move(g), n, d, name);
  }
  if (shape.columns != d * n) in.refuse("W is ", shape.rows, " x ", shape.columns, ", not ", d * n, " x ", d * n);
  Problem p{.dimension = d, .name = name};
  p.W.swap(A);
  p.q = in.vector("q", d * n);
  p.mu = friction(in, n);
  end(in);
  return p;
}

Problem read_dat(const std::string& path) { return parse_dat(lcp::read_file(path), path); }

}  // namespace perp::contact
