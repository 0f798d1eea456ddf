// SPDX-License-Identifier: Apache-2.0
#include "app/commands/ampl_driver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <ostream>
#include <variant>

#include "app/program/files.hpp"
#include "app/report/bounded_run.hpp"
#include "app/report/report.hpp"
#include "app/text/table.hpp"
#include "lcp/io/file_path.hpp"
#include "ncp/analysis/certificate.hpp"

namespace perp::app {

namespace {

constexpr int dont_print_message = 8;  // of wantsol's bits
constexpr std::array option_variables{"perp_options", "path_options", "pathampl_options"};

struct Call {
  std::string stub;
  std::vector<std::string> words;  // key=value
  char query = 0;                  // v, V, = or ?
};

/// The first argument without a dash is the stub; arguments with one are AMPL's flags, of which -v, -= and -? ask
/// something and the others (-AMPL, -s, -e, ...) change nothing here.
Call parse(const std::vector<std::string>& arguments) {
  Call call;
  for (const std::string& argument : arguments) {
    if (argument == "-v")
      call.query = 'v';
    else if (argument == "--version")
      call.query = 'V';
    else if (argument == "-=")
      call.query = '=';
    else if (argument == "-?" || argument == "-h" || argument == "--help")
      call.query = '?';
    else if (argument.starts_with('-') && argument.size() > 1 && call.words.empty())
      continue;
    else if (call.stub.empty())
      call.stub = argument;
    else
      call.words.push_back(argument);
  }
  return call;
}

void print_usage(std::ostream& out, const std::string& program) {
  out << fmt::format(
      "usage: {} stub [-AMPL] [key=value]...\n\n"
      "Solves the complementarity problem in stub.nl and writes stub.sol.\n"
      "  -v   version\n"
      "  -=   the options\n"
      "  -?   this text\n"
      "Options also from the environment variables perp_options, path_options, pathampl_options.\n",
      program);
}

void print_keywords(std::ostream& out) {
  for (const Option& option : options())
    out << fmt::format("{:<23} {}\n{:24}{}{}{}\n", option.key, option.takes, "", option.help,
                       option.alias.empty() ? "" : "; also ", option.alias);
  out << fmt::format("{:<24}a file\n{:24}of options, one a line: key value\n", "optfile", "");
}

ExitCode answer(const Call& call, const std::string& program, Streams streams) {
  if (call.query == 'v')
    streams.out << version_line() << '\n';
  else if (call.query == 'V')
    streams.out << version_text();
  else if (call.query == '=')
    print_keywords(streams.out);
  else
    print_usage(streams.out, program);
  return exit_solved;
}

void append(std::vector<Assignment>& all, const std::vector<Assignment>& given) {
  for (const Assignment& assignment : given) {
    if (assignment.key == "optfile") {
      const std::vector<Assignment> file = read_options_file(assignment.value);
      all.insert(all.end(), file.begin(), file.end());
    } else {
      all.push_back(assignment);
    }
  }
}

std::vector<Assignment> assignments(const AmplRequest& request, const Call& call) {
  std::vector<Assignment> all{{.key = "output", .value = "no", .source = "AMPL"}};  // AMPL prints what we print
  for (const char* name : option_variables)
    if (const char* text = request.environment(name))
      append(all, parse_words(text, fmt::format("environment variable {}", name)));
  append(all, parse_words(call.words, "command line"));
  return all;
}

std::string listed_notes(const ncp::Result& result) {
  std::string text;
  for (const std::string& note : result.notes) text += "\nNote: " + note;
  return text;
}

std::string message(const Report& report) {
  const ncp::Result& result = report.result;
  if (result.solved())
    return fmt::format("Perp {}: solution found. {}; {}; {}; natural residual {:.1e}", version_number(),
                       count(result.stats.iterations, "iteration"), count(result.stats.F_evals, "F evaluation"),
                       count(result.stats.J_evals, "Jacobian"), result.residual.natural) +
           listed_notes(result);
  if (result.status == ncp::Status::SolvedToRounding)
    return fmt::format("Perp {}: solved to rounding only, natural residual {:.1e}: {}.\nTry: {}.", version_number(),
                       result.residual.natural, result.message, result.advice) +
           listed_notes(result);
  std::string text =
      fmt::format("Perp {}: no solution found, {} after {}: {}.", version_number(), ncp::to_string(result.status),
                  count(result.stats.iterations, "iteration"), result.message);
  if (result.proof.certificate)
    text += fmt::format("\nProof: {} contradict each other.", ncp::rows_in_words(*report.problem->mcp, result.proof));
  if (!result.advice.empty()) text += fmt::format("\nTry: {}.", result.advice);
  return text + listed_notes(result);
}

/// There is no point to answer with: says so to the person and, in the .sol file, to AMPL. Whether that was written.
bool answer_without_point(const std::string& program, const std::string& stub, int code, const std::string& why,
                          Streams streams) {
  streams.err << program << ": " << why << '\n';
  try {
    ncp::ampl::write_failed_sol(stub, printable(fmt::format("Perp {}: {}", version_number(), why)), code);
    return true;
  } catch (const ncp::ampl::ModelError& error) {
    streams.err << program << ": " << error.what() << '\n';
    return false;
  }
}

/// The model was refused.
ExitCode refuse(const std::string& program, const std::string& stub, int code, const std::string& why,
                Streams streams) {
  answer_without_point(program, stub, code, why, streams);
  return exit_input;
}

ExitCode write_answer(const AmplRequest& request, const Report& report, const std::string& stub, Streams streams) {
  const std::string text = printable(message(report));  // AMPL shows it on a terminal
  if ((report.settings.wantsol & dont_print_message) == 0) streams.out << text << std::endl;
  const ncp::ampl::Model& model = *report.problem->model;
  const int code = solve_result_num(report.result.status);
  try {
    if (report.result.x.allFinite())
      model.write_sol(text, report.result.x.head(model.n_var()), code);
    else
      ncp::ampl::write_failed_sol(stub, text, code);
    return exit_solved;
  } catch (const ncp::ampl::ModelError& error) {
    streams.err << request.program << ": " << error.what() << '\n';
    return exit_input;
  }
}

/// The answer must not replace what is read.
std::vector<FileUse> inputs_of(const AmplRequest& request, const Call& call, const std::string& stub) {
  std::vector<FileUse> inputs;
  for (const char* ending : {".nl", ".col", ".row"}) inputs.push_back({"", stub + ending});
  const auto add = [&](const std::vector<Assignment>& given) {
    for (const Assignment& assignment : given)
      if (assignment.key == "optfile") inputs.push_back({"optfile", assignment.value});
  };
  for (const char* name : option_variables)
    if (const char* text = request.environment(name)) add(parse_words(text, name));
  add(parse_words(call.words, "command line"));
  return inputs;
}

ExitCode solve_stub(const AmplRequest& request, const Call& call, Streams streams, const std::atomic<bool>* interrupt) {
  Applied options = apply_options(assignments(request, call), Unknown::Report);
  for (const std::string& unknown : options.unknown) streams.err << request.program << ": warning: " << unknown << '\n';
  // Always a file, even if the collection has a problem of that name.
  const std::string file = call.stub.ends_with(".nl") ? call.stub : call.stub + ".nl";
  const Patience limits = patience(ncp::stop(options.settings.method).max_time, interrupt);
  end_by(limits.deadline);
  const auto loaded = load_within(
      limits, [file] { return load_problem(file); }, fmt::format("'{}' was being read", file));
  const LoadedProblem& problem = *loaded;
  note_limits_of_size(problem.mcp->size(), options);
  for (const std::string& note : options.notes) streams.err << request.program << ": note: " << note << '\n';
  if (std::holds_alternative<ncp::Affine>(options.settings.method) && !problem.mcp->is_affine())
    throw ncp::ampl::ModelError(ncp::ampl::not_applicable, "the method is for affine problems, and this one is not");
  const Output& output = options.settings.output;
  if (output.shows(output.options)) print_options(streams.out, options.settings);
  if (output.shows(output.initial_statistics)) print_initial_statistics(streams.out, problem);
  const Report report =
      run_within(limits, loaded, options.settings, problem.mcp->size(), output.table() ? &streams.out : nullptr);
  writing_takes(patience_with_writing(problem.mcp->size()));
  if (output.shows(output.final_statistics)) print_final_statistics(streams.out, report);
  if (output.shows(output.final_summary)) print_final_summary(streams.out, report);
  return write_answer(request, report, call.stub, streams);
}

}  // namespace

bool is_ampl_call(const std::string& program, const std::vector<std::string>& arguments) {
  if (program == "pathampl" || std::ranges::find(arguments, "-AMPL") != arguments.end()) return true;
  return arguments.size() == 1 && (arguments[0] == "-v" || arguments[0] == "-=" || arguments[0] == "-?");
}

int solve_result_num(ncp::Status status) {
  switch (status) {
    case ncp::Status::Solved:
      return 0;
    case ncp::Status::SolvedToRounding:  // AMPL: "solved?"
      return 100;
    case ncp::Status::IterationLimit:
      return 400;
    case ncp::Status::TimeLimit:
      return 402;
    case ncp::Status::Interrupted:
      return 403;
    case ncp::Status::LinearAlgebraFailed:
      return 501;
    case ncp::Status::OutOfMemory:
      return 502;
    case ncp::Status::EvaluationFailed:
      return 503;
    case ncp::Status::Infeasible:
      return 201;
    case ncp::Status::Unbounded:
      return 300;
    case ncp::Status::NotApplicable:
      return ncp::ampl::not_applicable;
    case ncp::Status::StationaryPoint:
    case ncp::Status::NoProgress:
    case ncp::Status::Stalled:
    case ncp::Status::Ray:
    case ncp::Status::Singular:
    case ncp::Status::SubproblemFailed:  // no error, but an end of what the method can do from here: another start may
                                         // do
      return 510;
  }
  return 500;
}

ExitCode ampl_driver(const AmplRequest& request, Streams streams, const std::atomic<bool>* interrupt) {
  const Call call = parse(request.arguments);
  if (call.query != 0) return answer(call, request.program, streams);
  if (call.stub.empty()) {
    print_usage(streams.err, request.program);
    return exit_input;
  }
  const std::string file = call.stub.ends_with(".nl") ? call.stub : call.stub + ".nl";
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(lcp::file_path(file), ignored)) {  // no model to answer
    streams.err << fmt::format("{}: there is no file '{}'\n", request.program, file);
    return exit_input;
  }
  const std::string stub = file.substr(0, file.size() - 3);
  try {
    check_apart(std::vector<FileUse>{{"", stub + ".sol"}}, inputs_of(request, call, stub));
  } catch (const InputError& error) {
    streams.err << request.program << ": " << error.what() << '\n';
    return exit_input;
  }
  try {
    return solve_stub(request, call, streams, interrupt);
  } catch (const ncp::ampl::ModelError& error) {
    return refuse(request.program, call.stub, error.code(), error.what(), streams);
  } catch (const OutOfTime& out) {
    const int code = solve_result_num(out.status());
    return answer_without_point(request.program, call.stub, code, out.what(), streams) ? exit_solved : exit_input;
  } catch (const InputError& error) {
    return refuse(request.program, call.stub, ncp::ampl::bad_file, error.what(), streams);
  } catch (const std::invalid_argument& error) {
    return refuse(request.program, call.stub, ncp::ampl::bad_file, error.what(), streams);
  }
}

}  // namespace perp::app
