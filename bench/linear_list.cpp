// SPDX-License-Identifier: Apache-2.0
/// Measures what each entry of the list for affine problems is worth. The affine problems of the collection, and those
/// of files NAME.mtx with NAME-q.mtx, NAME-lower.mtx and NAME-upper.mtx, with one entry at a time left out. See
/// README.md.
#include <chrono>
#include <cstdio>
#include <ctime>
#include <exception>
#include <random>
#include <string>
#include <vector>

#include "cases.hpp"
#include "collection/random/random_lcps.hpp"
#include "lcp/io/matrix_market.hpp"
#include "ncp/problem/affine.hpp"

namespace {

using namespace perp;

struct Problem {
  std::string name;
  lcp::AffineMcp mcp;
  lcp::Vec start;
};

struct Outcome {
  lcp::Result result;
  double seconds = 0;
  bool settled() const { return result.accepted() || result.status == lcp::Status::Infeasible; }
};

Outcome run(const Problem& problem, const lcp::Auto& method) {
  const std::clock_t begin = std::clock();
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  Outcome outcome{lcp::solve(problem.mcp, problem.start, method, {.deadline = deadline})};
  outcome.seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  return outcome;
}

Problem read(const std::string& file) {
  const std::string stem = file.substr(0, file.rfind(".mtx"));
  Problem problem{stem.substr(stem.rfind('/') + 1), {}, {}};
  problem.mcp.M = lcp::read_matrix(file);
  problem.mcp.q = lcp::read_vector(stem + "-q.mtx");
  problem.mcp.box = {lcp::read_vector(stem + "-lower.mtx", true), lcp::read_vector(stem + "-upper.mtx", true)};
  problem.start = lcp::project(problem.mcp.box, lcp::Vec::Zero(problem.mcp.size()));
  return problem;
}

/// Small problems of every class with a name, and of none.
void add_random(std::vector<Problem>& problems) {
  namespace made = ncp::collection;
  const auto add = [&](const std::string& name, lcp::AffineMcp mcp) {
    lcp::Vec start = lcp::Vec::Zero(mcp.size());
    problems.push_back({name, std::move(mcp), std::move(start)});
  };
  for (const lcp::Index n : {12, 40, 120})
    for (unsigned seed = 1; seed <= 10; ++seed) {
      const std::string of = ':' + std::to_string(n) + ':' + std::to_string(seed);
      add("definite" + of, made::random_positive_definite(n, seed).problem);
      add("semidefinite" + of, made::random_semidefinite(n, seed).problem);
      add("p" + of, made::random_p_matrix(n, seed).problem);
      add("strictly-copositive" + of, made::random_strictly_copositive(n, seed).problem);
      add("copositive-plus" + of, made::random_copositive_plus(n, seed).problem);
      add("copositive" + of, made::random_copositive(n, seed).problem);
      add("z" + of, made::random_z_matrix(n, seed).problem);
      add("bimatrix" + of, made::random_bimatrix(n / 2, n / 2, seed).problem);
      add("degenerate" + of, made::random_degenerate(n, seed).problem);
      add("infeasible" + of, made::random_infeasible(n, seed).problem);
      std::mt19937 engine(seed);
      const auto uniform = [&engine] { return 2 * static_cast<double>(engine()) / 4294967296.0 - 1; };
      Eigen::MatrixXd M = Eigen::MatrixXd::NullaryExpr(n, n, uniform);
      lcp::Vec q = lcp::Vec::NullaryExpr(n, uniform);
      add("any" + of, lcp::standard_lcp(M.sparseView(), q));
      const lcp::Vec z = lcp::Vec::NullaryExpr(n, uniform);  // planted: z+ is a solution
      add("planted" + of, lcp::standard_lcp(M.sparseView(), z.cwiseMax(0) - z - M * z.cwiseMax(0)));
    }
}

}  // namespace

int main(int argc, char** argv) try {
  std::vector<Problem> problems;
  for (int i = 1; i < argc; ++i) problems.push_back(read(argv[i]));
  for (const bench::Case& c : bench::collection_cases(""))
    if (auto affine = ncp::affine_part(*c.mcp)) problems.push_back({c.problem + ' ' + c.start, *affine, c.x0});

  add_random(problems);

  const lcp::Auto whole;
  std::vector<Outcome> before;
  int settled = 0;
  double seconds = 0;
  for (const Problem& problem : problems) {
    before.push_back(run(problem, whole));
    settled += before.back().settled();
    seconds += before.back().seconds;
    if (before.back().seconds > 1)
      std::printf("# %s %.2f s: %s\n", problem.name.c_str(), before.back().seconds,
                  before.back().result.message.c_str());
  }
  std::printf(
      "| left out | problems that come to it | settled | lost | gained | seconds |\n|---|---|---|---|---|---|\n");
  std::printf("| nothing | %zu | %d | | | %.1f |\n", problems.size(), settled, seconds);
  for (std::size_t k = 0; k < whole.list.size(); ++k) {
    const std::string title(whole.list[k].title.empty() ? lcp::name(whole.list[k].method) : whole.list[k].title);
    lcp::Auto without = whole;
    without.list.erase(without.list.begin() + static_cast<std::ptrdiff_t>(k));
    int come = 0;
    int settled_without = settled;
    double seconds_without = seconds;
    std::string lost, gained;
    for (std::size_t i = 0; i < problems.size(); ++i) {
      if (before[i].result.message.find(title) == std::string::npos) continue;
      ++come;
      const Outcome now = run(problems[i], without);
      seconds_without += now.seconds - before[i].seconds;
      settled_without += now.settled() - before[i].settled();
      if (before[i].settled() && !now.settled()) lost += ' ' + problems[i].name;
      if (!before[i].settled() && now.settled()) gained += ' ' + problems[i].name;
    }
    std::printf("| %zu %s | %d | %d |%s |%s | %.1f |\n", k + 1, title.c_str(), come, settled_without, lost.c_str(),
                gained.c_str(), seconds_without);
    std::fflush(stdout);
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "bench_linear_list: %s\n", error.what());
  return 1;
}
