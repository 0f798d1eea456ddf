#include "app/compare/command_line.hpp"

namespace perp::app::compare {

namespace {

constexpr const char* footer =
    "PROBLEMS is a comma-separated list of NAME, NAME:SIZE, class:CLASS, FILE.nl, all; METHODS of NAME,\n"
    "NAME:key=value:key=value, presets, published, all, cfunctions (semismooth over every C-function), none.\n"
    "Names may have * and ?; what begins with - is taken away.\n"
    "\n"
    "Examples:\n"
    "  perp compare --problems class:tiny --out tiny\n"
    "  perp compare --problems all,-class:pde --methods path,miles,semismooth:tol=1e-9 --starts 1\n"
    "  perp compare --methods=presets,-gsl* --restarts 2 --out with-restarts\n"
    "  perp compare --methods cfunctions --problems class:tiny,class:economics --out functions\n"
    "  perp compare --problems 'models/*.nl' --external 'peer=./peer tol={tol}' --out peers\n"
    "  perp compare --out tiny --resume                      after Ctrl-C, kill -9 or a power cut\n"
    "  perp compare --problems class:tiny --baseline tiny/outcomes.csv --out again\n"
    "\n"
    "Every run is a process of its own with limits of time and memory, its point is judged by the natural residual of\n"
    "the problem built anew, and every finished cell is on the disk at once. DIR then has report.html, cells.csv and\n"
    "cells.json; outcomes.csv is without times, so that two campaigns can be compared with cmp.\n"
    "\n"
    "Exit codes: 0 complete, 1 complete but something that the baseline has solved is not solved, 2 wrong usage or\n"
    "input, 3 internal error, 4 interrupted (--resume goes on).";

}  // namespace

CLI::App* add_command(CLI::App& app, CompareRequest& request) {
  CLI::App* compare = app.add_subcommand("compare", "Compare methods on many problems: a campaign and its report");
  compare->footer(footer);
  compare->add_option("--problems", request.problems, "which problems; default all of the collection")
      ->option_text("PROBLEMS");
  compare->add_option("--methods", request.methods, "which methods; default presets")->option_text("METHODS");
  compare->add_option("--starts", request.starts, "all starts of each problem (default), or at most so many")
      ->option_text("all|K");
  compare->add_option("--tol", request.tol, "the judge's tolerance, and the methods' where they are given none (1e-6)")
      ->option_text("TOL");
  compare->add_option("--time-limit", request.time_limit, "wall clock of a run (60)")->option_text("SECONDS");
  compare->add_option("--memory-limit", request.memory_mb, "resident memory of a run (4096)")->option_text("MB");
  compare->add_option("--jobs", request.jobs, "runs at a time (one a core)")->option_text("N");
  compare->add_option("--restarts", request.restarts, "after a failure, so many further runs from perturbed starts (0)")
      ->option_text("R");
  compare->add_option("--seed", request.seed, "of those starts (1)")->option_text("N");
  compare
      ->add_option("--external", request.externals,
                   "a program that AMPL could call, 'COMMAND stub -AMPL', on .nl problems; {tol} in COMMAND is the "
                   "campaign's tolerance; may be repeated")
      ->option_text("NAME=COMMAND")
      ->allow_extra_args(false);
  compare->add_option("--out", request.out, "where all is kept (comparison)")->option_text("DIR");
  compare->add_flag("--resume", request.resume, "go on with the campaign in DIR; what is not given is as it was");
  compare
      ->add_option("--baseline", request.baseline,
                   "cells.csv or outcomes.csv of an earlier campaign: list what it solved and this one has not")
      ->option_text("FILE.csv");
  return compare;
}

}  // namespace perp::app::compare
