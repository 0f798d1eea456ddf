// SPDX-License-Identifier: Apache-2.0
// Starts at which a model is not defined: the operation, its argument and the argument's value are named, and a start
// on a bound is moved off it. The texts are written by hand from the expressions, the solution x = 0.5 is put into the
// models. Would catch a message that names the variable which happens to be paired with the row, and a solve that gives
// up although a bound shows where the domain is.
#include <cmath>

#include "ncp/strategy/solve.hpp"
#include "nl_text.hpp"

namespace perp::ncp::ampl {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

struct Case {
  std::string expression;  // in x = v0
  double value;            // at 0.5, of an increasing function
  std::string bounds;      // of x
  double start;
  std::vector<std::string> told;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> list{
      {"o43\nv0\n", std::log(0.5), "2 0", 0, {"log(x)", "x = 0 at the start"}},
      {"o42\nv0\n", std::log10(0.5), "2 0", 0, {"log10(x)", "x = 0 at the start"}},
      {"o16\no3\nn1\nv0\n", -2, "2 0", 0, {"1/x in", "x = 0 at the start"}},
      {"o16\no5\nv0\nn-0.5\n", -std::sqrt(2), "2 0", 0, {"x^-0.5", "x = 0 at the start"}},
      {"o39\nv0\n", std::sqrt(0.5), "2 0", 0, {"the derivative of sqrt(x)", "x = 0 at the start"}},
      {"o5\nv0\nn0.5\n", std::sqrt(0.5), "2 0", 0, {"the derivative of x^0.5", "x = 0 at the start"}},
      {"o5\nv0\nn1\n", 0.5, "2 0", 0, {"the derivative of x^1", "x = 0 at the start"}},
      {"o51\nv0\n", std::asin(0.5), "0 -1 1", -1, {"the derivative of asin(x)", "x = -1 at the start"}},
      {"o51\nv0\n", std::asin(0.5), "0 -1 1", 1, {"the derivative of asin(x)", "x = 1 at the start"}},
      {"o16\no53\nv0\n", -std::acos(0.5), "0 -1 1", 1, {"the derivative of acos(x)", "x = 1 at the start"}},
      {"o47\nv0\n", std::atanh(0.5), "0 -1 1", 1, {"atanh(x)", "x = 1 at the start"}},
      {"o52\no0\nv0\nn1\n", std::acosh(1.5), "2 0", 0, {"acosh(x + 1)", "x + 1 = 1 at the start, where x = 0"}},
      {"o43\no1\nv0\nn-3\n", std::log(3.5), "2 -3", -3, {"log(x - (-3))", "= 0 at the start, where x = -3"}},
      {"o43\no2\nn2\nv0\n", 0, "0 0 1e-3", 0, {"log(2*x)", "2*x = 0 at the start, where x = 0"}},
      {"o2\nn1e-3\no43\no3\nv0\no1\nn1\nv0\n", 0, "0 0 1", 1, {"x/(1 - x)", "1 - x = 0 at the start, where x = 1"}},
      {"o43\no3\nv0\no1\nn1\nv0\n", 0, "0 0 1", 0, {"log(x/(1 - x))", "x/(1 - x) = 0 at the start, where x = 0"}},
  };
  return list;
}

std::unique_ptr<Model> model_of(const Case& c) {
  const TempFolder folder;
  const std::string path =
      folder.write("m.nl", text({.vars = 1, .cons = 1, .cc = 1, .nonzeros = 1}) + "C0\no1\n" + c.expression + "n" +
                               std::to_string(c.value) + "\nx1\n0 " + std::to_string(c.start) + "\nr\n5 " +
                               (c.bounds.front() == '0' ? "3" : "1") + " 1\nb\n" + c.bounds + "\nk0\nJ0 1\n0 0\n");
  folder.write("m.col", "x\n");
  folder.write("m.row", "market\n");
  return read_model(path);
}

// Every operation with an end of its domain at a bound. With 0 <= x <= 1e-3 the solution is the upper bound.
TEST(UndefinedStart, OnABoundIsMovedInside) {
  for (const Case& c : cases()) {
    const auto model = model_of(c);
    for (const char* method : {"auto", "path"}) {
      const Result result = solve(*model, model->start(), method_of(method));
      ASSERT_TRUE(result.solved()) << c.expression << method << ": " << result;
      EXPECT_NEAR(result.x[0], c.bounds == "0 0 1e-3" ? 1e-3 : 0.5, 1e-4) << c.expression << method;
      if (result.notes.empty()) continue;  // the method begins in the interior by itself
      EXPECT_THAT(result.notes.front(), AllOf(HasSubstr("in row market"), HasSubstr("the start was moved")));
      for (const std::string& part : c.told) EXPECT_THAT(result.notes.front(), HasSubstr(part)) << c.expression;
    }
    EXPECT_FALSE(solve(*model, model->start(), method_of("auto")).notes.empty()) << c.expression;
  }
}

// utility = log(price), utility = 3, as `price` is free and starts at 0: either order of the rows pairs `utility` or
// `price` with the row that is not defined.
TEST(UndefinedStart, OfAFreeVariableIsNamed) {
  for (const bool swapped : {false, true}) {
    const TempFolder folder;
    const std::string log_row = "o43\nv0\n";
    const std::string path = folder.write(
        "m.nl", text({.vars = 2, .cons = 2, .eqns = 2, .nonzeros = 3}) + "C0\n" + (swapped ? "n0\n" : log_row) +
                    "C1\n" + (swapped ? log_row : "n0\n") + "x1\n1 5\nr\n4 " + (swapped ? "3\n4 0" : "0\n4 3") +
                    "\nb\n3\n3\nk1\n1\n" + (swapped ? "J0 1\n1 1\nJ1 2\n0 0\n1 -1\n" : "J0 2\n0 0\n1 -1\nJ1 1\n1 1\n"));
    folder.write("m.col", "price\nutility\n");
    folder.write("m.row", swapped ? "market\ndef_utility\n" : "def_utility\nmarket\n");
    const auto model = read_model(path);
    const Result result = solve(*model, model->start(), automatic());
    EXPECT_EQ(result.status, Status::EvaluationFailed);
    EXPECT_THAT(result.message, AllOf(HasSubstr("log(price) in row def_utility: price = 0 at the start"),
                                      Not(HasSubstr("utility = 5"))));
  }
}

// The bound of a variable that is paired with an equation is a row of its own in the problem. log(p) = 1, p >= 0.
TEST(UndefinedStart, TheModelsOwnBoundCountsWhereverItIs) {
  const auto model = read_text(text({.vars = 1, .cons = 1, .eqns = 1, .nonzeros = 1}) +
                               "C0\no43\nv0\nr\n4 1\nb\n2 0\nk0\nJ0 1\n0 0\n");
  const Result result = solve(*model, model->start(), automatic());
  ASSERT_TRUE(result.solved()) << result;
  EXPECT_NEAR(result.x[0], std::exp(1), 1e-6);
}

// 1 / (x - y) where both start at 0: the same step for both would leave the difference 0.
TEST(UndefinedStart, DifferencesAreMovedApart) {
  const auto model = read_text(text({.vars = 2, .cons = 2, .cc = 2, .nonzeros = 4}) +
                               "C0\no0\no5\no3\nn1\no1\nv0\nv1\nn2\no1\nv0\nn3\nC1\no0\no5\no3\nn1\no1\nv0\nv1\nn2\n"
                               "o1\nv1\nn1\nr\n5 1 1\n5 1 2\nb\n2 0\n2 0\nk1\n2\nJ0 2\n0 0\n1 0\nJ1 2\n0 0\n1 0\n");
  const Result result = solve(*model, model->start(), automatic());
  EXPECT_NE(result.status, Status::EvaluationFailed) << result;
  ASSERT_FALSE(result.notes.empty());
  EXPECT_THAT(result.notes.front(), HasSubstr("_svar[1] - _svar[2] = 0 at the start, where _svar[1] = 0 and"));
}

// bv - log(x) = 1, bv complements x >= 0, where the auxiliary variable bv comes first and is no unknown: x = 1/e.
// Catches unknowns taken for the model's variables.
TEST(UndefinedStart, AuxiliaryVariablesAreNotCounted) {
  const TempFolder folder;
  const std::string path = folder.write("m.nl", text({.vars = 2, .cons = 2, .eqns = 1, .cc = 1, .nonzeros = 3}) +
                                                    "C0\no16\no43\nv1\nC1\nn0\nr\n4 1\n5 1 2\nb\n3\n2 0\nk1\n2\n"
                                                    "J0 2\n0 1\n1 0\nJ1 1\n0 1\n");
  folder.write("m.col", "c.bv\nx\n");
  folder.write("m.row", "c.bc\nc.c\n");
  const auto model = read_model(path);
  const Result result = solve(*model, model->start(), automatic());
  ASSERT_TRUE(result.solved()) << result;
  EXPECT_NEAR(result.x[model->n_var() - 1], std::exp(-1), 1e-6);
  ASSERT_FALSE(result.notes.empty());
  EXPECT_THAT(result.notes.front(), HasSubstr("log(x) in row c: x = 0 at the start"));
}

// exp(800 x) at x = 1 has a value, which no double holds.
TEST(UndefinedStart, OverflowIsSaidToBeOne) {
  const auto model = read_text(text({.vars = 1, .cons = 1, .eqns = 1, .nonzeros = 1}) +
                               "C0\no44\no2\nn800\nv0\nx1\n0 1\nr\n4 1\nb\n3\nk0\nJ0 1\n0 0\n");
  EXPECT_THAT(solve(*model, model->start(), automatic()).message,
              HasSubstr("exp(800*_svar[1]) in row _scon[1] is too large: 800*_svar[1] = 800 at the start"));
}

// A long argument is shortened, and a deep one does not exhaust the stack.
TEST(UndefinedStart, LongArgumentsAreShortened) {
  std::string sum = "n0\n";
  std::string deep = "v0\n";
  for (int k = 0; k < 2000; ++k) {
    sum.insert(0, "o0\n").append("v0\n");
    deep.insert(0, "o41\n");
  }
  for (const std::string& argument : {sum, deep}) {
    const auto model = read_text(text({.vars = 1, .cons = 1, .eqns = 1, .nonzeros = 1}) + "C0\no43\n" + argument +
                                 "r\n4 -10\nb\n3\nk0\nJ0 1\n0 0\n");
    const std::string message = solve(*model, model->start(), automatic()).message;
    EXPECT_THAT(message, AllOf(HasSubstr("..."), HasSubstr("where _svar[1] = 0")));
    EXPECT_LT(message.size(), 400);
  }
}

// if x >= 1 then log(x - 1) else 1 / x, at 0: which branch it is is not known, the one that is not defined is named.
TEST(UndefinedStart, WithinAConditionIsNamedWhereNothingElseIs) {
  const auto model = read_text(text({.vars = 1, .cons = 1, .cc = 1, .nonzeros = 1}) +
                               "C0\no35\no28\nv0\nn1\no43\nv0\no3\nn1\nv0\nr\n5 1 1\nb\n2 0\nk0\nJ0 1\n0 0\n");
  const Result result = solve(*model, model->start(), automatic());
  ASSERT_FALSE(result.notes.empty()) << result;
  EXPECT_THAT(result.notes.front(), HasSubstr("_svar[1] = 0 at the start"));
}

}  // namespace
}  // namespace perp::ncp::ampl
