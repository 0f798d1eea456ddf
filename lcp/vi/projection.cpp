// SPDX-License-Identifier: Apache-2.0
#include "lcp/vi/projection.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lcp/dense_factors.hpp"
#include "lcp/exact_sum.hpp"
#include "lcp/solve/solve.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {
namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();
/// Bounds the loss of a step of a sum in two doubles, beside its terms.
constexpr double eps_twice = 8 * eps * eps;
/// Up to so many rows and variables a dense projection is tried.
constexpr Index dense_size = 3000;
/// Steps of refinement, each worth ten digits or so.
constexpr int refinements = 6;

Eigen::MatrixXd gram(const Eigen::SparseMatrix<double, Eigen::RowMajor>& rows, const std::vector<Index>& W,
                     const std::vector<char>& held, Vec& scale) {
  const auto k = static_cast<Index>(W.size());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(rows.cols(), k);
  scale.resize(k);
  for (Index i = 0; i < k; ++i) {
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(rows, W[at(i)]); it; ++it)
      if (held[at(it.col())] == 0) A(it.col(), i) = it.value();
    const double norm = A.col(i).norm();
    scale[i] = norm > 0 ? 1 / norm : 0;
    A.col(i) *= scale[i];
  }
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(k, k);
  G.selfadjointView<Eigen::Lower>().rankUpdate(A.transpose());
  return G;
}

/// sum of parts and what is left, as one double.
double both(const TwoPartVector& v, Index i) { return v.value[i] + v.rest[i]; }

}  // namespace

Projector::Projector(Polyhedron C) : C_(std::move(C)) {
  if (const auto why = C_.invalid()) refuse_input(*why);
  C_.A.makeCompressed();
  rows_ = C_.A;
  norms_.resize(rows_.rows());
  for (Index i = 0; i < norms_.size(); ++i) norms_[i] = rows_.row(i).norm();
}

const FacePivoting::Rows& Projector::dense() {
  if (!has_dense_) dense_ = C_.A;
  has_dense_ = true;
  return dense_;
}

FacePivoting& Projector::pivoting() {
  if (!prepared_) pivoting_.prepare(nullptr, dense());
  prepared_ = true;
  return pivoting_;
}

void Projector::set_sides(Box rows, Box box) {
  C_.rows = std::move(rows);
  C_.box = std::move(box);
  if (C_.box.size() != rows_.cols() || C_.rows.size() != rows_.rows()) refuse_input("b, l: have other lengths than A");
  if (const auto why = C_.rows.invalid()) refuse_input("b, c: ", *why);
  if (const auto why = C_.box.invalid()) refuse_input("l, u: ", *why);
}

const Projection& Projector::project(const TwoPartVector& t, Face face, double wanted, const Limits& limits) {
  out_.empty = false;
  out_.certificate.resize(0);
  out_.error = out_.misses = infinity;
  out_.p.resize(0);
  face.rows.resize(at(rows_.rows()), Cell::Inside);
  face.bounds.resize(at(C_.size()), Cell::Inside);
  for (const bool search : {false, true}) {
    if (search && !find_face(t, face, limits)) break;
    keep_fixed(face);
    std::optional<Point> point = solve_face(face, t);
    if (!point) continue;
    at_ = std::move(*point);
    out_.face = face;
    out_.p = at_.p.value;
    out_.multipliers = Vec::Zero(rows_.rows());
    for (std::size_t k = 0; k < at_.active.size(); ++k)
      out_.multipliers[at_.active[k]] = at_.mu.value[static_cast<Index>(k)];
    out_.error = error_bound(t, limits);
    if (out_.error <= wanted) break;
  }
  return out_;
}

/// Holds the fixed variables, and takes no side that is none for an equation.
void Projector::keep_fixed(Face& face) const {
  for (Index i = 0; i < rows_.rows(); ++i)
    if (face.rows[at(i)] == Cell::Fixed && !C_.rows.is_fixed(i)) face.rows[at(i)] = Cell::Inside;
  for (Index j = 0; j < C_.size(); ++j) {
    Cell& cell = face.bounds[at(j)];
    if (C_.box.is_fixed(j))
      cell = Cell::Fixed;
    else if (cell == Cell::Fixed)
      cell = Cell::Inside;
  }
}

/// The face that the projection lies on, by pivoting; false if there is none, or it was not found.
bool Projector::find_face(const TwoPartVector& t, Face& face, const Limits& limits) {
  if (C_.size() + rows_.rows() <= dense_size) {
    const auto end = pivoting().run(-t.value, C_.rows, C_.box, face, limits);
    out_.empty = end == FacePivoting::End::Empty;
    out_.certificate = pivoting_.certificate();
    if (end != FacePivoting::End::Stopped) return !out_.empty;
  }
  SpMat identity(C_.size(), C_.size());
  identity.setIdentity();
  const AffineMcp mcp = lifted({identity, -t.value, C_});
  const Result found = lcp::solve(mcp, lcp::project(mcp.box, Vec::Zero(mcp.size())), Auto{}, limits);
  if (found.status == Status::Infeasible) {
    out_.empty = true;
    return false;
  }
  if (!found.accepted()) return false;
  face = face_of(C_, found.z);
  return true;
}

/// p and mu of the face; nothing if its normals are dependent.
std::optional<Projector::Point> Projector::solve_face(const Face& face, const TwoPartVector& t) const {
  const Index n = C_.size(), m = rows_.rows();
  Point point{.p = t};
  std::vector<Index>& active = point.active;
  Vec b(m);
  for (Index i = 0; i < m; ++i) {
    const Cell cell = face.rows[at(i)];
    if (cell == Cell::Inside) continue;
    b[static_cast<Index>(active.size())] = cell == Cell::Above ? C_.rows.upper[i] : C_.rows.lower[i];
    active.push_back(i);
  }
  const auto k = static_cast<Index>(active.size());
  if (!b.head(k).allFinite()) return {};
  std::vector<char> held(at(n), 0);
  for (Index j = 0; j < n; ++j) {
    const Cell cell = face.bounds[at(j)];
    if (cell == Cell::Inside) continue;
    held[at(j)] = 1;
    point.p.value[j] = cell == Cell::Above ? C_.box.upper[j] : C_.box.lower[j];
    point.p.rest[j] = 0;
    if (!std::isfinite(point.p.value[j])) return {};
  }
  point.mu = TwoPartVector(Vec(Vec::Zero(k)));
  point.misses.resize(k);
  if (k > 0) {
    Vec scale;
    const Eigen::LLT<Eigen::MatrixXd> factor(gram(rows_, active, held, scale));
    if (factor.info() != Eigen::Success || scale.minCoeff() == 0) return {};
    const auto diagonal = factor.matrixLLT().diagonal();
    if (!(diagonal.minCoeff() > 1e-7)) return {};
    const auto correct = [&](const Vec& r) {
      const Vec d = factor.solve(r);
      for (Index i = 0; i < k; ++i) {
        const double di = scale[i] * d[i];
        point.mu.add(i, di);
        for (Rows::InnerIterator it(rows_, active[at(i)]); it; ++it)
          if (held[at(it.col())] == 0) point.p.add_product(it.col(), it.value(), di);
      }
    };
    Vec r(k);
    for (Index i = 0; i < k; ++i) r[i] = scale[i] * (b[i] - rows_.row(active[at(i)]).dot(point.p.value));
    correct(r);
    double last = infinity;
    for (int step = 1; step < refinements; ++step) {
      for (Index i = 0; i < k; ++i) {
        const Slack off = slack(active[at(i)], b[i], point.p);
        point.misses[i] = off.size();
        r[i] = -scale[i] * off.value;
      }
      const double size = r.lpNorm<Eigen::Infinity>();
      if (!(size > eps_twice * point.p.value.lpNorm<Eigen::Infinity>()) || !(size < 0.5 * last)) break;
      last = size;
      if (step + 1 < refinements) correct(r);
    }
  }
  for (const Vec* part : {&point.p.value, &point.p.rest, &point.mu.value, &point.mu.rest})
    if (!part->allFinite()) return {};
  return point;
}

double Projector::error_bound(const TwoPartVector& t, const Limits& limits) {
  const Index n = C_.size();
  // nu = p - t - A'mu, and what is not right of its signs and mu's.
  TwoPartVector nu = at_.p;
  Vec terms = at_.p.value.cwiseAbs() + t.value.cwiseAbs();
  for (Index j = 0; j < n; ++j) {
    nu.add(j, -t.value[j]);
    nu.add(j, -t.rest[j]);
  }
  double wrong = 0, kappa = 0;
  for (std::size_t k = 0; k < at_.active.size(); ++k) {
    const Index i = at_.active[k];
    const auto at_k = static_cast<Index>(k);
    const Cell cell = out_.face.rows[at(i)];
    const double mu = both(at_.mu, at_k);
    for (Rows::InnerIterator it(rows_, i); it; ++it) {
      nu.add_product(it.col(), -it.value(), at_.mu.value[at_k]);
      nu.add_product(it.col(), -it.value(), at_.mu.rest[at_k]);
      terms[it.col()] += std::abs(it.value() * mu);
    }
    if (cell != Cell::Fixed && (cell == Cell::Above ? mu > 0 : mu < 0))
      wrong += std::abs(mu) * norms_[i];
    else
      kappa += std::abs(mu) * at_.misses[at_k];
  }
  double square = 0;
  for (Index j = 0; j < n; ++j) {
    const double v = both(nu, j), rounding = eps_twice * static_cast<double>(at_.active.size() + 4) * terms[j];
    const Cell cell = out_.face.bounds[at(j)];
    const bool right = cell == Cell::Fixed || (cell == Cell::Below && v >= 0) || (cell == Cell::Above && v <= 0);
    const double off = (right ? 0 : std::abs(v)) + rounding;
    square += off * off;
    nu.value[j] = cell == Cell::Inside ? 0 : v;
  }
  out_.reduced = nu.value;
  const double moved = wrong + std::sqrt(square);
  out_.misses = moved + violation();
  const double eta = distance(limits);
  const double away = (at_.p.value - t.value).norm() * (1 + 4 * eps) + eps * (at_.p.value.norm() + t.value.norm());
  // Rounding of these few positive sums, generously.
  const double error = (moved + std::sqrt(kappa + (away + eta) * eta)) * (1 + 1e-6) + eps * at_.p.value.norm();
  return std::isnan(error) ? infinity : error;
}

/// By how much p misses the row or bound that it misses most, rows beside their norms; infinite where that overflows.
double Projector::violation() const {
  double worst = 0;
  const auto off_row = [&](Index i, double by) {
    if (!(by <= 0)) worst = std::max(worst, norms_[i] > 0 && std::isfinite(norms_[i]) ? by / norms_[i] : infinity);
  };
  std::size_t k = 0;  // W is in order
  for (Index i = 0; i < rows_.rows(); ++i) {
    if (k < at_.active.size() && at_.active[k] == i)
      off_row(i, at_.misses[static_cast<Index>(k++)]);
    else
      off_row(i, -row_slack(i, at_.p));
  }
  for (Index j = 0; j < C_.size(); ++j) worst = std::max(worst, -bound_slack(j, at_.p));
  return worst;
}

/// At least the distance from p to a point of C.
double Projector::distance(const Limits& limits) {
  const Index n = C_.size();
  const double size = at_.p.value.lpNorm<Eigen::Infinity>();
  // p in doubles; what is left of a zero is none.
  const TwoPartVector rounded((at_.p.value.array().abs() > 1e-25 * size).select(at_.p.value, 0));
  const double rounding = ((at_.p.value - rounded.value) + at_.p.rest).norm();
  bool inside = rounding <= 1e-25 * size;
  for (Index i = 0; inside && i < rows_.rows(); ++i) inside = row_slack(i, rounded) >= 0;
  for (Index j = 0; inside && j < n; ++j) inside = bound_slack(j, rounded) >= 0;
  if (inside) return rounding * (1 + 1e-6);
  std::vector<char> held(at(n), 0);
  std::vector<Index> E = at_.active;
  std::vector<char> in(at(rows_.rows()), 0);
  for (const Index i : at_.active) in[at(i)] = 1;
  TwoPartVector y = at_.p;
  double moved = 0;  // to bounds that p only just misses
  for (Index j = 0; j < n; ++j) {
    if (out_.face.bounds[at(j)] != Cell::Inside) {
      held[at(j)] = 1;
      continue;
    }
    if (bound_slack(j, at_.p) > 1e-20 * size) continue;
    const double side =
        both(at_.p, j) - C_.box.lower[j] < C_.box.upper[j] - both(at_.p, j) ? C_.box.lower[j] : C_.box.upper[j];
    moved += std::abs((at_.p.value[j] - side) + at_.p.rest[j]);
    held[at(j)] = 1;
    y.value[j] = side;
    y.rest[j] = 0;
  }
  for (Index i = 0; i < rows_.rows(); ++i)
    if (in[at(i)] == 0 && row_slack(i, y) <= 1e-20 * norms_[i] * (size + 1e-300)) E.push_back(i);
  const double eta = through_equations(E, held, y, moved > 0) + moved;
  if (eta < infinity) return eta;
  return through_inside(limits);
}

/// The distance from y to a point with y's values of held variables on which the rows E are equations, if all else
/// holds there. `tight` begins with W; y is p unless it is `moved`.
double Projector::through_equations(const std::vector<Index>& tight, const std::vector<char>& held,
                                    const TwoPartVector& y, bool moved) const {
  std::vector<Index> E;
  std::vector<double> sides, off;
  for (std::size_t t = 0; t < tight.size(); ++t) {
    const Index i = tight[t];
    const Cell cell = out_.face.rows[at(i)];
    const auto miss = [&](double side) {
      if (t < at_.active.size() && !moved) return at_.misses[static_cast<Index>(t)];
      return std::isfinite(side) ? slack(i, side, y).size() : infinity;
    };
    const double below = cell == Cell::Above ? infinity : miss(C_.rows.lower[i]);
    const double above = cell == Cell::Below || cell == Cell::Fixed ? infinity : miss(C_.rows.upper[i]);
    const double side = below <= above ? C_.rows.lower[i] : C_.rows.upper[i];
    bool said = false;  // by the same or the opposite row, as an equation
    for (std::size_t k = 0; k < E.size() && !said; ++k)
      said = norms_[E[k]] == norms_[i] &&
             ((side == sides[k] && same_row(E[k], i, 1)) || (side == -sides[k] && same_row(E[k], i, -1)));
    if (said) continue;
    E.push_back(i);
    sides.push_back(side);
    off.push_back(std::min(below, above));
  }
  const Vec misses = Eigen::Map<const Vec>(off.data(), static_cast<Index>(off.size()));
  const double zeta = step_onto(E, held, misses);
  if (zeta == infinity) return infinity;
  std::vector<char> in(at(rows_.rows()), 0);
  for (const Index i : tight) in[at(i)] = 1;
  for (Index i = 0; i < rows_.rows(); ++i)
    if (in[at(i)] == 0 && !(row_slack(i, y) >= 1.01 * zeta * norms_[i])) return infinity;
  for (Index j = 0; j < C_.size(); ++j)
    if (held[at(j)] == 0 && !(bound_slack(j, y) >= zeta)) return infinity;
  return zeta;
}

/// True if row j is s times row i.
bool Projector::same_row(Index i, Index j, double s) const {
  Rows::InnerIterator a(rows_, i), b(rows_, j);
  for (; a && b; ++a, ++b)
    if (a.col() != b.col() || b.value() != s * a.value()) return false;
  return !a && !b;
}

/// At least the length of the least step onto the equations E from a point that misses them by so much; infinite where
/// their normals are, or may be, dependent.
double Projector::step_onto(const std::vector<Index>& E, const std::vector<char>& held, const Vec& misses) const {
  const auto k = static_cast<Index>(E.size());
  if (k == 0 || misses.isZero(0)) return 0;
  Vec scale;
  Eigen::MatrixXd G = gram(rows_, E, held, scale);
  if (scale.minCoeff() == 0) return infinity;
  // The rounding of G and of the factorization is at most shift / 2 (Rump 2006).
  const double shift = std::max(1e-9, 16.0 * static_cast<double>((rows_.cols() + k) * k) * eps);
  G.diagonal().array() -= shift;
  if (Eigen::LLT<Eigen::MatrixXd>(G).info() != Eigen::Success) return infinity;
  return 1.01 * scale.cwiseProduct(misses).norm() / std::sqrt(shift / 2);
}

/// The distance from p to a point of C on the way to a point z inside all rows that are no equations.
double Projector::through_inside(const Limits& limits) {
  const Index n = C_.size(), m = rows_.rows();
  if (n + m > dense_size) return infinity;
  const TwoPartVector& p = at_.p;
  const double size = p.value.lpNorm<Eigen::Infinity>() + 1;
  for (Index j = 0; j < n; ++j)  // no way leads from a fixed variable's wrong value
    if (C_.box.is_fixed(j) && (p.value[j] != C_.box.lower[j] || p.rest[j] != 0)) return infinity;
  Face equations{std::vector<Cell>(at(m), Cell::Inside), std::vector<Cell>(at(n), Cell::Inside)};
  std::vector<char> held(at(n), 0);
  for (Index i = 0; i < m; ++i)
    if (C_.rows.is_fixed(i)) equations.rows[at(i)] = Cell::Fixed;
  for (Index j = 0; j < n; ++j)
    if (C_.box.is_fixed(j)) {
      equations.bounds[at(j)] = Cell::Fixed;
      held[at(j)] = 1;
    }
  for (const double margin : {1e-3, 1e-6}) {
    Box rows = C_.rows, box = C_.box;
    const auto shrink = [](Box& sides, Index i, double by) {
      if (sides.is_fixed(i)) return;
      const double most = std::min(by, (sides.upper[i] - sides.lower[i]) / 4);
      sides.lower[i] += most;
      sides.upper[i] -= most;
    };
    for (Index i = 0; i < m; ++i) shrink(rows, i, margin * size * norms_[i]);
    for (Index j = 0; j < n; ++j) shrink(box, j, margin * size);
    Face face;
    if (pivoting().run(-p.value, rows, box, face, limits) != FacePivoting::End::Found) continue;
    const std::optional<Point> z = solve_face(equations, TwoPartVector(pivoting().x()));
    if (!z) return infinity;
    // A point y on the way misses the equations by at most what p and z miss; the step onto them needs room.
    const std::vector<Index>& E = z->active;
    Vec misses(static_cast<Index>(E.size()));
    for (std::size_t k = 0; k < E.size(); ++k) {
      const double side = C_.rows.lower[E[k]];
      misses[static_cast<Index>(k)] = std::max(slack(E[k], side, p).size(), slack(E[k], side, z->p).size());
    }
    const double zeta = step_onto(E, held, misses);
    double theta = 0;
    const auto go = [&](double at_p, double at_z, double room) {
      if (!(at_z > room) || !(at_p > -infinity))
        theta = infinity;
      else if (at_p < room)
        theta = std::max(theta, (room - at_p) / (at_z - at_p));
    };
    for (Index i = 0; i < m; ++i)
      if (!C_.rows.is_fixed(i)) go(row_slack(i, p), row_slack(i, z->p), 1.01 * zeta * norms_[i]);
    for (Index j = 0; j < n; ++j)
      if (!C_.box.is_fixed(j)) go(bound_slack(j, p), bound_slack(j, z->p), 1.01 * zeta);
    theta *= 1 + 1e-10;
    if (theta <= 1) return (theta * ((z->p.value - p.value).norm() + eps * size) + zeta) * (1 + 1e-6);
  }
  return infinity;
}

/// a_i y - side, in three doubles, and exactly where products leave the range.
Projector::Slack Projector::slack(Index i, double side, const TwoPartVector& y) const {
  const auto sum_up = [&](auto& sum) {
    for (Rows::InnerIterator it(rows_, i); it; ++it)
      for (const double part : {y.value[it.col()], y.rest[it.col()]})
        if (part != 0) sum.add_product(it.value(), part);
  };
  TripleSum sum(-side);
  sum_up(sum);
  sum.settle();
  if (sum.doubt() < infinity) return {sum.value(), eps * std::abs(sum.value()) + 2 * sum.doubt()};
  ExactSum exact;
  exact.add(-side);
  sum_up(exact);
  const double value = exact.value();
  // Products below the range lose less than 2^-1000 each.
  const double lost = exact.exact() ? 0 : 0x1p-1000 * static_cast<double>(2 * rows_.cols() + 1);
  return {value, std::isfinite(value) ? eps * std::abs(value) + lost : infinity};
}

/// Bounds from below how far the row is inside its sides, exactly where it matters; -infinity where it overflows.
double Projector::row_slack(Index i, const TwoPartVector& y) const {
  double a = 0, terms = 0;
  for (Rows::InnerIterator it(rows_, i); it; ++it) {
    const double term = it.value() * y.value[it.col()];
    a += term;
    terms += std::abs(term);
  }
  if (!std::isfinite(terms)) return -infinity;
  const double lower = C_.rows.lower[i], upper = C_.rows.upper[i];
  const double rounding = eps * (static_cast<double>(rows_.cols()) + 4) * terms;
  const double near = std::min(a - lower, upper - a);
  const double side = a - lower < upper - a ? lower : upper;
  if (near == infinity || near > 1e-6 * (terms + (std::isfinite(side) ? std::abs(side) : 0)) + rounding)
    return near * (1 - 4 * eps) - rounding;
  double least = infinity;
  for (const bool above : {false, true}) {
    if (!std::isfinite(above ? upper : lower)) continue;
    const Slack s = slack(i, above ? upper : lower, y);
    const double inside = (above ? -s.value : s.value) - eps * std::abs(s.value) - s.error;
    if (!(inside > -infinity)) return -infinity;
    least = std::min(least, inside);
  }
  return least;
}

double Projector::bound_slack(Index j, const TwoPartVector& y) const {
  const double below = (y.value[j] - C_.box.lower[j]) + y.rest[j], above = (C_.box.upper[j] - y.value[j]) - y.rest[j];
  return std::min(below, above);
}

Vec proof_of_empty(const AffineMcp& mcp, const Polyhedron& C, In y) {
  Vec lifted_y = Vec::Zero(mcp.size());
  lifted_y.segment(C.size(), C.A.rows()) = y;
  return exact_certificate(mcp, lifted_y);
}

}  // namespace perp::lcp
