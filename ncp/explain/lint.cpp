// SPDX-License-Identifier: Apache-2.0
#include "ncp/explain/lint.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "ncp/analysis/structure_report.hpp"
#include "ncp/problem/counted_mcp.hpp"
#include "ncp/problem/model_structure.hpp"
#include "ncp/problem/residual.hpp"
#include "ncp/problem/words.hpp"
#include "ncp/run/undefined_start.hpp"

namespace perp::ncp {
namespace {

using Indices = std::vector<Index>;

constexpr std::size_t like = 5;  // rows of a family: so many agree by no chance

/// The entries of a row for one family of variables.
struct Part {
  bool positive = false, negative = false;
  double largest = 0;
  void add(double a) {
    (a > 0 ? positive : negative) = true;
    largest = std::max(largest, std::abs(a));
  }
};

/// The only member of a family for which `is` holds, or does not hold; -1: there is none.
Index odd_one(const Indices& members, const std::function<bool(Index)>& is) {
  Indices yes, no;
  for (const Index i : members) (is(i) ? yes : no).push_back(i);
  if (members.size() < like) return -1;
  return yes.size() == 1 ? yes.front() : no.size() == 1 ? no.front() : -1;
}

/// Finds the one of positive sizes that is far from all others, which are near each other; -1: there is none.
Index odd_size(std::vector<std::pair<double, Index>> sizes) {
  constexpr double far = 100, near = 10;  // factors
  if (sizes.size() < like) return -1;
  std::ranges::sort(sizes);
  const auto& [least, first] = sizes.front();
  const auto& [most, last] = sizes.back();
  const double second = sizes[1].first, last_but_one = sizes[sizes.size() - 2].first;
  if (most >= far * last_but_one && last_but_one <= near * least) return last;
  if (second >= far * least && most <= near * second) return first;
  return -1;
}

}  // namespace

void add_family_faults(const Mcp& mcp, const SpMat& J, std::vector<Answer>& found) {
  const std::vector<bool> constant = mcp.linear_entries();
  if (constant.empty() && !mcp.is_affine()) return;
  std::map<std::string, Indices> families;
  std::vector<std::string> column_family(at(mcp.size()));
  for (Index i = 0; i < mcp.size(); ++i) {
    families[split_name(mcp.equation_name(i)).first].push_back(i);
    column_family[at(i)] = split_name(mcp.variable_name(i)).first;
  }
  std::vector<std::map<std::string, Part>> parts(at(mcp.size()));
  Vec own = Vec::Zero(mcp.size());
  std::size_t p = 0;
  for (Index j = 0; j < J.cols(); ++j)
    for (SpMat::InnerIterator it(J, j); it; ++it, ++p) {
      if (it.value() == 0 || (!mcp.is_affine() && !constant[p])) continue;
      parts[at(it.row())][column_family[at(j)]].add(it.value());
      if (it.row() == j) own[j] = it.value();
    }
  const auto tell = [&](Index i, const Indices& members, const std::string& what) {
    const Index other = members.front() == i ? members[1] : members.front();
    found.push_back({.kind = Answer::Kind::Family,
                     .rows = {i},
                     .text = "row " + mcp.equation_name(i) + " differs from its like, as " + mcp.equation_name(other) +
                             ": " + what});
  };
  for (const auto& [name, members] : families) {
    if (members.size() < like) continue;
    if (std::ranges::all_of(members, [&](Index i) { return own[i] != 0; }))
      if (const Index i = odd_one(members, [&](Index k) { return own[k] > 0; }); i >= 0)
        tell(i, members,
             "it " + std::string(own[i] > 0 ? "increases" : "decreases") + " in its own variable " +
                 mcp.variable_name(i) + ", they do not: the other sense, perhaps");
    std::map<std::string, int> met;
    for (const Index i : members)
      for (const auto& [column, part] : parts[at(i)]) ++met[column];
    for (const auto& [column, count] : met) {
      const auto part = [&, column = column](Index i) -> const Part* {
        const auto it = parts[at(i)].find(column);
        return it == parts[at(i)].end() ? nullptr : &it->second;
      };
      if (count < std::ssize(members)) continue;
      if (std::ranges::any_of(members, [&](Index k) { return part(k)->positive && part(k)->negative; })) continue;
      if (const Index i = odd_one(members, [&](Index k) { return part(k)->positive; }); i >= 0)
        tell(i, members, "its entries of " + column + " have the other sign");
      std::vector<std::pair<double, Index>> sizes;
      for (const Index i : members) sizes.emplace_back(part(i)->largest, i);
      if (const Index i = odd_size(std::move(sizes)); i >= 0)
        tell(i, members,
             "its entries of " + column + " are of another size, " + number(part(i)->largest) +
                 " where theirs are near " +
                 number(part(members.front() == i ? members[1] : members.front())->largest));
    }
  }
}

void add_start_faults(const Mcp& mcp, In x0, std::vector<Answer>& found) {
  const Box& box = mcp.box();
  Indices outside;
  const Vec x = lcp::project(box, x0);
  for (Index j = 0; j < mcp.size(); ++j)
    if (x[j] != x0[j] && x0[j] != 0) outside.push_back(j);
  if (!outside.empty())
    found.push_back({.kind = Answer::Kind::Start,
                     .variables = outside,
                     .text = "the start is outside the bounds of " + listed(outside.size(), [&](std::size_t k) {
                               const Index j = outside[k];
                               return mcp.variable_name(j) + ", " + number(x0[j]) + " beside [" + number(box.lower[j]) +
                                      ", " + number(box.upper[j]) + "]";
                             })});
  CountedMcp counted(mcp);
  Point point;
  point.x = x;
  point.F = Vec::Zero(mcp.size());
  point.J = mcp.jacobian_pattern();
  if (!counted.eval(point.x, point.F) || !counted.jacobian(point.x, point.J)) {
    const auto moved = moved_start(counted, point.x);
    mcp.eval(point.x, point.F);
    const bool defined = point.F.allFinite();
    Answer answer{.kind = Answer::Kind::Start,
                  .text = moved ? moved->note : undefined_start(mcp, point.x, point.F, defined ? &point.J : nullptr)};
    for (Index i = 0; i < mcp.size(); ++i)
      if (!std::isfinite(point.F[i])) answer.rows.push_back(i);
    found.push_back(std::move(answer));
    return;
  }
  // Rows that hold, though something has to be balanced in them.
  constexpr double holds = 1e-6;
  constexpr Index enough = 10, share = 50;  // rows that hold; for each row but the first one that does not
  Vec size = Vec::Zero(mcp.size());
  for (Index j = 0; j < mcp.size(); ++j)
    for (SpMat::InnerIterator it(point.J, j); it; ++it)
      if (it.row() != j) size[it.row()] = std::max(size[it.row()], std::abs(it.value() * x[j]));
  const Vec r = row_residuals(box, point.x, point.F);
  Index balanced = 0;
  Indices off;
  for (Index i = 0; i < mcp.size(); ++i) {
    if (r[i] > holds * (1 + size[i]))
      off.push_back(i);
    else if (size[i] > 0 && std::abs(point.F[i]) <= holds * size[i])
      ++balanced;
  }
  if (balanced >= enough && !off.empty() && std::ssize(off) <= 1 + balanced / share)
    found.push_back({.kind = Answer::Kind::Start,
                     .rows = off,
                     .text = "at the start " + quantity(balanced, "row") + " hold, and " +
                             listed(off.size(),
                                    [&](std::size_t k) {
                                      return mcp.equation_name(off[k]) + " does not, by " + number(r[off[k]]);
                                    }) +
                             ": if the start is a calibrated benchmark, look there"});
}

}  // namespace perp::ncp
