#include "app/problem.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "app/program.hpp"

namespace perp::app {

namespace {

namespace fs = std::filesystem;
namespace collection = ncp::collection;

bool exists(const std::string& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
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
  if (!exists(file)) throw InputError(fmt::format("there is no file '{}'", file));
  if (start.value_or(1) != 1)
    throw InputError(fmt::format("--start {}: '{}' has one start, the model's own", *start, file));
  std::unique_ptr<ncp::ampl::Model> model = ncp::ampl::read_model(path);
  LoadedProblem problem{.label = file, .mcp = nullptr, .x0 = model->start()};
  problem.model = model.get();
  problem.mcp = std::move(model);
  return problem;
}

LoadedProblem from_collection(const collection::Entry& entry, std::optional<int> start) {
  collection::Problem made = entry.make();
  const int k = start.value_or(1);
  const int starts = static_cast<int>(made.starts.size());
  if (k < 1 || k > starts)
    throw InputError(fmt::format("--start {}: '{}' has the starts 1 to {}", k, entry.name, starts));
  return {.label = std::string(entry.name),
          .mcp = std::move(made.mcp),
          .x0 = made.starts[static_cast<std::size_t>(k - 1)],
          .start = k,
          .starts = starts,
          .solutions = std::move(made.solutions),
          .solutions_complete = made.solutions_complete};
}

}  // namespace

LoadedProblem load_problem(const std::string& argument, std::optional<int> start) {
  std::error_code ignored;
  if (fs::is_directory(argument, ignored)) throw InputError(fmt::format("'{}' is a directory, not a model", argument));
  if (argument.ends_with(".nl") || argument.find('/') != std::string::npos) return from_file(argument, start);
  if (const collection::Entry* entry = collection::find(argument)) return from_collection(*entry, start);
  if (exists(argument + ".nl")) return from_file(argument, start);
  throw InputError(
      fmt::format("'{}' is neither a file (no '{}.nl' here) nor a problem of the collection.{} "
                  "'perp list' shows the collection.",
                  argument, argument, suggestion(argument)));
}

const collection::Entry& find_entry(const std::string& name) {
  if (const collection::Entry* entry = collection::find(name)) return *entry;
  throw InputError(fmt::format("the collection has no problem '{}'.{}", name, suggestion(name)));
}

}  // namespace perp::app
