// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "lcp/linalg/equation_order.hpp"
#include "ncp/analysis/structure_report.hpp"
#include "ncp/explain/lint.hpp"
#include "ncp/problem/model_structure.hpp"
#include "ncp/problem/words.hpp"

namespace perp::ncp {
namespace {

using Indices = std::vector<Index>;

constexpr double equal = 1e-6;       // relative: entries, some of them of difference quotients
constexpr std::size_t evidence = 2;  // pairs that keep the law, at least
constexpr Index most_variables = 50'000;

/// Entries J_ij and J_ji, i < j, by pairs: row i is row_of[i].
struct Edge {
  Index i, j;
  double a, b;
  bool equals() const { return std::abs(std::abs(a) - std::abs(b)) <= equal * std::max(std::abs(a), std::abs(b)); }
};

std::vector<Edge> edges_of(const SpMat& J, const Indices& row_of) {
  Indices pair_of(row_of.size());
  for (std::size_t k = 0; k < row_of.size(); ++k) pair_of[at(row_of[k])] = static_cast<Index>(k);
  std::vector<Edge> all;
  for (Index j = 0; j < J.cols(); ++j)
    for (SpMat::InnerIterator it(J, j); it; ++it) {
      const Index i = pair_of[at(it.row())];
      if (it.value() == 0 || i == j) continue;
      all.push_back(i < j ? Edge{i, j, it.value(), 0} : Edge{j, i, 0, it.value()});
    }
  std::ranges::sort(all, {}, [](const Edge& e) { return std::pair(e.i, e.j); });
  std::vector<Edge> out;
  for (const Edge& e : all)
    if (!out.empty() && out.back().i == e.i && out.back().j == e.j)
      out.back().a += e.a, out.back().b += e.b;
    else
      out.push_back(e);
  return out;
}

std::size_t unequal(const std::vector<Edge>& edges) {
  return static_cast<std::size_t>(std::ranges::count_if(edges, [](const Edge& e) { return !e.equals(); }));
}

/// The equations beside free variables, as they stand, as their names would have it, or as an order makes J symmetric
/// up to signs: whichever does that best.
Indices partners(const Mcp& mcp, const SpMat& J) {
  const Index n = mcp.size();
  const Box& box = mcp.box();
  Indices natural(at(n));
  std::iota(natural.begin(), natural.end(), Index{0});
  Indices best = natural;
  std::size_t least = unequal(edges_of(J, natural));
  const auto consider = [&](const Indices& row_of) {
    if (const std::size_t faults = unequal(edges_of(J, row_of)); faults < least) least = faults, best = row_of;
  };
  if (least > 0)
    if (const auto order = lcp::equation_order(J, box)) consider(order->row_of);
  if (least == 0) return best;
  const auto names = namesakes(
      n, n, [&](Index i) { return mcp.equation_name(i); }, [&](Index j) { return mcp.variable_name(j); });
  Indices by_name = natural;
  std::vector<char> taken(at(n), 0), has(at(n), 0);
  for (Index j = 0; j < n; ++j)
    if (const Index i = names.row_of[at(j)]; box.is_free(j) && i >= 0 && box.is_free(i) && !taken[at(i)])
      by_name[at(j)] = i, taken[at(i)] = has[at(j)] = 1;
  Index next = 0;
  for (Index j = 0; j < n; ++j) {
    if (!box.is_free(j) || has[at(j)]) continue;
    while (!box.is_free(next) || taken[at(next)]) ++next;
    by_name[at(j)] = next++;
  }
  consider(by_name);
  return best;
}

/// The index that all of the edges have in common, the one that is in most of the others if there are two; -1: none.
Indices common(const std::vector<Edge>& edges) {
  Indices both;
  for (const Index k : {edges.front().i, edges.front().j})
    if (std::ranges::all_of(edges, [k](const Edge& e) { return e.i == k || e.j == k; })) both.push_back(k);
  return both;
}

class Mirror {
 public:
  Mirror(const Mcp& mcp, const SpMat& J, std::vector<Answer>& found)
      : mcp_(mcp), J_(J), found_(found), row_of_(partners(mcp, J)), edges_(edges_of(J, row_of_)) {}

  bool find() {
    std::vector<Edge> wrong, right;
    for (const Edge& e : edges_) (e.equals() ? right : wrong).push_back(e);
    if (right.size() < evidence) return false;
    if (wrong.empty()) {
      colour();
      return true;
    }
    if (const Indices culprits = common(wrong); !culprits.empty())
      tell_sizes(wrong, culprits);
    else
      tell_exchanged(wrong);
    return right.size() > wrong.size();
  }

 private:
  std::string row(Index k) const { return mcp_.equation_name(row_of_[at(k)]); }
  std::string variable(Index k) const { return mcp_.variable_name(k); }

  /// "variable x1 has 3 in row e1, and lambda_e1 has -4 in row d_x1".
  std::string told(const Edge& e) const {
    const auto has = [](double a) { return a == 0 ? std::string("no entry") : number(a); };
    return variable(e.j) + " has " + has(e.a) + " in row " + row(e.i) + ", and " + variable(e.i) + " has " + has(e.b) +
           " in row " + row(e.j);
  }

  void tell(std::string text, const Indices& rows, const Indices& variables) {
    Answer answer{.kind = Answer::Kind::Mirror, .text = std::move(text)};
    for (const Index k : rows) answer.rows.push_back(row_of_[at(k)]);
    answer.variables = variables;
    found_.push_back(std::move(answer));
  }

  void tell_sizes(const std::vector<Edge>& wrong, const Indices& culprits) {
    if (wrong.size() == 1) {
      const Edge& e = wrong.front();
      tell(told(e) + ": in size these are the same wherever else a variable and a row meet", {e.i, e.j}, {e.i, e.j});
      return;
    }
    const Index k = culprits.front();
    double factor = 0;
    bool same = true;
    for (const Edge& e : wrong) {
      const double f = std::abs(e.i == k ? e.a / e.b : e.b / e.a);
      same = same && f > 0 && std::isfinite(f) && (factor == 0 || std::abs(f / factor - 1) <= equal);
      factor = f;
    }
    if (same)
      tell("row " + row(k) + " is " + number(factor) + " times as large as the entries of " + variable(k) +
               " in other rows, which are of the same size everywhere else: other units, perhaps",
           {k}, {k});
    else
      tell("row " + row(k) + " does not agree with what " + variable(k) +
               " does in other rows: " + told(wrong.front()) + ", and so in " +
               quantity(std::ssize(wrong) - 1, "other place") + "; everywhere else these are the same in size",
           {k}, {k});
  }

  /// Two rows that would break the law no more, each in the place of the other.
  void tell_exchanged(const std::vector<Edge>& wrong) {
    std::set<Index> met;
    for (const Edge& e : wrong) met.insert({e.i, e.j});
    constexpr std::size_t some = 60;
    if (met.size() > some) return;
    for (const Index a : met)
      for (const Index b : met) {
        if (b <= a) continue;
        Indices other = row_of_;
        std::swap(other[at(a)], other[at(b)]);
        if (unequal(edges_of(J_, other)) > 0) continue;
        tell("rows " + row(a) + " and " + row(b) + " seem to have each other's variables, " + variable(a) + " and " +
                 variable(b) + ": exchanged, the Jacobian would be symmetric up to signs",
             {a, b}, {a, b});
        return;
      }
  }

  static int sign_of(const Edge& e) { return (e.a > 0) == (e.b > 0) ? 1 : -1; }

  std::vector<Edge> broken(const std::vector<int>& side) const {
    std::vector<Edge> out;
    for (const Edge& e : edges_)
      if (sign_of(e) != side[at(e.i)] * side[at(e.j)]) out.push_back(e);
    return out;
  }

  /// The edges between rows of the same two families: of two, either may be the wrong one.
  std::vector<Edge> alike(const Edge& e) const {
    const auto families = [&](const Edge& one) {
      return std::minmax({split_name(row(one.i)).first, split_name(row(one.j)).first});
    };
    std::vector<Edge> all;
    std::ranges::copy_if(edges_, std::back_inserter(all),
                         [&](const Edge& one) { return families(one) == families(e); });
    return all;
  }

  /// Tells the edges of the wrong sign: with one side for all rows of a family, or where that puts several rows in the
  /// wrong, with the sides of single rows that make these edges fewest.
  void colour() {
    const std::size_t n = row_of_.size();
    std::vector<std::vector<std::pair<Index, int>>> neighbours(n);
    for (const Edge& e : edges_) {
      neighbours[at(e.i)].emplace_back(e.j, sign_of(e));
      neighbours[at(e.j)].emplace_back(e.i, sign_of(e));
    }
    std::vector<Edge> wrong = broken(by_families());
    constexpr std::size_t tries = 12;
    for (std::size_t t = 0; t < tries && !wrong.empty() && common(wrong).empty(); ++t) {
      std::vector<int> side(n, 0);
      for (std::size_t k = 0; k < n; ++k) spread(static_cast<Index>((n / tries * t + k) % n), t, neighbours, side);
      flip(neighbours, side);
      if (std::vector<Edge> fewer = broken(side); fewer.size() < wrong.size()) wrong = std::move(fewer);
    }
    if (wrong.empty() || edges_.size() < (evidence + 1) * wrong.size()) return;
    const Indices culprits = common(wrong);
    if (culprits.empty()) return;
    const Edge& e = wrong.front();
    const std::string law = ": wherever else a variable and a row meet, the signs agree with those of all others";
    if (wrong.size() == 1) {
      const std::vector<Edge> twins = alike(e);
      if (twins.size() != 2) return tell(told(e) + law, {e.i, e.j}, {e.i, e.j});
      const Indices rows{twins[0].i, twins[0].j, twins[1].i, twins[1].j};
      return tell(
          "one sign is the wrong way round of two that should be alike: " + told(twins[0]) + "; but " + told(twins[1]),
          rows, rows);
    }
    const Index k = culprits.front();
    const auto all = std::ranges::count_if(edges_, [k](const Edge& other) { return other.i == k || other.j == k; });
    Indices both;  // of two alike either may be the other way round
    for (Index other = 0; other < mcp_.size(); ++other)
      if (split_name(row(other)).first == split_name(row(k)).first) both.push_back(other);
    if (both.size() != 2) both = {k};
    if (all == std::ssize(wrong))
      tell((both.size() == 2 ? "one of rows " + row(both[0]) + " and " + row(both[1]) : "row " + row(k)) +
               " has the sign opposite to that of its like: " + told(e) + ", and so in all of the row" + law,
           both, both);
    else
      tell(told(e) + ", and so in " + quantity(std::ssize(wrong) - 1, "other place") + " of row " + row(k) + law, {k},
           {k});
  }

  /// One side for all rows of a family, along the families that are most of one sign to each other.
  std::vector<int> by_families() const {
    std::map<std::string, std::size_t> number;
    std::vector<std::size_t> family;
    for (Index k = 0; k < mcp_.size(); ++k)
      family.push_back(number.emplace(split_name(row(k)).first, number.size()).first->second);
    std::map<std::pair<std::size_t, std::size_t>, int> weight;
    for (const Edge& e : edges_) {
      const auto [f, g] = std::minmax(family[at(e.i)], family[at(e.j)]);
      if (f != g) weight[{f, g}] += sign_of(e);
    }
    std::vector<std::pair<int, std::pair<std::size_t, std::size_t>>> links;
    for (const auto& [pair, w] : weight) links.emplace_back(w, pair);
    std::ranges::stable_sort(links, std::greater{}, [](const auto& link) { return std::abs(link.first); });
    std::vector<std::size_t> group(number.size());
    std::iota(group.begin(), group.end(), std::size_t{0});
    std::vector<int> side(number.size(), 1);
    for (const auto& [w, pair] : links) {
      const std::size_t from = group[pair.first], to = group[pair.second];
      if (from == to || w == 0) continue;
      const int turn = side[pair.first] * side[pair.second] * (w > 0 ? 1 : -1);
      for (std::size_t f = 0; f < group.size(); ++f)
        if (group[f] == to) group[f] = from, side[f] *= turn;
    }
    std::vector<int> out;
    for (const std::size_t f : family) out.push_back(side[f]);
    return out;
  }

  static void spread(Index root, std::size_t turn, const std::vector<std::vector<std::pair<Index, int>>>& neighbours,
                     std::vector<int>& side) {
    if (side[at(root)] != 0) return;
    side[at(root)] = 1;
    Indices open{root};
    for (std::size_t p = 0; p < open.size(); ++p) {
      const Index k = open[p];
      const auto& around = neighbours[at(k)];
      for (std::size_t q = 0; q < around.size(); ++q) {
        const auto& [j, sign] = around[(q + turn) % around.size()];
        if (side[at(j)] != 0) continue;
        side[at(j)] = sign * side[at(k)];
        open.push_back(j);
      }
    }
  }

  static void flip(const std::vector<std::vector<std::pair<Index, int>>>& neighbours, std::vector<int>& side) {
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t k = 0; k < side.size(); ++k) {
        int agree = 0;
        for (const auto& [j, sign] : neighbours[k]) agree += sign * side[k] * side[at(j)];
        if (agree >= 0) continue;
        side[k] = -side[k];
        changed = true;
      }
    }
  }

  const Mcp& mcp_;
  const SpMat& J_;
  std::vector<Answer>& found_;
  Indices row_of_;
  std::vector<Edge> edges_;
};

}  // namespace

bool add_mirror_faults(const Mcp& mcp, const SpMat& J, std::vector<Answer>& found) {
  return mcp.size() <= most_variables && Mirror(mcp, J, found).find();
}

}  // namespace perp::ncp
