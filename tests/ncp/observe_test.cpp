#include "ncp/observe.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

// PATH's columns (its manual, section 4.2): major, minor (pivots), func, grad (of this iteration), residual, step,
// type, prox, label. Catches columns in another order, counts that go on from the iterations before, and a label of
// the wrong row.
TEST(PrintTable, HasPathsColumns) {
  Functions functions = support::kojima_shindo();
  functions.equation_names = {"supply", "clearing", "profit", "income"};
  const auto mcp = make_mcp(std::move(functions));
  std::ostringstream out;
  const Observer table = print_table(out, *mcp);
  EXPECT_EQ(table({.k = 0, .residual = 12.5, .worst = 0, .F_evals = 1, .J_evals = 1, .kind = 'I'}), Next::Continue);
  table({.k = 1, .residual = 0.5, .worst = 2, .step = 1, .pivots = 17, .F_evals = 3, .J_evals = 2, .kind = 'N'});
  table({.k = 2,
         .residual = 2.5e-9,
         .worst = 3,
         .step = 0.25,
         .prox = 0.001,
         .pivots = 4,
         .F_evals = 9,
         .J_evals = 3,
         .kind = 'P'});
  table({.k = 3, .residual = 0, .worst = -1, .step = 1, .F_evals = 10, .J_evals = 3, .kind = 'N'});

  std::istringstream lines(out.str());
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(lines, line);) rows.push_back(words(line));
  ASSERT_EQ(rows.size(), 5U) << out.str();
  EXPECT_THAT(rows[0],
              ElementsAre("major", "minor", "func", "grad", "residual", "step", "type", "prox", "worst", "equation"));
  EXPECT_THAT(rows[1], ElementsAre("0", "0", "1", "1", "1.2500e+01", "I", "(supply)"));
  EXPECT_THAT(rows[2], ElementsAre("1", "17", "2", "1", "5.0000e-01", "1.0e+00", "N", "(profit)"));
  EXPECT_THAT(rows[3], ElementsAre("2", "4", "6", "1", "2.5000e-09", "2.5e-01", "P", "1e-03", "(income)"));
  EXPECT_THAT(rows[4], ElementsAre("3", "0", "1", "0", "0.0000e+00", "1.0e+00", "N"));
}

// Catches columns that shift with the values' widths.
TEST(PrintTable, KeepsItsColumnsAligned) {
  const auto mcp = make_mcp(support::kojima_shindo());
  std::ostringstream out;
  const Observer table = print_table(out, *mcp);
  table({.k = 0, .residual = 1e99, .worst = 0, .F_evals = 1, .J_evals = 1, .kind = 'I'});
  table({.k = 99, .residual = infinity, .worst = 1, .step = 1e-9, .prox = 1e-12, .F_evals = 300, .kind = 'L'});
  std::istringstream lines(out.str());
  std::string header;
  std::string first;
  std::string second;
  std::getline(lines, header);
  std::getline(lines, first);
  std::getline(lines, second);
  EXPECT_EQ(header.find("worst equation"), first.find("(F[1])"));
  EXPECT_EQ(first.find("(F[1])"), second.find("(F[2])")) << out.str();
}

// Two tables at once know nothing of each other. Catches state shared between observers.
TEST(PrintTable, KeepsItsOwnCounts) {
  const auto mcp = make_mcp(support::kojima_shindo());
  std::ostringstream one;
  std::ostringstream two;
  const Observer first = print_table(one, *mcp);
  const Observer second = print_table(two, *mcp);
  first({.k = 0, .worst = 0, .F_evals = 1, .J_evals = 1});
  second({.k = 0, .worst = 0, .F_evals = 50, .J_evals = 40});
  first({.k = 1, .worst = 0, .F_evals = 3, .J_evals = 2});
  EXPECT_THAT(one.str(), HasSubstr("    1     0     2     1"));
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
