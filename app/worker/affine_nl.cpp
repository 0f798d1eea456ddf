// SPDX-License-Identifier: Apache-2.0
#include "app/worker/external.hpp"

#include <fmt/format.h>

#include <cmath>

#include "app/program/program.hpp"
#include "ncp/problem/affine.hpp"

namespace perp::app::compare {

namespace {

using Text = std::back_insert_iterator<std::string>;

/// Ten lines, of which most say that nothing is nonlinear, integer or a network.
void write_header(Text text, ncp::Index n, ncp::Index equations, ncp::Index nonzeros) {
  fmt::format_to(
      text,
      "g3 1 1 0\n {0} {0} 0 0 {1}\n 0 0 {2} 0 0 0\n 0 0\n 0 0 0\n 0 0 0 1\n 0 0 0 0 0\n {3} 0\n 0 0\n 0 0 0 0 0\n", n,
      equations, n - equations, nonzeros);
}

/// "0 l u", "1 u", "2 l", "3" or "4 v".
void write_bounds(Text text, double lower, double upper) {
  if (lower == upper)
    fmt::format_to(text, "4 {}\n", lower);
  else if (std::isfinite(lower) && std::isfinite(upper))
    fmt::format_to(text, "0 {} {}\n", lower, upper);
  else if (std::isfinite(upper))
    fmt::format_to(text, "1 {}\n", upper);
  else if (std::isfinite(lower))
    fmt::format_to(text, "2 {}\n", lower);
  else
    fmt::format_to(text, "3\n");
}

}  // namespace

std::string affine_nl(const ncp::Mcp& mcp, ncp::In x0) {
  const std::optional<lcp::AffineMcp> affine = ncp::affine_part(mcp);
  if (!affine) throw input_error("'{}' is not affine", mcp.name());
  const ncp::Box& box = affine->box;
  const ncp::Index n = mcp.size();
  const Eigen::SparseMatrix<double, Eigen::RowMajor> rows(affine->M);
  const auto free = [&](ncp::Index i) { return !std::isfinite(box.lower[i]) && !std::isfinite(box.upper[i]); };
  ncp::Index equations = 0;
  for (ncp::Index i = 0; i < n; ++i) equations += free(i) ? 1 : 0;
  std::string nl;
  const Text text(nl);
  write_header(text, n, equations, rows.nonZeros());
  for (ncp::Index i = 0; i < n; ++i) fmt::format_to(text, "C{}\nn{}\n", i, free(i) ? 0 : affine->q[i]);
  fmt::format_to(text, "x{}\n", n);
  for (ncp::Index i = 0; i < n; ++i) fmt::format_to(text, "{} {}\n", i, x0[i]);
  nl += "r\n";
  for (ncp::Index i = 0; i < n; ++i) {
    const int finite = (std::isfinite(box.lower[i]) ? 1 : 0) + (std::isfinite(box.upper[i]) ? 2 : 0);
    if (free(i))
      fmt::format_to(text, "4 {}\n", -affine->q[i]);
    else
      fmt::format_to(text, "5 {} {}\n", finite, i + 1);
  }
  nl += "b\n";
  for (ncp::Index i = 0; i < n; ++i) write_bounds(text, box.lower[i], box.upper[i]);
  fmt::format_to(text, "k{}\n", n - 1);
  ncp::Index before = 0;
  for (ncp::Index j = 0; j + 1 < n; ++j) {
    before += affine->M.col(j).nonZeros();
    fmt::format_to(text, "{}\n", before);
  }
  for (ncp::Index i = 0; i < n; ++i) {
    if (rows.row(i).nonZeros() == 0) continue;
    fmt::format_to(text, "J{} {}\n", i, rows.row(i).nonZeros());
    for (decltype(rows)::InnerIterator entry(rows, i); entry; ++entry)
      fmt::format_to(text, "{} {}\n", entry.col(), entry.value());
  }
  return nl;
}

}  // namespace perp::app::compare
