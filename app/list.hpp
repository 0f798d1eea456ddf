#pragma once
/// `perp list`: the collection.
#include <string>

#include "app/program.hpp"

namespace perp::app {

struct ListRequest {
  std::string name{};  ///< "" for the table of all
  bool json = false;
};

ExitCode list(const ListRequest& request, Streams streams);

}  // namespace perp::app
