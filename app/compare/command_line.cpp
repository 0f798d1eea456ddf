// SPDX-License-Identifier: Apache-2.0
#include "app/compare/compare.hpp"

#include "app/program/command_option.hpp"

namespace perp::app::compare {

namespace {

constexpr const char* footer =
    "PROBLEMS is a comma-separated list of NAME, NAME:SIZE, class:CLASS, FILE.nl, all; METHODS of NAME,\n"
    "NAME:key=value:key=value, presets, published, all, cfunctions (semismooth over every C-function;\n"
    "cfunctions:rho=0.01:rho=100 takes those values of their parameters rho, lambda or alpha),\n"
    "cfunction-grid (those with a parameter at 4 or 5 values of it), none.\n"
    "Names may have * and ?; what begins with - is taken away.\n"
    "\n"
    "Examples:\n"
    "  perp compare --problems class:tiny --out tiny\n"
    "  perp compare --problems all,-class:pde --methods path,miles,semismooth:tol=1e-9 --starts 1\n"
    "  perp compare --methods=presets,-gsl* --restarts 2 --out with-restarts\n"
    "  perp compare --methods cfunctions --problems class:tiny,class:economics --out functions\n"
    "  perp compare --problems 'models/*.nl' --external 'peer=./peer tol={tol}' --out peers\n"
    "  perp compare --out tiny --resume                      after Ctrl-C, kill -9 or a power cut\n"
    "  perp compare --problems all --shard 3/7 --out part3   the third of seven parts\n"
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
  option(compare, "--problems", request.problems, "which problems; default all of the collection", "PROBLEMS");
  option(compare, "--methods", request.methods, "which methods; default presets", "METHODS");
  option(compare, "--starts", request.starts, "all starts of each problem (default), or at most so many", "all|K");
  option(compare, "--tol", request.tol, "the judge's tolerance, and the methods' where they are given none (1e-6)",
         "TOL");
  option(compare, "--time-limit", request.time_limit, "wall clock of a run (60)", "SECONDS");
  option(compare, "--memory-limit", request.memory_mb, "resident memory of a run (4096)", "MB");
  option(compare, "--jobs", request.jobs, "runs at a time (one a core)", "N");
  option(compare, "--restarts", request.restarts, "after a failure, so many further runs from perturbed starts (0)",
         "R");
  option(compare, "--seed", request.seed, "of those starts (1)", "N");
  option(compare, "--external", request.externals,
         "a program that AMPL could call, 'COMMAND stub -AMPL', on .nl problems; {tol} in COMMAND is the "
         "campaign's tolerance; may be repeated",
         "NAME=COMMAND")
      ->allow_extra_args(false);
  option(compare, "--shard", request.shard,
         "runs part K of N of the cells, for N machines or processes, each with a DIR of its own; 'perp report' joins "
         "them",
         "K/N");
  option(compare, "--out", request.out, "where all is kept (comparison)", "DIR");
  compare->add_flag("--resume", request.resume, "go on with the campaign in DIR; what is not given is as it was");
  option(compare, "--baseline", request.baseline,
         "cells.csv or outcomes.csv of an earlier campaign: list what it solved and this one has not", "FILE.csv");
  return compare;
}

}  // namespace perp::app::compare
