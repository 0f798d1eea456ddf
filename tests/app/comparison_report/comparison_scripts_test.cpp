// SPDX-License-Identifier: Apache-2.0
/// The scripts that bench/README.md shows, as they stand there: every figure of a report follows from its CSV.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <sstream>

#include "app/comparison_report/write_report.hpp"
#include "app/json.hpp"
#include "report_support.hpp"

namespace perp::app {
namespace {

using compare::Outcome;
using test::csv;
using test::Folder;
using test::Json;
using test::MadeUp;
using test::parse_json;
using test::Records;

/// The k-th script of the section.
std::string script(std::size_t k) {
  const std::string readme = test::read(std::string(PERP_SOURCE_DIR) + "/bench/README.md");
  std::size_t at = readme.find("## The report of a comparison, recomputed");
  for (std::size_t i = 0; i <= k && at != std::string::npos; ++i) at = readme.find("```python\n", at + 1);
  if (at == std::string::npos) return "";
  at += 10;
  return readme.substr(at, readme.find("```", at) - at);
}

/// Also: a program that solves all at costs nobody knows, one that has not finished, and a curve that was thinned.
MadeUp campaign() {
  MadeUp made_up = test::small_campaign();
  made_up.method("peer").method("late");
  made_up.campaign.methods[6].command = "peer";
  for (const auto& problem : made_up.campaign.problems)
    for (int start = 1; start <= problem.starts; ++start)
      made_up.run("peer", problem.name, problem.solvable() ? Outcome::Solved : Outcome::Failed, 0.5, -1, -1).start =
          start;
  made_up.run("late", "ahn", Outcome::Solved, 1e-5, 0, 0);
  made_up.cells[0].iterations = 1000;
  made_up.cells[0].curve.assign(compare::longest_curve, 0.5);
  return made_up;
}

class ScriptsOfTheReadme : public testing::Test {
 protected:
  enum Script : std::size_t { Robustness, Profiles, Means, Curves };
  void SetUp() override {
    if (std::system("python3 -c 'import csv' >/dev/null 2>&1") != 0) GTEST_SKIP() << "no python3";
    campaign().write(folder_);
    write_report(folder_ / "");
  }
  /// What the script prints for these arguments.
  Records run(Script which, const std::vector<std::string>& arguments) const {
    test::write(folder_ / "script.py", script(which));
    std::string command = "python3 '" + folder_ / "script.py" + "' '" + folder_ / "" + "'";
    for (std::size_t k = 0; k < arguments.size(); ++k) {  // names may have any character
      const std::string file = folder_ / ("argument" + std::to_string(k));
      test::write(file, arguments[k]);
      command += " \"$(cat '" + file + "')\"";
    }
    command += " > '" + folder_ / "printed.csv" + "'";
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
    return csv(folder_, "printed.csv");
  }
  Folder folder_;
};

/// Numbers with twelve digits: those of C++ and of Python are printed differently.
Records rounded(Records records) {
  for (auto& record : records)
    for (std::string& field : record) {
      char* end = nullptr;
      const double value = std::strtod(field.c_str(), &end);
      if (field.empty() || *end != '\0') continue;
      std::ostringstream text;
      text.precision(12);
      text << value;
      field = text.str();
    }
  return records;
}

// "A script of ten lines": of lines that can be read.
TEST_F(ScriptsOfTheReadme, HaveTenLines) {
  for (std::size_t k = 0; k <= Curves; ++k) {
    std::istringstream lines(script(k));
    std::size_t count = 0;
    for (std::string line; std::getline(lines, line); ++count) EXPECT_LE(line.size(), 120U) << line;
    EXPECT_GE(count, 5U);
    EXPECT_LE(count, 10U) << script(k);
  }
  EXPECT_EQ(script(Curves + 1), "") << "one that no test runs";
}

TEST_F(ScriptsOfTheReadme, Robustness) {
  Records expected = csv(folder_, "robustness.csv");
  expected.erase(expected.begin());
  EXPECT_EQ(expected.size(), 8U * 5U) << "methods, four classes and the total";
  EXPECT_THAT(run(Robustness, {}), testing::UnorderedElementsAreArray(expected));
}

/// Both kinds, all costs, all comparisons: in the order in which the file has them.
TEST_F(ScriptsOfTheReadme, Profiles) {
  const Records all = csv(folder_, "profiles.csv");
  std::map<std::vector<std::string>, Records> expected;
  for (std::size_t k = 1; k < all.size(); ++k) expected[{all[k].begin(), all[k].begin() + 3}].push_back(all[k]);
  std::set<std::string> comparisons;
  bool left_out = false;
  for (const auto& [which, records] : expected) {
    comparisons.insert(which[0]);
    EXPECT_THAT(rounded(run(Profiles, which)), testing::UnorderedElementsAreArray(rounded(records)))
        << testing::PrintToString(which);
    left_out = left_out || (which[0] == "general" && which[2] == "F_evals" &&
                            std::ranges::none_of(records, [](const auto& record) { return record[3] == "peer"; }));
  }
  EXPECT_THAT(comparisons, testing::IsSupersetOf({"general", "affine", "cfunctions-semismooth"}));
  EXPECT_EQ(expected.size(), comparisons.size() * 2 * 3) << "kinds, costs";
  EXPECT_TRUE(left_out) << "nobody knows what the peer's evaluations are";
}

TEST_F(ScriptsOfTheReadme, Means) {
  const Records all = csv(folder_, "summary.csv");
  std::map<std::string, Records> expected;
  for (std::size_t k = 1; k < all.size(); ++k) {
    const auto& r = all[k];
    if (!r.back().empty()) expected[r[0]].push_back({r[0], r[1], r[9], r[10], r[11], r[12]});
  }
  EXPECT_GE(expected.size(), 3U);
  for (const auto& [comparison, records] : expected) {
    Records printed = run(Means, {comparison});
    for (auto& record : printed) std::ranges::replace(record, "nan", "");
    EXPECT_THAT(rounded(printed), testing::UnorderedElementsAreArray(rounded(records))) << comparison;
  }
}

/// Every curve against what the page draws from: hundredths of log10; not below -18, and over the iterations, as its
/// chart.
TEST_F(ScriptsOfTheReadme, Curves) {
  const std::string page = test::read(folder_ / "report.html");
  const std::size_t begin = page.find('>', page.find("<script type=\"application/json\"")) + 1;
  const Json data = parse_json(page.substr(begin, page.find("</script>", begin) - begin));
  std::map<std::pair<std::string, int>, std::map<std::string, Json>> drawn;
  for (const Json& cell : data["cells"])
    drawn[{data["problems"][cell[1].get<std::size_t>()][0], cell[2]}][data["methods"][cell[0].get<std::size_t>()]] =
        cell;
  std::size_t points = 0;
  for (const auto& [pair, curves] : drawn) {
    std::map<std::string, std::vector<std::pair<double, std::string>>> printed;
    for (const auto& record : run(Curves, {pair.first, std::to_string(pair.second)}))
      printed[record[0]].emplace_back(std::strtod(record[1].c_str(), nullptr), record[2]);
    for (const auto& [method, cell] : curves) {
      const Json& curve = cell[16];
      const auto& way = printed[method];
      ASSERT_EQ(way.size(), curve.size()) << method;
      const double steps = static_cast<double>(curve.size()) - 1;
      const double width = cell[7].is_number() && cell[7] > steps && steps > 0 ? cell[7].get<double>() / steps : 1;
      for (std::size_t k = 0; k < way.size(); ++k, ++points) {
        EXPECT_NEAR(way[k].first, width * static_cast<double>(k), 1e-9);
        EXPECT_EQ(way[k].second.empty(), curve[k].is_null());
        const double height = curve[k].is_null() ? 0 : std::max(-18.0, curve[k].get<double>() / 100);
        EXPECT_NEAR(std::strtod(way[k].second.c_str(), nullptr), height, 0.0051);
      }
    }
  }
  EXPECT_GT(points, 200U);
}

}  // namespace
}  // namespace perp::app
