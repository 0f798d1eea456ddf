// SPDX-License-Identifier: Apache-2.0
#include "app/contact/ball.hpp"

#include <fmt/format.h>

#include <ostream>

#include "app/program/command_option.hpp"

namespace perp::app::contacts {

namespace {

constexpr const char* ball_footer =
    "A ball slides on a plane under a load that comes from 60, 180 and -60 degrees in turn (lecture 3 by Acary). With "
    "a\n"
    "polygon of K facets in place of the friction disk, the path of the ball is bent and drifts. It then depends on "
    "how\n"
    "the frame of the contact is turned. By Coulomb's law the ball stays if friction can hold the load. Otherwise its\n"
    "path closes.\n"
    "\n"
    "Examples:\n"
    "  perp contact ball                                       4, 6, 8, 16 facets and the exact law\n"
    "  perp contact ball --facets 8 --exact --load 1.2 --frame 20\n"
    "  perp contact ball --exact --json - | jq '.loads[].paths[].drift'\n"
    "\n"
    "'perp-compare ball' draws the paths. Exit codes: 0 every step solved, 1 not, 2 wrong usage or input, 3 internal "
    "error.";

}  // namespace

CLI::App* add_ball_command(CLI::App& contact, BallRequest& request) {
  CLI::App* ball = contact.add_subcommand(
      "ball", "Compute the path of a ball under a cyclic load, by friction polygons and by Coulomb's law");
  ball->footer(ball_footer);
  option(ball, "--facets", request.facets,
         "friction polygons of K facets (without --facets and --exact: 4,6,8,16 and Coulomb's law)", "K[,K]...");
  ball->add_flag("--exact", request.exact, "Coulomb's law; distances are measured from its path");
  ball->add_flag("--outer", request.outer, "polygons around the friction disk, not inside it");
  option(ball, "--load", request.loads, "size of the load in units of mu m g; one path for each (1,1.5)", "L[,L]...");
  option(ball, "--frame", request.frame, "turn the tangents (T1, T2) of the contact (0)", "DEGREES");
  option(ball, "--mu", request.ball.mu, "coefficient of friction (0.3)", "MU");
  option(ball, "--phase", request.ball.phase, "time for which the load keeps a direction (5)", "SECONDS");
  option(ball, "--cycles", request.ball.cycles, "number of cycles of three phases (4)", "N");
  option(ball, "--step", request.ball.h, "time step h (0.01)", "SECONDS");
  option(ball, "--theta", request.ball.theta, "theta of the time-stepping scheme, from 1/2 to 1 (0.5)", "THETA");
  ball->add_flag("--rolling", request.ball.rolls, "let the ball turn; then it rolls, with 2/7 of the load as friction");
  option(ball, "--json", request.json,
         "write the result as JSON; - is standard output, the text then goes to standard error", "FILE");
  return ball;
}

int run_ball_command(const CLI::App& contact, const BallRequest& request, Streams streams,
                     const std::atomic<bool>* interrupt) {
  for (const CLI::Option* option : contact.get_options())
    if (option->count() > 0) {
      streams.err << fmt::format(
          "perp contact: {} stands before 'ball', which is a command of its own; see 'perp "
          "contact ball --help' (./ball is a file)\n",
          option->get_name());
      return exit_input;
    }
  return ball(request, streams, interrupt);
}

}  // namespace perp::app::contacts
