// SPDX-License-Identifier: Apache-2.0
#include "ncp/problem/residual.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "ncp/problem/affine.hpp"

namespace perp::ncp {

Residual residual(const Box& box, In x, In F) {
  if (x.size() != box.size() || F.size() != box.size())
    throw std::invalid_argument("residual: x has " + std::to_string(x.size()) + " entries, F " +
                                std::to_string(F.size()) + ", the box " + std::to_string(box.size()));
  Residual r;
  r.natural = 0;
  for (Index i = 0; i < x.size(); ++i) {
    if (!std::isfinite(F[i]) || !std::isfinite(x[i])) {
      r.natural = infinity;
      r.worst = i;
      return r;
    }
    const double natural = lcp::row_residual(box, i, x[i], F[i]);
    if (natural > r.natural || r.worst < 0) {
      r.natural = natural;
      r.worst = i;
    }
    r.bounds = std::max(r.bounds, std::abs(x[i] - lcp::project(box, i, x[i])));
    r.complementarity = std::max({r.complementarity, std::min(std::max(x[i] - box.lower[i], 0.0), std::max(F[i], 0.0)),
                                  std::min(std::max(box.upper[i] - x[i], 0.0), std::max(-F[i], 0.0))});
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
