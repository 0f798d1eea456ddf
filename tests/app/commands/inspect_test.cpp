// SPDX-License-Identifier: Apache-2.0
/// `perp inspect`: what it finds in small problems that are wrong in one way each, what it prints and writes.
#include "app/commands/inspect.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <limits>

#include "app/json.hpp"
#include "app/support.hpp"
#include "ncp/problem/affine.hpp"
#include "ncp/strategy/solve.hpp"
#include "support/matrices.hpp"
#include "support/problems.hpp"

namespace perp::app {
namespace {

using perp::support::matrix;
using perp::support::vec;
using test::Json;
using test::parse_json;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// Keeps the problems that inspections refer to.
class Inspect : public testing::Test {
 protected:
  LoadedProblem& loaded(std::unique_ptr<ncp::Mcp> mcp, ncp::Vec x0) {
    LoadedProblem problem{.label = "made", .mcp = std::move(mcp), .x0 = std::move(x0)};
    return problems_.emplace_back(std::move(problem));
  }
  LoadedProblem& loaded(ncp::Functions functions, ncp::Vec x0) {
    return loaded(ncp::make_mcp(std::move(functions)), std::move(x0));
  }
  LoadedProblem& affine(ncp::SpMat M, ncp::Vec q, ncp::Box box, std::vector<std::string> variables = {},
                        std::vector<std::string> equations = {}) {
    ncp::Vec x0 = lcp::project(box, ncp::Vec::Zero(q.size()));
    return loaded(ncp::make_affine_mcp({std::move(M), std::move(q), std::move(box)}, "made", std::move(variables),
                                       std::move(equations)),
                  std::move(x0));
  }

 private:
  std::deque<LoadedProblem> problems_;
};

std::string printed(const Inspection& inspection) {
  std::ostringstream out;
  print_inspection(out, inspection);
  return out.str();
}
std::vector<std::string> texts(const Inspection& inspection, Concern::Part part) {
  std::vector<std::string> found;
  for (const Concern& concern : concerns(inspection))
    if (concern.part == part) found.push_back(concern.text);
  return found;
}

TEST_F(Inspect, AHealthyProblem) {
  test::Captured captured;
  EXPECT_EQ(inspect({.source = {.problem = "nash10"}}, captured.streams), exit_solved);
  EXPECT_THAT(captured.out.str(), AllOf(HasSubstr("nash10: 10 variables"), HasSubstr("10 with a lower bound"),
                                        HasSubstr("structural rank 10 of 10"), HasSubstr("Nothing stands out.")));
  EXPECT_THAT(captured.out.str(), Not(HasSubstr("!")));
  EXPECT_EQ(captured.err.str(), "");
}

TEST_F(Inspect, KindsOfVariables) {
  const double inf = ncp::infinity;
  const LoadedProblem& problem =
      affine(matrix({{1, 0, 0, 0, 0, 0},
                     {0, 1, 0, 0, 0, 0},
                     {0, 0, 1, 0, 0, 0},
                     {0, 0, 0, 1, 0, 0},
                     {0, 0, 0, 0, 1, 0},
                     {0, 0, 0, 0, 0, 1}}),
             ncp::Vec::Ones(6), {vec({-inf, 0, -inf, 0, 3, -inf}), vec({inf, inf, 1, 1, 3, inf})},
             {"a", "b", "c", "d", "numeraire", "f"});
  const Inspection inspection = inspect_problem(problem);
  EXPECT_EQ(inspection.kinds.free, 2);
  EXPECT_EQ(inspection.kinds.lower, 1);
  EXPECT_EQ(inspection.kinds.upper, 1);
  EXPECT_EQ(inspection.kinds.boxed, 1);
  EXPECT_THAT(inspection.kinds.fixed, ElementsAre(4));
  EXPECT_EQ(inspection.structure.size, 5);
  EXPECT_THAT(printed(inspection), AllOf(HasSubstr("fixed (numeraire)"), HasSubstr("2 free")));
}

// Two equations in one unknown, and an unknown in no equation: the names of all three must be told. The bounded third
// variable must not be blamed.
TEST_F(Inspect, StructurallySingular) {
  const double inf = ncp::infinity;
  const LoadedProblem& problem =
      affine(matrix({{1, 0, 0}, {2, 0, 0}, {0, 0, 1}}), vec({1, 1, 1}), {vec({-inf, -inf, 0}), vec({inf, inf, inf})},
             {"price", "income", "stock"}, {"market", "budget", "storage"});
  const Inspection inspection = inspect_problem(problem);
  EXPECT_EQ(inspection.structure.rank, 2);
  EXPECT_EQ(inspection.structure.rank_with_bounds, 2);
  EXPECT_TRUE(inspection.structure.singular());
  EXPECT_THAT(inspection.structure.over.rows, ElementsAre(0, 1));
  EXPECT_THAT(inspection.structure.over.columns, ElementsAre(0));
  EXPECT_THAT(inspection.structure.under.columns, ElementsAre(1));
  EXPECT_THAT(inspection.structure.empty_columns, ElementsAre(1));
  EXPECT_THAT(printed(inspection),
              AllOf(HasSubstr("! structurally singular"), HasSubstr("market and budget"),
                    HasSubstr("variable income is in no row: nothing determines it"), Not(HasSubstr("storage)"))));
}

// [0 A; -A' 0] with more rows than columns in A is singular, but not so with slacks: no concern, but told.
TEST_F(Inspect, SingularOnlyBetweenTheBounds) {
  const Inspection inspection =
      inspect_problem(affine(matrix({{0, 0, 1}, {0, 0, 2}, {-1, -2, 0}}), vec({1, 1, 1}), ncp::Box::nonnegative(3)));
  EXPECT_EQ(inspection.structure.rank, 2);
  EXPECT_EQ(inspection.structure.rank_with_bounds, 3);
  EXPECT_THAT(texts(inspection, Concern::Structure), IsEmpty());
  EXPECT_THAT(inspection.structure.over.rows, ElementsAre(0, 1));
  EXPECT_THAT(inspection.structure.under.columns, ElementsAre(0, 1));
  EXPECT_THAT(printed(inspection), AllOf(HasSubstr("structural rank 2 of 3"),
                                         HasSubstr("With variables at their bounds it is 3: no concern."),
                                         HasSubstr("Nothing stands out.")));
}

// A row that depends on fixed variables alone is empty; what a fixed variable's row lacks is not missed.
TEST_F(Inspect, EmptyRows) {
  const LoadedProblem& problem =
      affine(matrix({{1, 0, 0}, {0, 0, 5}, {0, 0, 0}}), vec({1, 1, 1}),
             {vec({0, 0, 2}), vec({ncp::infinity, ncp::infinity, 2})}, {"a", "b", "c"}, {"A", "B", "C"});
  const Inspection inspection = inspect_problem(problem);
  EXPECT_THAT(inspection.structure.empty_rows, ElementsAre(1));
  EXPECT_THAT(inspection.structure.empty_columns, ElementsAre(1));
  EXPECT_THAT(texts(inspection, Concern::Structure),
              ElementsAre("1 row depends on no variable: B", "1 variable occurs in no row: b"));
}

// An entry that is 0 everywhere is none for an affine problem, and may become one for others.
TEST_F(Inspect, ZerosInThePattern) {
  ncp::SpMat M = matrix({{1, 1}, {1, 1}});
  M.coeffRef(0, 1) = M.coeffRef(1, 1) = 0;
  EXPECT_THAT(inspect_problem(affine(M, vec({1, 1}), ncp::Box::free(2))).structure.empty_columns, ElementsAre(1));
  const LoadedProblem& product = loaded(support::dense(
                                            "product", ncp::Box::free(2),
                                            [](const ncp::Vec& x) {
                                              return vec({x[0] * x[1], x[0] - 1});
                                            },
                                            [](const ncp::Vec& x) {
                                              return ncp::SpMat(matrix({{x[1], x[0]}, {1, 0}})).toDense();
                                            }),
                                        ncp::Vec::Zero(2));
  const Inspection inspection = inspect_problem(product);
  EXPECT_EQ(inspection.structure.rank, 2);
  EXPECT_EQ(inspection.start.rank, 1);
  EXPECT_EQ(inspection.scaling.zeros, 3);
  EXPECT_THAT(printed(inspection), HasSubstr("structural rank 1 of 2 here, where 3 of the Jacobian's 4 entries are 0"));
}

TEST_F(Inspect, NotDefinedAtTheStart) {
  ncp::Functions functions = support::dense(
      "log", ncp::Box::nonnegative(2),
      [](const ncp::Vec& x) {
        return vec({x[0] - 1, std::log(x[1] - 1)});
      },
      [](const ncp::Vec& x) {
        return ncp::SpMat(matrix({{1, 0}, {0, 1 / (x[1] - 1)}})).toDense();
      });
  functions.equation_names = {"first", "logarithm"};
  const Inspection inspection = inspect_problem(loaded(functions, vec({0, 0})));
  EXPECT_FALSE(inspection.start.F_defined);
  EXPECT_THAT(inspection.start.F_undefined, ElementsAre(1));
  EXPECT_EQ(inspection.start.residual.natural, ncp::infinity);
  EXPECT_THAT(texts(inspection, Concern::Start),
              ElementsAre("not defined: row logarithm is NaN at the start, where x[1] = 0, x[2] = 0"));
  EXPECT_FALSE(inspection.condition.all);
  EXPECT_EQ(inspection.start.largest_F, 0);

  // F(1) is -inf, and dF_2 / dx_2 as well.
  const Inspection pole = inspect_problem(loaded(functions, vec({0, 1})));
  EXPECT_THAT(pole.start.J_undefined, ElementsAre(std::pair<ncp::Index, ncp::Index>{1, 1}));
  EXPECT_THAT(
      texts(pole, Concern::Start),
      ElementsAre(
          "not defined: row logarithm is infinite (an overflow or a pole) at the start, where x[1] = 0, x[2] = 1"));

  functions.F = [](ncp::In, ncp::Out) { return false; };
  const Inspection silent = inspect_problem(loaded(functions, vec({0, 3})));
  EXPECT_THAT(texts(silent, Concern::Start), ElementsAre("F is not defined at the start"));
  EXPECT_EQ(silent.start.residual.natural, ncp::infinity);
  EXPECT_THAT(printed(silent), Not(HasSubstr("natural residual")));
}

TEST_F(Inspect, WrongDerivative) {
  ncp::Functions functions = support::scalar(
      0, ncp::infinity, [](double x) { return x * x - 1; }, [](double x) { return -2 * x; });
  functions.variable_names = {"price"};
  functions.equation_names = {"market"};
  const Inspection inspection = inspect_problem(loaded(functions, vec({3})));
  EXPECT_THAT(texts(inspection, Concern::Derivatives),
              ElementsAre(AllOf(HasSubstr("market"), HasSubstr("price"), HasSubstr("given as -6"))));
  EXPECT_THAT(printed(inspection), AllOf(HasSubstr("derivatives  ! the Jacobian does not match F"),
                                         HasSubstr("1 point that deserves a second look is")));
}

// At the start 0: x_1 at its bound with F_1 = 0, x_2 at its bound with F_2 = 1, x_3 free with F_3 = 0.
TEST_F(Inspect, DegenerateAtTheStart) {
  const double inf = ncp::infinity;
  const Inspection inspection = inspect_problem(affine(matrix({{2, 1, 0}, {0, 3, 0}, {0, 0, 1}}), vec({0, 1, 0}),
                                                       {vec({0, 0, -inf}), vec({inf, inf, inf})}, {"a", "b", "c"}));
  EXPECT_THAT(inspection.start.degenerate, ElementsAre(0));
  EXPECT_EQ(inspection.start.zeros_in_F, 2);
  EXPECT_EQ(inspection.start.residual.natural, 0);
  // x_2's natural residual is x_2 - l_2; the rows of the others are those of J: [2 0; 0 1].
  EXPECT_EQ(inspection.condition.active_size, 2);
  EXPECT_DOUBLE_EQ(*inspection.condition.active, 0.5);
  EXPECT_THAT(printed(inspection), HasSubstr("at a bound with F_i = 0 (degenerate): a"));
}

TEST_F(Inspect, StartOutsideItsBounds) {
  LoadedProblem& problem = affine(matrix({{1, 0}, {0, 1}}), vec({-1, -1}), ncp::Box::nonnegative(2), {"a", "b"});
  problem.x0 = vec({-5, 2});
  const Inspection inspection = inspect_problem(problem);
  EXPECT_THAT(inspection.start.outside, ElementsAre(0));
  EXPECT_EQ(inspection.start.F[0], -1);  // of the projection
  EXPECT_THAT(printed(inspection), HasSubstr("a is outside its bounds"));
}

TEST_F(Inspect, BadlyScaled) {
  const Inspection inspection =
      inspect_problem(affine(matrix({{1e-6, 1e-7, 0}, {0, 1, 0}, {0, -2, 1e7}}), vec({1, 1, 1}), ncp::Box::free(3),
                             {"a", "b", "c"}, {"A", "B", "C"}));
  const ScalingFindings& found = inspection.scaling;
  EXPECT_EQ(found.smallest, 1e-7);
  EXPECT_EQ(found.smallest_at, (std::pair<ncp::Index, ncp::Index>{0, 1}));
  EXPECT_EQ(found.largest_at, (std::pair<ncp::Index, ncp::Index>{2, 2}));
  EXPECT_EQ(found.small_rows[0].index, 0);
  EXPECT_EQ(found.small_rows[0].value, 1e-6);
  EXPECT_EQ(found.large_columns[0].index, 2);
  EXPECT_DOUBLE_EQ(found.spread(), 1e13);
  EXPECT_THAT(texts(inspection, Concern::Scaling), ElementsAre(HasSubstr("1e+13")));
  EXPECT_THAT(printed(inspection), AllOf(HasSubstr("1e-07 (A by b)"), HasSubstr("1e+07 (C by c)"),
                                         HasSubstr("largest entries of rows: C 1e+07, B 1 and A 1e-06")));
}

// [1 1; 1 1] has full structural rank: only the factorization sees that it is singular.
TEST_F(Inspect, ConditionAtTheStart) {
  EXPECT_THAT(
      texts(inspect_problem(affine(matrix({{1, 1}, {1, 1}}), vec({1, 1}), ncp::Box::free(2))), Concern::Condition),
      ElementsAre(AllOf(HasSubstr("at the start the Jacobian of the 2 variables off their bounds is singular"),
                        HasSubstr("is 1 times that of"))));
  // ||diag(1, 1e-4)||_1 ||diag(1, 1e4)||_1
  const Inspection diagonal =
      inspect_problem(affine(matrix({{1, 0}, {0, 1e-4}}), vec({-1, -1}), ncp::Box::nonnegative(2)));
  EXPECT_NEAR(*diagonal.condition.all, 1e-4, 1e-12);
  EXPECT_THAT(concerns(diagonal), IsEmpty());
}

// Cottle, Pang & Stone 1992, example 1.2.1: [2 1; 1 2] is everything but Z.
TEST_F(Inspect, ClassesOfAnLcp) {
  const Inspection inspection = inspect_problem(
      affine(matrix({{2, 1}, {1, 2}}), vec({-5, -6}), ncp::Box::nonnegative(2), {"u", "v"}, {"U", "V"}));
  ASSERT_TRUE(inspection.classes);
  EXPECT_TRUE(inspection.classes->symmetric.yes());
  EXPECT_TRUE(inspection.classes->p.yes());
  EXPECT_TRUE(inspection.classes->z.no());
  EXPECT_THAT(printed(inspection), AllOf(HasSubstr("an LCP"), HasSubstr("positive definite"),
                                         HasSubstr("exactly one solution for every q"), HasSubstr("What follows:")));
  // A No is told with names.
  EXPECT_THAT(printed(inspection), testing::AnyOf(HasSubstr("(2, 1): V, u"), HasSubstr("(1, 2): U, v")));
  test::Captured nonlinear;
  inspect({.source = {.problem = "kojshin"}}, nonlinear.streams);
  EXPECT_THAT(nonlinear.out.str(), Not(HasSubstr("M is")));
}

// Nothing at all, and a thousand rows that say the same: lists stay short.
TEST_F(Inspect, SmallAndLarge) {
  const Inspection nothing = inspect_problem(affine(ncp::SpMat(0, 0), ncp::Vec(0), ncp::Box::free(0)));
  EXPECT_THAT(printed(nothing), AllOf(HasSubstr("0 variables"), HasSubstr("Nothing stands out.")));
  EXPECT_EQ(parse_json(inspect_json(nothing)).at("size"), 0);
  const Inspection empty = inspect_problem(affine(ncp::SpMat(1000, 1000), ncp::Vec::Ones(1000), ncp::Box::free(1000)));
  EXPECT_THAT(texts(empty, Concern::Structure)[1],
              AllOf(HasSubstr("rows without a variable: F[1]"), HasSubstr("and 995 more")));
  EXPECT_LT(printed(empty).size(), 6000U);
  EXPECT_EQ(empty.derivatives->columns, 50);
  EXPECT_THAT(printed(empty), HasSubstr("50 of 1000 columns"));
}

TEST_F(Inspect, NamesOfAModel) {
  test::Captured captured;
  EXPECT_EQ(inspect({.source = {.problem = PERP_SOURCE_DIR "/data/models/harberger.nl"}}, captured.streams),
            exit_solved);
  EXPECT_THAT(captured.out.str(), AllOf(HasSubstr("1 fixed (price[labour])"), HasSubstr("at budget[government]"),
                                        HasSubstr("structural rank 13 of 13")));
  // The files of names make the difference.
  const test::Folder folder;
  test::write(folder / "m.nl", test::undefined_nl());
  test::write(folder / "m.row", "entropy\n");
  test::Captured undefined;
  EXPECT_EQ(inspect({.source = {.problem = folder / "m.nl"}}, undefined.streams), exit_solved);
  EXPECT_THAT(undefined.out.str(), HasSubstr("not defined: log(_svar[1]) in row entropy: _svar[1] = 0 at the start"));
}

// A start on a bound: what solve() says of it, and of the objective. Catches two doors with two sentences.
TEST_F(Inspect, SaysWhatSolveSays) {
  std::string nl = test::scalar_nl("o43\nv0\n", 0);
  nl.replace(nl.find("\n 1 1 0"), 7, "\n 1 1 1");
  nl.insert(nl.find("x1\n"), "O0 0\nn5\n");
  const test::Folder folder;
  test::write(folder / "m.nl", nl);
  const LoadedProblem problem = load_problem(folder / "m.nl");
  const ncp::Result result = ncp::solve(*problem.mcp, problem.x0, ncp::automatic());
  EXPECT_TRUE(result.solved());
  const Inspection inspection = inspect_problem(problem);
  ASSERT_THAT(texts(inspection, Concern::Start), testing::SizeIs(1));
  EXPECT_THAT(result.notes, testing::Contains(texts(inspection, Concern::Start)[0]));
  EXPECT_THAT(printed(inspection), AllOf(HasSubstr("log(_svar[1]) in row _scon[1]: _svar[1] = 0 at the start"),
                                         HasSubstr("the objective is not used")));
}

// The keys app/README.md promises, with the types it promises.
TEST_F(Inspect, Json) {
  test::Captured captured;
  ASSERT_EQ(inspect({.source = {.problem = "murty"}, .json = "-"}, captured.streams), exit_solved);
  EXPECT_THAT(captured.err.str(), HasSubstr("structural rank"));
  const Json parsed = parse_json(captured.out.str());
  EXPECT_EQ(parsed.at("status"), "Inspected");
  EXPECT_EQ(parsed.at("exit_code"), 0);
  EXPECT_EQ(parsed.at("affine"), true);
  const Json::size_type n = parsed.at("size").get<Json::size_type>();
  EXPECT_EQ(parsed.at("variables").at("lower"), n);
  EXPECT_EQ(parsed.at("variables").at("fixed").at("names"), Json::array());
  for (const char* key : {"size", "rank", "rank_with_bounds"}) EXPECT_EQ(parsed.at("structure").at(key), n);
  for (const char* key : {"empty_rows", "empty_columns", "overdetermined", "underdetermined"})
    EXPECT_TRUE(parsed.at("structure").at(key).is_object()) << key;
  EXPECT_EQ(parsed.at("at_start").at("residual").at("natural"), 1.0);
  EXPECT_EQ(parsed.at("at_start").at("F_largest_equation"), "F[1]");
  EXPECT_EQ(parsed.at("scaling").at("largest"), 2.0);
  EXPECT_EQ(parsed.at("scaling").at("largest_at").at("row"), 0);
  EXPECT_EQ(parsed.at("derivatives").at("columns"), n);
  EXPECT_GT(parsed.at("condition").at("rcond").get<double>(), 1e-4);
  EXPECT_EQ(parsed.at("concerns"), Json::array());
  bool p = false;
  for (const Json& property : parsed.at("classes").at("properties"))
    if (property.at("name") == "P") p = property.at("answer") == "yes";
  EXPECT_TRUE(p);
  EXPECT_FALSE(parsed.at("classes").at("guarantees").empty());
}

TEST_F(Inspect, JsonOfConcernsAndInfinities) {
  const Json parsed = parse_json(inspect_json(
      inspect_problem(loaded(support::scalar(
                                 0, 1, [](double x) { return 1 / x; }, [](double x) { return -1 / (x * x); }),
                             vec({0})))));
  EXPECT_EQ(parsed.at("at_start").at("residual").at("natural"), "inf");
  EXPECT_EQ(parsed.at("at_start").at("F_undefined").at("indices"), Json::array({0}));
  EXPECT_EQ(parsed.at("at_start").at("rank"), nullptr);
  EXPECT_EQ(parsed.at("condition").at("rcond"), nullptr);
  EXPECT_EQ(parsed.at("classes"), nullptr);
  ASSERT_EQ(parsed.at("concerns").size(), 1U);
  EXPECT_THAT(parsed.at("concerns")[0].get<std::string>(), HasSubstr("the start was moved off the bounds"));
}

TEST_F(Inspect, RefusesWhatSolveRefuses) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::nonsquare_nl());
  const std::vector<ProblemSource> sources{{.problem = "kojshim"},
                                           {.problem = "kojshin", .start = 9},
                                           {.problem = folder / "none.nl"},
                                           {.problem = folder / "m.nl"},
                                           {.problem = "kojshin", .q = "q.mtx"}};
  for (const ProblemSource& source : sources) {
    test::Captured captured;
    EXPECT_EQ(inspect({.source = source, .json = folder / "out.json"}, captured.streams), exit_input);
    EXPECT_THAT(captured.err.str(), HasSubstr("perp: "));
    EXPECT_EQ(captured.out.str(), "");
    EXPECT_EQ(parse_json(test::read(folder / "out.json")).at("status"), "InputError");
  }
  test::Captured captured;
  EXPECT_EQ(inspect({.source = {.problem = "kojshin"}, .json = "/dev/full"}, captured.streams), exit_input);
  EXPECT_THAT(captured.out.str(), HasSubstr("structural rank"));
  test::Captured refused;
  EXPECT_EQ(inspect({.source = {.problem = "kojshin"}, .json = folder / "none/out.json"}, refused.streams), exit_input);
  EXPECT_EQ(refused.out.str(), "");
}

// Its Jacobian comes back with another pattern: refused as by solve, with names.
TEST_F(Inspect, JacobianThatLeavesItsPattern) {
  ncp::Functions functions = support::scalar(
      0, 1, [](double x) { return x; }, [](double) { return 1.0; });
  functions.J = [](ncp::In, ncp::SpMat& J) {
    J = ncp::SpMat(1, 1);
    return true;
  };
  EXPECT_THROW(inspect_problem(loaded(functions, vec({0}))), std::invalid_argument);
}

// Three goods without a numeraire: M p = 0 where all prices move together. At the start most F are larger than p, so
// that Newton's own matrix is regular there. Catches "nothing stands out" of what solve() says of the solution.
TEST_F(Inspect, PricesWithoutANumeraireAreTold) {
  const ncp::Box box{.lower = ncp::Vec::Constant(3, 1e-6), .upper = ncp::Vec::Constant(3, ncp::infinity)};
  const Inspection inspection = inspect_problem(
      loaded(ncp::make_affine_mcp({matrix({{8, -4, -4}, {-5, 6, -1}, {-3, -2, 5}}), vec({0, 0, 0}), box}, "goods"),
             vec({3, 1, 1})));
  EXPECT_GT(inspection.condition.active.value_or(1), 1e-3);
  EXPECT_THAT(texts(inspection, Concern::Condition), ElementsAre(HasSubstr("3 variables can move together")));
}

// x^2 - 2 on the model's box. Catches a table that is left out, or one of M for a nonlinear F.
TEST_F(Inspect, SaysTheClassOfNonlinearF) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  const LoadedProblem problem = load_problem(ProblemSource{.problem = folder / "m.nl"});
  const Inspection inspection = inspect_problem(problem);
  ASSERT_TRUE(inspection.function_classes);
  EXPECT_THAT(printed(inspection), AllOf(HasSubstr("uniform P-function"), Not(HasSubstr("M is"))));
  const Json parsed = parse_json(inspect_json(inspection));
  EXPECT_EQ(parsed.at("function_classes").at("properties").size(), 6);
  EXPECT_EQ(parsed.at("classes"), nullptr);
}

TEST_F(Inspect, InterruptedSaysWhatIsMissing) {
  const std::atomic<bool> interrupt{true};
  const LoadedProblem& problem = affine(matrix({{1}}), vec({1}), ncp::Box::free(1));
  const Inspection inspection = inspect_problem(problem, &interrupt);
  EXPECT_FALSE(inspection.derivatives);
  EXPECT_FALSE(inspection.classes);
  EXPECT_THAT(printed(inspection), HasSubstr("Interrupted: derivatives, condition, matrix classes left out."));
}

}  // namespace
}  // namespace perp::app
