// SPDX-License-Identifier: Apache-2.0
#include "ncp/strategy/presets.hpp"

#include <algorithm>
#include <vector>

#include "lcp/gpl.hpp"
#include "ncp/strategy/lists.hpp"

namespace perp::ncp {
namespace {

/// Rutherford's damping: halved steps until the merit falls, no memory.
NewtonJosephy miles() { return {.search = {.memory = 1}}; }

/// Pang & Gabriel: every step descends.
MinNewton nesqp() { return {.direction = MinNewton::Direction::ConvexQp, .search = {.memory = 1}}; }

/// De Luca, Facchinei & Kanzow's test of a direction and of a step; the memory is that of their non-monotone variant.
SemismoothNewton semismooth() { return {}; }

std::vector<Preset> all_presets() {
  return {
      {"auto",
       "chooses by size, structure and class, goes on to others of these where it is stuck, and says what it did",
       "ncp/strategy/lists.cpp", automatic()},
      {"path", "Newton-Robinson with path search: PATH's algorithm, with crash, restarts and other methods at last",
       "Ralph (1994); Dirkse & Ferris (1995); Ferris, Kanzow & Munson (1999); Munson (2000)", path()},
      {"miles", "Newton-Josephy: linear complementarity problems by Lemke's method, damped",
       "Rutherford, MILES (1993); Mathiesen, Math. Programming Study 23 (1985) 144", miles()},
      {"nesqp", "least-squares steps on the min function from convex quadratic programs",
       "Pang & Gabriel, Math. Programming 60 (1993) 295", nesqp()},
      {"qpcomp", "nesqp that leaves local minima by proximal escapes",
       "Billups & Ferris, Math. Programming 76 (1997) 533", with_escapes(nesqp(), "qpcomp")},
      {"smooth", "Newton on a sequence of smooth approximations, by the neural smoothing function",
       "Chen & Mangasarian, Comput. Optim. Appl. 5 (1996) 97", with_rescalings(Smoothing{}, "smooth")},
      {"interior", "primal-dual interior points: a homotopy in the products, predictor and corrector",
       "Mehrotra, SIAM J. Optim. 2 (1992) 575; Kojima, Megiddo & Noma, Math. Oper. Res. 16 (1991) 754",
       InteriorPoint{}},
      {"proxi", "Newton on the min function that leaves local minima by proximal escapes",
       "Billups, PhD thesis, Wisconsin (1995)", with_escapes(MinNewton{}, "proxi")},
      {"semismooth", "Newton on the Fischer-Burmeister equation, safeguarded by Levenberg-Marquardt and gradient steps",
       "De Luca, Facchinei & Kanzow, Math. Programming 75 (1996) 407", semismooth()},
      {"semicomp", "semismooth that leaves local minima by proximal escapes", "Billups, PhD thesis, Wisconsin (1995)",
       with_escapes(semismooth(), "semicomp")},
      {"josephy", "miles with a non-monotone search and proximal escapes",
       "Josephy, MRC report 1965 (1979); Billups & Ferris, Math. Programming 76 (1997) 533",
       with_escapes(NewtonJosephy{}, "josephy")},
      {"robinson", "Newton on the normal map, undamped: full steps of josephy, for comparison",
       "Robinson, Math. Oper. Res. 17 (1992) 691; Acary, lecture 3, (36)", NewtonRobinson{}},
      {"newton-min", "Newton on the min function, the base of proxi", "Pang, Math. Oper. Res. 15 (1990) 311",
       MinNewton{}},
      {"semismooth-min", "semismooth on the min function, its steps searched on the Fischer-Burmeister merit",
       "Pang, Math. Oper. Res. 15 (1990) 311", SemismoothNewton{.cfunction = natural_min()}},
      {"semismooth-penalised", "semismooth on the penalised Fischer-Burmeister function",
       "Chen, Chen & Kanzow, Math. Programming 88 (2000) 211",
       SemismoothNewton{.cfunction = penalised_fischer_burmeister()}},
      {"gsl-hybridsj", "a baseline: GSL's dense hybrid solver on the smoothed equations, mu in stages",
       "GNU Scientific Library manual, Multidimensional Root-Finding; Powell (1970), MINPACK hybrj", Multiroot{}},
  };
}

NewtonJosephy miles_published() {
  NewtonJosephy method = miles();
  method.subproblem = Subproblem::Lemke;
  return method;
}

/// In 1997: no Fischer-Burmeister merit and so no gradient steps, lambda as given.
PathSearch path_published() {
  return {.merit = PathMerit::NormalMap, .chord_steps = 0, .proximal_adaptive = false, .gradient_step_limit = 0};
}

Smoothing smooth_published() { return {.finish = false, .restarts = 0}; }

SemismoothNewton semismooth_published() { return {.levenberg_marquardt = false, .linear = LinearSolver::Direct}; }

std::vector<Preset> all_published() {
  return {
      {"path-1997", "path as published: one attempt on the normal map's merit, the problem as it is",
       "Ralph, Math. Oper. Res. 19 (1994) 352; Dirkse & Ferris, Optim. Methods Softw. 5 (1995) 123", path_published()},
      {"path-one-attempt", "path with presolve and the Fischer-Burmeister merit, without restarts",
       "Ferris, Kanzow & Munson, Math. Programming 86 (1999) 475", path_documented({.chord_steps = 0}, 0)},
      {"path-three-restarts", "path-one-attempt with the three restarts that PATH documents",
       "Ferris & Munson, PATH 4.7 (option restart_limit)", path_documented({.chord_steps = 0}, 3)},
      {"miles-1997", "miles, every linearised problem by Lemke's method", "Rutherford, MILES (1993)",
       miles_published()},
      {"nesqp-1997", "nesqp, which is as published", "Pang & Gabriel, Math. Programming 60 (1993) 295", nesqp()},
      {"qpcomp-1997", "qpcomp without rescalings", "Billups & Ferris, Math. Programming 76 (1997) 533",
       escaping(nesqp())},
      {"smooth-1997", "smooth without rescalings, without raising mu, without steps on the active set",
       "Chen & Mangasarian, Comput. Optim. Appl. 5 (1996) 97", smooth_published()},
      {"proxi-1997", "proxi without rescalings", "Billups, PhD thesis, Wisconsin (1995)", escaping(MinNewton{})},
      {"semismooth-1997", "semismooth with gradient steps alone as a safeguard, by factorizations",
       "De Luca, Facchinei & Kanzow, Math. Programming 75 (1996) 407", semismooth_published()},
      {"semicomp-1997", "semismooth-1997 that leaves local minima by proximal escapes, without rescalings",
       "Billups, PhD thesis, Wisconsin (1995)", escaping(semismooth_published())},
      {"lmmcp",
       "Levenberg-Marquardt on 2 n equations: Fischer-Burmeister beside products, with a projected preprocessor",
       "Kanzow & Petra, Optim. Methods Softw. 19 (2004) 507", Lmmcp{}},
  };
}

}  // namespace

std::span<const Preset> presets() {
  static const std::vector<Preset> table = [] {
    std::vector<Preset> all = all_presets();
    std::erase_if(all, [](const Preset& preset) { return lcp::left_out(preset.name); });
    return all;
  }();
  return table;
}

std::span<const Preset> published() {
  static const std::vector<Preset> table = all_published();
  return table;
}

const Preset* find_preset(std::string_view name) {
  for (const auto table : {presets(), published()})
    if (const auto found = std::ranges::find(table, name, &Preset::name); found != table.end()) return &*found;
  return nullptr;
}

}  // namespace perp::ncp
