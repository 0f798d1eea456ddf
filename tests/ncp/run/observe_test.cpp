// SPDX-License-Identifier: Apache-2.0
#include "ncp/run/observe.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::vec;
using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> words(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> out;
  for (std::string word; in >> word;) out.push_back(word);
  return out;
}

// PATH's columns (its manual, section 2.2): major, minor (pivots), func, grad (so far), residual, step, type, prox,
// inorm, label. Catches columns in another order, counts an iteration in place of sums, residual = merit, a label of
// the wrong row.
TEST(PrintTable, HasPathsColumns) {
  Functions functions = support::kojima_shindo();
  functions.equation_names = {"supply", "clearing", "profit", "income"};
  const auto mcp = make_mcp(std::move(functions));
  std::ostringstream out;
  const Observer table = print_table(out, *mcp);
  EXPECT_EQ(table({.k = 0, .residual = 12.5, .worst = 0, .merit = 8, .F_evals = 1, .J_evals = 1, .kind = 'I'}),
            Next::Continue);
  table({.k = 1, .residual = 0.5, .worst = 2, .step = 1, .pivots = 17, .F_evals = 3, .J_evals = 2, .kind = 'N'});
  table({.k = 2,
         .residual = 2.5e-9,
         .worst = 3,
         .merit = 2e-18,
         .step = 0.25,
         .prox = 0.001,
         .pivots = 4,
         .F_evals = 9,
         .J_evals = 3,
         .kind = 'B',
         .linear = 'S'});
  table({.k = 3, .residual = 0, .worst = -1, .step = 1, .F_evals = 10, .J_evals = 3, .kind = 'N'});

  std::istringstream lines(out.str());
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(lines, line);) rows.push_back(words(line));
  ASSERT_EQ(rows.size(), 6U) << out.str();
  EXPECT_THAT(rows[0], ElementsAre("Major", "Iteration", "Log"));
  EXPECT_THAT(rows[1],
              ElementsAre("major", "minor", "func", "grad", "residual", "step", "type", "prox", "inorm", "(label)"));
  EXPECT_THAT(rows[2], ElementsAre("0", "0", "1", "1", "4.0000e+00", "I", "1.2500e+01", "(supply)"));
  EXPECT_THAT(rows[3], ElementsAre("1", "17", "3", "2", "1.0e+00", "N", "5.0000e-01", "(profit)"));
  EXPECT_THAT(rows[4],
              ElementsAre("2", "4", "9", "3", "2.0000e-09", "2.5e-01", "SB", "1e-03", "2.5000e-09", "(income)"));
  EXPECT_THAT(rows[5], ElementsAre("3", "0", "10", "3", "0.0000e+00", "1.0e+00", "N", "0.0000e+00"));
}

/// The lines of what `show` makes a table print.
std::vector<std::string> table_of(const std::vector<Iteration>& records, TableOptions options = {}) {
  const auto mcp = make_mcp(support::kojima_shindo());
  std::ostringstream out;
  const Observer table = print_table(out, *mcp, options);
  for (const Iteration& it : records) table(it);
  std::istringstream in(out.str());
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

// Catches columns that shift with the values' widths.
TEST(PrintTable, KeepsItsColumnsAligned) {
  const auto lines = table_of(
      {{.k = 0, .residual = 1e99, .worst = 0, .merit = 1e180, .F_evals = 1, .J_evals = 1, .kind = 'I'},
       {.k = 99, .residual = infinity, .worst = 1, .step = 1e-9, .prox = 1e-12, .F_evals = 300, .kind = 'L'},
       {.k = 100, .residual = 1, .worst = 2, .merit = 1, .step = 1, .F_evals = 301, .kind = 'M', .linear = 'S'}});
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_EQ(lines[1].find("(label)"), lines[2].find("(F[1])")) << lines[2];
  EXPECT_EQ(lines[1].find("(label)"), lines[3].find("(F[2])")) << lines[3];
  EXPECT_EQ(lines[1].find("(label)"), lines[4].find("(F[3])")) << lines[4];
  EXPECT_EQ(lines[1].find("type") + 4, lines[4].find("SM") + 2);
  EXPECT_EQ(lines[1].find("inorm") + 5, lines[4].find("1.0000e+00 (") + 10);
}

const std::vector<Iteration> with_crash{
    {.k = 0, .residual = 9, .worst = 0, .merit = 2, .F_evals = 1, .J_evals = 1, .kind = 'I', .crash = true},
    {.k = 0,
     .residual = 4,
     .worst = 1,
     .merit = 0.5,
     .step = 1,
     .F_evals = 2,
     .J_evals = 2,
     .kind = 'C',
     .crash = true,
     .changes = 3,
     .inside = 2},
    {.k = 1,
     .residual = 1,
     .worst = 2,
     .merit = 0.02,
     .step = 1,
     .pivots = 5,
     .F_evals = 3,
     .J_evals = 3,
     .kind = 'O',
     .linear = 'S'},
    {.k = 1, .residual = 9, .worst = 0, .merit = 2, .F_evals = 4, .J_evals = 4, .kind = 'R', .attempt = "no crash"},
    {.k = 2, .residual = 0, .merit = 0, .step = 1, .F_evals = 5, .J_evals = 5, .kind = 'M', .linear = 'S'}};

// The order of PATH's log. Catches crash iterations counted as major ones, a major table that does not begin with the
// point the crash left, restarts without a name.
TEST(PrintTable, CrashMajorsAndRestarts) {
  const auto lines = table_of(with_crash);
  ASSERT_EQ(lines.size(), 15U);
  EXPECT_EQ(lines[0], "Crash Log");
  EXPECT_THAT(words(lines[1]),
              ElementsAre("major", "func", "diff", "size", "residual", "step", "prox", "inorm", "(label)"));
  EXPECT_THAT(words(lines[2]), ElementsAre("0", "1", "2.0000e+00", "9.0000e+00", "(F[1])"));
  EXPECT_THAT(words(lines[3]), ElementsAre("1", "2", "3", "2", "1.0000e+00", "1.0e+00", "4.0000e+00", "(F[2])"));
  EXPECT_EQ(lines[1].find("(label)"), lines[3].find("(F[2])"));
  EXPECT_EQ(lines[4], "");
  EXPECT_EQ(lines[5], "Major Iteration Log");
  EXPECT_THAT(words(lines[7]), ElementsAre("0", "0", "2", "2", "1.0000e+00", "I", "4.0000e+00", "(F[2])"));
  EXPECT_THAT(words(lines[8]), ElementsAre("1", "5", "3", "3", "2.0000e-01", "1.0e+00", "SO", "1.0000e+00", "(F[3])"));
  EXPECT_EQ(lines[10], "Restart: no crash");
  EXPECT_EQ(lines[11], "Major Iteration Log");
  EXPECT_THAT(words(lines[13]), testing::Contains("R"));
}

// Catches options that no longer hide what they are for, or hide more.
TEST(PrintTable, PartsCanBeLeftOut) {
  const auto has = [](const std::vector<std::string>& lines, const std::string& text) {
    return std::any_of(lines.begin(), lines.end(), [&](const std::string& line) { return line.find(text) == 0; });
  };
  const auto majors = table_of(with_crash, {.crash = false});
  EXPECT_FALSE(has(majors, "Crash Log"));
  EXPECT_TRUE(has(majors, "Major Iteration Log"));
  const auto crash = table_of(with_crash, {.major = false, .restarts = false});
  EXPECT_TRUE(has(crash, "Crash Log"));
  EXPECT_FALSE(has(crash, "Major Iteration Log"));
  EXPECT_FALSE(has(crash, "Restart"));
  const auto every_second = table_of(with_crash, {.major_frequency = 2});
  EXPECT_FALSE(has(every_second, "    1     5"));
  EXPECT_TRUE(has(every_second, "    2     0"));
}

// R is also the letter of josephy's partial steps, which begin nothing: of 9 of them every 5th is printed. Catches a
// frequency that all steps of such a run escape.
TEST(PrintTable, FrequencyHoldsForPartialSteps) {
  std::vector<Iteration> run{{.k = 0, .worst = 0, .kind = 'I'}};
  for (int k = 1; k < 10; ++k) run.push_back({.k = k, .worst = 0, .kind = 'R'});
  run.push_back({.k = 10, .worst = 0, .kind = 'R', .attempt = "again"});
  run.push_back({.k = 11, .worst = 0, .kind = 'N'});
  const auto mcp = make_mcp(support::kojima_shindo());
  std::ostringstream out;
  const Observer table = print_table(out, *mcp, {.major_frequency = 5});
  for (const Iteration& it : run) table(it);
  std::vector<int> shown;
  std::istringstream lines(out.str());
  for (std::string line; std::getline(lines, line);)
    if (int k = 0; std::istringstream(line) >> k) shown.push_back(k);
  EXPECT_THAT(shown, testing::ElementsAre(0, 5, 10));
}

// Two tables at once know nothing of each other. Catches state shared between observers.
TEST(PrintTable, KeepsItsOwnState) {
  const auto mcp = make_mcp(support::kojima_shindo());
  std::ostringstream one;
  std::ostringstream two;
  const Observer first = print_table(one, *mcp);
  const Observer second = print_table(two, *mcp);
  first({.k = 0, .worst = 0, .kind = 'I', .crash = true});
  second({.k = 0, .worst = 0, .kind = 'I'});
  first({.k = 1, .worst = 0, .kind = 'N'});
  EXPECT_THAT(one.str(), testing::AllOf(HasSubstr("Crash Log"), HasSubstr("Major Iteration Log")));
  EXPECT_THAT(two.str(), testing::Not(HasSubstr("Crash Log")));
}

// x is valid during the call only: a record that kept it would dangle.
TEST(Record, KeepsAllButThePoint) {
  std::vector<Iteration> records;
  const Observer recorder = record(records);
  const Vec x = vec({1, 2});
  EXPECT_EQ(recorder({.k = 0, .residual = 3, .x = &x}), Next::Continue);
  EXPECT_EQ(recorder({.k = 1, .residual = 2, .kind = 'N', .x = &x}), Next::Continue);
  ASSERT_EQ(records.size(), 2U);
  EXPECT_EQ(records[1].residual, 2);
  EXPECT_EQ(records[1].kind, 'N');
  EXPECT_EQ(records[0].x, nullptr);
}

TEST(StopWhen, StopsOnceTheFlagIsSet) {
  std::atomic<bool> flag = false;
  const Observer observer = stop_when(flag);
  EXPECT_EQ(observer({}), Next::Continue);
  flag = true;
  EXPECT_EQ(observer({}), Next::Stop);
  flag = false;
  EXPECT_EQ(observer({}), Next::Continue);
}

// Catches a stop that keeps the iteration from those after it, and a call of an empty observer.
TEST(All, CallsEveryObserverAndStopsForAny) {
  std::vector<Iteration> before;
  std::vector<Iteration> after;
  std::atomic<bool> flag = true;
  const Observer both = all({record(before), stop_when(flag), Observer{}, record(after)});
  EXPECT_EQ(both({.k = 5}), Next::Stop);
  flag = false;
  EXPECT_EQ(both({.k = 6}), Next::Continue);
  EXPECT_EQ(before.size(), 2U);
  EXPECT_EQ(after.size(), 2U);
  EXPECT_EQ(all({})({}), Next::Continue);
}

}  // namespace
}  // namespace perp::ncp
