// SPDX-License-Identifier: Apache-2.0
#include "app/command_line.hpp"

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <array>
#include <filesystem>
#include <ostream>

#include "app/commands/commands.hpp"
#include "app/commands/explain.hpp"
#include "app/commands/inspect.hpp"
#include "app/commands/solve.hpp"
#include "app/contact/command_line.hpp"
#include "app/options/methods.hpp"
#include "app/program/command_option.hpp"
#include "app/program/files.hpp"
#include "app/report/report.hpp"
#include "collection/collection.hpp"
#include "lcp/io/file_path.hpp"

namespace perp::app {

namespace {

constexpr const char* about =
    "Perp solves mixed complementarity problems: find x between l and u with\n"
    "  F_i(x) >= 0 where x_i = l_i,   F_i(x) <= 0 where x_i = u_i,   F_i(x) = 0 between them.";

constexpr const char* main_footer =
    "Examples:\n"
    "  perp solve market.nl             solve an AMPL model\n"
    "  perp solve kojshin --start 2     solve a problem of the collection\n"
    "  perp inspect market.nl           its size, structure, scaling, start and derivatives, before it is solved\n"
    "  perp explain market.nl           why it has no solution, which row is the cause, what would mend it\n"
    "  perp judge market.nl x.mtx       is the point in this file a solution?\n"
    "  perp list                        the problems of the collection\n"
    "  perp export kojshin --nl         write a problem as an AMPL model, for other solvers\n"
    "  perp export ahn -o F.mtx         write an affine problem as Matrix Market files\n"
    "  perp contact spheres:200         contact with friction: a generated problem, or a file of Siconos or FCLIB\n"
    "  perp methods                     the methods and their options\n"
    "  perp cfunctions                  the complementarity functions and smoothings that methods use\n"
    "  perp-compare --problems class:tiny  run every method on every problem, and make a report\n"
    "  perp market -AMPL tol=1e-10      as AMPL calls a solver: reads market.nl, writes market.sol\n"
    "\n"
    "Exit codes: 0 solved, 1 not solved, 2 wrong usage or input, 3 internal error.\n"
    "'perp COMMAND --help' explains a command, and 'man perp' explains everything.";

constexpr const char* solve_footer =
    "Examples:\n"
    "  perp solve market.nl --tol 1e-10\n"
    "  perp solve kojshin --start 3 --method josephy\n"
    "  perp solve nash10 --option nms_memory_size=10 --option lu=klu\n"
    "  perp solve market.nl --json result.json --log-level summary\n"
    "  perp solve M.mtx q.mtx --lower psi.mtx --method qp --solution x.mtx\n"
    "  perp solve market.nl --plot path.svg\n"
    "  perp solve market2.nl --warm-start result.json\n"
    "  perp solve kehoe --all\n"
    "  perp solve market.nl --json - | jq .residual.natural\n"
    "\n"
    "Ctrl-C ends the run. The best point so far is printed and written. A second Ctrl-C ends the program.\n"
    "A problem counts as solved when its natural residual max_i |x_i - mid(l_i, x_i - F_i(x), u_i)| is at most the\n"
    "tolerance. The method has no say in this. 'perp methods' explains the options.";

constexpr const char* inspect_footer =
    "Examples:\n"
    "  perp inspect market.nl\n"
    "  perp inspect kojshin --start 2\n"
    "  perp inspect M.mtx q.mtx                        also the classes of M and what they guarantee\n"
    "  perp inspect market.nl --json - | jq .concerns\n"
    "\n"
    "A line with ! deserves a second look. The exit code is 0 whatever was found, and 2 for bad input.";

constexpr const char* judge_footer =
    "Examples:\n"
    "  perp solve market.nl --solution x.mtx && perp judge market.nl x.mtx\n"
    "  perp judge kojshin --start 2\n"
    "  perp judge kojshin --json - | jq .residual.natural\n"
    "\n"
    "The natural residual is max_i |x_i - mid(l_i, x_i - F_i(x), u_i)|. A point that is out of its bounds by at most\n"
    "the tolerance is judged at the bounds. Exit codes: 0 a solution, 1 none, 2 bad input.";

constexpr const char* list_footer =
    "Examples:\n"
    "  perp list\n"
    "  perp list --class kkt,games --json\n"
    "  perp list kojshin           starts, bounds, known solutions and their residuals\n"
    "  perp list walras-own        a problem of any size: 'perp solve walras-own:400x300x300:7'\n"
    "  perp list kojshin --json    the same for programs, with all digits";

constexpr const char* export_footer =
    "Examples:\n"
    "  perp export kojshin -o F.nl      writes F.nl, F.col, F.row, for any solver that reads AMPL's models\n"
    "  perp export cottle4 -o F.mtx     writes F.mtx, F-q.mtx, F-lower.mtx, F-upper.mtx, F-start.mtx\n"
    "  perp export lq-control-own:1000 --start 2 -o F.mtx\n"
    "\n"
    "The command that solves the files is printed. They hold the same problem, digit for digit.";

constexpr const char* explain_footer =
    "Examples:\n"
    "  perp explain market.nl\n"
    "  perp explain market.nl --json - | jq '.answers[0]'";

constexpr const char* methods_footer =
    "Examples:\n"
    "  perp methods\n"
    "  perp methods --show path\n"
    "  perp solve kojshin --method josephy --option lemke_start=always";

constexpr const char* cfunctions_footer =
    "Examples:\n"
    "  perp cfunctions\n"
    "  perp solve kojshin --method semismooth --option cfunction=kanzow-kleinmichel --option cfunction_parameter=1\n"
    "  perp solve kojshin --method smooth --option smoothing_function=chks";

/// Options with a flag of their own on `perp solve`.
struct Shortcut {
  const char* flag;
  const char* value;  // for the help
  const char* key;
  const char* help;
};
constexpr std::array shortcuts{
    Shortcut{"--method", "NAME", "method", "one of"},  // and their names
    Shortcut{"--tol", "TOL", "convergence_tolerance", "tolerance on the natural residual"},
    Shortcut{"--tol-relative", "R", "relative_tolerance",
             "ask also for |F_i| <= R (size of its terms) where x_i is off its bounds"},
    Shortcut{"--max-iterations", "N", "major_iteration_limit", "give up after N iterations"},
    Shortcut{"--time-limit", "SECONDS", "time_limit", "give up after this time"},
};

struct CommandLine {
  CLI::App app{about, "perp"};
  CLI::App* solve = nullptr;
  CLI::App* inspect = nullptr;
  CLI::App* explain = nullptr;
  CLI::App* list = nullptr;
  CLI::App* methods = nullptr;
  std::string shown_method{};
  bool methods_as_json = false;
  std::vector<std::string> method_options{};
  CLI::App* judge = nullptr;
  JudgeRequest judge_request{};
  CLI::App* cfunctions = nullptr;
  CLI::App* export_command = nullptr;
  CLI::App* contact = nullptr;
  SolveRequest solve_request;
  InspectRequest inspect_request;
  ExplainRequest explain_request;
  ListRequest list_request;
  ExportRequest export_request;
  contacts::ContactWords contact_words;
  std::array<std::string, shortcuts.size()> shortcut_values;
  std::string level = "info";
  std::string all;
  bool check_derivatives = false, verify = false;
  bool version = false;

  CommandLine() {
    app.footer(main_footer);
    app.require_subcommand(0, 1);
    app.add_flag("-V,--version", version, "version, licence and linked libraries (-v alone: one line)");
    add_solve();
    add_inspect();
    add_explain();
    add_judge();
    list = app.add_subcommand("list", "List the collection of test problems, or describe one of them");
    list->footer(list_footer);
    option(list, "NAME", list_request.name, "show everything about this one", " ");
    option(list, "--class", list_request.classes, "list only problems of these classes", "CLASS[,CLASS]")
        ->allow_extra_args(false);
    list->add_flag("--json", list_request.json, "as JSON");
    add_export();
    methods =
        app.add_subcommand("methods", "List the methods with their references, and all options with their defaults");
    methods->footer(methods_footer);
    option(methods, "--show", shown_method, "show what METHOD tries in turn, and its options", "METHOD");
    option(methods, "-o,--option", method_options, "with --show and --json: an option that is set; may be repeated",
           "KEY=VALUE")
        ->allow_extra_args(false);
    methods->add_flag("--json", methods_as_json,
                      "write methods and C-functions as JSON; with --show also the options in force");
    cfunctions = app.add_subcommand("cfunctions",
                                    "List the C-functions and smoothings with formulas, properties and references");
    cfunctions->footer(cfunctions_footer);
    contact = contacts::add_command(app, contact_words);
  }

  void add_export() {
    export_command = app.add_subcommand(
        "export", "Write a problem of the collection as an AMPL model, or an affine one as Matrix Market files");
    export_command->footer(export_footer);
    option(export_command, "PROBLEM", export_request.source.problem, "a NAME that 'perp list' shows, or FILE.nl", " ")
        ->required();
    option(export_command, "-o,--output", export_request.file,
           "F.nl, with F.col and F.row beside it; or F.mtx, the matrix, with F-q.mtx and other vectors beside it",
           "FILE");
    export_command->add_flag("--nl", export_request.nl,
                             "write an .nl file; its name is PROBLEM.nl unless -o gives one");
    option(export_command, "--start", export_request.source.start, "which start is written, counted from 1", "K");
    export_command->add_flag("--force", export_request.force, "overwrite files");
  }

  template <class Source>
  static void add_problem(CLI::App* command, Source& source, const char* start_at) {
    option(command, "PROBLEM", source.problem,
           "FILE.nl, a NAME that 'perp list' shows, M.mtx (Matrix Market) or FILE.dat (Siconos)", " ")
        ->required();
    option(command, "VECTOR", source.q, "q.mtx, beside M.mtx: the problem is affine, F(x) = M x + q", " ");
    option(command, "--lower", source.lower, "with M.mtx: the lower bounds, a number for all or a file (default 0)",
           "NUMBER|FILE");
    option(command, "--upper", source.upper, "with M.mtx: the upper bounds, a number for all or a file (default inf)",
           "NUMBER|FILE");
    option(command, "--rows", source.rows,
           "with M.mtx: A of a variational inequality over b <= A x <= c and the bounds", "A.mtx");
    option(command, "--row-lower", source.row_lower, "with --rows: b, a number for all or a file (default -inf)",
           "NUMBER|FILE");
    option(command, "--row-upper", source.row_upper, "with --rows: c, a number for all or a file (default inf)",
           "NUMBER|FILE");
    option(command, "--start", source.start, "which start of a problem of the collection, counted from 1", "K");
    option(command, "--start-at", source.start_at, start_at, "FILE");
  }

  void add_solve() {
    solve = app.add_subcommand("solve", "Solve an AMPL model or a problem of the collection");
    solve->footer(solve_footer);
    SolveRequest& request = solve_request;
    add_problem(solve, request, "start from the point in this file");
    option(solve, "--warm-start", request.warm_start,
           "start from the point and basis in the --json FILE of an earlier run", "FILE");
    for (std::size_t k = 0; k < shortcuts.size(); ++k)
      option(solve, shortcuts[k].flag, shortcut_values[k],
             shortcuts[k].help != std::string_view("one of")
                 ? shortcuts[k].help
                 : fmt::format("one of {}: 'perp methods' explains them", fmt::join(method_names(), ", ")),
             shortcuts[k].value);
    solve->add_flag("--check-derivatives", check_derivatives,
                    "compare the Jacobian with differences at the start; refuse a wrong one");
    solve->add_flag("--verify", verify,
                    "prove by interval arithmetic that exactly one solution is near the point found, and say how near");
    option(solve, "-o,--option", request.options, "an option of 'perp methods'; may be repeated", "KEY=VALUE")
        ->allow_extra_args(false);
    option(solve, "--all", all, fmt::format("look for up to K solutions (default {}), by deflation", default_solutions),
           "[K]")
        ->expected(0, 1);
    option(solve, "--options-file", request.options_file, "read options from FILE, one on each line: key value",
           "FILE");
    option(solve, "--solution", request.solution, "write x as a Matrix Market vector", "FILE");
    option(solve, "--json", request.json,
           "write the result as JSON; - is standard output, the log then goes to standard error", "FILE");
    option(solve, "--log-level", level,
           fmt::format("one of {}; each shows more than the one before", fmt::join(log_level_names(), ", ")), "LEVEL");
    option(solve, "--plot", request.plot, "draw merit and residual, and the path of one iteration, as SVG", "FILE");
    option(solve, "--plot-iteration", request.plot_iteration,
           "which iteration --plot draws (default: the one with most kinks)", "K");
    solve->add_flag("--full", request.full, "print every row of a long solution");
  }

  void add_judge() {
    judge = app.add_subcommand("judge", "Evaluate the natural residual of a point: is it a solution?");
    judge->footer(judge_footer);
    ProblemSource& source = judge_request.source;
    option(judge, "PROBLEM", source.problem,
           "FILE.nl, a NAME that 'perp list' shows, or FILE.dat (Siconos); 'perp solve --help' says more", " ")
        ->required();
    option(judge, "POINT", judge_request.point, "a Matrix Market vector (default: the problem's start)", " ");
    option(judge, "--start", source.start, "without POINT: which start, counted from 1", "K");
    option(judge, "--tol", judge_request.tol, "what the residual may be at a solution (1e-8)", "TOL");
    option(judge, "--json", judge_request.json,
           "write the verdict as JSON; - is standard output, the text then goes to standard error", "FILE");
    judge->add_flag("--full", judge_request.full, "bounds and point in the JSON, too");
  }

  void add_inspect() {
    inspect = app.add_subcommand("inspect", "Tell what is known about a problem before it is solved");
    inspect->footer(inspect_footer);
    add_problem(inspect, inspect_request.source, "look at the point in this file");
    option(inspect, "--json", inspect_request.json,
           "write the findings as JSON; - is standard output, the text then goes to standard error", "FILE");
  }

  void add_explain() {
    explain =
        app.add_subcommand("explain", "Say why a model has no solution, which row is the cause, what would mend it");
    explain->footer(explain_footer);
    add_problem(explain, explain_request.source, "start from the point in this file");
    option(explain, "--time-limit", explain_request.time_limit, "for all of it (30)", "SECONDS");
    option(explain, "--json", explain_request.json,
           "write the answers as JSON; - is standard output, the text then goes to standard error", "FILE");
  }

  void finish_solve_request() {
    solve_request.log_level = log_level(level);
    if (solve->count("--all") > 0) solve_request.all = parse_solutions(all);
    for (std::size_t k = 0; k < shortcuts.size(); ++k)
      if (solve->count(shortcuts[k].flag) > 0)
        solve_request.flags.push_back({shortcuts[k].key, shortcut_values[k], shortcuts[k].flag});
    if (verify) solve_request.flags.push_back({"verify", "yes", "--verify"});
    if (check_derivatives) solve_request.flags.push_back({"check_derivatives", "yes", "--check-derivatives"});
  }
};

/// Where commands have gone that were a part of the program; "" for others.
std::string moved(const std::vector<std::string>& arguments) {
  const auto has = [&](const char* word) { return std::ranges::find(arguments, word) != arguments.end(); };
  if (arguments[0] == "compare" || arguments[0] == "report") return "perp-" + arguments[0];
  if (arguments[0] == "contact" && has("--compare")) return "perp-compare contact";
  if (arguments[0] == "contact" && has("--facets")) return "perp-compare facets";
  if (arguments[0] == "contact" && has("ball")) return "perp-compare ball";
  if (arguments[0] == "contact" && has("--svg")) return "perp-compare forces";
  return "";
}

/// A first word that is no command: what was meant?
void check_command(const CLI::App& app, const std::string& word, const Streams& streams, bool& known) {
  std::vector<std::string> names{"help"};
  for (const CLI::App* command : app.get_subcommands(nullptr)) names.push_back(command->get_name());
  const std::vector<std::string_view> commands(names.begin(), names.end());
  known = word.starts_with('-') || std::ranges::find(commands, word) != commands.end();
  if (known) return;
  std::string hint = did_you_mean(word, commands);
  std::error_code ignored;
  if (word.ends_with(".nl") || std::filesystem::exists(perp::lcp::file_path(word + ".nl"), ignored) ||
      perp::ncp::collection::find(word) != nullptr)
    hint = fmt::format(" Did you mean 'perp solve {}'?", word);
  streams.err << fmt::format("perp: there is no command '{}'.{} 'perp --help' lists the commands.\n", word, hint);
}

/// What is wrong with the command line, with the closest flag for one that does not exist.
std::string parse_message(const CLI::App& app, const CLI::ParseError& error) {
  const std::string what = error.what();
  const std::size_t dashes = what.rfind("--");
  if (dynamic_cast<const CLI::ExtrasError*>(&error) == nullptr || dashes == std::string::npos) return what + '.';
  const std::string given = what.substr(dashes, what.find_first_of(" =", dashes) - dashes);
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  const std::vector<std::string_view> views(names.begin(), names.end());
  return fmt::format("there is no flag '{}'.{}", given, did_you_mean(given, views));
}

}  // namespace

int run_command(std::vector<std::string> arguments, Streams streams, const std::atomic<bool>* interrupt) {
  if (!arguments.empty() && arguments[0] == "help") {  // perp help solve
    arguments.erase(arguments.begin());
    arguments.emplace_back("--help");
  }
  CommandLine line;
  bool known = true;
  if (const std::string now = arguments.empty() ? "" : moved(arguments); !now.empty()) {
    streams.err << fmt::format("perp: this is '{}' now, a program of the Python package perp.lab; see '{} --help'\n",
                               now, now);
    return exit_input;
  }
  if (!arguments.empty()) check_command(line.app, arguments[0], streams, known);
  if (!known) return exit_input;

  try {
    line.app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::CallForHelp&) {
    const auto chosen = line.app.get_subcommands();
    streams.out << (chosen.empty() ? line.app.help() : chosen[0]->help("perp"));
    return exit_solved;
  } catch (const CLI::ParseError& error) {
    const CLI::App* chosen = &line.app;
    std::string command = "perp";
    while (!chosen->get_subcommands().empty()) {
      chosen = chosen->get_subcommands()[0];
      command += " " + chosen->get_name();
    }
    streams.err << fmt::format("{}: {} See '{} --help'.\n", command, parse_message(*chosen, error), command);
    return exit_input;
  }
  if (line.version) {
    streams.out << version_text();
    return exit_solved;
  }
  if (line.inspect->parsed()) return inspect(line.inspect_request, streams, interrupt);
  if (line.explain->parsed()) return explain(line.explain_request, streams, interrupt);
  if (line.list->parsed()) return list(line.list_request, streams);
  if (line.export_command->parsed()) return export_problem(line.export_request, streams);
  if (line.judge->parsed()) return judge(line.judge_request, streams);
  if (line.methods->parsed() && (line.methods_as_json || !line.method_options.empty())) {
    try {
      if (!line.methods_as_json || (line.shown_method.empty() && !line.method_options.empty()))
        throw InputError("--option goes with --show METHOD --json");
      streams.out << methods_json(line.shown_method, line.method_options);
      return exit_solved;
    } catch (const InputError& error) {
      return say_refused(streams, error.what());
    }
  }
  if (line.methods->parsed())
    return line.shown_method.empty() ? print_methods(streams) : show_method(line.shown_method, streams);
  if (line.cfunctions->parsed()) return print_cfunctions(streams);
  if (line.contact->parsed()) return contacts::run_command(*line.contact, line.contact_words, streams, interrupt);
  if (line.solve->parsed()) {
    try {
      line.finish_solve_request();
    } catch (const InputError& error) {
      return say_refused(streams, error.what());
    }
    return solve(line.solve_request, streams, interrupt);
  }
  streams.out << line.app.help();
  return exit_input;  // nothing was asked for
}

}  // namespace perp::app
