// SPDX-License-Identifier: Apache-2.0
// Rows that are multiples of equations.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>

#include "lcp/words.hpp"
#include "ncp/transforms/presolve_reducer.hpp"

namespace perp::ncp {
namespace {

constexpr std::size_t max_notes = 20;
constexpr double same = 1e-15;  // relative: coefficients that differ by rounding

void mix(std::uint64_t& hash, std::uint64_t value) {
  hash = (hash ^ value) * 0x9E3779B97F4A7C15U;
  hash ^= hash >> 29U;
}

}  // namespace

// The affine rows that have as many entries in kept columns as another one, and the same first column: one of them an
// equation. Few rows of most problems do.
std::vector<Index> Reducer::alike() const {
  struct Look {
    int first, entries;
    Index row;
    bool operator<(const Look& other) const {
      return std::tie(first, entries, row) < std::tie(other.first, other.entries, other.row);
    }
  };
  std::vector<Look> looks;
  looks.reserve(at(mcp_.size()));
  for (Index i = 0; i < mcp_.size(); ++i) {
    if (row_kept_[at(i)] == 0 || !is_affine(i) || unfixed_[at(i)] == 0) continue;
    const auto entries = rows_[at(i)];
    const auto first = std::ranges::find_if(entries, [this](const Entry& e) { return kept(e.index); });
    if (first != entries.end()) looks.push_back({first->index, unfixed_[at(i)], i});
  }
  std::sort(looks.begin(), looks.end());
  std::vector<Index> rows;
  for (std::size_t begin = 0, end = 0; begin < looks.size(); begin = end) {
    bool equation = false;
    for (end = begin;
         end < looks.size() && looks[end].first == looks[begin].first && looks[end].entries == looks[begin].entries;
         ++end)
      equation = equation || is_equation(looks[end].row);
    if (equation && end - begin > 1)
      for (std::size_t k = begin; k < end; ++k) rows.push_back(looks[k].row);
  }
  return rows;
}

// Looks for affine rows F_i = t F_e + d of equations F_e = 0. True: something was taken out.
bool Reducer::parallel_rows() {
  notes.clear();
  std::vector<std::pair<std::uint64_t, Index>> keys;
  for (const Index i : alike()) {
    std::uint64_t key = 1;
    double first = 0;
    for (const Entry& e : rows_[at(i)]) {
      if (!kept(e.index)) continue;
      if (first == 0) first = e.a;
      mix(key, static_cast<std::uint64_t>(e.index));
      mix(key, static_cast<std::uint64_t>(std::llround(std::clamp(e.a / first, -1e9, 1e9) * 1e6)));
    }
    keys.emplace_back(key, i);
  }
  std::sort(keys.begin(), keys.end());
  for (std::size_t begin = 0, end = 0; begin < keys.size() && infeasible.empty(); begin = end) {
    Index first = -1;
    for (end = begin; end < keys.size() && keys[end].first == keys[begin].first; ++end)
      if (first < 0 && is_equation(keys[end].second)) first = keys[end].second;
    for (std::size_t k = begin; k < end && first >= 0; ++k)
      if (keys[k].second != first && infeasible.empty()) compare(first, keys[k].second);
  }
  return infeasible.empty() && !row_queue_.empty();
}

void Reducer::compare(Index equation_row, Index row) {
  const Entries a = rows_[at(equation_row)];
  const Entries b = rows_[at(row)];
  double t = 0;
  std::size_t p = 0;
  const auto next = [&](Entries entries, std::size_t from) {
    while (from < entries.size() && !kept(entries[from].index)) ++from;
    return from;
  };
  for (std::size_t q = next(b, 0); q < b.size(); q = next(b, q + 1), ++p) {
    p = next(a, p);
    if (p == a.size() || a[p].index != b[q].index) return;
    if (t == 0) t = b[q].a / a[p].a;
    if (!(std::abs(b[q].a - t * a[p].a) <= same * std::abs(b[q].a))) return;
  }
  if (next(a, p) != a.size()) return;
  const double d = F_[row] - t * F_[equation_row];
  const double margin = trust * (1 + std::abs(t)) + rounding(row) + std::abs(t) * rounding(equation_row);
  if (std::abs(d) > margin) {
    if (!is_equation(row)) return force(row, d, d, {.implied = true});
    if (std::abs(d) <= verdict(row) + std::abs(t) * verdict(equation_row)) return;
    infeasible = text_of("equations ", mcp_.equation_name(equation_row), " and ", mcp_.equation_name(row),
                         " contradict each other: both have to be 0, but the second is ", t, " times the first ",
                         (d > 0 ? "plus " : "minus "), std::abs(d));
  } else if (is_equation(row) && notes.size() < max_notes) {
    notes.push_back(text_of("equations ", mcp_.equation_name(equation_row), " and ", mcp_.equation_name(row),
                            " say the same: the second is ", t, " times the first"));
  }
}

}  // namespace perp::ncp
