// SPDX-License-Identifier: Apache-2.0
/// Outputs that are also inputs, and text for terminals.
#include "app/program/files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <random>

#include "app/commands/ampl_driver.hpp"
#include "app/commands/commands.hpp"
#include "app/commands/inspect.hpp"
#include "app/commands/solve.hpp"
#include "app/contact/contact.hpp"
#include "app/json.hpp"
#include "app/report/json.hpp"
#include "app/support.hpp"
#include "app/text/json_parts.hpp"
#include "lcp/io/matrix_market.hpp"

namespace perp::app {
namespace {

namespace fs = std::filesystem;
using test::parse_json;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

// Issue 17: `perp solve model.nl --json model.nl` left no model and exit 0.
TEST(Outputs, AreNoInputs) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  test::write(folder / "m.col", "x\n");
  test::write(folder / "options", "tol 1e-8\n");
  test::write(folder / "start.mtx", "1\n");
  fs::create_symlink("m.nl", folder / "link");
  fs::create_hard_link(folder / "m.nl", folder / "hard");
  const auto refused = [&](const SolveRequest& request) {
    test::Captured captured;
    EXPECT_EQ(solve(request, captured.streams), exit_input);
    EXPECT_EQ(captured.out.str(), "");
    return captured.err.str();
  };
  const std::string model = folder / "m.nl";
  EXPECT_THAT(refused({.problem = model, .json = model}),
              AllOf(HasSubstr("--json '" + model + "': that is the input '" + model), HasSubstr("lost")));
  EXPECT_THAT(refused({.problem = folder / "m", .json = folder / "link"}), HasSubstr("that is the input"));
  EXPECT_THAT(refused({.problem = model, .plot = folder / "hard"}), HasSubstr("--plot"));
  EXPECT_THAT(refused({.problem = model, .solution = folder / "./m.col"}), HasSubstr("--solution"));
  EXPECT_THAT(refused({.problem = model, .options_file = folder / "options", .solution = folder / "options"}),
              HasSubstr("the input --options-file"));
  EXPECT_THAT(refused({.problem = model, .start_at = folder / "start.mtx", .solution = folder / "start.mtx"}),
              HasSubstr("the input --start-at"));
  // A refusal for another reason is not written over the model either.
  EXPECT_THAT(refused({.problem = model, .options = {"nonsense"}, .json = model}), HasSubstr("that is the input"));
  EXPECT_EQ(test::read(model), test::sqrt2_nl());
  test::Captured captured;
  EXPECT_EQ(inspect({.source = {.problem = model}, .json = folder / "link"}, captured.streams), exit_input);
  EXPECT_EQ(test::read(model), test::sqrt2_nl());
}

// Issue 17: `--json a --plot a` lost one of them silently.
TEST(Outputs, AreApart) {
  const test::Folder folder;
  fs::create_symlink("a", folder / "link");
  test::Captured captured;
  EXPECT_EQ(solve({.problem = "josephy", .json = folder / "a", .plot = folder / "link"}, captured.streams), exit_input);
  EXPECT_THAT(captured.err.str(), AllOf(HasSubstr("--plot"), HasSubstr("that is the output --json")));
  EXPECT_FALSE(fs::exists(folder / "a"));
  EXPECT_EQ(solve({.problem = "josephy", .json = "/dev/null", .plot = "/dev/null", .solution = "/dev/null"},
                  captured.streams),
            exit_solved);
}

// What cannot be written is refused before the solve: of every output.
TEST(Outputs, AreWritableBeforeTheSolve) {
  const test::Folder folder;
  for (const SolveRequest& request : {SolveRequest{.problem = "josephy", .json = folder / "none/a"},
                                      SolveRequest{.problem = "josephy", .plot = folder / "none/a"},
                                      SolveRequest{.problem = "josephy", .solution = folder / "none/a"}}) {
    test::Captured captured;
    EXPECT_EQ(solve(request, captured.streams), exit_input);
    EXPECT_EQ(captured.out.str(), "");
    EXPECT_THAT(captured.err.str(), HasSubstr("none/a: cannot be written: there is no folder of that name"));
  }
}

TEST(Outputs, OfExportAreNoInputs) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  fs::create_symlink("m.nl", folder / "F-q.mtx");
  test::Captured captured;
  EXPECT_EQ(export_problem({.source = {.problem = folder / "m.nl"}, .file = folder / "F.mtx", .force = true},
                           captured.streams),
            exit_input);
  EXPECT_THAT(captured.err.str(), HasSubstr("F-q.mtx': that is the input"));
  fs::remove(folder / "F-q.mtx");
  fs::create_symlink("F-upper.mtx", folder / "F-lower.mtx");
  EXPECT_EQ(export_problem({.source = {.problem = "ahn"}, .file = folder / "F.mtx", .force = true}, captured.streams),
            exit_input);
  EXPECT_THAT(captured.err.str(), HasSubstr("that is the output"));
  EXPECT_FALSE(fs::exists(folder / "F.mtx"));
}

TEST(Outputs, OfContactAreNoInputs) {
  const test::Folder folder;
  test::write(folder / "c.dat", "no problem");
  const std::string file = folder / "c.dat";
  const auto refused = [&](auto call) {
    test::Captured captured;
    EXPECT_EQ(call(captured.streams), exit_input);
    EXPECT_EQ(captured.out.str(), "");
    EXPECT_EQ(test::read(file), "no problem");
    return captured.err.str();
  };
  for (const contacts::ContactRequest& request :
       {contacts::ContactRequest{.problems = {file}, .json = file}, {.problems = {file}, .fclib_out = file}})
    EXPECT_THAT(refused([&](Streams streams) { return contacts::solve_contact(request, streams); }),
                HasSubstr("that is the input"));
}

// AMPL's answer, STUB.sol, as a link to the model: the model must stay, and nothing else may be written in its place.
TEST(Outputs, OfAmplAreNoInputs) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  fs::create_symlink("m.nl", folder / "m.sol");
  test::Captured captured;
  const auto call = [&](std::vector<std::string> arguments) {
    return ampl_driver({.program = "perp",
                        .arguments = std::move(arguments),
                        .environment = [](const char*) -> const char* { return nullptr; }},
                       captured.streams);
  };
  EXPECT_EQ(call({folder / "m", "-AMPL"}), exit_input);
  EXPECT_THAT(captured.err.str(), AllOf(HasSubstr("m.sol"), HasSubstr("that is the input")));
  EXPECT_EQ(test::read(folder / "m.nl"), test::sqrt2_nl());
  const auto model = ncp::ampl::read_model(folder / "m.nl");
  EXPECT_THROW(model->write_sol("", ncp::Vec::Ones(1), 0), ncp::ampl::ModelError);
  EXPECT_THROW(ncp::ampl::write_failed_sol(folder / "m", "", 500), ncp::ampl::ModelError);
  fs::remove(folder / "m.sol");
  test::write(folder / "m.sol", "tol 1e-7\n");
  EXPECT_EQ(call({folder / "m", "-AMPL", "optfile=" + folder / "m.sol"}), exit_input);
  EXPECT_EQ(test::read(folder / "m.sol"), "tol 1e-7\n");
}

// The mark that some editors put before a text is no part of it, and no reason for a refusal that names another.
TEST(ByteOrderMarks, OfTextFiles) {
  const test::Folder folder;
  const std::string mark = "\xEF\xBB\xBF";
  test::write(folder / "options", mark + "tol 1e-9\n");
  ASSERT_EQ(read_options_file(folder / "options").size(), 1U);
  EXPECT_EQ(read_options_file(folder / "options")[0].key, "tol");
  test::write(folder / "wide", "\xFF\xFEt");
  EXPECT_THAT(test::refused([&] { read_options_file(folder / "wide"); }), HasSubstr("wide:1: it is text in UTF-16"));
  test::write(folder / "m.col", mark + "name\n");
  test::write(folder / "m.nl", test::sqrt2_nl());
  EXPECT_EQ(ncp::ampl::read_model(folder / "m.nl")->variable_name(0), "name");
  test::write(folder / "b.nl", mark + test::sqrt2_nl());
  try {
    ncp::ampl::read_model(folder / "b.nl");
    ADD_FAILURE();
  } catch (const ncp::ampl::ModelError& error) {
    EXPECT_THAT(error.what(), HasSubstr("b.nl:1: it begins with a UTF-8 byte order mark"));
  }
  test::Captured captured;
  ASSERT_EQ(solve({.problem = "josephy", .json = folder / "r.json"}, captured.streams), exit_solved);
  test::write(folder / "r.json", mark + test::read(folder / "r.json"));
  EXPECT_EQ(solve({.problem = "josephy", .warm_start = folder / "r.json"}, captured.streams), exit_solved)
      << captured.err.str();
}

TEST(Printable, LeavesTextAndShowsControls) {
  for (const std::string text : {"", "plain\n\ttext", "äöü €", "\U0001F600", "\u00A0"})
    EXPECT_EQ(printable(text), text);
  EXPECT_EQ(printable("\033[31mred"), "\\x1b[31mred");
  EXPECT_EQ(printable(std::string("\0\a\b\r\x7F", 5)), "\\x00\\x07\\x08\\x0d\\x7f");
  EXPECT_EQ(printable("\xC2\x9B"
                      "31m"),
            "\\xc2\\x9b31m");  // CSI as C1
  EXPECT_EQ(printable("\x9B"
                      "31m \xE9t\xE9"),
            "\\x9b31m \\xe9t\\xe9");  // no UTF-8
  EXPECT_EQ(printable("\xC0\x9B \xED\xA0\x80 \xF4\x90\x80\x80 \xE2\x82"),
            "\\xc0\\x9b \\xed\\xa0\\x80 \\xf4\\x90\\x80\\x80 \\xe2\\x82");
  EXPECT_TRUE(is_utf8("€\U0010FFFF"));
  for (const char* text : {"\xFF", "\xE2\x82", "\xC0\x80", "\xED\xA0\x80"}) EXPECT_FALSE(is_utf8(text)) << text;
}

// However the text is cut into writes, and the stream's failure is still seen.
TEST(Printable, Streams) {
  const std::string text = "a\033[K\r€\xC2\x9B\U0001F600\xFF.\n";
  std::ostringstream stream;
  std::streambuf* const before = stream.rdbuf();
  {
    PrintableStream through(stream);
    for (const char c : text) stream << c << std::flush;
    stream << text;
    through.raw() << "\r\033[K";
    stream << "\xE2\x82";
  }
  EXPECT_EQ(stream.rdbuf(), before);
  EXPECT_EQ(stream.str(), printable(text) + printable(text) + "\r\033[K\\xe2\\x82");
  std::ofstream full("/dev/full");
  {
    const PrintableStream through(full);
    full << "text" << std::flush;
    EXPECT_FALSE(full);
  }
  EXPECT_FALSE(full);
}

// JSON lets DEL and C1 stand as they are: a terminal that is shown `--json -` would obey them.
TEST(Printable, Json) {
  const std::string name = "a\033\x7F\xC2\x9B€";
  const std::string text = json_text({{"name", name}});
  EXPECT_EQ(text, printable(text));
  EXPECT_EQ(parse_json(text)["name"], name);
}

}  // namespace
}  // namespace perp::app
