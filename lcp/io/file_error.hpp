// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Why a file is refused: "file:line: reason".
#include <stdexcept>
#include <string>
#include <string_view>

namespace perp::lcp {

class FileError : public std::runtime_error {
 public:
  /// line from 1; 0: the file as a whole.
  FileError(const std::string& file, long line, const std::string& reason)
      : std::runtime_error(line > 0 ? file + ":" + std::to_string(line) + ": " + reason : file + ": " + reason) {}
};

/// The text without the UTF-8 byte order mark that some editors put before it.
inline std::string_view without_utf8_mark(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  return text;
}
/// The same. Throws FileError for UTF-16.
std::string_view without_mark(std::string_view text, const std::string& file);

/// The whole file as text. Throws FileError if it cannot be read, naming the system's reason.
std::string read_file(const std::string& path);

}  // namespace perp::lcp
