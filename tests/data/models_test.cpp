// SPDX-License-Identifier: Apache-2.0
/// The models of data/models, from file to solution: each method must find what data/models/reference.py, which shares
/// no line with the library, wrote to MODEL.sol.json. Catches a row paired with the wrong variable, a lost constant, a
/// bound read on the wrong side, a wrong derivative - everything between the .nl file and the answer.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>

#include "ncp/ampl/model.hpp"
#include "ncp/strategy/solve.hpp"

namespace perp::ncp {
namespace {

const std::filesystem::path folder = std::filesystem::path(PERP_SOURCE_DIR) / "data" / "models";

Method method_called(const std::string& method) {
  if (method == "path") return path();
  if (method == "semismooth") return SemismoothNewton{};
  return NewtonJosephy{};
}

class DataModels : public testing::TestWithParam<std::tuple<std::string, std::string>> {};

TEST_P(DataModels, SolvedAtTheReference) {
  const auto& [stub, method] = GetParam();
  const auto model = ampl::read_model((folder / (stub + ".nl")).string());
  const Result result = solve(*model, model->start(), method_called(method));
  ASSERT_TRUE(result.solved()) << result;

  std::ifstream file(folder / (stub + ".sol.json"));
  const auto reference = nlohmann::json::parse(file);
  // Any plan of shipments of least cost will do.
  const auto determined = [&, name = stub](const std::string& variable) {
    return name != "spatial" || variable.rfind("flow[", 0) != 0;
  };
  for (Index i = 0; i < model->n_var(); ++i) {
    if (!determined(model->variable_name(i))) continue;
    const double expected = reference.at(model->variable_name(i)).get<double>();
    EXPECT_NEAR(result.x[i], expected, 1e-6 * std::max(1.0, std::abs(expected))) << model->variable_name(i);
  }
}

TEST(DataModels, NamesAndSizes) {
  const auto model = ampl::read_model((folder / "cases.nl").string());
  EXPECT_EQ(model->n_var(), 11);
  // Two one-sided rows, one range (one y for each side), and the lower bound of `bounded`, which an equation
  // determines.
  EXPECT_EQ(model->side_inequalities(), 5);
  EXPECT_EQ(model->equation_name(1), "F_at_lower");  // of the variable in second place
  EXPECT_FALSE(model->has_objective());
}

INSTANTIATE_TEST_SUITE_P(All, DataModels,
                         testing::Combine(testing::Values("energy", "cournot", "harberger", "harberger-benchmark",
                                                          "cases", "economy", "spatial", "streets", "growth"),
                                          testing::Values("path", "semismooth", "josephy")),
                         [](const auto& combination) {
                           std::string name = std::get<0>(combination.param) + "_" + std::get<1>(combination.param);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace perp::ncp
