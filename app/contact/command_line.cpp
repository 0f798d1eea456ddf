// SPDX-License-Identifier: Apache-2.0
#include "app/contact/command_line.hpp"

#include <fmt/format.h>

#include <ostream>
#include <utility>

#include "app/contact/contact.hpp"
#include "app/contact/run/report.hpp"
#include "app/contact/run/run.hpp"
#include "app/contact/run/variant.hpp"
#include "app/program/command_option.hpp"

namespace perp::app::contacts {

namespace {

constexpr const char* footer =
    "PROBLEM is a file of FCLIB (HDF5) or Siconos (.dat), or NAME:SIZE[:SEED[:MU]]. This makes a problem of about "
    "SIZE\n"
    "contacts: stack, spheres, arch, chain, wall, incline.\n"
    "\n"
    "Examples:\n"
    "  perp contact Capsules.hdf5                              Coulomb's law, by several methods in turn\n"
    "  perp contact wall:100 --formulation inner:8             octagons as friction disks, and the error this makes\n"
    "  perp contact Rover.dat --method path --encoding B --row original\n"
    "  perp contact incline:40:1:0.3 --json - | jq '.contacts[] | select(.state == \"slip\")'\n"
    "  perp contact Rover.dat --method homotopy                only Glocker's NCP by interior points\n"
    "  perp contact --generate stack:60 --fclib-out stack.hdf5\n"
    "  perp-compare contact data/*.dat --out contact-comparison        variants compared\n"
    "  perp-compare facets data/*.dat --facets 4,8,16,32 --svg facets.svg   the errors of polygons, drawn over K\n"
    "  perp-compare forces spheres:200:7 --svg forces.svg      the forces in their friction disks, drawn\n"
    "\n"
    "glocker, coulomb and ncp1 have Coulomb's law. They are solved when two conditions hold. The natural map, "
    "relative\n"
    "to max(|q|, |r|, |u|) and to |q|, is at most the tolerance. So are, at each contact, the violations of cone, "
    "normal\n"
    "and slip, relative to the impulses and velocities there. inner:K, outer:K and frictionless are solved when their\n"
    "own affine problem is solved. By how much they violate Coulomb's law is printed beside it.\n"
    "\n"
    "Exit codes: 0 solved, 1 not solved, 2 wrong usage or input, 3 internal error.";

/// A flag without a value.
std::string misplaced(const CLI::App& command) {
  for (const char* flag : {"--json", "--fclib-out", "--method", "--encoding", "--row", "--form"})
    if (const CLI::Option* option = command.get_option(flag); option->count() > 0 && option->results().back().empty())
      return fmt::format("{}: a name is missing", flag);
  return "";
}

/// Gives all problems the coefficient of friction; why that cannot be.
std::string refusal_of_friction(ContactWords& words) {
  try {
    for (auto* problems : {&words.request.problems, &words.request.generated})
      for (std::string& problem : *problems) problem = with_friction(problem, *words.mu);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

CLI::App* add_command(CLI::App& app, ContactWords& words) {
  CLI::App* contact = app.add_subcommand("contact", "Solve and judge problems of contact with Coulomb friction");
  contact->footer(footer);
  ContactRequest& request = words.request;
  VariantRequest& variant = request.variant;
  option(contact, "PROBLEM", request.problems, "files, or problems to make: NAME:SIZE[:SEED[:MU]]", "...");
  option(contact, "--generate", request.generated, "one more problem to make; may be repeated", "NAME:SIZE[:SEED[:MU]]")
      ->allow_extra_args(false);
  option(contact, "--mu", words.mu, "coefficient of friction of all problems that are made", "MU");
  option(contact, "--formulation", variant.formulation,
         fmt::format("one of {}; default glocker", contact::formulation_names), "NAME");
  option(contact, "--method", variant.method,
         fmt::format(
             "with glocker: auto (the default: several methods in turn), homotopy, or a nonlinear method of 'perp "
             "methods'; with coulomb, which follows from the name: {}; with ncp1: a nonlinear method of 'perp methods' "
             "(path); with the others: auto (the default: Lemke's first), or any method of 'perp methods'",
             classic_names()),
         "NAME");
  option(contact, "--encoding", variant.encoding,
         "with glocker and a method of 'perp methods': A, an MCP, or B, an NCP (B)", "A|B");
  option(contact, "--row", variant.row, "with glocker and a method of 'perp methods': the row of the disk (normalised)",
         "normalised|original");
  option(contact, "--form", variant.form, "with inner and outer: an LCP, or an MLCP with r_T free (reduced)",
         "reduced|mixed");
  option(contact, "-o,--option", variant.options,
         fmt::format("of the method; may be repeated: of auto {}; of homotopy {}; {}; of others what 'perp methods' "
                     "lists, and for glocker {}",
                     contact::own_keys(contact::Auto{}), contact::own_keys(contact::GlockerHomotopy{}), classic_keys(),
                     contact::own_keys(contact::GlockerNcp{})),
         "KEY=VALUE")
      ->allow_extra_args(false);
  option(contact, "--tol", request.tol, "tolerance (1e-8)", "TOL");
  option(contact, "--time-limit", request.time_limit, "give up after this time (30)", "SECONDS");
  option(contact, "--json", request.json,
         "write the result as JSON; - is standard output, the text then goes to standard error", "FILE");
  option(contact, "--fclib-out", request.fclib_out, "write problem and solution as an FCLIB file", "FILE");
  option(contact, "--log-level", words.level,
         fmt::format("one of {}; each shows more than the one before", fmt::join(log_level_names(), ", ")), "LEVEL");
  option(contact, "--rotation", variant.rotation, "with inner:K and outer:K: turn the polygon in its plane (0)",
         "RADIANS");
  contact->add_flag("--full", request.full, "print every contact of a long table");
  option(contact, "--variants", words.variants,
         "say as JSON what the list stands for, FORMULATION[+METHOD][/WORD]..., with * for every METHOD or WORD, and "
         "refuse problems that cannot be read: for programs that run perp",
         "LIST");
  contact->add_flag("--show", words.show, "print what the method tries in turn, and its options, without a problem");
  return contact;
}

int run_command(const CLI::App& command, const ContactWords& given, Streams streams,
                const std::atomic<bool>* interrupt) {
  ContactWords words = given;
  ContactRequest& request = words.request;
  std::string why = misplaced(command);
  if (why.empty() && words.mu) why = refusal_of_friction(words);
  if (!why.empty()) {
    streams.err << "perp contact: " << why << '\n';
    return exit_input;
  }
  if (words.variants) {
    request.problems.insert(request.problems.end(), request.generated.begin(), request.generated.end());
    return list_variants(*words.variants, request.problems, request.json, streams);
  }
  try {
    request.log_level = log_level(words.level);
    if (words.show) {
      show(streams.out, parse_variant(request.variant));
      return exit_solved;
    }
  } catch (const InputError& error) {
    return say_refused(streams, error.what());
  }
  return solve_contact(request, streams, interrupt);
}

}  // namespace perp::app::contacts
