// SPDX-License-Identifier: Apache-2.0
#include "lcp/linalg/block_triangular.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "lcp/exact_sum.hpp"

namespace perp::lcp {
namespace {

bool is_fixed(const Box& box, Index i) { return box.lower[i] == box.upper[i]; }

/// Tarjan's algorithm along the columns (j -> i where M_ij != 0) with an explicit stack. Components come out with
/// those that nothing depends on first.
class Tarjan {
 public:
  explicit Tarjan(const AffineMcp& problem)
      : problem_(problem), number_(at(problem.size()), 0), low_(number_), open_(at(problem.size()), 0) {}

  Components components() {
    for (Index j = 0; j < problem_.size(); ++j)
      if (number_[at(j)] == 0) search_from(j);
    return std::move(found_);
  }

 private:
  struct Frame {
    Index node;
    SpMat::InnerIterator next;
  };

  void open(Index j) {
    number_[at(j)] = low_[at(j)] = ++counter_;
    open_[at(j)] = 1;
    stack_.push_back(j);
    path_.push_back({j, SpMat::InnerIterator(problem_.M, j)});
  }

  void search_from(Index root) {
    open(root);
    while (!path_.empty()) {
      Frame& frame = path_.back();
      const Index j = frame.node;
      if (frame.next) {
        const Index i = frame.next.row();
        const bool dependence = frame.next.value() != 0 && !is_fixed(problem_.box, i);
        ++frame.next;
        if (!dependence) continue;
        if (number_[at(i)] == 0)
          open(i);  // frame dangles from here on
        else if (open_[at(i)] != 0)
          low_[at(j)] = std::min(low_[at(j)], number_[at(i)]);
        continue;
      }
      path_.pop_back();
      if (!path_.empty()) {
        Index& low = low_[at(path_.back().node)];
        low = std::min(low, low_[at(j)]);
      }
      if (low_[at(j)] == number_[at(j)]) close(j);
    }
  }

  void close(Index root) {
    for (Index i = -1; i != root;) {
      i = stack_.back();
      stack_.pop_back();
      open_[at(i)] = 0;
      found_.order.push_back(i);
    }
    found_.first.push_back(static_cast<Index>(found_.order.size()));
  }

  const AffineMcp& problem_;
  std::vector<Index> number_;  ///< in the order of discovery, from 1; 0: not seen
  std::vector<Index> low_;
  std::vector<char> open_;  ///< on stack_
  std::vector<Index> stack_;
  std::vector<Frame> path_;
  Index counter_ = 0;
  Components found_;
};

/// The reverse order, indices of a component ascending.
Components reversed(const Components& c) {
  Components out;
  for (Index k = c.count() - 1; k >= 0; --k) {
    out.order.insert(out.order.end(), c.order.begin() + c.first[at(k)], c.order.begin() + c.first[at(k + 1)]);
    std::sort(out.order.begin() + out.first.back(), out.order.end());
    out.first.push_back(static_cast<Index>(out.order.size()));
  }
  return out;
}

/// One run over the components.
class Sweep {
 public:
  Sweep(const AffineMcp& problem, In start, const ComponentSolver& solver, const Limits& limits)
      : problem_(problem),
        start_(start),
        solver_(solver),
        limits_(limits),
        q_(problem.q),
        z_(project(problem.box, start)),
        depends_(at(problem.size()), 0),
        position_(at(problem.size()), -1) {}

  Result run() {
    const Components c = strong_components(problem_);
    for (Index k = 0; k < c.count(); ++k) {
      const std::vector<Index> indices(c.order.begin() + c.first[at(k)], c.order.begin() + c.first[at(k + 1)]);
      const bool closed = closed_form(indices);
      if (!closed && !by_solver(indices, k, c.count())) break;
      pass_on(indices, closed);
    }
    Result result = judged(problem_, z_, limits_, failure_.status, failure_.message);
    if (!result.solved()) result.certificate = failure_.certificate;
    result.iterations = iterations_;
    result.factorizations = factorizations_;
    return result;
  }

 private:
  /// mid(l, -q / M_ii, u) if that is the one solution, but for rounding: then it is no ground for a proof.
  bool closed_form(const std::vector<Index>& indices) {
    const Index i = indices.front();
    if (indices.size() > 1) return false;
    if (is_fixed(problem_.box, i)) return true;
    const double m = problem_.M.coeff(i, i);
    const double z = -q_[i] / m;
    if (!(m > 0) || !std::isfinite(z)) return false;
    z_[i] = project(problem_.box, i, z);
    if (z_[i] == z && std::fma(m, z, q_[i]) != 0) depends_[at(i)] = 1;
    return true;
  }

  bool by_solver(const std::vector<Index>& indices, Index k, Index count) {
    if (const auto reached = limits_.reached()) {
      failure_ = {.status = *reached, .message = "stopped between two components", .z = {}};
      return false;
    }
    const AffineMcp part = component(indices);
    Vec start(part.size());
    for (Index i = 0; i < part.size(); ++i) start[i] = start_[indices[at(i)]];
    Result result = part.invalid() ? Result{.status = Status::Stalled, .message = "its data overflow", .z = start}
                                   : solver_(part, start, limits_);
    iterations_ += result.iterations;
    factorizations_ += result.factorizations;
    for (Index i = 0; i < part.size(); ++i) z_[indices[at(i)]] = result.z[i];
    if (!result.accepted()) fail(indices, result, k, count);
    return result.accepted();
  }

  AffineMcp component(const std::vector<Index>& indices) {
    const auto m = static_cast<Index>(indices.size());
    AffineMcp part{.M = SpMat(m, m), .q = Vec(m), .box = Box::free(m)};
    for (Index i = 0; i < m; ++i) position_[at(indices[at(i)])] = static_cast<int>(i);
    for (Index j = 0; j < m; ++j) {
      const Index whole = indices[at(j)];
      part.q[j] = q_[whole];
      part.box.lower[j] = problem_.box.lower[whole];
      part.box.upper[j] = problem_.box.upper[whole];
      part.M.startVec(j);
      for (SpMat::InnerIterator it(problem_.M, whole); it; ++it)
        if (const int row = position_[at(it.row())]; row >= 0) part.M.insertBack(row, j) = it.value();
    }
    part.M.finalize();
    for (const Index i : indices) position_[at(i)] = -1;
    return part;
  }

  void fail(const std::vector<Index>& indices, const Result& result, Index k, Index count) {
    std::ostringstream what;
    what << "component " << k + 1 << " of " << count << " (" << indices.size() << " variables, the first is "
         << indices.front() + 1 << "): " << to_string(result.status);
    if (!result.message.empty()) what << ": " << result.message;
    failure_.status = result.status;
    if (result.status == Status::Infeasible) {
      Vec y = Vec::Zero(problem_.size());
      if (result.certificate.size() > 0)
        for (std::size_t i = 0; i < indices.size(); ++i) y[indices[i]] = result.certificate[static_cast<Index>(i)];
      const bool forced = std::none_of(indices.begin(), indices.end(), [&](Index i) { return depends_[at(i)] != 0; });
      if (proves_infeasible(problem_, y))
        failure_.certificate = y;
      else if (!forced) {
        failure_.status = Status::Stalled;
        what << "; other solutions of the components before it might make it feasible";
      }
    }
    failure_.message = what.str();
  }

  /// Adds M_.j z_j to q; marks the rows that depend on a value that is not known to be the only one, or exact.
  void pass_on(const std::vector<Index>& indices, bool closed) {
    const bool certain = closed && (is_fixed(problem_.box, indices.front()) || depends_[at(indices.front())] == 0);
    for (const Index j : indices)
      for (SpMat::InnerIterator it(problem_.M, j); it; ++it) {
        const TwoParts product = two_product(it.value(), z_[j]);
        const TwoParts sum = two_sum(q_[it.row()], product.value);
        q_[it.row()] = sum.value;
        const bool rounded = product.error != 0 || sum.error != 0 || (product.value == 0 && z_[j] != 0);
        if ((!certain || rounded) && it.value() != 0) depends_[at(it.row())] = 1;
      }
  }

  const AffineMcp& problem_;
  In start_;
  const ComponentSolver& solver_;
  const Limits& limits_;
  Vec q_;  ///< with the solved components' M_.j z_j
  Vec z_;
  std::vector<char> depends_;  ///< on a solution that may not be the only one, or is rounded
  std::vector<int> position_;
  Result failure_{
      .status = Status::Stalled, .message = "the components' solutions do not fit together: rounding", .z = {}};
  long iterations_ = 0;
  int factorizations_ = 0;
};

}  // namespace

Components strong_components(const AffineMcp& problem) { return reversed(Tarjan(problem).components()); }

Result solve_by_components(const AffineMcp& problem, In start, const ComponentSolver& solver, const Limits& limits) {
  check_input("solve_by_components", problem, start, limits);
  if (!solver) throw std::invalid_argument("solve_by_components: there is no solver");
  return Sweep(problem, start, solver, limits).run();
}

}  // namespace perp::lcp
