// SPDX-License-Identifier: Apache-2.0
/// `perp export`: what it writes is read back as the same problem.
#include "app/commands/commands.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "app/support.hpp"
#include "collection/collection.hpp"
#include "lcp/io/matrix_market.hpp"
#include "ncp/problem/affine.hpp"

namespace perp::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string refused(const ExportRequest& request) {
  test::Captured captured;
  EXPECT_EQ(export_problem(request, captured.streams), exit_input);
  EXPECT_EQ(captured.out.str(), "");
  return captured.err.str();
}

lcp::AffineMcp exported(const test::Folder& folder, const std::string& name) {
  test::Captured captured;
  EXPECT_EQ(export_problem({.source = {.problem = name}, .file = folder / "F.mtx", .force = true}, captured.streams),
            exit_solved)
      << captured.err.str();
  const LoadedProblem read = load_problem({.problem = folder / "F.mtx",
                                           .q = folder / "F-q.mtx",
                                           .lower = folder / "F-lower.mtx",
                                           .upper = folder / "F-upper.mtx",
                                           .start_at = folder / "F-start.mtx"});
  EXPECT_EQ(read.x0, load_problem(name).x0) << name;
  return *ncp::affine_part(*read.mcp);
}

// Every affine problem of the collection that is not large. Would catch digits, bounds, signs of infinities or entries
// lost on the way.
TEST(Export, ReadsBackAsTheSameProblem) {
  const test::Folder folder;
  int compared = 0;
  for (const ncp::collection::Entry& entry : ncp::collection::entries()) {
    const ncp::collection::Problem problem = entry.make();
    const auto original = ncp::affine_part(*problem.mcp);
    if (!original || entry.size > 200) continue;
    const lcp::AffineMcp read = exported(folder, std::string(entry.name));
    EXPECT_EQ(read.q, original->q) << entry.name;
    EXPECT_EQ(read.box.lower, original->box.lower) << entry.name;
    EXPECT_EQ(read.box.upper, original->box.upper) << entry.name;
    ASSERT_EQ(read.M.nonZeros(), original->M.nonZeros()) << entry.name;
    EXPECT_EQ(Eigen::MatrixXd(read.M), Eigen::MatrixXd(original->M)) << entry.name;
    ++compared;
  }
  EXPECT_GE(compared, 30);
}

// Sizes and starts. Would catch an export of the catalogue's size, or of the first start whatever is asked.
TEST(Export, SizesAndStarts) {
  const test::Folder folder;
  EXPECT_EQ(exported(folder, "ahn:7").size(), 7);
  test::Captured captured;
  ASSERT_EQ(export_problem({.source = {.problem = "cottle2", .start = 2}, .file = folder / "G.mtx"}, captured.streams),
            exit_solved);
  EXPECT_EQ(lcp::read_vector(folder / "G-start.mtx"), Eigen::VectorXd::Ones(2));
  EXPECT_THAT(captured.out.str(), AllOf(HasSubstr("2 rows"), HasSubstr("perp solve " + folder / "G.mtx")));
}

// As .nl file with its names, from the start asked for; --nl without a file names it after the problem. Would catch a
// start that is not written, names of other rows, and a problem that cannot be taken to other solvers. (All of the
// collection: tests/collection/test_nl_files.cpp.)
TEST(Export, WritesAmplModels) {
  const test::Folder folder;
  test::Captured captured;
  ASSERT_EQ(export_problem({.source = {.problem = "kehoe", .start = 3}, .file = folder / "F.nl"}, captured.streams),
            exit_solved)
      << captured.err.str();
  EXPECT_THAT(captured.out.str(), AllOf(HasSubstr("start 3 of 4"), HasSubstr("perp solve " + folder / "F.nl")));
  const LoadedProblem read = load_problem(folder / "F.nl"),
                      original = load_problem(ProblemSource{.problem = "kehoe", .start = 3});
  EXPECT_EQ(read.x0, original.x0);
  EXPECT_EQ(read.mcp->variable_name(3), "p[2]");
  EXPECT_EQ(read.mcp->equation_name(3), "market[2]");
  EXPECT_EQ(read.mcp->box().lower, original.mcp->box().lower);
  EXPECT_THAT(refused({.source = {.problem = "kehoe"}, .file = folder / "F.nl"}), HasSubstr("--force"));
  EXPECT_THAT(refused({.source = {.problem = folder / "F.nl"}, .file = folder / "G.nl"}), HasSubstr("already"));
  EXPECT_THAT(refused({.source = {.problem = "kehoe"}, .file = folder / "F.mtx", .nl = true}), HasSubstr(".nl file"));
  EXPECT_THAT(refused({.source = {.problem = "kehoe"}}), HasSubstr("-o FILE is missing"));
}

// Would catch files of a problem they cannot hold, and files that overwrite others.
TEST(Export, RefusalsWriteNothing) {
  const test::Folder folder;
  EXPECT_THAT(refused({.source = {.problem = "kojshin"}, .file = folder / "F.mtx"}),
              AllOf(HasSubstr("'kojshin'"), HasSubstr("not affine")));
  EXPECT_THAT(refused({.source = {.problem = "ahnn"}, .file = folder / "F.mtx"}), HasSubstr("'ahn'"));
  EXPECT_THAT(refused({.source = {.problem = "cottle2", .start = 9}, .file = folder / "F.mtx"}),
              HasSubstr("--start 9"));
  EXPECT_THAT(refused({.source = {.problem = "cottle2"}, .file = folder / "F.txt"}), HasSubstr("F.txt"));
  EXPECT_THAT(refused({.source = {.problem = "cottle2"}, .file = ".mtx"}), HasSubstr("-o .mtx"));
  EXPECT_THAT(refused({.source = {.problem = "cottle2"}, .file = folder / "nowhere/F.mtx"}),
              AllOf(HasSubstr("nowhere/F.mtx"), HasSubstr("no folder")));
  EXPECT_TRUE(std::filesystem::is_empty(folder / ""));

  test::write(folder / "F-upper.mtx", "mine");
  EXPECT_THAT(refused({.source = {.problem = "cottle2"}, .file = folder / "F.mtx"}),
              AllOf(HasSubstr("F-upper.mtx"), HasSubstr("--force")));
  EXPECT_EQ(test::read(folder / "F-upper.mtx"), "mine");
  EXPECT_FALSE(std::filesystem::exists(folder / "F.mtx"));
  test::Captured captured;
  EXPECT_EQ(
      export_problem({.source = {.problem = "cottle2"}, .file = folder / "F.mtx", .force = true}, captured.streams),
      exit_solved);
  EXPECT_NE(test::read(folder / "F-upper.mtx"), "mine");
}

}  // namespace
}  // namespace perp::app
