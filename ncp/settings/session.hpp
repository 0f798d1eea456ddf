// SPDX-License-Identifier: Apache-2.0
#pragma once
/// One solve with all that may be asked of it: the same for the program, for AMPL's protocol, for C and for Python.
#include <atomic>
#include <functional>
#include <optional>
#include <vector>

#include "lcp/solve/enumeration.hpp"
#include "ncp/ampl/model.hpp"
#include "ncp/analysis/verify.hpp"
#include "ncp/problem/mcp.hpp"
#include "ncp/settings/settings.hpp"
#include "ncp/strategy/deflation.hpp"
#include "ncp/strategy/vi.hpp"

namespace perp::settings {

/// AMPL's solve_result_num for a model refused because of its side inequalities.
inline constexpr int side_inequalities_refused = 505;

/// The findings of a session.
struct Outcome {
  ncp::Result result{};               ///< of several solutions the first
  std::optional<lcp::ViResult> vi{};  ///< of a problem with a polyhedron(): the verdict, which `result` has too
  std::vector<ncp::Iteration> iterations{};
  std::optional<ncp::JacobianCheck> derivatives{};  ///< at the start, if asked for
  std::optional<ncp::AllSolutions> several{};       ///< where Settings::solutions asks for several
  std::optional<lcp::Solutions> all_solutions{};    ///< of method enumeration
  std::optional<ncp::Verified> verified{};          ///< where Settings::verify asks for it, of an accepted point
};

struct Session {
  const ncp::Mcp& mcp;
  ncp::Vec x0;
  Settings settings{};
  const ncp::ampl::Model* model = nullptr;  ///< mcp, or what is in it, where that came from an .nl file
  const std::atomic<bool>* interrupt = nullptr;
  /// Sees the records of the first solution.
  ncp::Observer observer{};
  /// Called with a solution before more is told of it (a proof, all other solutions), which may take long.
  std::function<void(const Outcome&)> found{};

  /// Throws InputError if the Jacobian was to be checked and is wrong, or if several solutions are asked of
  /// enumeration, ampl::ModelError if side inequalities were to be refused, and what ncp::solve and ncp::solve_all
  /// throw.
  Outcome run() const;
};

}  // namespace perp::settings
