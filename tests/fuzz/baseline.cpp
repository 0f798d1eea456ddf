// SPDX-License-Identifier: Apache-2.0
/// The CSV of --baseline (app/compare/baseline.hpp): what is read is compared with cells and printed.
#include "app/compare/baseline.hpp"

#include <sstream>

#include "app/program/program.hpp"
#include "fuzz/support.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace perp;
  const std::string_view text = fuzz::view(data, size);
  fuzz::accepted<app::InputError>([&] {
    const auto rows = app::compare::parse_baseline(text, "input.csv");
    std::vector<app::compare::Cell> cells;
    for (const app::compare::BaselineRow& row : rows)
      cells.push_back({.method = row.key.method, .problem = row.key.problem, .start = row.key.start});
    const auto comparison = app::compare::compare_with(rows, cells);
    fuzz::require(comparison.compared == rows.size(), "every row finds its cell");
    std::ostringstream out;
    app::compare::print_comparison(out, "input.csv", comparison);
  });
  return 0;
}
