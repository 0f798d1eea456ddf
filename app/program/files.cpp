// SPDX-License-Identifier: Apache-2.0
#include "app/program/files.hpp"
#include "lcp/io/file_path.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <utility>

namespace perp::app {

namespace {

bool steers(std::string_view letter) {
  const auto first = static_cast<unsigned char>(letter[0]);
  if (letter.size() == 1) return (first < 0x20 && first != '\n' && first != '\t') || first == 0x7F;
  return letter.size() == 2 && first == 0xC2 && static_cast<unsigned char>(letter[1]) < 0xA0;  // C1
}

void append_bytes(std::string& text, std::string_view bytes) {
  for (const char c : bytes) text += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
}

/// The text up to its first letter that is not one of ASCII, or steers.
std::string_view plain_part(std::string_view text) {
  const auto plain = [](char c) { return (c >= ' ' && c <= '~') || c == '\n' || c == '\t'; };
  return text.substr(0, static_cast<std::size_t>(std::ranges::find_if_not(text, plain) - text.begin()));
}

/// What is before a character that is not whole yet, which stays in `text`.
std::string take_printable(std::string_view& text) {
  std::string shown;
  shown.reserve(text.size());
  while (!text.empty()) {
    if (const std::string_view plain = plain_part(text); !plain.empty()) {
      shown += plain;
      text.remove_prefix(plain.size());
      continue;
    }
    bool whole = true;
    const std::size_t length = utf8_character(text, whole);
    if (!whole) break;
    const std::string_view letter = text.substr(0, std::max<std::size_t>(length, 1));
    if (length == 0 || steers(letter))
      append_bytes(shown, letter);
    else
      shown += letter;
    text.remove_prefix(letter.size());
  }
  return shown;
}

std::string named(const FileUse& use) {
  return use.flag.empty() ? fmt::format("'{}'", use.path) : fmt::format("{} '{}'", use.flag, use.path);
}

void as_input_error(const std::function<void()>& work) {
  try {
    work();
  } catch (const lcp::FileError& error) {
    throw InputError(error.what());
  }
}

bool is_file(const FileUse& use) { return !use.path.empty() && use.path != "-"; }

}  // namespace

void write_file(const std::string& path, std::string_view content, lcp::Sync sync) {
  as_input_error([&] { lcp::write_file(path, content, sync); });
}

void check_writable(const std::string& path) {
  as_input_error([&] { lcp::check_writable(path); });
}

std::string read_text(const std::string& path) {
  std::ifstream file(lcp::file_path(path), std::ios::binary);
  std::ostringstream text;
  std::error_code ignored;
  if (!file && std::filesystem::exists(lcp::file_path(path), ignored)) throw input_error("'{}' cannot be read", path);
  if (file && file.peek() != std::ifstream::traits_type::eof()) text << file.rdbuf();
  if (file.bad() || !text) throw input_error("'{}' cannot be read", path);
  return std::move(text).str();
}

void check_apart(std::span<const FileUse> outputs, std::span<const FileUse> inputs) {
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    const FileUse& output = outputs[k];
    if (!is_file(output) || !lcp::replaces(output.path)) continue;
    const auto same = [&](const FileUse& other) { return is_file(other) && lcp::same_file(output.path, other.path); };
    if (const auto input = std::ranges::find_if(inputs, same); input != inputs.end())
      throw input_error("{}: that is the input {}, which would be lost", named(output), named(*input));
    const auto others = outputs.first(k);
    if (const auto other = std::ranges::find_if(others, same); other != others.end())
      throw input_error("{}: that is the output {}, too", named(output), named(*other));
  }
}

void check_outputs(std::span<const FileUse> outputs, std::span<const FileUse> inputs) {
  check_apart(outputs, inputs);
  for (const FileUse& output : outputs)
    if (is_file(output)) check_writable(output.path);
}

bool outputs_fit(std::span<const FileUse> outputs, std::span<const FileUse> inputs, Streams streams) {
  try {
    check_outputs(outputs, inputs);
    return true;
  } catch (const InputError& error) {
    streams.err << "perp: " << error.what() << '\n';
    return false;
  }
}

std::size_t utf8_character(std::string_view text, bool& whole) {
  whole = true;
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xC2 && first < 0xE0   ? 2
                             : first >= 0xE0 && first < 0xF0 ? 3
                             : first >= 0xF0 && first < 0xF5 ? 4
                                                             : 0;
  for (std::size_t k = 1; k < length; ++k) {
    if (k == text.size()) {
      whole = false;
      return 0;
    }
    // Not the longer forms of shorter ones, no halves of pairs, nothing beyond the last character.
    const unsigned least = k == 1 && first == 0xE0 ? 0xA0 : k == 1 && first == 0xF0 ? 0x90 : 0x80;
    const unsigned most = k == 1 && first == 0xED ? 0x9F : k == 1 && first == 0xF4 ? 0x8F : 0xBF;
    if (byte(k) < least || byte(k) > most) return 0;
  }
  return length;
}

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    bool whole = true;
    const std::size_t length = utf8_character(text, whole);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

std::string printable(std::string_view text) {
  std::string shown = take_printable(text);
  append_bytes(shown, text);
  return shown;
}

PrintableStream::PrintableStream(std::ostream& stream)
    : stream_(stream), raw_(stream.rdbuf()), buffer_(stream.rdbuf()) {
  stream_.rdbuf(&buffer_);
}

PrintableStream::~PrintableStream() {
  const std::ios::iostate state = stream_.rdstate();
  buffer_.end();
  stream_.rdbuf(raw_.rdbuf());  // which clears the state
  stream_.setstate(state);
}

std::streambuf::int_type PrintableStream::Buffer::overflow(int_type c) {
  if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
  const char letter = traits_type::to_char_type(c);
  return put({&letter, 1}) ? c : traits_type::eof();
}

std::streamsize PrintableStream::Buffer::xsputn(const char* text, std::streamsize size) {
  return put({text, static_cast<std::size_t>(size)}) ? size : 0;
}

int PrintableStream::Buffer::sync() { return to_->pubsync(); }

void PrintableStream::Buffer::end() {
  const std::string shown = printable(begun_);
  to_->sputn(shown.data(), static_cast<std::streamsize>(shown.size()));
  begun_.clear();
}

bool PrintableStream::Buffer::put(std::string_view text) {
  if (begun_.empty() && plain_part(text).size() == text.size()) {
    const auto all = static_cast<std::streamsize>(text.size());
    return to_->sputn(text.data(), all) == all;
  }
  begun_ += text;
  std::string_view rest = begun_;
  const std::string shown = take_printable(rest);
  begun_ = std::string(rest);
  const auto size = static_cast<std::streamsize>(shown.size());
  return to_->sputn(shown.data(), size) == size;
}

}  // namespace perp::app
