#pragma once
/// The nonlinear methods by name, each a documented combination of ingredients. Eight carry the names of the systems
/// that Billups, Dirkse & Ferris (1997, Comput. Optim. Appl. 7, 3) compare: miles, path, nesqp, qpcomp, smooth, proxi,
/// semismooth, semicomp, with the parameters of their papers where those are for what the ingredients do. published()
/// has them without later additions (rescalings, other methods as restarts, ...), and PATH 4 with its own restarts.
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
