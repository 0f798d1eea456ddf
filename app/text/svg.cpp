// SPDX-License-Identifier: Apache-2.0
#include "app/text/svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace perp::app {

namespace {

bool finite(const Pixel& p) { return std::isfinite(p.x) && std::isfinite(p.y); }

/// 1, 2, 2.5 or 5 times a power of ten, not less than `least`.
double round_step(double least) {
  const double power = std::pow(10, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 2.5, 5.0})
    if (factor * power >= least * (1 - 1e-9)) return factor * power;
  return 10 * power;
}

}  // namespace

std::string_view entity(char c) {
  switch (c) {
    case '&':
      return "&amp;";
    case '<':
      return "&lt;";
    case '>':
      return "&gt;";
    case '"':
      return "&quot;";
    case '\'':
      return "&#39;";
    default:
      return "";
  }
}

std::string xml_text(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (const std::string_view other = entity(c); !other.empty())
      result += other;
    else
      result += c >= ' ' && c <= '~' ? c : '?';
  }
  return result;
}

Svg::Svg(int width, int height, std::string_view title, std::string_view style)
    : body_(
          fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
                      "role=\"img\">\n<title>{2}</title>\n<style>{3}</style>\n"
                      "<rect x=\"0\" y=\"0\" width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>\n",
                      width, height, xml_text(title), style)) {}

void Svg::line(std::string_view css, Pixel a, Pixel b) {
  body_ += fmt::format("<line class=\"{}\" x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\"/>\n", css, a.x, a.y,
                       b.x, b.y);
}

void Svg::polyline(std::string_view css, const std::vector<Pixel>& points) {
  for (std::size_t k = 0; k < points.size();) {
    std::string list;
    std::size_t length = 0;
    for (; k < points.size() && finite(points[k]); ++k, ++length)
      list += fmt::format("{}{:.2f},{:.2f}", length == 0 ? "" : " ", points[k].x, points[k].y);
    if (length > 1) body_ += fmt::format("<polyline class=\"{}\" points=\"{}\"/>\n", css, list);
    while (k < points.size() && !finite(points[k])) ++k;
  }
}

void Svg::rectangle(std::string_view css, Pixel corner, double width, double height) {
  body_ += fmt::format("<rect class=\"{}\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\"/>\n", css,
                       corner.x, corner.y, width, height);
}

void Svg::text(std::string_view css, Pixel at, std::string_view words, Anchor anchor, int degrees) {
  const char* name = anchor == Anchor::Start ? "start" : anchor == Anchor::Middle ? "middle" : "end";
  const std::string turned =
      degrees == 0 ? "" : fmt::format(" transform=\"rotate({} {:.2f} {:.2f})\"", degrees, at.x, at.y);
  body_ += fmt::format("<text class=\"{}\" x=\"{:.2f}\" y=\"{:.2f}\" text-anchor=\"{}\"{}>{}</text>\n", css, at.x, at.y,
                       name, turned, xml_text(words));
}

void Svg::marker(std::string_view css, Marker shape, Pixel at, double radius, std::string_view tip) {
  if (!finite(at)) return;
  const std::string inside = tip.empty() ? "" : fmt::format("<title>{}</title>", xml_text(tip));
  const auto polygon = [&](std::initializer_list<Pixel> corners) {
    std::string path;
    for (const Pixel& corner : corners)
      path +=
          fmt::format("{}{:.2f} {:.2f} ", path.empty() ? 'M' : 'L', at.x + radius * corner.x, at.y + radius * corner.y);
    body_ += fmt::format("<path class=\"{}\" d=\"{}Z\">{}</path>\n", css, path, inside);
  };
  const double r = radius;
  switch (shape) {
    case Marker::Dot:
    case Marker::Ring:
      body_ += fmt::format("<circle class=\"{}{}\" cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:.2f}\">{}</circle>\n", css,
                           shape == Marker::Ring ? " hollow" : "", at.x, at.y, r, inside);
      return;
    case Marker::Diamond:
      return polygon({{0, -1.3}, {1.3, 0}, {0, 1.3}, {-1.3, 0}});
    case Marker::TriangleDown:
      return polygon({{-1.2, -0.9}, {1.2, -0.9}, {0, 1.3}});
    case Marker::TriangleUp:
      return polygon({{-1.2, 0.9}, {1.2, 0.9}, {0, -1.3}});
    case Marker::Square:
      return polygon({{-1, -1}, {1, -1}, {1, 1}, {-1, 1}});
    case Marker::Plus:
      body_ += fmt::format("<path class=\"{} stroke\" d=\"M{:.2f} {:.2f}H{:.2f}M{:.2f} {:.2f}V{:.2f}\">{}</path>\n",
                           css, at.x - r, at.y, at.x + r, at.x, at.y - r, at.y + r, inside);
      return;
    case Marker::Cross:
      body_ += fmt::format(
          "<path class=\"{} stroke\" d=\"M{:.2f} {:.2f}L{:.2f} {:.2f}M{:.2f} {:.2f}L{:.2f} {:.2f}\">{}</path>\n", css,
          at.x - r, at.y - r, at.x + r, at.y + r, at.x - r, at.y + r, at.x + r, at.y - r, inside);
      return;
  }
}

void Svg::begin_group(std::string_view id, std::string_view css) {
  body_ += fmt::format("<g id=\"{}\"{}>\n", id, css.empty() ? "" : fmt::format(" class=\"{}\"", css));
}
void Svg::end_group() { body_ += "</g>\n"; }

std::string Svg::finish() const { return body_ + "</svg>\n"; }

Scale Scale::logarithmic(const std::vector<double>& values, double pixel_low, double pixel_high) {
  double low = std::numeric_limits<double>::infinity();
  double high = 0;
  for (const double value : values)
    if (value > 0 && std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
  if (high == 0) low = 0.1, high = 1;
  low = std::log10(std::max(low, 1e-40 * high));
  high = std::log10(high);
  const double room = std::max(0.07 * (high - low), 0.25 - 0.5 * (high - low));
  Scale scale = linear(low - room, high + room, pixel_low, pixel_high);
  scale.log_ = true;
  return scale;
}

Scale Scale::linear(double low, double high, double pixel_low, double pixel_high) {
  Scale scale;
  scale.low_ = low;
  scale.high_ = high > low ? high : low + 1;
  scale.pixel_low_ = pixel_low;
  scale.pixel_high_ = pixel_high;
  return scale;
}

double Scale::operator()(double value) const {
  if (!std::isfinite(value)) return std::numeric_limits<double>::quiet_NaN();
  double place = value;
  if (log_) place = value > 0 ? std::max(std::log10(value), low_) : low_;
  return pixel_low_ + (place - low_) / (high_ - low_) * (pixel_high_ - pixel_low_);
}

std::vector<Scale::Tick> Scale::ticks(int most) const {
  std::vector<Tick> ticks;
  const double span = high_ - low_;
  if (!log_ || span >= 2) {
    double step = round_step(span / most);
    if (log_) step = std::max(1.0, std::ceil(span / most));
    const auto first = std::lround(std::ceil(low_ / step - 1e-9));
    const auto last = std::lround(std::floor(high_ / step + 1e-9));
    for (auto k = first; k <= last; ++k) {
      const double value = static_cast<double>(k) * step;
      if (log_)
        ticks.push_back({std::pow(10, value), fmt::format("1e{:+03.0f}", value)});
      else
        ticks.push_back({value, fmt::format("{:g}", std::abs(value) < 1e-9 * span ? 0 : value)});
    }
    return ticks;
  }
  for (auto power = std::lround(std::floor(low_)); power <= std::lround(std::floor(high_)); ++power)
    for (const double factor : {1.0, 2.0, 3.0, 5.0, 7.0})
      if (const double place = std::log10(factor) + static_cast<double>(power); place >= low_ && place <= high_)
        ticks.push_back({std::pow(10, place), fmt::format("{:g}e{:+03d}", factor, power)});
  return ticks;
}

}  // namespace perp::app
