// SPDX-License-Identifier: Apache-2.0
#include "app/problem/problem.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <new>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "app/program/program.hpp"
#include "collection/sized.hpp"
#include "lcp/io/file_path.hpp"
#include "lcp/io/matrix_market.hpp"
#include "lcp/io/siconos_file.hpp"
#include "lcp/memory.hpp"
#include "ncp/problem/affine.hpp"
#include "ncp/problem/lifted_vi.hpp"

namespace perp::app {

namespace {

namespace fs = std::filesystem;
namespace collection = ncp::collection;

bool exists(const std::string& path) {
  std::error_code ignored;
  return fs::exists(lcp::file_path(path), ignored);
}

/// "" or " Did you mean ...?", of the collection.
std::string suggestion(const std::string& name) {
  const std::vector<std::string_view> similar = collection::similar(name);
  std::string text;
  for (std::size_t k = 0; k < similar.size() && k < 3; ++k)
    text += fmt::format("{}'{}'", k == 0 ? " Did you mean " : " or ", similar[k]);
  return text.empty() ? text : text + "?";
}

LoadedProblem from_file(const std::string& path, std::optional<int> start) {
  const std::string file = path.ends_with(".nl") ? path : path + ".nl";
  if (!exists(file)) throw input_error("there is no file '{}'", file);
  if (start.value_or(1) != 1) throw input_error("--start {}: '{}' has one start, the model's own", *start, file);
  std::unique_ptr<ncp::ampl::Model> model = ncp::ampl::read_model(path);
  LoadedProblem problem{.label = file, .mcp = nullptr, .x0 = model->start()};
  problem.model = model.get();
  problem.mcp = std::move(model);
  return problem;
}

LoadedProblem from_collection(const std::string& label, collection::Problem made, std::optional<int> start) {
  const int k = start.value_or(1);
  const int starts = static_cast<int>(made.starts.size());
  if (k < 1 || k > starts) throw input_error("--start {}: '{}' has the starts 1 to {}", k, label, starts);
  return {.label = label,
          .mcp = std::move(made.mcp),
          .x0 = made.starts[static_cast<std::size_t>(k - 1)],
          .start = k,
          .starts = starts,
          .solutions = std::move(made.solutions),
          .solutions_complete = made.solutions_complete,
          .no_solution = std::move(made.no_solution)};
}

/// NAME:SIZES of a problem that comes in any size; nothing if NAME is no problem at all.
std::optional<collection::Problem> of_size(const std::string& argument) {
  const std::size_t colon = argument.find(':');
  if (colon == std::string::npos) return std::nullopt;
  const std::string name = argument.substr(0, colon);
  const collection::Family* family = collection::find_family(name);
  if (family == nullptr) {
    if (collection::find(name) != nullptr) throw input_error("'{}': '{}' comes in one size", argument, name);
    return std::nullopt;
  }
  try {
    return collection::make(*family, argument.substr(colon + 1));
  } catch (const std::invalid_argument& refused) {
    throw InputError(refused.what());
  } catch (const lcp::NotEnoughMemory& error) {
    throw input_error("'{}': out of memory: {}", argument, error.what());
  } catch (const std::bad_alloc&) {
    throw InputError(out_of_memory(std::string(argument)));
  }
}

bool is_number(const std::string& given) {
  char* end = nullptr;
  std::strtod(given.c_str(), &end);
  return *end == '\0';
}

/// Reads the bounds of all variables or rows: the number, or the numbers of the file.
lcp::Vec bound(const char* flag, const std::string& given, double otherwise, lcp::Index n) {
  if (given.empty()) return lcp::Vec::Constant(n, otherwise);
  lcp::Vec bounds =
      is_number(given) ? lcp::Vec::Constant(n, std::strtod(given.c_str(), nullptr)) : lcp::read_vector(given, true);
  if (bounds.size() != n)
    throw input_error("{} {}: {} numbers for {} {}", flag, given, bounds.size(), n,
                      std::string_view(flag).starts_with("--row") ? "rows" : "variables");
  return bounds;
}

/// So many vectors more: bounds and start.
void require_vectors(const std::string& file, int vectors, lcp::Index n) {
  try {
    lcp::require_memory(static_cast<double>(sizeof(double)) * vectors * static_cast<double>(n), "bounds and start");
  } catch (const lcp::NotEnoughMemory& error) {
    throw input_error("{}: {}", file, error.what());
  }
}

LoadedProblem from_matrix(const ProblemSource& source) {
  if (source.q.empty())
    throw input_error("'{}' is a matrix: its vector is missing, as in 'perp solve M.mtx q.mtx'", source.problem);
  lcp::AffineMcp problem{.M = lcp::read_matrix(source.problem), .q = lcp::read_vector(source.q), .box = {}};
  if (problem.M.rows() != problem.M.cols())
    throw input_error("{}: the matrix is {} x {}, not square", source.problem, problem.M.rows(), problem.M.cols());
  if (problem.M.rows() != problem.q.size())
    throw input_error("{}: {} numbers for the {} rows of {}", source.q, problem.q.size(), problem.M.rows(),
                      source.problem);
  const lcp::Index n = problem.q.size();
  require_vectors(source.problem, 3, n);
  problem.box = {bound("--lower", source.lower, 0, n), bound("--upper", source.upper, lcp::infinity, n)};
  LoadedProblem loaded{.label = source.problem, .mcp = nullptr, .x0 = lcp::Vec::Zero(n)};
  loaded.mcp = ncp::make_affine_mcp(std::move(problem), source.problem);
  if (source.rows.empty()) {
    for (const auto& [flag, given] : {std::pair{"--row-lower", source.row_lower}, {"--row-upper", source.row_upper}})
      if (!given.empty()) throw input_error("{} {}: --rows A.mtx, whose bounds these are, is missing", flag, given);
    return loaded;
  }
  const lcp::SpMat A = lcp::read_matrix(source.rows);
  if (A.cols() != n)
    throw input_error("--rows {}: the matrix is {} x {}, and {} has {} variables", source.rows, A.rows(), A.cols(),
                      source.problem, n);
  loaded.without_rows = std::move(loaded.mcp);
  loaded.mcp = ncp::lifted(*loaded.without_rows, A,
                           {bound("--row-lower", source.row_lower, -lcp::infinity, A.rows()),
                            bound("--row-upper", source.row_upper, lcp::infinity, A.rows())});
  loaded.x0 = ncp::lifted_point(*loaded.mcp, loaded.x0, lcp::Vec::Zero(A.rows()));
  return loaded;
}

/// An LCP or an MLCP, whichever it is.
LoadedProblem from_siconos(const std::string& path) {
  const std::string text = lcp::read_file(path);
  // An MLCP begins with two flags of 0 or 1, an LCP with its size and its matrix' storage: "1 0" could be both.
  std::istringstream first(std::string(lcp::without_mark(text, path)));
  double a = 0;
  double b = 0;
  first >> a >> b;
  LoadedProblem loaded{.label = path, .mcp = nullptr, .x0 = {}};
  lcp::AffineMcp problem;
  std::vector<std::string> names;
  const bool flags = (a == 0 || a == 1) && (b == 0 || b == 1) && a + b > 0;
  std::optional<lcp::SiconosMlcp> mixed;
  std::exception_ptr no_mlcp;
  if (flags) try {
      mixed = lcp::parse_siconos_mlcp(text, path);
    } catch (const lcp::FileError&) {
      no_mlcp = std::current_exception();
    }
  if (mixed) {
    problem = lcp::to_affine(mixed->mlcp);
    for (const auto& [letter, count] : {std::pair{'u', mixed->mlcp.a.size()}, {'v', mixed->mlcp.b.size()}})
      for (lcp::Index i = 0; i < count; ++i) names.push_back(fmt::format("{}[{}]", letter, i + 1));
  } else {
    try {
      problem = lcp::parse_siconos_lcp(text, path).problem;
    } catch (const lcp::FileError&) {
      if (no_mlcp && b == 1) std::rethrow_exception(no_mlcp);  // an LCP of size 1 by blocks is rarer than a bad MLCP
      throw;
    }
  }
  loaded.x0 = lcp::Vec::Zero(problem.size());
  loaded.mcp = ncp::make_affine_mcp(std::move(problem), path, std::move(names));
  return loaded;
}

}  // namespace

bool is_matrix_file(const std::string& argument) { return argument.ends_with(".mtx") || argument.ends_with(".dat"); }

LoadedProblem load_problem(const ProblemSource& source) {
  const bool matrix = source.problem.ends_with(".mtx");
  if (!matrix)
    for (const auto& [flag, given] : {std::pair{"a second file", source.q},
                                      {"--lower", source.lower},
                                      {"--upper", source.upper},
                                      {"--rows", source.rows},
                                      {"--row-lower", source.row_lower},
                                      {"--row-upper", source.row_upper}})
      if (!given.empty())
        throw input_error("{} ('{}') goes with a matrix file, not with '{}'", flag, given, source.problem);
  if (is_matrix_file(source.problem) && source.start.value_or(1) != 1)
    throw input_error("--start {}: a matrix file has one start; --start-at FILE gives another", *source.start);
  LoadedProblem problem = matrix                             ? from_matrix(source)
                          : source.problem.ends_with(".dat") ? from_siconos(source.problem)
                                                             : load_problem(source.problem, source.start);
  if (!source.start_at.empty()) {
    problem.x0 = lcp::read_vector(source.start_at);
    if (problem.without_rows && problem.x0.size() == problem.own_variables())
      problem.x0 = ncp::lifted_point(*problem.mcp, problem.x0, lcp::Vec::Zero(problem.mcp->polyhedron()->A.rows()));
    if (problem.x0.size() != problem.mcp->size())
      throw input_error("--start-at {}: {} numbers for {} variables", source.start_at, problem.x0.size(),
                        problem.mcp->size());
  }
  return problem;
}

LoadedProblem load_problem(const std::string& argument, std::optional<int> start) {
  std::error_code ignored;
  if (fs::is_directory(lcp::file_path(argument), ignored))
    throw input_error("'{}' is a directory, not a model", argument);
  if (argument.ends_with(".nl") || lcp::file_path(argument).has_parent_path()) return from_file(argument, start);
  if (const collection::Entry* entry = collection::find(argument))
    return from_collection(argument, entry->make(), start);
  if (std::optional<collection::Problem> made = of_size(argument))
    return from_collection(argument, std::move(*made), start);
  if (exists(argument + ".nl")) return from_file(argument, start);
  throw input_error(
      "'{}' is neither a file (no '{}.nl' here) nor a problem of the collection.{} "
      "'perp list' shows the collection.",
      argument, argument, suggestion(argument));
}

std::vector<FileUse> files_of(const ProblemSource& source) {
  std::vector<FileUse> files;
  const std::string& problem = source.problem;
  const bool path = lcp::file_path(problem).has_parent_path();
  if (is_matrix_file(problem)) {
    files.push_back({"", problem});
  } else if (problem.ends_with(".nl") || path || collection::find(problem) == nullptr) {
    const std::string stub = problem.ends_with(".nl") ? problem.substr(0, problem.size() - 3) : problem;
    for (const char* ending : {".nl", ".col", ".row"}) files.push_back({"", stub + ending});
  }
  files.push_back({"", source.q});
  files.push_back({"--rows", source.rows});
  for (const auto& [flag, given] : {std::pair{"--lower", source.lower},
                                    {"--upper", source.upper},
                                    {"--row-lower", source.row_lower},
                                    {"--row-upper", source.row_upper}})
    if (!is_number(given)) files.push_back({flag, given});
  files.push_back({"--start-at", source.start_at});
  return files;
}

const collection::Entry& find_entry(const std::string& name) {
  if (const collection::Entry* entry = collection::find(name)) return *entry;
  throw input_error("the collection has no problem '{}'.{}", name, suggestion(name));
}

std::string refusal(const std::string& problem, const std::function<void()>& work) {
  try {
    work();
    return "";
  } catch (const InputError& error) {
    return error.what();
  } catch (const ncp::ampl::ModelError& error) {
    return error.what();
  } catch (const lcp::FileError& error) {
    return error.what();
  } catch (const std::invalid_argument& error) {  // the library's door
    return error.what();
  } catch (const lcp::NotEnoughMemory& error) {
    return problem.empty() ? error.what() : fmt::format("'{}': out of memory: {}", problem, error.what());
  } catch (const std::bad_alloc&) {
    return out_of_memory(problem);
  }
}

}  // namespace perp::app
