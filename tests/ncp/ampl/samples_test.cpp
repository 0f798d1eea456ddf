// SPDX-License-Identifier: Apache-2.0
// The samples: hand-written, by AMPL, by Pyomo, text and binary. Would catch a reader that refuses what real writers
// write, or that reads the binary form differently.
#include <set>

#include "nl_text.hpp"

namespace perp::ncp::ampl {
namespace {

std::string base(const std::string& path) {
  const std::string file = path.substr(path.find_last_of('/') + 1);
  return file.substr(0, file.size() - 3);
}

TEST(Samples, LoadOrAreRefusedForWhatTheyAre) {
  if (samples().empty()) GTEST_SKIP() << "no samples beside the repository";
  const std::set<std::string> nonsquare_ones = {"pyomo-cov1", "pyomo-cov4", "pyomo-t11", "pyomo-t12", "pyomo-t1a",
                                                "pyomo-t2a",  "pyomo-t2b",  "pyomo-t3a", "pyomo-t4a"};
  int loaded = 0;
  for (const std::string& path : samples()) {
    SCOPED_TRACE(path);
    try {
      const auto model = read_model(path);
      ++loaded;
      EXPECT_EQ(model->name(), base(path));
      EXPECT_FALSE(model->box().invalid());
      const Vec x = model->start().array() + 0.3;
      EXPECT_EQ(describe(*model, check_jacobian(*model, x)), "");
      values(*model, x);
    } catch (const ModelError& e) {
      EXPECT_THAT(e.what(), testing::StartsWith(path));
      EXPECT_EQ(e.code(), nonsquare_ones.contains(base(path)) ? nonsquare : bad_file) << e.what();
      EXPECT_TRUE(nonsquare_ones.contains(base(path)) || base(path).starts_with("malformed")) << e.what();
    }
  }
  EXPECT_EQ(loaded, 13);
}

TEST(Samples, MalformedOnesNameTheLine) {
  for (const std::string& path : samples()) {
    if (!base(path).starts_with("malformed")) continue;
    try {
      read_model(path);
      FAIL() << path;
    } catch (const ModelError& e) {
      EXPECT_EQ(e.code(), bad_file);
      EXPECT_THAT(e.what(), testing::ContainsRegex("malformed-t[0-9ab]*.nl:[0-9]+: "));
    }
  }
}

// josephy-ampl.nl against the formulas of Josephy (1979) written out; F(1, 0, 3, 0) of the known solution family.
TEST(Samples, JosephyValues) {
  if (samples().empty()) GTEST_SKIP() << "no samples beside the repository";
  for (const char* name : {"josephy-ampl", "josephy_b"}) {
    for (const std::string& path : samples()) {
      if (base(path) != name) continue;
      const auto model = read_model(path);
      const Vec x{{0.5, -1, 2, 3}};
      const double a = x[0], b = x[1], c = x[2], d = x[3];
      const Vec expected{{3 * a * a + 2 * a * b + 2 * b * b + c + 3 * d - 6, 2 * a * a + a + b * b + 3 * c + 2 * d - 2,
                          3 * a * a + a * b + 2 * b * b + 2 * c + 3 * d - 1, a * a + 3 * b * b + 2 * c + 3 * d - 3}};
      EXPECT_THAT((values(*model, x) - expected).lpNorm<Eigen::Infinity>(), testing::Le(1e-14)) << path;
    }
  }
}

TEST(Samples, BinaryTwinsAreIdentical) {
  int pairs = 0;
  for (const std::string& path : samples()) {
    const std::string twin = path.substr(0, path.size() - 3) + "_b.nl";
    const auto all = samples();
    if (std::find(all.begin(), all.end(), twin) == all.end()) continue;
    ++pairs;
    const auto a = read_model(path), b = read_model(twin);
    ASSERT_EQ(a->size(), b->size());
    const Vec x = a->start().array() + 0.25;
    EXPECT_EQ(values(*a, x), values(*b, x));
    EXPECT_EQ(jacobian(*a, x), jacobian(*b, x));
    EXPECT_EQ(a->box().lower, b->box().lower);
    EXPECT_EQ(a->box().upper, b->box().upper);
    EXPECT_EQ(a->start(), b->start());
  }
  if (pairs == 0) GTEST_SKIP() << "no samples beside the repository";
}

}  // namespace
}  // namespace perp::ncp::ampl
