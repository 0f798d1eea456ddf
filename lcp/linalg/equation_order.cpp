// SPDX-License-Identifier: Apache-2.0
#include "lcp/linalg/equation_order.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

namespace perp::lcp {
namespace {

using Hash = std::uint64_t;

Hash mixed(Hash a) {  // the finalizer of splitmix64
  a = (a ^ (a >> 30U)) * 0xBF58476D1CE4E5B9U;
  a = (a ^ (a >> 27U)) * 0x94D049BB133111EBU;
  return a ^ (a >> 31U);
}

/// What two entries have in common that may stand across the diagonal from each other; 0: no entry.
Hash key(double a) { return a == 0 ? 0 : 1 + Hash{std::bit_cast<std::uint32_t>(static_cast<float>(std::abs(a)))}; }

/// Classes of equations and free variables that may belong together. Nodes are rows 0 .. f - 1 and columns f .. 2f - 1
/// of the free ones.
class Refinement {
 public:
  Refinement(const SpMat& M, const SpMat& Mt, const std::vector<Index>& free)
      : M_(M), Mt_(Mt), free_(free), f_(free.size()), number_(at(M.rows()), -1) {
    for (std::size_t k = 0; k < f_; ++k) number_[at(free[k])] = static_cast<int>(k);
  }

  /// The row of each free variable; empty: there is no order.
  std::vector<Index> order() {
    start();
    if (!refine()) return {};
    std::vector<Index> row_of(f_);
    for (std::size_t k = 0; k < f_; ++k) {
      const std::size_t column = f_ + k;
      if (size_[at(class_[column])] > 2 && !(split_off(partner(k), column) && refine())) return {};
      const Index c = class_[column];
      const std::size_t first = member_[first_[at(c)]], second = member_[first_[at(c)] + 1];
      row_of[k] = free_[std::min(first, second)];
    }
    return row_of;
  }

 private:
  template <class Visit>
  void for_entries(std::size_t node, Visit visit) const {
    const bool row = node < f_;
    for (SpMat::InnerIterator it(row ? Mt_ : M_, free_[row ? node : node - f_]); it; ++it)
      if (const Hash k = key(it.value()); k != 0) visit(it.row(), k, row);
  }
  static Hash term(Hash k, Hash label) { return mixed(k * 0x9E3779B97F4A7C15U + mixed(label)); }
  static Hash class_label(Index c) { return 2 * static_cast<Hash>(c) + 1; }

  void start() {
    class_.assign(2 * f_, 0);
    member_.resize(2 * f_);
    std::iota(member_.begin(), member_.end(), std::size_t{0});
    place_ = member_;
    first_ = {0};
    size_ = {2 * f_};
    common_ = {0};
    sum_.assign(2 * f_, 0);
    is_dirty_.assign(2 * f_, 1);
    dirty_ = member_;
    for (std::size_t node = 0; node < 2 * f_; ++node)
      for_entries(node, [&](Index other, Hash k, bool) {
        sum_[node] += term(k, number_[at(other)] < 0 ? 2 * static_cast<Hash>(other) : class_label(0));
      });
    // Nobody has been looked at: no sum is common yet.
    while (std::ranges::find(sum_, common_[0]) != sum_.end()) ++common_[0];
  }

  /// A row of the class of column k: of twins the one that puts the largest entry onto the diagonal, so that H of twin
  /// variables keeps its own; else the natural one if it can be.
  std::size_t partner(std::size_t k) const {
    const Index c = class_[f_ + k];
    std::size_t best = 2 * f_;
    double largest = 0;
    for (SpMat::InnerIterator it(M_, free_[k]); it; ++it) {
      const int row = number_[at(it.row())];
      if (row < 0 || class_[at(row)] != c || !(std::abs(it.value()) > largest)) continue;
      best = at(row);
      largest = std::abs(it.value());
    }
    if (best < 2 * f_) return best;
    if (class_[k] == c) return k;
    std::size_t m = first_[at(c)];
    while (member_[m] >= f_) ++m;
    return member_[m];
  }

  /// Moves the nodes to a class of their own.
  void move_to_new_class(const std::vector<std::size_t>& nodes, Hash common) {
    const Index from = class_[nodes.front()];
    const auto c = static_cast<Index>(first_.size());
    for (const std::size_t node : nodes) {  // to the end of its class
      const std::size_t last = first_[at(from)] + --size_[at(from)];
      const std::size_t other = member_[last];
      std::swap(member_[place_[node]], member_[last]);
      std::swap(place_[node], place_[other]);
      moved_.push_back({node, from});
      class_[node] = c;
    }
    first_.push_back(first_[at(from)] + size_[at(from)]);
    size_.push_back(nodes.size());
    common_.push_back(common);
  }

  bool split_off(std::size_t row, std::size_t column) {
    move_to_new_class({row, column}, sum_[row]);
    tell_neighbours();
    return true;
  }

  /// The sums of those whose neighbours have moved.
  void tell_neighbours() {
    for (const auto& [node, from] : moved_) {
      const Hash label = class_label(class_[node]), before = class_label(from);
      for_entries(node, [&, node = node](Index other, Hash k, bool row) {
        const int n = number_[at(other)];
        if (n < 0) return;
        const std::size_t neighbour = at(n) + (row ? f_ : 0);
        sum_[neighbour] += term(k, label) - term(k, before);
        if (std::exchange(is_dirty_[neighbour], 1) == 0) dirty_.push_back(neighbour);
      });
    }
    moved_.clear();
  }

  /// Until members of a class have the same neighbours. False: a class has more rows than columns, or fewer.
  bool refine() {
    std::vector<std::size_t> round, group;
    while (!dirty_.empty()) {
      round.clear();
      round.swap(dirty_);
      for (const std::size_t node : round) is_dirty_[node] = 0;
      std::erase_if(round, [&](std::size_t node) { return sum_[node] == common_[at(class_[node])]; });
      std::sort(round.begin(), round.end(), [&](std::size_t a, std::size_t b) {
        return std::tuple(class_[a], sum_[a], a) < std::tuple(class_[b], sum_[b], b);
      });
      for (std::size_t begin = 0, end = 0; begin < round.size(); begin = end) {
        const Index c = class_[round[begin]];
        for (end = begin; end < round.size() && class_[round[end]] == c;) ++end;
        if (!split(c, {round.data() + begin, round.data() + end}, group)) return false;
      }
      tell_neighbours();
    }
    return true;
  }

  /// The members of class c whose sums are not the common one any more, sorted by their sums.
  bool split(Index c, std::span<const std::size_t> changed, std::vector<std::size_t>& group) {
    struct Run {
      std::size_t begin, end;
    };
    std::vector<Run> runs;
    for (std::size_t begin = 0, end = 0; begin < changed.size(); begin = end) {
      for (end = begin; end < changed.size() && sum_[changed[end]] == sum_[changed[begin]];) ++end;
      runs.push_back({begin, end});
    }
    if (changed.size() == size_[at(c)]) {  // nobody is left in it: the most numerous stay
      const auto most = std::ranges::max_element(runs, {}, [](const Run& r) { return r.end - r.begin; });
      common_[at(c)] = sum_[changed[most->begin]];
      if (!balanced(changed.subspan(most->begin, most->end - most->begin))) return false;
      runs.erase(most);
    }
    for (const Run& run : runs) {
      const auto part = changed.subspan(run.begin, run.end - run.begin);
      if (!balanced(part)) return false;
      group.assign(part.begin(), part.end());
      move_to_new_class(group, sum_[group.front()]);
    }
    return true;
  }

  bool balanced(std::span<const std::size_t> nodes) const {
    return 2 * std::ranges::count_if(nodes, [&](std::size_t node) { return node < f_; }) == std::ssize(nodes);
  }

  const SpMat& M_;
  const SpMat& Mt_;
  const std::vector<Index>& free_;
  std::size_t f_;
  std::vector<int> number_;                ///< of a variable among the free ones, or -1
  std::vector<Index> class_;               ///< of each node
  std::vector<std::size_t> member_;        ///< nodes by classes
  std::vector<std::size_t> place_;         ///< of each node in member_
  std::vector<std::size_t> first_, size_;  ///< of each class in member_
  std::vector<Hash> common_;               ///< of each class: the sum of its members
  std::vector<Hash> sum_;                  ///< of each node: over its entries and where they lead
  std::vector<char> is_dirty_;
  std::vector<std::size_t> dirty_;  ///< nodes whose sum has changed
  struct Moved {
    std::size_t node;
    Index from;
  };
  std::vector<Moved> moved_;
};

/// Whether the keys of M_ij and M_ji agree, row i being row_of[i].
bool symmetric_in_order(const SpMat& M, const SpMat& Mt, const std::vector<Index>& row_of) {
  std::vector<Index> pair_of(row_of.size());
  for (std::size_t i = 0; i < row_of.size(); ++i) pair_of[at(row_of[i])] = static_cast<Index>(i);
  std::vector<Hash> there(row_of.size(), 0);
  for (Index j = 0; j < M.cols(); ++j) {
    Index count = 0;
    for (SpMat::InnerIterator it(M, j); it; ++it) {  // column j, by pairs
      there[at(pair_of[at(it.row())])] = key(it.value());
      count += it.value() != 0;
    }
    bool same = true;
    for (SpMat::InnerIterator it(Mt, row_of[at(j)]); it && same; ++it) {  // row j, by columns
      same = key(it.value()) == 0 || key(it.value()) == there[at(it.row())];
      count -= it.value() != 0;
    }
    for (SpMat::InnerIterator it(M, j); it; ++it) there[at(pair_of[at(it.row())])] = 0;
    if (!same || count != 0) return false;
  }
  return true;
}

/// Signs of equations with which no diagonal entry is negative, rows without one are skew to all others, and rows with
/// one that were symmetric stay so; nothing where there are none.
std::optional<Vec> signs(const SpMat& M, const SpMat& Mt, const std::vector<Index>& row_of,
                         const std::vector<char>& is_free) {
  const Index n = M.rows();
  std::vector<Index> pair_of(row_of.size());
  for (Index i = 0; i < n; ++i) pair_of[at(row_of[at(i)])] = i;
  Vec diagonal(n);
  for (Index i = 0; i < n; ++i) diagonal[i] = M.coeff(row_of[at(i)], i);
  Vec sign = Vec::Zero(n);
  std::vector<Index> open;
  for (Index i = 0; i < n; ++i)
    if (is_free[at(i)] == 0 || diagonal[i] != 0) {
      sign[i] = is_free[at(i)] != 0 && diagonal[i] < 0 ? -1 : 1;
      open.push_back(i);
    }
  Vec column = Vec::Zero(n);
  bool consistent = true;
  const auto follow = [&] {
    while (!open.empty() && consistent) {
      const Index j = open.back();
      open.pop_back();
      for (SpMat::InnerIterator it(M, j); it; ++it) column[pair_of[at(it.row())]] = it.value();
      for (SpMat::InnerIterator it(Mt, row_of[at(j)]); it; ++it) {  // M_ji beside M_ij
        const Index i = it.row();
        const double product = it.value() * column[i];
        if (i == j || product == 0 || (is_free[at(i)] == 0 && is_free[at(j)] == 0)) continue;
        if (diagonal[i] != 0 && diagonal[j] != 0) {  // what is symmetric stays so
          consistent = consistent && (product < 0 || sign[i] == sign[j]);
          continue;
        }
        const double wanted = product < 0 ? sign[j] : -sign[j];
        if (sign[i] == 0) open.push_back(i), sign[i] = wanted;
        consistent = consistent && sign[i] == wanted;
      }
      for (SpMat::InnerIterator it(M, j); it; ++it) column[pair_of[at(it.row())]] = 0;
    }
  };
  follow();
  for (Index i = 0; i < n && consistent; ++i)
    if (sign[i] == 0) open.push_back(i), sign[i] = 1, follow();
  if (!consistent) return std::nullopt;
  return sign;
}

}  // namespace

AffineMcp EquationOrder::apply(const AffineMcp& problem) const {
  std::vector<int> pair_of(row_of.size());
  for (std::size_t i = 0; i < row_of.size(); ++i) pair_of[at(row_of[i])] = static_cast<int>(i);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(at(problem.M.nonZeros()));
  for (Index j = 0; j < problem.size(); ++j)
    for (SpMat::InnerIterator it(problem.M, j); it; ++it) {
      const int i = pair_of[at(it.row())];
      entries.emplace_back(i, static_cast<int>(j), sign[i] * it.value());
    }
  AffineMcp ordered{.M = SpMat(problem.size(), problem.size()), .q = Vec(problem.size()), .box = problem.box};
  ordered.M.setFromTriplets(entries.begin(), entries.end());
  for (Index i = 0; i < problem.size(); ++i) ordered.q[i] = sign[i] * problem.q[row_of[at(i)]];
  return ordered;
}

Vec EquationOrder::multipliers_back(In y) const {
  Vec there(y.size());
  for (Index i = 0; i < y.size(); ++i) there[row_of[at(i)]] = sign[i] * y[i];
  return there;
}

namespace {

void reorder(const EquationOrder& order, Refutation::Proof& proof) {
  for (Multiplier& m : proof.y) {
    const double sign = order.sign[m.row];
    m = {order.row_of[at(m.row)], sign * m.high, sign * m.low};
  }
  std::ranges::sort(proof.y, {}, &Multiplier::row);
  for (Refutation::Assumption& assumption : proof.assumptions) reorder(order, assumption.refuted);
}

}  // namespace

Refutation EquationOrder::back(Refutation refutation) const {
  reorder(*this, refutation.proof);
  return refutation;
}

std::optional<EquationOrder> equation_order(const SpMat& M, const Box& box) {
  std::vector<Index> free;
  std::vector<char> is_free(at(M.rows()), 0);
  for (Index i = 0; i < M.rows(); ++i)
    if (box.is_free(i)) {
      free.push_back(i);
      is_free[at(i)] = 1;
    }
  if (free.empty() || std::ssize(free) == M.rows()) return std::nullopt;
  const SpMat Mt = M.transpose();
  std::vector<Index> natural(at(M.rows()));
  std::iota(natural.begin(), natural.end(), Index{0});
  std::vector<Index> row_of = natural;
  if (!symmetric_in_order(M, Mt, natural)) {
    const std::vector<Index> found = Refinement(M, Mt, free).order();
    if (found.empty()) return std::nullopt;
    for (std::size_t k = 0; k < free.size(); ++k) row_of[at(free[k])] = found[k];
    if (!symmetric_in_order(M, Mt, row_of)) return std::nullopt;
  }
  const std::optional<Vec> sign = signs(M, Mt, row_of, is_free);
  if (!sign || (row_of == natural && (sign->array() > 0).all())) return std::nullopt;
  return EquationOrder{std::move(row_of), *sign};
}

}  // namespace perp::lcp
