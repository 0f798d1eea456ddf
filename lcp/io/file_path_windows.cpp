// SPDX-License-Identifier: Apache-2.0
#include "lcp/io/file_path.hpp"

namespace perp::lcp {

std::filesystem::path file_path(const std::string& name) {
  try {
    return std::u8string(name.begin(), name.end());
  } catch (const std::filesystem::filesystem_error&) {  // no UTF-8: Windows has no file of that name
    return {};
  }
}

std::FILE* open_file(const std::string& name) { return _wfopen(file_path(name).c_str(), L"rb"); }

}  // namespace perp::lcp
