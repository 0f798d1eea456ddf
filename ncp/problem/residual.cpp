// SPDX-License-Identifier: Apache-2.0
#include "ncp/problem/residual.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "ncp/problem/affine.hpp"

namespace perp::ncp {

namespace {

/// The first row where x or F is not finite, else their number.
Index defined_rows(In x, In F) {
  if (((x - x) + (F - F)).sum() == 0) return x.size();  // the usual case, without a test a row
  Index i = 0;
  while (i < x.size() && std::isfinite(F[i]) && std::isfinite(x[i])) ++i;
  return i;
}

}  // namespace

// Whole arrays at a time: every iteration of every method asks for it.
Residual residual(const Box& box, In x, In F) {
  if (x.size() != box.size() || F.size() != box.size())
    throw std::invalid_argument("residual: x has " + std::to_string(x.size()) + " entries, F " +
                                std::to_string(F.size()) + ", the box " + std::to_string(box.size()));
  const Index n = defined_rows(x, F);
  Residual r;
  r.natural = 0;
  if (n > 0) {
    const auto z = x.head(n).array();
    const auto f = F.head(n).array();
    const auto above = z - box.lower.head(n).array();
    const auto below = box.upper.head(n).array() - z;
    r.natural = f.max(-below).min(above).abs().maxCoeff();
    r.bounds = std::max(0.0, (-above).max(-below).maxCoeff());
    r.complementarity = std::max(0.0, above.min(f).max(below.min(-f)).maxCoeff());
    r.worst = 0;
    while (r.worst + 1 < n && lcp::row_residual(box, r.worst, x[r.worst], F[r.worst]) != r.natural) ++r.worst;
  }
  if (n < x.size()) {
    r.natural = infinity;
    r.worst = n;
  }
  return r;
}

Residual residual(const Mcp& mcp, In x) {
  Vec F = Vec::Zero(x.size());
  if (x.size() != mcp.size()) return residual(mcp.box(), x, F);  // refuses it
  if (mcp.eval(x, F)) {
    const auto affine = affine_part(mcp);
    return residual(mcp.box(), x, affine && x.allFinite() ? lcp::judge(*affine, x).F : F);
  }
  Residual r = residual(mcp.box(), x, F);  // finds an undefined row if one was marked
  if (std::isfinite(r.natural)) r = Residual{};
  return r;
}

lcp::RowTerms row_terms(const SpMat& J, In x, In F) {
  lcp::RowTerms terms{.size = Vec::Zero(x.size()), .entries = Eigen::VectorXi::Zero(x.size())};
  Vec rest = F;
  for (Index j = 0; j < J.cols(); ++j)
    for (SpMat::InnerIterator it(J, j); it; ++it) {
      if (it.value() == 0) continue;
      const double term = it.value() * x[j];
      terms.size[it.row()] += std::abs(term);
      rest[it.row()] -= term;
      ++terms.entries[it.row()];
    }
  terms.size += rest.cwiseAbs();
  return terms;
}

Vec row_residuals(const Box& box, In x, In F) {
  return Vec::NullaryExpr(x.size(), [&](Index i) { return lcp::row_residual(box, i, x[i], F[i]); });
}

bool at_its_bound(const Box& box, Index i, double x, double F) {
  return (x == box.lower[i] && F >= 0) || (x == box.upper[i] && F <= 0) || box.lower[i] == box.upper[i];
}

lcp::Accuracy accuracy(const Box& box, In x, In F, const SpMat& J) {
  return lcp::accuracy(row_residuals(box, x, F), row_terms(J, x, F));
}

lcp::Accuracy accuracy(const Mcp& mcp, In x) {
  if (const auto affine = affine_part(mcp)) return lcp::judge(*affine, x).accuracy;
  Vec F = Vec::Zero(mcp.size());
  SpMat J = mcp.jacobian_pattern();
  if (!x.allFinite() || !mcp.eval(x, F) || !F.allFinite() || !mcp.jacobian(x, J)) return {};
  return accuracy(mcp.box(), x, F, J);
}

}  // namespace perp::ncp
