#include <array>
#include <limits>

#include "app/options_parts.hpp"

namespace perp::app {

namespace {

constexpr double max_int = std::numeric_limits<int>::max();
constexpr double years = 1e9;  // of seconds: a limit that no clock overflows with

constexpr std::array lu_choices{
    Choice{"umfpack", static_cast<int>(lcp::LuBackend::Umfpack)}, Choice{"klu", static_cast<int>(lcp::LuBackend::Klu)},
    Choice{"eigen", static_cast<int>(lcp::LuBackend::Eigen)}, Choice{"dense", static_cast<int>(lcp::LuBackend::Dense)},
    Choice{"auto", static_cast<int>(lcp::LuBackend::Auto)}};
constexpr std::array linear_choices{Choice{"direct", static_cast<int>(ncp::LinearSolver::Direct)},
                                    Choice{"krylov", static_cast<int>(ncp::LinearSolver::Krylov)},
                                    Choice{"auto", static_cast<int>(ncp::LinearSolver::Auto)}};
constexpr std::array subproblem_choices{Choice{"lemke", static_cast<int>(ncp::Subproblem::Lemke)},
                                        Choice{"qp", static_cast<int>(ncp::Subproblem::Qp)},
                                        Choice{"auto", static_cast<int>(ncp::Subproblem::Auto)}};
constexpr std::array path_start_choices{Choice{"automatic", static_cast<int>(ncp::PathStart::Automatic)},
                                        Choice{"first", static_cast<int>(ncp::PathStart::First)},
                                        Choice{"always", static_cast<int>(ncp::PathStart::Always)}};
// Only PathSearch can start from a ray in the first iteration alone.
constexpr std::array start_choices{Choice{"automatic", static_cast<int>(lcp::LemkeStart::Regular)},
                                   Choice{"first", static_cast<int>(lcp::LemkeStart::Regular), Choice::Role::StandIn},
                                   Choice{"always", static_cast<int>(lcp::LemkeStart::Ray)}};
constexpr std::array cover_choices{Choice{"ones", static_cast<int>(lcp::Cover::Ones)},
                                   Choice{"generic", static_cast<int>(lcp::Cover::Generic)},
                                   Choice{"spread", static_cast<int>(lcp::Cover::Spread)}};

/// Lemke's method for affine problems has its options where Newton-Josephy has those of its subproblems.
struct LemkeView {
  lcp::LemkeOptions& lemke;
};

/// The field that the last of `gets` that finds one finds in the run's method; a get that does not compile for a method
/// finds nothing.
template <class... Gets>
Field of_method(Settings& settings, Gets... gets) {
  const auto find = [&](auto& method) {
    Field field;
    const auto look = [&](auto get) {
      if constexpr (std::is_invocable_v<decltype(get), decltype(method)>) field = get(method);
    };
    (look(gets), ...);
    return field;
  };
  if (auto* affine = std::get_if<ncp::Affine>(&settings.method)) {
    if (auto* lemke = std::get_if<lcp::Lemke>(&affine->method)) {
      LemkeView view{lemke->options};
      return find(view);
    }
    return std::visit(find, affine->method);
  }
  if (ncp::PathSearch* path = ncp::path_of(settings.method)) return find(*path);
  return std::visit(find, settings.method);
}

/// The escapes', where there are any.
template <class Get>
Field of_escape(Settings& settings, Get get) {
  return of_method(settings, [&](auto& m) -> decltype(Field(get(m.escape))) {
    if (m.escape.rounds == 0) return NoEffect{"escape_rounds = 0"};
    return get(m.escape);
  });
}

/// The inexact Newton method's, where Newton systems may be solved so.
template <class Get>
Field of_forcing(Settings& settings, Get get) {
  return of_method(settings, [&](auto& m) -> decltype(Field(get(m.forcing))) {
    if (m.linear == ncp::LinearSolver::Direct) return NoEffect{"linear_solver = direct"};
    return get(m.forcing);
  });
}

}  // namespace

std::span<const Option> options() {
  static const std::vector<Option> table = [] {
    std::vector<Option> all = general_options();
    for (const auto& part : {reformulation_options(), path_search_options(), output_options()})
      all.insert(all.end(), part.begin(), part.end());
    return all;
  }();
  return table;
}

std::vector<Option> general_options() {
  return {
      Option{"method",
             {},
             {},
             "the method that runs; the other options apply to it, whatever their order",
             [](Settings& settings) -> Field { return &settings.method_name; }},
      Option{"convergence_tolerance",
             {"tol"},
             {0, lcp::infinity, true},
             "tol: solved when the natural residual max_i |x_i - mid(l_i, x_i - F_i(x), u_i)| is at most tol",
             [](Settings& settings) -> Field { return &ncp::stop(settings.method).tol; }},
      Option{
          "relative_tolerance",
          {"tol_relative"},
          {0, lcp::infinity, true},
          "R: asked in addition of equations whose variable is not at a bound: |F_i| <= R t_i, the size of the terms "
          "that F_i is the rest of; inf: not asked",
          [](Settings& settings) -> Field { return &ncp::stop(settings.method).tol_relative; }},
      Option{"major_iteration_limit",
             {"max_iterations"},
             {0, max_int},
             "iterations (a linearisation each) after which to give up",
             [](Settings& settings) -> Field {
               if (std::holds_alternative<ncp::Affine>(settings.method)) return {};  // they count pivots, sweeps, ...
               return &ncp::stop(settings.method).max_iterations;
             }},
      Option{"evaluation_limit",
             {"max_F_evals"},
             {1, max_int},
             "evaluations of F, of all attempts together, after which to give up; looked at after each iteration",
             [](Settings& settings) -> Field { return &ncp::stop(settings.method).max_F_evals; }},
      Option{"time_limit",
             {"max_time"},
             {0, years, true},
             "seconds after which to give up",
             [](Settings& settings) -> Field { return &ncp::stop(settings.method).max_time; }},
      Option{"check_derivatives",
             {},
             {},
             "compare the Jacobian with differences of F at the start, and refuse a problem whose Jacobian is wrong",
             [](Settings& settings) -> Field { return &ncp::stop(settings.method).check_derivatives; }},
      Option{"auto_large",
             {},
             {0, max_int},
             "auto: from more variables on it takes iterative linear algebra and interior points first",
             [](Settings& settings) -> Field {
               auto* automatic = std::get_if<ncp::Auto>(&settings.method);
               if (automatic == nullptr) return {};
               return &automatic->large;
             }},
      Option{"nms_memory_size",
             {"memory"},
             {1, 1e6},
             "non-monotone search: merits remembered, the largest of which must be beaten; 1 is monotone",
             [](Settings& settings) {
               return of_method(
                   settings, [](auto& m) -> decltype(&m.search.memory) { return &m.search.memory; },
                   [](auto& m) -> decltype(&m.nms.memory) { return &m.nms.memory; });
             }},
      Option{"sigma",
             {},
             {0, 1, true},
             "line search: share of the predicted decrease of the merit that is demanded",
             [](Settings& settings) {
               return of_method(
                   settings, [](auto& m) -> decltype(&m.search.sigma) { return &m.search.sigma; },
                   [](auto& m) -> decltype(&m.sigma) { return &m.sigma; });
             }},
      Option{"beta",
             {},
             {0, 1, true},
             "line search: factor of the step length a trial",
             [](Settings& settings) {
               return of_method(
                   settings, [](auto& m) -> decltype(&m.search.beta) { return &m.search.beta; },
                   [](auto& m) -> decltype(&m.beta) { return &m.beta; });
             }},
      Option{"max_backtracks",
             {},
             {0, 1000},
             "line search: trials before the direction is given up",
             [](Settings& settings) {
               return of_method(
                   settings, [](auto& m) -> decltype(&m.search.max_backtracks) { return &m.search.max_backtracks; },
                   [](auto& m) -> decltype(&m.max_backtracks) { return &m.max_backtracks; });
             }},
      Option{"descent_rho",
             {},
             {0, lcp::infinity, true},
             "a Newton direction d needs  merit'(x; d) <= -descent_rho (|d| / sqrt n)^descent_p",
             [](Settings& settings) {
               return of_method(settings, [](auto& m) -> decltype(&m.descent_rho) { return &m.descent_rho; });
             }},
      Option{"descent_p",
             {},
             {2, lcp::infinity, true},
             "see descent_rho",
             [](Settings& settings) {
               return of_method(settings, [](auto& m) -> decltype(&m.descent_p) { return &m.descent_p; });
             }},
      Option{"levenberg_marquardt",
             {},
             {},
             "steps of that kind where Newton's does not descend, before gradient steps",
             [](Settings& settings) {
               return of_method(settings,
                                [](auto& m) -> decltype(&m.levenberg_marquardt) { return &m.levenberg_marquardt; });
             }},
      Option{
          "escape_rounds",
          {},
          {0, max_int},
          "where the method is stuck: proximal problems  F(x) + lambda (x - xbar)  tried to get away; 0: stay stuck, "
          "and no effect of the other options escape_*",
          [](Settings& settings) {
            return of_method(settings, [](auto& m) -> decltype(&m.escape.rounds) { return &m.escape.rounds; });
          }},
      Option{"escape_lambda",
             {},
             {0, lcp::infinity, true},
             "that lambda, in units of sqrt(|J|_1 |J|_inf)",
             [](Settings& settings) { return of_escape(settings, [](auto& m) -> Field { return &m.lambda; }); }},
      Option{"escape_grow",
             {},
             {1, 1e100, true},
             "lambda x escape_grow where a proximal problem has not been solved",
             [](Settings& settings) { return of_escape(settings, [](auto& m) -> Field { return &m.grow; }); }},
      Option{"escape_shrink",
             {},
             {0, 1, true, false},
             "lambda x escape_shrink after each move of xbar",
             [](Settings& settings) { return of_escape(settings, [](auto& m) -> Field { return &m.shrink; }); }},
      Option{"escape_accept",
             {},
             {0, 1, true},
             "an xbar with this part of the best residual is accepted: the method goes on from it",
             [](Settings& settings) { return of_escape(settings, [](auto& m) -> Field { return &m.accept; }); }},
      Option{
          "escape_trial_iterations",
          {},
          {0, max_int},
          "iterations tried from other xbar",
          [](Settings& settings) { return of_escape(settings, [](auto& m) -> Field { return &m.trial_iterations; }); }},
      Option{"escape_tolerance",
             {},
             {0, lcp::infinity, true},
             "natural residual at which a proximal problem is solved well enough",
             [](Settings& settings) { return of_escape(settings, [](auto& m) -> Field { return &m.perturbed_tol; }); }},
      Option{"escape_iteration_limit",
             {},
             {1, max_int},
             "iterations for one proximal problem",
             [](Settings& settings) {
               return of_escape(settings, [](auto& m) -> Field { return &m.perturbed_iterations; });
             }},
      Option{"rescalings",
             {},
             {0, 2},
             "where a method with escapes, or smooth, is stuck: runs from the start on the scaled problem, by J at the "
             "best point, then at the start",
             [](Settings& settings) -> Field {
               if (auto* smoothing = std::get_if<ncp::Smoothing>(&settings.method)) return &smoothing->rescalings;
               return of_escape(settings, [](auto& m) -> Field { return &m.rescalings; });
             }},
      Option{"lu",
             {},
             {},
             "the sparse LU factorization used",
             [](Settings& settings) {
               return of_method(
                   settings, [](auto& m) -> decltype(word(m.lu, lu_choices)) { return word(m.lu, lu_choices); },
                   [](auto& m) -> decltype(word(m.lemke.basis.lu, lu_choices)) {
                     return word(m.lemke.basis.lu, lu_choices);
                   });
             }},
      Option{"linear_solver",
             {},
             {},
             "Newton systems of semismooth: direct (LU), krylov (inexactly, in little memory) or auto (krylov for more "
             "than 20000 variables)",
             [](Settings& settings) {
               return of_method(settings, [](auto& m) -> decltype(word(m.linear, linear_choices)) {
                 return word(m.linear, linear_choices);
               });
             }},
      Option{"forcing_max",
             {},
             {0, 1, true},
             "krylov: a Newton system's relative residual at most",
             [](Settings& settings) { return of_forcing(settings, [](auto& m) -> Field { return &m.eta_max; }); }},
      Option{"forcing_gamma",
             {},
             {0, 1, true, false},
             "krylov: factor of the forcing term  gamma (|Phi_k| / |Phi_k-1|)^alpha",
             [](Settings& settings) { return of_forcing(settings, [](auto& m) -> Field { return &m.gamma; }); }},
      Option{"forcing_alpha",
             {},
             {1, 2, true, false},
             "krylov: its exponent, the order of convergence aimed at",
             [](Settings& settings) { return of_forcing(settings, [](auto& m) -> Field { return &m.alpha; }); }},
      Option{
          "krylov_iteration_limit",
          {},
          {1, max_int},
          "krylov: iterations for one Newton system, after which LU takes over",
          [](Settings& settings) { return of_forcing(settings, [](auto& m) -> Field { return &m.max_iterations; }); }},
      Option{"chord_steps",
             {},
             {0, 1000},
             "simplified Newton steps with the last matrix after a Newton point, while they pay; of josephy where it "
             "solves quadratic programs, of semismooth where krylov solves the systems",
             [](Settings& settings) {
               if (auto* semismooth = std::get_if<ncp::SemismoothNewton>(&settings.method); semismooth != nullptr)
                 return of_forcing(settings, [](auto& m) -> Field { return &m.chord_steps; });
               return of_method(settings, [](auto& m) -> decltype(&m.chord_steps) { return &m.chord_steps; });
             }},
      Option{"patience",
             {},
             {1, max_int},
             "path: iterations in which the best merit must fall by 1 %, or the attempt is given up; smooth, interior: "
             "the same of the natural residual, or the parameter is raised; psor: sweeps likewise",
             [](Settings& settings) {
               return of_method(settings, [](auto& m) -> decltype(&m.patience) { return &m.patience; });
             }},
      Option{
          "subproblem",
          {},
          {},
          "linearised problems of josephy: lemke (pivoting), qp (quadratic programs where J is symmetric) or auto (qp "
          "for more than 2000 variables)",
          [](Settings& settings) {
            return of_method(settings, [](auto& m) -> decltype(word(m.subproblem, subproblem_choices)) {
              return word(m.subproblem, subproblem_choices);
            });
          }},
      Option{"minor_iteration_limit",
             {"max_pivots"},
             {1, max_int},
             "pivots of one linearised problem, at most 1000 + 20 n of them; or of Lemke's method on an affine one",
             [](Settings& settings) {
               return of_method(settings, [](auto& m) -> decltype(&m.lemke.max_pivots) { return &m.lemke.max_pivots; });
             }},
      Option{
          "lemke_start",
          {},
          {},
          "where pivoting starts: automatic (the cell of the current point), first (a ray in the first iteration) or "
          "always (a ray, as Lemke's method)",
          [](Settings& settings) {
            return of_method(
                settings,
                [](auto& m) -> decltype(word(m.lemke.start, start_choices)) {
                  return word(m.lemke.start, start_choices);
                },
                [](ncp::PathSearch& m) { return word(m.start, path_start_choices); });
          }},
      Option{
          "lemke_cover",
          {},
          {},
          "Lemke's covering vector: ones (the textbook's e), generic (random about e in equilibrated units) or spread "
          "(log-uniform over three decades)",
          [](Settings& settings) {
            return of_method(settings, [](auto& m) -> decltype(word(m.lemke.cover, cover_choices)) {
              return word(m.lemke.cover, cover_choices);
            });
          }},
      Option{"pivot_tolerance",
             {},
             {0, 1, true},
             "smallest pivot, relative to the largest entry of its column",
             [](Settings& settings) {
               return of_method(settings, [](auto& m) -> decltype(&m.lemke.pivot_tol) { return &m.lemke.pivot_tol; });
             }},
      Option{"lemke_perturbation",
             {},
             {0, 1e100},
             "relative perturbation of the path's start, against ties; 0: none",
             [](Settings& settings) {
               return of_method(settings,
                                [](auto& m) -> decltype(&m.lemke.perturbation) { return &m.lemke.perturbation; });
             }},
      Option{"lemke_seed",
             {"seed"},
             {0, max_int},
             "of that perturbation and of the ray",
             [](Settings& settings) {
               return of_method(settings, [](auto& m) -> decltype(&m.lemke.seed) { return &m.lemke.seed; });
             }},
      Option{"refactor_every",
             {},
             {1, max_int},
             "pivots between fresh factorizations of the basis",
             [](Settings& settings) {
               return of_method(settings, [](auto& m) -> decltype(&m.lemke.basis.refactor_every) {
                 return &m.lemke.basis.refactor_every;
               });
             }},
      Option{"sideineq",
             {},
             {1, 2},
             "a model's side inequalities: 1 accepts them, with an extra variable each; 2 refuses the model",
             [](Settings& settings) -> Field { return &settings.sideineq; }},
      Option{"wantsol",
             {},
             {0, 15},
             "AMPL's: 8 does not print the closing message (the .sol file is written whatever the value)",
             [](Settings& settings) -> Field { return &settings.wantsol; }},
  };
}

}  // namespace perp::app
