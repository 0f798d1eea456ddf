// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Drawings as SVG text: shapes with classes, escaped words, axes with ticks. Units are pixels, y grows downwards.
#include <string>
#include <string_view>
#include <vector>

namespace perp::app {

/// What stands for c in XML and HTML, if c cannot stand for itself; else "".
std::string_view entity(char c);
/// Escaped for XML; bytes that are no printable ASCII become '?'.
std::string xml_text(std::string_view text);

struct Pixel {
  double x = 0;
  double y = 0;
};

class Svg {
 public:
  Svg(int width, int height, std::string_view title, std::string_view style);

  enum class Anchor { Start, Middle, End };
  void line(std::string_view css, Pixel a, Pixel b);
  /// Points that are no finite numbers are gaps.
  void polyline(std::string_view css, const std::vector<Pixel>& points);
  void rectangle(std::string_view css, Pixel corner, double width, double height);
  void text(std::string_view css, Pixel at, std::string_view words, Anchor anchor = Anchor::Start, int degrees = 0);

  enum class Marker { Dot, Ring, Diamond, TriangleDown, TriangleUp, Square, Plus, Cross };
  /// `tip`, if not empty, is shown where a mouse rests on it.
  void marker(std::string_view css, Marker shape, Pixel at, double radius, std::string_view tip = {});

  /// Everything up to end_group() has this id, and this class if it is not empty.
  void begin_group(std::string_view id, std::string_view css = {});
  void end_group();

  std::string finish() const;

 private:
  std::string body_;
};

/// A linear or decimal-logarithmic scale from values to pixels.
class Scale {
 public:
  /// Contains all positive finite values, with some room; at least a factor of 3, at most 10^-40 of the largest.
  static Scale logarithmic(const std::vector<double>& values, double pixel_low, double pixel_high);
  static Scale linear(double low, double high, double pixel_low, double pixel_high);

  /// NaN for values that have no place; on a logarithmic scale 0 and what is below the scale lie at its low end.
  double operator()(double value) const;
  double low() const { return low_; }
  double high() const { return high_; }

  struct Tick {
    double value;
    std::string label;
  };
  /// At most about `most` of them.
  std::vector<Tick> ticks(int most) const;

 private:
  bool log_ = false;
  double low_ = 0, high_ = 1, pixel_low_ = 0, pixel_high_ = 1;
};

}  // namespace perp::app
