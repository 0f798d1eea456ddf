// SPDX-License-Identifier: Apache-2.0
#include "contact/existence/frictionless_ray.hpp"

#include <utility>

#include "lcp/solve/solve.hpp"

namespace perp::contact {
namespace {

/// Impulses in units of their contacts beyond which the problem does not count as solved.
constexpr double largest_impulse = 1e8;

/// Columns `of` A, each times its unit.
SpMat columns_of(const SpMat& A, const std::vector<Index>& of, const Vec& unit) {
  SpMat out(A.rows(), static_cast<Index>(of.size()));
  for (Index k = 0; k < out.cols(); ++k) {
    out.startVec(k);
    for (SpMat::InnerIterator it(A, of[at(k)]); it; ++it) out.insertBack(it.row(), k) = it.value() * unit[k];
  }
  out.finalize();
  return out;
}

/// The part's W_NN in its units.
SpMat normal_block(const Problem& problem, const std::vector<Index>& normals, const Vec& unit) {
  const DelassusParts* parts = problem.W.whole_parts();
  if (parts != nullptr && parts->root() != nullptr) {
    const SpMat Z = columns_of(*parts->root(), normals, unit);
    return SpMat(Z.transpose()) * Z;
  }
  if (parts != nullptr) {
    const SpMat H = columns_of(parts->H(), normals, unit);
    Eigen::MatrixXd W(H.cols(), H.cols());
    for (Index k = 0; k < H.cols(); ++k) W.col(k) = H.transpose() * parts->inverse(Vec(H.col(k)));
    return Eigen::MatrixXd(0.5 * (W + W.transpose())).sparseView();
  }
  std::vector<Index> place(at(problem.q.size()), -1);
  for (std::size_t k = 0; k < normals.size(); ++k) place[at(normals[k])] = static_cast<Index>(k);
  const SpMat columns = columns_of(problem.W.matrix(), normals, unit);
  std::vector<Eigen::Triplet<double>> entries;
  for (Index k = 0; k < columns.cols(); ++k)
    for (SpMat::InnerIterator it(columns, k); it; ++it)
      if (const Index row = place[at(it.row())]; row >= 0)
        entries.emplace_back(static_cast<int>(row), static_cast<int>(k), unit[row] * it.value());
  SpMat W(columns.cols(), columns.cols());
  W.setFromTriplets(entries.begin(), entries.end());
  return W;
}

/// (v, r_N): [M -H_N; H_N' 0], v of the bodies that the part's contacts touch, in units in which M has a unit diagonal.
/// Of constrained ones (v, lambda) for v: [M -G; G' 0].
lcp::AffineMcp bodies_problem(const DelassusParts& parts, const std::vector<Index>& normals, const Vec& unit,
                              const Vec& q) {
  const SpMat H = columns_of(parts.H(), normals, unit);
  const std::vector<int>& body_of = parts.inertia().body_of();
  std::vector<char> touched(at(parts.inertia().bodies()), 0);
  for (Index k = 0; k < H.cols(); ++k)
    for (SpMat::InnerIterator it(H, k); it; ++it) touched[at(body_of[at(it.row())])] = 1;
  std::vector<int> place(at(H.rows()), -1);
  int m = 0;
  for (std::size_t i = 0; i < place.size(); ++i)
    if (touched[at(body_of[i])] != 0) place[i] = m++;
  const Index velocities = parts.inertia().velocities();
  const Vec units =
      parts.inertia().by_lu() ? parts.inertia().lu().scale() : Vec(parts.M().diagonal().cwiseSqrt().cwiseInverse());
  std::vector<Eigen::Triplet<double>> entries;
  for (Index j = 0; j < H.rows(); ++j)
    for (SpMat::InnerIterator it(parts.M(), j); it; ++it)
      if (place[at(j)] >= 0)
        entries.emplace_back(place[at(it.row())], place[at(j)],
                             (j < velocities ? 1 : -1) * units[it.row()] * it.value() * units[j]);
  for (Index k = 0; k < H.cols(); ++k)
    for (SpMat::InnerIterator it(H, k); it; ++it) {
      const int row = place[at(it.row())];
      const int contact = m + static_cast<int>(k);
      entries.emplace_back(row, contact, -units[it.row()] * it.value());
      entries.emplace_back(contact, row, units[it.row()] * it.value());
    }
  const Index size = m + H.cols();
  lcp::AffineMcp out{.M = SpMat(size, size), .q = Vec::Zero(size), .box = {}};
  out.M.setFromTriplets(entries.begin(), entries.end());
  out.q.tail(H.cols()) = q;
  out.box = {.lower = Vec::Constant(size, -lcp::infinity), .upper = Vec::Constant(size, lcp::infinity)};
  out.box.lower.tail(H.cols()).setZero();
  return out;
}

}  // namespace

FrictionlessAnswer frictionless_answer(const Problem& problem, const std::vector<Index>& part, const Vec& unit,
                                       const lcp::Limits& limits) {
  std::vector<Index> normals;
  for (const Index a : part) normals.push_back(problem.dimension * a);
  Vec q = Vec(problem.q(normals)).cwiseProduct(unit);
  q /= q.lpNorm<Eigen::Infinity>();
  const Index n = q.size();
  const bool few = n < pivoting_to;
  const DelassusParts* parts = problem.W.whole_parts();
  const bool by_bodies = parts != nullptr && !few;
  const lcp::AffineMcp frictionless =
      by_bodies ? bodies_problem(*parts, normals, unit, q) : lcp::standard_lcp(normal_block(problem, normals, unit), q);
  const lcp::Method method = few         ? lcp::Method(lcp::PrincipalPivoting{})
                             : by_bodies ? lcp::Method(lcp::InteriorPoint{})
                                         : lcp::Method(lcp::BoundQp{});
  const lcp::Result result = lcp::solve(frictionless, Vec::Zero(frictionless.size()), method, limits);
  FrictionlessAnswer answer;
  answer.solved = result.solved() && result.z.tail(n).lpNorm<Eigen::Infinity>() <= largest_impulse;
  if (result.certificate.size() == frictionless.size())
    answer.y = result.certificate.tail(n).cwiseMax(0).cwiseProduct(unit);
  return answer;
}

}  // namespace perp::contact
