// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What `perp contact --compare` says: tables for a terminal, a page and a chart.
#include <iosfwd>
#include <string>
#include <vector>

#include "app/contact/compare/cell.hpp"

namespace perp::app::contacts {

/// Cells with what they were asked to do. Not all pairs need be there.
struct Comparison {
  std::vector<std::string> variants{};
  std::vector<std::string> problems{};
  std::vector<Cell> cells{};
  double tol = 1e-8;
  double time_limit = 30;
  long long memory_mb = 4096;

  const Cell* find(const std::string& variant, const std::string& problem) const;
};

/// Variants by outcomes, times and errors of the exact law; then problems by variants, times.
void print_comparison(std::ostream& out, const Comparison& comparison);

/// Performance profile (Dolan & More 2002) of the solve times, as a drawing of its own.
std::string profile_svg(const Comparison& comparison);
/// All of it as one HTML page that needs nothing else.
std::string report_html(const Comparison& comparison);

}  // namespace perp::app::contacts
