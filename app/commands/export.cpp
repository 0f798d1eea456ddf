// SPDX-License-Identifier: Apache-2.0
#include "app/commands/commands.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <optional>
#include <ostream>
#include <string_view>

#include "app/program/files.hpp"
#include "lcp/io/matrix_market.hpp"
#include "ncp/ampl/model.hpp"
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
    throw input_error("-o {}: a Matrix Market file is needed, as in -o F.mtx", file);
  const std::string stem = file.substr(0, file.size() - ending.size());
  return {file, stem + "-q.mtx", stem + "-lower.mtx", stem + "-upper.mtx", stem + "-start.mtx"};
}

/// Before anything is read: all of the paths are fit.
void check(const Files& files, const ProblemSource& source, bool force) {
  std::vector<FileUse> outputs;
  for (const std::string& path : files.all()) outputs.push_back({"-o", path});
  check_outputs(outputs, files_of(source));
  for (const std::string& path : files.all()) {
    std::error_code ignored;
    if (!force && std::filesystem::exists(path, ignored)) throw input_error("'{}' exists; --force overwrites it", path);
  }
}

void write_and_tell(const ExportRequest& request, Streams streams) {
  const Files files = files_of(request.file);
  check(files, request.source, request.force);
  const LoadedProblem problem = load_problem(request.source);
  const std::optional<lcp::AffineMcp> affine = ncp::affine_part(*problem.mcp);
  if (!affine)
    throw input_error(
        "'{}' is not affine, F(x) = M x + q: Matrix Market files cannot hold it. 'perp list --json' tells which are",
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

}  // namespace

ExitCode export_problem(const ExportRequest& request, Streams streams) {
  const std::string why = refusal(request.source.problem, [&] { write_and_tell(request, streams); });
  if (why.empty()) return exit_solved;
  return say_refused(streams, why);
}

}  // namespace perp::app
