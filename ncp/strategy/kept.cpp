// SPDX-License-Identifier: Apache-2.0
#include "ncp/strategy/kept.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>
#include <vector>

#include "lcp/exact_sum.hpp"
#include "lcp/lu/refactored_lu.hpp"
#include "ncp/reformulation/normal_map.hpp"

namespace perp::ncp {
namespace {

using lcp::Cell;

/// Newton steps, and changes of the active set among them.
constexpr int most_steps = 25;
constexpr int most_exchanges = 12;
/// Without a change, Newton's method on a neighbour has to gain this each time.
constexpr double gains = 0.5;

bool same_pattern_as(const SpMat& A, const SpMat& B) {
  return A.rows() == B.rows() && A.nonZeros() == B.nonZeros() &&
         std::equal(A.outerIndexPtr(), A.outerIndexPtr() + A.outerSize() + 1, B.outerIndexPtr()) &&
         std::equal(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros(), B.innerIndexPtr());
}

/// The entries of a pattern by rows.
struct RowWise {
  std::vector<Index> start, column, place;

  explicit RowWise(const SpMat& A) : start(at(A.rows()) + 1), column(at(A.nonZeros())), place(at(A.nonZeros())) {
    for (Index k = 0; k < A.nonZeros(); ++k) ++start[at(A.innerIndexPtr()[k]) + 1];
    for (std::size_t i = 1; i < start.size(); ++i) start[i] += start[i - 1];
    std::vector<Index> next(start.begin(), start.end() - 1);
    for (Index j = 0; j < A.cols(); ++j)
      for (Index k = A.outerIndexPtr()[j]; k < A.outerIndexPtr()[j + 1]; ++k) {
        const auto to = at(next[at(A.innerIndexPtr()[k])]++);
        column[to] = j;
        place[to] = k;
      }
  }
};

}  // namespace

struct KeptSolver::Impl {
  explicit Impl(Method m) : method(std::move(m)) {}

  Method method;
  By by = By::Anew;
  bool known = false;  // there is a solution to begin from
  Result result;

  // Of the last solution.
  Vec x, F, q, zero;
  SpMat J;
  std::vector<Cell> cells;
  std::unique_ptr<RowWise> rows;

  // J_II, its entries' places in J, and its factors.
  std::vector<Index> inside, position, from;
  SpMat C;
  Vec step;
  lcp::RefactoredLu lu;
  bool factored = false;  // of this set I

  double tol() const { return stop(method).tol; }
  bool fits(const Mcp& mcp) const { return known && same_pattern_as(mcp.jacobian_pattern(), J); }
  void place(const Box& box);
  bool evaluate(const Mcp& mcp);
  void choose_inside();
  bool factor();
  bool newton_step(const Box& box, bool& changed);
  bool exchange(const Box& box);
  bool follow(const Mcp& mcp);
  void remember(const Mcp& mcp);
  void answer(int steps);
};

/// The last solution in this box, its variables at the bounds of their cells.
void KeptSolver::Impl::place(const Box& box) {
  for (Index i = 0; i < x.size(); ++i) {
    Cell& cell = cells[at(i)];
    if (box.lower[i] == box.upper[i]) cell = Cell::Fixed;
    const bool gone = (cell == Cell::Below && box.lower[i] == -infinity) ||
                      (cell == Cell::Above && box.upper[i] == infinity) ||
                      (cell == Cell::Fixed && box.lower[i] < box.upper[i]);
    if (gone) {
      cell = Cell::Inside;
      factored = false;
    }
    if (cell == Cell::Below || cell == Cell::Fixed)
      x[i] = box.lower[i];
    else if (cell == Cell::Above)
      x[i] = box.upper[i];
    else
      x[i] = lcp::project(box, i, x[i]);
  }
}

/// F and J; F of affine problems in sums without rounding errors, which is what the judge knows them by.
bool KeptSolver::Impl::evaluate(const Mcp& mcp) {
  ++result.stats.F_evals;
  if (!mcp.is_affine()) return mcp.eval(x, F) && F.allFinite();
  lcp::ExactSum sum;
  for (Index i = 0; i < x.size(); ++i) {
    sum = {};
    sum.add(q[i]);
    for (auto k = at(rows->start[at(i)]); k < at(rows->start[at(i) + 1]); ++k)
      sum.add_product(J.valuePtr()[rows->place[k]], x[rows->column[k]]);
    F[i] = sum.value();
  }
  return F.allFinite();
}

void KeptSolver::Impl::choose_inside() {
  const Index n = x.size();
  inside.clear();
  position.assign(at(n), -1);
  for (Index i = 0; i < n; ++i) {
    if (cells[at(i)] != Cell::Inside) continue;
    position[at(i)] = static_cast<Index>(inside.size());
    inside.push_back(i);
  }
  const auto m = static_cast<Index>(inside.size());
  C.resize(m, m);
  from.clear();
  for (Index k = 0; k < m; ++k) {
    C.startVec(k);
    const Index j = inside[at(k)];
    for (Index e = J.outerIndexPtr()[j]; e < J.outerIndexPtr()[j + 1]; ++e)
      if (const Index row = position[at(J.innerIndexPtr()[e])]; row >= 0) {
        C.insertBack(row, k) = 0;
        from.push_back(e);
      }
  }
  C.finalize();
  step.resize(m);
}

/// J_II in the order of the last factors, or in a new one where I is another set or the old pivots no longer do.
bool KeptSolver::Impl::factor() {
  const bool again = std::exchange(factored, true);
  if (!again) choose_inside();
  for (std::size_t k = 0; k < from.size(); ++k) C.valuePtr()[k] = J.valuePtr()[from[k]];
  ++result.stats.factorizations;
  if (again && lu.refactor(C)) return true;
  factored = lu.factor(C) == lcp::LuStatus::Ok;
  return factored;
}

bool KeptSolver::Impl::newton_step(const Box& box, bool& changed) {
  if (!factor()) return false;
  for (std::size_t k = 0; k < inside.size(); ++k) step[static_cast<Index>(k)] = -F[inside[k]];
  lu.solve(step);
  if (!step.allFinite()) return false;
  for (std::size_t k = 0; k < inside.size(); ++k) {
    const Index i = inside[k];
    x[i] += step[static_cast<Index>(k)];
    if (x[i] >= box.lower[i] && x[i] <= box.upper[i]) continue;
    const bool below = x[i] < box.lower[i];
    x[i] = below ? box.lower[i] : box.upper[i];
    cells[at(i)] = below ? Cell::Below : Cell::Above;
    changed = true;
  }
  return true;
}

/// Inside comes what F pushes off its bound.
bool KeptSolver::Impl::exchange(const Box& box) {
  bool changed = false;
  for (Index i = 0; i < x.size(); ++i) {
    Cell& cell = cells[at(i)];
    const bool leaves = (cell == Cell::Below && F[i] < 0) || (cell == Cell::Above && F[i] > 0);
    if (!leaves || lcp::row_residual(box, i, x[i], F[i]) <= tol()) continue;
    cell = Cell::Inside;
    changed = true;
  }
  return changed;
}

/// From the last active set; false: no solution was found so.
bool KeptSolver::Impl::follow(const Mcp& mcp) {
  const Box& box = mcp.box();
  place(box);
  if (mcp.is_affine() && !mcp.eval(zero, q)) return false;
  if (!mcp.jacobian(x, J)) return false;
  double last = infinity;
  int exchanges = 0;
  bool changed = false;
  for (int k = 0; k <= most_steps; ++k) {
    if (!evaluate(mcp)) return false;
    const Residual now = residual(box, x, F);
    if (now.natural <= tol()) {
      by = exchanges > 0 ? By::Exchanges : By::Kept;
      result.residual = now;
      answer(k);
      return true;
    }
    if (k > 0) changed = exchange(box) || changed;
    if (changed) {
      factored = false;
      last = infinity;
      if (++exchanges > most_exchanges) return false;
    } else if (!(now.natural <= gains * last)) {
      return false;
    } else {
      last = now.natural;
    }
    changed = false;
    if (k > 0 && !mcp.is_affine()) {
      ++result.stats.J_evals;
      if (!mcp.jacobian(x, J)) return false;
    }
    if (!newton_step(box, changed)) return false;
  }
  return false;
}

void KeptSolver::Impl::answer(int steps) {
  result.status = Status::Solved;
  result.message = "solution found from the last one";
  result.advice.clear();
  result.notes.clear();
  result.x = x;
  result.F = F;
  result.relative = std::numeric_limits<double>::quiet_NaN();
  result.relative_row = -1;
  result.basis = cells;
  result.stats.iterations = steps;
}

/// What the next solve begins from.
void KeptSolver::Impl::remember(const Mcp& mcp) {
  known = result.accepted();
  factored = false;
  if (!known) return;
  x = result.x;
  F = result.F;
  q.resize(x.size());
  zero = Vec::Zero(x.size());
  if (rows == nullptr || !same_pattern_as(mcp.jacobian_pattern(), J)) {
    J = mcp.jacobian_pattern();
    rows = std::make_unique<RowWise>(J);
  }
  cells = static_cast<Index>(result.basis.size()) == x.size() ? result.basis : cells_at(mcp.box(), x);
}

KeptSolver::KeptSolver(Method method) : impl_(std::make_unique<Impl>(std::move(method))) {}
KeptSolver::~KeptSolver() = default;
KeptSolver::KeptSolver(KeptSolver&&) noexcept = default;
KeptSolver& KeptSolver::operator=(KeptSolver&&) noexcept = default;

KeptSolver::By KeptSolver::by() const { return impl_->by; }
void KeptSolver::forget() { impl_->known = false; }

const Result& KeptSolver::solve(const Mcp& mcp, In x0) {
  Impl& s = *impl_;
  if (s.fits(mcp)) {
    const auto begin = std::chrono::steady_clock::now();
    s.result.stats = {};
    const bool solved = s.follow(mcp);
    s.result.stats.time = std::chrono::steady_clock::now() - begin;
    if (solved) return s.result;
    const PathSearch* own = path_of(s.method);
    PathSearch path = own != nullptr ? *own : PathSearch{};
    path.stop = stop(s.method);
    path.crash.on = false;
    s.by = By::Path;
    if (static_cast<Index>(s.result.basis.size()) == mcp.size()) {
      const Vec last = lcp::project(mcp.box(), s.result.x);
      Result warm = ncp::solve(mcp, last, path, {}, s.result.basis);
      if (warm.accepted()) {
        s.result = std::move(warm);
        s.remember(mcp);
        return s.result;
      }
    }
  }
  s.by = By::Anew;
  s.result = ncp::solve(mcp, x0, s.method);
  s.remember(mcp);
  return s.result;
}

std::string_view to_string(KeptSolver::By by) {
  switch (by) {
    case KeptSolver::By::Kept:
      return "kept";
    case KeptSolver::By::Exchanges:
      return "exchanges";
    case KeptSolver::By::Path:
      return "path";
    case KeptSolver::By::Anew:
      return "anew";
  }
  return "?";
}

}  // namespace perp::ncp
