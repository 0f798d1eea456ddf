// SPDX-License-Identifier: Apache-2.0
#include "lcp/linalg/krylov.hpp"

#include <Eigen/IterativeLinearSolvers>
#include <algorithm>
#include <cmath>
#include <new>
#include <utility>
#include <vector>

#include "lcp/cholesky/symmetric.hpp"
#include "lcp/linalg/multilevel.hpp"

namespace perp::lcp {
namespace {

/// The unknowns that are left when the known ones have gone.
struct Block {
  std::vector<int> number;    ///< of an unknown among those left; -1: known
  std::vector<int> unknowns;  ///< those left
};

/// max_j |J_ij|: what a row says off its diagonal counts too (the multipliers' rows of a saddle point have only that).
Vec row_sizes(const SpMat& J) {
  Vec size = Vec::Zero(J.rows());
  for (Index j = 0; j < J.cols(); ++j)
    for (SpMat::InnerIterator it(J, j); it; ++it) size[it.row()] = std::max(size[it.row()], std::abs(it.value()));
  return size;
}

/// False if a row says nothing.
bool reduce(const SpMat& J, In Da, In Db, Block& block) {
  constexpr double negligible = 1e-16;
  const Vec size = row_sizes(J);
  const Index n = J.rows();
  block.number.assign(at(n), -1);
  for (Index i = 0; i < n; ++i) {
    if (Da[i] == 0 && Db[i] == 0) return false;
    if (std::abs(Db[i]) * std::max(size[i], 1e-300) <= negligible * std::abs(Da[i])) continue;
    block.number[at(i)] = static_cast<int>(block.unknowns.size());
    block.unknowns.push_back(static_cast<int>(i));
  }
  return true;
}

/// D + J of the rows left, for symmetric J; empty if its diagonal is not positive or too few of its entries are
/// negative for multigrid.
SparseRows symmetric_block(const SpMat& J, In Da, In Db, const Block& block) {
  constexpr double positive_share = 0.33;  // BoundQp::positive_share
  SparseRows S;
  S.start.reserve(block.unknowns.size() + 1);
  S.column.reserve(at(J.nonZeros()));
  S.value.reserve(at(J.nonZeros()));
  double positive = 0;
  double all = 0;
  for (const int i : block.unknowns) {  // column i of J is its row
    double diagonal = Da[i] / Db[i];
    const std::size_t place = S.column.size();
    bool has_diagonal = false;
    std::size_t own = place;
    for (SpMat::InnerIterator it(J, i); it; ++it) {
      const int j = block.number[at(it.row())];
      if (j < 0) continue;
      if (it.row() == i) {
        diagonal += it.value();
        own = S.column.size();
        has_diagonal = true;
      } else {
        all += std::abs(it.value());
        positive += std::max(0.0, it.value());
      }
      S.push(j, it.value());
    }
    if (!has_diagonal || !(diagonal > 0)) return {};
    S.value[own] = diagonal;
    S.end_row();
  }
  return positive <= positive_share * all ? S : SparseRows{};
}

/// Conjugate gradients on S d = b / Db preconditioned by B, until ||Db (b / Db - S d)|| <= tol. False where S or B
/// shows not to be positive definite, after max_iterations, or at a limit.
bool conjugate_gradients(const SparseRows& S, FacePreconditioner& B, const Vec& Db, const Vec& b, double tol,
                         int max_iterations, const Limits& limits, Vec& d, int& iterations) {
  const Index n = b.size();
  Vec r = b.cwiseQuotient(Db);
  Vec z(n);
  Vec p = Vec::Zero(n);
  Vec Sp(n);
  d = Vec::Zero(n);
  double rz_before = 1;
  for (int k = 0;; ++k) {
    if (r.cwiseProduct(Db).norm() <= tol) return true;
    if (k == max_iterations || limits.reached()) return false;
    B.apply(r, z);
    const double rz = r.dot(z);
    if (!(rz > 0)) return false;
    p = z + (k == 0 ? 0 : rz / rz_before) * p;
    rz_before = rz;
    S.multiply(p, Sp);
    const double curvature = p.dot(Sp);
    if (!(curvature > 0)) return false;
    ++iterations;
    d += rz / curvature * p;
    r -= rz / curvature * Sp;
  }
}

using Ilut = Eigen::IncompleteLUT<double, int>;

/// BiCGSTAB on H d = b preconditioned from the right by B, until ||b - H d|| <= tol by its recurrence, or after
/// max_iterations, at a limit, or where starting again from d does not cure a breakdown. (Eigen's cannot be
/// interrupted, and a run of it in slices would lose its search space at each.)
void bicgstab(const SpMat& H, const Ilut& B, const Vec& b, double tol, int max_iterations, const Limits& limits, Vec& d,
              int& iterations) {
  constexpr double orthogonal = 1e-16;  // cosine of an angle that is rounding
  d = Vec::Zero(b.size());
  Vec r = b;
  Vec shadow = r;
  Vec p;
  Vec v;
  double rho = 1;
  double alpha = 1;
  double omega = 1;
  bool begun = true;  // by the last iteration
  for (int k = 0; k < max_iterations && r.norm() > tol && !limits.reached(); ++k, ++iterations) {
    double next = shadow.dot(r);
    if (omega == 0 || !(std::abs(next) > orthogonal * shadow.norm() * r.norm())) {
      if (begun) return;
      begun = true;
      r = b - H * d;
      shadow = r;
      next = r.squaredNorm();
    } else {
      begun = k == 0;
    }
    p = begun ? r : Vec(r + next / rho * (alpha / omega) * (p - omega * v));
    rho = next;
    const Vec y = B.solve(p);
    v = H * y;
    alpha = rho / shadow.dot(v);
    if (!std::isfinite(alpha)) return;
    r -= alpha * v;
    const Vec z = B.solve(r);
    const Vec t = H * z;
    const double tt = t.squaredNorm();
    omega = tt > 0 ? t.dot(r) / tt : 0;
    d += alpha * y + omega * z;
    r -= omega * t;
  }
}

/// The block of H itself, for the incomplete LU factorization: its rows are of one size.
SpMat block_of(const SpMat& J, In Da, In Db, const Block& block) {
  const auto n = static_cast<Index>(block.unknowns.size());
  SpMat H(n, n);
  H.reserve(J.nonZeros() + n);
  for (Index k = 0; k < n; ++k) {
    const int column = block.unknowns[at(k)];
    H.startVec(k);
    bool diagonal = false;
    const auto own = [&] {
      if (!diagonal) H.insertBack(k, k) = Da[column];
      diagonal = true;
    };
    for (SpMat::InnerIterator it(J, column); it; ++it) {
      const int row = block.number[at(it.row())];
      if (row < 0) continue;
      if (row >= k) own();
      if (row == k)
        H.valuePtr()[H.data().size() - 1] += Db[column] * it.value();
      else
        H.insertBack(row, k) = Db[it.row()] * it.value();
    }
    own();
  }
  H.finalize();
  return H;
}

/// ILUT(drop, fill) does not pivot, so it is made of H with diagonal entries of at least sqrt(drop) max_j |H_ij|: in
/// the multipliers' rows of a saddle point they are zero or next to it. (Eigen does as much for exact zeros.)
std::unique_ptr<Ilut> incomplete_lu(SpMat& H, double drop, int fill) {
  const Vec diagonal = H.diagonal();
  const Vec least = std::sqrt(drop) * row_sizes(H);
  const auto enlarged = [&](Index i) { return std::abs(diagonal[i]) < least[i]; };
  for (Index i = 0; i < H.rows(); ++i)
    if (enlarged(i)) H.coeffRef(i, i) = std::copysign(least[i], diagonal[i]);
  auto ilut = std::make_unique<Ilut>();
  ilut->setDroptol(drop);
  ilut->setFillfactor(fill);
  ilut->compute(H);
  for (Index i = 0; i < H.rows(); ++i)
    if (enlarged(i)) H.coeffRef(i, i) = diagonal[i];
  return ilut;
}

}  // namespace

struct KrylovSystem::Parts {
  const SpMat& J;
  Vec Da, Db;
  KrylovOptions options;
  Limits limits;
  Block block{};
  bool regular = false;
  Vec scale{};  // Db of the rows left
  bool multigrid_tried = false;
  std::unique_ptr<Hierarchy> hierarchy{};
  std::unique_ptr<VCycle> cycle{};
  SpMat H{};  // made with ilut
  std::unique_ptr<Ilut> ilut{};

  Parts(const SpMat& matrix, In a, In b, const KrylovOptions& given, Limits until)
      : J(matrix), Da(a), Db(b), options(given), limits(std::move(until)) {
    regular = reduce(J, Da, Db, block);
    scale = Vec(static_cast<Index>(block.unknowns.size()));
    for (std::size_t k = 0; k < block.unknowns.size(); ++k) scale[static_cast<Index>(k)] = Db[block.unknowns[k]];
  }

  bool has_multigrid() {
    if (std::exchange(multigrid_tried, true)) return cycle != nullptr;
    if (!symmetric(J)) return false;
    SparseRows S = symmetric_block(J, Da, Db, block);
    if (S.rows() == 0) return false;
    const auto direct = static_cast<int>(std::min<Index>(options.coarsest, S.rows()));
    hierarchy = std::make_unique<Hierarchy>(std::move(S), options.strength, direct);
    cycle = std::make_unique<VCycle>(*hierarchy, 0, direct);
    cycle->set_free(Mask(block.unknowns.size(), 1));
    return true;
  }

  /// d with the part of it that belongs to the rows left; ||H d - b|| <= eta ||b|| or not.
  bool take(KrylovResult& result, In b, const Vec& part, KrylovKind kind, double eta) const {
    for (std::size_t k = 0; k < block.unknowns.size(); ++k) result.d[block.unknowns[k]] = part[static_cast<Index>(k)];
    if (!result.d.allFinite()) return false;
    const double size = b.norm();
    result.reduction = size > 0 ? (b - Da.cwiseProduct(result.d) - Db.cwiseProduct(J * result.d)).norm() / size : 0;
    result.kind = kind;
    // A little more than eta: the recurrences' residual is the true one but for rounding.
    if (result.reduction <= 1.1 * eta) result.end = KrylovEnd::Solved;
    return result.solved();
  }

  bool stopped(KrylovResult& result) const {
    if (!limits.reached()) return false;
    result.end = KrylovEnd::Stopped;
    return true;
  }

  void solve(In b, double eta, KrylovResult& result) {
    if (!regular) return;
    // The known unknowns, and what they leave of the others' right-hand sides.
    Vec rest(scale.size());
    if (rest.size() == b.size()) {
      rest = b;
    } else {
      for (Index i = 0; i < b.size(); ++i)
        if (block.number[at(i)] < 0) result.d[i] = b[i] / Da[i];
      const Vec moved = J * result.d;
      for (std::size_t k = 0; k < block.unknowns.size(); ++k) {
        const int i = block.unknowns[k];
        rest[static_cast<Index>(k)] = b[i] - Db[i] * moved[i];
      }
    }
    const double tol = eta * b.norm();
    Vec part = Vec::Zero(rest.size());
    if (rest.norm() <= tol) {
      take(result, b, part, KrylovKind::None, eta);
      return;
    }
    if (stopped(result)) return;
    if (has_multigrid()) {
      conjugate_gradients(hierarchy->grids[0].A, *cycle, scale, rest, tol, options.max_iterations, limits, part,
                          result.iterations);
      if (take(result, b, part, KrylovKind::ConjugateGradients, eta) || stopped(result)) return;
    }
    if (!ilut) {
      H = block_of(J, Da, Db, block);
      ilut = incomplete_lu(H, options.drop, options.fill);
    }
    if (ilut->info() != Eigen::Success) return;
    bicgstab(H, *ilut, rest, tol, options.max_iterations, limits, part, result.iterations);
    if (!take(result, b, part, KrylovKind::BiCgStab, eta)) stopped(result);
  }
};

KrylovSystem::KrylovSystem(const SpMat& J, In Da, In Db, const KrylovOptions& options, const Limits& limits)
    : parts_(std::make_unique<Parts>(J, Da, Db, options, limits)) {}
KrylovSystem::~KrylovSystem() = default;
KrylovSystem::KrylovSystem(KrylovSystem&&) noexcept = default;
KrylovSystem& KrylovSystem::operator=(KrylovSystem&&) noexcept = default;

KrylovResult KrylovSystem::solve(In b, double eta) {
  KrylovResult result;
  result.d = Vec::Zero(b.size());
  parts_->solve(b, eta, result);
  return result;
}

Vec damped_least_squares(const SpMat& J, In Da, In Db, In b, double nu, double eta, int iterations,
                         const Limits& limits) {
  const Index n = b.size();
  // Unknowns y = S d, S_j^2 = ||H e_j||^2 + nu.
  Vec scale = Vec::Constant(n, nu);
  for (Index j = 0; j < n; ++j) {
    double own = Da[j];
    for (SpMat::InnerIterator it(J, j); it; ++it) {
      if (it.row() == j)
        own += Db[j] * it.value();
      else
        scale[j] += Db[it.row()] * Db[it.row()] * it.value() * it.value();
    }
    scale[j] += own * own;
  }
  scale = scale.cwiseSqrt().unaryExpr([](double s) { return s > 0 ? s : 1.0; });
  Vec d = Vec::Zero(n);
  Vec r = b;  // b - H d
  const auto gradient = [&]() -> Vec {
    return (Da.cwiseProduct(r) + J.transpose() * Db.cwiseProduct(r) - nu * d).cwiseQuotient(scale);
  };
  Vec s = gradient();
  Vec p = s;
  double ss = s.squaredNorm();
  const double goal = eta * eta * ss;
  for (int k = 0; k < iterations && ss > goal && std::isfinite(ss) && !limits.reached(); ++k) {
    const Vec step = p.cwiseQuotient(scale);
    const Vec q = Da.cwiseProduct(step) + Db.cwiseProduct(J * step);
    const double curvature = q.squaredNorm() + nu * step.squaredNorm();
    if (!(curvature > 0)) break;
    const double alpha = ss / curvature;
    d += alpha * step;
    r -= alpha * q;
    s = gradient();
    const double next = s.squaredNorm();
    p = s + next / ss * p;
    ss = next;
  }
  return d;
}

}  // namespace perp::lcp
