// SPDX-License-Identifier: Apache-2.0
/// cells.jsonl of `perp compare` and `perp contact --compare` (app/campaign/cell.hpp, app/contact/compare/cell.hpp).
/// The fuzzer cannot guess a CRC: a text without "crc" is made lines whose CRC is right. One with "variant" is of
/// contact, one with "residual" what a run of contact leaves behind. What is read writes lines and tables that read
/// back the same.
#include "app/campaign/cell.hpp"
#include "app/contact/compare/cell.hpp"
#include "app/program/program.hpp"
#include "app/text/csv.hpp"
#include "fuzz/support.hpp"

namespace {

using namespace perp;
using fuzz::require;
namespace compare = app::compare;
namespace contacts = app::contacts;

/// The text with each of its lines made one whose CRC fits.
std::string checked(std::string_view text) {
  std::string lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines += compare::checked_line(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

void use(const std::vector<compare::Cell>& cells) {
  std::string lines;
  for (const compare::Cell& cell : cells) lines += compare::cell_line(cell);
  const compare::CellsRead again = compare::parse_cells(lines);
  require(again.dropped.empty() && !again.torn && again.cells.size() == cells.size(), "cells read back");
  std::string written;
  for (const compare::Cell& cell : again.cells) written += compare::cell_line(cell);
  require(written == lines, "cells read back as they were");
  for (const auto& [csv, columns] : {std::pair{compare::cells_csv(cells), compare::csv_columns().size()},
                                     std::pair{compare::outcomes_csv(cells), compare::outcome_columns().size()}}) {
    const auto records = app::parse_csv(csv);
    require(records.size() == cells.size() + 1, "a table has a record a cell");
    for (const auto& record : records) require(record.size() == columns, "a record has a field a column");
  }
}

void use(const std::vector<contacts::Cell>& cells) {
  std::string lines;
  for (const contacts::Cell& cell : cells) lines += contacts::cell_line(cell);
  const contacts::CellsRead again = contacts::parse_cells(lines);
  require(again.dropped.empty() && again.cells.size() == cells.size(), "contact cells read back");
  std::string written;
  for (const contacts::Cell& cell : again.cells) written += contacts::cell_line(cell);
  require(written == lines, "contact cells read back as they were");
  const auto records = app::parse_csv(contacts::cells_csv(cells));
  require(records.size() == cells.size() + 1, "a contact table has a record a cell");
  for (const auto& record : records) require(record.size() == records.front().size(), "a field a column");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzz::view(data, size);
  const auto has = [&](std::string_view word) { return text.find(word) != std::string_view::npos; };
  if (has("\"residual\"")) {
    contacts::cell_of({}, std::string(text), {});
    return 0;
  }
  const std::string lines = has("crc") ? std::string(text) : checked(text);
  const bool seldom = fuzz::one_in(8, text);  // writing takes longer than reading
  if (has("variant")) {
    if (const contacts::CellsRead read = contacts::parse_cells(lines); seldom) use(read.cells);
  } else {
    if (const compare::CellsRead read = compare::parse_cells(lines); seldom) use(read.cells);
  }
  return 0;
}
