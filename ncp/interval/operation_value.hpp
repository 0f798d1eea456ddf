// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The value of an operation, of doubles and of intervals alike. Private to ncp/.
#include <algorithm>
#include <cmath>
#include <optional>

#include "ncp/interval/expression_graph.hpp"

namespace perp::ncp {

/// Returns the value of the operation at a, and b where it has two operands; nothing of operations that are neither
/// elementary nor arithmetic.
template <class T>
std::optional<T> value_of(Operation operation, const T& a, const T& b) {
  using std::abs, std::floor, std::ceil, std::sqrt, std::exp, std::log, std::log10, std::sin, std::cos, std::tan;
  using std::asin, std::acos, std::atan, std::sinh, std::cosh, std::tanh, std::asinh, std::acosh, std::atanh;
  using std::atan2;
  using enum Operation;
  switch (operation) {
    // clang-format off
    case Add: return a + b;
    case Subtract: return a - b;
    case Multiply: return a * b;
    case Divide: return a / b;
    case Power:
      if constexpr (std::is_same_v<T, double>) return std::pow(a, b);
      else return power(a, b);
    case Minimum:
      if constexpr (std::is_same_v<T, double>) return std::min(a, b);
      else return minimum(a, b);
    case Maximum:
      if constexpr (std::is_same_v<T, double>) return std::max(a, b);
      else return maximum(a, b);
    case Absolute:
      if constexpr (std::is_same_v<T, double>) return std::abs(a);
      else return absolute(a);
    case Negate: return -a;
    case Atan2: return atan2(a, b);
    case Floor: return floor(a);
    case Ceil: return ceil(a);
    case Sqrt: return sqrt(a);
    case Exp: return exp(a);
    case Log: return log(a);
    case Log10: return log10(a);
    case Sin: return sin(a);
    case Cos: return cos(a);
    case Tan: return tan(a);
    case Asin: return asin(a);
    case Acos: return acos(a);
    case Atan: return atan(a);
    case Sinh: return sinh(a);
    case Cosh: return cosh(a);
    case Tanh: return tanh(a);
    case Asinh: return asinh(a);
    case Acosh: return acosh(a);
    case Atanh: return atanh(a);
    default: return std::nullopt;
      // clang-format on
  }
}

}  // namespace perp::ncp
