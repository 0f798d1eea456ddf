// SPDX-License-Identifier: Apache-2.0
#include "app/report/report.hpp"

#include <fmt/format.h>

#include <charconv>
#include <ostream>

#include "app/text/table.hpp"

namespace perp::app {

namespace {

constexpr std::size_t side_by_side = 5;  // solutions in one table

void print_side_by_side(std::ostream& out, const Report& report, std::size_t begin, std::size_t end, bool full) {
  std::vector<Column> columns{"variable"};
  for (std::size_t k = begin; k < end; ++k) columns.push_back({fmt::format("{}", k + 1), Align::Right});
  Table table(std::move(columns));
  for (ncp::Index i = 0; i < report.mcp().size(); ++i) {
    std::vector<std::string> row{report.mcp().variable_name(i)};
    for (std::size_t k = begin; k < end; ++k) row.push_back(number(report.several->found[k].result.x[i]));
    table.add(std::move(row));
  }
  table.print(out, 2, full ? 0 : long_table, "--full shows them");
}

}  // namespace

int parse_solutions(const std::string& text) {
  if (text.empty()) return default_solutions;
  int count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  if (error != std::errc{} || end != text.data() + text.size())
    throw input_error("--all: '{}' is no number of solutions; give --all after the problem, or --all={}", text,
                      default_solutions);
  if (count < 1) throw input_error("--all {}: at least 1 solution must be asked for", count);
  return count;
}

void print_several(std::ostream& out, const Report& report, bool full) {
  if (!report.several) return;
  const ncp::AllSolutions& all = *report.several;
  out << fmt::format("{} after {}: {}; the list need not be complete\n",
                     count(static_cast<ncp::Index>(all.found.size()), "solution"),
                     count(all.attempts, "attempt") + " of deflation", all.message);
  for (std::size_t k = 0; k < all.found.size(); ++k) {
    const ncp::FoundSolution& f = all.found[k];
    out << fmt::format("  {}: natural residual {:.1e}, by {}\n", k + 1, f.result.residual.natural, f.how);
    if (!f.singular.empty()) out << fmt::format("     perhaps one of a continuum: {}\n", f.singular);
  }
  for (std::size_t k = 0; all.found.size() > 1 && k < all.found.size(); k += side_by_side) {
    out << '\n';
    print_side_by_side(out, report, k, std::min(k + side_by_side, all.found.size()), full);
  }
}

}  // namespace perp::app
