// SPDX-License-Identifier: Apache-2.0
#include "ncp/ampl/nl_tokens.hpp"

#include <array>
#include <bit>
#include <cerrno>
#include <charconv>
#include <climits>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "lcp/io/file_path.hpp"
#include "ncp/ampl/model.hpp"

namespace perp::ncp::ampl {
namespace {

static_assert(std::endian::native == std::endian::little, "binary .nl files are read as little-endian");

constexpr std::size_t max_file = std::size_t{1} << 30;
constexpr std::size_t max_line = 79;  // AMPL's library keeps that much of a line and drops the rest
constexpr std::size_t max_word = 127;

std::string printable(std::string_view text) {
  std::string shown;
  for (char c : text.substr(0, 40)) shown += c >= ' ' && c <= '~' ? c : '?';
  if (text.size() > 40) shown += "...";
  return "\"" + shown + "\"";
}

// from_chars calls both overflow and underflow "out of range".
bool underflows(std::string_view token) {
  const std::size_t e = token.find_first_of("eE");
  if (e != std::string_view::npos && e + 1 < token.size()) return token[e + 1] == '-';
  return token.substr(0, token.find('.')).find_first_of("123456789") == std::string_view::npos;
}

}  // namespace

std::string number(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

std::string read_file(const std::string& path) {
  const auto refuse = [&](const std::string& why) { throw ModelError(bad_file, path + ": " + why); };
  const std::filesystem::path file = lcp::file_path(path);
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) refuse("cannot be opened: " + error.message());
  if (std::filesystem::is_directory(status)) refuse("is a directory, not an .nl file");
  if (!std::filesystem::is_regular_file(status)) refuse("is not a regular file");
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) refuse("cannot be read: " + error.message());
  if (size > max_file) refuse("is larger than 1 GiB, the most this reader takes");
  std::ifstream in(file, std::ios::binary);
  if (!in) refuse(std::string("cannot be opened: ") + std::strerror(errno));
  std::string bytes(static_cast<std::size_t>(size), '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (in.bad()) refuse(std::string("cannot be read: ") + std::strerror(errno));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  if (bytes.empty()) refuse("is empty");
  return bytes;
}

std::string NlTokens::at(Place place) const {
  return binary_ ? file_ + ": byte " + std::to_string(place) : file_ + ":" + std::to_string(place);
}

void NlTokens::fail(const std::string& reason) const { throw ModelError(bad_file, at(place()) + ": " + reason); }

void NlTokens::open_line() {
  if (at_end()) fail("early end of file");
  ++line_;
  const std::size_t end = bytes_.find_first_of("\r\n", pos_);
  if (end == std::string_view::npos) {
    pos_ = bytes_.size();
    fail("early end of file: the line has no end");
  }
  rest_ = bytes_.substr(pos_, end - pos_);
  column_ = 0;
  pos_ = end;
  while (pos_ < bytes_.size() && bytes_[pos_] == '\r') ++pos_;
  if (pos_ < bytes_.size() && bytes_[pos_] == '\n') ++pos_;
}

const char* NlTokens::take_bytes(std::size_t n) {
  if (bytes_.size() - pos_ < n) {
    item_ = bytes_.size();
    fail("early end of file");
  }
  const char* here = bytes_.data() + pos_;
  pos_ += n;
  return here;
}

template <class T>
T NlTokens::take() {
  T value{};
  std::memcpy(&value, take_bytes(sizeof value), sizeof value);
  return value;
}

char NlTokens::kind() {
  item_ = pos_;
  if (binary_) return take<char>();
  open_line();
  if (rest_.empty()) fail("blank line");
  const char first = rest_.front();
  rest_.remove_prefix(1);
  column_ = 1;
  return first;
}

void NlTokens::item() {
  item_ = pos_;
  if (!binary_) open_line();
}

std::string_view NlTokens::field(std::string_view what) {
  const std::size_t begin = std::min(rest_.find_first_not_of(' '), rest_.size());
  rest_.remove_prefix(begin);
  const std::size_t length = std::min(rest_.find_first_of(" \t"), rest_.size());
  column_ += begin + length;
  const std::string_view token = rest_.substr(0, length);
  if (token.empty() || token.front() == '#') fail("expected " + std::string(what) + ", found the end of the line");
  if (column_ > max_line) fail(std::string(what) + " lies beyond the 79th character of its line");
  rest_.remove_prefix(length);
  return token;
}

int NlTokens::integer(std::string_view what, int min, int max) {
  int value = 0;
  if (binary_) {
    value = take<int>();
  } else {
    const std::string_view token = field(what);
    const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
    if (error == std::errc::result_out_of_range) fail(std::string(what) + " is " + printable(token) + ", too large");
    if (error != std::errc{} || end != token.data() + token.size())
      fail("expected " + std::string(what) + ", an integer, found " + printable(token));
  }
  if (value < min || value > max) {
    fail(std::string(what) + " is " + std::to_string(value) +
         (max < min        ? ", but there is none"
          : max == INT_MAX ? ", which is less than " + std::to_string(min)
                           : ", not in " + std::to_string(min) + ".." + std::to_string(max)));
  }
  return value;
}

double NlTokens::real(std::string_view what) {
  double value = 0;
  std::string shown;
  if (binary_) {
    value = take<double>();
    shown = number(value);
  } else {
    const std::string_view token = field(what);
    const std::string_view digits = token.front() == '+' ? token.substr(1) : token;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error == std::errc::invalid_argument || end != token.data() + token.size() ||
        (token.front() == '+' && digits.front() == '-'))
      fail("expected " + std::string(what) + ", a number, found " + printable(token));
    if (error == std::errc::result_out_of_range) value = underflows(digits) ? 0 : infinity;
    shown = token;
  }
  if (!std::isfinite(value)) fail(std::string(what) + " is " + shown + ", not a finite number");
  return value;
}

double NlTokens::literal(std::string_view what) { return literal(kind(), what); }

double NlTokens::literal(char kind, std::string_view what) {
  double value = 0;
  if (kind == 'n') {
    value = real(what);
  } else if (kind == 'l') {
    value = integer(what, INT_MIN, INT_MAX);
  } else if (kind == 's' && binary_) {  // AMPL's library ends the process over one in a text file
    value = take<short>();
  } else {
    fail("expected " + std::string(what) + ", a number (n), found " + printable({&kind, 1}));
  }
  close();
  return value;
}

std::string NlTokens::word(std::string_view what) {
  std::string text;
  if (binary_) {
    const int length = integer("the length of " + std::string(what), 1, static_cast<int>(max_word));
    text.assign(take_bytes(static_cast<std::size_t>(length)), static_cast<std::size_t>(length));
  } else {
    text = field(what);
  }
  for (char c : text) {
    if (c <= ' ' || c > '~') fail(std::string(what) + " is " + printable(text) + ", not a name");
  }
  return text;
}

bool NlTokens::line_ends() const {
  const std::size_t next = rest_.find_first_not_of(" \t");
  return next == std::string_view::npos || rest_[next] == '#';
}

void NlTokens::close() {
  if (!binary_ && !line_ends()) fail("unexpected " + printable(rest_.substr(rest_.find_first_not_of(" \t"))));
}

char NlTokens::header_kind(std::string_view kinds) {
  open_line();
  if (rest_.starts_with("\xEF\xBB\xBF"))
    fail("it begins with a UTF-8 byte order mark, which .nl files do not have: write the file without it");
  if (rest_.empty() || kinds.find(rest_.front()) == std::string_view::npos)
    fail("not an .nl file: it has to begin with g (text) or b (binary), found " + printable(rest_.substr(0, 12)));
  const char kind = rest_.front();
  rest_.remove_prefix(1);
  column_ = 1;
  return kind;
}

std::vector<int> NlTokens::header_integers(std::string_view what) {
  std::vector<int> values;
  while (!line_ends()) {
    const std::size_t begin = rest_.find_first_not_of(" \t");
    const std::size_t end = std::min(rest_.find_first_of(" \t", begin), rest_.size());
    const std::string_view token = rest_.substr(begin, end - begin);
    int value = 0;
    const auto [last, error] = std::from_chars(token.data(), token.data() + token.size(), value);
    if (error != std::errc{} || last != token.data() + token.size()) break;
    rest_.remove_prefix(end);
    column_ += end;
    if (column_ > max_line) fail("header (" + std::string(what) + "): the line is too long");
    values.push_back(value);
  }
  return values;
}

}  // namespace perp::ncp::ampl
