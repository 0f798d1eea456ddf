// SPDX-License-Identifier: Apache-2.0
#include "app/text/plot_layout.hpp"

namespace perp::app {

namespace {
constexpr double character = 8.3;  // of 14 px
constexpr double row = 24;
}  // namespace

void y_axis(Svg& svg, const Panel& panel, const Scale& scale, std::string_view name) {
  for (const Scale::Tick& tick : scale.ticks(9)) {
    const double y = scale(tick.value);
    svg.line("grid", {panel.left, y}, {panel.right, y});
    svg.line("tick", {panel.left - 5, y}, {panel.left, y});
    svg.text("small", {panel.left - 9, y + 4}, tick.label, Svg::Anchor::End);
  }
  if (!name.empty()) svg.text("", {28, (panel.top + panel.bottom) / 2}, name, Svg::Anchor::Middle, -90);
}

Pixel Legend::place(double symbol, std::string_view words) {
  const double needs = symbol + 8 + character * static_cast<double>(words.size());
  if (at_.x > left_ && at_.x + needs > right_) at_ = {left_, at_.y + row};
  const Pixel here{at_.x + symbol + 8, at_.y};
  at_.x += needs + 22;
  return here;
}

void Legend::line(std::string_view css, std::string_view words) {
  const Pixel text = place(36, words);
  svg_.line(css, {text.x - 44, text.y - 5}, {text.x - 8, text.y - 5});
  svg_.text("", text, words);
}

void Legend::box(std::string_view css, std::string_view words) {
  const Pixel text = place(20, words);
  svg_.rectangle(css, {text.x - 28, text.y - 13}, 20, 16);
  svg_.rectangle("frame", {text.x - 28, text.y - 13}, 20, 16);
  svg_.text("", text, words);
}

void Legend::marker(std::string_view css, Svg::Marker shape, std::string_view words) {
  const Pixel text = place(12, words);
  svg_.marker(std::string(css) + " legend", shape, {text.x - 14, text.y - 5}, 5);
  svg_.text("", text, words);
}

void Legend::words(std::string_view words) { svg_.text("", place(0, words), words); }

std::string shortened(std::string_view text, std::size_t length) {
  if (text.size() <= length) return std::string(text);
  const std::size_t half = (length - 3) / 2;
  return std::string(text.substr(0, half)) + "..." + std::string(text.substr(text.size() - half));
}

}  // namespace perp::app
