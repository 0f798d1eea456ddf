// SPDX-License-Identifier: Apache-2.0
#include "ncp/run/undefined_start.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "ncp/interval/enclosure.hpp"
#include "ncp/problem/counted_mcp.hpp"
#include "ncp/problem/words.hpp"

namespace perp::ncp {
namespace {

using Indices = std::vector<Index>;

std::vector<UndefinedOperation> operations(const Mcp& mcp, In x, bool derivatives) {
  const Enclosure* enclosure = mcp.enclosure();
  if (enclosure == nullptr) return {};
  return enclosure->undefined({x.data(), at(x.size())}, derivatives,
                              [&mcp](int j) { return mcp.variable_name(static_cast<Index>(j)); });
}

Indices variables_of(const SpMat& pattern, const std::vector<char>& rows) {
  Indices variables;
  for (Index j = 0; j < pattern.cols(); ++j)
    for (SpMat::InnerIterator it(pattern, j); it; ++it)
      if (rows[at(it.row())] != 0) {
        variables.push_back(j);
        break;
      }
  return variables;
}

/// -1, 1: at its lower or upper bound; 0: at none, or fixed.
int side(const Box& box, Index j, double x) {
  const double l = box.lower[j];
  const double u = box.upper[j];
  return l == u ? 0 : x == l ? -1 : x == u ? 1 : 0;
}

/// Off its bound by `step`, relative to the bound if that is larger than 1, but at most to the middle of the box.
double off_bound(const Box& box, Index j, double x, double step) {
  const double room = 0.5 * (box.upper[j] - box.lower[j]);
  return x - side(box, j, x) * std::min(step * std::max(1.0, std::abs(x)), room);
}

/// What is known of the place where F or J is not defined.
struct Suspects {
  bool defined = false;
  Indices variables{};  ///< at a bound
};

class Search {
 public:
  Search(CountedMcp& counted, In x)
      : counted_(counted), mcp_(counted.mcp()), box_(mcp_.box()), x_(x), J_(mcp_.jacobian_pattern()) {}

  Suspects look(const Vec& z) {
    Suspects suspects;
    std::vector<char> rows(at(x_.size()), 0);
    std::vector<UndefinedOperation> found;
    if (!counted_.eval(z, F_)) {
      found = operations(mcp_, z, false);
      for (Index i = 0; i < F_.size(); ++i) rows[at(i)] = std::isfinite(F_[i]) ? 0 : 1;
    } else if (!counted_.jacobian(z, J_)) {
      found = operations(mcp_, z, true);
      for (Index j = 0; j < J_.cols(); ++j)
        for (SpMat::InnerIterator it(J_, j); it; ++it)
          if (!std::isfinite(it.value())) suspects.variables.push_back(j);
    } else {
      suspects.defined = true;
      return suspects;
    }
    for (const UndefinedOperation& operation : found)
      for (const auto& [j, bounds] : operation.variables) {
        suspects.variables.push_back(j);
        box_.lower[j] = std::max(box_.lower[j], bounds.lower);
        box_.upper[j] = std::min(box_.upper[j], bounds.upper);
      }
    if (found.empty() && suspects.variables.empty()) suspects.variables = variables_of(mcp_.jacobian_pattern(), rows);
    if (suspects.variables.empty() && found.empty())
      for (Index j = 0; j < x_.size(); ++j) suspects.variables.push_back(j);
    std::ranges::sort(suspects.variables);
    suspects.variables.erase(std::ranges::unique(suspects.variables).begin(), suspects.variables.end());
    std::erase_if(suspects.variables, [&](Index j) { return side(box_, j, z[j]) == 0; });
    return suspects;
  }

  /// x with all that prove to be in the way `step` off their bounds; spread: by different steps, for differences.
  std::optional<Vec> by_steps_of(double step, bool spread) {
    Vec z = x_;
    for (Suspects suspects = look(z); !suspects.defined; suspects = look(z)) {
      if (suspects.variables.empty()) return std::nullopt;
      for (const Index j : suspects.variables) {
        const double part = spread ? 0.5 + 0.5 * std::abs(std::sin(static_cast<double>(j + 1))) : 1;
        z[j] = off_bound(box_, j, z[j], step * part);
      }
    }
    return z;
  }

 private:
  CountedMcp& counted_;
  const Mcp& mcp_;
  Box box_;  // with the bounds that the model has in rows of their own
  Vec x_, F_;
  SpMat J_;
};

std::string moved_to(const Mcp& mcp, In x, In z) {
  constexpr int shown = 3;
  std::string text;
  int moved = 0;
  for (Index j = 0; j < x.size(); ++j) {
    if (z[j] == x[j] || moved++ >= shown) continue;
    text += (text.empty() ? "" : ", ") + mcp.variable_name(j) + " = " + number(z[j]);
  }
  return moved > shown ? text + " and " + quantity(moved - shown, "more variable") + " off their bounds" : text;
}

}  // namespace

std::string why_undefined(const Mcp& mcp, In x, In F, const SpMat* J) {
  if (const auto found = operations(mcp, x, J != nullptr); !found.empty()) {
    const UndefinedOperation& first = found.front();
    return first.operation + " in row " + mcp.equation_name(first.row) + (first.overflow ? " is too large: " : ": ") +
           first.argument + " at the start" + first.where;
  }
  if (J != nullptr) {
    for (Index j = 0; j < J->cols(); ++j)
      for (SpMat::InnerIterator it(*J, j); it; ++it)
        if (!std::isfinite(it.value()))
          return "the derivative of row " + mcp.equation_name(it.row()) + " with respect to " + mcp.variable_name(j) +
                 " is " + number(it.value()) + ": " + mcp.variable_name(j) + " = " + number(x[j]) + " at the start";
    return {};
  }
  Index row = 0;
  while (row < F.size() && std::isfinite(F[row])) ++row;
  if (row == F.size()) return {};
  std::vector<char> rows(at(F.size()), 0);
  rows[at(row)] = 1;
  Indices variables = variables_of(mcp.jacobian_pattern(), rows);
  std::ranges::stable_partition(variables, [&](Index j) { return side(mcp.box(), j, x[j]) != 0; });
  constexpr std::size_t shown = 5;
  std::string text = "row " + mcp.equation_name(row) + " is " +
                     (std::isnan(F[row]) ? "NaN" : "infinite (an overflow or a pole)") + " at the start";
  for (std::size_t k = 0; k < std::min(shown, variables.size()); ++k)
    text += (k == 0 ? ", where " : ", ") + mcp.variable_name(variables[k]) + " = " + number(x[variables[k]]);
  return variables.size() > shown ? text + ", ..." : text;
}

std::string undefined_start(const Mcp& mcp, In x, In F, const SpMat* J) {
  const std::string why = why_undefined(mcp, x, F, J);
  if (J != nullptr) return "the Jacobian is not defined at the start" + (why.empty() ? "" : ": " + why);
  return why.empty() ? "F is not defined at the start" : "not defined: " + why;
}

std::optional<MovedStart> moved_start(CountedMcp& counted, In x) {
  const Mcp& mcp = counted.mcp();
  Search search(counted, x);
  const Suspects here = search.look(x);
  if (here.defined || here.variables.empty()) return std::nullopt;
  // Domains that are narrower than a step are rare; each try costs an evaluation.
  for (const double step : {1.0, 1e-1, 1e-2, 1e-4, 1e-6})
    for (const bool spread : {false, true})
      if (std::optional<Vec> z = search.by_steps_of(step, spread)) {
        Vec F;
        SpMat J;
        const bool has_F = counted.eval(x, F);
        if (has_F) counted.jacobian(x, J);
        std::string why = why_undefined(mcp, x, F, has_F ? &J : nullptr);
        if (why.empty()) why = has_F ? "the Jacobian at the start" : "F at the start";
        return MovedStart{
            .x = *z,
            .note = "not defined: " + why + "; the start was moved off the bounds, to " + moved_to(mcp, x, *z)};
      }
  return std::nullopt;
}

}  // namespace perp::ncp
