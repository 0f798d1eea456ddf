// SPDX-License-Identifier: Apache-2.0
#include "ncp/ampl/names.hpp"

#include <algorithm>
#include <fstream>

#include "lcp/io/file_error.hpp"
#include "lcp/io/file_path.hpp"

namespace perp::ncp::ampl {
namespace {

std::vector<std::string> read_lines(const std::string& path, int at_most) {
  std::vector<std::string> lines;
  std::ifstream file(lcp::file_path(path));
  file.exceptions(std::ios::badbit);  // else want of memory would be the end of the file
  try {
    for (std::string line; static_cast<int>(lines.size()) < at_most && std::getline(file, line);
         lines.push_back(line)) {
      if (!line.empty() && line.back() == '\r') line.pop_back();
      if (lines.empty()) line = std::string(lcp::without_utf8_mark(line));
    }
  } catch (const std::ios::failure&) {  // as far as it can be read
  }
  return lines;
}

std::string name(const std::vector<std::string>& names, int i, const char* otherwise) {
  const auto k = static_cast<std::size_t>(i);
  return k < names.size() && !names[k].empty() ? names[k] : otherwise + std::to_string(i + 1) + "]";
}

}  // namespace

Names::Names(const std::string& stub, int n_var, int n_con)
    : variables_(read_lines(stub + ".col", n_var)), rows_(read_lines(stub + ".row", n_con)) {
  const auto all_named = [](const std::vector<std::string>& names, int count) {
    return std::ssize(names) >= count && std::ranges::none_of(names, &std::string::empty);
  };
  complete_ = all_named(variables_, n_var) && all_named(rows_, n_con);
}

std::string Names::variable(int i) const { return name(variables_, i, "_svar["); }
std::string Names::row(int i) const { return name(rows_, i, "_scon["); }

std::string Names::list(const std::vector<std::string>& names) {
  constexpr std::size_t shown = 5;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), shown); ++i) text += (i == 0 ? "" : ", ") + names[i];
  if (names.size() > shown) text += " and " + std::to_string(names.size() - shown) + " more";
  return text;
}

}  // namespace perp::ncp::ampl
