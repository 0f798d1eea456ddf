// SPDX-License-Identifier: Apache-2.0
// The tables in the sources against the recorded ones, number by number, and choi's F against its formula as printed.
// Catches: a digit, row or column lost in the tables.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <sstream>
#include <type_traits>

#include "collection/collection.hpp"
#include "collection/models/choi_tables.hpp"
#include "collection/models/distillation_tables.hpp"
#include "collection/models/pies_tables.hpp"

namespace {

using namespace perp::ncp;
using namespace perp::ncp::collection;

class Tables : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no recorded tables: " << folder << " is absent";
  }
  std::ifstream open(const char* file) const {
    std::ifstream in(folder / file);
    EXPECT_TRUE(in) << folder / file;
    return in;
  }
  const std::filesystem::path folder = std::filesystem::path(PERP_SOURCE_DIR) / ".." / "shared" / "data" / "mcplib";
};

/// The numbers after ":=" of AMPL's `param name`, without the leading index of each row; comments are dropped.
std::vector<double> ampl_numbers(std::string text, const std::string& name, std::size_t columns) {
  for (std::size_t at = text.find("/*"); at != std::string::npos; at = text.find("/*"))
    text.erase(at, text.find("*/", at) + 2 - at);
  const std::size_t head = text.find("param " + name);
  const std::size_t from = text.find(":=", head) + 2;
  std::istringstream body(text.substr(from, text.find(';', from) - from));
  std::vector<double> numbers;
  std::size_t k = 0;
  for (double number = 0; body >> number; ++k)
    if (k % (columns + 1) != 0) numbers.push_back(number);
  return numbers;
}

template <class Table>
void expect_rows(const std::vector<double>& recorded, const Table& table) {
  std::vector<double> ours;
  for (const auto& row : table)
    if constexpr (std::is_array_v<std::remove_reference_t<decltype(row)>>)
      ours.insert(ours.end(), std::begin(row), std::end(row));
    else
      ours.push_back(row);
  EXPECT_EQ(ours, recorded);
}

TEST_F(Tables, Choi) {
  std::stringstream text;
  text << open("choi.dat").rdbuf();
  expect_rows(ampl_numbers(text.str(), "x ", 4), choi_tables::x);
  expect_rows(ampl_numbers(text.str(), "y ", 4), choi_tables::y);
  expect_rows(ampl_numbers(text.str(), "v ", 1), choi_tables::v);
  expect_rows(ampl_numbers(text.str(), "b ", 1), choi_tables::b);
  expect_rows(ampl_numbers(text.str(), "c ", 1), choi_tables::c);
  expect_rows(ampl_numbers(text.str(), "w0 ", 1), choi_tables::w0);
}

/// The numbers of AMPL's `param name` to its semicolon: below a heading ": 1 2 :=" whole rows without their first
/// index, else the last number of each line.
std::vector<double> ampl_rows(const std::string& text, const std::string& name) {
  const std::size_t head = text.find("param " + name);
  std::istringstream body(text.substr(head, text.find(';', head) - head));
  std::vector<double> numbers;
  bool heading = false;
  for (std::string line; std::getline(body, line);) {
    heading = heading || line.starts_with(':');
    if (line.empty() || line.starts_with(':') || line.starts_with('[') || line.starts_with("param")) continue;
    std::istringstream words(line);
    std::vector<std::string> row{std::istream_iterator<std::string>(words), {}};
    for (std::size_t k = heading ? 1 : row.size() - 1; k < row.size(); ++k) numbers.push_back(std::stod(row[k]));
  }
  return numbers;
}

/// A table of any rank, row by row.
template <class Table>
void expect_all(const std::string& text, const std::string& name, const Table& table) {
  using Entry = std::remove_all_extents_t<Table>;
  const auto* first = reinterpret_cast<const Entry*>(&table);
  EXPECT_EQ(std::vector<double>(first, first + sizeof(Table) / sizeof(Entry)), ampl_rows(text, name)) << name;
}

TEST_F(Tables, Pies) {
  std::stringstream in;
  in << open("pies.dat").rdbuf();
  const std::string text = in.str();
  using namespace pies_tables;
  expect_all(text, "rmax", rmax);
  expect_all(text, "cmax", cmax);
  expect_all(text, "omax", omax);
  expect_all(text, "rcost", rcost);
  expect_all(text, "q0", q0);
  expect_all(text, "p0", p0);
  expect_all(text, "output", output);
  expect_all(text, "esub", esub);
  expect_all(text, "cruse", cruse);
  expect_all(text, "oruse", oruse);
  expect_all(text, "ccost", ccost);
  expect_all(text, "ocost", ocost);
  expect_all(text, "ctcost", ctcost);
  expect_all(text, "otcost", otcost);
  expect_all(text, "ltcost", ltcost);
  expect_all(text, "htcost", htcost);
  expect_all(text, "i_c", i_c);
  expect_all(text, "i_o", i_o);
  expect_all(text, "i_ct", i_ct);
  expect_all(text, "i_ot", i_ot);
  expect_all(text, "i_lt", i_lt);
  expect_all(text, "i_ht", i_ht);
  expect_all(text, "iprice", iprice);
}

TEST_F(Tables, Distillation) {
  using namespace distillation_tables;
  nlohmann::json recorded;
  open("distillation.json") >> recorded;
  const auto expect_column = [&](const Column& ours, std::span<const double> start, std::span<const double> solution) {
    const nlohmann::json& column = recorded.at(ours.name);
    const auto expect_list = [&](const char* key, std::span<const double> values, auto count) {
      const auto length = static_cast<std::size_t>(count);
      ASSERT_EQ(column.at(key).size(), length) << key;
      for (std::size_t i = 0; i < length; ++i) EXPECT_EQ(column[key][i], values[i]) << key << i;
    };
    EXPECT_EQ(column["n"], ours.n);
    EXPECT_EQ(column["m"], ours.m);
    EXPECT_EQ(column["k"], ours.feed_stage);
    expect_list("a", ours.a, ours.m);
    expect_list("b", ours.b, ours.m);
    expect_list("c", ours.c, ours.m);
    expect_list("al", ours.al, ours.m);
    expect_list("al1", ours.al1, ours.m);
    expect_list("al2", ours.al2, ours.m);
    expect_list("be", ours.be, ours.m);
    expect_list("be1", ours.be1, ours.m);
    expect_list("be2", ours.be2, ours.m);
    expect_list("feed_liquid", ours.feed_liquid, ours.m);
    expect_list("feed_vapour", ours.feed_vapour, ours.m);
    expect_list("pressure", ours.pressure, ours.n);
    EXPECT_EQ(column["feed_temperature"], ours.feed_temperature);
    EXPECT_EQ(column["bottoms"], ours.bottoms);
    EXPECT_EQ(column["distillate"], ours.distillate);
    EXPECT_EQ(column["heat"], ours.heat);
    const std::size_t n = start.size();
    expect_list("start", start, n);
    for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(column["solution"][i].get<double>(), solution[i], 1e-9);
  };
  expect_column(hydroc06, hydroc06_start, hydroc06_solution);
  expect_column(methan08, methan08_start, methan08_solution);
}

// The matrix is 'row col value' counted from 1: J at any point; b is F(0).
TEST_F(Tables, Tinloi) {
  const Problem problem = find("tinloi42")->make();
  SpMat J = problem.mcp->jacobian_pattern();
  ASSERT_TRUE(problem.mcp->jacobian(Vec::Zero(42), J));
  std::ifstream in = open("tinloi42/A.txt");
  Index row = 0, col = 0, count = 0;
  for (double value = 0; in >> row >> col >> value; ++count)
    EXPECT_EQ(J.coeff(row - 1, col - 1), value) << row << ", " << col;
  EXPECT_EQ(count, 504);
  EXPECT_EQ(J.nonZeros(), 504);
  Vec q(42);
  ASSERT_TRUE(problem.mcp->eval(Vec::Zero(42), q));
  std::ifstream b = open("tinloi42/b.txt");
  for (Index i = 0; i < 42; ++i) {
    double value = 0;
    ASSERT_TRUE(b >> value);
    EXPECT_EQ(q[i], value) << i + 1;
  }
}

// F_j = -(1/30) sum_i E_ij/S_i (1 + (p_j - c_j) w_i (S_i - E_ij)/S_i) with plain exponentials, where those are
// harmless.
TEST(Choi, FollowsItsFormulaAsPrinted) {
  const Problem problem = find("choi")->make();
  const Vec p = problem.starts[0];
  Vec expected = Vec::Zero(14), F(14);
  for (std::size_t i = 0; i < 30; ++i) {
    const double w = -3 * choi_tables::w0[i];
    Vec E(14);
    for (std::size_t j = 0; j < 14; ++j) {
      double distance = 0;
      for (std::size_t k = 0; k < 4; ++k) distance += std::pow(choi_tables::x[j][k] - choi_tables::y[i][k], 2);
      const auto at = static_cast<Index>(j);
      E[at] = std::exp(w * p[at] - 3 * (choi_tables::v[i] * distance + choi_tables::b[i]));
    }
    const double S = 1 + E.sum();
    for (Index j = 0; j < 14; ++j) {
      const double margin = p[j] - choi_tables::c[static_cast<std::size_t>(j)];
      expected[j] -= E[j] / S * (1 + margin * w * (S - E[j]) / S) / 30;
    }
  }
  ASSERT_TRUE(problem.mcp->eval(p, F));
  EXPECT_LT((F - expected).lpNorm<Eigen::Infinity>(), 1e-15);
  EXPECT_GT(expected.lpNorm<Eigen::Infinity>(), 0.01);
}

}  // namespace
