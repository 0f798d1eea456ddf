// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A picture of a run: merit and residual against the iterations; and of one iteration of PathSearch, the merit along
/// the way of its linearised problem, with every kink (pivot) and the point that was accepted.
#include <optional>
#include <string>

#include "app/problem/kept_way.hpp"
#include "app/report/report.hpp"

namespace perp::app {

/// One SVG that needs nothing else. `way`: a WayKeeper's, if it kept one.
std::string plot_svg(const Report& report, const std::optional<KeptWay>& way);

}  // namespace perp::app
