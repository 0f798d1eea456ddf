#pragma once
/// `perp list`: the collection.
#include <string>
#include <vector>

#include "app/program/program.hpp"

namespace perp::app {

struct ListRequest {
  std::string name{};                  ///< "" for the table of all
  std::vector<std::string> classes{};  ///< of these alone; each may be several, comma-separated; empty: of all
  bool json = false;
};

/// Exit code 2 with a suggestion for a name or class that does not exist.
ExitCode list(const ListRequest& request, Streams streams);

}  // namespace perp::app
