// SPDX-License-Identifier: Apache-2.0
// The methods for affine problems, where a request for memory fails. Catches crashes, factors of another matrix used,
// and "stalled" or "singular" said of what was want of memory.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <sstream>

#include "faults/harness.hpp"
#include "lcp/cholesky/cholesky.hpp"
#include "lcp/judge/judge.hpp"
#include "lcp/pivoting/lemke_howson.hpp"
#include "lcp/solve/solve.hpp"
#include "support/matrices.hpp"
#include "support/problems.hpp"

namespace perp::faults {
namespace {

using lcp::AffineMcp;
using lcp::Method;
using lcp::Status;

std::string bits(const lcp::Vec& v) {
  std::ostringstream out;
  out << std::hexfloat;
  for (const double x : v) out << x << ' ';
  return out.str();
}

Scenario solving(AffineMcp problem, Method method) {
  return [=, usual = std::optional<Status>()](long k) mutable {
    lcp::Result result;
    const lcp::Vec start = lcp::Vec::Zero(problem.size());
    Outcome outcome;
    outcome.out_of_memory = !attempt(k, [&] { result = lcp::solve(problem, start, method); });
    std::ostringstream all;
    all << to_string(result.status) << ": " << result.message << "; " << result.residual << ", " << result.iterations
        << ", " << result.factorizations << "; " << bits(result.z);
    outcome.all = all.str();
    if (outcome.out_of_memory) return outcome;
    if (!usual) usual = result.status;
    outcome.out_of_memory = result.status == Status::OutOfMemory;
    const auto judgement = lcp::judge(problem, result.z);
    outcome.right = judgement.natural == result.residual && (result.accepted() || result.status == *usual) &&
                    (!result.solved() || judgement.natural <= 1e-9);
    if (outcome.out_of_memory && judgement.natural != result.residual)
      outcome = {false, false, "not its residual: " + outcome.all};
    return outcome;
  };
}

AffineMcp obstacle(int N) {
  support::Random random(1);
  const lcp::SpMat M = support::five_point(N, 4.01);
  return {M, random.normals(M.rows()), lcp::Box::nonnegative(M.rows())};
}

AffineMcp unsymmetric(lcp::Index n) {
  support::Random random(2);
  return {support::h_plus(n, 3, random), random.normals(n), lcp::Box::nonnegative(n)};
}

/// No structure: Auto goes through its list.
AffineMcp any(lcp::Index n) {
  support::Random random(3);
  return {support::random_sparse(n, 3, random), random.normals(n), lcp::Box::nonnegative(n)};
}

AffineMcp infeasible() {
  return {support::matrix({{0, 1, 0}, {-1, 0, 0}, {0, 0, -1}}), support::vec({1, 1, -1}), lcp::Box::nonnegative(3)};
}

class LcpFaults : public testing::TestWithParam<const lcp::MethodEntry*> {};

std::vector<const lcp::MethodEntry*> entries() {
  std::vector<const lcp::MethodEntry*> all;
  for (const auto& entry : lcp::methods()) all.push_back(&entry);
  return all;
}

INSTANTIATE_TEST_SUITE_P(Methods, LcpFaults, testing::ValuesIn(entries()), [](const auto& entry) {
  std::string name(entry.param->name);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST_P(LcpFaults, Small) {
  const std::string name(GetParam()->name);
  every_request_fails_once(name + ", 12 rows", solving(unsymmetric(12), GetParam()->method));
  every_request_fails_once(name + ", no structure", solving(any(12), GetParam()->method));
  every_request_fails_once(name + ", infeasible", solving(infeasible(), GetParam()->method));
}

// KLU, CHOLMOD.
TEST_P(LcpFaults, Middle) {
  const std::string name(GetParam()->name);
  every_request_fails_once(name + ", 64 rows symmetric", solving(obstacle(8), GetParam()->method));
  every_request_fails_once(name + ", 60 rows", solving(unsymmetric(60), GetParam()->method));
}

// UMFPACK.
TEST_P(LcpFaults, Large) {
  const std::string name(GetParam()->name);
  every_request_fails_once(name + ", 361 rows symmetric", solving(obstacle(19), GetParam()->method), 12);
  every_request_fails_once(name + ", 350 rows", solving(unsymmetric(350), GetParam()->method), 12);
}

/// Of the seven-point grid of N^3 points.
lcp::SpMat cube(int N) {
  const int n = N * N * N;
  support::Triplets entries;
  for (int k = 0; k < n; ++k) {
    entries.emplace_back(k, k, 6.1);
    const auto join = [&](bool inside, int other) {
      if (!inside) return;
      entries.emplace_back(k, other, -1);
      entries.emplace_back(other, k, -1);
    };
    join(k % N + 1 < N, k + 1);
    join(k / N % N + 1 < N, k + N);
    join(k / (N * N) + 1 < N, k + N * N);
  }
  return support::from(n, entries);
}

// Of the requests that cholmod_solve2 makes with supernodal factors it looks at the last one only.
TEST(CholeskyFaults, Supernodal) {
  const lcp::SpMat A = cube(13);
  const lcp::Vec b = lcp::Vec::LinSpaced(A.rows(), 0, 1);
  every_request_fails_once(
      "Cholesky, 2197 rows",
      [&](long k) {
        Outcome outcome;
        lcp::Vec x = lcp::Vec::Zero(A.rows());
        std::optional<lcp::CholeskyStatus> status;
        outcome.out_of_memory = !attempt(k, [&] {
          lcp::Cholesky factors;
          status = factors.factor(A);
          if (status == lcp::CholeskyStatus::Ok) factors.solve(b, x);
        });
        outcome.all = std::to_string(status ? static_cast<int>(*status) : -1) + ": " + bits(x);
        if (outcome.out_of_memory) return outcome;
        outcome.out_of_memory = status == lcp::CholeskyStatus::OutOfMemory;
        outcome.right = status == lcp::CholeskyStatus::Ok && (A * x - b).lpNorm<Eigen::Infinity>() <= 1e-12;
        return outcome;
      },
      6);
}

}  // namespace
}  // namespace perp::faults
