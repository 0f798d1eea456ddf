// The catalogue as a whole.
#include <gtest/gtest.h>

#include <set>

#include "ncp/collection/collection.hpp"

namespace {

using namespace perp::ncp::collection;

// Catches: two problems under one name, of which find() would hide the second.
TEST(Catalogue, NamesAreUnique) {
  std::set<std::string_view> names;
  for (const Entry& entry : entries()) EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
}

}  // namespace
