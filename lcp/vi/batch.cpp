// SPDX-License-Identifier: Apache-2.0
#include "lcp/vi/batch.hpp"

#include <limits>
#include <memory>
#include <optional>

#include "lcp/judge/dense_judge.hpp"
#include "lcp/solve/dense.hpp"
#include "lcp/threads.hpp"

namespace perp::lcp {
namespace {

using ByRows = Eigen::Map<const FacePivoting::Rows>;
using Values = Eigen::Map<const Vec>;

/// Solves one thread's instances, and keeps its memory.
class Worker {
 public:
  Worker(const ViBatch& batch, const BatchAnswers& answers, const Limits& limits)
      : batch_(batch), answers_(answers), limits_(limits) {}

  void solve(Index k) {
    if (batch_.m == 0)
      solve_in_box(k);
    else
      solve_in_polyhedron(k);
  }

 private:
  Box rows(Index k) const { return {Values(batch_.b.of(k), batch_.m), Values(batch_.c.of(k), batch_.m)}; }
  Box box(Index k) const { return {Values(batch_.l.of(k), batch_.n), Values(batch_.u.of(k), batch_.n)}; }

  void solve_in_box(Index k) {
    const Index n = batch_.n;
    const Eigen::Map<const Eigen::MatrixXd, 0, Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>> M(
        batch_.M.of(k), n, n, Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>(1, n));
    dense_.forget();
    const Result& r =
        dense_.solve(M, Values(batch_.q.of(k), n), Values(batch_.l.of(k), n), Values(batch_.u.of(k), n), limits_);
    put(k, r.z, {}, r.status, r.residual);
  }

  void solve_in_polyhedron(Index k) {
    const Index n = batch_.n, m = batch_.m;
    const bool new_M = batch_.M.step != 0 || !projector_, new_A = batch_.A.step != 0 || !projector_;
    if (new_A) projector_.emplace(Polyhedron{SpMat(ByRows(batch_.A.of(k), m, n).sparseView()), rows(k), box(k)});
    if (new_M) problem_ = {ByRows(batch_.M.of(k), n, n), Vec(n), Box::free(n)};
    if (new_A || new_M) pivoting_.prepare(&problem_.M, projector_->dense());
    problem_.q = Values(batch_.q.of(k), n);
    projector_->set_sides(rows(k), box(k));
    const Polyhedron& C = projector_->polyhedron();
    Face face;
    const auto end = problem_.M.allFinite() && problem_.q.allFinite()
                         ? pivoting_.run(problem_.q, C.rows, C.box, face, limits_)
                         : FacePivoting::End::Stopped;
    if (end == FacePivoting::End::Found) {
      const Vec& x = pivoting_.x();
      const ViResult r = judge_affine_vi(*projector_, x, judge(problem_, x), std::move(face), limits_);
      if (r.accepted()) return put(k, r.x, r.multipliers, r.status, r.residual);
    }
    const ViResult r = solve_vi({problem_.M.sparseView(), problem_.q, C}, {}, limits_);
    put(k, r.x, r.multipliers, r.status, r.residual);
  }

  void put(Index k, const Vec& x, const Vec& multipliers, Status status, double residual) const {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    const auto write = [&](std::span<double> to, Index size, const Vec& from) {
      if (to.empty()) return;
      Eigen::Map<Vec> place(to.data() + k * size, size);
      if (from.size() == size)
        place = from;
      else
        place.setConstant(none);
    };
    write(answers_.x, batch_.n, x);
    write(answers_.multipliers, batch_.m, multipliers);
    if (!answers_.status.empty()) answers_.status[at(k)] = status;
    if (!answers_.residual.empty()) answers_.residual[at(k)] = residual;
  }

  const ViBatch& batch_;
  const BatchAnswers& answers_;
  const Limits& limits_;
  DenseSolver dense_{};
  DenseMcp problem_{};
  FacePivoting pivoting_{};
  std::optional<Projector> projector_{};
};

}  // namespace

void solve_batch(const ViBatch& batch, const BatchAnswers& answers, int threads, const Limits& limits) {
  in_threads(batch.count, threads, [&] {
    const auto worker = std::make_shared<Worker>(batch, answers, limits);
    return [worker](Index k) { worker->solve(k); };
  });
}

}  // namespace perp::lcp
