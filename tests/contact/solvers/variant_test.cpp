// SPDX-License-Identifier: Apache-2.0
/// Laws, forms and methods by name.
#include "contact/solvers/variant.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ncp/strategy/presets.hpp"

namespace perp::contact {
namespace {

using testing::Contains;
using testing::HasSubstr;

// Would catch a default that changes, and a word that is dropped between text and variant.
TEST(Variant, TextThereAndBack) {
  for (const char* label :
       {"glocker+auto", "glocker+homotopy", "glocker+path/B", "glocker+semismooth/A", "glocker+path/B/original",
        "ncp1+path", "ncp1+semismooth", "inner:8", "outer:64/mixed", "inner:4+lemke/mixed", "frictionless",
        "frictionless+block-pivoting", "coulomb+nsgs", "coulomb+fixed-point", "coulomb+cadoux"})
    EXPECT_EQ(variant_of(label).label(), label);
  EXPECT_EQ(variant_of("glocker").label(), "glocker+auto");
  EXPECT_EQ(variant_of("glocker/B").label(), "glocker+path/B");
  EXPECT_EQ(variant_of("glocker/original").label(), "glocker+path/B/original");
  EXPECT_EQ(variant_of("ncp1").label(), "ncp1+path");
  EXPECT_EQ(variant_of("inner:8+auto/reduced").label(), "inner:8");
  EXPECT_EQ(Variant{}.label(), "glocker+auto");
  EXPECT_EQ(variant_of("coulomb").label(), "coulomb+nsgs");
}

// Methods on r alone have not Glocker's law: the formulation follows from the name. Catches a label that says of
// Gauss-Seidel that it solves Glocker's NCP.
TEST(Variant, FormulationFollowsFromTheName) {
  EXPECT_EQ(variant_of("glocker+nsgs").label(), "coulomb+nsgs");
  EXPECT_EQ(variant_of(VariantWords{.method = "tresca"}).label(), "coulomb+tresca");
  EXPECT_EQ(variant_of("coulomb+homotopy").label(), "glocker+homotopy");
  EXPECT_EQ(variant_of("coulomb+auto").label(), "glocker+auto");
  EXPECT_TRUE(std::holds_alternative<Nsgs>(variant_of("coulomb").solver));
  EXPECT_THROW(variant_of("coulomb+path"), std::invalid_argument);
  EXPECT_THROW(variant_of("ncp1+nsgs"), std::invalid_argument);
  EXPECT_THROW(variant_of("inner:8+nsgs"), std::invalid_argument);
  EXPECT_THROW(variant_of("coulomb+nsgs/B"), std::invalid_argument);
  EXPECT_THROW(variant_of("coulomb+nsgz"), UnknownWord);
}

// Would catch a method that a comparison of all leaves out, and a form.
TEST(Variant, StarsStandForAll) {
  const auto labels = [](const char* pattern) {
    std::vector<std::string> all;
    for (const Variant& variant : variants_of(pattern)) all.push_back(variant.label());
    return all;
  };
  EXPECT_THAT(labels("glocker+path"), testing::ElementsAre("glocker+path/B"));
  EXPECT_THAT(labels("inner:8+lemke/*"), testing::ElementsAre("inner:8+lemke", "inner:8+lemke/mixed"));
  EXPECT_THAT(labels("frictionless/*"), testing::ElementsAre("frictionless"));
  EXPECT_THAT(labels("outer:4+*"), testing::SizeIs(lcp::methods().size() - 1));
  const std::vector<std::string> grid = labels("glocker+*/*");
  for (const ncp::Preset& preset : ncp::presets()) {
    if (preset.name == "auto") continue;
    for (const char* form : {"/B", "/B/original", "/A", "/A/original"})
      EXPECT_THAT(grid, Contains("glocker+" + std::string(preset.name) + form));
  }
  EXPECT_THAT(grid, Contains("glocker+homotopy"));
  EXPECT_THAT(grid, testing::Each(testing::StartsWith("glocker+")));
  EXPECT_THAT(grid, testing::Not(Contains("glocker+auto")));
  EXPECT_THAT(labels("coulomb+*"), testing::Each(testing::StartsWith("coulomb+")));
  EXPECT_THAT(labels("coulomb+*"), testing::IsSupersetOf({"coulomb+nsgs", "coulomb+tresca", "coulomb+natural-map"}));
  EXPECT_THROW(variants_of("glocker/*/B"), std::invalid_argument);
  EXPECT_THROW(variants_of("*"), UnknownWord);
}

TEST(Variant, ExactLaws) {
  for (const char* label : {"glocker", "coulomb", "ncp1"}) EXPECT_TRUE(variant_of(label).exact());
  for (const char* label : {"inner:3", "outer:3", "frictionless"}) EXPECT_FALSE(variant_of(label).exact());
}

// Would catch a name that runs another method than it says.
TEST(Variant, NamesTheSolver) {
  EXPECT_TRUE(std::holds_alternative<Auto>(variant_of("glocker").solver));
  EXPECT_TRUE(std::holds_alternative<GlockerHomotopy>(variant_of("glocker+homotopy").solver));
  const Variant path = variant_of("glocker+path/A/original");
  ASSERT_NE(path.as_ncp(), nullptr);
  EXPECT_TRUE(ncp::path_of(path.as_ncp()->method) != nullptr);
  EXPECT_EQ(path.as_ncp()->formulation.encoding, Encoding::A);
  EXPECT_EQ(path.as_ncp()->formulation.row, DiskRow::Original);
  EXPECT_TRUE(std::holds_alternative<ncp::InteriorPoint>(std::get<ncp::Method>(variant_of("ncp1+interior").solver)));
  EXPECT_TRUE(std::holds_alternative<EncodingAuto>(variant_of("outer:4").solver));
  EXPECT_TRUE(std::holds_alternative<lcp::Lemke>(std::get<lcp::Method>(variant_of("inner:8+lemke").solver)));
  EXPECT_TRUE(ncp::path_of(std::get<ncp::Method>(variant_of("inner:8+path").solver)) != nullptr);
}

// Would catch words that are taken for near ones, and a refusal without what is known.
TEST(Variant, UnknownWordsComeWithTheKnownOnes) {
  const auto known = [](const char* text) {
    try {
      variant_of(text);
    } catch (const UnknownWord& error) {
      return error.known();
    }
    return std::vector<std::string_view>{};
  };
  EXPECT_THAT(known("gloker"), Contains("glocker"));
  EXPECT_THAT(known("glocker+pth"), testing::AllOf(Contains("path"), Contains("homotopy")));
  EXPECT_THAT(known("inner:8+lmke"), testing::AllOf(Contains("lemke"), testing::Not(Contains("path"))));
  EXPECT_THROW(variant_of("glocker/C"), std::invalid_argument);
  EXPECT_THROW(variant_of("glocker/mixed"), std::invalid_argument);
  EXPECT_THROW(variant_of(""), UnknownWord);
}

// The options of a method: every key a field of its own.
TEST(Variant, OptionsByName) {
  Auto method;
  ncp::Fields fields;
  describe(method, fields);
  const std::vector<ncp::Field> all = fields.options();
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(all[i].key, all[j].key);
  ASSERT_NE(fields.find("sweeps"), nullptr);
  *std::get<int*>(fields.find("sweeps")->target) = 7;
  EXPECT_EQ(method.sweeps, 7);
  EXPECT_EQ(fields.invalid(), std::nullopt);
  *std::get<double*>(fields.find("to_boundary")->target) = 1;
  EXPECT_EQ(fields.invalid(), "to_boundary is 1; it takes a number in (0, 1)");
}

}  // namespace
}  // namespace perp::contact
