// SPDX-License-Identifier: Apache-2.0
/// Aligned tables and numbers for people.
#include "app/text/table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <sstream>

namespace perp::app {
namespace {

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> result;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) result.push_back(line);
  return result;
}

// Would catch columns whose width is the header's, right alignment that pads on the right, trailing blanks.
TEST(Table, ColumnsLineUp) {
  Table table({{"name", Align::Left}, {"value", Align::Right}, {"state", Align::Left}});
  table.add({"x", "1", "basic"});
  table.add({"a long name", "-123.25", "at lower"});
  std::ostringstream out;
  table.print(out, 2);
  const auto text = lines(out.str());
  ASSERT_EQ(text.size(), 4U);
  const std::size_t end_of_value = text[0].find("value") + 5;
  EXPECT_EQ(text[2].find(" 1 ") + 2, end_of_value);
  EXPECT_EQ(text[3].find("-123.25") + 7, end_of_value);
  EXPECT_EQ(text[2].find("basic"), text[3].find("at lower"));
  for (const std::string& line : text) {
    EXPECT_TRUE(line.starts_with("  ")) << line;
    EXPECT_FALSE(line.ends_with(" ")) << line;
  }
}

// Bytes are not columns: a name with an umlaut takes two bytes and one column.
TEST(Table, WidthCountsCharacters) {
  Table table({{"n", Align::Left}, {"v", Align::Right}});
  table.add({"M\xC3\xBCnchen", "1"});
  table.add({"Leipzig", "2"});
  std::ostringstream out;
  table.print(out);
  const auto text = lines(out.str());
  EXPECT_EQ(text[2].find('1'), text[3].find('2') + 1);
}

// Would catch a shortened table that loses its last rows, miscounts, or shortens what fits.
TEST(Table, LongTablesAreShortened) {
  Table table({{"i", Align::Right}});
  for (int i = 1; i <= 100; ++i) table.add({std::to_string(i)});
  std::ostringstream out;
  table.print(out, 0, 60, "--full shows them");
  const std::string text = out.str();
  EXPECT_EQ(lines(text).size(), 2U + 60U + 1U);
  EXPECT_THAT(text, testing::HasSubstr("40 rows are not shown; --full shows them"));
  EXPECT_THAT(text, testing::EndsWith("100\n"));
  EXPECT_THAT(text, testing::HasSubstr("\n 50\n...")) << "ten of the sixty are the last ones";

  std::ostringstream all;
  table.print(all, 0, 100, "");
  EXPECT_EQ(lines(all.str()).size(), 102U);
}

// A million rows of which sixty are shown: only these are made, and the text is that of the whole table. Catches
// seconds for what nobody sees, after a time limit.
TEST(Table, RowsThatAreNotShownAreNotMade) {
  for (const std::size_t count : {std::size_t{5}, std::size_t{60}, std::size_t{61}, std::size_t{1000}}) {
    Table whole({{"i", Align::Right}}), filled({{"i", Align::Right}});
    std::size_t made = 0;
    for (std::size_t i = 0; i < count; ++i) whole.add({std::to_string(i)});
    filled.fill(count, 60,
                [&](std::size_t i) -> std::vector<std::string> { return ++made, std::vector{std::to_string(i)}; });
    EXPECT_EQ(made, std::min<std::size_t>(count, 60));
    EXPECT_EQ(filled.rows(), count);
    std::ostringstream a, b;
    whole.print(a, 2, 60, "how");
    filled.print(b, 2, 60, "how");
    EXPECT_EQ(a.str(), b.str());
  }
}

TEST(Numbers, ForPeople) {
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(number(inf), "inf");
  EXPECT_EQ(number(-inf), "-inf");
  EXPECT_EQ(number(std::numeric_limits<double>::quiet_NaN()), "nan");
  EXPECT_EQ(number(-0.0), "0");
  EXPECT_EQ(number(0.5), "0.5");
  EXPECT_EQ(number(1.0 / 3, 3), "0.333");
  EXPECT_EQ(count(1, "start"), "1 start");
  EXPECT_EQ(count(0, "start"), "0 starts");
}

TEST(Wrapped, KeepsToTheWidth) {
  std::string words = "word";
  for (int i = 1; i < 40; ++i) words += " word";
  std::ostringstream out;
  print_wrapped(out, words, 2, 30);
  for (const std::string& line : lines(out.str())) EXPECT_LE(line.size(), 30U);
  EXPECT_THAT(out.str(), testing::Not(testing::ContainsRegex(" \n")));
  EXPECT_EQ(std::count(words.begin(), words.end(), 'w'), std::ranges::count(out.str(), 'w'));
}

}  // namespace
}  // namespace perp::app
