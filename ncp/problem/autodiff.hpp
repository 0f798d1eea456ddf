// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Problems of one function, templated on its scalar type, with exact derivatives:
///     const auto F = []<class T>(std::span<const T> x, std::span<T> F) { using std::exp; F[0] = exp(x[0]) - x[1]; };
///     const auto mcp = make_autodiff_mcp(F, {.box = Box::nonnegative(2)});
/// T is double for F. It is Dual (ncp/problem/dual.hpp) for J, by forward mode, 8 groups of columns that share no row
/// (ncp/problem/colouring.hpp) a sweep. It is Expression (ncp/interval/expression.hpp) once, before anything else: that
/// run tells the pattern of J, which of its entries are constant, whether F is affine, and the ranges of F and J over
/// boxes, so that verify(), no_solution() and the classes of functions apply.
/// Functions may use + - * /, exp, expm1, log, log1p, log10, sqrt, pow, sin, cos, tan, asin, acos, atan, atan2, sinh,
/// cosh, tanh, asinh, acosh, atanh, abs, fabs, floor, ceil, min, max, called without `std::`
/// after `using std::exp;`. A function that compares
/// scalars (if, ?:, std::max<T>) has exact derivatives on each of its branches, but is not followed by Expressions: J
/// has the pattern given, else all entries, and nothing is promised of it.
#include <concepts>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "ncp/interval/expression.hpp"
#include "ncp/problem/dual.hpp"
#include "ncp/problem/mcp.hpp"

namespace perp::ncp {

/// What the problem has beside its function.
struct AutodiffParts {
  std::string name = "mcp";
  Box box;
  SpMat pattern{};  ///< n x n; for functions that compare: every entry that can be nonzero. None: all entries
  std::vector<std::string> variable_names{};  ///< empty, or n names
  std::vector<std::string> equation_names{};  ///< empty, or n names
};

/// f(x, F) for x and F of n entries; answers bool (false: not defined at x) or nothing. F comes in with zeros.
template <class Function>
concept ScalarFunction = std::invocable<const Function&, std::span<const double>, std::span<double>> &&
    std::invocable<const Function&, std::span<const Dual>, std::span<Dual>> &&
    std::invocable<const Function&, std::span<const Expression>, std::span<Expression>>;

template <class T>
using FunctionOf = std::function<bool(std::span<const T> x, std::span<T> F)>;

/// One function, for each scalar type.
struct FunctionInstances {
  FunctionOf<double> number;
  FunctionOf<Dual> dual;
  FunctionOf<Expression> expression;
};
/// Throws std::invalid_argument if the sizes of box, pattern and names differ.
std::unique_ptr<Mcp> make_autodiff_mcp(FunctionInstances instances, AutodiffParts parts);

/// The same of a function template: a generic lambda, or an object with a template operator() that is const.
template <ScalarFunction Function>
std::unique_ptr<Mcp> make_autodiff_mcp(Function function, AutodiffParts parts) {
  const auto shared = std::make_shared<const Function>(std::move(function));
  const auto instance = [&shared]<class T>(std::type_identity<T>) -> FunctionOf<T> {
    return [shared](std::span<const T> x, std::span<T> F) {
      if constexpr (std::is_void_v<decltype((*shared)(x, F))>) {
        (*shared)(x, F);
        return true;
      } else {
        return static_cast<bool>((*shared)(x, F));
      }
    };
  };
  return make_autodiff_mcp(
      FunctionInstances{instance(std::type_identity<double>{}), instance(std::type_identity<Dual>{}),
                        instance(std::type_identity<Expression>{})},
      std::move(parts));
}

}  // namespace perp::ncp
