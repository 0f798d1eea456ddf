// SPDX-License-Identifier: Apache-2.0
#include "contact/existence/frictionless_ray.hpp"

#include <algorithm>
#include <utility>

#include "lcp/solve/solve.hpp"

namespace perp::contact {
namespace {

/// Impulses in units of their contacts beyond which the problem does not count as solved.
constexpr double largest_impulse = 1e8;

/// (v, r_N): [M -H_N; H_N' 0], v of the bodies that the part's contacts touch, in units in which M has a unit diagonal.
/// Of constrained ones (v, lambda) for v: [M -G; G' 0].
lcp::AffineMcp bodies_problem(const DelassusParts& parts, const std::vector<Index>& normals, const Vec& unit,
                              const Vec& q) {
  const SpMat H = columns_of(parts.H(), normals, unit);
  const std::vector<int> place = touched_velocities(parts.inertia(), H);
  const int m = *std::ranges::max_element(place) + 1;
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
      by_bodies ? bodies_problem(*parts, normals, unit, q)
                : lcp::standard_lcp(unit.asDiagonal() * problem.W.part(normals).matrix() * unit.asDiagonal(), q);
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
