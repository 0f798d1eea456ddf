// SPDX-License-Identifier: Apache-2.0
/// C has no streams over memory: these are temporary files without a name.
#include <new>

#include "ncp/ampl/memory_stream.hpp"

namespace perp::ncp::ampl {

Messages::Messages() : stream_(std::tmpfile()) {
  if (stream_ == nullptr) throw std::bad_alloc();
}

Messages::~Messages() { std::fclose(stream_); }

std::string Messages::text() const {
  const long size = std::ftell(stream_);
  std::string text(size > 0 ? static_cast<std::size_t>(size) : 0, '\0');
  std::rewind(stream_);
  text.resize(std::fread(text.data(), 1, text.size(), stream_));
  std::fseek(stream_, 0, SEEK_END);  // where the next message goes
  return on_one_line(std::move(text));
}

std::FILE* stream_of(std::string_view bytes) {
  std::FILE* stream = std::tmpfile();
  if (stream == nullptr) throw std::bad_alloc();
  if (std::fwrite(bytes.data(), 1, bytes.size(), stream) != bytes.size()) {
    std::fclose(stream);
    throw std::bad_alloc();
  }
  std::rewind(stream);
  return stream;
}

}  // namespace perp::ncp::ampl
