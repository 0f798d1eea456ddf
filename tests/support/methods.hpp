#pragma once
/// The methods, each with the name tests report.
#include <string>
#include <vector>

#include "ncp/solve.hpp"

namespace perp::support {

struct NamedMethod {
  std::string name;
  ncp::Method method;
};

inline std::vector<NamedMethod> methods(const ncp::Stop& stop = {}, const ncp::Escape& escape = {}) {
  return {{"semismooth, Fischer-Burmeister", ncp::SemismoothNewton{.stop = stop, .escape = escape}},
          {"semismooth, min", ncp::SemismoothNewton{.stop = stop, .cfunction = ncp::natural_min(), .escape = escape}},
          {"josephy", ncp::NewtonJosephy{.stop = stop, .escape = escape}}};
}

/// Without proximal escapes: they end where they are stuck.
inline std::vector<NamedMethod> methods_without_escape(const ncp::Stop& stop = {}) {
  return methods(stop, {.rounds = 0});
}

}  // namespace perp::support
