#include "lcp/siconos_file.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "lcp/numbers.hpp"

namespace perp::lcp {
namespace {

using Dense = Eigen::MatrixXd;

/// MATRIX of the header comment.
Dense matrix(Numbers& in, const char* what, Index size) {
  const Index storage = in.integer("the storage type", 0, 100);
  if (storage != 0)
    in.refuse("the storage type of ", what, " is ", storage, storage == 1 ? " (block-sparse)" : "",
              ", only 0 (dense) is read");
  const Index most = std::numeric_limits<int>::max();
  const Index rows = in.integer("the number of rows", 0, most);
  const Index columns = in.integer("the number of columns", 0, most);
  if (in.integer("the number of rows, again,", 0, most) != rows ||
      in.integer("the number of columns, again,", 0, most) != columns)
    in.refuse("the second pair of sizes differs from the first, ", rows, " x ", columns);
  if (rows > columns && columns == size)
    in.refuse(what, " is ", rows, " x ", columns, ": ", rows - columns, " equations more than unknowns");
  if (rows != size || columns != size) in.refuse(what, " is ", rows, " x ", columns, ", not ", size, " x ", size);
  in.expect(what, rows, columns);
  Dense M(rows, columns);
  for (Index j = 0; j < columns; ++j)
    for (Index i = 0; i < rows; ++i) M(i, j) = in.number(what);
  return M;
}

/// The rows of the equations and of the conditions.
void read_blocks(Numbers& in, Index n, Index m, SiconosMlcp& out) {
  std::vector<Index> first{in.integer("the first block's first row", 0, 0)};
  while (first.back() < n + m) first.push_back(in.integer("a block's first row", first.back() + 1, n + m));
  for (std::size_t k = 0; k + 1 < first.size(); ++k) {
    auto& rows = in.integer("a block's type", 0, 1) == 0 ? out.equations : out.conditions;
    for (Index i = first[k]; i < first[k + 1]; ++i) rows.push_back(i);
  }
  if (static_cast<Index>(out.equations.size()) != n)
    in.refuse("the blocks have ", out.equations.size(), " equations for ", n, " free unknowns");
}

SpMat sparse(const Dense& A) { return A.sparseView(0, 0); }

void compare(const Numbers& in, const std::string& name, const Dense& block, const Dense& of_M) {
  for (Index j = 0; j < block.cols(); ++j)
    for (Index i = 0; i < block.rows(); ++i)
      if (std::abs(block(i, j) - of_M(i, j)) > 1e-12 * std::abs(of_M(i, j)))
        in.refuse(name, "(", i + 1, block.cols() > 1 ? ", " + std::to_string(j + 1) : "", ") is ", block(i, j),
                  ", but (M, q) has ", of_M(i, j), " there");
}

}  // namespace

SiconosLcp parse_siconos_lcp(std::string_view text, const std::string& name) {
  Numbers in(text, name);
  const Index n = in.integer("n", 0, std::numeric_limits<int>::max());
  const Dense M = matrix(in, "M", n);
  SiconosLcp out{.problem = standard_lcp(sparse(M), in.vector("q", n))};
  const std::vector<double> known = in.end();
  if (known.empty()) return out;
  if (static_cast<Index>(known.size()) != 2 * n)
    in.refuse(known.size(), " numbers after the problem, neither none nor a solution of ", 2 * n);
  out.z = Eigen::Map<const Vec>(known.data(), n);
  out.w = Eigen::Map<const Vec>(known.data() + n, n);
  return out;
}

SiconosMlcp parse_siconos_mlcp(std::string_view text, const std::string& name) {
  Numbers in(text, name);
  const bool whole = in.integer("the first storage flag", 0, 1) == 1;
  const bool blocks = in.integer("the second storage flag", 0, 1) == 1;
  if (!whole && !blocks) in.refuse("both storage flags are 0: there is no problem");
  const Index most = std::numeric_limits<int>::max() / 2;
  const Index n = in.integer("n", 0, most);
  const Index m = in.integer("m", 0, most);
  in.expect("the problem", n + m, 1);
  SiconosMlcp out;
  Mlcp& p = out.mlcp;
  Dense A;
  Dense B;
  Dense C;
  Dense D;
  if (whole) {
    read_blocks(in, n, m, out);
    const Dense M = matrix(in, "M", n + m);
    const Vec q = in.vector("q", n + m);
    A = M(out.equations, out.equations);
    B = M(out.conditions, out.conditions);
    C = M(out.equations, out.conditions);
    D = M(out.conditions, out.equations);
    p.a = q(out.equations);
    p.b = q(out.conditions);
  } else {
    for (Index i = 0; i < n + m; ++i) (i < n ? out.equations : out.conditions).push_back(i);
  }
  if (blocks) {
    const auto read = [&](const char* what, Index rows, Index columns, Dense& into) {
      const Dense given = in.by_rows(what, rows, columns);
      if (whole)
        compare(in, what, given, into);
      else
        into = given;
    };
    read("A", n, n, A);
    read("B", m, m, B);
    read("C", n, m, C);
    read("D", m, n, D);
    Dense a = p.a;
    Dense b = p.b;
    read("a", n, 1, a);
    read("b", m, 1, b);
    p.a = a;
    p.b = b;
  }
  p.A = sparse(A);
  p.B = sparse(B);
  p.C = sparse(C);
  p.D = sparse(D);
  const std::vector<double> known = in.end();
  if (known.empty()) return out;
  const auto count = static_cast<Index>(known.size());
  if (count != n + 2 * m && count != n + 2 * m - 1)
    in.refuse(count, " numbers after the problem, neither none nor a solution of ", n + 2 * m, " or one less");
  out.v = Eigen::Map<const Vec>(known.data() + count - 2 * m, m);
  out.w = Eigen::Map<const Vec>(known.data() + count - m, m);
  return out;
}

SiconosLcp read_siconos_lcp(const std::string& path) { return parse_siconos_lcp(read_file(path), path); }
SiconosMlcp read_siconos_mlcp(const std::string& path) { return parse_siconos_mlcp(read_file(path), path); }

}  // namespace perp::lcp
