// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "contact/model/checks.hpp"
#include "contact/model/velocities.hpp"
#include "lcp/solve/schur.hpp"
#include "lcp/words.hpp"

namespace perp::contact {
namespace {

/// Of M, for velocities of its bodies to be refined to twice the precision.
constexpr double least_rcond = 1e-11;
}  // namespace

SpMat saddle_point(const SpMat& M, const SpMat& G) {
  const Index m = M.rows();
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(M.nonZeros() + 2 * G.nonZeros()));
  for (Index j = 0; j < m; ++j)
    for (SpMat::InnerIterator it(M, j); it; ++it)
      entries.emplace_back(static_cast<int>(it.row()), static_cast<int>(j), it.value());
  for (Index j = 0; j < G.cols(); ++j)
    for (SpMat::InnerIterator it(G, j); it; ++it) {
      entries.emplace_back(static_cast<int>(it.row()), static_cast<int>(m + j), it.value());
      entries.emplace_back(static_cast<int>(m + j), static_cast<int>(it.row()), it.value());
    }
  SpMat K(m + G.cols(), m + G.cols());
  K.setFromTriplets(entries.begin(), entries.end());
  return K;
}

namespace {

/// Why K is not regular, or solutions do not converge: M by itself, or else G.
[[noreturn]] void refuse_singular(const Global& g, const lcp::RefinedLu& K) {
  const bool alone = g.G.cols() == 0;
  std::optional<lcp::RefinedLu> M;
  if (!alone) M.emplace(g.M);
  const bool dependent = M && M->regular();
  const lcp::RefinedLu& of = alone || dependent ? K : *M;
  const std::string measured =
      of.status() == lcp::LuStatus::Ok ? text_of(", reciprocal condition number ", of.rcond()) : std::string();
  refuse_input(
      "condensation: ", dependent ? "the constraints G' v + b = 0 are linearly dependent" : "the inertia M is singular",
      " (", lcp::to_string(of.status()), measured, ")");
}

/// The rows of A that have a place, and of a square A the columns.
SpMat at_places(const SpMat& A, const std::vector<int>& place, Index count, bool square) {
  SpMat out(count, square ? count : A.cols());
  out.reserve(A.nonZeros());
  for (Index j = 0; j < A.cols(); ++j) {
    const Index to = square ? place[at(j)] : j;
    if (to < 0) continue;
    out.startVec(to);
    for (SpMat::InnerIterator it(A, j); it; ++it)
      if (place[at(it.row())] >= 0) out.insertBack(place[at(it.row())], to) = it.value();
  }
  out.finalize();
  return out;
}

/// W and q by the parts of the bodies that contacts touch; false where M has no factors to rely on.
bool take_parts(const Global& g, Problem& p) {
  if (g.G.cols() != 0) return false;
  auto inertia = Inertia::of(g.M);
  if (!inertia || !(inertia->rcond() >= rounding_of_zero)) return false;
  SpMat H = g.H;
  Vec f = g.f;
  const std::vector<int> place = touched_velocities(*inertia, g.H);
  if (const auto count = static_cast<Index>(std::ranges::count_if(place, [](int k) { return k >= 0; }));
      0 < count && count < f.size()) {
    inertia = Inertia::of(at_places(g.M, place, count, true));
    if (!inertia) return false;
    H = at_places(g.H, place, count, false);
    f.resize(count);
    for (std::size_t i = 0; i < place.size(); ++i)
      if (place[i] >= 0) f[place[i]] = g.f[static_cast<Index>(i)];
  }
  if (!(inertia->rcond() >= least_rcond)) return false;
  const auto parts = std::make_shared<const DelassusParts>(std::move(inertia), std::move(H));
  p.W = Delassus(parts);
  p.q = exact_velocities(*parts, f, g.w);
  p.rounding = rounding_by_parts(*parts, f, p.q);
  return true;
}

/// With K = [M G; G' 0] and B = [H; 0]:  W = B' K^-1 B,  q = B' K^-1 [f; -b] + w. By the parts, or by entries where M
/// is none of an inertia, or K so ill-conditioned that solutions cannot be relied on.
void take_saddle_point(const Global& g, Problem& p) {
  const Index m = g.M.rows();
  const Index k = g.G.cols();
  SpMat B = g.H;
  B.conservativeResize(m + k, B.cols());
  Vec f(m + k);
  f << g.f, -g.b;
  SpMat K = saddle_point(g.M, g.G);
  const auto factors = std::make_shared<const lcp::RefinedLu>(K);
  if (!factors->regular()) refuse_singular(g, *factors);
  const std::optional<lcp::TwoPartVector> x = factors->refined(lcp::TwoPartVector(f));
  if (!x) refuse_singular(g, *factors);
  const auto exact = std::make_shared<const lcp::SchurProduct>(factors, B);
  p.q = exact->offset(f, g.w);
  p.rounding = rounding_by_lu(*factors, B, x->value, g.w, Vec::Zero(g.w.size()));
  if (factors->rcond() >= least_rcond)
    if (auto inertia = Inertia::of(g.M, K, factors)) {
      p.W = Delassus(std::make_shared<const DelassusParts>(std::move(inertia), std::move(B)));
      return;
    }
  std::optional<SpMat> W = exact->matrix(rounding_of_zero);
  if (!W) refuse_singular(g, *factors);
  W->makeCompressed();
  p.W = Delassus(std::move(*W), exact);
}

}  // namespace

Problem condense(Global global, Vec mu, int dimension, std::string name, Vec mu_r) {
  check_rolling(dimension, mu, mu_r);
  check(global, dimension * mu.size());
  Problem p{.dimension = dimension, .name = std::move(name)};
  if (!take_parts(global, p)) take_saddle_point(global, p);
  p.mu = std::move(mu);
  p.mu_r = std::move(mu_r);
  p.global = std::make_shared<const Global>(std::move(global));
  check(p);
  return p;
}

}  // namespace perp::contact
