// SPDX-License-Identifier: Apache-2.0
#include "ncp/strategy/solve.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <stdexcept>
#include <utility>

#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::Counting;
using support::Dense;
using support::methods;
using support::methods_without_escape;
using support::nan;
using support::Random;
using support::vec;
using testing::AllOf;
using testing::HasSubstr;
using testing::Optional;
using testing::ThrowsMessage;

TEST(Methods, HaveNamesAndOneStop) {
  EXPECT_EQ(name(SemismoothNewton{}), "semismooth");
  EXPECT_EQ(name(NewtonJosephy{}), "josephy");
  for (auto& [label, method] : methods()) {
    EXPECT_EQ(invalid(method), std::nullopt) << label;
    stop(method).tol = 3e-5;
    EXPECT_EQ(stop(std::as_const(method)).tol, 3e-5) << label;
  }
}

/// Why a method with these options is none.
template <class M, class Change>
std::optional<std::string> why(Change change) {
  M method;
  change(method);
  return invalid(method);
}

template <class M>
void expect_stop_and_search_checked() {
  const auto names = [](const char* option, const char* value) {
    return Optional(AllOf(HasSubstr(option), HasSubstr(value)));
  };
  EXPECT_THAT(why<M>([](M& m) { m.stop.tol = -1.5; }), names("convergence_tolerance", "-1.5"));
  EXPECT_THAT(why<M>([](M& m) { m.stop.tol = 0; }), names("convergence_tolerance", "0"));
  EXPECT_THAT(why<M>([](M& m) { m.stop.tol = nan; }), names("convergence_tolerance", "nan"));
  EXPECT_THAT(why<M>([](M& m) { m.stop.tol = infinity; }), names("convergence_tolerance", "inf"));
  EXPECT_THAT(why<M>([](M& m) { m.stop.max_iterations = -3; }), names("major_iteration_limit", "-3"));
  EXPECT_THAT(why<M>([](M& m) { m.stop.max_time = std::chrono::duration<double>(-2.5); }), names("time_limit", "-2.5"));
  EXPECT_THAT(why<M>([](M& m) { m.stop.max_time = std::chrono::duration<double>(nan); }), names("time_limit", "nan"));
  EXPECT_THAT(why<M>([](M& m) { m.search.sigma = 1.25; }), names("sigma", "1.25"));
  EXPECT_THAT(why<M>([](M& m) { m.search.beta = 0; }), names("beta", "0"));
  EXPECT_THAT(why<M>([](M& m) { m.search.beta = 1; }), names("beta", "1"));
  EXPECT_THAT(why<M>([](M& m) { m.search.max_backtracks = -7; }), names("max_backtracks", "-7"));
  EXPECT_THAT(why<M>([](M& m) { m.search.memory = 0; }), names("nms_memory_size", "0"));
  EXPECT_THAT(invalid(escaping(M{}, {.rounds = -4})), names("escape_rounds", "-4"));
  EXPECT_THAT(invalid(escaping(M{}, {.lambda = -0.5})), names("escape_lambda", "-0.5"));
  EXPECT_THAT(invalid(escaping(M{}, {.lambda = nan})), names("escape_lambda", "nan"));
  EXPECT_THAT(invalid(escaping(M{}, {.lambda = infinity})), names("escape_lambda", "inf"));
}

// Every option by its name and value. Catches an option that is not looked at: a beta of 1 would loop, a NaN compares
// false with everything.
TEST(Invalid, NamesTheOptionAndItsValue) {
  expect_stop_and_search_checked<SemismoothNewton>();
  expect_stop_and_search_checked<NewtonJosephy>();
  using S = SemismoothNewton;
  EXPECT_THAT(why<S>([](S& m) { m.cfunction.at = nullptr; }), Optional(HasSubstr("cfunction")));
  using J = NewtonJosephy;
  EXPECT_THAT(why<J>([](J& m) { m.lemke.max_pivots = -1; }), Optional(HasSubstr("minor_iteration_limit is -1")));
  EXPECT_THAT(why<J>([](J& m) { m.lemke.residual_tol = 0; }), Optional(HasSubstr("lemke.residual_tol is 0")));
  EXPECT_THAT(why<J>([](J& m) { m.lemke.pivot_tol = 1; }), Optional(HasSubstr("pivot_tolerance is 1")));
  EXPECT_THAT(why<J>([](J& m) { m.lemke.feasibility_tol = nan; }), Optional(HasSubstr("lemke.feasibility_tol is nan")));
  EXPECT_THAT(why<J>([](J& m) { m.lemke.perturbation = -1e-5; }), Optional(HasSubstr("lemke_perturbation is -1e-05")));
  EXPECT_THAT(why<J>([](J& m) { m.lemke.residual_tol = infinity; }), Optional(HasSubstr("lemke.residual_tol is inf")));
  EXPECT_THAT(why<J>([](J& m) { m.lemke.singular_rcond = nan; }), Optional(HasSubstr("lemke.singular_rcond is nan")));
  EXPECT_THAT(why<J>([](J& m) { m.lemke.basis.refactor_every = 0; }), Optional(HasSubstr("refactor_every is 0")));
  EXPECT_THAT(why<J>([](J& m) { m.lemke.basis.fill_limit = 0; }), Optional(HasSubstr("lemke.basis.fill_limit is 0")));
  EXPECT_THAT(why<J>([](J& m) { m.lemke.basis.unstable_tol = -1; }),
              Optional(HasSubstr("lemke.basis.unstable_tol is -1")));
  EXPECT_THAT(why<J>([](J& m) { m.lemke.basis.singular_tol = 2; }),
              Optional(HasSubstr("lemke.basis.singular_tol is 2")));
}

auto solving(const Mcp& mcp, const Vec& x0, const Method& method) {
  return [&mcp, x0, method] { solve(mcp, x0, method); };
}

TEST(Solve, RefusesOptionsAndInputAtTheDoor) {
  const auto mcp = make_mcp(support::kojima_shindo());
  const Counting counted(*mcp);
  const NewtonJosephy bad{.search = {.beta = 2}};
  EXPECT_THAT(solving(counted, Vec::Zero(4), bad),
              ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr("josephy"), HasSubstr(": beta is 2"))));
  for (const auto& [label, method] : methods()) {
    EXPECT_THAT(solving(counted, Vec::Zero(3), method),
                ThrowsMessage<std::invalid_argument>(HasSubstr("3 entries for 4 variables")));
    EXPECT_THAT(solving(counted, vec({0, nan, 0, 0}), method), ThrowsMessage<std::invalid_argument>(HasSubstr("x[2]")));
  }
  EXPECT_EQ(counted.F_evals, 0);
}

/// J of a problem of support::dense with one entry multiplied.
Functions with_wrong_entry(Functions functions, Index i, Index j, double factor) {
  functions.J = [J = std::move(functions.J), i, j, factor](In x, SpMat& out) {
    const bool defined = J(x, out);
    out.coeffRef(i, j) *= factor;
    return defined;
  };
  functions.variable_names = {"wheat", "rye", "oats", "barley"};
  functions.equation_names = {"market", "budget", "labour", "land"};
  return functions;
}

// Stop::check_derivatives compares at the (projected) start. F is not defined below
// 0 here, so that only one side can be compared. Catches a check that is not made, or made elsewhere.
TEST(Solve, RefusesAWrongJacobianIfAsked) {
  const auto right = make_mcp(support::kojima_shindo());
  Functions functions = with_wrong_entry(support::kojima_shindo(), 2, 3, -1);
  functions.F = [F = functions.F](In x, Out out) { return x.minCoeff() >= 0 && F(x, out); };
  const auto wrong = make_mcp(std::move(functions));
  for (const auto& [label, method] : methods({.check_derivatives = true})) {
    EXPECT_TRUE(solve(*right, Vec::Ones(4), method).solved()) << label;
    EXPECT_THAT(solving(*wrong, -Vec::Ones(4), method),
                ThrowsMessage<std::invalid_argument>(
                    AllOf(HasSubstr("kojima-shindo"), HasSubstr("labour"), HasSubstr("barley"), HasSubstr("-9"))));
  }
}

// Without it, a failure's message names the entry. Catches "no progress" as the only answer to the most frequent
// mistake.
TEST(Solve, FailuresNameAWrongDerivative) {
  const auto wrong = make_mcp(with_wrong_entry(support::kojima_shindo(), 0, 0, -1));
  for (const auto& [label, method] : methods({.max_iterations = 100})) {
    const Result result = solve(*wrong, Vec::Ones(4), method);
    ASSERT_FALSE(result.solved()) << label;
    EXPECT_THAT(result.message, AllOf(HasSubstr("derivative of equation market"), HasSubstr("variable wheat")))
        << label << ": " << result;
    EXPECT_THAT(result.advice, HasSubstr("Jacobian"));
  }
  const auto right = make_mcp(support::billups());  // a failure whose J is right is not blamed on it
  for (const auto& [label, method] : methods_without_escape())
    EXPECT_THAT(solve(*right, vec({0}), method).message, testing::Not(HasSubstr("derivative"))) << label;
}

// A J with other entries than its pattern makes the symbolic factorization that is kept that of another matrix. At the
// first call, or at a later one.
TEST(Solve, RefusesAJacobianThatLeavesItsPattern) {
  const SpMat tri = support::tridiagonal(4, -1, 4, -1);
  const auto changed = [&](int first, std::function<void(SpMat&)> change) {
    Functions functions = support::affine({.M = tri, .q = vec({-1, -5, 3, -2}), .box = Box::nonnegative(4)});
    functions.F = [tri](In x, Out F) {  // not affine: every method evaluates J more than once
      F = tri * x + vec({-1, -5, 3, -2}) + 0.1 * x.array().cube().matrix();
      return true;
    };
    functions.J = [tri, first, change = std::move(change), calls = 0](In x, SpMat& J) mutable {
      J = tri;
      J.diagonal().array() += 0.3 * x.array().square();
      if (++calls >= first) change(J);
      return true;
    };
    functions.variable_names = {"a", "b", "c", "d"};
    functions.equation_names = {"A", "B", "C", "D"};
    return functions;
  };
  for (const auto& each : methods())
    for (const int first : {1, 2}) {
      const auto refusal = [&](const std::function<void(SpMat&)>& change) {
        return [&, change] { solve(*make_mcp(changed(first, change)), Vec::Ones(4), each.method); };
      };
      EXPECT_NO_THROW(refusal([](SpMat&) {})()) << each.name;
      EXPECT_THAT(refusal([](SpMat& J) { J.coeffRef(3, 0) = 1; }),
                  ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr("equation D"), HasSubstr("variable a"))))
          << each.name;
      EXPECT_THAT(refusal([](SpMat& J) { J.prune([](Index i, Index j, double) { return i != 1 || j != 2; }); }),
                  ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr("equation B"), HasSubstr("variable c"))))
          << each.name;
      EXPECT_THAT(refusal([](SpMat& J) { J.uncompress(); }),
                  ThrowsMessage<std::invalid_argument>(HasSubstr("not compressed")))
          << each.name;
      EXPECT_THAT(refusal([](SpMat& J) { J = SpMat(5, 4); }), ThrowsMessage<std::invalid_argument>(HasSubstr("5 x 4")))
          << each.name;
    }
  EXPECT_THAT(
      [&] {
        solve(*make_mcp(changed(1, [](SpMat& J) { J = dense_pattern(7); })), Vec::Ones(4),
              NewtonJosephy{.stop = {.check_derivatives = true}});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("7 x 7")));
}

// Whatever throws in F or J comes out as it is, at any call, and the problem is solved afterwards. Catches exceptions
// that are swallowed or leave state behind; under the address sanitizer, leaks.
TEST(Solve, ExceptionsOfTheProblemPropagate) {
  struct Unplugged : std::runtime_error {
    using runtime_error::runtime_error;
  };
  for (const auto& [label, method] : methods())
    for (const bool in_J : {false, true})
      for (int last = 1; last < 12; last += 3) {
        int calls = 0;
        bool armed = true;
        Functions functions = support::kojima_shindo();
        const auto tick = [&calls, &armed, last](bool here) {
          if (armed && here && ++calls >= last) throw Unplugged("the model is gone");
        };
        functions.F = [F = functions.F, tick, in_J](In x, Out out) { return tick(!in_J), F(x, out); };
        functions.J = [J = functions.J, tick, in_J](In x, SpMat& out) { return tick(in_J), J(x, out); };
        const auto mcp = make_mcp(std::move(functions));
        EXPECT_THROW(while (true) solve(*mcp, Vec::Constant(4, 100), method), Unplugged) << label;
        armed = false;
        EXPECT_TRUE(solve(*mcp, Vec::Constant(4, 100), method).solved()) << label;
      }
  const auto mcp = make_mcp(support::kojima_shindo());
  const Observer throwing = [](const Iteration& it) -> Next {
    if (it.k == 2) throw Unplugged("the screen is gone");
    return Next::Continue;
  };
  for (const auto& [label, method] : methods()) EXPECT_THROW(solve(*mcp, Vec::Zero(4), method, throwing), Unplugged);
}

/// What Result promises, whatever the status.
void expect_consistent(const Mcp& mcp, const Result& result, double tol, const std::string& what) {
  EXPECT_EQ(result.x, lcp::project(mcp.box(), result.x)) << what;
  Vec F(result.x.size());
  const bool defined = mcp.eval(result.x, F) && F.allFinite();
  if (defined) {
    EXPECT_EQ(result.F, F) << what;
    EXPECT_NEAR(result.residual.natural, support::violation(mcp.box(), result.x, F), 1e-15) << what;
  }
  EXPECT_EQ(result.solved(), defined && support::violation(mcp, result.x) <= tol) << what << ": " << result;
  EXPECT_EQ(result.solved(), result.advice.empty()) << what;
  EXPECT_FALSE(result.message.empty()) << what;
}

// The answer in the box, F at the answer, and Solved exactly where the tolerance is met, after any number of
// iterations. Catches an answer outside the box, an F of another point, and a run that holds a solution and does not
// say so: an iterate outside the box whose projection is one.
TEST(Solve, AnswersAreConsistentAfterEveryIteration) {
  Random random(1);
  for (int k = 0; k < 12; ++k) {
    const Box box = support::mixed_box(5, random);
    const Dense M = Dense(support::p_matrix(5, 2, random));
    const Vec q = random.normals(5);
    const auto mcp = make_mcp(support::dense(
        "cubic", box, [=](const Vec& x) { return Vec(M * x + q + x.array().cube().matrix()); },
        [=](const Vec& x) { return Dense(M + Dense((3 * x.array().square()).matrix().asDiagonal())); }));
    const Vec x0 = 3 * random.normals(5);
    for (int iterations = 0; iterations < 15; ++iterations)
      for (const auto& [label, method] : methods({.tol = 1e-6, .max_iterations = iterations})) {
        const Result result = solve(*mcp, x0, method);
        expect_consistent(*mcp, result, 1e-6, label);
        EXPECT_LE(result.stats.iterations, iterations) << label;
      }
  }
}

// One variable that goes to its bound from inside: Newton's iterates overstep it. Catches the same as above where it is
// sure to happen.
TEST(Solve, AProjectionThatSolvesIsSeen) {
  const auto mcp = make_mcp(support::scalar(
      0, infinity, [](double x) { return 1 + x * x * x; }, [](double x) { return 3 * x * x; }));
  for (int iterations = 0; iterations < 12; ++iterations)
    for (const auto& [label, method] : methods({.max_iterations = iterations}))
      expect_consistent(*mcp, solve(*mcp, vec({3}), method), 1e-8, label + " " + std::to_string(iterations));
}

// ncp/run/observe.hpp: `residual` and `worst` are those of the iterate projected onto the box; F_evals and J_evals
// those so far. The answer is no worse than any of them.
TEST(Solve, RecordsAreOfTheProjectedIterates) {
  const auto mcp = make_mcp(support::kojima_shindo());
  const Counting counted(*mcp);
  for (const auto& [label, method] : methods())
    for (const Vec& x0 : support::kojima_shindo_starts()) {
      counted.F_evals = counted.J_evals = 0;
      double best = infinity;
      int k = 0;
      const Result result = solve(counted, x0, method, [&, &label = label](const Iteration& it) {
        EXPECT_EQ(it.k, it.kind == 'C' ? k - 1 : k++);  // steps of a crash are no major iterations
        EXPECT_NEAR(it.residual, residual(*mcp, lcp::project(mcp->box(), *it.x)).natural, 1e-14) << label;
        EXPECT_EQ(it.F_evals, counted.F_evals) << label;
        EXPECT_EQ(it.J_evals, counted.J_evals) << label;
        EXPECT_GE(it.worst, 0);
        best = std::min(best, it.residual);
        return Next::Continue;
      });
      // A solution may have moved to its bounds, within the tolerance.
      EXPECT_LE(result.residual.natural, result.solved() ? std::max(best, stop(method).tol) : best) << label;
      EXPECT_EQ(result.stats.iterations + 1, k) << label;
    }
}

// Against a problem that counts. Catches evaluations past the counter, so that two methods are compared by figures of
// different things. With escapes: billups from its local minimum.
TEST(Solve, CountsEveryEvaluation) {
  const auto expect_counted = [](const Mcp& mcp, const Vec& x0, const Method& method, const std::string& label) {
    const Counting counted(mcp);
    Result result = solve(counted, x0, method);
    EXPECT_TRUE(result.solved()) << label << ": " << result;
    EXPECT_EQ(result.stats.F_evals, counted.F_evals) << label;
    EXPECT_EQ(result.stats.J_evals + 1, counted.J_evals) << label << ": all but the one for Result::relative";
    EXPECT_GE(result.stats.time.count(), 0);
    return result;
  };
  const auto kojima = make_mcp(support::kojima_shindo());
  const auto billups = make_mcp(support::billups());
  for (const auto& [label, method] : methods()) {
    for (const Vec& x0 : support::kojima_shindo_starts()) {
      const Result result = expect_counted(*kojima, x0, method, label);
      EXPECT_GE(result.stats.factorizations, 1) << label;
      // A crash may leave none to path.
      EXPECT_TRUE(label == "path" || (result.stats.pivots > 0) == (label == "josephy")) << label;
    }
    EXPECT_THAT(expect_counted(*billups, vec({0}), method, label).message, HasSubstr("escape")) << label;
  }
}

// An F that answers 0 at every second call. Two calls have to agree before a point is called solved: the method's, and
// the judge's, which follow one another where no chord step is tried in between. Catches a verdict from the values the
// method holds.
TEST(Solve, IsNotDeceivedByAnFThatLies) {
  for (auto& [label, method] : methods({.max_iterations = 60})) {
    if (auto* path = std::get_if<PathSearch>(&method)) path->chord_steps = 0;
    for (int shift = 0; shift < 2; ++shift) {
      const auto truth = make_mcp(support::kojima_shindo());
      Functions lying = support::kojima_shindo();
      lying.F = [&truth, calls = shift](In x, Out F) mutable {
        if (++calls % 2 == 0) return truth->eval(x, F);
        F.setZero();
        return true;
      };
      for (const Vec& x0 : support::kojima_shindo_starts()) {
        const Result result = solve(*make_mcp(lying), x0, method);
        EXPECT_TRUE(!result.solved() || support::violation(*truth, result.x) <= 1e-8) << label << ": " << result;
      }
    }
  }
}

// ncp/run/result.hpp: one line. Catches a text that leaves out what a log needs.
TEST(Result, PrintsInOneLine) {
  const auto mcp = make_mcp(support::kojima_shindo());
  std::ostringstream out;
  out << solve(*mcp, Vec::Constant(4, 100), SemismoothNewton{.stop = {.max_iterations = 1}});
  EXPECT_THAT(out.str(), AllOf(HasSubstr("IterationLimit"), HasSubstr("natural residual"), HasSubstr("1 iterations"),
                               HasSubstr("worst in equation F["), testing::Not(HasSubstr("\n"))));
}

}  // namespace
}  // namespace perp::ncp
