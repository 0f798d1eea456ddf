// SPDX-License-Identifier: Apache-2.0
#include "ncp/problem/colouring.hpp"

#include <algorithm>
#include <functional>
#include <numeric>

namespace perp::ncp {
namespace {

using ColumnGroups = std::vector<std::vector<int>>;

Eigen::Index fullest_row(const lcp::SpMat& pattern) {
  std::vector<Eigen::Index> entries(lcp::at(pattern.rows()));
  for (Eigen::Index k = 0; k < pattern.nonZeros(); ++k) ++entries[lcp::at(pattern.innerIndexPtr()[k])];
  return entries.empty() ? 0 : *std::ranges::max_element(entries);
}

ColumnGroups greedy_groups(const lcp::SpMat& pattern, const std::vector<int>& order) {
  ColumnGroups groups;
  std::vector<std::vector<int>> groups_of_row(lcp::at(pattern.rows()));
  std::vector<int> taken;  // taken[g] == j: group g has a row of column j
  for (const int j : order) {
    const auto rows = [&](const auto& visit) {
      for (int k = pattern.outerIndexPtr()[j]; k < pattern.outerIndexPtr()[j + 1]; ++k)
        visit(groups_of_row[lcp::at(pattern.innerIndexPtr()[k])]);
    };
    rows([&](const std::vector<int>& of_row) {
      for (const int g : of_row) taken[lcp::at(g)] = j;
    });
    const auto free = std::ranges::find_if(taken, [j](int last) { return last != j; });
    const auto g = static_cast<int>(free - taken.begin());
    if (free == taken.end()) {
      taken.push_back(-1);
      groups.emplace_back();
    }
    groups[lcp::at(g)].push_back(j);
    rows([&](std::vector<int>& of_row) { of_row.push_back(g); });
  }
  return groups;
}

}  // namespace

std::vector<std::vector<int>> column_groups(const lcp::SpMat& pattern) {
  const auto n = static_cast<int>(pattern.cols());
  const Eigen::Index fewest = fullest_row(pattern);
  std::vector<int> order(lcp::at(n));
  std::iota(order.begin(), order.end(), 0);
  if (fewest == n) {  // a full row: no two columns go together
    ColumnGroups groups;
    for (const int j : order) groups.push_back({j});
    return groups;
  }
  ColumnGroups natural = greedy_groups(pattern, order);
  if (static_cast<Eigen::Index>(natural.size()) <= std::max<Eigen::Index>(fewest, 1)) return natural;
  const auto entries = [&](int j) { return pattern.outerIndexPtr()[j + 1] - pattern.outerIndexPtr()[j]; };
  std::ranges::stable_sort(order, std::ranges::greater{}, entries);
  ColumnGroups largest_first = greedy_groups(pattern, order);
  return largest_first.size() <= natural.size() ? largest_first : natural;
}

}  // namespace perp::ncp
