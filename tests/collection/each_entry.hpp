// SPDX-License-Identifier: Apache-2.0
#pragma once
// Tests over all entries of the collection.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "collection/collection.hpp"

namespace perp::ncp::collection {

/// The names, since test runners print parameters.
inline auto each_name() {
  std::vector<std::string_view> names;
  for (const Entry& entry : entries()) names.push_back(entry.name);
  return ::testing::ValuesIn(names);
}

inline std::string test_name(const ::testing::TestParamInfo<std::string_view>& tested) {
  std::string name(tested.param);
  std::ranges::replace(name, '-', '_');
  return name;
}

class EachEntry : public ::testing::TestWithParam<std::string_view> {
 protected:
  const Entry& entry = *find(GetParam());
};

}  // namespace perp::ncp::collection
