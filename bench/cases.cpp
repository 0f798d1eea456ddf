// SPDX-License-Identifier: Apache-2.0
#include "cases.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <random>
#include <stdexcept>
#include <utility>

#include "collection/collection.hpp"
#include "ncp/ampl/model.hpp"
#include "ncp/problem/affine.hpp"
#include "ncp/strategy/presets.hpp"

namespace perp::bench {

using ncp::Index;
using ncp::Vec;

std::vector<Case> collection_cases(std::string_view only) {
  std::vector<Case> cases;
  for (const auto& entry : ncp::collection::entries()) {
    if (entry.name.find(only) == std::string_view::npos) continue;
    ncp::collection::Problem problem = entry.make();
    const std::shared_ptr<const ncp::Mcp> mcp = std::move(problem.mcp);
    for (std::size_t k = 0; k < problem.starts.size(); ++k)
      cases.push_back(
          {std::string(entry.name), std::to_string(k + 1), mcp, problem.starts[k], problem.no_solution.empty(), false});
  }
  return cases;
}

std::vector<Case> random_cases(std::string_view name, int count, std::uint64_t seed) {
  const auto* entry = ncp::collection::find(name);
  if (entry == nullptr) throw std::invalid_argument("the collection has no problem '" + std::string(name) + "'");
  ncp::collection::Problem problem = entry->make();
  const std::shared_ptr<const ncp::Mcp> mcp = std::move(problem.mcp);
  Vec low = problem.starts.front();
  Vec high = low;
  for (const Vec& x : problem.starts) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const Vec reach = (high - low).cwiseMax(1);
  low = lcp::project(mcp->box(), low - reach);
  high = lcp::project(mcp->box(), high + reach);

  std::mt19937_64 engine(seed);
  std::vector<Case> cases;
  for (int k = 1; k <= count; ++k) {
    Vec x(mcp->size());
    for (Index i = 0; i < x.size(); ++i)  // not <random>'s distribution, which differs between libraries
      x[i] = low[i] + (high[i] - low[i]) * static_cast<double>(engine() >> 11U) * 0x1p-53;
    cases.push_back({std::string(name), std::string("random ").append(std::to_string(k)), mcp, std::move(x),
                     problem.no_solution.empty(), true});
  }
  return cases;
}

namespace {

/// Not <random>'s distributions, which differ between libraries.
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : engine_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11U) * 0x1p-53;
  }
  Index below(Index n) { return static_cast<Index>(uniform(0, static_cast<double>(n))); }

 private:
  std::mt19937_64 engine_;
};

lcp::AffineMcp random_program(Numbers& random) {
  const Index n = 20 + random.below(180);
  const Index m = 5 + random.below(std::min<Index>(95, n / 2));
  std::vector<::Eigen::Triplet<double>> entries;
  const auto put = [&](Index i, Index j, double v) {
    entries.emplace_back(static_cast<int>(i), static_cast<int>(j), v);
  };
  for (Index i = 0; i < n; ++i) put(i, i, random.uniform(0, 1));
  for (Index k = 0; k < n / 10; ++k) {  // V V', four entries a column
    std::array<std::pair<Index, double>, 4> v;
    for (auto& [i, value] : v) i = random.below(n), value = random.uniform(-1, 1);
    for (const auto& [i, a] : v)
      for (const auto& [j, b] : v) put(i, j, a * b);
  }
  Vec b = Vec::Zero(m);
  for (Index j = 0; j < n; ++j) {
    const double inside = random.uniform(0.1, 0.9);
    for (int k = 0; k < 3; ++k) {
      const Index i = random.below(m);
      const double a = random.uniform(-1, 1);
      put(n + i, j, a);
      put(j, n + i, -a);
      b[i] += a * inside;
    }
  }
  lcp::AffineMcp problem{ncp::SpMat(n + m, n + m), Vec(n + m), lcp::Box::free(n + m)};
  problem.M.setFromTriplets(entries.begin(), entries.end());
  problem.box.lower.head(n).setZero();
  problem.box.upper.head(n).setOnes();
  for (Index i = 0; i < m; ++i)
    if (random.uniform(0, 1) < 0.5) problem.box.lower[n + i] = 0;
  for (Index j = 0; j < n; ++j) problem.q[j] = random.uniform(-2, 2);
  problem.q.tail(m) = -b;
  return problem;
}

}  // namespace

std::vector<Case> random_programs(int count, std::uint64_t seed) {
  Numbers random(seed);
  std::vector<Case> cases;
  while (static_cast<int>(cases.size()) < count) {
    lcp::AffineMcp problem = random_program(random);
    if (problem.M.nonZeros() > 2000) continue;  // PATH's limit
    const Index n = problem.size();
    cases.push_back({"program", "random " + std::to_string(cases.size() + 1),
                     ncp::make_affine_mcp(std::move(problem), "program"), Vec::Zero(n), true, true});
  }
  return cases;
}

Case model_case(const std::string& path) {
  std::shared_ptr<const ncp::ampl::Model> model = ncp::ampl::read_model(path);
  Vec start = model->start();
  return {std::filesystem::path(path).stem().string(), "model", std::move(model), std::move(start), true, false};
}

std::vector<Case> starts_of(const Case& model, int count, std::uint64_t seed) {
  Numbers random(seed);
  const lcp::Box& box = model.mcp->box();
  const auto moved = [&](double share, double x) { return x + share * (1 + std::abs(x)) * random.uniform(-1, 1); };
  const auto at_bound = [&](Index i) {
    const bool low = box.has_lower(i) && (!box.has_upper(i) || random.uniform(0, 1) < 0.5);
    return low ? box.lower[i] : box.has_upper(i) ? box.upper[i] : model.x0[i];
  };
  static constexpr std::array<const char*, 4> kinds{"near", "far", "scaled", "bound"};
  std::vector<Case> cases;
  for (int k = 0; k < count; ++k) {
    const auto kind = static_cast<std::size_t>(k) % kinds.size();
    Vec x = model.x0;
    for (Index i = 0; i < x.size(); ++i) {
      if (kind == 0) x[i] = moved(0.1, x[i]);
      if (kind == 1) x[i] = moved(1, x[i]);
      if (kind == 2) x[i] *= std::pow(10, random.uniform(-1, 1));
      if (kind == 3 && random.uniform(0, 1) < 0.5) x[i] = at_bound(i);
    }
    cases.push_back({model.problem, std::string(kinds[kind]).append(" ").append(std::to_string(k / 4 + 1)), model.mcp,
                     lcp::project(box, x), model.solvable, true});
  }
  return cases;
}

ncp::Method method_called(std::string_view name) {
  if (const ncp::Preset* preset = ncp::find_preset(name)) return preset->method;
  std::string known;
  for (const ncp::Preset& preset : ncp::presets()) known.append(" ").append(preset.name);
  throw std::invalid_argument("there is no method '" + std::string(name) + "'; known:" + known);
}

}  // namespace perp::bench
