#pragma once
/// One run: a problem, a variant, limits, and the judge's word. Only contact::accepted calls a point a solution of
/// Coulomb's law; faceted and frictionless laws are judged by the natural residual
/// of their own affine problem first, in the units of contact/units.hpp, and the exact law's residual stands beside it.
#include <atomic>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "app/contact/variant.hpp"
#include "app/files.hpp"
#include "contact/facts.hpp"
#include "contact/problem.hpp"
#include "contact/residual.hpp"
#include "contact/solve.hpp"

namespace perp::app::contacts {

struct Loaded {
  std::string label;  ///< as it was given
  contact::Problem problem;
};
/// A file of FCLIB or Siconos, or NAME:SIZE[:SEED] of contact/generators.hpp, SIZE contacts, where there is no such
/// file. Throws InputError, lcp::FileError, std::invalid_argument, std::bad_alloc.
Loaded load(const std::string& argument);
/// The same where the argument has to be NAME:SIZE[:SEED].
Loaded generate(const std::string& argument);
/// Is it NAME:... of a generator and no file?
bool is_generated(const std::string& argument);
/// Those of the arguments that are files: for check_outputs().
std::vector<FileUse> files_of(const std::vector<std::string>& arguments);

/// Clocks count nanoseconds in 64 bits: a limit beyond this, infinity too, is this one.
inline constexpr double most_seconds = 1e9;

struct Limits {
  double tol = 1e-8;
  double seconds = 30;  ///< at most most_seconds
  const std::atomic<bool>* interrupt = nullptr;
  /// Called with every r that is better by Coulomb's law than those before, by formulations whose method tells of its
  /// iterates; on the thread that solves.
  std::function<void(const lcp::Vec& r)> better{};
};

struct Run {
  Variant variant{};
  Limits limits{};
  std::string status{};  ///< "Solved", "NoProgress", "TimeLimit", ...
  std::string message{};
  contact::Verdict verdict{};  ///< what is known of solutions of the variant's law, where none was found
  bool solved = false;         ///< exact(): the exact law, else the variant's own problem
  std::string solved_by{};  ///< the step that made the accepted point (contact::Origin), or the method; "" if unsolved
  contact::Solution solution{};
  contact::Residual residual{};  ///< of Coulomb's law
  double own = 0;                ///< of laws that are not exact: natural residual of the affine problem
  lcp::Index unknowns = 0;       ///< of it, or of the NCP; 0 of auto and homotopy, which have none but r
  std::vector<contact::ContactState> states{};
  std::vector<std::pair<std::string, long>> counts{};  ///< iterations first; JSON's keys
  double seconds = 0;
  std::vector<contact::Record> history{};

  long steps() const;  ///< iterations, sweeps and Newton steps
  lcp::Index in_state(contact::State state) const;
};

/// Fills in residual and states of run.solution.r: what the exact law's judge says, whoever made it.
void judge(Run& run, const contact::Problem& problem);

/// Throws what the libraries throw at malformed input.
Run run(const contact::Problem& problem, const Variant& variant, const Limits& limits);

}  // namespace perp::app::contacts
