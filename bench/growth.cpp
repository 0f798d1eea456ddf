// SPDX-License-Identifier: Apache-2.0
/// How the time of a method grows with the size, in factorizations of J at the solution. See README.md.
#include <cmath>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "cases.hpp"
#include "collection/sized.hpp"
#include "lcp/lu/sparse_lu.hpp"
#include "ncp/problem/affine.hpp"
#include "timing.hpp"

namespace {

using namespace perp;
using ncp::Index;
using ncp::SpMat;
using ncp::Vec;

/// An obstacle problem of convection and diffusion on the m x m inner points of the unit square, upwind: the rows are
/// h^2 times  -Delta u + v . grad u - f  with v = (100, 50) and f = 100 sin(2 pi x) sin(2 pi y), 0 <= u.
std::unique_ptr<ncp::Mcp> convection_diffusion(Index m) {
  const double h = 1 / static_cast<double>(m + 1);
  const double east = 100 * h;
  const double north = 50 * h;
  lcp::AffineMcp problem;
  problem.M.resize(m * m, m * m);
  problem.M.reserve(Eigen::VectorXi::Constant(static_cast<int>(m * m), 5));
  problem.q.resize(m * m);
  problem.box = {Vec::Zero(m * m), Vec::Constant(m * m, lcp::infinity)};
  for (Index j = 0; j < m; ++j)
    for (Index i = 0; i < m; ++i) {
      const Index k = j * m + i;
      problem.M.insert(k, k) = 4 + east + north;
      if (i > 0) problem.M.insert(k, k - 1) = -1 - east;
      if (i + 1 < m) problem.M.insert(k, k + 1) = -1;
      if (j > 0) problem.M.insert(k, k - m) = -1 - north;
      if (j + 1 < m) problem.M.insert(k, k + m) = -1;
      const double turn = 2 * M_PI * h;
      problem.q[k] =
          -100 * h * h * std::sin(turn * static_cast<double>(i + 1)) * std::sin(turn * static_cast<double>(j + 1));
    }
  problem.M.makeCompressed();
  return ncp::make_affine_mcp(std::move(problem), "convection-diffusion");
}

struct Problem {
  std::unique_ptr<ncp::Mcp> mcp;
  std::vector<Vec> starts;
};

/// FAMILY:SIZES, or convection-diffusion:M.
Problem named(const std::string& text) {
  const auto colon = text.find(':');
  if (colon == std::string::npos) throw std::invalid_argument("'" + text + "': expected FAMILY:SIZES");
  const std::string name = text.substr(0, colon);
  const std::string sizes = text.substr(colon + 1);
  if (name == "convection-diffusion") {
    auto mcp = convection_diffusion(std::stol(sizes));
    Vec zero = Vec::Zero(mcp->size());
    return {std::move(mcp), {std::move(zero)}};
  }
  const auto* family = ncp::collection::find_family(name);
  if (family == nullptr) throw std::invalid_argument("no family of problems is called '" + name + "'");
  auto made = ncp::collection::make(*family, sizes);
  return {std::move(made.mcp), std::move(made.starts)};
}

/// A factorization of J(x) with its analysis [s], NaN if there are no factors.
double factorization(const ncp::Mcp& mcp, const Vec& x) {
  SpMat J = mcp.jacobian_pattern();
  if (!mcp.jacobian(x, J)) return std::nan("");
  bool factored = true;
  const double seconds = bench::least_seconds([&] {
    lcp::SparseLu lu(lcp::LuBackend::General);
    factored = lu.factor(J) == lcp::LuStatus::Ok;
  });
  return factored ? seconds : std::nan("");
}

void line(const std::string& text, std::size_t start, const std::string& method) {
  const Problem problem = named(text);
  if (start > problem.starts.size()) throw std::invalid_argument(text + ": there is no start " + std::to_string(start));
  ncp::Result result;
  const double least = bench::least_seconds(
      [&] { result = ncp::solve(*problem.mcp, problem.starts[start - 1], ncp::method_of(method)); });
  const double lu = factorization(*problem.mcp, result.x);
  std::printf("| %s | %zu | %td | %s | %.2g | %.3g | %.2g | %.3g | %d | %d |\n", text.c_str(), start,
              problem.mcp->size(), result.accepted() ? method.c_str() : (method + " (not solved)").c_str(),
              result.residual.natural, least, lu, least / lu, result.stats.factorizations, result.stats.pivots);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 3) throw std::invalid_argument("usage: bench_growth METHOD FAMILY:SIZES[@START]...");
  std::printf(
      "| problem | start | unknowns | method | residual | solve, s | LU, s | in LUs | factorizations | pivots |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  for (int k = 2; k < argc; ++k) {
    std::string text = argv[k];
    const auto at = text.find('@');
    const std::size_t start = at == std::string::npos ? 1 : std::stoul(text.substr(at + 1));
    line(text.substr(0, at), start, argv[1]);
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "bench_growth: %s\n", error.what());
  return 2;
}
