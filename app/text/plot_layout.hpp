// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Panels, axes and legends of drawings. Private to app/.
#include <string>
#include <string_view>

#include "app/text/svg.hpp"

namespace perp::app {

struct Panel {
  double left, right, top, bottom;
  constexpr double width() const { return right - left; }
  constexpr double height() const { return bottom - top; }
  constexpr double middle() const { return (left + right) / 2; }
};

/// Ticks and grid lines on the left, and its name if it has one.
void y_axis(Svg& svg, const Panel& panel, const Scale& scale, std::string_view name);

/// Entries in rows from `at` on, no further than `right`.
class Legend {
 public:
  Legend(Svg& svg, Pixel at, double right) : svg_(svg), at_(at), left_(at.x), right_(right) {}
  void line(std::string_view css, std::string_view words);
  void box(std::string_view css, std::string_view words);
  void marker(std::string_view css, Svg::Marker shape, std::string_view words);
  void words(std::string_view words);

 private:
  /// Begins an entry with a symbol of that width; where its words go.
  Pixel place(double symbol, std::string_view words);
  Svg& svg_;
  Pixel at_;
  double left_, right_;
};

/// At most `length` characters, the middle left out.
std::string shortened(std::string_view text, std::size_t length);

}  // namespace perp::app
