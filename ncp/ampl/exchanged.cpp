// SPDX-License-Identifier: Apache-2.0
#include "ncp/ampl/exchanged.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

namespace perp::ncp::ampl {
namespace {

using Indices = std::vector<Index>;

constexpr Index most = 100'000;  // conditions whose names are compared
constexpr std::size_t few = 4;   // rows in a circle, of which a person can make sense

/// Conditions: unknowns with a bound and a row of the model.
Indices conditions_of(const Pairing& pairing) {
  Indices found;
  for (Index u = 0; u < std::ssize(pairing.variables); ++u)
    if (!pairing.box.is_free(u)) found.push_back(u);
  return found;
}

/// Returns whether an index may begin there: "cap[gas]" at '[', "cap_gas" and "cap.gas" behind the mark, "e12" at the
/// number.
bool begins_index(const std::string& name, std::size_t k) {
  const auto digit = [&](std::size_t at) { return name[at] >= '0' && name[at] <= '9'; };
  return k == 0 || name[k] == '[' || name[k - 1] == '_' || name[k - 1] == '.' || (digit(k) && !digit(k - 1));
}

using Habit = std::pair<std::string, std::string>;  // what rows begin with, and their variables

std::vector<Habit> habits_of(const std::string& row, const std::string& variable) {
  std::vector<Habit> found;
  for (std::size_t k = 0; k < row.size(); ++k)
    if (begins_index(row, k) && variable.ends_with(row.substr(k)))
      found.emplace_back(row.substr(0, k), variable.substr(0, variable.size() - (row.size() - k)));
  return found;
}

std::string by_names(const Pairing& pairing, const Names& names) {
  const Indices conditions = conditions_of(pairing);
  if (!names.complete() || std::ssize(conditions) > most) return {};
  std::unordered_map<std::string, Index> unknown;
  std::map<Habit, Indices> followers;
  for (const Index u : conditions) {
    unknown.emplace(unknown_name(pairing, names, u), u);
    for (Habit& habit : habits_of(equation_name(pairing, names, u), unknown_name(pairing, names, u)))
      followers[std::move(habit)].push_back(u);
  }
  std::erase_if(followers, [](const auto& entry) { return entry.second.size() < 2; });  // no habit
  std::set<Index> follows;
  for (const auto& [habit, those] : followers) follows.insert(those.begin(), those.end());
  // Maps a row to the variable that the commonest habit of its like gives it, and an example.
  std::map<Index, std::pair<Index, Index>> expected;
  for (const Index u : conditions) {
    if (follows.contains(u)) continue;
    const std::string row = equation_name(pairing, names, u);
    std::size_t commonest = 0;
    for (const auto& [habit, those] : followers) {
      if (!row.starts_with(habit.first) || those.size() <= commonest || !begins_index(row, habit.first.size()))
        continue;
      const auto it = unknown.find(habit.second + row.substr(habit.first.size()));
      if (it == unknown.end() || it->second == u || follows.contains(it->second)) continue;
      commonest = those.size();
      expected[u] = {it->second, those.front()};
    }
  }
  // A whole circle is asked for: each has what another one should have.
  if (expected.size() < 2 || expected.size() > few) return {};
  std::set<Index> taken;
  for (const auto& [u, wants] : expected)
    if (!expected.contains(wants.first) || !taken.insert(wants.first).second) return {};
  std::string text;
  for (const auto& [u, wants] : expected)
    text += (text.empty() ? "row " : ", row ") + equation_name(pairing, names, u) + " complements " +
            unknown_name(pairing, names, u) + " and not " + unknown_name(pairing, names, wants.first);
  const Index like = expected.begin()->second.second;
  return text + ", as the names would have it (" + equation_name(pairing, names, like) + " complements " +
         unknown_name(pairing, names, like) + ")";
}

/// Entries of P without an entry in the other half, with rows i and k exchanged; at most `limit` of them.
std::vector<std::pair<Index, Index>> unmirrored(const SpMat& P, const SpMat& transposed, Index i, Index k,
                                                std::size_t limit) {
  const auto row_of = [&](Index row) { return row == i ? k : row == k ? i : row; };  // that is in the place of `row`
  const auto has = [&](Index row, Index column) {
    const auto *begin = P.innerIndexPtr() + P.outerIndexPtr()[column],
               *end = P.innerIndexPtr() + P.outerIndexPtr()[column + 1];
    return std::binary_search(begin, end, static_cast<int>(row_of(row)));
  };
  std::vector<std::pair<Index, Index>> found;
  for (Index row = 0; row < P.cols() && found.size() < limit; ++row)
    for (SpMat::InnerIterator it(transposed, row_of(row)); it && found.size() < limit; ++it)
      if (it.row() != row && !has(it.row(), row)) found.emplace_back(row, it.row());
  return found;
}

std::string by_pattern(const Pairing& pairing, const SpMat& P, const Names& names) {
  const SpMat transposed = P.transpose();
  constexpr std::size_t some = 200;  // of two rows, however long: more than that and they are not looked through
  const auto now = unmirrored(P, transposed, -1, -1, some);
  // Patterns of a few entries may become symmetric by any exchange.
  constexpr std::size_t evidence = 3;
  if (now.size() < evidence || now.size() == some || P.nonZeros() < 2 * std::ssize(now)) return {};
  // Two rows that have to do with all of these.
  std::set<std::pair<Index, Index>> pairs;
  for (const Index i : {now.front().first, now.front().second}) {
    const auto other = std::ranges::find_if(now, [i](const auto& e) { return e.first != i && e.second != i; });
    for (const auto& [a, b] : other == now.end() ? now : std::vector{*other})
      for (const Index k : {a, b})
        if (k != i) pairs.emplace(std::min(i, k), std::max(i, k));
  }
  for (const auto& [i, k] : pairs) {
    if (k >= std::ssize(pairing.variables) || pairing.box.is_free(i) || pairing.box.is_free(k)) continue;
    if (!unmirrored(P, transposed, i, k, 1).empty()) continue;
    const std::string x = unknown_name(pairing, names, i), y = unknown_name(pairing, names, k);
    return "rows " + equation_name(pairing, names, i) + " and " + equation_name(pairing, names, k) +
           " seem to have each other's variables, " + x + " and " + y +
           ": exchanged, the pattern of the Jacobian would be symmetric";
  }
  return {};
}

}  // namespace

std::string exchanged(const Pairing& pairing, const JacobianMap& jacobian, const Names& names) {
  std::string text = by_names(pairing, names);
  return text.empty() ? by_pattern(pairing, jacobian.pattern, names) : text;
}

}  // namespace perp::ncp::ampl
