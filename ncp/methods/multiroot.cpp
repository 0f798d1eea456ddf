// SPDX-License-Identifier: Apache-2.0
#include "ncp/methods/multiroot.hpp"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_multiroots.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <new>

#include "lcp/memory.hpp"
#include "ncp/methods/gsl_errors.hpp"
#include "ncp/reformulation/smoothing_function.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {
namespace {

using Map = Eigen::Map<Vec, 0, Eigen::InnerStride<>>;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct Free {
  void operator()(gsl_multiroot_fdfsolver* s) const { gsl_multiroot_fdfsolver_free(s); }
  void operator()(gsl_vector* v) const { gsl_vector_free(v); }
  void operator()(gsl_permutation* p) const { gsl_permutation_free(p); }
};

/// What GSL has made, or std::bad_alloc.
template <class T>
std::unique_ptr<T, Free> made(T* object) {
  if (object == nullptr) throw std::bad_alloc();
  return std::unique_ptr<T, Free>(object);
}

Vec to_vec(const gsl_vector* v) {
  return Eigen::Map<const Vec, 0, Eigen::InnerStride<>>(v->data, static_cast<Index>(v->size),
                                                        Eigen::InnerStride<>(static_cast<Index>(v->stride)));
}

const gsl_multiroot_fdfsolver_type* type_of(MultirootSolver solver) {
  switch (solver) {
    case MultirootSolver::Hybridsj:
      return gsl_multiroot_fdfsolver_hybridsj;
    case MultirootSolver::Hybridj:
      return gsl_multiroot_fdfsolver_hybridj;
    case MultirootSolver::Newton:
      return gsl_multiroot_fdfsolver_newton;
    case MultirootSolver::Gnewton:
      return gsl_multiroot_fdfsolver_gnewton;
  }
  return gsl_multiroot_fdfsolver_hybridsj;
}

/// What GSL calls: Phi_mu and its Jacobian, and why the last call failed.
class System {
 public:
  enum class Trouble { None, Undefined, NotFinite, Singular };

  System(Run& run, MultirootSolver solver, Index n)
      : run_(run),
        smoothing_(smoothed_fischer_burmeister()),
        factors_(solver == MultirootSolver::Newton || solver == MultirootSolver::Gnewton),
        n_(n),
        permutation_(factors_ ? made(gsl_permutation_alloc(static_cast<std::size_t>(n))) : nullptr) {
    gsl_.f = [](const gsl_vector* x, void* self, gsl_vector* f) { return static_cast<System*>(self)->value(x, f); };
    gsl_.df = [](const gsl_vector* x, void* self, gsl_matrix* J) { return static_cast<System*>(self)->jacobian(x, J); };
    gsl_.fdf = [](const gsl_vector* x, void* self, gsl_vector* f, gsl_matrix* J) {
      auto* system = static_cast<System*>(self);
      const int status = system->value(x, f);
      return status == GSL_SUCCESS ? system->jacobian(x, J) : status;
    };
    gsl_.n = static_cast<std::size_t>(n);
    gsl_.params = this;
  }

  gsl_multiroot_function_fdf* gsl() { return &gsl_; }
  double mu = 0;
  Trouble trouble() const { return trouble_; }
  /// The point evaluated last, with F there.
  const Point& last() const { return last_; }
  bool evaluate(const Vec& x) {
    if (last_.x.size() == x.size() && last_.x == x && last_.F.size() == n_) return true;
    last_.x = x;
    const bool defined = x.allFinite() && run_.counted().eval(last_.x, last_.F);
    if (!defined) {
      trouble_ = x.allFinite() ? Trouble::Undefined : Trouble::NotFinite;
      last_.x.resize(0);
    }
    return defined;
  }
  /// Exceptions must not cross GSL's frames.
  void rethrow() const {
    if (thrown_) std::rethrow_exception(thrown_);
  }

 private:
  template <class Work>
  int guarded(Work work) noexcept {
    const GslCallback callback;
    trouble_ = Trouble::None;
    try {
      return work() ? GSL_SUCCESS : GSL_EBADFUNC;
    } catch (...) {
      thrown_ = std::current_exception();
      return GSL_EBADFUNC;
    }
  }

  int value(const gsl_vector* x, gsl_vector* f) noexcept {
    return guarded([&] {
      if (!evaluate(to_vec(x))) return false;
      Vec Phi(n_);
      reformulate(smoothing_, run_.box(), last_.x, last_.F, mu, Phi);
      Map(f->data, n_, Eigen::InnerStride<>(static_cast<Index>(f->stride))) = Phi;
      return finite(Phi.allFinite());
    });
  }

  int jacobian(const gsl_vector* x, gsl_matrix* J) noexcept {
    return guarded([&] {
      if (!evaluate(to_vec(x))) return false;
      if (!run_.counted().jacobian(last_.x, last_.J)) {
        trouble_ = Trouble::Undefined;
        return false;
      }
      reformulate(smoothing_, run_.box(), last_.x, last_.F, mu, at_);
      RowMajor H = RowMajor::Zero(n_, n_);
      for (Index j = 0; j < n_; ++j)
        for (SpMat::InnerIterator it(last_.J, j); it; ++it) H(it.row(), j) = at_.Db[it.row()] * it.value();
      H.diagonal() += at_.Da;
      for (Index i = 0; i < n_; ++i) Eigen::Map<Vec>(J->data + i * static_cast<Index>(J->tda), n_) = H.row(i);
      return finite(H.allFinite()) && regular(H);
    });
  }

  bool finite(bool finite) {
    if (!finite) trouble_ = Trouble::NotFinite;
    return finite;
  }

  /// No zero pivot where GSL is to factor: its solve would call the error handler.
  bool regular(RowMajor& H) {
    if (!factors_) return true;
    gsl_matrix_view view = gsl_matrix_view_array(H.data(), gsl_.n, gsl_.n);
    int sign = 0;
    call_gsl([&] { gsl_linalg_LU_decomp(&view.matrix, permutation_.get(), &sign); });
    if ((H.diagonal().array() != 0).all()) return true;
    trouble_ = Trouble::Singular;
    return false;
  }

  Run& run_;
  SmoothingFunction smoothing_;
  bool factors_;
  Index n_;
  std::unique_ptr<gsl_permutation, Free> permutation_;
  gsl_multiroot_function_fdf gsl_{};
  Point last_;
  SmoothReformulation at_;
  Trouble trouble_ = Trouble::None;
  std::exception_ptr thrown_;
};

/// GSL's state: some five matrices and twenty vectors.
double bytes_for(Index n) { return static_cast<double>(sizeof(double)) * static_cast<double>(8 * n * n + 40 * n); }

bool has_bounds(const Box& box) {
  for (Index i = 0; i < box.size(); ++i)
    if (box.lower[i] < box.upper[i] && (std::isfinite(box.lower[i]) || std::isfinite(box.upper[i]))) return true;
  return false;
}

/// The verdict of a stage that GSL gave up.
void give_up(Run& run, const Multiroot& method, const System& system, int status) {
  const std::string solver(to_string(method.solver));
  const std::string at = system.mu > 0 ? " of the equations smoothed with mu = " + number(system.mu) : "";
  switch (system.trouble()) {
    case System::Trouble::Undefined:
      return run.end(Status::EvaluationFailed,
                     "F or its Jacobian is not defined at a trial point of " + solver +
                         ", which does not shorten its steps for that",
                     "another start, or --method path");
    case System::Trouble::NotFinite:
    case System::Trouble::Singular:
      return run.end(Status::LinearAlgebraFailed, "the Jacobian" + at + " is singular at an iterate of " + solver,
                     "another start, or --method path");
    case System::Trouble::None:
      break;
  }
  run.end(Status::NoProgress, solver + " has given up: " + gsl_strerror(status), "another start, or --method path");
}

/// From `point` to a zero of Phi_mu, as far as GSL gets. False: the run is over.
bool stage(Run& run, const Multiroot& method, System& system, gsl_multiroot_fdfsolver* solver, bool last, Point& point,
           Iteration& it) {
  const double enough = last ? 0 : std::max(0.1 * system.mu, 0.1 * run.tol());
  const auto x = made(gsl_vector_alloc(static_cast<std::size_t>(point.x.size())));
  std::copy(point.x.begin(), point.x.end(), x->data);
  int status = GSL_SUCCESS;
  call_gsl([&] { status = gsl_multiroot_fdfsolver_set(solver, system.gsl(), x.get()); });
  if (system.trouble() != System::Trouble::None) status = GSL_EBADFUNC;  // GSL does not look here
  while (status == GSL_SUCCESS && !(to_vec(solver->f).lpNorm<Eigen::Infinity>() <= enough)) {
    call_gsl([&] { status = gsl_multiroot_fdfsolver_iterate(solver); });
    system.rethrow();
    if (status != GSL_SUCCESS || !system.evaluate(to_vec(solver->x))) break;
    point.x = system.last().x;
    point.F = system.last().F;
    it = {.k = it.k + 1, .merit = 0.5 * to_vec(solver->f).squaredNorm(), .step = 1, .mu = system.mu, .kind = 'N'};
    ++run.stats().factorizations;
    if (!run.go_on(point, it)) return false;
  }
  system.rethrow();
  // A stage on the way need not be solved; where F is not defined or a matrix singular, GSL cannot go on at all.
  if (status == GSL_SUCCESS || (!last && system.trouble() == System::Trouble::None)) return true;
  give_up(run, method, system, status);
  return false;
}

}  // namespace

std::string_view to_string(MultirootSolver solver) {
  constexpr std::array<std::string_view, 4> names{"gsl-hybridsj", "gsl-hybridj", "gsl-newton", "gsl-gnewton"};
  return names[static_cast<std::size_t>(solver)];
}

void iterate(Run& run, const Multiroot& method, Point point) {
  const Index n = point.x.size();
  if (!run.ended() && n > method.max_size)
    run.end(Status::NotApplicable,
            "GSL's solvers are dense: " + std::to_string(n) + " variables are more than the limit of " +
                std::to_string(method.max_size) + " (max_size)",
            "--method path");
  Iteration it{.k = 0, .kind = 'I'};
  if (!run.go_on(point, it) || n == 0) return;  // GSL's handler would end the process at n = 0
  lcp::require_memory(bytes_for(n), "GSL's dense matrices");
  const GslErrors errors;
  const auto solver = made(gsl_multiroot_fdfsolver_alloc(type_of(method.solver), static_cast<std::size_t>(n)));
  System system(run, method.solver, n);
  if (!has_bounds(run.box())) {
    stage(run, method, system, solver.get(), true, point, it);
  } else {
    for (double mu = method.mu; system.mu != method.mu_end; mu *= method.shrink) {
      system.mu = std::max(mu, method.mu_end);
      if (!stage(run, method, system, solver.get(), system.mu == method.mu_end, point, it)) break;
    }
  }
  run.end(Status::NoProgress, "the equations are solved, the problem is not to the tolerance",
          "a smaller mu_end, or --method path");
}

void describe(Multiroot& m, Fields& f) {
  using enum MultirootSolver;
  f.choice("gsl_solver", &m.solver,
           {{"hybridsj", Hybridsj}, {"hybridj", Hybridj}, {"newton", Newton}, {"gnewton", Gnewton}},
           "gsl: hybridsj (Powell's hybrid method, scaled), hybridj (unscaled), newton (undamped) or gnewton (damped)");
  f.add("gsl_mu", &m.mu, strictly_between(0, 1e100), "gsl: first mu of the smoothed equations");
  f.add("gsl_shrink", &m.shrink, strictly_between(0, 1), "gsl: factor of mu from stage to stage");
  f.add("gsl_mu_end", &m.mu_end, strictly_between(0, 1e100), "gsl: last mu; at most gsl_mu");
  f.add("gsl_max_size", &m.max_size, at_least(0), "gsl: problems of more variables are refused");
  f.check(m.mu_end <= m.mu, "gsl_mu_end", m.mu_end, "at most gsl_mu");
}

}  // namespace perp::ncp
