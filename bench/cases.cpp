// SPDX-License-Identifier: Apache-2.0
#include "cases.hpp"

#include <filesystem>
#include <random>
#include <stdexcept>
#include <utility>

#include "ncp/ampl/model.hpp"
#include "ncp/collection/collection.hpp"
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

Case model_case(const std::string& path) {
  std::shared_ptr<const ncp::ampl::Model> model = ncp::ampl::read_model(path);
  Vec start = model->start();
  return {std::filesystem::path(path).stem().string(), "model", std::move(model), std::move(start), true, false};
}

ncp::Method method_called(std::string_view name) {
  if (const ncp::Preset* preset = ncp::find_preset(name)) return preset->method;
  std::string known;
  for (const ncp::Preset& preset : ncp::presets()) known.append(" ").append(preset.name);
  throw std::invalid_argument("there is no method '" + std::string(name) + "'; known:" + known);
}

}  // namespace perp::bench
