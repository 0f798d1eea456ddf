#include "app/list.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ostream>

#include "app/json.hpp"
#include "app/problem.hpp"
#include "app/report.hpp"
#include "app/table.hpp"
#include "ncp/collection/sized.hpp"
#include "ncp/residual.hpp"

namespace perp::app {

namespace {

namespace collection = ncp::collection;

void print_all(std::ostream& out) {
  Table table({{"name", Align::Left},
               {"n", Align::Right},
               {"sizes", Align::Left},
               {"class", Align::Left},
               {"starts", Align::Right},
               {"known", Align::Right},
               {"why it is hard", Align::Left}});
  for (const collection::Entry& entry : collection::entries()) {
    const collection::Problem problem = entry.make();
    const bool any_size = collection::find_family(entry.name) != nullptr;
    table.add({std::string(entry.name), std::to_string(entry.size), any_size ? "any" : "",
               std::string(entry.problem_class), std::to_string(problem.starts.size()),
               problem.no_solution.empty() ? std::to_string(problem.solutions.size()) : "none",
               std::string(entry.hard)});
  }
  table.print(out);
  out << fmt::format(
      "\n{}. 'known' counts solutions from the literature or in closed form, 'none': there is no solution.\n"
      "'perp list NAME' shows one of them, 'perp solve NAME --start K' solves it.\n"
      "'any': comes in any size as NAME:SIZE[xSIZE...][:SEED], as in 'perp solve walras-own:400x300x300:7';\n"
      "'perp list NAME' tells what its sizes are.\n",
      count(static_cast<long long>(table.rows()), "problem"));
}

/// Variables down, starts and known solutions across.
void print_values(std::ostream& out, const collection::Problem& problem) {
  const ncp::Mcp& mcp = *problem.mcp;
  constexpr std::size_t most_columns = 8;  // what a terminal takes
  constexpr std::size_t most_rows = 60;
  std::vector<Column> columns{{"variable", Align::Left}, {"lower", Align::Right}, {"upper", Align::Right}};
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
      if (request.json)
        streams.out << list_json();
      else
        print_all(streams.out);
    } else {
      const collection::Entry& entry = find_entry(request.name);
      if (request.json)
        streams.out << problem_json(entry);
      else
        print_one(streams.out, entry);
    }
    return exit_solved;
  } catch (const InputError& error) {
    streams.err << "perp: " << error.what() << '\n';
    return exit_input;
  }
}

}  // namespace perp::app
