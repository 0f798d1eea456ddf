// SPDX-License-Identifier: Apache-2.0
#pragma once
/// `perp contact ball`: the ball under the cyclic load (contact/scenes/ball.hpp) by polygons in place of the friction
/// disk and by Coulomb's law, side by side.
#include <atomic>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/program/program.hpp"
#include "contact/scenes/ball.hpp"

namespace CLI {
class App;
}

namespace perp::app::contacts {

struct BallRequest {
  std::optional<std::string> facets{};    ///< comma-separated K >= 3; neither this nor exact: 4,6,8,16 and exact
  bool exact = false;                     ///< Coulomb's law
  bool outer = false;                     ///< polygons about the disk, not in it
  std::string loads = "1,1.5";            ///< comma-separated L: a path for each
  double frame = 0;                       ///< of the contact, in degrees
  contact::CyclicBall ball{.cycles = 4};  ///< but for load and frame
  std::string json{};                     ///< "" for none, "-" for standard output (and the text to `err`)
};

/// The same ball under one load by several laws; the exact one, if there is one, is the last.
struct BallScene {
  contact::CyclicBall ball{};
  std::vector<contact::BallPath> paths{};

  const contact::BallPath* exact() const;
};

/// How far the path's end is from the exact path's [m]; NaN if there is none.
double from_exact(const BallScene& scene, const contact::BallPath& path);

/// exit_solved: every step of every path; exit_unsolved; exit_input. Errors are printed, not thrown. `interrupt` may be
/// null.
ExitCode ball(const BallRequest& request, Streams streams, const std::atomic<bool>* interrupt = nullptr);

// The command line of `perp contact ball`.

/// Adds it to `perp contact`; what it is called with goes to `request`, which must outlive `contact`.
CLI::App* add_ball_command(CLI::App& contact, BallRequest& request);

/// Runs it if it was called; its exit code. What stands before `ball` is refused.
int run_ball_command(const CLI::App& contact, const BallRequest& request, Streams streams,
                     const std::atomic<bool>* interrupt);

}  // namespace perp::app::contacts
