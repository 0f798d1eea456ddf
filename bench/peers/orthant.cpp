// SPDX-License-Identifier: Apache-2.0
#include "orthant.hpp"

#include <cmath>

namespace perp::bench {

using ncp::Index;
using ncp::Vec;

Orthant::Orthant(const ncp::Mcp& mcp)
    : mcp_(mcp), place_(static_cast<std::size_t>(mcp.size()), -1), J_(mcp.jacobian_pattern()) {
  const ncp::Box& box = mcp.box();
  const auto add = [&](Index i, double sign, double origin) {
    place_[static_cast<std::size_t>(i)] = static_cast<Index>(unknowns_.size());
    unknowns_.push_back({.i = i, .sign = sign, .origin = origin});
  };
  for (Index i = 0; i < mcp.size(); ++i)
    if (!std::isfinite(box.lower[i]) && !std::isfinite(box.upper[i])) add(i, 1, 0);
  equations_ = static_cast<Index>(unknowns_.size());
  for (Index i = 0; i < mcp.size(); ++i) {
    if (box.lower[i] == box.upper[i]) continue;
    if (std::isfinite(box.lower[i]))
      add(i, 1, box.lower[i]);
    else if (std::isfinite(box.upper[i]))
      add(i, -1, box.upper[i]);
  }
  size_ = static_cast<Index>(unknowns_.size());
  for (Unknown& unknown : unknowns_)
    if (std::isfinite(box.lower[unknown.i]) && std::isfinite(box.upper[unknown.i])) unknown.multiplier = size_++;
}

Vec Orthant::from(ncp::In x) const {
  Vec z = Vec::Zero(size_);
  for (Index k = 0; const Unknown& unknown : unknowns_) {
    z[k] = unknown.sign * (x[unknown.i] - unknown.origin);
    if (k >= equations_) z[k] = std::max(z[k], 0.0);
    ++k;
  }
  return z;
}

Vec Orthant::point(ncp::In z) const {
  Vec x = mcp_.box().lower;  // of those that are fixed
  for (Index k = 0; const Unknown& unknown : unknowns_) x[unknown.i] = unknown.origin + unknown.sign * z[k++];
  return x;
}

bool Orthant::eval(ncp::In z, ncp::Out G) const {
  Vec F(mcp_.size());
  const Vec x = point(z);
  if (!x.allFinite() || !mcp_.eval(x, F)) return false;
  for (Index k = 0; const Unknown& unknown : unknowns_) {
    G[k] = unknown.sign * F[unknown.i];
    if (unknown.multiplier >= 0) {
      G[k] += z[unknown.multiplier];
      G[unknown.multiplier] = mcp_.box().upper[unknown.i] - x[unknown.i];
    }
    ++k;
  }
  return G.allFinite();
}

bool Orthant::jacobian(ncp::In z, Eigen::Ref<Eigen::MatrixXd> J) {
  const Vec x = point(z);
  if (!x.allFinite() || !mcp_.jacobian(x, J_)) return false;
  J.setZero();
  for (Index j = 0; j < J_.outerSize(); ++j) {
    const Index column = place_[static_cast<std::size_t>(j)];
    if (column < 0) continue;
    for (ncp::SpMat::InnerIterator entry(J_, j); entry; ++entry) {
      const Index row = place_[static_cast<std::size_t>(entry.row())];
      if (row < 0) continue;
      J(row, column) = unknowns_[static_cast<std::size_t>(row)].sign * entry.value() *
                       unknowns_[static_cast<std::size_t>(column)].sign;
    }
  }
  for (Index k = 0; const Unknown& unknown : unknowns_) {
    if (unknown.multiplier >= 0) {
      J(k, unknown.multiplier) = 1;
      J(unknown.multiplier, k) = -1;
    }
    ++k;
  }
  return J.allFinite();
}

}  // namespace perp::bench
