// SPDX-License-Identifier: Apache-2.0
/// Contact problems without a solution through every formulation, encoding and method of `perp contact`: nothing is
/// solved, what is refused is refused with a certificate that holds in rationals. Source: issue 16; the problems are
/// those of tests/contact/existence/unsolvable.hpp. PERP_UNSOLVABLE=2000 runs so many.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <numbers>

#include "app/contact/run/report.hpp"
#include "app/contact/run/run.hpp"
#include "app/json.hpp"
#include "app/options/methods.hpp"
#include "contact/existence/exact_certificate.hpp"
#include "contact/existence/unsolvable.hpp"

namespace perp::app::contacts {
namespace {

using contact::Problem;
using contact::test::make_unsolvable;
using support::Random;
using support::vec;
using test::Json;
using test::parse_json;
using testing::HasSubstr;

int asked(int by_default) {
  const char* said = std::getenv("PERP_UNSOLVABLE");
  return said != nullptr ? std::atoi(said) : by_default;
}

/// All that `perp contact` takes: every formulation by every method in every form, but for what it refuses.
std::vector<Variant> all_variants() {
  std::vector<Variant> all;
  for (const std::string_view method : method_names())
    for (const char* law : {"glocker", "ncp1", "inner:6", "outer:6", "frictionless"})
      for (const char* form : {"", "/A", "/B", "/A/original", "/B/original", "/reduced", "/mixed"}) try {
          std::string text = law;
          text += '+';
          text += method;
          text += form;
          const Variant variant = parse_variant(text);
          const auto same = [&](const Variant& other) { return other.label() == variant.label(); };
          if (std::ranges::none_of(all, same)) all.push_back(variant);
        } catch (const InputError&) {
        }
  return all;
}

/// The law's own problem, as rationals can judge it: a mu that holds all its impulses.
Problem enclosing(Problem problem, const Variant& variant) {
  if (variant.law == Variant::Law::Frictionless) problem.mu.setZero();
  if (variant.law == Variant::Law::Outer && problem.dimension == 3)
    problem.mu *= (1 + 2e-15) / std::cos(std::numbers::pi / variant.facets);
  return problem;
}

void check_claims(const Problem& problem, const contact::Vec& planted, const Run& run) {
  const std::string what = problem.name + " by " + run.variant.label() + ": " + run.message;
  const Problem own = enclosing(problem, run.variant);
  if (contact::test::exactly_infeasible(own, planted)) {
    EXPECT_FALSE(run.solved) << what << ", largest impulse " << run.solution.r.lpNorm<Eigen::Infinity>();
  }
  EXPECT_NE(run.verdict.existence, contact::Existence::Exists) << what;
  if (run.verdict.existence != contact::Existence::None) return;
  EXPECT_EQ(run.status, Status::Infeasible) << what;
  if (run.verdict.certificate.size() == 0) {  // the proof of a method for affine problems, in its own unknowns
    EXPECT_FALSE(run.variant.exact()) << what;
    return;
  }
  const double radius = contact::test::exact_radius(own, run.verdict.certificate);
  EXPECT_GE(radius, run.verdict.radius) << what;
}

// Every variant in turn, some for each problem. Catches a method that calls an unsolvable problem solved, a certificate
// of one law that is claimed for a wider one.
TEST(ContactUnsolvable, ByEveryVariant) {
  const std::vector<Variant> variants = all_variants();
  ASSERT_GT(variants.size(), 100u);
  Random random(31);
  const int problems = asked(120);
  const std::size_t each = problems >= 2000 ? 4 : 2;
  std::map<std::string, int> ended;
  std::size_t next = 0;
  for (int k = 0; k < problems; ++k) {
    const auto [problem, planted, family] = make_unsolvable(k, random);
    for (std::size_t i = 0; i < each; ++i) {
      const Variant& variant = variants[next++ % variants.size()];
      const contacts::Run run = contacts::run(problem, variant, {.seconds = 0.2});
      check_claims(problem, planted, run);
      ++ended[std::string(to_string(run.status))];
    }
  }
  EXPECT_GE(ended["Infeasible"], 0.9 * static_cast<double>(each) * problems) << testing::PrintToString(ended);
}

// What a user and a program read of a body between two walls. Catches an advice that leads nowhere, a radius that is no
// JSON.
TEST(ContactUnsolvable, TextAndJson) {
  Problem problem{.dimension = 2, .W = {}, .q = vec({-1, 0, 0.5, 0}), .mu = vec({0.3, 0.3})};
  problem.W = support::matrix({{1, 0, -1, 0}, {0, 1, 0, 1}, {-1, 0, 1, 0}, {0, 1, 0, 1}});
  const Loaded loaded{"squeezed", problem};
  for (const char* label : {"glocker", "glocker+path/B", "ncp1", "inner:8", "outer:8", "frictionless"}) {
    const contacts::Run run = contacts::run(problem, parse_variant(std::string(label)), {.seconds = 5});
    EXPECT_EQ(run.status, Status::Infeasible) << label;
    std::ostringstream text;
    print_verdict(text, problem, run);
    std::string words = text.str();
    std::ranges::replace(words, '\n', ' ');
    EXPECT_THAT(words, HasSubstr("no solution exists")) << label;
    EXPECT_THAT(words, HasSubstr("contacts 1 and 2")) << label;
    EXPECT_THAT(words, testing::Not(HasSubstr("--tol"))) << label;
    const Json json = parse_json(run_json(loaded, run, exit_unsolved));
    EXPECT_EQ(json["status"], "Infeasible");
    EXPECT_EQ(json["existence"], "none");
    EXPECT_EQ(json["certificate"], Json({1, 1}));
    EXPECT_EQ(json["radius"], "inf");
    EXPECT_TRUE(json["witness"].is_null());
  }
  problem.q[2] = 2;
  const contacts::Run solved = contacts::run(problem, parse_variant(std::string("glocker")), {});
  const Json json = parse_json(run_json(loaded, solved, exit_solved));
  for (const char* key : {"existence", "certificate", "radius", "witness", "witness_velocities"})
    EXPECT_TRUE(json.at(key).is_null()) << key;
}

}  // namespace
}  // namespace perp::app::contacts
