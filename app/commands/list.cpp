// SPDX-License-Identifier: Apache-2.0
#include "app/commands/commands.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>
#include <ostream>
#include <sstream>

#include "app/problem/problem.hpp"
#include "app/report/json.hpp"
#include "app/report/report.hpp"
#include "app/text/table.hpp"
#include "collection/sized.hpp"
#include "ncp/problem/residual.hpp"

namespace perp::app {

namespace {

namespace collection = ncp::collection;

constexpr std::size_t widest = 120;  // columns of a terminal
using Entries = std::vector<const collection::Entry*>;

std::vector<std::string_view> all_classes() {
  std::vector<std::string_view> names;  // entries() is sorted by class
  for (const collection::Entry& entry : collection::entries())
    if (names.empty() || names.back() != entry.problem_class) names.push_back(entry.problem_class);
  return names;
}

/// The entries of the classes, of all if there are none. Throws InputError for a class that does not exist.
Entries entries_of(const std::vector<std::string>& classes) {
  const std::vector<std::string_view> known = all_classes();
  std::vector<std::string> wanted;
  for (const std::string& given : classes) {
    std::istringstream parts(given);
    for (std::string name; std::getline(parts, name, ',');) {
      if (std::ranges::find(known, name) == known.end())
        throw input_error("the collection has no class '{}'.{} It has {}.", name, did_you_mean(name, known),
                          fmt::join(known, ", "));
      wanted.push_back(name);
    }
  }
  if (wanted.empty() && !classes.empty()) throw InputError("--class: no class is given");
  Entries chosen;
  for (const collection::Entry& entry : collection::entries())
    if (wanted.empty() || std::ranges::find(wanted, entry.problem_class) != wanted.end()) chosen.push_back(&entry);
  return chosen;
}

/// The words that fit, and "..." where some do not.
std::string cut_at_a_word(std::string_view text, std::size_t width) {
  if (text.size() <= width) return std::string(text);
  const std::size_t end = text.find_last_of(' ', width - 3);
  text = text.substr(0, end == std::string_view::npos ? width - 3 : end);
  return std::string(text.substr(0, text.find_last_not_of(",;:") + 1)) + "...";
}

void print_table(std::ostream& out, const Entries& entries) {
  const std::vector<Column> columns{"name", ">n", "sizes", "class", ">starts", ">known", "why it is hard"};
  std::vector<std::vector<std::string>> rows;
  std::vector<std::size_t> width;
  width.reserve(columns.size());
  for (const Column& column : columns) width.push_back(column.header.size());
  std::size_t pairs = 0;
  for (const collection::Entry* entry : entries) {
    const collection::Problem problem = entry->make();
    const bool any_size = collection::find_family(entry->name) != nullptr;
    rows.push_back({std::string(entry->name), std::to_string(entry->size), any_size ? "any" : "",
                    std::string(entry->problem_class), std::to_string(problem.starts.size()),
                    problem.no_solution.empty() ? std::to_string(problem.solutions.size()) : "none",
                    std::string(entry->hard)});
    pairs += problem.starts.size();
    for (std::size_t j = 0; j < width.size(); ++j) width[j] = std::max(width[j], rows.back()[j].size());
  }
  const std::size_t others = std::accumulate(width.begin(), width.end() - 1, 2 * (width.size() - 1));
  Table table(columns);
  for (std::vector<std::string>& row : rows) {
    row.back() = cut_at_a_word(row.back(), widest - others);
    table.add(std::move(row));
  }
  table.print(out);
  out << fmt::format(
      "\n{}, {} with their starts. 'known' counts solutions from the literature or in closed form,\n"
      "'none': there is no solution. 'perp list NAME' shows one of them and says in full why it is hard, 'perp solve\n"
      "NAME --start K' solves it. 'any': comes in any size as NAME:SIZE[xSIZE...][:SEED], as in 'perp solve\n"
      "walras-own:400x300x300:7'; 'perp list NAME' tells what its sizes are.\n",
      count(static_cast<long long>(table.rows()), "problem"), count(static_cast<long long>(pairs), "pair"));
}

/// Variables down, starts and known solutions across.
void print_values(std::ostream& out, const collection::Problem& problem) {
  const ncp::Mcp& mcp = *problem.mcp;
  constexpr std::size_t most_columns = 8;  // what a terminal takes
  constexpr std::size_t most_rows = 60;
  std::vector<Column> columns{"variable", ">lower", ">upper"};
  std::vector<const ncp::Vec*> values;
  for (std::size_t k = 0; k < problem.starts.size() && values.size() < most_columns; ++k) {
    columns.push_back({fmt::format("start {}", k + 1), Align::Right});
    values.push_back(&problem.starts[k]);
  }
  const std::size_t shown_starts = values.size();
  for (std::size_t k = 0; k < problem.solutions.size() && values.size() < shown_starts + most_columns; ++k) {
    columns.push_back({fmt::format("solution {}", k + 1), Align::Right});
    values.push_back(&problem.solutions[k].x);
  }
  Table table(columns);
  for (ncp::Index i = 0; i < mcp.size(); ++i) {
    std::vector<std::string> row{mcp.variable_name(i), number(mcp.box().lower[i]), number(mcp.box().upper[i])};
    for (const ncp::Vec* x : values) row.push_back(i < x->size() ? number((*x)[i]) : "-");
    table.add(std::move(row));
  }
  table.print(out, 2, most_rows, "--json has all of them");
  const std::size_t hidden = problem.starts.size() + problem.solutions.size() - values.size();
  if (hidden > 0) out << fmt::format("  {} more are not shown; --json has all of them\n", hidden);
}

/// What the sizes of a family are, if it is one.
void print_sizes(std::ostream& out, const collection::Family* family) {
  if (family == nullptr) return;
  out << fmt::format("  sizes   {}, as in {}:{}\n          {}{}\n", syntax(*family), family->name, family->example,
                     limits(*family), family->seeded() ? ", a seed for other random numbers, else 1" : "");
}

void print_one(std::ostream& out, const collection::Entry& entry) {
  const collection::Problem problem = entry.make();
  const ncp::Mcp& mcp = *problem.mcp;
  out << fmt::format("{}: {}, {} in the Jacobian\n  class   {}\n  hard    {}\n  source  {}\n", entry.name,
                     count(mcp.size(), "variable"), count(mcp.jacobian_pattern().nonZeros(), "nonzero"),
                     entry.problem_class, entry.hard, entry.source);
  print_sizes(out, collection::find_family(entry.name));
  out << '\n'
      << fmt::format("{}, {}\n\n", count(static_cast<long long>(problem.starts.size()), "start"),
                     count(static_cast<long long>(problem.solutions.size()), "known solution"));
  print_values(out, problem);
  if (!problem.solutions.empty()) out << '\n';
  for (std::size_t k = 0; k < problem.solutions.size(); ++k) {
    const collection::KnownSolution& known = problem.solutions[k];
    out << fmt::format("  solution {}: {}natural residual {:.1e}, printed to within {:.0e}\n", k + 1,
                       known.label.empty() ? "" : known.label + ", ", ncp::residual(mcp, known.x).natural, known.tol);
  }
  if (!problem.solutions.empty())
    out << (problem.solutions_complete ? "  There are no others.\n" : "  There may be others.\n");
  if (!problem.no_solution.empty()) out << "\n  There is no solution: " << problem.no_solution << ".\n";
}

}  // namespace

ExitCode list(const ListRequest& request, Streams streams) {
  try {
    if (request.name.empty()) {
      const Entries entries = entries_of(request.classes);
      if (request.json)
        streams.out << list_json(entries);
      else
        print_table(streams.out, entries);
    } else {
      if (!request.classes.empty()) throw InputError("--class is for the table of all, not for one problem");
      const collection::Entry& entry = find_entry(request.name);
      if (request.json)
        streams.out << problem_json(entry);
      else
        print_one(streams.out, entry);
    }
    return exit_solved;
  } catch (const InputError& error) {
    return say_refused(streams, error.what());
  }
}

}  // namespace perp::app
