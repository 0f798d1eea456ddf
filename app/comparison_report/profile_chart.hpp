// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Profiles as inline SVG: steps over a logarithmic axis, told apart by colour (Okabe & Ito's palette without yellow),
/// dashes, markers and a label at the end of each.
#include <string>
#include <vector>

#include "app/findings/profiles.hpp"

namespace perp::app::comparison {

struct ChartCurve {
  std::string id{};  ///< of its group in the page
  std::string label{};
  std::size_t style = 0;  ///< colour style % 7, dashes style % 4, marker style % 8: 56 that differ
  bool muted = false;     ///< thin and grey until it is asked for
  Profile profile{};
};

struct ChartAxes {
  std::string title{};
  std::string x{};
  bool ratios = true;  ///< x starts at 1 and has powers of 2; otherwise decimal
};

std::string profile_chart(const ChartAxes& axes, const std::vector<ChartCurve>& curves);

/// A short piece of the line of a style with its marker, for the list of names.
std::string line_sample(std::size_t style);

}  // namespace perp::app::comparison
