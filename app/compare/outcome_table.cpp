// SPDX-License-Identifier: Apache-2.0
#include "app/compare/outcome_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <ostream>

#include "app/text/table.hpp"
#include "app/worker/run_cell.hpp"

namespace perp::app::compare {

namespace {

constexpr std::size_t outcome_count = static_cast<std::size_t>(Outcome::FalseInfeasible) + 1;

struct Row {
  std::array<std::size_t, outcome_count> of{};
  std::size_t honest = 0;  // where there is no solution
  std::size_t left = 0;    // failures after restarts
  double seconds = 0;
};

Row row_of(const std::string& method, const std::map<std::string, bool>& solvable, std::span<const Cell> cells) {
  Row row;
  for (const Cell& cell : cells) {
    if (cell.method != method) continue;
    row.seconds += cell.seconds;
    const auto known = solvable.find(cell.problem);
    const bool honest = cell.outcome == Outcome::Failed && known != solvable.end() && !known->second;
    ++(honest ? row.honest : row.of.at(static_cast<std::size_t>(cell.outcome)));
    if (!honest && is_failure(cell.outcome_after_restarts)) ++row.left;
  }
  return row;
}

}  // namespace

void print_outcomes(std::ostream& out, const Campaign& campaign, std::span<const Cell> cells) {
  std::map<std::string, bool> solvable;
  for (const AskedProblem& problem : campaign.problems) solvable[problem.name] = problem.solvable();
  std::vector<Row> rows;
  for (const AskedMethod& method : campaign.methods) rows.push_back(row_of(method.label, solvable, cells));
  const auto occurs = [&](std::size_t k) {
    return std::ranges::any_of(rows, [k](const Row& row) { return row.of.at(k) > 0; });
  };
  const bool honest = std::ranges::any_of(rows, [](const Row& row) { return row.honest > 0; });
  const bool restarts = campaign.restarts > 0;
  std::vector<Column> columns{"method"};
  for (std::size_t k = 0; k < outcome_count; ++k)
    if (occurs(k)) columns.push_back({std::string(outcome_names()[k]), Align::Right});
  if (honest) columns.push_back({"honest", Align::Right});
  if (restarts) columns.push_back({"failures after restarts", Align::Right});
  columns.push_back({"seconds", Align::Right});
  Table table(columns);
  for (std::size_t m = 0; m < rows.size(); ++m) {
    std::vector<std::string> line{campaign.methods[m].label};
    const auto cell = [&](std::size_t n) { line.push_back(n == 0 ? "." : fmt::format("{}", n)); };
    for (std::size_t k = 0; k < outcome_count; ++k)
      if (occurs(k)) cell(rows[m].of.at(k));
    if (honest) cell(rows[m].honest);
    if (restarts) cell(rows[m].left);
    line.push_back(fmt::format("{:.1f}", rows[m].seconds));
    table.add(std::move(line));
  }
  table.print(out);
  const bool infeasible = occurs(static_cast<std::size_t>(Outcome::Infeasible));
  if (infeasible || honest) out << "\nOf problems that have no solution: ";
  if (infeasible) out << "infeasible, it says so" << (honest ? "; " : ".\n");
  if (honest) out << "honest, it does not claim one.\n";
}

void print_false_claims(std::ostream& out, std::span<const Cell> cells) {
  constexpr std::size_t most = 20;
  Table table({"false claim of", "problem", ">start", "outcome", ">residual", "message"});
  for (const Cell& cell : cells)
    if (cell.outcome == Outcome::FalseConvergence || cell.outcome == Outcome::FalseInfeasible)
      table.add({cell.method, cell.problem, fmt::format("{}", cell.start), std::string(to_string(cell.outcome)),
                 number(cell.natural, 3), cell.message});
  if (table.rows() == 0) return;
  out << '\n';
  table.print(out, 0, most, "the report shows them");
}

}  // namespace perp::app::compare
