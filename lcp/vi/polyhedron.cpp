// SPDX-License-Identifier: Apache-2.0
#include "lcp/vi/polyhedron.hpp"

#include <cmath>

#include "lcp/words.hpp"

namespace perp::lcp {

std::optional<std::string> Polyhedron::invalid() const {
  if (A.cols() != size()) return text_of("A: has ", A.cols(), " columns, and x has ", size(), " entries");
  if (A.rows() != rows.size()) return text_of("A: has ", A.rows(), " rows, and b has ", rows.size(), " entries");
  if (const auto why = rows.invalid()) return "b, c: " + *why;
  if (const auto why = box.invalid()) return "l, u: " + *why;
  for (Index j = 0; j < A.cols(); ++j)
    for (SpMat::InnerIterator it(A, j); it; ++it)
      if (!std::isfinite(it.value()))
        return text_of("A: entry [", it.row(), ", ", j, "] is ", it.value(), ", no finite number");
  return {};
}

AffineMcp lifted(const AffineVi& vi) {
  const Index n = vi.size(), m = vi.C.A.rows();
  const Box& rows = vi.C.rows;
  std::vector<Index> ranges;
  for (Index i = 0; i < m; ++i)
    if (rows.has_lower(i) && rows.has_upper(i) && !rows.is_fixed(i)) ranges.push_back(i);
  const Index size = n + m + static_cast<Index>(ranges.size());
  AffineMcp mcp{SpMat(size, size), Vec::Zero(size), Box::free(size)};
  mcp.q.head(n) = vi.q;
  mcp.box.lower.head(n) = vi.C.box.lower;
  mcp.box.upper.head(n) = vi.C.box.upper;
  std::vector<Eigen::Triplet<double, int>> entries;
  const auto put = [&](Index i, Index j, double a) {
    entries.emplace_back(static_cast<int>(i), static_cast<int>(j), a);
  };
  for (Index j = 0; j < n; ++j) {
    for (SpMat::InnerIterator it(vi.M, j); it; ++it) put(it.row(), j, it.value());
    for (SpMat::InnerIterator it(vi.C.A, j); it; ++it) {
      put(n + it.row(), j, it.value());
      put(j, n + it.row(), -it.value());
    }
  }
  for (Index i = 0; i < m; ++i) {
    if (rows.is_fixed(i)) {
      mcp.q[n + i] = -rows.lower[i];
    } else if (rows.is_free(i)) {
      mcp.box.lower[n + i] = mcp.box.upper[n + i] = 0;
    } else if (!rows.has_upper(i)) {
      mcp.q[n + i] = -rows.lower[i];
      mcp.box.lower[n + i] = 0;
    } else if (!rows.has_lower(i)) {
      mcp.q[n + i] = -rows.upper[i];
      mcp.box.upper[n + i] = 0;
    }
  }
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    const Index s = n + m + static_cast<Index>(k), i = ranges[k];
    put(n + i, s, -1);
    put(s, n + i, 1);
    mcp.box.lower[s] = rows.lower[i];
    mcp.box.upper[s] = rows.upper[i];
  }
  mcp.M.setFromTriplets(entries.begin(), entries.end());
  return mcp;
}

Face face_of(const Polyhedron& C, In z) {
  const Index n = C.size(), m = C.A.rows();
  Face face{.rows = std::vector<Cell>(at(m), Cell::Inside), .bounds = std::vector<Cell>(at(n), Cell::Inside)};
  const double small = m > 0 ? 1e-10 * z.segment(n, m).lpNorm<Eigen::Infinity>() : 0;
  for (Index j = 0; j < n; ++j) face.bounds[at(j)] = cell_of(C.box, j, z[j]);
  for (Index i = 0; i < m; ++i) {
    const double y = z[n + i];
    face.rows[at(i)] = C.rows.is_fixed(i) ? Cell::Fixed
                       : y > small        ? Cell::Below
                       : y < -small       ? Cell::Above
                                          : Cell::Inside;
  }
  return face;
}

}  // namespace perp::lcp
