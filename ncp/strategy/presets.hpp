// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The nonlinear methods by name. Eight have the names of the systems that Billups, Dirkse & Ferris (1997, Comput.
/// Optim. Appl. 7, 3) compare: miles, path, nesqp, qpcomp, smooth, proxi, semismooth, semicomp. Their parameters are
/// those of the papers, as far as these apply. published() has these systems without later additions (rescalings, other
/// methods as restarts, ...), and PATH 4 with its own restarts.
#include <span>
#include <string_view>

#include "ncp/strategy/solve.hpp"

namespace perp::ncp {

struct Preset {
  std::string_view name;
  std::string_view what;  ///< one line
  std::string_view reference;
  Method method;
};

std::span<const Preset> presets();
std::span<const Preset> published();
const Preset* find_preset(std::string_view name);  ///< of both; nullptr if there is none

}  // namespace perp::ncp
