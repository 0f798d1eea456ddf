// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The tokens of an .nl file. Text ("g"): an item is one line, an optional kind character and fields separated by
/// blanks, then perhaps a comment that begins with #. Binary ("b"): ten text lines of header, then kind characters,
/// 32-bit integers and doubles without separators, little-endian (Gay, "Writing .nl files", 2005).
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace perp::ncp::ampl {

/// For messages: the line of a text file, the byte offset of a binary one.
using Place = std::size_t;

/// Shortest decimal form that reads back as the same double.
std::string number(double value);

/// The whole of a regular file. Throws ModelError with the reason if it cannot be read or is larger than 1 GiB.
std::string read_file(const std::string& path);

/// A cursor. Everything that is not the token asked for throws ModelError(bad_file) with file, place, name and value.
class NlTokens {
 public:
  NlTokens(std::string file, std::string_view bytes) : file_(std::move(file)), bytes_(bytes) {}

  bool binary() const { return binary_; }
  bool at_end() const { return pos_ == bytes_.size(); }
  std::size_t offset() const { return pos_; }
  /// What follows is binary; to be called where the header ends.
  void switch_to_binary() { binary_ = true; }

  char kind();  ///< opens an item that begins with a character and returns that
  void item();  ///< opens an item of fields only
  int integer(std::string_view what, int min, int max);
  double real(std::string_view what);                ///< finite
  double literal(std::string_view what);             ///< an item "n" real, "l" long or "s" short
  double literal(char kind, std::string_view what);  ///< the same, its kind already read
  std::string word(std::string_view what);           ///< a name of at most 127 characters
  void close();                                      ///< of an item: nothing but a comment may follow its fields

  char header_kind(std::string_view kinds);                 ///< opens the first line, which begins with one of `kinds`
  std::vector<int> header_integers(std::string_view what);  ///< all integers at the front of the open line
  bool line_ends() const;                                   ///< has the open line nothing but a comment left?
  void header_line() { open_line(); }

  Place place() const { return binary_ ? item_ : line_; }
  std::string at(Place place) const;  ///< "FILE:LINE" or "FILE: byte OFFSET"
  [[noreturn]] void fail(const std::string& reason) const;

 private:
  void open_line();
  std::string_view field(std::string_view what);  ///< the next field of the line, not empty
  template <class T>
  T take();
  const char* take_bytes(std::size_t n);

  std::string file_;
  std::string_view bytes_;
  std::size_t pos_ = 0;   ///< first byte not yet consumed
  std::size_t item_ = 0;  ///< where the item began
  bool binary_ = false;
  std::size_t line_ = 0;    ///< number of the open line
  std::string_view rest_;   ///< what is left of it
  std::size_t column_ = 0;  ///< characters of it consumed
};

}  // namespace perp::ncp::ampl
