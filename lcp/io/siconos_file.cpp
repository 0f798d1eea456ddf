// SPDX-License-Identifier: Apache-2.0
#include "lcp/io/siconos_file.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "lcp/io/siconos_matrix.hpp"

namespace perp::lcp {
namespace {

using Dense = Eigen::MatrixXd;

/// MATRIX of the header comment, size x size.
SpMat matrix(Numbers& in, const char* what, Index size) {
  SiconosMatrix M(in, what);
  if (M.rows() > M.columns() && M.columns() == size)
    in.refuse(what, " is ", M.rows(), " x ", M.columns(), ": ", M.rows() - M.columns(),
              " equations more than unknowns");
  if (M.rows() != size || M.columns() != size)
    in.refuse(what, " is ", M.rows(), " x ", M.columns(), ", not ", size, " x ", size);
  return M.entries();
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

/// The entries of M in these rows and columns.
SpMat part(const SpMat& M, const std::vector<Index>& rows, const std::vector<Index>& columns) {
  std::vector<int> row(static_cast<std::size_t>(M.rows()), -1);
  for (std::size_t i = 0; i < rows.size(); ++i) row[static_cast<std::size_t>(rows[i])] = static_cast<int>(i);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t j = 0; j < columns.size(); ++j)
    for (SpMat::InnerIterator it(M, columns[j]); it; ++it)
      if (const int i = row[static_cast<std::size_t>(it.row())]; i >= 0)
        entries.emplace_back(i, static_cast<int>(j), it.value());
  SpMat A(static_cast<Index>(rows.size()), static_cast<Index>(columns.size()));
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

void compare(const Numbers& in, const std::string& name, const Dense& block, const SpMat& of_M) {
  for (Index j = 0; j < block.cols(); ++j)
    for (Index i = 0; i < block.rows(); ++i)
      if (const double there = of_M.coeff(i, j); std::abs(block(i, j) - there) > 1e-12 * std::abs(there))
        in.refuse(name, "(", i + 1, block.cols() > 1 ? ", " + std::to_string(j + 1) : "", ") is ", block(i, j),
                  ", but (M, q) has ", there, " there");
}

}  // namespace

SiconosLcp parse_siconos_lcp(std::string_view text, const std::string& name) {
  Numbers in(text, name);
  const Index n = in.integer("n", 0, std::numeric_limits<int>::max());
  SpMat M = matrix(in, "M", n);
  SiconosLcp out{.problem = standard_lcp(std::move(M), in.vector("q", n))};
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
  if (whole) {
    read_blocks(in, n, m, out);
    const SpMat M = matrix(in, "M", n + m);
    const Vec q = in.vector("q", n + m);
    p.A = part(M, out.equations, out.equations);
    p.B = part(M, out.conditions, out.conditions);
    p.C = part(M, out.equations, out.conditions);
    p.D = part(M, out.conditions, out.equations);
    p.a = q(out.equations);
    p.b = q(out.conditions);
  } else {
    for (Index i = 0; i < n + m; ++i) (i < n ? out.equations : out.conditions).push_back(i);
  }
  if (blocks) {
    const auto read = [&](const char* what, Index rows, Index columns, SpMat& into) {
      const Dense given = in.by_rows(what, rows, columns);
      if (whole)
        compare(in, what, given, into);
      else
        into = sparse(given);
    };
    read("A", n, n, p.A);
    read("B", m, m, p.B);
    read("C", n, m, p.C);
    read("D", m, n, p.D);
    SpMat a = sparse(p.a);
    SpMat b = sparse(p.b);
    read("a", n, 1, a);
    read("b", m, 1, b);
    p.a = a;
    p.b = b;
  }
  const std::vector<double> known = in.end();
  if (known.empty()) return out;
  const auto count = static_cast<Index>(known.size());
  // Some files lack one number of u, which is not read; where there is no u, none can be missing.
  if (count != n + 2 * m && (n == 0 || count != n + 2 * m - 1))
    in.refuse(count, " numbers after the problem, neither none nor a solution of ", n + 2 * m,
              n == 0 ? "" : " or one less");
  out.v = Eigen::Map<const Vec>(known.data() + count - 2 * m, m);
  out.w = Eigen::Map<const Vec>(known.data() + count - m, m);
  return out;
}

SiconosLcp read_siconos_lcp(const std::string& path) { return parse_siconos_lcp(read_file(path), path); }
SiconosMlcp read_siconos_mlcp(const std::string& path) { return parse_siconos_mlcp(read_file(path), path); }

}  // namespace perp::lcp
