// SPDX-License-Identifier: Apache-2.0
/// `perp contact --compare --resume`: kill -9, files that were damaged, what may not differ.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <limits>
#include <sstream>

#include "app/compare/compare_process_support.hpp"
#include "app/contact/compare/campaign.hpp"
#include "app/contact/compare/cell.hpp"
#include "app/contact/compare/compare_variants.hpp"
#include "app/text/csv.hpp"
#include "contact_app_support.hpp"

namespace perp::app::contacts {
namespace {

using compare::Child;
using compare::eventually;
using compare::Finished;
using testing::HasSubstr;

Finished contact(const test::Folder& folder, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"contact", "--compare"});
  Child child(folder, std::move(arguments));
  const int code = child.wait();
  return {code, child.out(), child.err()};
}

/// cells.csv without what depends on time and memory.
std::string timeless(const std::string& dir) {
  std::string text;
  auto records = parse_csv(test::read(dir + "/cells.csv"));
  for (auto& record : records) {
    for (std::size_t k = 0; k < record.size(); ++k)
      if (records[0][k] != "seconds" && records[0][k] != "peak_mb") text += record[k] + "|";
    text += '\n';
  }
  return text;
}

long lines(const std::string& dir) {
  const std::string text = test::read(dir + "/cells.jsonl");
  return std::count(text.begin(), text.end(), '\n');
}

// Killed with -9 twice, a byte changed and a line torn; then the same table as in one go but for times, every finished
// cell kept as it was, and none run twice but the damaged one.
TEST(ContactResume, KilledAndResumed) {
  const test::Folder folder;
  const std::vector<std::string> asked{"stack:8",
                                       "incline:8",
                                       "arch:8",
                                       "stack:12",
                                       "arch:12",
                                       "--variants",
                                       "glocker,inner:6,outer:6,frictionless,glocker+path/B"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), asked.begin(), asked.end());
    return more;
  };
  const Finished once = contact(folder, with({"--out", folder / "once"}));
  ASSERT_EQ(once.code, exit_solved) << once.err;
  constexpr long total = 25;
  EXPECT_EQ(lines(folder / "once"), total);
  const std::string out = folder / "killed";
  for (const long more : {4, 5}) {
    const long before = lines(out);
    std::vector<std::string> words = before == 0 ? with({"--out", out}) : std::vector<std::string>{"--out", out};
    words.insert(words.begin(), {"contact", "--compare"});
    if (before > 0) words.emplace_back("--resume");
    Child child(folder, words);
    ASSERT_TRUE(eventually([&] { return lines(out) >= before + more; }));
    child.signal(SIGKILL);
    EXPECT_EQ(child.wait(), -SIGKILL);
    EXPECT_LT(lines(out), total);
  }
  EXPECT_FALSE(std::filesystem::exists(out + "/cells.csv"));
  std::string text = test::read(out + "/cells.jsonl");
  const long before = lines(out);
  const std::string first = text.substr(0, text.find('\n') + 1);
  text[text.find('\n') + 30] ^= 1;
  test::write(out + "/cells.jsonl", text + R"({"cell":{"variant":"gl)");
  const Finished last = contact(folder, {"--out", out, "--resume"});
  EXPECT_EQ(last.code, exit_solved) << last.err;
  EXPECT_THAT(last.err, HasSubstr("line 2: its CRC"));
  EXPECT_THAT(last.err, HasSubstr("torn"));
  EXPECT_THAT(last.err, HasSubstr("25 cells, " + std::to_string(total - before + 1) + " of them to do"));
  EXPECT_EQ(timeless(out), timeless(folder / "once"));
  EXPECT_EQ(lines(out), total + 1) << "one line for every cell, and the one with the changed byte";
  EXPECT_THAT(test::read(out + "/cells.jsonl"), testing::StartsWith(first));
  EXPECT_FALSE(std::filesystem::exists(out + "/work"));
  const Finished again = contact(folder, {"--out", out, "--resume"});
  EXPECT_EQ(again.code, exit_solved);
  EXPECT_EQ(again.out, last.out);  // times too: nothing was run
  EXPECT_EQ(lines(out), total + 1);
}

TEST(ContactResume, WhatMayNotDiffer) {
  const test::Folder folder;
  const std::string file = folder / "three.dat";
  const std::string out = folder / "out";
  test::write(file, test::three_contacts());
  EXPECT_THAT(contact(folder, {"--resume", "--out", out}).err, HasSubstr("no campaign"));
  EXPECT_FALSE(std::filesystem::exists(out));
  const Finished begun = contact(folder, {file, "--variants", "glocker,inner:4", "--out", out, "--resume"});
  EXPECT_EQ(begun.code, exit_solved) << begun.err;
  EXPECT_THAT(begun.err, HasSubstr("one begins"));
  const auto why = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"--out", out, "--resume"};
    words.insert(words.end(), more.begin(), more.end());
    const Finished finished = contact(folder, words);
    EXPECT_EQ(finished.code, exit_input);
    return finished.err;
  };
  EXPECT_THAT(why({"--tol", "1e-6"}), HasSubstr("--tol: 1e-08 there, 1e-06 here"));
  EXPECT_THAT(why({"--time-limit", "3"}), HasSubstr("--time-limit: 30 there, 3 here"));
  EXPECT_THAT(why({"--memory-limit", "3"}), HasSubstr("--memory-limit: 4096 there, 3 here"));
  EXPECT_THAT(why({"--variants", "glocker,inner:5"}),
              testing::AllOf(HasSubstr("variants there but not here: inner:4"),
                             HasSubstr("variants here but not there: inner:5")));
  EXPECT_THAT(why({"stack:4"}), HasSubstr("problems here but not there: stack:4"));
  EXPECT_EQ(contact(folder, {file, "--variants", "glocker,inner:4", "--out", out, "--resume", "--jobs", "2"}).code,
            exit_solved)
      << "the same in full";
  EXPECT_THAT(contact(folder, {file, "--out", out}).err, HasSubstr("--resume goes on with it"));
  test::write(file, test::identity_dat(3, 1, "-1 1.2 1.6", "0.5"));
  EXPECT_THAT(why({}), HasSubstr("content (CRC) of"));
  std::filesystem::remove(file);
  EXPECT_THAT(why({}), HasSubstr("there is no file"));
  test::write(out + "/campaign.json", "{\"campaign\": 1}");  // of perp compare
  EXPECT_THAT(why({}), HasSubstr("no campaign of perp contact"));
  test::write(out + "/campaign.json", "{");
  EXPECT_THAT(why({}), HasSubstr("campaign.json: "));
}

// Two at once would write over each other.
TEST(ContactResume, OneAtATime) {
  const test::Folder folder;
  Child child(folder,
              {"contact", "spheres:200", "spheres:300", "--compare", "--variants", "ncp1", "--out", folder / "out"});
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(folder / "out/campaign.json"); }));
  test::Captured captured;
  EXPECT_EQ(compare_variants({.out = folder / "out", .resume = true, .program = PERP_PROGRAM}, captured.streams),
            exit_input);
  EXPECT_THAT(captured.err.str(), HasSubstr("another campaign is at work there"));
}

// As written, so read: also infinities and what is not known.
TEST(ContactResume, CellsComeBack) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  Cell full{.variant = "inner:8", .problem = "a \"b\",\n c", .exact = false, .outcome = Outcome::Solved};
  full.status = "Solved", full.contacts = 7, full.iterations = 12, full.seconds = 0.1 + 0.2, full.peak_mb = 1.0 / 3;
  full.siconos = inf, full.rr9118 = 1e-300, full.own = 5e-324, full.message = "m\\n", full.command = "perp contact";
  const Cell empty{.variant = "v", .problem = "p", .outcome = Outcome::Crashed};
  const std::string text = cell_line(full) + cell_line(empty);
  const CellsRead read = parse_cells(text);
  ASSERT_EQ(read.cells.size(), 2U);
  EXPECT_TRUE(read.dropped.empty());
  EXPECT_EQ(cell_line(read.cells[0]) + cell_line(read.cells[1]), text);
  EXPECT_EQ(read.cells[0].siconos, inf);
  EXPECT_EQ(read.cells[0].seconds, 0.1 + 0.2);
  EXPECT_EQ(read.cells[1].contacts, -1);
  EXPECT_TRUE(std::isnan(read.cells[1].siconos));
  Cell later = full;
  later.outcome = Outcome::Failed;
  EXPECT_EQ(parse_cells(text + cell_line(later)).cells.front().outcome, Outcome::Failed);
  EXPECT_EQ(parse_cells(text.substr(0, text.size() - 1)).dropped.size(), 1U);
  EXPECT_EQ(parse_cells(compare::checked_line(R"({"variant":3})")).dropped.size(), 1U);
}

// Damaged files. Would catch a double or a long turned into an integer that does not hold it (undefined, or modulo
// 2^32).
TEST(ContactResume, NumbersOutOfRangeAreRefused) {
  const std::string line = cell_line(Cell{.variant = "v", .problem = "p", .contacts = 7, .iterations = 12});
  const std::string whole(compare::checked_object(std::string_view(line).substr(0, line.size() - 1)));
  for (const auto& [was, is] : {std::pair{R"("contacts":7)", R"("contacts":4294967303)"},
                                {R"("contacts":7)", R"("contacts":1e300)"},
                                {R"("iterations":12)", R"("iterations":1e300)"}}) {
    std::string object = whole;
    object.replace(object.find(was), std::string_view(was).size(), is);
    EXPECT_THAT(parse_cells(compare::checked_line(object)).dropped, testing::SizeIs(1)) << is;
  }
  const std::string limit = R"("memory_limit_mb": 4096)";
  std::string campaign = compare::campaign_json(Campaign{});
  EXPECT_EQ(compare::campaign_of<Campaign>(campaign).memory_mb, 4096);
  campaign.replace(campaign.find(limit), limit.size(), R"("memory_limit_mb": 1e300)");
  EXPECT_THROW(compare::campaign_of<Campaign>(campaign), InputError);
}

// What a run that was killed left behind may be anything that is JSON.
TEST(ContactResume, ResultsWithCountsOutOfRangeAreTorn) {
  const std::string huge = "9223372036854775807";
  const std::string json =
      R"({"status":"Solved","message":"","residual":{"siconos":1,"rr9118":1,"scaled":1},"exact":true,)"
      R"("solved_by":null,"contacts":[],"own_residual":null,"stats":{"time_s":0,"iterations":)" +
      huge + R"(,"sweeps":)" + huge + "}}";
  EXPECT_EQ(cell_of({}, json, {}).outcome, Outcome::Crashed);
}

}  // namespace
}  // namespace perp::app::contacts
