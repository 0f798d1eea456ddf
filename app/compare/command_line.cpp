// SPDX-License-Identifier: Apache-2.0
#include "app/compare/compare.hpp"

#include "app/program/command_option.hpp"

namespace perp::app::compare {

namespace {

constexpr const char* footer =
    "PROBLEMS is a comma-separated list of NAME, NAME:SIZE, class:CLASS, FILE.nl and all.\n"
    "METHODS is a comma-separated list of NAME, NAME:key=value:key=value, presets, published, all, none and:\n"
    "  cfunctions                    semismooth with every C-function\n"
    "  cfunctions:rho=0.01:rho=100   the same, with these values of the parameters rho, lambda or alpha\n"
    "  cfunction-grid                the C-functions that have a parameter, each at 4 or 5 values of it\n"
    "Names may contain * and ?. An item that begins with - is taken out of the list.\n"
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
    "A cell is one method on one problem from one start. It runs in a process of its own, with limits of time and\n"
    "memory. The judge builds the problem anew and evaluates the natural residual at the point found. Every finished\n"
    "cell is on the disk at once. In the end DIR has report.html, cells.csv and cells.json. outcomes.csv has no "
    "times,\n"
    "so two campaigns can be compared with cmp.\n"
    "\n"
    "Exit codes: 0 complete, 1 complete but something that the baseline solved is not solved, 2 wrong usage or\n"
    "input, 3 internal error, 4 interrupted (--resume goes on).";

}  // namespace

CLI::App* add_command(CLI::App& app, CompareRequest& request) {
  CLI::App* compare = app.add_subcommand("compare", "Compare methods on many problems: a campaign and its report");
  compare->footer(footer);
  option(compare, "--problems", request.problems, "which problems (all of the collection)", "PROBLEMS");
  option(compare, "--methods", request.methods, "which methods (presets)", "METHODS");
  option(compare, "--starts", request.starts, "all starts of each problem, or at most K (all)", "all|K");
  option(compare, "--tol", request.tol,
         "tolerance of the judge, and of the methods unless their options set one (1e-6)", "TOL");
  option(compare, "--time-limit", request.time_limit, "wall-clock limit of a run (60)", "SECONDS");
  option(compare, "--memory-limit", request.memory_mb, "limit of the resident memory of a run (4096)", "MB");
  option(compare, "--jobs", request.jobs, "number of runs at a time (one for each core)", "N");
  option(compare, "--restarts", request.restarts,
         "after a failure, make up to R further runs from perturbed starts (0)", "R");
  option(compare, "--seed", request.seed, "seed of the perturbed starts (1)", "N");
  option(compare, "--external", request.externals,
         "add a program that AMPL could call, as 'COMMAND stub -AMPL'; {tol} in COMMAND is the tolerance of "
         "--tol; may be repeated",
         "NAME=COMMAND")
      ->allow_extra_args(false);
  option(compare, "--shard", request.shard,
         "run part K of N of the cells, for N machines or processes, each with a DIR of its own; 'perp report' joins "
         "the parts",
         "K/N");
  option(compare, "--out", request.out, "folder of the campaign (comparison)", "DIR");
  compare->add_flag("--resume", request.resume, "go on with the campaign in DIR, with its options");
  option(compare, "--baseline", request.baseline,
         "cells.csv or outcomes.csv of an earlier campaign; list what it solved and this one did not", "FILE.csv");
  return compare;
}

}  // namespace perp::app::compare
