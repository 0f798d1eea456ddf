// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <random>
#include <span>
#include <vector>

#include "lcp/judge/refutation.hpp"
#include "ncp/analysis/certificate.hpp"
#include "ncp/analysis/no_solution.hpp"
#include "ncp/analysis/row_sums.hpp"
#include "ncp/problem/autodiff.hpp"
#include "ncp/strategy/presets.hpp"
#include "ncp/strategy/solve.hpp"

namespace perp::ncp {
namespace {

using testing::HasSubstr;

/// F(x) = A' phi(A x) + S x + q with S' = -S: monotone, as the phi grow.
struct Monotone {
  std::vector<std::vector<int>> A{};
  std::vector<std::vector<int>> S{};
  std::vector<double> q{};

  template <class T>
  void operator()(std::span<const T> x, std::span<T> F) const {
    using std::atan, std::exp;
    for (std::size_t k = 0; k < A.size(); ++k) {
      T a = 0;
      for (std::size_t j = 0; j < x.size(); ++j)
        if (A[k][j] != 0) a += A[k][j] * x[j];
      const T phi = k % 3 == 0 ? exp(0.1 * a) : k % 3 == 1 ? a * a * a : atan(a);
      for (std::size_t i = 0; i < x.size(); ++i)
        if (A[k][i] != 0) F[i] += A[k][i] * phi;
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
      for (std::size_t j = 0; j < x.size(); ++j)
        if (S[i][j] != 0) F[i] += S[i][j] * x[j];
      F[i] += q[i];
    }
  }
};

/// With a direction d >= 0, A d = 0 or, where phi is positive, A d <= 0, S d = 0, along which d'F <= q'd < 0: by the
/// variational inequality no x >= 0 solves it (Facchinei & Pang 2003, section 2.4). With q'd = 0 in place of it, and
/// F >= 0 at some x >= 0, it is feasible.
Monotone drawn(std::mt19937& random, std::size_t n, int slope) {
  const auto number = [&](int from, int to) { return std::uniform_int_distribution<int>(from, to)(random); };
  std::vector<int> d(n);
  for (int& entry : d) entry = number(0, 2);
  d[0] = 1;
  Monotone f{.A = std::vector(n, std::vector<int>(n)), .S = std::vector(n, std::vector<int>(n)), .q = {}};
  for (std::size_t k = 0; k < n; ++k) {
    int along = 0;
    for (std::size_t j = 1; j < n; ++j) along += (f.A[k][j] = number(0, 3) == 0 ? number(-3, 3) : 0) * d[j];
    f.A[k][0] = -along - (k % 3 == 0 ? number(0, 2) : 0);
  }
  // (u v' - v u') d = 0 where u'd = v'd = 0.
  std::vector<int> u(n), v(n);
  for (auto* w : {&u, &v}) {
    int along = 0;
    for (std::size_t j = 1; j < n; ++j) along += ((*w)[j] = number(-1, 1)) * d[j];
    (*w)[0] = -along;
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) f.S[i][j] = u[i] * v[j] - v[i] * u[j];
  double along = 0;
  for (std::size_t j = 0; j < n; ++j) f.q.push_back(j == 0 ? 0 : number(-5, 5));
  for (std::size_t j = 1; j < n; ++j) along += f.q[j] * d[j];
  f.q[0] = slope - along;
  return f;
}

std::unique_ptr<Mcp> problem_of(const Monotone& f) {
  return make_autodiff_mcp(f, {.box = Box::nonnegative(static_cast<Index>(f.q.size()))});
}

// 100 monotone problems without a solution, none of whose rows has one sign. Most are proven. Catches proofs that are
// lost because a term is not known again in another row, and certificates that do not hold.
TEST(NoSolutionBySums, IsProvenOfMonotoneProblems) {
  std::mt19937 random(5);
  int proven = 0;
  for (int run = 0; run < 100; ++run) {
    const auto mcp = problem_of(drawn(random, 2 + static_cast<std::size_t>(run) % 19, -1 - run % 7));
    const auto proof = no_solution_by_sums(*mcp, 1e-8);
    if (!proof) continue;
    ++proven;
    EXPECT_TRUE(lcp::holds(*proof->sums, *proof->certificate)) << run;
    EXPECT_GE(proof->residual_bound, 1e-8) << run;
  }
  EXPECT_GE(proven, 95);  // the multipliers of a few have more digits than two doubles
}

// The end of a solve says it, with a certificate. Catches a method that is stuck, and nobody looks for the proof.
TEST(NoSolutionBySums, EndsASolve) {
  std::mt19937 random(6);
  int proven = 0;
  for (int run = 0; run < 20; ++run) {
    const auto mcp = problem_of(drawn(random, 3 + static_cast<std::size_t>(run) % 8, -1));
    Method method = method_of("auto");
    stop(method).max_time = std::chrono::seconds(20);
    const Result result = solve(*mcp, Vec::Ones(mcp->size()), method);
    EXPECT_FALSE(result.accepted()) << run;
    if (result.status != Status::Infeasible) continue;
    ++proven;
    EXPECT_THAT(result.message, HasSubstr("proven to have no solution")) << run;
  }
  EXPECT_GE(proven, 18);
}

// Problems with a planted solution. Catches a proof of what is false.
TEST(NoSolutionBySums, IsNotClaimedWhereThereIsASolution) {
  std::mt19937 random(7);
  for (int run = 0; run < 300; ++run) {
    const std::size_t n = 2 + static_cast<std::size_t>(run) % 9;
    Monotone f = drawn(random, n, -run % 3);
    std::vector<double> x(n), F(n);
    for (double& entry : x) entry = static_cast<double>(random() % 3);
    std::ranges::fill(f.q, 0.0);
    f(std::span<const double>(x), std::span<double>(F));
    for (std::size_t i = 0; i < n; ++i) f.q[i] = (x[i] > 0 ? 0 : static_cast<double>(random() % 2)) - F[i];
    EXPECT_FALSE(no_solution_by_sums(*problem_of(f), 1e-8)) << run;
  }
}

// (1 + eps) e^x - e^u = 0 and e^x - (1 - eps) e^u = 1 have the solution e^x = 2^104: multipliers prove that there is
// none with terms below 1e31, and variables of 72 have larger ones. Catches a radius that is kept for variables only.
TEST(NoSolutionBySums, IsNotClaimedWhereTermsAreLarge) {
  const auto mcp = make_autodiff_mcp(
      []<class T>(std::span<const T> x, std::span<T> F) {
        using std::exp;
        F[0] = (1 + 0x1p-52) * exp(x[0]) - exp(x[1]);
        F[1] = exp(x[0]) - (1 - 0x1p-52) * exp(x[1]) - 1;
      },
      {.box = Box::free(2)});
  EXPECT_FALSE(no_solution_by_sums(*mcp, 1e-8));
}

// The sums are F: at points, with terms at the values that they have there. Catches terms that are taken for the same,
// coefficients that were rounded, and signs.
TEST(RowSums, EqualF) {
  const auto f = [](const auto& x, auto F) {
    using std::exp, std::log;
    const auto e = exp(x[0] - x[1]);
    F[0] = 3 * e - 0.1 * x[0] + 0.2 * x[0] - (x[1] - 2.0) / 4 + 7;
    F[1] = -(e + log(x[2])) / 3 + x[0] * x[1] - -x[2];
    F[2] = 0.1 * x[0] - 0.1 * x[0] + exp(x[0] - x[1]) * 2 - exp(x[1] - x[0]) + 1e300 * x[2] + 1e-300;
  };
  const auto mcp =
      make_autodiff_mcp([&f]<class T>(std::span<const T> x, std::span<T> F) { f(x, F); }, {.box = Box::nonnegative(3)});
  const auto sums = row_sums(*mcp);
  ASSERT_TRUE(sums);
  const Index columns = sums->problem.size();
  // exp(x1 - x2), exp(x2 - x1), (e + log x3)/3, x1 x2, and a number whose product with 1 is taken for rounded.
  EXPECT_EQ(columns, 3 + 5);
  EXPECT_EQ(std::count(sums->rows.begin(), sums->rows.end(), 1), 3);
  EXPECT_FALSE(sums->problem.invalid());
  const SpMat rows = sums->problem.M.transpose();
  Index shared = 0;
  for (Index j = 3; j < columns; ++j)
    if (sums->problem.M.coeff(0, j) == 3) shared = j;
  ASSERT_GE(shared, 3);
  EXPECT_EQ(sums->problem.M.coeff(2, shared), 2);
  EXPECT_EQ(sums->problem.box.lower[shared], 0);
  EXPECT_EQ(sums->problem.M.coeff(0, 1), -0.25);
  EXPECT_EQ(sums->problem.q[0], 7.5);
}

// x_1 x_2 - 1 and 2 - x_1 x_2 cannot both be 0. Catches certificates that the text leaves out, and names.
TEST(NoSolutionBySums, HasACertificateWithItsTerms) {
  const auto mcp = make_autodiff_mcp(
      []<class T>(std::span<const T> x, std::span<T> F) {
        F[0] = x[0] * x[1] - 1;
        F[1] = 2 - x[0] * x[1];
      },
      {.box = Box::free(2)});
  const auto proof = no_solution_by_sums(*mcp, 1e-8);
  ASSERT_TRUE(proof);
  EXPECT_NEAR(proof->residual_bound, 0.5, 1e-6);
  const std::string text = certificate_json(*mcp, Vec::Zero(2), *proof);
  EXPECT_THAT(text, HasSubstr("\"name\":\"term 1\",\"lower\":null,\"upper\":null"));
  EXPECT_THAT(text, HasSubstr("\"terms_from\":2"));
  EXPECT_EQ(rows_in_words(*mcp, *proof), "rows F[1] and F[2]");
  EXPECT_TRUE(uses_terms(*mcp, *proof));
}

}  // namespace
}  // namespace perp::ncp
