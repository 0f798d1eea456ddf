// SPDX-License-Identifier: Apache-2.0
#include "lcp/qp/bound_qp.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "lcp/judge/shared_options.hpp"
#include "lcp/linalg/multilevel.hpp"
#include "lcp/qp/face_descent.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {
namespace {

using Kind = BoundQp::Preconditioner;
using End = Descent::End;

/// j is strong for i if -m_ij >= strength max_k -m_ik: Ruge & Stueben's 1/4.
constexpr double strength = 0.25;
/// Auto takes M for mostly negative if the positive entries off the diagonal add up to at most this share of all: a
/// plate on an obstacle (share 0.27, n = 40000) takes 1.1 s by Multilevel and 10 s by Cholesky.
constexpr double positive_share = 0.33;
/// Entries of the largest Cholesky factor: 2.4 GB.
constexpr double cholesky_entries = 2e8;
/// Reduction of the energy norm of the error on a face that may still change.
constexpr double loose = 0.1;
/// More conjugate gradient iterations than this on one face, and Multilevel gives way to Cholesky, that to GaussSeidel.
constexpr Index cg_limit = 200;
/// eps of the proximal points. Larger: fewer digits are lost in d'(M + eps D)d where M d = 0; smaller: fewer points, as
/// the error in an eigenvector to lambda (of D^-1 M) falls by eps / (lambda + eps) a point.
constexpr double proximal = 1e-8;
constexpr long proximal_limit = 200;

/// A: the columns of M, T: its rows. Entries as assembled twice may differ by rounding, of terms as large as those of
/// the diagonal.
std::string asymmetry(const SparseRows& A, const SparseRows& T, const Vec& d) {
  constexpr double rounding = 1e-13;
  const auto compare = [&](Index i, int j, double a, double b) -> std::string {
    const double scale = std::max({std::abs(a), std::abs(b), std::sqrt(std::abs(d[i] * d[j]))});
    if (std::abs(a - b) <= rounding * scale) return {};
    return text_of("M is not symmetric: its entry (", i + 1, ", ", j + 1, ") is ", b, ", the entry (", j + 1, ", ",
                   i + 1, ") is ", a);
  };
  for (int i = 0; i < A.rows(); ++i) {
    int s = A.start[at(i)];
    int t = T.start[at(i)];
    while (s < A.start[at(i) + 1] || t < T.start[at(i) + 1]) {
      const int j = s < A.start[at(i) + 1] ? A.column[at(s)] : A.rows();
      const int k = t < T.start[at(i) + 1] ? T.column[at(t)] : A.rows();
      std::string why = compare(i, std::min(j, k), j <= k ? A.value[at(s)] : 0, k <= j ? T.value[at(t)] : 0);
      if (!why.empty()) return why;
      if (j <= k) ++s;
      if (k <= j) ++t;
    }
  }
  return {};
}

Vec diagonal_of(const SparseRows& A) {
  Vec d = Vec::Zero(A.rows());
  for (int i = 0; i < A.rows(); ++i)
    for (int s = A.start[at(i)]; s < A.start[at(i) + 1]; ++s)
      if (A.column[at(s)] == i) d[i] += A.value[at(s)];
  return d;
}

bool sorted(const SparseRows& A) {
  for (int i = 0; i < A.rows(); ++i)
    if (!std::is_sorted(A.column.begin() + A.start[at(i)], A.column.begin() + A.start[at(i) + 1])) return false;
  return true;
}

bool mostly_negative(const SparseRows& A) {
  double positive = 0;
  double all = 0;
  for (int i = 0; i < A.rows(); ++i)
    for (int s = A.start[at(i)]; s < A.start[at(i) + 1]; ++s) {
      if (A.column[at(s)] == i) continue;
      all += std::abs(A.value[at(s)]);
      positive += std::max(0.0, A.value[at(s)]);
    }
  return all > 0 && positive <= positive_share * all;
}

class Solver {
 public:
  Solver(const AffineMcp& problem, In start, const BoundQp& options, const Limits& limits)
      : problem_(problem), start_(project(problem.box, start)), z_(start_), options_(options), limits_(limits) {}
  Result solve();

 private:
  bool take_matrix();
  bool fix_zero_rows();
  void prepare(Kind kind, double shift);
  Kind first_choice() const;
  double objective(const Vec& z) const;
  void nested_start();
  void clamp(const BoxQp& qp, Vec& z) const { z = z.cwiseMax(qp.lower).cwiseMin(qp.upper); }
  End descend(Vec& z);
  End proximal_points();
  bool certify(const Vec& d);
  double relative_residual() const;
  Result finish(Status otherwise, const std::string& message);

  const AffineMcp& problem_;
  Vec start_;
  Vec z_;
  const BoundQp& options_;
  const Limits& limits_;

  SparseRows A_;  // M
  Vec d_;         // its diagonal
  BoxQp qp_;
  Kind kind_ = Kind::Auto;
  double shift_ = 0;
  SparseRows shifted_;  // M + shift D, if there is a shift
  Vec shifted_d_;
  std::unique_ptr<Hierarchy> hierarchy_;
  std::unique_ptr<FacePreconditioner> B_;
  Descent descent_;
  long steps_ = 0;
  int factorizations_ = 0;
  Result early_;  // the answer, where there is one before the descent
  Vec certificate_;
};

/// M by rows with its diagonal; false if bound_qp does not apply, with the reason in early_.
bool Solver::take_matrix() {
  A_ = rows_of(problem_.M);
  SparseRows T = A_.transposed(A_.rows());  // sorted rows, which what follows needs
  if (!sorted(A_)) A_ = T.transposed(A_.rows());
  d_ = diagonal_of(A_);
  const auto refuse = [&](const std::string& why) {
    early_ = finish(Status::NotApplicable, why);
    return false;
  };
  const std::string why = asymmetry(A_, T, d_);
  if (!why.empty()) return refuse(why);
  if (A_.column == T.column && A_.value != T.value)
    for (std::size_t s = 0; s < A_.value.size(); ++s) A_.value[s] = 0.5 * (A_.value[s] + T.value[s]);
  for (int i = 0; i < A_.rows(); ++i) {
    if (d_[i] > 0) continue;
    if (d_[i] < 0) return refuse(text_of("M is not positive semidefinite: its diagonal entry ", i + 1, " is ", d_[i]));
    for (int s = A_.start[at(i)]; s < A_.start[at(i) + 1]; ++s) {
      if (A_.value[at(s)] == 0) continue;
      return refuse(text_of("M is not positive semidefinite: its diagonal entry ", i + 1, " is 0, but not its entry (",
                            i + 1, ", ", A_.column[at(s)] + 1, "), ", A_.value[at(s)]));
    }
  }
  return true;
}

/// Unknowns that M does not know go where q_i sends them; false if that is to infinity.
bool Solver::fix_zero_rows() {
  qp_.q = problem_.q;
  qp_.lower = problem_.box.lower;
  qp_.upper = problem_.box.upper;
  for (Index i = 0; i < d_.size(); ++i) {
    if (d_[i] > 0) continue;
    const double q = problem_.q[i];
    if (q != 0) z_[i] = q > 0 ? qp_.lower[i] : qp_.upper[i];
    if (!std::isfinite(z_[i])) {
      z_[i] = start_[i];
      early_ = finish(Status::Stalled,
                      text_of("row ", i + 1, " of M is 0, q is ", q, " and nothing bounds the variable on that side"));
      certify(Vec::Unit(d_.size(), i) * (q > 0 ? -1 : 1));
      if (certificate_.size() > 0 && !early_.solved()) {
        early_.status = Status::Infeasible;
        early_.certificate = certificate_;
      }
      return false;
    }
    start_[i] = qp_.lower[i] = qp_.upper[i] = z_[i];
  }
  return true;
}

Kind Solver::first_choice() const {
  if (options_.preconditioner != Kind::Auto) return options_.preconditioner;
  return A_.rows() > options_.direct && mostly_negative(A_) ? Kind::Multilevel : Kind::Cholesky;
}

void Solver::prepare(Kind kind, double shift) {
  if (B_) factorizations_ += B_->factorizations;
  B_.reset();
  kind_ = kind;
  shift_ = shift;
  shifted_d_ = (1 + shift) * d_;
  if (shift > 0) {
    shifted_ = A_;
    for (int i = 0; i < A_.rows(); ++i)
      for (int s = A_.start[at(i)]; s < A_.start[at(i) + 1]; ++s)
        if (A_.column[at(s)] == i) shifted_.value[at(s)] *= 1 + shift;
  }
  const SparseRows& A = shift > 0 ? shifted_ : A_;
  qp_.A = &A;
  qp_.diagonal = &shifted_d_;
  qp_.q = problem_.q - shift * d_.cwiseProduct(z_);
  hierarchy_.reset();
  if (kind == Kind::Cholesky) {
    B_ = std::make_unique<CholeskyFace>(A, cholesky_entries);
    return;
  }
  const auto direct = static_cast<int>(std::min<Index>(options_.direct, A.rows()));
  hierarchy_ = std::make_unique<Hierarchy>(A, strength, kind == Kind::Multilevel ? direct : A.rows());
  B_ = std::make_unique<VCycle>(*hierarchy_, 0, kind == Kind::Multilevel ? direct : 0);
}

double Solver::objective(const Vec& z) const {
  Vec Mz(z.size());
  A_.multiply(z, Mz);
  return z.dot(0.5 * Mz + problem_.q);
}

/// Solves the problem for coarse unknowns c, z = P c, bounds those of the C points, from the coarsest grid to the
/// finest but one, each from the solution before; takes what comes out as the start if phi is lower there.
void Solver::nested_start() {
  if (kind_ != Kind::Multilevel || !options_.nested) return;
  const auto& grids = hierarchy_->grids;
  std::vector<BoxQp> qps{qp_};
  std::vector<Vec> given{z_};
  for (std::size_t k = 1; k < grids.size(); ++k) {
    const auto& points = grids[k - 1].c_points;
    const auto n = static_cast<Index>(points.size());
    BoxQp qp{.A = &grids[k].A, .diagonal = &grids[k].diagonal, .q = Vec(n), .lower = Vec(n), .upper = Vec(n)};
    grids[k - 1].R.multiply(qps.back().q, qp.q);
    Vec c(n);
    for (Index I = 0; I < n; ++I) {
      qp.lower[I] = qps.back().lower[points[at(I)]];
      qp.upper[I] = qps.back().upper[points[at(I)]];
      c[I] = given.back()[points[at(I)]];
    }
    qps.push_back(std::move(qp));
    given.push_back(std::move(c));
  }
  const auto direct = static_cast<int>(std::min<Index>(options_.direct, A_.rows()));
  Vec z = given.back();
  for (std::size_t k = grids.size(); k-- > 0;) {
    if (k + 1 < grids.size()) {
      Vec fine(qps[k].q.size());
      grids[k].P.multiply(z, fine);
      z = std::move(fine);
      clamp(qps[k], z);
    }
    if (k == 0 || limits_.reached()) continue;
    VCycle B(*hierarchy_, k, direct);
    // The face of the coarsest grid is found from any start; after that it settles within two to four steps.
    Descent coarse{.settle_only = true,
                   .loose = loose,
                   .step_limit = k + 1 == grids.size() ? options_.step_limit : 20,
                   .cg_limit = cg_limit,
                   .limits = &limits_};
    coarse.run(qps[k], B, z);
    factorizations_ += B.factorizations;
    if (!z.allFinite()) z = given[k];
  }
  for (Index i = 0; i < z.size(); ++i)
    if (!(d_[i] > 0)) z[i] = z_[i];
  if (z.allFinite() && objective(z) < objective(z_)) z_ = std::move(z);
}

End Solver::descend(Vec& z) {
  descent_ = Descent{.loose = loose,
                     .step_limit = options_.step_limit - steps_,
                     .cg_limit = kind_ == Kind::GaussSeidel ? std::max(10 * z.size(), cg_limit) : cg_limit,
                     .limits = &limits_};
  const End end = descent_.run(qp_, *B_, z);
  steps_ += descent_.steps;
  return end;
}

/// max_i |M z + q|_i / (|M| |z| + |q|)_i over what the box leaves of M z + q.
double Solver::relative_residual() const {
  double worst = 0;
  for (int i = 0; i < A_.rows(); ++i) {
    double sum = problem_.q[i];
    double size = std::abs(sum);
    for (int s = A_.start[at(i)]; s < A_.start[at(i) + 1]; ++s) {
      const double term = A_.value[at(s)] * z_[A_.column[at(s)]];
      sum += term;
      size += std::abs(term);
    }
    if (!(d_[i] > 0) || size == 0) continue;
    const double moved = z_[i] - project(problem_.box, i, z_[i] - sum / d_[i]);
    worst = std::max(worst, std::abs(moved) * d_[i] / size);
  }
  return worst;
}

/// z+ solves the problem with M + eps D, q - eps D z.
End Solver::proximal_points() {
  constexpr double rounding = 1e-15;
  double previous = infinity;
  int slow = 0;
  for (long k = 0; k < proximal_limit; ++k) {
    Vec next = z_;
    qp_.q = problem_.q - shift_ * d_.cwiseProduct(z_);
    const End end = descend(next);
    if (end != End::Solved) return end;
    const Vec step = next - z_;
    z_ = std::move(next);
    if (relative_residual() <= rounding) return End::Solved;
    const double length = std::sqrt(step.cwiseAbs2().dot(d_));
    if (!std::isfinite(length)) return End::Limit;
    if (!(length < 0.5 * previous)) {
      if (certify(step)) return End::Flat;
      if (accepts(problem_, z_, limits_.tol)) return End::Solved;
      // Eigenvalues about eps: a smaller one, while it is told from zero.
      if (++slow % 3 == 0 && shift_ > 1e-11) prepare(kind_, shift_ / 10);
    }
    previous = length;
  }
  return End::Limit;
}

/// Whether d, made a direction of the box and of M's null space, proves that there is no solution: certificate_.
bool Solver::certify(const Vec& d) {
  const Box& box = problem_.box;
  Vec y = d / std::max(d.lpNorm<::Eigen::Infinity>(), 1e-300);
  for (int round = 0; round < 4; ++round) {
    for (Index i = 0; i < y.size(); ++i) {
      const bool below = box.lower[i] > -infinity;
      const bool above = box.upper[i] < infinity;
      if (std::abs(y[i]) < 1e-10 || (below && y[i] < 0) || (above && y[i] > 0)) y[i] = 0;
    }
    certificate_ = exact_certificate(problem_, y, limits_.tol);
    if (certificate_.size() > 0) return true;
    if (!(problem_.q.dot(y) < 0) || !B_ || shift_ == 0) return false;
    // (M + eps D) w = eps D y on the support of y leaves of y its part in the null space.
    BoxQp null = qp_;
    null.q = -shift_ * d_.cwiseProduct(y);
    for (Index i = 0; i < y.size(); ++i) {
      null.lower[i] = y[i] == 0 ? 0 : -infinity;
      null.upper[i] = y[i] == 0 ? 0 : infinity;
    }
    Descent project{.loose = loose, .step_limit = 20, .cg_limit = cg_limit, .limits = &limits_};
    project.run(null, *B_, y);
    const double largest = y.lpNorm<::Eigen::Infinity>();
    if (!(largest > 0) || !std::isfinite(largest)) return false;
    y /= largest;
  }
  return false;
}

Result Solver::finish(Status otherwise, const std::string& message) {
  if (!z_.allFinite()) z_ = start_;
  Result result = judged(problem_, z_, limits_, otherwise, message);
  result.iterations = steps_;
  result.factorizations = factorizations_ + (B_ ? B_->factorizations : 0);
  return result;
}

Result Solver::solve() {
  if (!take_matrix() || !fix_zero_rows()) return early_;
  prepare(first_choice(), 0);
  nested_start();
  for (;;) {
    const Vec before = z_;
    const End end = shift_ == 0 ? descend(z_) : proximal_points();
    const bool fell = z_.allFinite() && objective(z_) <= objective(before);
    if (!fell && shift_ == 0) z_ = before;
    switch (end) {
      case End::Solved:
      case End::Settled:
        if (shift_ > 0 || accepts(problem_, z_, limits_.tol))
          return finish(Status::Stalled, "no more digits: the residual is at the level of rounding");
        z_ = before;  // which may have gone far along a flat direction
        prepare(kind_, proximal);
        break;
      case End::NegativeCurvature:
        if (const Curvature c = curvature(A_, descent_.direction / descent_.direction.norm()); c.negative())
          return finish(Status::NotApplicable, text_of("M is not positive semidefinite: d'M d = ", c.value,
                                                       " with a direction d of length 1"));
        [[fallthrough]];
      case End::Flat:
        if (certificate_.size() > 0) {
          Result result =
              finish(Status::Infeasible, "q'd < 0 for the direction d of the box, M d = 0: phi falls forever");
          if (result.status == Status::Infeasible) result.certificate = certificate_;
          return result;
        }
        if (shift_ > 0) return finish(Status::Stalled, "M + eps D is singular up to rounding on a face");
        z_ = before;
        prepare(kind_, proximal);
        nested_start();
        break;
      case End::Slow:
      case End::OutOfMemory:
        if (kind_ == Kind::GaussSeidel) return finish(Status::Stalled, "conjugate gradients do not converge on a face");
        prepare(kind_ == Kind::Multilevel ? Kind::Cholesky : Kind::GaussSeidel, shift_);
        break;
      case End::Limit:
        return finish(steps_ >= options_.step_limit ? Status::IterationLimit : Status::Stalled,
                      text_of("after ", steps_, " steps the residual is ", natural_residual(problem_, z_)));
      case End::Stopped:
        return finish(limits_.reached().value_or(Status::Interrupted), "stopped");
    }
  }
}

}  // namespace

void describe(BoundQp& m, Fields& f) {
  using P = BoundQp::Preconditioner;
  f.choice(
      "qp_preconditioner", &m.preconditioner,
      {{"auto", P::Auto}, {"multilevel", P::Multilevel}, {"cholesky", P::Cholesky}, {"gauss-seidel", P::GaussSeidel}},
      "preconditioner of the conjugate gradients on a face");
  describe_iterations(m.step_limit, f);
  f.add("qp.direct", &m.direct, at_least(1), {});
}

Result bound_qp(const AffineMcp& problem, In start, const BoundQp& options, const Limits& limits) {
  check_input("bound_qp", problem, start, limits);
  refuse_invalid("bound_qp", options);
  return Solver(problem, start, options, limits).solve();
}

}  // namespace perp::lcp
