#include "extension/differences.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace perp::python {

using lcp::at;
using lcp::Index;
using lcp::Vec;

Differences::Differences(const lcp::SpMat& pattern) : pattern_(pattern) {
  const Index n = pattern.cols();
  const auto entries = [&](Index j) { return pattern.outerIndexPtr()[j + 1] - pattern.outerIndexPtr()[j]; };
  std::vector<int> order(at(n));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, std::ranges::greater{}, entries);  // full columns first: fewer groups
  // Greedily: the first group in which no column shares a row with this one.
  std::vector<std::vector<int>> groups_of_row(at(n));
  std::vector<int> taken;  // taken[g] == j: group g has a row of column j
  for (const int j : order) {
    const auto rows = [&](const auto& visit) {
      for (int k = pattern.outerIndexPtr()[j]; k < pattern.outerIndexPtr()[j + 1]; ++k)
        visit(groups_of_row[at(pattern.innerIndexPtr()[k])]);
    };
    rows([&](const std::vector<int>& groups) {
      for (const int g : groups) taken[at(g)] = j;
    });
    const auto free = std::ranges::find_if(taken, [j](int last) { return last != j; });
    const auto g = static_cast<int>(free - taken.begin());
    if (free == taken.end()) {
      taken.push_back(-1);
      groups_.emplace_back();
    }
    groups_[at(g)].push_back(j);
    rows([&](std::vector<int>& groups) { groups.push_back(g); });
  }
}

bool Differences::jacobian(const F& function, const lcp::Box& box, lcp::In x, double* value) const {
  Vec F0(x.size());
  if (!function(x, F0) || !F0.allFinite()) return false;
  Vec step(x.size());
  for (Index j = 0; j < x.size(); ++j) {
    const double h = std::sqrt(std::numeric_limits<double>::epsilon()) * std::max(1.0, std::abs(x[j]));
    step[j] = x[j] + h > box.upper[j] && x[j] - h >= box.lower[j] ? -h : h;
  }
  return std::ranges::all_of(groups_,
                             [&](const auto& columns) { return group(columns, function, x, F0, step, value); });
}

bool Differences::group(const std::vector<int>& columns, const F& function, lcp::In x, const Vec& F0, const Vec& step,
                        double* value) const {
  Vec F1(x.size());
  for (const double way : {1.0, -1.0}) {
    Vec moved = x;
    for (const int j : columns) moved[j] += way * step[j];
    if (!function(moved, F1)) continue;
    bool finite = true;
    for (const int j : columns)
      for (int k = pattern_.outerIndexPtr()[j]; k < pattern_.outerIndexPtr()[j + 1]; ++k) {
        const int i = pattern_.innerIndexPtr()[k];
        value[k] = (F1[i] - F0[i]) / (moved[j] - x[j]);
        finite = finite && std::isfinite(value[k]);
      }
    if (finite) return true;
  }
  return false;
}

}  // namespace perp::python
