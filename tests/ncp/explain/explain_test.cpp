// SPDX-License-Identifier: Apache-2.0
/// explain() on small models that are broken in one way each. The model is the optimality conditions of
///     min s1 + 2 s2  subject to  s1 + s2 >= 1 (need), s1 <= 4 (cap1), s2 <= 4 (cap2), s >= 0,
/// whose Jacobian is skew: what is broken in it is known.
#include "ncp/explain/explain.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <span>

#include "ncp/problem/affine.hpp"
#include "ncp/problem/autodiff.hpp"
#include "ncp/strategy/lists.hpp"
#include "support/matrices.hpp"

namespace perp::ncp {
namespace {

using perp::support::matrix;
using perp::support::vec;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

lcp::AffineMcp model() {
  lcp::AffineMcp p{
      .M = matrix({{0, 0, -1, 1, 0}, {0, 0, -1, 0, 1}, {1, 1, 0, 0, 0}, {-1, 0, 0, 0, 0}, {0, -1, 0, 0, 0}}),
      .q = vec({1, 2, -1, 4, 4}),
      .box = Box::nonnegative(5)};
  return p;
}

Explanation explained(lcp::AffineMcp p) {
  const Vec x0 = Vec::Zero(p.size());
  const auto mcp = make_affine_mcp(std::move(p), "made", {"s1", "s2", "price", "rent1", "rent2"},
                                   {"d_s1", "d_s2", "need", "cap1", "cap2"});
  return explain(*mcp, x0, {.method = automatic()});
}

// Would catch any false alarm of a sound model.
TEST(Explain, SoundModelHasNoAnswers) {
  const Explanation found = explained(model());
  EXPECT_TRUE(found.result.solved());
  EXPECT_THAT(found.answers, IsEmpty());
}

// need >= 10 and both capacities contradict each other by 2; d_s1 and d_s2 have nothing to do with it. Would catch a
// set that is not smallest, a proof that is none, and a repair that is not least or does not mend.
TEST(Explain, SmallestConflictAndLeastRepair) {
  lcp::AffineMcp p = model();
  p.q[2] = -10;
  const lcp::AffineMcp broken = p;
  const Explanation found = explained(std::move(p));
  ASSERT_EQ(found.result.status, Status::Infeasible);
  ASSERT_FALSE(found.answers.empty());
  EXPECT_EQ(found.answers.front().kind, Answer::Kind::Conflict);
  EXPECT_TRUE(found.answers.front().proven);
  EXPECT_THAT(found.answers.front().rows, ElementsAre(2, 3, 4));
  ASSERT_TRUE(found.conflict);
  EXPECT_TRUE(found.conflict->smallest);
  ASSERT_NE(found.conflict->proof.certificate, nullptr);
  EXPECT_TRUE(holds(broken, *found.conflict->proof.certificate));
  double total = 0;
  for (const Change& c : found.repair.changes) total += std::abs(c.to - c.from);
  EXPECT_NEAR(total, 2, 1e-6);
  EXPECT_TRUE(found.repair.verified);
}

// x_2 - exp(x_1) >= 0 and exp(x_1) - x_2 >= 1 contradict each other whatever exp(x_1) is; the third row has nothing to
// do with it. Would catch a contradiction of rows that are not affine that is told as likely, demands on exp(x_1), and
// a repair that does not mend.
TEST(Explain, ConflictOfRowsWithTheSameTerms) {
  const auto mcp = make_autodiff_mcp(
      []<class T>(std::span<const T> x, std::span<T> F) {
        using std::exp;
        F[0] = x[1] - exp(x[0]);
        F[1] = exp(x[0]) - x[1] - 1;
        F[2] = x[2] + exp(x[1]) - 3;
      },
      {.box = Box::nonnegative(3), .equation_names = {"supply", "demand", "other"}});
  const Explanation found = explain(*mcp, Vec::Zero(3), {.method = automatic()});
  ASSERT_EQ(found.result.status, Status::Infeasible);
  ASSERT_FALSE(found.answers.empty());
  EXPECT_EQ(found.answers.front().kind, Answer::Kind::Conflict);
  EXPECT_TRUE(found.answers.front().proven);
  EXPECT_THAT(found.answers.front().rows, ElementsAre(0, 1));
  EXPECT_THAT(found.answers.front().variables, IsEmpty());
  EXPECT_THAT(found.answers.front().text, HasSubstr("rows supply and demand contradict each other"));
  EXPECT_TRUE(found.repair.verified);
}

// x - y = 0, 1e8 (y - z) = 0 and z - x = 1 contradict each other, no two of them do. Would catch a row that is left out
// because its multiplier is small beside the others' in the units that it is written in.
TEST(Explain, ConflictKeepsRowsOfLargeCoefficients) {
  const auto mcp = make_affine_mcp(
      {.M = matrix({{1, -1, 0}, {0, 1e8, -1e8}, {-1, 0, 1}}), .q = vec({0, 0, -1}), .box = Box::free(3)}, "made");
  const Explanation found = explain(*mcp, Vec::Zero(3), {.method = automatic()});
  ASSERT_EQ(found.result.status, Status::Infeasible);
  ASSERT_FALSE(found.answers.empty());
  EXPECT_TRUE(found.answers.front().proven);
  EXPECT_THAT(found.answers.front().rows, ElementsAre(0, 1, 2));
}

// e^x = -1, by terms that cancel beside it. Would catch a sentence without an end where nothing but the range of a term
// contradicts.
TEST(Explain, ConflictOfARowAndARange) {
  const auto mcp = make_autodiff_mcp(
      []<class T>(std::span<const T> x, std::span<T> F) {
        using std::exp;
        F[0] = x[1] * x[1] - x[0];
        F[1] = exp(x[0]) - x[1] * x[0] + x[2] + 1;
        F[2] = x[1] * x[0] - x[2];
      },
      {.box = Box::free(3)});
  const Explanation found = explain(*mcp, Vec::Zero(3), {.method = automatic()});
  ASSERT_EQ(found.result.status, Status::Infeasible) << found.result.message;
  ASSERT_FALSE(found.answers.empty());
  EXPECT_TRUE(found.answers.front().proven);
  EXPECT_THAT(found.answers.front().rows, ElementsAre(1, 2));
  EXPECT_THAT(found.answers.front().text, HasSubstr("with the ranges of terms that are not affine"));
}

// Each is solved, or found to have no solution, and in each the row is told that is no mirror of the others. Would
// catch a law that is read off the wrong entries, or blames the others.
TEST(Explain, RowThatBreaksTheSymmetry) {
  const auto told = [](lcp::AffineMcp p) {
    const Explanation found = explained(std::move(p));
    for (const Answer& a : found.answers)
      if (a.kind == Answer::Kind::Mirror) return a;
    return Answer{};
  };
  lcp::AffineMcp sign = model();
  sign.M.coeffRef(0, 3) = -1;  // rent1 in d_s1
  EXPECT_THAT(told(sign).rows, testing::Contains(0));
  lcp::AffineMcp unit = model();
  unit.M.coeffRef(2, 1) = 1000;  // s2 in need
  EXPECT_THAT(told(unit).text, HasSubstr("1000 in row need"));
  lcp::AffineMcp deleted = model();
  deleted.M.coeffRef(1, 2) = 0;  // price in d_s2
  EXPECT_THAT(told(deleted).text, HasSubstr("no entry in row d_s2"));
}

// Levels of a benchmark that are outside the bounds are a slip in one of them. Would catch a start that is moved
// silently.
TEST(Explain, StartOutsideTheBoundsIsTold) {
  lcp::AffineMcp p = model();
  p.box.upper[0] = 2;
  const auto mcp = make_affine_mcp(std::move(p), "made");
  const Explanation found = explain(*mcp, vec({3, 0, 0, 0, 0}), {.method = automatic()});
  ASSERT_FALSE(found.answers.empty());
  EXPECT_EQ(found.answers.front().kind, Answer::Kind::Start);
  EXPECT_THAT(found.answers.front().variables, ElementsAre(0));
}

}  // namespace
}  // namespace perp::ncp
