// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <new>

#include "ncp/ampl/memory_stream.hpp"

namespace perp::ncp::ampl {

Messages::Messages() : stream_(open_memstream(&text_, &size_)) {
  if (stream_ == nullptr) throw std::bad_alloc();
}

Messages::~Messages() {
  std::fclose(stream_);
  std::free(text_);
}

std::string Messages::text() const {
  std::fflush(stream_);
  return on_one_line({text_, size_});
}

std::FILE* stream_of(std::string_view bytes) {
  std::FILE* stream = fmemopen(const_cast<char*>(bytes.data()), bytes.size(), "rb");
  if (stream == nullptr) throw std::bad_alloc();
  return stream;
}

}  // namespace perp::ncp::ampl
