// SPDX-License-Identifier: Apache-2.0
/// The chart of what the parameter of a C-function does.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/compare/campaign_support.hpp"
#include "app/comparison_report/page.hpp"

namespace perp::app::comparison {
namespace {

using test::MadeUp;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string chart_of(const MadeUp& made_up) {
  const CampaignData data = made_up.data();
  for (const Comparison& comparison : comparisons(data))
    if (comparison.id.starts_with("cfunctions")) return parameter_chart(data, comparison);
  return "no comparison of C-functions";
}

// 18, 12 and 20 of 20 pairs at rho = 0.01, 1 and 100, and one function without a parameter, which has no place. Catches
// a share that is drawn at another value, and a curve of one point.
TEST(ParameterChart, HasTheSharesByValue) {
  MadeUp made_up;
  made_up.problems("tiny", 20);
  for (const auto& [value, solved] : {std::pair("0.01", 18), {"1", 12}, {"100", 20}}) {
    const std::string label = std::string("semismooth:cfunction=min-rho-b:cfunction_parameter=") + value;
    made_up.method(label, "min-rho-b").runs(label, "tiny", 20, solved);
  }
  made_up.method("semismooth:cfunction=min", "min").runs("semismooth:cfunction=min", "tiny", 20, 15);
  EXPECT_THAT(chart_of(made_up), AllOf(HasSubstr("min-rho-b at 0.01: 90.0 %"), HasSubstr("min-rho-b at 1: 60.0 %"),
                                       HasSubstr("min-rho-b at 100: 100.0 %"), Not(HasSubstr("min at"))));
  EXPECT_THAT(chart_of(made_up), AllOf(HasSubstr("Solved of 20 pairs"), HasSubstr(">rho<"), Not(HasSubstr("lambda"))));
}

TEST(ParameterChart, NeedsTwoValues) {
  MadeUp made_up;
  made_up.problems("tiny", 5);
  for (const char* label : {"semismooth:cfunction=min-rho-b:cfunction_parameter=2", "semismooth:cfunction=min"})
    made_up.method(label, "min").runs(label, "tiny", 5, 5);
  EXPECT_EQ(chart_of(made_up), "");
}

}  // namespace
}  // namespace perp::app::comparison
