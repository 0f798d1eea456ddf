// SPDX-License-Identifier: Apache-2.0
#include "contact/classics/newton_matrix.hpp"

namespace perp::contact {
namespace {

/// A direction by bodies with a larger residual, relative to its right side, is none: (A + alpha B)^-1 has taken its
/// digits.
constexpr double direction_tol = 1e-6;

}  // namespace

NewtonMatrix::NewtonMatrix(const Scaled& problem, lcp::Deadline deadline)
    : problem_(problem), lu_(lcp::LuBackend::General, deadline) {
  if (problem.W.whole_parts() != nullptr)
    bodies_ = std::make_unique<ContactSystem>(problem, lcp::LuBackend::General, deadline);
  else
    K_ = problem.W.matrix();
}

bool NewtonMatrix::factor(const std::vector<ContactRows>& rows, double alpha) {
  if (!bodies_) {
    contact_matrix(problem_, rows, alpha, K_);
    return lu_.try_factor(K_);
  }
  rows_ = rows;
  for (ContactRows& of : rows_) of.A += alpha * of.B;
  return bodies_->factor(rows_);
}

bool NewtonMatrix::solve(In c, Vec& d) {
  d.resize(c.size());
  if (!bodies_) {
    lu_.solve(c, d);
    return d.allFinite();
  }
  bodies_->solve(c, d);
  return (c - product(d)).norm() <= direction_tol * c.norm();
}

/// (A + B (W + alpha I)) d.
Vec NewtonMatrix::product(const Vec& d) const {
  const Vec Wd = problem_.W * d;
  Vec out(d.size());
  for (std::size_t a = 0; a < rows_.size(); ++a) {
    const Scaled::Block& block = problem_.blocks[a];
    out.segment(block.first, block.size) = (rows_[a].A * block.of(d) + rows_[a].B * block.of(Wd)).head(block.size);
  }
  return out;
}

}  // namespace perp::contact
