// SPDX-License-Identifier: Apache-2.0
#include "app/contact/command_line.hpp"

#include <fmt/format.h>

#include <ostream>
#include <utility>

#include "app/contact/compare/compare_variants.hpp"
#include "app/contact/contact.hpp"
#include "app/contact/run/variant.hpp"
#include "app/contact/studies/ball.hpp"
#include "app/contact/studies/facets.hpp"
#include "app/program/command_option.hpp"

namespace perp::app::contacts {

namespace {

constexpr const char* footer =
    "PROBLEM is a file of FCLIB (HDF5) or Siconos (.dat), or NAME:SIZE[:SEED[:MU]], a problem that is made with about "
    "SIZE\n"
    "contacts: stack, spheres, arch, chain, wall, incline.\n"
    "\n"
    "Examples:\n"
    "  perp contact Capsules.hdf5                              Coulomb's law, by several methods until one solves it\n"
    "  perp contact spheres:200:7 --svg forces.svg             the forces in their friction disks\n"
    "  perp contact wall:100 --formulation inner:8             friction by octagons, and what that costs\n"
    "  perp contact Rover.dat --method path --encoding B --row original\n"
    "  perp contact arch:40 --json - | jq '.contacts[] | select(.state == \"slip\")'\n"
    "  perp contact Rover.dat --method homotopy                Glocker's NCP by interior points, and nothing else\n"
    "  perp contact --generate stack:60 --fclib-out stack.hdf5\n"
    "  perp contact data/*.dat --compare --out contact-comparison\n"
    "  perp contact data/*.dat --facets 4,8,16,32 --svg facets.svg   what facets cost by the exact law, over K\n"
    "  perp contact --compare --out contact-comparison --resume    after Ctrl-C, kill -9 or a power cut\n"
    "  perp contact ball --svg ball.svg                        time stepping: what facets do to a path\n"
    "  perp contact wall:40 arch:40 --compare --variants glocker,glocker+path/B,inner:4,inner:16,ncp1\n"
    "\n"
    "glocker, coulomb and ncp1 are solved when Coulomb's law holds at r: the natural map relative to max(|q|, |r|, "
    "|u|) and to\n"
    "|q| is at most the tolerance, and so are, contact by contact, the violations of cone, normal and slip relative "
    "to\n"
    "the impulses and velocities there. inner:K, outer:K and frictionless are solved when their own affine problem is; "
    "what\n"
    "Coulomb's law says of them stands beside it.\n"
    "\n"
    "Exit codes: 0 solved (--compare: complete), 1 not solved, 2 wrong usage or input, 3 internal error, 4 a "
    "comparison\n"
    "that was interrupted (--resume goes on).";

/// Flags of another mode: one run, --compare, --facets.
std::string misplaced(const CLI::App& command, const ContactWords& words) {
  const auto given = [&](const char* flag) { return command.count(flag) > 0; };
  for (const auto& [flag, file] :
       {std::pair{"--json", words.json}, std::pair{"--svg", words.svg}, std::pair{"--fclib-out", words.fclib_out},
        std::pair{"--out", words.out.value_or("")}})
    if (given(flag) && file.empty()) return fmt::format("{}: a name is missing", flag);
  const bool facets = given("--facets");
  if (words.compare && facets) return "--facets is a study of its own; --compare runs inner:8,outer:8 of --variants";
  if (words.compare) {
    for (const char* flag : {"--formulation", "--method", "--encoding", "--row", "--form"})
      if (given(flag))
        return fmt::format("{}: --compare runs what --variants lists, as in glocker+path/B,inner:8", flag);
    for (const char* flag : {"--option", "--svg", "--fclib-out", "--log-level", "--full"})
      if (given(flag)) return fmt::format("{} goes with one run, not with --compare", flag);
    return "";
  }
  for (const char* flag : {"--variants", "--out", "--resume", "--memory-limit", "--jobs"})
    if (given(flag)) return fmt::format("{} goes with --compare", flag);
  if (!facets) return "";
  for (const char* flag : {"--formulation", "--method", "--encoding", "--row"})
    if (given(flag)) return fmt::format("{}: --facets runs inner:K and outer:K, by Lemke's method first", flag);
  for (const char* flag : {"--option", "--fclib-out", "--log-level", "--full"})
    if (given(flag)) return fmt::format("{} goes with one run, not with --facets", flag);
  return "";
}

std::optional<std::string> if_given(const CLI::App& command, const char* flag, const std::string& value) {
  return command.count(flag) > 0 ? std::optional(value) : std::nullopt;
}

std::vector<std::string> all_problems(const ContactWords& words) {
  std::vector<std::string> all = words.problems;
  all.insert(all.end(), words.generated.begin(), words.generated.end());
  return all;
}

/// Gives all problems the coefficient of friction; why that cannot be.
std::string refusal_of_friction(ContactWords& words) {
  try {
    for (auto* problems : {&words.problems, &words.generated})
      for (std::string& problem : *problems) problem = with_friction(problem, *words.mu);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

ExitCode run_facets(const ContactWords& words, Streams streams, const std::atomic<bool>* interrupt) {
  FacetsRequest request{.problems = all_problems(words), .facets = words.facets, .svg = words.svg, .json = words.json};
  if (!words.form.empty()) request.form = words.form;
  request.tol = words.tol.value_or(request.tol);
  request.time_limit = words.time_limit.value_or(request.time_limit);
  return facets(request, streams, interrupt);
}

}  // namespace

CLI::App* add_command(CLI::App& app, ContactWords& words) {
  CLI::App* contact = app.add_subcommand("contact", "Unilateral contact with Coulomb friction: solve, judge, compare");
  contact->footer(footer);
  option(contact, "PROBLEM", words.problems, "files, or problems that are made: NAME:SIZE[:SEED[:MU]]", "...");
  option(contact, "--generate", words.generated, "one more problem that is made; may be repeated",
         "NAME:SIZE[:SEED[:MU]]")
      ->allow_extra_args(false);
  option(contact, "--mu", words.mu, "coefficient of friction of all problems that are made, in place of the scene's",
         "MU");
  option(contact, "--formulation", words.formulation,
         fmt::format("one of {}; default glocker", contact::formulation_names), "NAME");
  option(
      contact, "--method", words.method,
      fmt::format(
          "of glocker auto (its default: sweeps, cones, homotopy, Newton steps, proximal loop) or homotopy alone; of "
          "coulomb "
          "(which follows from the name) {}; or a method of 'perp methods': for glocker and ncp1 (default path) those "
          "for nonlinear problems, for the others (default auto: Lemke's first) those for affine ones, or for "
          "nonlinear ones",
          classic_names()),
      "NAME");
  option(contact, "--encoding", words.encoding, "of glocker by a method of 'perp methods': A, an MCP, or B, an NCP (B)",
         "A|B");
  option(contact, "--row", words.row, "of glocker by a method of 'perp methods': the disk's equation (normalised)",
         "normalised|original");
  option(contact, "--form", words.form, "of inner and outer: an LCP, or an MLCP with r_T free (reduced)",
         "reduced|mixed");
  option(contact, "-o,--option", words.options,
         fmt::format("of the method; may be repeated: of homotopy {}; of auto these and {}; {}; of others what 'perp "
                     "methods' lists, and for glocker {}",
                     homotopy_keys(), auto_keys(), classic_keys(), glocker_keys()),
         "KEY=VALUE")
      ->allow_extra_args(false);
  option(contact, "--tol", words.tol, "tolerance (1e-8; of --facets 1e-9)", "TOL");
  option(contact, "--time-limit", words.time_limit, "give up after that time; of --compare and --facets: each run (30)",
         "SECONDS");
  option(contact, "--json", words.json,
         "write the result as JSON; - is standard output, the text then goes to standard error", "FILE");
  option(contact, "--fclib-out", words.fclib_out, "write problem and solution as an FCLIB file", "FILE");
  option(contact, "--svg", words.svg, "draw the forces in their friction disks; of --facets: the errors over K",
         "FILE");
  option(contact, "--log-level", words.level,
         fmt::format("one of {}; each shows more than the one before", fmt::join(log_level_names(), ", ")), "LEVEL");
  contact->add_flag("--full", words.full, "print every contact of a long table");
  contact->add_flag("--compare", words.compare, "run variants on all problems, each in a process of its own");
  option(contact, "--variants", words.variants,
         fmt::format(
             "of a comparison: FORMULATION[+METHOD][/WORD]...; a method * is each one, a word * each form; default {}",
             default_variants),
         "LIST");
  option(contact, "--out", words.out, "of a comparison: where its files go (contact-comparison)", "DIR");
  contact->add_flag("--resume", words.resume,
                    "of a comparison: go on with the one in DIR; what is not given is as it was");
  option(contact, "--memory-limit", words.memory_mb, "of a comparison: resident memory of a run (4096)", "MB");
  option(contact, "--jobs", words.jobs, "of a comparison: runs at a time (1, so that times compare)", "N");
  option(contact, "--facets", words.facets,
         "by polygons of each K of the list, in the disk and about it: the errors by the exact law, and how they fall",
         "K,K,...");
  add_ball_command(*contact, words.ball);
  return contact;
}

int run_command(const CLI::App& command, const ContactWords& given, Streams streams,
                const std::atomic<bool>* interrupt) {
  if (command.got_subcommand("ball")) return run_ball_command(command, given.ball, streams, interrupt);
  ContactWords words = given;
  std::string why = misplaced(command, words);
  if (why.empty() && words.mu) why = refusal_of_friction(words);
  if (!why.empty()) {
    streams.err << "perp contact: " << why << '\n';
    return exit_input;
  }
  if (words.compare) {
    CompareVariantsRequest request{.problems = all_problems(words), .json = words.json};
    request.variants = words.variants;
    request.tol = words.tol;
    request.time_limit = words.time_limit;
    request.memory_mb = words.memory_mb;
    request.jobs = words.jobs.value_or(request.jobs);
    request.out = words.out.value_or(request.out);
    request.resume = words.resume;
    return compare_variants(request, streams, interrupt);
  }
  if (command.count("--facets") > 0) return run_facets(words, streams, interrupt);
  ContactRequest request{.problems = words.problems,
                         .generated = words.generated,
                         .json = words.json,
                         .fclib_out = words.fclib_out,
                         .svg = words.svg,
                         .full = words.full};
  request.variant = {.method = if_given(command, "--method", words.method),
                     .encoding = if_given(command, "--encoding", words.encoding),
                     .row = if_given(command, "--row", words.row),
                     .form = if_given(command, "--form", words.form),
                     .options = words.options};
  if (command.count("--formulation") > 0) request.variant.formulation = words.formulation;
  request.tol = words.tol.value_or(request.tol);
  request.time_limit = words.time_limit.value_or(request.time_limit);
  try {
    request.log_level = log_level(words.level);
  } catch (const InputError& error) {
    return say_refused(streams, error.what());
  }
  return solve_contact(request, streams, interrupt);
}

}  // namespace perp::app::contacts
