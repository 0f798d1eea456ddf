// SPDX-License-Identifier: Apache-2.0
/// The report of a made-up campaign: a page that is well-formed, complete in itself, and says what the CSV files say.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <regex>

#include "app/comparison_report/html.hpp"
#include "app/comparison_report/write_report.hpp"
#include "app/json.hpp"
#include "report_support.hpp"

namespace perp::app {
namespace {

using compare::Cell;
using compare::Outcome;
using test::csv;
using test::Folder;
using test::is_json;
using test::Json;
using test::MadeUp;
using test::nasty;
using test::parse_json;
using test::Records;
using test::small_campaign;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// What a page consists of; throws where an element is not closed, an attribute has no quotes, or an entity no name.
struct Html {
  std::map<std::string, std::string> scripts;  // by type, "" for JavaScript
  std::map<std::string, int> tags;
  std::vector<std::string> references;  // src, href

  explicit Html(const std::string& page) : in_(page) {
    if (!page.starts_with("<!DOCTYPE html>\n")) throw std::runtime_error("no doctype");
    for (at_ = page.find('\n'); at_ < in_.size();) in_[at_] == '<' ? tag() : characters();
    if (!open_.empty()) throw std::runtime_error(open_.back() + " is open");
  }

 private:
  void characters() {
    const std::size_t end = std::min(in_.find('<', at_), in_.size());
    entities(in_.substr(at_, end - at_));
    at_ = end;
  }

  static void entities(const std::string& words) {
    static const std::regex entity("^&(amp|lt|gt|quot|#39);");
    if (words.find('>') != std::string::npos) throw std::runtime_error("stray >: " + words);
    for (std::size_t k = words.find('&'); k != std::string::npos; k = words.find('&', k + 1))
      if (!std::regex_search(words.substr(k, 8), entity)) throw std::runtime_error("entity " + words.substr(k, 8));
  }

  void tag() {
    static const std::regex attribute("^\\s+([a-zA-Z0-9-]+)=\"([^\"<]*)\"");
    const std::size_t end = in_.find('>', at_);
    if (end == std::string::npos) throw std::runtime_error("a tag without its end");
    std::string inside = in_.substr(at_ + 1, end - at_ - 1);
    at_ = end + 1;
    if (inside.starts_with('/')) {
      if (open_.empty() || open_.back() != inside.substr(1)) throw std::runtime_error("closes " + inside);
      open_.pop_back();
      return;
    }
    const bool empty = inside.ends_with('/');
    if (empty) inside.pop_back();
    const std::string name = inside.substr(0, inside.find_first_of(" \n"));
    ++tags[name];
    std::string rest = inside.substr(name.size()), type;
    for (std::smatch found; std::regex_search(rest, found, attribute); rest = found.suffix()) {
      entities(found[2]);
      if (found[1] == "src" || found[1] == "href") references.push_back(found[2]);
      if (found[1] == "type") type = found[2];
    }
    if (!rest.empty()) throw std::runtime_error("attributes of " + name + ":" + rest);
    if (empty) return;
    if (name == "script" || name == "style") {
      const std::size_t close = in_.find("</" + name + ">", at_);
      if (close == std::string::npos) throw std::runtime_error(name + " is open");
      if (name == "script") scripts[type] += in_.substr(at_, close - at_);
      at_ = close + name.size() + 3;
    } else {
      open_.push_back(name);
    }
  }

  std::string in_;
  std::size_t at_ = 0;
  std::vector<std::string> open_;
};

class ComparisonReport : public testing::Test {
 protected:
  void SetUp() override {
    made_up_.write(folder_);
    write_report(folder_ / "");
    page_ = test::read(folder_ / "report.html");
  }
  MadeUp made_up_ = small_campaign();
  Folder folder_;
  std::string page_;
};

/// Would catch: names or messages that are taken for markup, a script that a message ends early, anything fetched.
TEST_F(ComparisonReport, IsWellFormedAndSelfContained) {
  const Html html(page_);
  EXPECT_EQ(html.tags.at("script"), 2);
  EXPECT_EQ(html.tags.count("i"), 0U);
  EXPECT_EQ(html.tags.count("img") + html.tags.count("iframe"), 0U);
  for (const std::string& reference : html.references)
    EXPECT_TRUE(reference.starts_with('#') || reference == "data:,") << reference;
  const std::string without = std::regex_replace(page_, std::regex("http://www.w3.org/2000/svg"), "");
  for (const char* word : {"http:", "https:", "url(", "@import", "fetch(", "XMLHttpRequest", "innerHTML", "eval("})
    EXPECT_EQ(without.find(word), std::string::npos) << word;
  EXPECT_NE(page_.find("&lt;evil&gt; &amp; &quot;co&quot;"), std::string::npos);
  for (const std::string& reference : html.references) {
    if (reference == "data:,") continue;
    EXPECT_NE(page_.find("id=\"" + reference.substr(1) + '"'), std::string::npos) << "a link to nowhere";
  }
}

/// The page's data and cells.csv say the same of every cell.
TEST_F(ComparisonReport, EmbeddedCellsAreThoseOfTheCsv) {
  const Json data = parse_json(Html(page_).scripts.at("application/json"));
  const Records records = csv(folder_, "cells.csv");
  ASSERT_EQ(data["cells"].size(), made_up_.cells.size());
  ASSERT_EQ(records.size(), made_up_.cells.size() + 1);
  std::map<std::string, std::vector<std::string>> by_key;
  for (const auto& record : records) by_key[record[0] + '\n' + record[1] + '\n' + record[2]] = record;
  const auto same = [](const Json& value, const std::string& field) {
    return value.is_null() ? field.empty()
                           : !field.empty() && value.get<double>() == std::strtod(field.c_str(), nullptr);
  };
  for (const Json& cell : data["cells"]) {
    const auto& record = by_key.at(data["methods"][cell[0].get<std::size_t>()].get<std::string>() + '\n' +
                                   data["problems"][cell[1].get<std::size_t>()][0].get<std::string>() + '\n' +
                                   std::to_string(cell[2].get<int>()));
    EXPECT_EQ(data["outcomes"][cell[3].get<std::size_t>()], record[3]);
    EXPECT_EQ(data["outcomes"][cell[4].get<std::size_t>()], record[13]);
    EXPECT_TRUE(same(cell[6], record[6])) << cell[6] << " " << record[6];
    for (std::size_t k = 7; k <= 12; ++k) EXPECT_TRUE(same(cell[k], record[k])) << k;
    EXPECT_TRUE(same(cell[13], record[14])) << cell[13] << " " << record[14];
  }
  const Json& curve = data["cells"][3][16];
  EXPECT_EQ(curve, parse_json("[30000, null, -30000]"));
  EXPECT_EQ(data["cells"][0][16], parse_json("[0, -100, -900]"));
}

/// Every row of the robustness table on the page against robustness.csv.
TEST_F(ComparisonReport, RobustnessTableIsThatOfTheCsv) {
  const std::size_t begin = page_.find("<tbody>", page_.find("id=\"robustness\""));
  const std::string body = page_.substr(begin, page_.find("</tbody>", begin) - begin);
  std::map<std::string, std::string> expected;  // a method's cells, one after another
  const Records records = csv(folder_, "robustness.csv");
  for (std::size_t k = 1; k < records.size(); ++k) {
    const auto& r = records[k];
    const std::string cell = '|' + (r[2] == "0" ? "-" : r[3] == "0" ? "0" : r[3] + " (" + r[4] + ')');
    std::string& cells = expected[r[0]];
    cells.insert(r[1] == "total" ? 0 : cells.size(), cell);
  }
  EXPECT_EQ(expected.size(), 6U);
  const std::regex tags("<[^>]*>");
  std::size_t rows = 0;
  for (std::size_t at = body.find("<tr>"); at != std::string::npos; at = body.find("<tr>", at + 1), ++rows) {
    std::string row = body.substr(at, body.find("</tr>", at) - at);
    row = std::regex_replace(std::regex_replace(row, std::regex("</t[hd]>"), "|"), tags, "");
    const std::string label = row.substr(0, row.find('|'));
    const auto found =
        std::ranges::find_if(expected, [&](const auto& entry) { return comparison::html_text(entry.first) == label; });
    ASSERT_NE(found, expected.end()) << label;
    row = std::regex_replace(row, std::regex("\\|[0-9.]+ %"), "");  // the share stands after the total
    EXPECT_EQ(row.substr(label.size(), found->second.size()), found->second) << row;
  }
  EXPECT_EQ(rows, 6U);
}

/// The markers of the charts say "label: count of pairs within x": as many as profiles.csv has there; and curves end at
/// the share that it ends with.
TEST_F(ComparisonReport, ChartsAreThoseOfTheCsv) {
  const Records records = csv(folder_, "profiles.csv");
  std::size_t tips = 0;
  const std::regex tip("<title>([a-z]+): ([0-9]+) of ([0-9]+) within ([0-9.e+-]+)</title>");
  const std::array<std::pair<const char*, const char*>, 3> kinds{
      {{"seconds", "rho"}, {"F_evals", "rho"}, {"seconds", "d"}}};
  for (const auto& [cost, kind] : kinds) {
    const std::string group = std::string("<g id=\"general-") + cost + '-' + kind + "-m";
    for (std::size_t at = page_.find(group); at != std::string::npos; at = page_.find(group, at + 1)) {
      const std::string curve = page_.substr(at, page_.find("</g>", at) - at);
      for (std::sregex_iterator it(curve.begin(), curve.end(), tip); it != std::sregex_iterator(); ++it, ++tips) {
        const double x = std::strtod((*it)[4].str().c_str(), nullptr) * (1 + 1e-3);
        std::string count = "0";
        for (const auto& r : records)
          if (r[0] == "general" && r[1] == (kind[0] == 'r' ? "performance" : "data") && r[2] == cost &&
              r[3] == (*it)[1] && std::strtod(r[4].c_str(), nullptr) <= x)
            count = r[5];
        EXPECT_EQ((*it)[2], count) << group << ' ' << (*it)[0];
      }
    }
  }
  EXPECT_EQ(tips, 3U * 3U * 4U) << "costs, methods, markers";
}

/// False claims stand before everything else, and where there is none a line says so.
TEST_F(ComparisonReport, FalseClaimsComeFirst) {
  EXPECT_LT(page_.find("class=\"alarm\""), page_.find("id=\"findings\""));
  EXPECT_NE(page_.find("<td class=\"bad\">false-convergence</td>"), std::string::npos);
  EXPECT_GT(csv(folder_, "false_claims.csv").size(), 1U);
  MadeUp honest;
  honest.method("a").problem("p", "tiny").run("a", "p", Outcome::Failed);
  honest.write(folder_);
  write_report(folder_ / "");
  EXPECT_THAT(test::read(folder_ / "report.html"),
              AllOf(HasSubstr("No false claims"), Not(HasSubstr("class=\"alarm\""))));
}

/// The command itself. Would catch a subcommand that is not wired, and wrong exit codes.
TEST_F(ComparisonReport, IsACommand) {
  std::filesystem::remove(folder_ / "report.html");
  const std::string program = std::string("'") + PERP_PROGRAM + "' report '";
  EXPECT_EQ(std::system((program + folder_ / "" + "' > '" + folder_ / "out" + "'").c_str()), 0);
  EXPECT_EQ(test::read(folder_ / "report.html"), page_) << "and twice the same page";
  EXPECT_THAT(test::read(folder_ / "out"), HasSubstr("report.html"));
  const int status = std::system((program + folder_ / "nowhere' 2> '" + folder_ / "err" + "'").c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), exit_input);
  EXPECT_THAT(test::read(folder_ / "err"), HasSubstr("campaign.json"));
}

/// In a browser, if there is one: the script fills the table and draws the curves without an error.
TEST_F(ComparisonReport, RunsInABrowser) {
  if (std::system("command -v chromium >/dev/null 2>&1") != 0) GTEST_SKIP() << "no chromium";
  const std::string command = "HOME='" + folder_ / "" +
                              "' timeout 100 chromium --headless --no-sandbox --disable-gpu " +
                              "--enable-logging=stderr --v=0 --dump-dom 'file://" + folder_ / "report.html" + "' > '" +
                              folder_ / "dom.html" + "' 2> '" + folder_ / "log" + "'";
  if (std::system(command.c_str()) != 0) GTEST_SKIP() << "chromium does not start here";
  EXPECT_THAT(test::read(folder_ / "log"), Not(HasSubstr("CONSOLE")));
  const std::string dom = test::read(folder_ / "dom.html");
  EXPECT_NE(dom.find("1 to " + std::to_string(made_up_.cells.size()) + " of"), std::string::npos);
  EXPECT_NE(dom.find("<path class=\"line c0", dom.find("id=\"curves\"")), std::string::npos);
  EXPECT_NE(dom.find("<td class=\"w bad\">\u26a0 false-convergence"), std::string::npos);
}

/// Nothing finished, one method, one cell, all failed, NaN everywhere: a report, and files that can be read.
TEST(ComparisonReportEdges, LittleToReport) {
  const Folder folder;
  const auto check = [&](const MadeUp& made_up, const char* what) {
    made_up.write(folder);
    const std::vector<std::string> findings = write_report(folder / "");
    EXPECT_FALSE(findings.empty()) << what;
    const std::string page = test::read(folder / "report.html");
    EXPECT_NO_THROW({
      const Html html(page);
      EXPECT_TRUE(parse_json(html.scripts.at("application/json")).is_object());
    }) << what;
    EXPECT_EQ(page.find(">nan<"), std::string::npos) << what;
    EXPECT_FALSE(std::regex_search(page, std::regex(" (points|d|x|y|cx|cy)=\"[^\"]*(nan|inf)"))) << what;
    EXPECT_TRUE(is_json(test::read(folder / "report.json"))) << what;
    for (const char* name : {"methods.csv", "pairs.csv", "profiles.csv", "summary.csv", "curves.csv"}) {
      const Records records = csv(folder, name);
      for (const auto& record : records) EXPECT_EQ(record.size(), records[0].size()) << what << ' ' << name;
    }
  };
  MadeUp made_up;
  check(made_up, "nothing asked");
  made_up.method("a").problem("p", "tiny");
  check(made_up, "nothing finished");
  made_up.run("a", "p", Outcome::Solved);
  check(made_up, "one cell");
  made_up.cells[0].curve.clear();
  made_up.cells[0].natural = made_up.cells[0].seconds = made_up.cells[0].peak_mb = std::nan("");
  made_up.cells[0].iterations = made_up.cells[0].F_evals = made_up.cells[0].factorizations = -1;
  check(made_up, "NaN everywhere");
  made_up.cells[0].outcome = Outcome::Crashed;
  check(made_up, "all failed");
  made_up.method("b").problem("none", "lcp", 2, 1, "why");
  made_up.cells.clear();
  made_up.run("b", "none", Outcome::NotApplicable);
  made_up.run("a", "none", Outcome::Garbage);
  check(made_up, "problems without a solution only");
}

/// What cannot be read is refused by name; torn lines and cells of other campaigns are left out, and the page says so.
TEST(ComparisonReportEdges, WhatCannotBeRead) {
  const Folder folder;
  test::Captured captured;
  EXPECT_EQ(report_campaign({.dirs = {folder / "nowhere"}}, captured.streams), exit_input);
  EXPECT_THAT(captured.err.str(), HasSubstr("nowhere/campaign.json"));
  MadeUp made_up;
  made_up.method("a").problem("p", "tiny").run("a", "p", Outcome::Solved);
  made_up.run("stranger", "p", Outcome::Solved);
  made_up.write(folder);
  std::ofstream(folder / "cells.jsonl", std::ios::app) << R"({"cell":{"method")";
  EXPECT_EQ(report_campaign({.dirs = {folder / ""}}, captured.streams), exit_solved);
  const std::string page = test::read(folder / "report.html");
  EXPECT_THAT(page, AllOf(HasSubstr("stranger on p from start 1"), HasSubstr("line 3: torn")));
  EXPECT_EQ(csv(folder, "cells.csv").size(), 2U);
}

// Every file that a report makes is known to be one, so that none replaces a baseline.
TEST(ComparisonReportEdges, ReplacesNoInput) {
  const Folder folder;
  MadeUp made_up;
  made_up.method("a").problem("p", "tiny").run("a", "p", Outcome::Solved);
  made_up.write(folder);
  write_report(folder / ".");
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / ".")) {
    const std::vector<FileUse> inputs{{"--baseline", entry.path()}};
    EXPECT_THROW(check_campaign_files(folder / ".", inputs), InputError) << entry.path();
    ++files;
  }
  EXPECT_GE(files, 16);
}

TEST(HtmlText, EscapesAndReplaces) {
  EXPECT_EQ(comparison::html_text("<a href=\"x\">'&"), "&lt;a href=&quot;x&quot;&gt;&#39;&amp;");
  EXPECT_EQ(comparison::html_text("\xc3\xa9\xe2\x80\x93\xf0\x9f\x98\x80"), "\xc3\xa9\xe2\x80\x93\xf0\x9f\x98\x80");
  EXPECT_EQ(comparison::html_text("a\x01\xff\xc3"), "a\uFFFD\uFFFD\uFFFD");
  EXPECT_EQ(comparison::html_text("\xed\xa0\x80\xc0\xaf"), "\uFFFD\uFFFD\uFFFD\uFFFD\uFFFD")
      << "a surrogate, an overlong /";
  EXPECT_EQ(comparison::script_json("[\"</script>\"]"), "[\"\\u003c/script>\"]");
}

}  // namespace
}  // namespace perp::app
