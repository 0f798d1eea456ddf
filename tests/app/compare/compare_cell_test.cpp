// SPDX-License-Identifier: Apache-2.0
/// The lines of cells.jsonl and the files made from them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "app/campaign/cell.hpp"
#include "app/json.hpp"
#include "app/support.hpp"
#include "app/text/csv.hpp"

namespace perp::app::compare {
namespace {

using test::Json;
using test::parse_json;
using testing::ElementsAre;
using testing::HasSubstr;

Cell example_cell() {
  return {.method = "semismooth:tol=1e-9",
          .problem = "obstacle:30x30",
          .start = 2,
          .outcome = Outcome::FalseConvergence,
          .status = "Solved",
          .claimed = true,
          .natural = 0.1,
          .iterations = 7,
          .F_evals = 9,
          .J_evals = 8,
          .factorizations = 7,
          .krylov_iterations = 0,
          .seconds = 0.25,
          .peak_mb = 12.5,
          .restarts = 1,
          .outcome_after_restarts = Outcome::Solved,
          .message = "says \"done\", is not\n",
          .curve = {1, 1.0 / 3.0, std::numeric_limits<double>::infinity()}};
}

Cell parse_line(std::string_view line) { return row_of<Cell>(json_object(checked_object(line))); }

// The check value of the CRC catalogues for CRC-32/ISO-HDLC, the one of zlib: a reader in another language can check
// lines only if it is this one.
TEST(Cell, Crc32) {
  EXPECT_EQ(crc32("123456789"), 0xcbf43926U);
  EXPECT_EQ(crc32(""), 0U);
}

// Would catch fields that are lost, doubles that are rounded, and NaN or inf that break JSON.
TEST(Cell, LineIsReadBackExactly) {
  Cell cell = example_cell();
  for (const double natural : {0.1, 5e-324, std::numeric_limits<double>::infinity(), std::nan("")}) {
    cell.natural = natural;
    const std::string line = cell_line(cell);
    ASSERT_EQ(line.back(), '\n');
    EXPECT_EQ(line.find('\n'), line.size() - 1) << "one line";
    const Cell back = parse_line(std::string_view(line).substr(0, line.size() - 1));
    EXPECT_EQ(cell_line(back), line);
    EXPECT_EQ(back.message, cell.message);
    EXPECT_EQ(back.curve, cell.curve);
    EXPECT_TRUE(back.natural == natural || std::isnan(natural));
  }
}

// Every way a line can end early, and every byte of it that can be changed: none may pass for a cell. (A CRC finds all
// changes of a single byte.)
TEST(Cell, TornAndChangedLinesAreRefused) {
  const std::string whole = cell_line(example_cell());
  const std::string line = whole.substr(0, whole.size() - 1);
  for (std::size_t length = 0; length < line.size(); ++length)
    EXPECT_THROW(parse_line(line.substr(0, length)), InputError) << length;
  for (std::size_t i = 0; i < line.size(); ++i) {
    std::string changed = line;
    changed[i] = static_cast<char>(changed[i] ^ 1);
    EXPECT_THROW(parse_line(changed), InputError) << i;
  }
}

// Numbers that an int does not hold. Would catch one taken modulo 2^32: a cell that counts as that of another start.
TEST(Cell, CountsBeyondAnIntAreRefused) {
  const std::string line = cell_line(example_cell());
  for (const char* count : {"4294967298", "-9223372036854775808", "18446744073709551615", "2.0"}) {
    std::string object(checked_object(std::string_view(line).substr(0, line.size() - 1)));
    const std::string start = R"("start":2)";
    object.replace(object.find(start), start.size(), std::string(R"("start":)") + count);
    EXPECT_THAT(parse_cells(checked_line(object)).dropped, ElementsAre(HasSubstr("'start'"))) << count;
  }
}

// After a kill -9 the file ends anywhere; a disk may change bytes in the middle. Both cost the lines they hit alone.
TEST(Cell, FileWithTornAndCorruptLines) {
  Cell a = example_cell();
  Cell b = example_cell();
  b.problem = "billups";
  Cell c = example_cell();
  c.start = 1;
  std::string corrupt = cell_line(b);
  corrupt[20] = '#';
  const std::string text = cell_line(a) + corrupt + cell_line(c);
  const CellsRead read = parse_cells(text + cell_line(b).substr(0, 50));
  EXPECT_TRUE(read.torn);
  EXPECT_THAT(read.dropped, ElementsAre(HasSubstr("line 2: its CRC"), "line 4: torn"));
  ASSERT_EQ(read.cells.size(), 2U);
  EXPECT_EQ(read.cells[0].start, 1) << "sorted";
  EXPECT_FALSE(parse_cells(text).torn);

  c.outcome = Outcome::Crashed;
  const CellsRead again = parse_cells(text + cell_line(c));
  ASSERT_EQ(again.cells.size(), 2U);
  EXPECT_EQ(again.cells[0].outcome, Outcome::Crashed) << "the later one counts";
  EXPECT_TRUE(parse_cells("").cells.empty());
}

TEST(Cell, ReadsADirectory) {
  const test::Folder folder;
  EXPECT_THROW(read_cells(folder / "absent"), InputError);
  test::write(folder / "cells.jsonl", "");
  EXPECT_TRUE(read_cells(folder / "").cells.empty());
  test::write(folder / "cells.jsonl", cell_line(example_cell()));
  EXPECT_EQ(read_cells(folder / "").cells.size(), 1U);
}

TEST(Cell, OutcomesHaveNamesOfTheirOwn) {
  for (const std::string_view name : outcome_names()) EXPECT_EQ(to_string(outcome_of(name)), name);
  EXPECT_EQ(outcome_names().size(), static_cast<std::size_t>(Outcome::FalseInfeasible) + 1);
  EXPECT_THROW(outcome_of("done"), InputError);
}

// RFC 4180: a message with commas, quotes and line breaks is one field.
TEST(Cell, CsvIsReadBack) {
  const std::vector<Cell> cells{example_cell()};
  const auto records = parse_csv(cells_csv(cells));
  ASSERT_EQ(records.size(), 2U);
  ASSERT_EQ(records[1].size(), csv_columns().size());
  for (std::size_t k = 0; k < csv_columns().size(); ++k) EXPECT_EQ(records[0][k], csv_columns()[k]);
  EXPECT_EQ(records[1].back(), example_cell().message);
  EXPECT_EQ(records[1][3], "false-convergence");
  EXPECT_THROW(parse_csv("a,\"b"), InputError);
}

// Times, memory and how far a run came before a limit differ from run to run: none of it may be in outcomes.csv.
TEST(Cell, OutcomesDoNotDependOnTime) {
  Cell once = example_cell();
  Cell again = example_cell();
  again.seconds = 77;
  again.peak_mb = 1e4;
  again.message = "after 77 s";
  EXPECT_EQ(outcomes_csv({{once}}), outcomes_csv({{again}}));
  again.iterations += 1;
  EXPECT_NE(outcomes_csv({{once}}), outcomes_csv({{again}}));
  once.outcome = again.outcome = Outcome::TimeLimit;
  again.natural = 3;
  EXPECT_EQ(outcomes_csv({{once}}), outcomes_csv({{again}}));
}

TEST(Cell, JsonOfAll) {
  const Json parsed = parse_json(cells_json(std::vector<Cell>{example_cell(), example_cell()}));
  ASSERT_EQ(parsed.size(), 2U);
  EXPECT_EQ(parsed[0]["curve"].size(), 3U);
  EXPECT_TRUE(parse_json(cells_json({})).empty());
}

}  // namespace
}  // namespace perp::app::compare
