#include "lcp/lemke.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "lcp/equilibrate.hpp"

namespace perp::lcp {
namespace {

/// Where x_i lies; the column of x_i in the normal map is M_{.i} if Inside, e_i otherwise.
enum class Cell : signed char { Below, Inside, Above, Fixed };

/// The path G(x) = (1 - t) r and the basis that represents its present segment.
/// Unknowns: x_0 .. x_{n-1} and x_n = t, with column r. One of them, the driver, is nonbasic and moves; the n others
/// are basic, head_[p] at position p.
class Path {
 public:
  Path(const AffineMcp& problem, In start, const LemkeOptions& options)
      : original_(problem),
        scaling_(equilibrate(problem)),
        problem_(scaling_.apply(problem)),
        options_(options),
        n_(problem.size()),
        random_(options.seed),
        x_(scaling_.to_scaled(problem.box, start)),
        cell_(static_cast<std::size_t>(n_)),
        A_(with_unit_columns(problem_.M)),
        factor_(A_, options.basis) {}

  PivotResult follow();

 private:
  static SpMat with_unit_columns(const SpMat& M);
  Index column(Index i) const { return i == n_ ? 2 * n_ : inside(i) ? i : n_ + i; }
  bool inside(Index i) const { return cell_[static_cast<std::size_t>(i)] == Cell::Inside; }
  double& value(Index i) { return i == n_ ? t_ : x_[i]; }
  double low(Index i) const;  ///< bounds of the present cell of unknown i
  double high(Index i) const;

  void choose_cells(bool outside);
  double generic() { return std::uniform_real_distribution<double>(0.5, 1.5)(random_); }
  void perturb();
  LuStatus factor_cells();
  void place_outside();
  void set_residual_column();
  Vec constant() const;
  LuStatus factor_basis();
  LuStatus refactor();
  bool drive(Vec& d);
  bool t_moves(double rate, const Vec& d) const;
  bool advance(PivotResult& result, const Vec& d);
  void enter(Index p, const Vec& d);
  void cross(Index i, double direction);
  bool back_at_start(PivotResult& result) const;
  double polish();
  PivotResult finish(PivotResult result);
  std::optional<PivotEnd> limit(const PivotResult& result) const;

  Vec original(In x) const { return scaling_.to_original(problem_.box, x); }  ///< in the units of the problem given
  double judge(In x) const { return natural_residual(original_, project(original_.box, original(x))); }

  const AffineMcp& original_;
  Scaling scaling_;
  AffineMcp problem_;  // equilibrated: that is what makes the tolerances mean the same for every unknown
  const LemkeOptions& options_;
  Index n_;
  std::mt19937 random_;
  Vec x_;
  double t_ = 0;
  std::vector<Cell> cell_;
  SpMat A_;  // [M, I, r]
  BasisFactor factor_;
  std::vector<Index> head_;
  std::vector<Cell> start_;
  Index away_ = 0;    // how many unknowns are in another cell than at the start
  Index driver_ = 0;  // the unknown that is not basic
  double direction_ = 1;
  bool distrusted_ = false;  // the last update was unstable or refused: factor afresh before the next solve
};

SpMat Path::with_unit_columns(const SpMat& M) {
  const Index n = M.rows();
  SpMat A(n, 2 * n + 1);
  A.reserve(M.nonZeros() + 2 * n);
  for (Index j = 0; j < n; ++j) {
    A.startVec(j);
    for (SpMat::InnerIterator it(M, j); it; ++it) A.insertBack(it.row(), j) = it.value();
  }
  for (Index j = 0; j < n; ++j) {
    A.startVec(n + j);
    A.insertBack(j, n + j) = 1;
  }
  A.startVec(2 * n);
  for (Index i = 0; i < n; ++i) A.insertBack(i, 2 * n) = 0;  // r, when it is known
  A.finalize();
  return A;
}

double Path::low(Index i) const {
  if (i == n_) return -infinity;
  const Cell c = cell_[static_cast<std::size_t>(i)];
  return c == Cell::Inside ? problem_.box.lower[i] : c == Cell::Above ? problem_.box.upper[i] : -infinity;
}

double Path::high(Index i) const {
  if (i == n_) return 1;
  const Cell c = cell_[static_cast<std::size_t>(i)];
  return c == Cell::Inside ? problem_.box.upper[i] : c == Cell::Below ? problem_.box.lower[i] : infinity;
}

/// The cell the start lies in; with `outside`, the one beyond a finite bound for every variable that has one.
void Path::choose_cells(bool outside) {
  const Box& box = problem_.box;
  for (Index i = 0; i < n_; ++i) {
    Cell& cell = cell_[static_cast<std::size_t>(i)];
    if (box.lower[i] == box.upper[i])
      cell = Cell::Fixed;  // both cells outside have the column e_i and nothing lies between them
    else if (outside && (box.lower[i] > -infinity || box.upper[i] < infinity))
      cell = box.lower[i] > -infinity ? Cell::Below : Cell::Above;
    else
      cell = x_[i] < box.lower[i] ? Cell::Below : x_[i] > box.upper[i] ? Cell::Above : Cell::Inside;
  }
}

/// Moves the start to a random nearby point in the interior of its cell.
void Path::perturb() {
  if (options_.perturbation == 0) return;
  for (Index i = 0; i < n_; ++i) {
    double step = options_.perturbation * (1 + std::abs(x_[i])) * generic();
    const double to_low = x_[i] - low(i);
    const double to_high = high(i) - x_[i];
    step = std::min(step, 0.25 * (high(i) - low(i)));
    x_[i] += to_low <= to_high ? step : -step;
  }
}

/// For a ray start: x with G(x) = 0 in the linear piece of the start cell, then every bounded variable pushed beyond
/// its bound, so that -r is positive towards the box: the covering vector.
void Path::place_outside() {
  Vec y(n_);
  factor_.ftran(constant(), y);
  const double scale = 1 + problem_.q.lpNorm<::Eigen::Infinity>();
  for (Index i = 0; i < n_; ++i) {
    const Cell c = cell_[static_cast<std::size_t>(i)];
    if (c == Cell::Below)
      x_[i] = std::min(y[i], problem_.box.lower[i]) - scale * generic();
    else if (c == Cell::Above)
      x_[i] = std::max(y[i], problem_.box.upper[i]) + scale * generic();
    else
      x_[i] = y[i];
  }
}

/// -(the part of G that does not depend on x in the present cells).
Vec Path::constant() const {
  Vec bounds = Vec::Zero(n_);
  for (Index i = 0; i < n_; ++i)
    if (!inside(i))
      bounds[i] = cell_[static_cast<std::size_t>(i)] == Cell::Above ? problem_.box.upper[i] : problem_.box.lower[i];
  return bounds - problem_.q - problem_.M * bounds;
}

void Path::set_residual_column() {
  const Vec z = project(problem_.box, x_);
  const Vec r = problem_.M * z + problem_.q + x_ - z;
  std::copy_n(r.data(), n_, A_.valuePtr() + A_.outerIndexPtr()[2 * n_]);
}

/// The basis of all x_i in their present cells, t nonbasic.
LuStatus Path::factor_cells() {
  head_.resize(static_cast<std::size_t>(n_));
  for (Index i = 0; i < n_; ++i) head_[static_cast<std::size_t>(i)] = i;
  driver_ = n_;
  return factor_basis();
}

LuStatus Path::factor_basis() {
  std::vector<Index> columns(head_.size());
  std::transform(head_.begin(), head_.end(), columns.begin(), [this](Index i) { return column(i); });
  return factor_.factor(columns);
}

/// Factors the present basis afresh and recomputes the basic unknowns from the equations, which removes drift.
LuStatus Path::refactor() {
  const LuStatus status = factor_basis();
  if (status != LuStatus::Ok) return status;
  Vec rhs = constant() + Vec(A_.col(2 * n_));  // G(x) = r - t r
  rhs -= value(driver_) * Vec(A_.col(column(driver_)));
  Vec y(n_);
  factor_.ftran(rhs, y);
  for (Index p = 0; p < n_; ++p) value(head_[static_cast<std::size_t>(p)]) = y[p];
  return LuStatus::Ok;
}

/// d = B^-1 a of the driver's column: the basic unknowns move by -direction d a unit step. False if the basis is
/// singular.
bool Path::drive(Vec& d) {
  if ((distrusted_ || factor_.stale()) && refactor() != LuStatus::Ok) return false;
  distrusted_ = false;
  factor_.ftran(Vec(A_.col(column(driver_))), d);
  return d.allFinite();
}

/// Whether the rate of t is more than the rounding of d: with dt = 0 the equation  sum a_i dx_i + r dt = 0  of the
/// segment has the residual r dt, which is compared with the terms of the sum. On the ray of an infeasible
/// copositive-plus problem dt is zero (Cottle, Pang & Stone 1992, section 4.4).
bool Path::t_moves(double rate, const Vec& d) const {
  Vec terms = Vec(A_.col(column(driver_))).cwiseAbs();
  for (Index p = 0; p < n_; ++p)
    if (const Index i = head_[static_cast<std::size_t>(p)]; i != n_)
      terms += std::abs(d[p]) * A_.col(column(i)).cwiseAbs();
  const double rounding = 1e-12;
  return std::abs(rate) * Vec(A_.col(2 * n_)).lpNorm<::Eigen::Infinity>() > rounding * terms.maxCoeff();
}

/// Ratio test and move. False at the end of the path: t = 1, or a ray.
bool Path::advance(PivotResult& result, const Vec& d) {
  const double smallest = options_.pivot_tol * std::max(1.0, d.lpNorm<::Eigen::Infinity>());
  // t = 1 is the end: no basis has to be built on its pivot, however small - if it is more than rounding.
  const auto moves = [&](Index i, double rate) {
    return std::abs(rate) > smallest || (i == n_ && rate != 0 && t_moves(rate, d));
  };
  const auto room = [&](Index i, double rate) {  // how far unknown i may go at this rate, without tolerance
    const double bound = rate > 0 ? high(i) : low(i);
    return std::isinf(bound) ? infinity : std::max(0.0, rate > 0 ? bound - value(i) : value(i) - bound);
  };
  // Harris' first pass: the longest step with every bound relaxed by the tolerance.
  double longest = infinity;
  for (Index p = 0; p < n_; ++p) {
    const double rate = -direction_ * d[p];
    const Index i = head_[static_cast<std::size_t>(p)];
    if (!moves(i, rate)) continue;
    const double r = room(i, rate);
    if (std::isinf(r)) continue;
    const double bound = rate > 0 ? high(i) : low(i);
    longest = std::min(longest, (r + options_.feasibility_tol * (1 + std::abs(bound))) / std::abs(rate));
  }
  // Second pass: of those that block by then, t if it is among them, else the largest pivot.
  Index leaving = -1;
  double step = infinity;
  for (Index p = 0; p < n_; ++p) {
    const double rate = -direction_ * d[p];
    const Index i = head_[static_cast<std::size_t>(p)];
    if (!moves(i, rate)) continue;
    const double ratio = room(i, rate) / std::abs(rate);
    if (ratio > longest) continue;
    if (leaving < 0 || i == n_ ||
        (head_[static_cast<std::size_t>(leaving)] != n_ && std::abs(d[p]) > std::abs(d[leaving]))) {
      leaving = p;
      step = ratio;
    }
  }
  const double own = room(driver_, direction_);
  const bool driver_blocks = own <= step;
  if (driver_blocks) step = own;
  if (std::isinf(step)) {
    result.end = PivotEnd::Ray;
    result.ray = Vec::Zero(n_);
    for (Index p = 0; p < n_; ++p)
      if (const Index i = head_[static_cast<std::size_t>(p)]; i < n_) result.ray[i] = -direction_ * d[p];
    if (driver_ < n_) result.ray[driver_] = direction_;
    for (Index i = 0; i < n_; ++i) result.ray[i] *= inside(i) ? scaling_.columns[i] : 1 / scaling_.rows[i];
    return false;
  }
  for (Index p = 0; p < n_; ++p) value(head_[static_cast<std::size_t>(p)]) -= direction_ * step * d[p];
  value(driver_) += direction_ * step;
  ++result.pivots;

  if (driver_blocks) {  // the driver crosses its cell: no change of basis but in its own column
    if (driver_ == n_) {
      t_ = 1;
      return false;
    }
    cross(driver_, direction_);
    return !back_at_start(result);
  }
  const Index blocking = head_[static_cast<std::size_t>(leaving)];
  const double onward = -direction_ * d[leaving] > 0 ? 1 : -1;
  if (blocking == n_) t_ = 1;
  enter(leaving, d);
  driver_ = blocking;
  direction_ = onward;
  if (blocking == n_) return false;
  cross(blocking, onward);
  return !back_at_start(result);
}

bool Path::back_at_start(PivotResult& result) const {
  if (away_ > 0) return false;
  result.end = PivotEnd::Loop;
  return true;
}

/// The driver's column takes position p.
void Path::enter(Index p, const Vec& d) {
  head_[static_cast<std::size_t>(p)] = driver_;
  distrusted_ = factor_.replace(p, column(driver_), d) != BasisFactor::Update::Ok;
}

/// x_i passes from its cell into the next one in its direction.
void Path::cross(Index i, double direction) {
  Cell& cell = cell_[static_cast<std::size_t>(i)];
  const Cell home = start_[static_cast<std::size_t>(i)];
  if (cell == home) ++away_;
  if (cell == Cell::Inside) {
    x_[i] = direction > 0 ? problem_.box.upper[i] : problem_.box.lower[i];
    cell = direction > 0 ? Cell::Above : Cell::Below;
  } else {
    x_[i] = cell == Cell::Below ? problem_.box.lower[i] : problem_.box.upper[i];
    cell = Cell::Inside;
  }
  if (cell == home) --away_;
}

std::optional<PivotEnd> Path::limit(const PivotResult& result) const {
  if (options_.interrupted && options_.interrupted()) return PivotEnd::Interrupted;
  if (std::chrono::steady_clock::now() >= options_.deadline) return PivotEnd::TimeLimit;
  if (result.pivots >= options_.max_pivots) return PivotEnd::PivotLimit;
  return std::nullopt;
}

/// At t = 1: the zero of the last linear piece from a fresh factorization, if it is better than the point carried
/// along. Returns the reciprocal condition of that piece.
double Path::polish() {
  if (factor_cells() != LuStatus::Ok) return 0;
  Vec y(n_);
  Vec correction(n_);
  const Vec rhs = constant();
  factor_.ftran(rhs, y);
  factor_.ftran(factor_.residual(rhs, y), correction);
  for (const Vec& x : {y, Vec(y + correction)})
    if (x.allFinite() && judge(x) < judge(x_)) x_ = x;
  return factor_.rcond();
}

/// Fills in the point reached and judges it.
PivotResult Path::finish(PivotResult result) {
  const bool at_end = t_ == 1 && result.end != PivotEnd::Ray;
  if (at_end) result.rcond = polish();
  result.x = original(x_);
  result.z = project(original_.box, result.x);
  result.t = t_;
  result.residual = natural_residual(original_, result.z);
  const double scale = 1 + original_.q.lpNorm<::Eigen::Infinity>();
  const bool right = result.residual <= options_.residual_tol * scale;
  if (right)
    result.end = PivotEnd::Solved;
  else if (at_end)
    result.end = PivotEnd::Inaccurate;
  if (t_ >= result.best_t || right) {
    result.best_t = t_;
    result.best_x = result.x;
  }
  result.refactorizations = factor_.factorizations();
  return result;
}

PivotResult Path::follow() {
  PivotResult result;
  choose_cells(options_.start == LemkeStart::Ray);
  start_ = cell_;
  if (options_.start == LemkeStart::Regular) perturb();
  result.best_x = original(x_);
  if (factor_cells() != LuStatus::Ok || factor_.rcond() < options_.singular_rcond) {
    result.end = PivotEnd::SingularBasis;
    return finish(std::move(result));
  }
  if (options_.start == LemkeStart::Ray) place_outside();
  set_residual_column();

  Vec d(n_);
  for (;;) {
    if (options_.keep_path) result.path.push_back({t_, original(x_)});
    if (t_ > result.best_t) {
      result.best_t = t_;
      result.best_x = original(x_);
    }
    if (const auto end = limit(result)) {
      result.end = *end;
      break;
    }
    if (!drive(d)) {
      result.end = PivotEnd::SingularBasis;
      break;
    }
    if (!advance(result, d)) break;
  }
  if (options_.keep_path) result.path.push_back({t_, original(x_)});
  return finish(std::move(result));
}

}  // namespace

std::string_view to_string(PivotEnd end) {
  switch (end) {
    case PivotEnd::Solved:
      return "solved";
    case PivotEnd::Ray:
      return "ray";
    case PivotEnd::Loop:
      return "loop";
    case PivotEnd::SingularBasis:
      return "singular basis";
    case PivotEnd::PivotLimit:
      return "pivot limit";
    case PivotEnd::TimeLimit:
      return "time limit";
    case PivotEnd::Interrupted:
      return "interrupted";
    case PivotEnd::Inaccurate:
      return "inaccurate";
  }
  return "?";
}

PivotResult lemke(const AffineMcp& problem, In start, const LemkeOptions& options) {
  if (const auto why = problem.invalid()) throw std::invalid_argument("lemke: " + *why);
  std::ostringstream what;
  if (start.size() != problem.size()) {
    what << "lemke: the start has " << start.size() << " entries, the problem " << problem.size();
    throw std::invalid_argument(what.str());
  }
  for (Index i = 0; i < start.size(); ++i)
    if (!std::isfinite(start[i])) {
      what << "lemke: the start of index " << i << " is " << start[i];
      throw std::invalid_argument(what.str());
    }
  for (const auto& [name, value] : {std::pair{"residual_tol", options.residual_tol},
                                    {"pivot_tol", options.pivot_tol},
                                    {"feasibility_tol", options.feasibility_tol},
                                    {"perturbation", options.perturbation}})
    if (!(value >= 0) || std::isinf(value)) {
      what << "lemke: the option " << name << " is " << value << ", not a finite number >= 0";
      throw std::invalid_argument(what.str());
    }
  return Path(problem, start, options).follow();
}

}  // namespace perp::lcp
