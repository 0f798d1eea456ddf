// SPDX-License-Identifier: Apache-2.0
#include "ncp/ampl/memory_stream.hpp"

namespace perp::ncp::ampl {

std::string on_one_line(std::string text) {
  for (char& c : text)
    if (c == '\n' || c == '\t' || c == '\r') c = ' ';
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

}  // namespace perp::ncp::ampl
