// SPDX-License-Identifier: Apache-2.0
#include "ncp/problem/counted_mcp.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace perp::ncp {
namespace {

/// The first entry of J that its pattern has not, or of the pattern that J lost; (-1, -1) if there is none.
std::pair<Index, Index> first_difference(const SpMat& J, const SpMat& pattern) {
  for (Index j = 0; j < pattern.cols(); ++j) {
    SpMat::InnerIterator a(J, j);
    SpMat::InnerIterator b(pattern, j);
    for (; a && b; ++a, ++b)
      if (a.row() != b.row()) return {std::min(a.row(), b.row()), j};
    if (a) return {a.row(), j};
    if (b) return {b.row(), j};
  }
  return {-1, -1};
}

}  // namespace

bool CountedMcp::eval(In x, Vec& F) {
  ++F_evals_;
  F.setZero(x.size());
  return mcp_.eval(x, F) && F.allFinite();
}

bool CountedMcp::jacobian(In x, SpMat& J) {
  ++J_evals_;
  const SpMat& pattern = mcp_.jacobian_pattern();
  if (J.rows() != pattern.rows() || J.nonZeros() != pattern.nonZeros()) J = pattern;
  if (!mcp_.jacobian(x, J)) return false;
  const bool kept =
      J.isCompressed() && J.rows() == pattern.rows() && J.cols() == pattern.cols() &&
      J.nonZeros() == pattern.nonZeros() &&
      std::equal(pattern.outerIndexPtr(), pattern.outerIndexPtr() + pattern.cols() + 1, J.outerIndexPtr()) &&
      std::equal(pattern.innerIndexPtr(), pattern.innerIndexPtr() + pattern.nonZeros(), J.innerIndexPtr());
  if (!kept) {
    std::ostringstream what;
    what << mcp_.name() << ": the Jacobian does not match its pattern";
    if (J.rows() != pattern.rows() || J.cols() != pattern.cols()) {
      what << ": it is " << J.rows() << " x " << J.cols() << ", the pattern " << pattern.rows() << " x "
           << pattern.cols();
    } else if (const auto [i, j] = first_difference(J, pattern); i >= 0) {
      what << " at the derivative of equation " << mcp_.equation_name(i) << " with respect to variable "
           << mcp_.variable_name(j) << ": it has " << J.nonZeros() << " entries, the pattern " << pattern.nonZeros();
    } else {
      what << ": it is not compressed";
    }
    throw std::invalid_argument(what.str());
  }
  return std::all_of(J.valuePtr(), J.valuePtr() + J.nonZeros(), [](double v) { return std::isfinite(v); });
}

}  // namespace perp::ncp
