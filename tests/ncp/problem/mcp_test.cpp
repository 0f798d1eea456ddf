// SPDX-License-Identifier: Apache-2.0
#include "ncp/problem/mcp.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <utility>

#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::nan;
using support::vec;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

Functions named() {
  Functions functions = support::kojima_shindo();
  functions.name = "market";
  functions.variable_names = {"price[1]", "price[2]", "price[3]", "demand"};
  functions.equation_names = {"supply", "clearing", "profit", "income"};
  return functions;
}

// Kojima & Shindo 1986 by hand at (1, 2, 0, 1). Catches a wrapper that loses or exchanges its functions.
TEST(MakeMcp, EvaluatesItsFunctions) {
  const auto mcp = make_mcp(support::kojima_shindo());
  EXPECT_EQ(mcp->size(), 4);
  EXPECT_EQ(mcp->name(), "kojima-shindo");
  Vec F(4);
  ASSERT_TRUE(mcp->eval(vec({1, 2, 0, 1}), F));
  EXPECT_EQ(F, vec({12, 7, 13, 13}));
  SpMat J = mcp->jacobian_pattern();
  ASSERT_TRUE(mcp->jacobian(vec({1, 2, 0, 1}), J));
  EXPECT_EQ(J.coeff(0, 1), 10);
  EXPECT_EQ(J.coeff(1, 0), 5);
  EXPECT_EQ(J.coeff(3, 3), 3);
  EXPECT_EQ(mcp->box().lower, Vec::Zero(4));
}

TEST(MakeMcp, NamesCountFromOneUnlessGiven) {
  const auto plain = make_mcp(support::kojima_shindo());
  EXPECT_EQ(plain->variable_name(0), "x[1]");
  EXPECT_EQ(plain->equation_name(3), "F[4]");
  const auto mcp = make_mcp(named());
  EXPECT_EQ(mcp->variable_name(2), "price[3]");
  EXPECT_EQ(mcp->equation_name(1), "clearing");
}

// Catches parts that do not fit and are found out by a crash later.
TEST(MakeMcp, RefusesPartsThatDoNotFit) {
  const auto refusal = [](auto damage) {
    return [damage] {
      Functions functions = named();
      damage(functions);
      make_mcp(std::move(functions));
    };
  };
  EXPECT_THAT(refusal([](Functions& f) { f.F = nullptr; }),
              ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr("market"), HasSubstr("no function F"))));
  EXPECT_THAT(refusal([](Functions& f) {
                f.J = nullptr;
                f.affine = true;
              }),
              ThrowsMessage<std::invalid_argument>(HasSubstr("no Jacobian J")));
  EXPECT_THAT(refusal([](Functions& f) {
                f.J = nullptr;
                f.differences.noise = 0;
              }),
              ThrowsMessage<std::invalid_argument>(HasSubstr("noise")));
  EXPECT_THAT(refusal([](Functions& f) { f.box.upper = Vec::Zero(3); }),
              ThrowsMessage<std::invalid_argument>(HasSubstr("4 lower bounds and 3 upper bounds")));
  EXPECT_THAT(refusal([](Functions& f) { f.pattern = SpMat(4, 3); }),
              ThrowsMessage<std::invalid_argument>(HasSubstr("4 x 3")));
  EXPECT_THAT(refusal([](Functions& f) { f.variable_names.pop_back(); }),
              ThrowsMessage<std::invalid_argument>(HasSubstr("3 names for 4 variables")));
  EXPECT_THAT(refusal([](Functions& f) { f.equation_names.emplace_back("one too many"); }),
              ThrowsMessage<std::invalid_argument>(HasSubstr("5 names for 4")));
  EXPECT_THAT(refusal([](Functions& f) {
                f.linear_entries = {true, false};
              }),
              ThrowsMessage<std::invalid_argument>(HasSubstr("2 flags of linear entries")));
}

// Nothing is known unless said; an affine problem says it of all. Catches flags that get lost on the way.
TEST(MakeMcp, PassesOnWhichEntriesAreLinear) {
  EXPECT_TRUE(make_mcp(named())->linear_entries().empty());
  Functions functions = named();
  functions.linear_entries = std::vector<bool>(16, false);
  functions.linear_entries[2] = true;
  EXPECT_EQ(make_mcp(functions)->linear_entries(), functions.linear_entries);
  functions.affine = true;
  EXPECT_EQ(make_mcp(functions)->linear_entries(), std::vector<bool>(16, true));
}

// A pattern built entry by entry is not compressed; mcp.hpp promises one that is.
TEST(MakeMcp, CompressesThePattern) {
  Functions functions = support::kojima_shindo();
  functions.pattern.uncompress();
  EXPECT_TRUE(make_mcp(std::move(functions))->jacobian_pattern().isCompressed());
}

TEST(DensePattern, HasEveryEntry) {
  EXPECT_EQ(dense_pattern(3).nonZeros(), 9);
  EXPECT_TRUE(dense_pattern(3).isCompressed());
  EXPECT_EQ(dense_pattern(0).rows(), 0);
}

auto input(Functions functions, Vec x0) {
  return [functions = std::move(functions), x0 = std::move(x0)] { check_input(*make_mcp(functions), x0); };
}

Functions bounded(Index i, double lower, double upper) {
  Functions functions = named();
  functions.box.lower[i] = lower;
  functions.box.upper[i] = upper;
  return functions;
}

TEST(CheckInput, AcceptsEveryKindOfInterval) {
  EXPECT_NO_THROW(input(named(), Vec::Ones(4))());
  EXPECT_NO_THROW(input(named(), vec({-5, 1e300, 0, -0.0}))());  // outside the box: projected later
  EXPECT_NO_THROW(input(bounded(2, -infinity, infinity), Vec::Ones(4))());
  EXPECT_NO_THROW(input(bounded(2, 3, 3), Vec::Ones(4))());
  EXPECT_NO_THROW(input(bounded(2, -infinity, 3), Vec::Ones(4))());
}

// What, where and the value, in the words of the problem. Catches boxes without a point, which the methods would search
// for ever, and NaNs, which compare false with everything.
TEST(CheckInput, NamesTheVariableWithoutAnInterval) {
  for (const auto& [lower, upper, text] : {std::tuple{4.0, 2.5, "2.5"},
                                           {nan, 1.0, "nan"},
                                           {0.0, nan, "nan"},
                                           {infinity, infinity, "inf"},
                                           {-infinity, -infinity, "-inf"}})
    EXPECT_THAT(input(bounded(2, lower, upper), Vec::Ones(4)),
                ThrowsMessage<std::invalid_argument>(
                    AllOf(HasSubstr("market"), HasSubstr("price[3]"), HasSubstr("bound"), HasSubstr(text))))
        << lower << ' ' << upper;
}

TEST(CheckInput, NamesTheVariableWithoutAStart) {
  EXPECT_THAT(input(named(), Vec::Ones(3)),
              ThrowsMessage<std::invalid_argument>(HasSubstr("3 entries for 4 variables")));
  EXPECT_THAT(input(named(), vec({1, 1, nan, 1})),
              ThrowsMessage<std::invalid_argument>(HasSubstr("the start of variable price[3] is nan")));
  EXPECT_THAT(input(named(), vec({1, -infinity, 1, 1})),
              ThrowsMessage<std::invalid_argument>(HasSubstr("the start of variable price[2] is -inf")));
}

/// A problem of a class of one's own, which nothing has checked before.
struct Raw final : Mcp {
  Box bounds = Box::nonnegative(2);
  SpMat J = dense_pattern(2);
  const Box& box() const override { return bounds; }
  const SpMat& jacobian_pattern() const override { return J; }
  bool eval(In, Out F) const override { return F.setZero(), true; }
  bool jacobian(In, SpMat&) const override { return true; }
};

// Catches problems that did not come through make_mcp.
TEST(CheckInput, LooksAtProblemsOfOtherClasses) {
  Raw raw;
  EXPECT_NO_THROW(check_input(raw, Vec::Ones(2)));
  EXPECT_EQ(raw.name(), "mcp");
  raw.bounds.upper = Vec::Ones(3);
  EXPECT_THAT([&] { check_input(raw, Vec::Ones(2)); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("2 lower bounds and 3 upper bounds")));
  raw = {};
  raw.J = SpMat(3, 2);
  EXPECT_THAT([&] { check_input(raw, Vec::Ones(2)); }, ThrowsMessage<std::invalid_argument>(HasSubstr("3 x 2")));
  raw = {};
  raw.J.uncompress();
  EXPECT_THAT([&] { check_input(raw, Vec::Ones(2)); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("not compressed")));
}

}  // namespace
}  // namespace perp::ncp
