// SPDX-License-Identifier: Apache-2.0
/// `perp solve` on affine problems in files: Matrix Market, and Siconos' test data.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/commands/solve.hpp"
#include "app/json.hpp"
#include "app/report/report.hpp"
#include "app/support.hpp"
#include "lcp/io/matrix_market.hpp"

namespace perp::app {
namespace {

using test::Json;
using test::parse_json;
using testing::AllOf;
using testing::HasSubstr;

/// Cottle, Pang & Stone 1992, example 1.2.1 in files: M = [2 1; 1 2], q = (-5, -6), solution (4/3, 7/3).
class Matrix : public testing::Test {
 protected:
  Matrix() {
    test::write(folder / "M.mtx", "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 2\n2 1 1\n2 2 2\n");
    test::write(folder / "q.mtx", "%%MatrixMarket matrix array real general\n2 1\n-5\n-6\n");
  }
  SolveRequest request() const {
    return {.problem = folder / "M.mtx", .json = folder / "out.json", .q = folder / "q.mtx"};
  }
  Json solved(const SolveRequest& what) {
    test::Captured captured;
    EXPECT_EQ(solve(what, captured.streams), exit_solved) << captured.err.str();
    return parse_json(test::read(folder / "out.json"));
  }
  std::string refused(const SolveRequest& what) {
    test::Captured captured;
    EXPECT_EQ(solve(what, captured.streams), exit_input);
    return captured.err.str();
  }
  test::Folder folder;
};

TEST_F(Matrix, AutoIsTheDefaultAndSaysWhy) {
  const Json result = solved(request());
  EXPECT_EQ(result["method"], "auto");
  EXPECT_THAT(result["message"].get<std::string>(),
              HasSubstr("lemke with few pivots (n <= 100); auto chose the linear methods"));
  EXPECT_NEAR(result["variables"][0]["value"].get<double>(), 4.0 / 3, 1e-14);
  EXPECT_NEAR(result["variables"][1]["value"].get<double>(), 7.0 / 3, 1e-14);
}

// Every method of the list runs on it, also those for nonlinear problems. Would catch a name wired to another method.
TEST_F(Matrix, EveryMethodSolvesIt) {
  for (const MethodEntry& method : methods()) {
    SolveRequest what = request();
    what.flags = {{"method", std::string(method.name), "--method"}};
    if (method.name == "lemke-howson") what.flags.push_back({"tol", "1e-6", ""});
    test::Captured captured;
    EXPECT_EQ(solve(what, captured.streams), exit_solved) << method.name << ": " << captured.out.str();
    EXPECT_EQ(parse_json(test::read(folder / "out.json"))["method"], std::string(method.name));
  }
}

// Bounds: of all by a number, one by one by a file with infinities. z_1 <= 1: F_1 = 2 + z_2 - 5 <= 0 there, z_2 = 5/2.
TEST_F(Matrix, BoundsAndStart) {
  test::write(folder / "u.mtx", "%%MatrixMarket matrix array real general\n2 1\n1\ninf\n");
  test::write(folder / "x0.txt", "1\n2.5\n");
  SolveRequest what = request();
  what.upper = folder / "u.mtx";
  what.solution = folder / "x.mtx";
  Json result = solved(what);
  EXPECT_EQ(result["variables"][0]["value"], 1.0);
  EXPECT_EQ(result["variables"][0]["state"], "at upper");
  EXPECT_EQ(result["variables"][1]["value"], 2.5);
  EXPECT_EQ(lcp::read_vector(folder / "x.mtx"), (lcp::Vec(2) << 1, 2.5).finished());

  what.start_at = folder / "x0.txt";
  EXPECT_EQ(solved(what)["stats"]["iterations"], 0) << "the start is the solution";

  what = request();
  what.lower = "-inf";
  what.upper = "0.5";
  result = solved(what);
  EXPECT_EQ(result["variables"][1]["value"], 0.5);
  what.lower = "3";
  EXPECT_THAT(refused(what), HasSubstr("0.5"));
}

TEST_F(Matrix, RefusalsNameFileLineAndValue) {
  SolveRequest what = request();
  what.q.clear();
  EXPECT_THAT(refused(what), AllOf(HasSubstr("M.mtx"), HasSubstr("q.mtx")));
  what.q = folder / "nowhere.mtx";
  EXPECT_THAT(refused(what), AllOf(HasSubstr("nowhere.mtx"), HasSubstr("No such file")));
  test::write(folder / "three.mtx", "%%MatrixMarket matrix array real general\n3 1\n1\n2\n3\n");
  what.q = folder / "three.mtx";
  EXPECT_THAT(refused(what), AllOf(HasSubstr("three.mtx"), HasSubstr("3 numbers"), HasSubstr("2 rows")));
  test::write(folder / "bad.mtx", "%%MatrixMarket matrix array real general\n2 1\n1\nx2\n");
  what.q = folder / "bad.mtx";
  EXPECT_THAT(refused(what), AllOf(HasSubstr("bad.mtx:4"), HasSubstr("x2")));
  what = request();
  what.lower = folder / "three.mtx";
  EXPECT_THAT(refused(what), AllOf(HasSubstr("--lower"), HasSubstr("three.mtx")));
  what = request();
  what.start_at = folder / "three.mtx";
  EXPECT_THAT(refused(what), HasSubstr("--start-at"));
  what = request();
  what.start = 2;
  EXPECT_THAT(refused(what), HasSubstr("--start 2"));
  EXPECT_THAT(refused({.problem = "kojshin", .q = "q.mtx"}), AllOf(HasSubstr("q.mtx"), HasSubstr("kojshin")));
  EXPECT_THAT(refused({.problem = "kojshin", .lower = "0"}), HasSubstr("--lower"));
}

// Two answers of an infeasible problem: a status of its own, with the proof in words.
TEST_F(Matrix, Infeasible) {
  test::write(folder / "M.mtx", "%%MatrixMarket matrix coordinate real general\n2 2 2\n1 2 -1\n2 1 1\n");
  test::write(folder / "q.mtx", "-1\n-1\n");
  test::Captured captured;
  EXPECT_EQ(solve(request(), captured.streams), exit_unsolved);
  const Json result = parse_json(test::read(folder / "out.json"));
  EXPECT_EQ(result["status"], "Infeasible");
  EXPECT_THAT(result["message"].get<std::string>(), HasSubstr("proven to have no solution"));
}

// Rows make a variational inequality: over z_1 + z_2 <= 3 the multiplier is -1 and z = (1, 2) (docs/vi.md). Catches
// bounds of rows that go to variables, and a point judged by its multipliers.
TEST_F(Matrix, VariationalInequality) {
  test::write(folder / "A.mtx", "%%MatrixMarket matrix array real general\n1 2\n1\n1\n");
  SolveRequest what = request();
  what.rows = folder / "A.mtx";
  what.row_upper = "3";
  const Json result = solved(what);
  EXPECT_NEAR(result["variables"][0]["value"].get<double>(), 1, 1e-12);
  EXPECT_NEAR(result["variables"][1]["value"].get<double>(), 2, 1e-12);
  EXPECT_EQ(result["variables"][2]["name"], "lambda[1]");
  EXPECT_NEAR(result["variables"][2]["value"].get<double>(), -1, 1e-12);
  what.row_upper = "-1";
  test::Captured captured;
  EXPECT_EQ(solve(what, captured.streams), exit_unsolved);
  EXPECT_EQ(parse_json(test::read(folder / "out.json"))["status"], "Infeasible");
  what.row_upper = folder / "q.mtx";
  EXPECT_THAT(refused(what), AllOf(HasSubstr("--row-upper"), HasSubstr("2 numbers for 1 rows")));
  what.rows = folder / "q.mtx";
  EXPECT_THAT(refused(what), AllOf(HasSubstr("--rows"), HasSubstr("2 x 1")));
  what.rows.clear();
  EXPECT_THAT(refused(what), HasSubstr("--rows A.mtx"));
  EXPECT_THAT(refused({.problem = "kojshin", .rows = "A.mtx"}), HasSubstr("--rows"));
}

// The bimatrix game of Cottle, Pang & Stone 1992, example 4.4.23: three equilibria.
TEST_F(Matrix, EnumerationShowsAllSolutions) {
  test::write(
      folder / "M.mtx",
      "%%MatrixMarket matrix array real general\n4 4\n0\n0\n10\n20\n0\n0\n30\n15\n10\n20\n0\n0\n30\n15\n0\n0\n");
  test::write(folder / "q.mtx", "-1 -1 -1 -1\n");
  SolveRequest what = request();
  what.flags = {{"method", "enumeration", ""}};
  test::Captured captured;
  EXPECT_EQ(solve(what, captured.streams), exit_solved);
  EXPECT_THAT(captured.out.str(), HasSubstr("3 solutions, and there are no others"));
  const Json result = parse_json(test::read(folder / "out.json"));
  EXPECT_TRUE(result["solutions_complete"]);
  ASSERT_EQ(result["solutions"].size(), 3U);
  EXPECT_EQ(result["solutions"][0]["dimension"], 0);
}

// An LCP and an MLCP in Siconos' format, which tells them apart by its first numbers.
TEST(SiconosFiles, LcpAndMlcp) {
  const test::Folder folder;
  test::write(folder / "lcp.dat", "2\n0\n2\n2\n2\t2\n2 1\n1 2\n-5 -6\n");
  test::write(folder / "mlcp.dat", "0\n1\n1\n1\n2\n1\n1\n1\n-4\n-5\n");  // 2u + v - 4 = 0, 0 <= v _|_ u + v - 5 >= 0
  test::Captured captured;
  EXPECT_EQ(solve({.problem = folder / "lcp.dat", .json = "-"}, captured.streams), exit_solved) << captured.err.str();
  EXPECT_NEAR(parse_json(captured.out.str())["variables"][0]["value"].get<double>(), 4.0 / 3, 1e-14);
  test::Captured mixed;
  EXPECT_EQ(solve({.problem = folder / "mlcp.dat", .json = "-"}, mixed.streams), exit_solved) << mixed.err.str();
  const Json result = parse_json(mixed.out.str());
  EXPECT_EQ(result["variables"][0]["name"], "u[1]");
  EXPECT_NEAR(result["variables"][1]["value"].get<double>(), 6, 1e-13);
  test::write(folder / "bad.dat", "2\n1\n2\n2\n2 2\n2 1\n1 2\n-5 -6\n");
  test::Captured bad;
  EXPECT_EQ(solve({.problem = folder / "bad.dat"}, bad.streams), exit_input);
  EXPECT_THAT(bad.err.str(), HasSubstr("bad.dat:"));
}

}  // namespace
}  // namespace perp::app
