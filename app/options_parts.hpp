#pragma once
/// The parts of the table of options(). Private to app/.
#include <type_traits>
#include <utility>
#include <vector>

#include "app/options.hpp"

namespace perp::app {

/// Of the program, the limits, searches and pivoting.
std::vector<Option> general_options();
/// Of PathSearch alone.
std::vector<Option> path_search_options();
/// Of SemismoothNewton, Smoothing, InteriorPoint and Multiroot alone: the C-function, the smoothing, the path.
std::vector<Option> reformulation_options();
/// PATH's output switches.
std::vector<Option> output_options();

/// An enumeration's word.
template <class E>
Word word(E& target, std::span<const Choice> choices) {
  return {choices, [&target] { return static_cast<int>(target); },
          [&target](int value) { target = static_cast<E>(value); }};
}

}  // namespace perp::app
