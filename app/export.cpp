#include "app/export.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string_view>

#include "app/json.hpp"
#include "lcp/file_error.hpp"
#include "lcp/matrix_market.hpp"
#include "ncp/affine.hpp"
#include "ncp/ampl/model.hpp"

namespace perp::app {

namespace {

struct Files {
  std::string M, q, lower, upper, start;
};

Files files_of(const std::string& file) {
  constexpr std::string_view ending = ".mtx";
  if (!file.ends_with(ending) || file.size() == ending.size() || file.ends_with("/.mtx"))
    throw InputError(fmt::format("-o {}: a Matrix Market file is needed, as in -o F.mtx", file));
  const std::string stem = file.substr(0, file.size() - ending.size());
  return {file, stem + "-q.mtx", stem + "-lower.mtx", stem + "-upper.mtx", stem + "-start.mtx"};
}

/// Before anything is written: all of the paths are fit.
void check(const Files& files, bool force) {
  for (const std::string& path : {files.M, files.q, files.lower, files.upper, files.start}) {
    check_writable(path);
    std::error_code ignored;
    if (!force && std::filesystem::exists(path, ignored))
      throw InputError(fmt::format("'{}' exists; --force overwrites it", path));
  }
}

/// The word for a shell.
std::string quoted(const std::string& path) {
  constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./-+:,@%=";
  if (path.find_first_not_of(plain) == std::string::npos) return path;
  std::string text = "'";
  for (const char letter : path) text += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  return text + "'";
}

void write_and_tell(const ExportRequest& request, Streams streams) {
  const Files files = files_of(request.file);
  const LoadedProblem problem = load_problem(request.source);
  const std::optional<lcp::AffineMcp> affine = ncp::affine_part(*problem.mcp);
  if (!affine)
    throw InputError(fmt::format(
        "'{}' is not affine, F(x) = M x + q: Matrix Market files cannot hold it. 'perp list --json' tells which are",
        problem.label));
  check(files, request.force);
  const std::string comment = fmt::format("{}, written by perp {}", problem.label, version_number());
  lcp::write_matrix(files.M, affine->M, comment);
  lcp::write_vector(files.q, affine->q, comment + ": q");
  lcp::write_vector(files.lower, affine->box.lower, comment + ": lower bounds");
  lcp::write_vector(files.upper, affine->box.upper, comment + ": upper bounds");
  lcp::write_vector(files.start, problem.x0, fmt::format("{}: start {} of {}", comment, problem.start, problem.starts));
  streams.out << fmt::format("{}: {} rows, {} entries\n  perp solve {} {} --lower {} --upper {} --start-at {}\n",
                             problem.label, affine->size(), affine->M.nonZeros(), quoted(files.M), quoted(files.q),
                             quoted(files.lower), quoted(files.upper), quoted(files.start));
}

}  // namespace

ExitCode export_problem(const ExportRequest& request, Streams streams) {
  const std::string why = refusal(request.source.problem, [&] { write_and_tell(request, streams); });
  if (why.empty()) return exit_solved;
  streams.err << "perp: " << why << '\n';
  return exit_input;
}

}  // namespace perp::app
