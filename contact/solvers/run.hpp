// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Any law of friction by any method:
///     const Run run = contact::run(problem, contact::variant_of("glocker+path"));
/// Only contact::accepted calls a point a solution of Coulomb's law; faceted and frictionless laws are judged by the
/// natural residual of their own affine problem first, in the units of contact/model/units.hpp, and the exact law's
/// residual stands beside it.
#include <atomic>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "contact/existence/existence.hpp"
#include "contact/model/problem.hpp"
#include "contact/model/residual.hpp"
#include "contact/solvers/solve.hpp"
#include "contact/solvers/variant.hpp"

namespace perp::contact {

struct RunLimits {
  double tol = 1e-8;
  double seconds = 30;
  const std::atomic<bool>* interrupt = nullptr;  ///< may be null; outlives the run
  /// Called, on the thread that solves, with every r that is better by Coulomb's law than those before. Formulations
  /// whose method does not report its iterates never call it.
  std::function<void(const Vec& r)> better{};
  /// r of a similar problem to begin near, as contact::Options::start; empty: cold. `auto`, methods of Coulomb's exact
  /// law on r and those of ncp/ for Glocker's NCP use it, the others begin where they always do.
  Vec start{};
};

struct Run {
  Status status = Status::NoProgress;
  std::string message{};
  Verdict verdict{};        ///< what is known of solutions of the variant's law, where none was found
  bool solved = false;      ///< exact(): the exact law, else the variant's own problem
  std::string solved_by{};  ///< the step that made the accepted point (contact::Origin), or the method; "" if unsolved
  Solution solution{};      ///< the accepted point, or the best one met
  Residual residual{};      ///< of Coulomb's law
  /// The natural residual of the affine problem, for laws that are not exact; NaN if it is not known.
  double own = std::numeric_limits<double>::quiet_NaN();
  Index unknowns = 0;  ///< of it, or of the NCP; 0 of methods that have none but r
  std::vector<ContactState> states{};
  std::vector<std::pair<std::string, long>> counts{};  ///< iterations first, then what else was counted
  double seconds = 0;
  std::vector<Record> history{};

  long steps() const;  ///< iterations, sweeps and Newton steps
  Index in_state(State state) const;
};

/// Solves the problem by the variant. Throws std::invalid_argument if contact::check refuses the problem, or if the
/// solver is not one for the law.
Run run(const Problem& problem, const Variant& variant, const RunLimits& limits = {});

/// The affine problem of a law that is not exact. Throws std::invalid_argument for the others.
AffineEncoding encoding_of(const Problem& problem, const Variant& variant);

/// Fills in the residual and the states of run.solution.r by the judge of the exact law.
void judge(Run& run, const Problem& problem, const Variant& variant);

}  // namespace perp::contact
