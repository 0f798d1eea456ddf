// SPDX-License-Identifier: Apache-2.0
// Values, derivatives and points where there are none. Would catch a process that ends over log(-1), stale values
// after an error, and two models that disturb each other.
#include <atomic>
#include <cfenv>
#include <cmath>
#include <csignal>
#include <thread>

#include "ncp/interval/enclosure.hpp"
#include "ncp/strategy/solve.hpp"
#include "nl_text.hpp"

namespace perp::ncp::ampl {
namespace {

using std::isnan;

// F_i = op_i(x_i), all with free variables.
std::string diagonal(const std::vector<std::string>& operators) {
  const int n = static_cast<int>(operators.size());
  std::string s = text({.vars = n, .cons = n, .cc = n, .nonzeros = n});
  for (int i = 0; i < n; ++i)
    s.append("C").append(std::to_string(i)).append("\n").append(operators[static_cast<std::size_t>(i)]);
  s += "r\n";
  for (int i = 1; i <= n; ++i) s.append("5 0 ").append(std::to_string(i)).append("\n");
  s += "b\n";
  for (int i = 0; i < n; ++i) s += "3\n";
  s.append("k").append(std::to_string(n - 1)).append("\n");
  for (int i = 1; i < n; ++i) s += std::to_string(i) + "\n";
  for (int i = 0; i < n; ++i)
    s.append("J").append(std::to_string(i)).append(" 1\n").append(std::to_string(i)).append(" 0\n");
  return s;
}

// A model whose rows' expressions are constants is affine, whatever its header says (here: that all rows are
// nonlinear); one x_1^2 makes it none. Would catch methods for affine problems run on a linearization.
TEST(Evaluation, KnowsAffineModels) {
  EXPECT_TRUE(read_text(diagonal({"n3\n", "n-1\n"}))->is_affine());
  EXPECT_TRUE(read_text(diagonal({"o0\nn3\nn2\n", "n-1\n"}))->is_affine()) << "3 + 2";
  EXPECT_FALSE(read_text(diagonal({"n3\n", "o5\nv1\nn2\n"}))->is_affine());
  EXPECT_FALSE(read_text(diagonal({"n3\n", "v1\n"}))->is_affine()) << "linear, but written as an expression";
}

// The defined variables of the first rich model, by hand: v3 = 2a + b^2, v4 = v3 + sin c, F(b) = exp(v4) + v3 + a - 3,
// F(c) = v4 a + c, F(a) = 1.5 + a - b.
TEST(Evaluation, DefinedVariables) {
  for (const std::string& content : {rich_models()[0], binary_twin(rich_models()[0])}) {
    const auto m = read_text(content);
    EXPECT_EQ(m->start(), (Vec{{0.25, 0, -0.5}}));
    for (double a : {0.25, -0.5}) {
      const double b = 0.3, c = -0.7;
      const double v3 = 2 * a + b * b, v4 = v3 + std::sin(c);
      const Vec x{{a, b, c}};
      const Vec expected{{1.5 + a - b, std::exp(v4) + v3 + a - 3, v4 * a + c}};
      EXPECT_LE((values(*m, x) - expected).lpNorm<Eigen::Infinity>(), 1e-15);
      const double e = std::exp(v4);
      const Eigen::MatrixXd J{
          {1, -1, 0}, {2 * e + 3, 2 * b * (e + 1), e * std::cos(c)}, {2 * a + v4, 2 * b * a, a * std::cos(c) + 1}};
      EXPECT_LE((jacobian(*m, x) - J).lpNorm<Eigen::Infinity>(), 1e-15);
    }
  }
}

TEST(Evaluation, ConditionsListsAndSideInequalities) {
  for (const std::string& content : {rich_models()[1], binary_twin(rich_models()[1])}) {
    const auto m = read_text(content);
    ASSERT_EQ(m->size(), 2 + 3 + 2);
    Vec x(7);
    x << 1.25, 0.75, 0.1, 0.2, 0.3, 0.4, 0.5;
    const double C0 = 0.75 + 2.5 + 2 + 0, C1 = 1.25 * 1.25, C2 = 2 * 0.75 + 1 + 0.75 + 0;
    const Vec expected{{C0, C1 - 1, C2 + 1 - 0.1, 20 - C2 - 0.2, 7 - 1 - 0.3, 0.75 + 3 - 0.4, 3 - 0.75 - 0.5}};
    EXPECT_LE((values(*m, x) - expected).lpNorm<Eigen::Infinity>(), 1e-14);
    EXPECT_EQ(describe(*m, check_jacobian(*m, x)), "");
  }
}

TEST(Evaluation, UndefinedRowsAreNaNOrInfinite) {
  // sqrt(x0), log(x1), 1 / x2, exp(x3), asin(x4), x5^-0.5, x6
  const auto m = read_text(
      diagonal({"o39\nv0\n", "o43\nv1\n", "o3\nn1\nv2\n", "o44\nv3\n", "o51\nv4\n", "o5\nv5\nn-0.5\n", "v6\n"}));
  const Vec good{{4, 1, 2, 0, 0.5, 4, 3}};
  const Vec bad{{-1, 0, 0, 1000, 2, -1, std::nan("")}};
  const Vec at_good{{2, 0, 0.5, 1, std::asin(0.5), 0.5, 3}};
  Vec F(7);
  for (unsigned mask = 0; mask < 128; ++mask) {
    Vec x = good;
    for (int i = 0; i < 7; ++i)
      if (mask & (1U << i)) x[i] = bad[i];
    for (int repeat = 0; repeat < 2; ++repeat) {
      ASSERT_EQ(m->eval(x, F), mask == 0);
      for (int i = 0; i < 7; ++i) {
        ASSERT_EQ(!std::isfinite(F[i]), (mask & (1U << i)) != 0) << mask << ' ' << i;
        ASSERT_EQ(std::isinf(F[i]), i == 3 && x[3] == 1000) << mask << ": exp(1000) is too large, and nothing else is";
        if (std::isfinite(F[i])) {
          ASSERT_NEAR(F[i], at_good[i], 1e-15);
        }
      }
      SpMat J = m->jacobian_pattern();
      if (mask < 64) {  // (x6 itself has a derivative anywhere)
        ASSERT_EQ(m->jacobian(x, J), mask == 0) << mask;
      }
    }
  }
}

// Defined but not differentiable: sqrt at 0.
TEST(Evaluation, NoDerivative) {
  const auto m = read_text(diagonal({"v0\n", "o39\nv1\n"}));
  SpMat J = m->jacobian_pattern();
  Vec F(2);
  EXPECT_TRUE(m->eval(Vec{{1, 0}}, F));
  EXPECT_FALSE(m->jacobian(Vec{{1, 0}}, J));
  EXPECT_TRUE(m->jacobian(Vec{{1, 4}}, J));
  EXPECT_EQ(J.coeff(1, 1), 0.25);
  EXPECT_FALSE(m->jacobian(Vec{{1, 0}}, J));
}

// A header that calls no variable and no constraint nonlinear makes AMPL's library miss changes of x and read past
// the end of its records of derivative errors.
TEST(Evaluation, HeaderThatCallsNothingNonlinear) {
  std::string s = diagonal({"v0\n", "o39\nv1\n"});
  const auto replace = [&](const std::string& from, const std::string& to) {
    s.replace(s.find(from), from.size(), to);
  };
  replace("\n 2 0 0 2 0 0\t", "\n 0 0 2 0 0 0\t");
  replace("\n 2 0 0\t# nonlinear vars", "\n 0 0 0\t# nonlinear vars");
  const auto m = read_text(s);
  EXPECT_EQ(values(*m, Vec{{1, 4}}), (Vec{{1, 2}}));
  EXPECT_EQ(values(*m, Vec{{1, 9}}), (Vec{{1, 3}}));
  SpMat J = m->jacobian_pattern();
  EXPECT_FALSE(m->jacobian(Vec{{1, 0}}, J));
  EXPECT_TRUE(m->jacobian(Vec{{1, 4}}, J));
}

// A defined variable without a value: the rows that use it, however indirectly, are named, at every call. The library
// by itself would use the defined variables of the last point at the second.
TEST(Evaluation, UndefinedDefinedVariable) {
  // v3 = log(x0), v4 = v3 + 1; F0 = v4, F1 = x1, F2 = v3 x2.
  for (int shared : {0, 1}) {  // by objectives too, or by constraints only
    const auto m =
        read_text(text({.vars = 3, .cons = 3, .cc = 3, .nonzeros = 4, .both = 2 * shared, .con = 2 - 2 * shared}) +
                  "V3 0 0\no43\nv0\nV4 0 0\no0\nv3\nn1\nC0\nv4\nC1\nv1\nC2\no2\nv3\nv2\nr\n5 0 1\n5 0 2\n5 0 3\n"
                  "b\n3\n3\n3\nk2\n2\n3\nJ0 1\n0 0\nJ1 1\n1 0\nJ2 2\n0 0\n2 0\n");
    Vec F(3);
    SpMat J = m->jacobian_pattern();
    EXPECT_TRUE(m->eval(Vec{{1, 2, 3}}, F));
    for (int repeat = 0; repeat < 3; ++repeat) {
      EXPECT_FALSE(m->jacobian(Vec{{-1, 2, 3}}, J));
      EXPECT_FALSE(m->eval(Vec{{-1, 2, 3}}, F));
      EXPECT_TRUE(isnan(F[0]) && !isnan(F[1]) && isnan(F[2]));
    }
    EXPECT_TRUE(m->eval(Vec{{1, 2, 3}}, F));
    EXPECT_EQ(F, (Vec{{1, 2, 0}}));
  }
}

// The same for defined variables of a single row, whose numbers the library counts differently.
TEST(Evaluation, UndefinedDefinedVariableOfOneRow) {
  // v2 = x0 (shared), v3 = x1 (shared), v4 = v2 + 1 (row 0), v5 = log(v3) (row 1); F0 = v4, F1 = v5.
  const auto m = read_text(text({.vars = 2, .cons = 2, .cc = 2, .nonzeros = 2, .con = 2, .con1 = 2}) +
                           "V2 0 0\nv0\nV3 0 0\nv1\nV4 0 1\no0\nv2\nn1\nC0\nv4\nV5 0 2\no43\nv3\nC1\nv5\n"
                           "r\n5 0 1\n5 0 2\nb\n3\n3\nk1\n1\nJ0 1\n0 0\nJ1 1\n1 0\n");
  Vec F(2);
  EXPECT_TRUE(m->eval(Vec{{1, 1}}, F));
  EXPECT_EQ(F, (Vec{{2, 0}}));
  EXPECT_FALSE(m->eval(Vec{{1, -1}}, F));
  EXPECT_FALSE(isnan(F[0]));
  EXPECT_TRUE(isnan(F[1]));
}

// A free row imposes nothing, not even that it has a value.
TEST(Evaluation, UndefinedFreeRow) {
  const auto m = read_text(text({.cons = 2, .eqns = 1, .nonzeros = 2}) +
                           "C0\no43\nv0\nC1\no5\nv0\nn2\nr\n3\n4 1\nb\n3\nk0\nJ0 1\n0 0\nJ1 1\n0 0\n");
  EXPECT_EQ(values(*m, Vec{{-2}}), (Vec{{3}}));
  EXPECT_EQ(jacobian(*m, Vec{{-2}}), (Eigen::MatrixXd{{-4}}));
}

TEST(Evaluation, OverflowIsUndefined) {
  const auto m = read_text(diagonal({"o2\nv0\no2\nv0\nv0\n", "v1\n"}));
  Vec F(2);
  EXPECT_FALSE(m->eval(Vec{{1e150, 1}}, F));
  EXPECT_EQ(F[0], infinity);
  EXPECT_EQ(F[1], 1);
  SpMat J = m->jacobian_pattern();
  EXPECT_FALSE(m->jacobian(Vec{{1e200, 1}}, J));
}

// An expression that is a single variable: the library has its value, but loses its derivative.
TEST(Evaluation, BareVariables) {
  // v2 = x1^2; F0 = x0 + 3 x0, F1 = v2.
  const std::string model = text({.vars = 2, .cons = 2, .cc = 2, .nonzeros = 2, .con = 1}) +
                            "V2 0 0\no5\nv1\nn2\nC0\nv0\nC1\nv2\nr\n5 0 1\n5 0 2\nb\n3\n3\nk1\n1\n"
                            "J0 1\n0 3\nJ1 1\n1 0\n";
  for (const std::string& content : {model, binary_twin(model)}) {
    const auto m = read_text(content);
    EXPECT_EQ(values(*m, Vec{{2, 5}}), (Vec{{8, 25}}));
    EXPECT_EQ(jacobian(*m, Vec{{2, 5}}), (Eigen::MatrixXd{{4, 0}, {0, 10}}));
  }
}

// A row without derivative after a definition of its own, which is not to lend it one; and linear terms beside a
// condition, which are not to lose theirs.
TEST(Evaluation, ExpressionsWithoutDerivative) {
  // v2 = 5 x0 + (if x0 < 1 then 2 else 3), v3 = x1^2 (row 0); F0 = 4 + 3 x0, F1 = v2.
  const std::string model = text({.vars = 2, .cons = 2, .cc = 2, .nonzeros = 3, .con = 1, .con1 = 1}) +
                            "V2 1 0\n0 5\no35\no22\nv0\nn1\nn2\nn3\nV3 0 1\no5\nv1\nn2\nC0\nn4\nC1\nv2\n"
                            "r\n5 0 1\n5 0 2\nb\n3\n3\nk1\n2\nJ0 2\n0 3\n1 0\nJ1 1\n0 0\n";
  for (const std::string& content : {model, binary_twin(model)}) {
    const auto m = read_text(content);
    EXPECT_EQ(values(*m, Vec{{0.5, 5}}), (Vec{{5.5, 4.5}}));
    EXPECT_EQ(jacobian(*m, Vec{{0.5, 5}}), (Eigen::MatrixXd{{3, 0}, {5, 0}}));
  }
}

// A sum of nothing but conditions: the library by itself crashes over its derivative.
TEST(Evaluation, SumOfConditions) {
  // v1 = (if x0 < 0 then 1 else 2) + max(3, 4) + 1 (shared), F0 = v1 + x0, objective = v1 likewise.
  const std::string sum = "o54\n3\no35\no22\nv0\nn0\nn1\nn2\no12\n2\nn3\nn4\nn1\n";
  const std::string model = text({.objs = 1, .cc = 1, .con = 1}) + "V1 0 0\no2\n" + sum + "n1\nC0\no0\nv1\n" + sum +
                            "O0 0\n" + sum + "r\n5 0 1\nb\n3\nk0\nJ0 1\n0 1\n";
  for (const std::string& content : {model, binary_twin(model)}) {
    const auto m = read_text(content);
    EXPECT_EQ(values(*m, Vec{{5}}), (Vec{{7 + 7 + 5}}));
    EXPECT_EQ(jacobian(*m, Vec{{5}}), (Eigen::MatrixXd{{1}}));
    EXPECT_EQ(values(*m, Vec{{-5}}), (Vec{{6 + 6 - 5}}));
  }
}

// log(2) is inexact and log(-1) invalid; a flag that the caller has raised stays. Catches an evaluation that keeps the
// rounding mode alone.
TEST(Evaluation, LeavesTheFlagsOfTheCaller) {
  const auto m = read_text(diagonal({"o43\nv0\n"}));
  Vec F(1);
  std::feclearexcept(FE_ALL_EXCEPT);
  EXPECT_TRUE(m->eval(Vec{{2}}, F));
  EXPECT_EQ(std::fetestexcept(FE_INEXACT), 0);
  std::feraiseexcept(FE_UNDERFLOW);
  EXPECT_FALSE(m->eval(Vec{{-1}}, F));
  EXPECT_NE(std::fetestexcept(FE_UNDERFLOW), 0);
  std::feclearexcept(FE_ALL_EXCEPT);
}

// Nothing of the caller's floating-point environment, signal handlers or standard streams changes.
TEST(Evaluation, LeavesTheProcessAlone) {
  std::fesetround(FE_UPWARD);
  const long double third = 1.0L / 3.0L;
  std::vector<struct sigaction> before;
  for (int s : {SIGINT, SIGFPE, SIGTERM, SIGHUP, SIGABRT}) {
    struct sigaction action {};
    sigaction(s, nullptr, &action);
    before.push_back(action);
  }
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  {
    const auto m = read_text(diagonal({"o43\nv0\n"}));
    Vec F(1);
    EXPECT_FALSE(m->eval(Vec{{-1}}, F));
  }
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  std::size_t k = 0;
  for (int s : {SIGINT, SIGFPE, SIGTERM, SIGHUP, SIGABRT}) {
    struct sigaction action {};
    sigaction(s, nullptr, &action);
    EXPECT_EQ(action.sa_handler, before[k++].sa_handler);
  }
  EXPECT_EQ(std::fegetround(), FE_UPWARD);
  volatile long double three = 3;
  EXPECT_EQ(1.0L / three, third);  // the x87 precision, which the library lowers
  std::fesetround(FE_TONEAREST);
}

// Two models in two threads, read and evaluated at the same time, give what they give one after the other; errors in
// one do not reach the other.
TEST(Evaluation, TwoThreads) {
  const std::vector<std::string> contents = {rich_models()[0], diagonal({"o39\nv0\n", "o43\nv1\n", "o44\nv2\n"})};
  const auto point = [](int k) { return Vec{{0.1 * (k % 11) - 0.3, 0.2 * (k % 7) - 0.2, 0.05 * (k % 13)}}; };
  constexpr int points = 300;
  std::vector<std::vector<Vec>> expected(2), found(2);
  const auto run = [&](std::size_t which, std::vector<Vec>& out) {
    for (int round = 0; round < 3; ++round) {
      const auto m = read_text(contents[which]);
      for (int k = 0; k < points; ++k) {
        Vec result = Vec::Zero(m->size() + m->jacobian_pattern().nonZeros() + 2);
        Vec F(m->size());
        SpMat J = m->jacobian_pattern();
        if (m->eval(point(k), F)) {
          result[0] = 1;
          result.segment(2, m->size()) = F;
        }
        if (m->jacobian(point(k), J)) {
          result[1] = 1;
          result.tail(J.nonZeros()) = Eigen::Map<const Vec>(J.valuePtr(), J.nonZeros());
        }
        out.push_back(result);
      }
    }
  };
  for (std::size_t i = 0; i < 2; ++i) run(i, expected[i]);
  std::thread first([&] { run(0, found[0]); });
  std::thread second([&] { run(1, found[1]); });
  first.join();
  second.join();
  for (std::size_t i = 0; i < 2; ++i) EXPECT_TRUE(found[i] == expected[i]);
}

// sum of n terms exp(x) = -0.1, which has no solution. With few elementary functions the ranges say so before any
// restart; with many they cost more than many a solve, and are asked for after it. Catches ranges whose cost nobody
// counts, and a proof that is then not looked for.
TEST(Evaluation, CostlyRangesWaitForAFailure) {
  for (const int terms : {3, 300}) {
    std::string sum = "C0\no54\n" + std::to_string(terms) + "\n";
    for (int k = 0; k < terms; ++k) sum += "o44\nv0\n";
    const auto model = read_text(text({.eqns = 1}) + sum + "r\n4 -0.1\nb\n3\nk0\nJ0 1\n0 0\n");
    ASSERT_NE(model->enclosure(), nullptr);
    const Result result = solve(*model, Vec::Zero(1), path());
    EXPECT_EQ(result.status, Status::Infeasible) << terms;
    EXPECT_THAT(result.message, testing::HasSubstr("proven to have no solution")) << terms;
    EXPECT_EQ(result.stats.restarts > 0, terms == 300) << terms;
  }
}

}  // namespace
}  // namespace perp::ncp::ampl
