// SPDX-License-Identifier: Apache-2.0
// The solvers of contact problems and what the encodings are made by, where a request for memory fails.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <sstream>

#include "contact/existence/existence.hpp"
#include "contact/existence/infeasible.hpp"
#include "contact/laws/frictionless.hpp"
#include "contact/laws/inner_faceting.hpp"
#include "contact/laws/outer_faceting.hpp"
#include "contact/scenes/generators.hpp"
#include "contact/solvers/solve.hpp"
#include "faults/harness.hpp"
#include "lcp/judge/judge.hpp"
#include "support/matrices.hpp"

namespace perp::faults {
namespace {

using contact::Options;
using contact::Problem;
using contact::Status;

Problem stack() { return contact::make_scene(contact::BoxStack{.boxes = 2}).problem(); }
Problem arch() { return contact::make_scene(contact::Arch{.voussoirs = 7}).problem(); }

/// A body squeezed between two walls that come nearer.
Problem squeezed() {
  return {.dimension = 2,
          .W = support::matrix({{1, 0, -1, 0}, {0, 1, 0, 1}, {-1, 0, 1, 0}, {0, 1, 0, 1}}),
          .q = support::vec({-1, 0, -1, 0}),
          .mu = support::vec({0.5, 0.5})};
}

std::string text_of(const contact::Result& result) {
  std::ostringstream all;
  all << to_string(result.status) << ": " << result.message << "; " << to_string(result.by) << ", "
      << result.stats.iterations << ", " << result.history.size() << "; " << std::hexfloat << result.residual.siconos
      << "; " << result.solution.r.transpose() << "; " << result.solution.u.transpose();
  return all.str();
}

bool whole(const Problem& problem, const contact::Result& result) {
  if (result.solution.r.size() != problem.q.size() || result.solution.u.size() != problem.q.size()) return false;
  const auto now = contact::residual(problem, result.solution.r);
  return now.siconos == result.residual.siconos && now.rr9118 == result.residual.rr9118;
}

/// What has not ended by itself within a minute is not told of: all limits are far.
Scenario solving(Problem problem, Options options) {
  options.max_time = std::chrono::hours(1);
  return [=, usual = std::optional<Status>()](long k) mutable {
    contact::Result result;
    Outcome outcome;
    outcome.out_of_memory = !attempt(k, [&] { result = contact::solve(problem, options); });
    outcome.all = text_of(result);
    if (outcome.out_of_memory) return outcome;
    if (!usual) usual = result.status;
    outcome.out_of_memory = result.status == Status::OutOfMemory;
    outcome.right = result.status == *usual && (!result.solved() || accepted(result.residual, options.tol)) &&
                    (result.status != Status::Infeasible || proves_infeasible(problem, result.verdict.certificate));
    if (!whole(problem, result)) outcome = {false, false, "point and residual differ: " + outcome.all};
    return outcome;
  };
}

TEST(ContactFaults, Auto) {
  every_request_fails_once("contact auto, stack", solving(stack(), {}));
  every_request_fails_once("contact auto, arch", solving(arch(), {}));
}

TEST(ContactFaults, AutoWithoutSweeps) {
  every_request_fails_once("contact auto without sweeps, arch",
                           solving(arch(), {.method = contact::Auto{.sweeps = 0}}));
}

TEST(ContactFaults, Homotopy) {
  every_request_fails_once("contact homotopy, stack", solving(stack(), {.method = contact::GlockerHomotopy{}}));
}

TEST(ContactFaults, GlockerNcp) {
  every_request_fails_once("contact ncp, stack", solving(stack(), {.method = contact::GlockerNcp{}}));
}

TEST(ContactFaults, Infeasible) { every_request_fails_once("contact auto, infeasible", solving(squeezed(), {})); }

template <class Make>
Scenario encoding(Make make) {
  return [=](long k) {
    contact::EncodingResult result;
    contact::Solution solution;
    std::optional<lcp::AffineMcp> affine;
    Outcome outcome;
    outcome.out_of_memory = !attempt(k, [&] {
      const auto encoding = make();
      result = contact::solve(encoding);
      solution = encoding.recover(result.z);
    });
    std::ostringstream all;
    all << to_string(result.status) << ": " << result.message << "; " << result.by << std::hexfloat << "; "
        << result.residual << "; " << solution.r.transpose();
    outcome.all = all.str();
    if (outcome.out_of_memory) return outcome;
    outcome.out_of_memory = result.status == lcp::Status::OutOfMemory;
    outcome.right = result.accepted() && lcp::judge(make().affine(), result.z).natural == result.residual;
    return outcome;
  };
}

TEST(ContactFaults, Encodings) {
  const auto polygons = contact::Polygons{contact::Polygon::inscribed(5)};
  const auto outside = contact::Polygons{contact::Polygon::circumscribed(5)};
  every_request_fails_once("inner faceting, stack",
                           encoding([=] { return contact::InnerFaceting(stack(), polygons); }));
  every_request_fails_once("inner faceting, mixed, stack", encoding([=] {
                             return contact::InnerFaceting(stack(), polygons, {.form = contact::Form::Mixed});
                           }));
  every_request_fails_once("outer faceting, stack", encoding([=] { return contact::OuterFaceting(stack(), outside); }));
  every_request_fails_once("outer faceting, mixed, stack", encoding([=] {
                             return contact::OuterFaceting(stack(), outside, {.form = contact::Form::Mixed});
                           }));
  every_request_fails_once("frictionless, arch", encoding([=] { return contact::Frictionless(arch()); }));
}

TEST(ContactFaults, Scenes) {
  for (const char* name : {"stack", "spheres", "arch", "chain", "wall", "incline"})
    every_request_fails_once(std::string("scene ") + name, [=](long k) {
      Problem problem;
      Outcome outcome;
      outcome.out_of_memory = !attempt(k, [&] { problem = contact::make_scene(name, 12).problem(); });
      std::ostringstream all;
      all << std::hexfloat << lcp::SpMat(problem.W.matrix()) << problem.q.transpose() << problem.mu.transpose();
      outcome.all = all.str();
      static std::string usual;
      static std::string of;
      if (of != name) usual = outcome.all;
      of = name;
      outcome.right = !outcome.out_of_memory && outcome.all == usual;
      return outcome;
    });
}

TEST(ContactFaults, Existence) {
  every_request_fails_once("existence, stack", [](long k) {
    static const Problem problem = stack();
    contact::Verdict verdict;
    Outcome outcome;
    outcome.out_of_memory =
        !attempt(k, [&] { verdict = contact::existence(problem, {.max_time = std::chrono::hours(1)}); });
    outcome.all = std::string(to_string(verdict.existence)) + ": " + verdict.message;
    outcome.right = !outcome.out_of_memory && verdict.existence == contact::Existence::Exists;
    return outcome;
  });
}

}  // namespace
}  // namespace perp::faults
