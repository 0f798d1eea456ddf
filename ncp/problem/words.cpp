#include "ncp/problem/words.hpp"

#include <sstream>

namespace perp::ncp {

std::string number(double value) {
  std::ostringstream text;
  text.precision(4);
  text << value;
  return text.str();
}

std::string quantity(Index n, std::string_view noun) {
  return std::to_string(n).append(" ").append(noun).append(n == 1 ? "" : "s");
}

}  // namespace perp::ncp
