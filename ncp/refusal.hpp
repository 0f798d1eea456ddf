#pragma once
/// The sentence that refuses an option's value; private to ncp/.
#include <sstream>
#include <string>

namespace perp::ncp {

template <class Value>
std::string refusal(const char* option, const Value& value, const char* range) {
  std::ostringstream why;
  why << option << " is " << value << "; it must be " << range;
  return why.str();
}

}  // namespace perp::ncp
