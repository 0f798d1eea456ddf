#pragma once
/// What keeps cells of two campaigns apart: lines such as "--tol: 1e-08 there, 1e-06 here".
#include <fmt/format.h>

#include <string>
#include <vector>

namespace perp::app::compare {

/// Names that only one of them has.
void compare_names(const char* what, const std::vector<std::string>& before, const std::vector<std::string>& now,
                   std::vector<std::string>& found);

template <class T>
void compare_value(const std::string& what, const T& before, const T& now, std::vector<std::string>& found) {
  if (before != now) found.push_back(fmt::format("{}: {} there, {} here", what, before, now));
}

}  // namespace perp::app::compare
