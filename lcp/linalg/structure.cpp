// SPDX-License-Identifier: Apache-2.0
#include "lcp/linalg/structure.hpp"

#include <algorithm>

namespace perp::lcp {
namespace {

/// For every node of one side its neighbours on the other.
struct Graph {
  std::vector<Index> first{0};
  std::vector<Index> neighbours{};
  Index other_side = 0;

  Index nodes() const { return static_cast<Index>(first.size()) - 1; }
  Index begin(Index v) const { return first[at(v)]; }
  Index end(Index v) const { return first[at(v + 1)]; }
};

/// Column -> rows.
Graph columns_of(const SpMat& A, Entries entries) {
  Graph g{.other_side = A.rows()};
  g.first.reserve(at(A.cols() + 1));
  g.neighbours.reserve(at(A.nonZeros()));
  for (Index j = 0; j < A.cols(); ++j) {
    for (SpMat::InnerIterator it(A, j); it; ++it)
      if (entries == Entries::Stored || it.value() != 0) g.neighbours.push_back(it.row());
    g.first.push_back(static_cast<Index>(g.neighbours.size()));
  }
  return g;
}

Graph transposed(const Graph& g) {
  Graph t{.first = std::vector<Index>(at(g.other_side + 1), 0), .other_side = g.nodes()};
  for (const Index i : g.neighbours) ++t.first[at(i + 1)];
  for (Index i = 0; i < g.other_side; ++i) t.first[at(i + 1)] += t.first[at(i)];
  std::vector<Index> next(t.first.begin(), t.first.end() - 1);
  t.neighbours.resize(g.neighbours.size());
  for (Index j = 0; j < g.nodes(); ++j)
    for (Index k = g.begin(j); k < g.end(j); ++k) t.neighbours[at(next[at(g.neighbours[at(k)])]++)] = j;
  return t;
}

class HopcroftKarp {
 public:
  explicit HopcroftKarp(const Graph& columns)
      : g_(columns), level_(at(g_.nodes())), next_(at(g_.nodes())), row_before_(at(g_.nodes())) {
    m_.row_of_column.assign(at(g_.nodes()), -1);
    m_.column_of_row.assign(at(g_.other_side), -1);
  }

  Matching matching() {
    match_greedily();
    while (layer()) {
      next_.assign(g_.first.begin(), g_.first.end() - 1);
      for (Index j = 0; j < g_.nodes(); ++j)
        if (m_.row_of_column[at(j)] < 0 && augment(j)) ++m_.size;
    }
    return std::move(m_);
  }

 private:
  void pair(Index i, Index j) {
    m_.column_of_row[at(i)] = j;
    m_.row_of_column[at(j)] = i;
  }

  /// The diagonal, then any row that is still free.
  void match_greedily() {
    const auto match = [&](auto&& acceptable) {
      for (Index j = 0; j < g_.nodes(); ++j) {
        if (m_.row_of_column[at(j)] >= 0) continue;
        for (Index k = g_.begin(j); k < g_.end(j); ++k) {
          const Index i = g_.neighbours[at(k)];
          if (m_.column_of_row[at(i)] >= 0 || !acceptable(i, j)) continue;
          pair(i, j);
          ++m_.size;
          break;
        }
      }
    };
    match([](Index i, Index j) { return i == j; });
    match([](Index, Index) { return true; });
  }

  /// level_[j]: the length of the shortest alternating path to column j from one that is not matched; -1: none, or
  /// longer than the shortest path to a free row. False: no path ends at a free row, the matching is maximum.
  bool layer() {
    queue_.clear();
    for (Index j = 0; j < g_.nodes(); ++j) {
      level_[at(j)] = m_.row_of_column[at(j)] < 0 ? 0 : -1;
      if (level_[at(j)] == 0) queue_.push_back(j);
    }
    Index shortest = -1;
    for (std::size_t head = 0; head < queue_.size(); ++head) {
      const Index j = queue_[head];
      if (shortest >= 0 && level_[at(j)] > shortest) break;
      for (Index k = g_.begin(j); k < g_.end(j); ++k) {
        const Index onward = m_.column_of_row[at(g_.neighbours[at(k)])];
        if (onward < 0) {
          shortest = level_[at(j)];
        } else if (level_[at(onward)] < 0) {
          level_[at(onward)] = level_[at(j)] + 1;
          queue_.push_back(onward);
        }
      }
    }
    return shortest >= 0;
  }

  /// Looks for a path from column `root` down the layers to a free row, depth first; every entry is looked at once in a
  /// round. Pairs along it.
  bool augment(Index root) {
    path_.assign(1, root);
    while (!path_.empty()) {
      const Index j = path_.back();
      if (next_[at(j)] == g_.end(j)) {
        path_.pop_back();
        continue;
      }
      const Index i = g_.neighbours[at(next_[at(j)]++)];
      row_before_[at(j)] = i;
      const Index onward = m_.column_of_row[at(i)];
      if (onward < 0) {
        for (const Index column : path_) pair(row_before_[at(column)], column);
        return true;
      }
      if (level_[at(onward)] == level_[at(j)] + 1) path_.push_back(onward);
    }
    return false;
  }

  const Graph& g_;
  Matching m_;
  std::vector<Index> level_;
  std::vector<Index> next_;        ///< entry of each column to look at next
  std::vector<Index> row_before_;  ///< of a column on the path: the row it goes on by
  std::vector<Index> queue_;
  std::vector<Index> path_;
};

/// What alternating paths from the free nodes of g's side reach: nodes, and nodes of the other side.
struct Reached {
  std::vector<char> nodes;
  std::vector<char> others;
};
Reached reach(const Graph& g, const std::vector<Index>& partner, const std::vector<Index>& partner_of_other) {
  Reached r{std::vector<char>(at(g.nodes()), 0), std::vector<char>(at(g.other_side), 0)};
  std::vector<Index> queue;
  for (Index v = 0; v < g.nodes(); ++v)
    if (partner[at(v)] < 0) {
      r.nodes[at(v)] = 1;
      queue.push_back(v);
    }
  while (!queue.empty()) {
    const Index v = queue.back();
    queue.pop_back();
    for (Index k = g.begin(v); k < g.end(v); ++k) {
      const Index w = g.neighbours[at(k)];
      if (r.others[at(w)] != 0) continue;
      r.others[at(w)] = 1;
      const Index onward = partner_of_other[at(w)];  // there is one: the matching is maximum
      if (r.nodes[at(onward)] != 0) continue;
      r.nodes[at(onward)] = 1;
      queue.push_back(onward);
    }
  }
  return r;
}

}  // namespace

Matching maximum_matching(const SpMat& A, Entries entries) {
  const Graph columns = columns_of(A, entries);
  return HopcroftKarp(columns).matching();
}

Index structural_rank(const SpMat& A, Entries entries) { return maximum_matching(A, entries).size; }

Structure dulmage_mendelsohn(const SpMat& A, Entries entries) {
  const Graph columns = columns_of(A, entries);
  Structure s;
  s.matching = HopcroftKarp(columns).matching();
  s.rank = s.matching.size;
  const auto& [column_of_row, row_of_column, size] = s.matching;
  const Reached under = reach(columns, row_of_column, column_of_row);
  const Reached over = reach(transposed(columns), column_of_row, row_of_column);
  const auto part = [&](bool is_under, bool is_over) -> StructurePart& {
    return is_under ? s.under : is_over ? s.over : s.square;
  };
  for (Index i = 0; i < A.rows(); ++i) part(under.others[at(i)] != 0, over.nodes[at(i)] != 0).rows.push_back(i);
  for (Index j = 0; j < A.cols(); ++j) part(under.nodes[at(j)] != 0, over.others[at(j)] != 0).columns.push_back(j);
  return s;
}

std::vector<StructurePart> overdetermined_parts(const SpMat& A, std::size_t most, Entries entries) {
  const Graph columns = columns_of(A, entries);
  const Graph rows = transposed(columns);
  const Matching matching = HopcroftKarp(columns).matching();
  std::vector<StructurePart> parts;
  std::vector<Index> reached_from(at(A.cols()), -1);
  for (Index start = 0; start < A.rows() && parts.size() < most; ++start) {
    if (matching.column_of_row[at(start)] >= 0) continue;
    StructurePart part{.rows = {start}, .columns = {}};
    for (std::size_t head = 0; head < part.rows.size(); ++head) {
      const Index i = part.rows[head];
      for (Index k = rows.begin(i); k < rows.end(i); ++k) {
        const Index j = rows.neighbours[at(k)];
        if (reached_from[at(j)] == start) continue;
        reached_from[at(j)] = start;
        part.columns.push_back(j);
        part.rows.push_back(matching.row_of_column[at(j)]);  // there is one: the matching is maximum
      }
    }
    std::ranges::sort(part.rows);
    std::ranges::sort(part.columns);
    parts.push_back(std::move(part));
  }
  std::ranges::stable_sort(parts, {}, [](const StructurePart& part) { return part.rows.size(); });
  return parts;
}

}  // namespace perp::lcp
