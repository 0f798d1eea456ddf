// SPDX-License-Identifier: Apache-2.0
#include "app/commands/commands.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <optional>
#include <ostream>
#include <string_view>

#include "app/program/files.hpp"
#include "lcp/io/file_path.hpp"
#include "lcp/io/matrix_market.hpp"
#include "ncp/ampl/model.hpp"
#include "ncp/ampl/nl_writer.hpp"
#include "ncp/problem/affine.hpp"

namespace perp::app {

namespace {

struct Files {
  std::string M, q, lower, upper, start;
  std::array<std::string, 5> all() const { return {M, q, lower, upper, start}; }
};

Files files_of(const std::string& file) {
  constexpr std::string_view ending = ".mtx";
  if (!file.ends_with(ending) || file.size() == ending.size() || file.ends_with("/.mtx"))
    throw input_error("-o {}: a Matrix Market or .nl file is needed, as in -o F.mtx or -o F.nl", file);
  const std::string stem = file.substr(0, file.size() - ending.size());
  return {file, stem + "-q.mtx", stem + "-lower.mtx", stem + "-upper.mtx", stem + "-start.mtx"};
}

/// Before anything is read: all of the paths are fit.
template <class Paths>
void check_paths(const Paths& paths, const ProblemSource& source, bool force) {
  std::vector<FileUse> outputs;
  for (const std::string& path : paths) outputs.push_back({"-o", path});
  check_outputs(outputs, files_of(source));
  for (const std::string& path : paths) {
    std::error_code ignored;
    if (!force && std::filesystem::exists(lcp::file_path(path), ignored))
      throw input_error("'{}' exists; --force overwrites it", path);
  }
}

void write_and_tell(const ExportRequest& request, Streams streams) {
  const Files files = files_of(request.file);
  check_paths(files.all(), request.source, request.force);
  const LoadedProblem problem = load_problem(request.source);
  const auto affine = ncp::affine_part(*problem.mcp);
  if (!affine)
    throw input_error(
        "'{}' is not affine, F(x) = M x + q: Matrix Market files cannot hold it, an .nl file can: -o F.nl. 'perp list "
        "--json' tells which are",
        problem.label);
  const std::string comment = fmt::format("{}, written by perp {}", problem.label, version_number());
  // Drafts of all, so that a full disk leaves all as they were.
  std::vector<lcp::OutputFile> drafts;
  const auto draft = [&](const std::string& path, const std::string& text) { drafts.emplace_back(path, text); };
  draft(files.M, lcp::matrix_text(affine->M, comment));
  draft(files.q, lcp::vector_text(affine->q, comment + ": q"));
  draft(files.lower, lcp::vector_text(affine->box.lower, comment + ": lower bounds"));
  draft(files.upper, lcp::vector_text(affine->box.upper, comment + ": upper bounds"));
  draft(files.start,
        lcp::vector_text(problem.x0, fmt::format("{}: start {} of {}", comment, problem.start, problem.starts)));
  for (lcp::OutputFile& file : drafts) file.replace();
  streams.out << fmt::format("{}: {} rows, {} entries\n  perp solve {} {} --lower {} --upper {} --start-at {}\n",
                             problem.label, affine->size(), affine->M.nonZeros(), shell_quoted(files.M),
                             shell_quoted(files.q), shell_quoted(files.lower), shell_quoted(files.upper),
                             shell_quoted(files.start));
}

/// The start that the source says, and the names.
void write_nl(const ExportRequest& request, const std::string& file, Streams streams) {
  const std::string stem = file.substr(0, file.size() - 3);
  const std::array<std::string, 3> paths{file, stem + ".col", stem + ".row"};
  check_paths(paths, request.source, request.force);
  const LoadedProblem problem = load_problem(request.source);
  if (problem.model != nullptr) throw input_error("'{}' is an .nl file already: copy it", problem.label);
  const std::optional<std::string> text = ncp::ampl::nl_text(*problem.mcp, problem.x0);
  if (!text) throw input_error("'{}' cannot be written as .nl file: its F is known as a program only", problem.label);
  std::string columns, rows;
  for (ncp::Index i = 0; i < problem.mcp->size(); ++i) {
    columns += problem.mcp->variable_name(i) + '\n';
    rows += problem.mcp->equation_name(i) + '\n';
  }
  std::vector<lcp::OutputFile> drafts;
  drafts.emplace_back(paths[0], *text);
  drafts.emplace_back(paths[1], columns);
  drafts.emplace_back(paths[2], rows);
  for (lcp::OutputFile& draft : drafts) draft.replace();
  streams.out << fmt::format("{}: {} variables, start {} of {}\n  perp solve {}\n", problem.label, problem.mcp->size(),
                             problem.start, problem.starts, shell_quoted(file));
}

void write_as_asked(const ExportRequest& request, Streams streams) {
  std::string file = request.file;
  if (request.nl && file.empty()) file = request.source.problem + ".nl";
  if (file.empty()) throw input_error("-o FILE is missing: F.nl, or F.mtx for an affine problem");
  if (!request.nl && !file.ends_with(".nl")) return write_and_tell(request, streams);
  if (!file.ends_with(".nl") || file.size() == 3 || file.ends_with("/.nl"))
    throw input_error("-o {}: an .nl file is needed, as in -o F.nl", file);
  write_nl(request, file, streams);
}

}  // namespace

ExitCode export_problem(const ExportRequest& request, Streams streams) {
  const std::string why = refusal(request.source.problem, [&] { write_as_asked(request, streams); });
  if (why.empty()) return exit_solved;
  return say_refused(streams, why);
}

}  // namespace perp::app
