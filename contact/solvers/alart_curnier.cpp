// SPDX-License-Identifier: Apache-2.0
#include "contact/solvers/alart_curnier.hpp"

#include <algorithm>
#include <utility>

namespace perp::contact {
AlartCurnierRows alart_curnier_rows(int size, const Eigen::Vector3d& r, const Eigen::Vector3d& u, double rho_N,
                                    double rho_T) {
  AlartCurnierRows out;
  const bool closed = r[0] - rho_N * u[0] > 0;
  if (closed) {
    out.B(0, 0) = 1;
    out.c[0] = -u[0];
  } else {
    out.A(0, 0) = 1 / rho_N;
    out.c[0] = -r[0] / rho_N;
  }
  const int tangents = size - 1;
  if (tangents == 0) return out;
  const double radius = closed ? std::max(0.0, r[0]) : 0;
  const Eigen::Vector2d y(r[1] - rho_T * u[1], tangents == 2 ? r[2] - rho_T * u[2] : 0);
  const double length = y.norm();
  if (closed && length <= radius) {  // sticks
    for (int i = 1; i <= tangents; ++i) {
      out.B(i, i) = 1;
      out.c[i] = -u[i];
    }
    return out;
  }
  const double beta = length > 0 ? radius / length : 0;
  const Eigen::Vector2d d = length > 0 ? Eigen::Vector2d(y / length) : Eigen::Vector2d::Zero();
  for (int i = 0; i < tangents; ++i) {
    for (int j = 0; j < tangents; ++j) {
      const double across = (i == j ? 1 : 0) - (length > 0 ? d[i] * d[j] : 0);
      out.A(i + 1, j + 1) = ((i == j ? 1 : 0) - beta * across) / rho_T;
      out.B(i + 1, j + 1) = beta * across;
    }
    if (radius > 0) out.A(i + 1, 0) = -d[i] / rho_T;
    out.c[i + 1] = -(r[i + 1] - radius * d[i]) / rho_T;
  }
  return out;
}

AlartCurnier::AlartCurnier(const Scaled& problem, std::shared_ptr<lcp::SparseLu> lu)
    : problem_(problem),
      rho_N_(static_cast<Index>(problem.blocks.size())),
      rho_T_(static_cast<Index>(problem.blocks.size())),
      K_(problem.W),
      lu_(std::move(lu)) {
  const Vec diagonal = problem.W.diagonal();
  const auto inverse = [](double w) { return w > 1e-12 ? 1 / w : 1; };
  for (std::size_t a = 0; a < problem.blocks.size(); ++a) {
    const Scaled::Block& block = problem.blocks[a];
    const auto i = static_cast<Index>(a);
    rho_N_[i] = inverse(diagonal[block.first]);
    rho_T_[i] = block.size > 1 ? inverse(diagonal.segment(block.first + 1, block.size - 1).mean()) : 1;
  }
}

bool AlartCurnier::step(In r, In centre, double alpha, Vec& to) {
  const Vec u = problem_.W * r + problem_.q + alpha * (r - centre);
  std::vector<AlartCurnierRows> local(problem_.blocks.size());
  Vec rhs(r.size());
  std::vector<int> owner(at(r.size()));
  for (std::size_t a = 0; a < local.size(); ++a) {
    const Scaled::Block& block = problem_.blocks[a];
    const auto index = static_cast<Index>(a);
    local[a] = alart_curnier_rows(block.size, block.of(r), block.of(u), rho_N_[index], rho_T_[index]);
    rhs.segment(block.first, block.size) = local[a].c.head(block.size);
    for (int i = 0; i < block.size; ++i) owner[at(block.first + i)] = static_cast<int>(a);
  }
  // K = A + B (W + alpha I). W has whole blocks only on the diagonal: elsewhere the rows of a contact may be in a
  // column in part, which couples through B's off-diagonal entries.
  for (Index j = 0; j < K_.cols(); ++j) {
    SpMat::InnerIterator w(problem_.W, j);
    SpMat::InnerIterator k(K_, j);
    while (w) {
      const int a = owner[at(w.row())];
      const Scaled::Block& block = problem_.blocks[at(a)];
      Eigen::Vector3d column = Eigen::Vector3d::Zero();
      for (; w && owner[at(w.row())] == a; ++w) column[w.row() - block.first] = w.value();
      const bool own = owner[at(j)] == a;
      if (own) column[j - block.first] += alpha;
      Eigen::Vector3d value = local[at(a)].B * column;
      if (own) value += local[at(a)].A.col(j - block.first);
      for (; k && owner[at(k.row())] == a; ++k) k.valueRef() = value[k.row() - block.first];
    }
  }
  ++factorizations_;
  if (!lu_->try_factor(K_)) return false;
  Vec d(r.size());
  lu_->solve(rhs, d);
  if (!d.allFinite()) return false;
  to = r + d;
  return true;
}

}  // namespace perp::contact
