// SPDX-License-Identifier: Apache-2.0
/// Obstacle problem: bound_qp beside one CHOLMOD factorization of the same matrix and, where PETSc is there, beside its
/// solvers of the same problem. README.md tells how to read it.
///     obstacle [REPETITIONS [N ...]]
#include "obstacle.hpp"

#include <cholmod.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "lcp/qp/bound_qp.hpp"

namespace perp::bench {

lcp::AffineMcp obstacle(int N) {
  const double h = 1.0 / (N + 1);
  const lcp::Index n = static_cast<lcp::Index>(N) * N;
  lcp::AffineMcp problem{
      .M = lcp::SpMat(n, n), .q = lcp::Vec::Constant(n, 1e-6 * h * h), .box = lcp::Box::nonnegative(n)};
  problem.M.reserve(Eigen::VectorXi::Constant(n, 5));
  for (int j = 0; j < N; ++j)
    for (int i = 0; i < N; ++i) {
      const int k = j * N + i;
      if (j > 0) problem.M.insert(k - N, k) = -1;
      if (i > 0) problem.M.insert(k - 1, k) = -1;
      problem.M.insert(k, k) = 4;
      if (i + 1 < N) problem.M.insert(k + 1, k) = -1;
      if (j + 1 < N) problem.M.insert(k + N, k) = -1;
      const double x = (i + 1) * h - 0.5;
      const double y = (j + 1) * h - 0.5;
      problem.box.lower[k] = 0.1 - x * x - y * y;
    }
  problem.M.makeCompressed();
  return problem;
}

lcp::Vec obstacle_start(const lcp::AffineMcp& problem) { return problem.box.lower.cwiseMax(0); }

namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

double peak_gigabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / (1024.0 * 1024.0);
}

/// Seconds of cholmod_analyze and cholmod_factorize with default options.
double factor(const lcp::SpMat& M) {
  cholmod_common common{};
  cholmod_start(&common);
  cholmod_sparse A{};
  A.nrow = A.ncol = static_cast<std::size_t>(M.rows());
  A.nzmax = static_cast<std::size_t>(M.nonZeros());
  A.p = const_cast<int*>(M.outerIndexPtr());
  A.i = const_cast<int*>(M.innerIndexPtr());
  A.x = const_cast<double*>(M.valuePtr());
  A.stype = -1;
  A.itype = CHOLMOD_INT;
  A.xtype = CHOLMOD_REAL;
  A.dtype = CHOLMOD_DOUBLE;
  A.sorted = A.packed = 1;
  const double begin = now();
  cholmod_factor* L = cholmod_analyze(&A, &common);
  cholmod_factorize(&A, L, &common);
  const double seconds = now() - begin;
  cholmod_free_factor(&L, &common);
  cholmod_finish(&common);
  return seconds;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void line(const std::string& what, double seconds, double factorization, double perp, const std::string& rest) {
  std::printf("  %-34s %9.3f s %8.2f factorizations %8.2f x perp  %s\n", what.c_str(), seconds, seconds / factorization,
              seconds / perp, rest.c_str());
  std::fflush(stdout);
}

std::string residual_of(double residual) {
  char text[64];
  std::snprintf(text, sizeof text, "natural residual %.1e", residual);
  return text;
}

void measure(int N, int repetitions, std::vector<std::string>& skip) {
  const lcp::AffineMcp problem = obstacle(N);
  const lcp::Vec start = obstacle_start(problem);
  const double before = peak_gigabytes();
  std::vector<double> perp;
  std::vector<double> cholmod;
  lcp::Result result;
  double peak = 0;
  for (int k = 0; k < repetitions; ++k) {  // in turn, so that a slow moment of the machine hits both
    const double begin = now();
    result = lcp::bound_qp(problem, start);
    perp.push_back(now() - begin);
    if (k == 0) peak = peak_gigabytes();
    cholmod.push_back(factor(problem.M));
  }
  const double factorization = median(cholmod);
  const double own = median(perp);
  std::printf("N = %d, n = %d, median of %d; peak of memory: %.2f GB with the problem alone, %.2f GB with bound_qp\n",
              N, N * N, repetitions, before, peak);
  line("one CHOLMOD factorization", factorization, factorization, own, "");
  line("perp bound_qp (" + std::string(to_string(result.status)) + ")", own, factorization, own,
       residual_of(result.residual) + ", " + std::to_string(result.iterations) + " steps");
  constexpr double tol = 1e-8;
  constexpr double too_slow = 60;  // seconds, after which a solver is not tried on larger grids
  for (const Measurement& m : petsc(problem, start, tol, skip)) {
    const double residual = natural_residual(problem, project(problem.box, m.z));
    line(m.solver, m.seconds, factorization, own,
         residual_of(residual) + (residual <= tol ? ", " : " NOT SOLVED, ") + m.remark);
    if (m.seconds > too_slow) skip.push_back(m.solver);
  }
}

}  // namespace
}  // namespace perp::bench

int main(int argc, char** argv) {
  const int repetitions = argc > 1 ? std::max(1, std::atoi(argv[1])) : 3;
  std::vector<int> sizes;
  for (int k = 2; k < argc; ++k) sizes.push_back(std::max(1, std::atoi(argv[k])));
  if (sizes.empty()) sizes = {300, 500, 1000};
  std::vector<std::string> skip;
  for (const int N : sizes) perp::bench::measure(N, repetitions, skip);
}
