// SPDX-License-Identifier: Apache-2.0
/// find_infeasibility(): single contacts, then part by part nonnegative least squares; simple numbers in the end.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>
#include <vector>

#include "contact/existence/conic_nnls.hpp"
#include "contact/existence/frictionless_ray.hpp"
#include "contact/existence/infeasible.hpp"
#include "contact/model/unit_cone.hpp"
#include "lcp/cholesky/symmetric.hpp"
#include "lcp/deadline.hpp"
#include "lcp/dense_factors.hpp"

namespace perp::contact {
namespace {

using Clock = std::chrono::steady_clock;
using Dense = Eigen::MatrixXd;

/// Columns, and rounds, of one least squares problem.
constexpr std::size_t most_columns = 600;
constexpr int rounds_a_contact = 40;
/// Of |rho|: directions that reduce it by less end the search; of the first |rho| = 1: what counts as a candidate.
constexpr double stationary = 1e-11;
constexpr double candidate = 1e-7;
/// y below this part of the largest is left out of the support.
constexpr double support_tol = 1e-9;
/// Fractions tried: their largest denominator, and the largest common one.
constexpr double largest_denominator = 1024;
constexpr double largest_common = 0x1p40;
/// Velocities of constrained bodies, all columns; the squares of those that are rounding.
constexpr std::size_t most_entries = 5'000'000;
constexpr double rounding_of_held = 1e-26;

/// The nearest fraction of a small denominator by continued fractions; 0 if there is none within 1e-9 of v.
double denominator(double v) {
  double before = 0;
  double now = 1;
  double rest = v;
  for (int k = 0; k < 20 && now <= largest_denominator; ++k) {
    if (std::abs(v * now - std::round(v * now)) <= 1e-9 * std::max(v, 1e-3) * now) return now;
    rest = 1 / (rest - std::floor(rest));
    if (!std::isfinite(rest)) return 0;
    before = std::exchange(now, std::floor(rest) * now + before);
  }
  return 0;
}

/// v in whole numbers, if its entries are ratios of small ones; empty if not.
Vec whole_numbers(const Vec& v) {
  double common = 1;
  for (const double value : v) {
    if (value == 0) continue;
    const double one = denominator(value);
    if (one == 0) return {};
    common *= one / static_cast<double>(std::gcd(static_cast<long long>(common), static_cast<long long>(one)));
    if (common > largest_common) return {};
  }
  return (common * v).array().round().matrix();
}

/// What weights y of the contacts have to make: columns y in -K*, contact by contact, or 0 where W is semidefinite.
struct Target {
  SpMat columns{};        // one a contact: of W', of H with each row in units of its own, or of K^-1 H
  int group = 1;          // rows that belong together: the d of a contact
  bool symmetric = true;  // W
};

/// Of bodies that constraints hold the velocities K^-1 H (y e_N) have to be 0. Nothing where they do not fit, it is
/// late, or nothing is proven by them.
std::optional<SpMat> velocities_of(const DelassusParts& parts, int d, const std::function<bool()>& late) {
  const Inertia& inertia = parts.inertia();
  if (!inertia.symmetric()) return std::nullopt;
  const Index m = inertia.velocities();
  const Vec M = parts.M().diagonal();
  const SpMat H = normal_columns(parts.H(), d);
  const Vec free = free_squares(inertia, H);
  std::vector<Eigen::Triplet<double>> entries;
  bool all = true;
  inertia.lu().for_each_column(H, [&](Index a, const lcp::SparseVector& v) {
    v.for_each([&](Index i, double value) {
      if (i >= m) return;
      const double size = std::sqrt(M[i]) * value;
      if (size * size > rounding_of_held * free[a])
        entries.emplace_back(static_cast<int>(i), static_cast<int>(a), size);
    });
    all = entries.size() <= most_entries && !late();
    return all;
  });
  if (!all) return std::nullopt;
  SpMat V(m, H.cols());
  V.setFromTriplets(entries.begin(), entries.end());
  return V;
}

/// Of W = H' M^-1 H by its parts H (y e_N) = 0, whatever the units of its rows.
std::optional<Target> target_of(const Problem& problem, const std::function<bool()>& late) {
  const int d = problem.dimension;
  if (const DelassusParts* parts = problem.W.whole_parts()) {
    if (parts->inertia().by_lu()) {
      std::optional<SpMat> V = velocities_of(*parts, d, late);
      return V ? std::optional<Target>({.columns = std::move(*V)}) : std::nullopt;
    }
    const Vec units = parts->M().diagonal().cwiseSqrt().cwiseInverse();
    return Target{.columns = units.asDiagonal() * normal_columns(parts->H(), d)};
  }
  const SpMat& W = problem.W.matrix();
  return Target{.columns = normal_columns(W.transpose(), d), .group = d, .symmetric = lcp::symmetric(W, 0)};
}

class Search {
 public:
  Search(const Problem& problem, const SearchLimits& limits, Target target)
      : problem_(problem), limits_(limits), d_(problem.dimension), target_(std::move(target)) {
    const Vec q = problem.q.cwiseAbs();
    velocity_ = q.size() > 0 && q.maxCoeff() > 0 ? q.maxCoeff() : 1;
  }

  std::optional<Infeasible> run() {
    for (Index a = 0; a < problem_.contacts() && !over(); ++a)
      if (problem_.q[d_ * a] < 0 && alone(a)) return best_;
    for (const std::vector<Index>& part : parts()) {
      if (over()) break;
      if (part.size() > 1 && examine(part)) return best_;
    }
    return best_;
  }

 private:
  bool over() const {
    return Clock::now() - begin_ > limits_.max_time || (limits_.interrupt != nullptr && *limits_.interrupt);
  }

  bool alone(Index a);
  std::vector<std::vector<Index>> parts() const;
  bool examine(const std::vector<Index>& part);
  void prepare(const std::vector<Index>& part);
  double unit(Index a) const;
  /// The coefficient of the disk that entry k of the contact is of; 1 of the normal.
  double friction(Index a, Index k) const {
    return k == 0 ? 1 : k < problem_.space() ? problem_.mu[a] : problem_.mu_r[a];
  }
  Index row_of(Index row) const { return group() * place_[at(row / group())] + row % group(); }
  Index group() const { return target_.group; }
  bool by_bodies() const { return problem_.W.whole_parts() != nullptr; }
  std::vector<Index> frictionless_ray(const std::vector<Index>& part, bool& solved);
  bool least_squares(const std::vector<Index>& part, bool with_slack);
  ConicNnls::Column ray(Index a, const Vec& rho, double& slope) const;
  bool offer(const ConicNnls& method, const std::vector<Index>& part);
  std::vector<Index> offer(Vec y, const std::vector<char>& slack, const std::vector<Index>& part);
  void refine(Vec& y, const std::vector<Index>& support, const std::vector<char>& slack) const;
  bool try_one(const Vec& y);

  const Problem& problem_;
  SearchLimits limits_;
  Clock::time_point begin_ = Clock::now();
  int d_;
  Target target_;
  double velocity_ = 1;
  std::optional<Infeasible> best_;

  // Of the part at hand: the groups of rows it acts on and their places, weights of rows, what columns are divided by.
  std::vector<Index> all_;
  std::vector<Index> place_;
  Vec weight_;
  Vec norm_;
};

/// Keeps y if it proves anything and more than what is kept; whether it proves all.
bool Search::try_one(const Vec& y) {
  if (y.size() == 0 || !proves_infeasible(problem_, y)) return false;
  const double radius = infeasibility_radius(problem_, y);
  if (!best_ || radius > best_->radius) best_ = Infeasible{y, radius};
  return radius == lcp::infinity;
}

/// 1 / sqrt of the largest diagonal entry of W at the contact.
double Search::unit(Index a) const {
  double largest = 0;
  for (int k = 0; k < d_; ++k) largest = std::max(largest, std::abs(problem_.W.near(d_ * a + k, d_ * a + k)));
  return largest > 0 ? 1 / std::sqrt(largest) : 1;
}

bool Search::alone(Index a) {
  for (SpMat::InnerIterator it(target_.columns, a); it; ++it)
    if (by_bodies() ? it.value() != 0 : it.row() % d_ == 0 && it.value() > 0) return false;
  Vec y = Vec::Zero(problem_.contacts());
  y[a] = 1;
  return try_one(y);
}

/// Contacts that do not act on each other are apart; of parts with an approaching contact, small ones first.
std::vector<std::vector<Index>> Search::parts() const {
  std::vector<std::vector<Index>> all = problem_.W.groups(d_);
  std::erase_if(all, [&](const std::vector<Index>& part) {
    return std::ranges::none_of(part, [&](Index a) { return problem_.q[d_ * a] < 0; });
  });
  std::ranges::stable_sort(all, {}, &std::vector<Index>::size);
  return all;
}

/// For symmetric semidefinite W there is a certificate if and only if the frictionless problem has none but
/// certificates for an answer: pivoting, or the QP, which is fast for any size, is asked first. Then least squares,
/// without slack where W y e_N has to be 0.
bool Search::examine(const std::vector<Index>& part) {
  if (!target_.symmetric) return least_squares(part, true);
  bool solved = false;
  const std::vector<Index> support = frictionless_ray(part, solved);
  if (best_) return true;
  if (solved) return false;
  if (!support.empty() && support.size() < part.size() && least_squares(support, false)) return true;
  if (least_squares(part, false)) return true;
  return !by_bodies() && static_cast<Index>(part.size()) < pivoting_to && least_squares(part, true);
}

/// Asks for the frictionless problem of the part; a certificate of it is offered. The contacts of that.
std::vector<Index> Search::frictionless_ray(const std::vector<Index>& part, bool& solved) {
  prepare(part);
  const Vec units = Vec::NullaryExpr(static_cast<Index>(part.size()), [&](Index k) { return unit(part[at(k)]); });
  lcp::Limits limits;
  limits.deadline = lcp::deadline_after(limits_.max_time, begin_);
  if (limits_.interrupt != nullptr) limits.interrupted = [stop = limits_.interrupt] { return stop->load(); };
  const FrictionlessAnswer answer = frictionless_answer(problem_, part, units, limits);
  solved = answer.solved;
  if (answer.y.size() == 0) return {};
  Vec y = Vec::Zero(problem_.contacts());
  y(part) = answer.y;
  const std::vector<char> slack(at(problem_.contacts()), 0);
  return offer(y, slack, part);
}

/// The generator of K* at contact a that reduces |rho| most: -P_K*(-rho_a), in coordinates where mu = 1.
ConicNnls::Column Search::ray(Index a, const Vec& rho, double& slope) const {
  const Index first = d_ * place_[at(a)];
  ConicNnls::Column column{.tag = -1 - a, .entries = {}};
  ContactVector<5> y = ContactVector<5>::Zero();
  for (int k = 0; k < d_; ++k)
    if (friction(a, k) > 0) y[k] = rho[first + k];
  // Moreau: -P_K*(-y) = y - P_K(y).
  ContactVector<5> z = project_onto_unit_cone<5>(y, problem_.rolls() ? problem_.disk_width() : 2) - y;
  slope = -z.norm();
  if (slope == 0) return column;
  z /= z.norm();
  for (int k = 0; k < d_; ++k)
    if (z[k] != 0) column.entries.emplace_back(first + k, z[k]);
  return column;
}

/// Every contact in units of its own, friction cones with mu = 1; no rows for tangents that do no work.
void Search::prepare(const std::vector<Index>& part) {
  all_.clear();
  if (!by_bodies()) all_ = part;
  for (const Index a : part)
    for (SpMat::InnerIterator it(target_.columns, a); it; ++it) all_.push_back(it.row() / group());
  std::ranges::sort(all_);
  all_.erase(std::unique(all_.begin(), all_.end()), all_.end());
  place_.assign(at(target_.columns.rows() / group()), -1);
  for (std::size_t k = 0; k < all_.size(); ++k) place_[at(all_[k])] = static_cast<Index>(k);
  weight_ = Vec::Ones(group() * static_cast<Index>(all_.size()));
  if (!by_bodies())
    for (const Index b : all_)
      for (int k = 0; k < d_; ++k) weight_[d_ * place_[at(b)] + k] = friction(b, k) * unit(b);
  norm_ = Vec::Ones(problem_.contacts());
}

bool Search::least_squares(const std::vector<Index>& part, bool with_slack) {
  prepare(part);
  const Index m = weight_.size();
  std::vector<ConicNnls::Column> columns;
  double steepest = 0;  // largest velocity of a column of norm 1
  for (const Index a : part) {
    ConicNnls::Column column{.tag = a, .entries = {}};
    double squares = 0;
    for (SpMat::InnerIterator it(target_.columns, a); it; ++it) {
      const Index row = row_of(it.row());
      const double value = weight_[row] * it.value();
      if (value != 0) column.entries.emplace_back(row, value);
      squares += value * value;
    }
    norm_[a] = squares > 0 && std::isfinite(squares) ? std::sqrt(squares) : 1;
    for (auto& [row, value] : column.entries) value /= norm_[a];
    columns.push_back(std::move(column));
    steepest = std::max(steepest, std::abs(problem_.q[d_ * a]) / velocity_ / norm_[a]);
  }
  if (!(steepest > 0) || !std::isfinite(steepest)) return false;
  for (ConicNnls::Column& column : columns)
    if (const double q = problem_.q[d_ * column.tag] / velocity_ / norm_[column.tag] / steepest; q != 0)
      column.entries.emplace_back(m, q);

  ConicNnls method(Vec::Unit(m + 1, m));
  std::vector<char> refused(columns.size(), 0);
  const int rounds = rounds_a_contact * static_cast<int>(all_.size()) + 100;
  for (int k = 0; k < rounds && method.columns().size() < most_columns && !over(); ++k) {
    const Vec& rho = method.rho();
    if (rho.norm() < candidate) break;
    double steep = -stationary * rho.norm();
    std::optional<std::size_t> entering;
    for (std::size_t j = 0; j < columns.size(); ++j)
      if (const double slope = columns[j].dot(rho); refused[j] == 0 && slope < steep) {
        steep = slope;
        entering = j;
      }
    std::optional<ConicNnls::Column> slack;
    for (const Index b : all_) {
      if (!with_slack) break;
      double slope = 0;
      ConicNnls::Column column = ray(b, rho, slope);
      if (slope >= steep) continue;
      steep = slope;
      slack = std::move(column);
    }
    if (!slack && !entering) break;
    if (method.enter(slack ? *slack : columns[*entering])) {
      std::ranges::fill(refused, 0);
      continue;
    }
    if (slack) break;
    refused[*entering] = 1;
  }
  // An exact certificate has rho = 0; at the end without one r = rho / rho_0 has u_N >= 0.
  return method.rho().norm() < std::sqrt(candidate) && offer(method, part);
}

/// y = y - the shortest correction after which W'(y e_N) = 0 in contacts without slack.
void Search::refine(Vec& y, const std::vector<Index>& support, const std::vector<char>& slack) const {
  const auto needed = [&](Index row) {
    const Index b = row / d_;
    return slack[at(b)] == 0 && friction(b, row % d_) > 0;
  };
  std::vector<Index> rows;
  for (const Index a : support)
    for (SpMat::InnerIterator it(target_.columns, a); it; ++it)
      if (it.value() != 0 && (by_bodies() || needed(it.row()))) rows.push_back(it.row());
  std::ranges::sort(rows);
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  if (rows.empty() || support.size() > most_columns) return;
  Dense G = Dense::Zero(static_cast<Index>(rows.size()), static_cast<Index>(support.size()));
  Vec x(G.cols());
  for (std::size_t k = 0; k < support.size(); ++k) {
    const Index a = support[k];
    x[static_cast<Index>(k)] = y[a] * norm_[a];
    for (SpMat::InnerIterator it(target_.columns, a); it; ++it)
      if (const auto found = std::ranges::lower_bound(rows, it.row()); found != rows.end() && *found == it.row())
        G(found - rows.begin(), static_cast<Index>(k)) = it.value() * weight_[row_of(it.row())] / norm_[a];
  }
  Eigen::CompleteOrthogonalDecomposition<Dense> factor;
  factor.setThreshold(1e-9);
  factor.compute(G);
  for (int k = 0; k < 3; ++k) x -= factor.solve(Vec(G * x));
  for (std::size_t k = 0; k < support.size(); ++k) {
    const Index a = support[k];
    y[a] = std::max(0.0, x[static_cast<Index>(k)] / norm_[a]);
  }
}

bool Search::offer(const ConicNnls& method, const std::vector<Index>& part) {
  Vec y = Vec::Zero(problem_.contacts());
  std::vector<char> slack(at(problem_.contacts()), 0);
  for (Index j = 0; j < method.x().size(); ++j) {
    const Index tag = method.columns()[at(j)].tag;
    if (tag < 0)
      slack[at(-1 - tag)] = 1;
    else
      y[tag] = method.x()[j] / norm_[tag];
  }
  offer(y, slack, part);
  return best_.has_value();
}

/// Tries y, refined, in whole numbers and as it is; the contacts it is made of.
std::vector<Index> Search::offer(Vec y, const std::vector<char>& slack, const std::vector<Index>& part) {
  double largest = 0;
  for (const Index a : part) largest = std::max(largest, y[a] / unit(a));
  std::vector<Index> support;
  for (const Index a : part) {
    if (y[a] / unit(a) > support_tol * largest)
      support.push_back(a);
    else
      y[a] = 0;
  }
  if (support.empty()) return support;
  Vec refined = y;
  refine(refined, support, slack);
  for (const Vec& v : {refined, y}) {
    const double most = v.maxCoeff();
    if (!(most > 0)) continue;
    double least = most;
    for (const Index a : support)
      if (v[a] > 0) least = std::min(least, v[a]);
    for (const double one : {most, least, v[support.front()]})
      if (one > 0 && try_one(whole_numbers(v / one))) return support;
    // Where all is slack any near numbers do: ten bits.
    if (try_one((v * (0x1p10 / most)).array().round().matrix()) || try_one(v / most)) return support;
  }
  return support;
}

}  // namespace

std::optional<Infeasible> find_infeasibility(const Problem& problem, const SearchLimits& limits) {
  check(problem);
  const lcp::Deadline deadline = lcp::deadline_after(limits.max_time);
  std::optional<Target> target =
      target_of(problem, [&] { return Clock::now() > deadline || (limits.interrupt != nullptr && *limits.interrupt); });
  return target ? Search(problem, limits, std::move(*target)).run() : std::nullopt;
}

}  // namespace perp::contact
