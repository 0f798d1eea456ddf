// SPDX-License-Identifier: Apache-2.0
#include "contact/condensation/free_motions.hpp"

#include <Eigen/QR>
#include <utility>
#include <vector>

#include "contact/model/joined.hpp"
#include "lcp/cholesky/symmetric.hpp"

namespace perp::contact {
namespace {

/// Of the largest pivot: less is a dependent constraint.
constexpr double independent = 1e-12;
/// What a constraint may be violated by, of what cancels in it: masses are too far apart for Z beyond.
constexpr double held = 1e-11;

/// Velocities that constraints join, and those constraints.
struct Joint {
  std::vector<int> rows{};
  std::vector<int> columns{};
};

/// All velocities, those that are free one by one.
std::vector<Joint> joints(const SpMat& G) {
  Joined velocities(G.rows());
  for (Index j = 0; j < G.cols(); ++j)
    for (SpMat::InnerIterator it(G, j), first(G, j); it; ++it) velocities.join(first.row(), it.row());
  const std::vector<int> number = velocities.numbers();
  std::vector<Joint> out;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (at(number[i]) >= out.size()) out.emplace_back();
    out[at(number[i])].rows.push_back(static_cast<int>(i));
  }
  for (Index j = 0; j < G.cols(); ++j)
    if (const SpMat::InnerIterator first(G, j); first)
      out[at(number[at(first.row())])].columns.push_back(static_cast<int>(j));
  return out;
}

/// Builds Z and v_b joint by joint.
class Elimination {
 public:
  explicit Elimination(const Global& g)
      : g_(g),
        unit_(Vec(g.M.diagonal()).cwiseSqrt().cwiseInverse()),
        v_b_(Vec::Zero(g.M.rows())),
        place_(at(g.M.rows())) {}

  bool run() {
    if (!unit_.allFinite()) return false;
    for (const Joint& joint : joints(g_.G))
      if (!add(joint)) return false;
    return motions_ > 0;
  }
  const Vec& v_b() const { return v_b_; }
  SpMat Z() const {
    SpMat Z(g_.M.rows(), motions_);
    Z.setFromTriplets(entries_.begin(), entries_.end());
    return Z;
  }

 private:
  bool add(const Joint& joint) {
    const auto m = static_cast<Index>(joint.rows.size());
    const auto k = static_cast<Index>(joint.columns.size());
    if (k == 0) {
      for (const int row : joint.rows) entries_.emplace_back(row, motions_++, unit_[row]);
      return true;
    }
    if (m > most_joined || k > m) return false;
    for (Index i = 0; i < m; ++i) place_[at(joint.rows[at(i)])] = i;
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(m, k);
    Vec b(k);
    for (Index j = 0; j < k; ++j) {
      for (SpMat::InnerIterator it(g_.G, joint.columns[at(j)]); it; ++it)
        G(place_[at(it.row())], j) = it.value() * unit_[it.row()];
      const double size = G.col(j).stableNorm();
      if (!(size > 0)) return false;
      G.col(j) /= size;
      b[j] = g_.b[joint.columns[at(j)]] / size;
    }
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(G);
    qr.setThreshold(independent);
    if (qr.rank() < k) return false;
    const Eigen::MatrixXd Q = qr.householderQ();
    // G P = Q R:  v_b = -Q R'^-1 P' b.
    const Vec pivoted = qr.colsPermutation().transpose() * b;
    const auto R = qr.matrixR().topLeftCorner(k, k).triangularView<Eigen::Upper>();
    const Vec v = -Q.leftCols(k) * R.transpose().solve(pivoted);
    if (!hold(G, v, b) || !hold(G, Q.rightCols(m - k), Eigen::MatrixXd::Zero(k, m - k))) return false;
    for (Index i = 0; i < m; ++i) v_b_[joint.rows[at(i)]] = unit_[joint.rows[at(i)]] * v[i];
    for (Index j = k; j < m; ++j, ++motions_)
      for (Index i = 0; i < m; ++i)
        if (Q(i, j) != 0) entries_.emplace_back(joint.rows[at(i)], motions_, unit_[joint.rows[at(i)]] * Q(i, j));
    return true;
  }

  /// G' V + B = 0, each entry beside the terms that cancel in it.
  static bool hold(const Eigen::MatrixXd& G, const Eigen::MatrixXd& V, const Eigen::MatrixXd& B) {
    const Eigen::ArrayXXd terms = (G.cwiseAbs().transpose() * V.cwiseAbs() + B.cwiseAbs()).array();
    return ((G.transpose() * V + B).array().abs() <= held * terms).all();
  }

  const Global& g_;
  Vec unit_;  // of the velocities: 1 / sqrt(M_ii), so that light bodies do not drown in heavy ones
  Vec v_b_;
  std::vector<Index> place_;
  std::vector<Eigen::Triplet<double>> entries_;
  int motions_ = 0;
};

}  // namespace

std::optional<Global> free_motions(const Global& global) {
  Elimination elimination(global);
  if (!lcp::symmetric(global.M, 0) || !elimination.run()) return std::nullopt;
  const SpMat Z = elimination.Z();
  const SpMat Zt = Z.transpose();
  const SpMat M = Zt * SpMat(global.M * Z);
  Global out;
  out.M = 0.5 * (M + SpMat(M.transpose()));
  out.H = Zt * global.H;
  out.G = SpMat(Z.cols(), 0);
  out.f = Zt * (global.f - global.M * elimination.v_b());
  out.w = global.w + global.H.transpose() * elimination.v_b();
  return out;
}

}  // namespace perp::contact
