// SPDX-License-Identifier: Apache-2.0
#include "lcp/io/file_path.hpp"

namespace perp::lcp {

std::filesystem::path file_path(const std::string& name) { return name; }

std::FILE* open_file(const std::string& name) { return std::fopen(name.c_str(), "rb"); }

}  // namespace perp::lcp
