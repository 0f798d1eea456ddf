// SPDX-License-Identifier: Apache-2.0
/// The formulations and methods of `perp contact` as flags.
#include "app/contact/run/variant.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/support.hpp"

namespace perp::app::contacts {
namespace {

using testing::HasSubstr;

// A comparison's cells are runs of these flags: would catch one that asks for something else.
TEST(ContactVariant, FlagsAskForTheSame) {
  for (const std::string label : {"glocker+auto", "glocker+homotopy", "glocker+path/B/original", "inner:8+lemke/mixed",
                                  "outer:5", "frictionless", "ncp1+semismooth"}) {
    const std::vector<std::string> flags = parse_variant(label).flags();
    VariantRequest request;
    for (std::size_t k = 0; k + 1 < flags.size(); k += 2) {
      if (flags[k] == "--formulation") request.formulation = flags[k + 1];
      if (flags[k] == "--method") request.method = flags[k + 1];
      if (flags[k] == "--encoding") request.encoding = flags[k + 1];
      if (flags[k] == "--row") request.row = flags[k + 1];
      if (flags[k] == "--form") request.form = flags[k + 1];
    }
    EXPECT_EQ(parse_variant(request).label(), label);
  }
}

// Would catch a flag that is ignored where it means nothing, and a refusal that does not say what was wrong.
TEST(ContactVariant, RefusesWithFlagAndValue) {
  const auto why = [](const VariantRequest& request) { return test::refused([&] { parse_variant(request); }); };
  EXPECT_THAT(why({.formulation = "gloker"}), testing::AllOf(HasSubstr("'gloker'"), HasSubstr("'glocker'")));
  EXPECT_THAT(why({.formulation = "inner"}), HasSubstr("inner:8"));
  for (const char* K : {"inner:2", "outer:0", "inner:-4", "outer:1001"})
    EXPECT_THAT(why({.formulation = K}), testing::AllOf(HasSubstr(K), HasSubstr("3 to 1000")));
  for (const char* K : {"inner:", "outer:8x", "inner:1e3", "inner:99999999999999999999"})
    EXPECT_THAT(why({.formulation = K}), HasSubstr("no number of facets"));
  EXPECT_THAT(why({.formulation = "glocker:8"}), HasSubstr("no facets"));
  EXPECT_THAT(why({.formulation = "inner:8", .encoding = "B"}),
              testing::AllOf(HasSubstr("--encoding B"), HasSubstr("inner:8")));
  EXPECT_THAT(why({.formulation = "frictionless", .row = "original"}), HasSubstr("--row original"));
  EXPECT_THAT(why({.formulation = "glocker", .form = "mixed"}), HasSubstr("--form mixed"));
  EXPECT_THAT(why({.formulation = "glocker", .encoding = "C"}), HasSubstr("'C'"));
  EXPECT_THAT(why({.method = "homotopy", .encoding = "B"}),
              testing::AllOf(HasSubstr("--encoding B"), HasSubstr("another method")));
  EXPECT_THAT(why({.method = "homotopy", .row = "original"}), HasSubstr("--row original"));
  EXPECT_THAT(why({.method = "auto", .encoding = "A"}), HasSubstr("method auto has its own form"));
  EXPECT_THAT(why({.method = "pth"}), HasSubstr("'path'"));
  EXPECT_THAT(why({.method = "lemke"}), HasSubstr("affine"));
  EXPECT_THAT(why({.formulation = "inner:8", .method = "homotopy"}), HasSubstr("glocker"));
  EXPECT_THAT(test::refused([] { parse_variant(std::string("glocker+path/C")); }), HasSubstr("'C'"));
  EXPECT_THAT(test::refused([] { parse_variants("inner:8,glocker,inner:8"); }), HasSubstr("twice"));
  EXPECT_THAT(test::refused([] { parse_variants("inner:8,,glocker"); }), HasSubstr("''"));
}

}  // namespace
}  // namespace perp::app::contacts
