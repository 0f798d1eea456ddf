// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Streams of C, which AMPL's library reads and prints to, over memory.
#include <cstdio>
#include <string>
#include <string_view>

namespace perp::ncp::ampl {

/// A stream that is printed to.
class Messages {
 public:
  Messages();
  Messages(const Messages&) = delete;
  Messages& operator=(const Messages&) = delete;
  ~Messages();
  std::FILE* stream() const { return stream_; }
  /// The text that was printed, on one line.
  std::string text() const;

 private:
  [[maybe_unused]] char* text_ = nullptr;  // of those over memory
  [[maybe_unused]] std::size_t size_ = 0;
  std::FILE* stream_;
};

/// A stream to read the bytes from, which must outlive it. Throws std::bad_alloc.
std::FILE* stream_of(std::string_view bytes);

/// Without its line ends, tabs, and the blanks at its end.
std::string on_one_line(std::string text);

}  // namespace perp::ncp::ampl
