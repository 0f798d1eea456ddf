// SPDX-License-Identifier: Apache-2.0
#include "contact/model/forms.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

namespace perp::contact {
namespace {

/// W may have so many times the entries of the parts, not more: it is to save time, and not to cost memory.
constexpr double most_entries = 3;
/// Solves, products with W or its parts, and sweeps for each factorization, in a typical run of the default method.
/// Weighed so, spheres, walls, arches, stacks, chains and inclines of 30 to 3,000 contacts get the form that takes
/// fewer instructions.
constexpr double solves = 3;
constexpr double products = 10;
constexpr double sweeps = 1;
/// A solve by bodies is two of them, as it is refined, with so many products of the system.
constexpr double refinements = 2;

using Lists = std::vector<std::vector<int>>;

/// What has a column of A in its rows, by contacts: those rows of each, ascending.
Lists rows_of(const SpMat& A, const std::vector<Scaled::Block>& blocks) {
  Lists rows;
  for (const Scaled::Block& block : blocks) {
    std::vector<int>& of = rows.emplace_back();
    for (int k = 0; k < block.size; ++k)
      for (SpMat::InnerIterator it(A, block.first + k); it; ++it) of.push_back(static_cast<int>(it.row()));
    std::sort(of.begin(), of.end());
    of.erase(std::unique(of.begin(), of.end()), of.end());
  }
  return rows;
}

/// For each number below n the lists that have it, ascending.
Lists turned(const Lists& lists, Index n) {
  Lists out(at(n));
  for (std::size_t a = 0; a < lists.size(); ++a)
    for (const int i : lists[a]) out[at(i)].push_back(static_cast<int>(a));
  return out;
}

/// A square pattern, made column by column.
class Pattern {
 public:
  explicit Pattern(Index n) : pattern_(n, n), seen_(at(n), -1) {}

  void begin(int column) {
    column_ = column;
    rows_.clear();
  }
  void add(int row) {
    if (std::exchange(seen_[at(row)], column_) != column_) rows_.push_back(row);
  }
  const std::vector<int>& end() {
    std::sort(rows_.begin(), rows_.end());
    pattern_.startVec(column_);
    for (const int row : rows_) pattern_.insertBack(row, column_) = 1;
    return rows_;
  }
  SpMat take() {
    pattern_.finalize();
    return std::move(pattern_);
  }

 private:
  SpMat pattern_;
  std::vector<int> seen_;  // in which column last
  std::vector<int> rows_;
  int column_ = 0;
};

/// A symmetric matrix of dense blocks of one size, by the pattern of its blocks.
struct Blocks {
  SpMat pattern;
  double size = 1;
};

/// W, by contacts; nothing where it would have more than `most` entries.
std::optional<Blocks> blocks_of_W(const SpMat& shares, const std::vector<Scaled::Block>& blocks, double most) {
  Lists contacts = turned(rows_of(shares, blocks), shares.rows());
  std::sort(contacts.begin(), contacts.end());  // bodies of the same contacts count once
  contacts.erase(std::unique(contacts.begin(), contacts.end()), contacts.end());
  const Lists bodies = turned(contacts, static_cast<Index>(blocks.size()));
  Pattern coupled(static_cast<Index>(blocks.size()));
  double entries = 0;
  for (std::size_t a = 0; a < blocks.size() && entries <= most; ++a) {
    coupled.begin(static_cast<int>(a));
    for (const int body : bodies[a])
      for (const int b : contacts[at(body)]) coupled.add(b);
    for (const int b : coupled.end()) entries += blocks[a].size * blocks[at(b)].size;
  }
  if (entries > most) return std::nullopt;
  return Blocks{.pattern = coupled.take(),
                .size = static_cast<double>(shares.cols()) / static_cast<double>(blocks.size())};
}

/// M + H E H', by groups of velocities that the same contacts have in H: those of a rigid body, or most of them. Their
/// mean size stands for all.
Blocks blocks_of_bodies(const SpMat& M, const SpMat& H, const std::vector<Scaled::Block>& blocks) {
  const Lists rows = rows_of(H, blocks);
  const Lists contacts = turned(rows, H.rows());
  std::map<std::vector<int>, int> known;
  std::vector<int> group;
  Lists members;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    auto of = static_cast<int>(members.size());
    if (!contacts[i].empty()) of = known.try_emplace(contacts[i], of).first->second;
    if (of == static_cast<int>(members.size())) members.emplace_back();
    members[at(of)].push_back(static_cast<int>(i));
    group.push_back(of);
  }
  Pattern K(static_cast<Index>(members.size()));
  for (std::size_t g = 0; g < members.size(); ++g) {
    K.begin(static_cast<int>(g));
    for (const int j : members[g])
      for (SpMat::InnerIterator it(M, j); it; ++it) K.add(group[at(it.row())]);
    for (const int a : contacts[at(members[g].front())])
      for (const int i : rows[at(a)]) K.add(group[at(i)]);
    K.end();
  }
  return {.pattern = K.take(), .size = static_cast<double>(M.rows()) / static_cast<double>(members.size())};
}

struct Work {
  double factor = 0;  // operations of Cholesky's factorization
  double solve = 0;
  double entries = 0;  // of the matrix
};

/// Nothing where L does not fit.
std::optional<Work> work_of(const Blocks& matrix) {
  lcp::Cholesky cholesky;
  if (cholesky.analyze(matrix.pattern) != lcp::CholeskyStatus::Ok) return std::nullopt;
  const double square = matrix.size * matrix.size;
  return Work{.factor = square * matrix.size * cholesky.flops(),
              .solve = 4 * square * cholesky.nonzeros(),
              .entries = square * static_cast<double>(matrix.pattern.nonZeros())};
}

/// What it takes without fill, and as a dense matrix.
Work least_work(const Blocks& matrix) {
  const double entries = matrix.size * matrix.size * static_cast<double>(matrix.pattern.nonZeros());
  return {.factor = 0, .solve = 2 * entries, .entries = entries};
}
Work most_work(const Blocks& matrix) {
  const double rows = matrix.size * static_cast<double>(matrix.pattern.rows());
  return {.factor = rows * rows * rows / 3, .solve = 2 * rows * (rows + 1), .entries = least_work(matrix).entries};
}

double with_entries(const Work& W) {
  constexpr double assembly = 6;  // an entry
  return W.factor + solves * W.solve + (assembly + 2 * (products + sweeps)) * W.entries;
}

double with_bodies(const Work& K, const DelassusParts& parts, const std::vector<Scaled::Block>& blocks) {
  const SpMat& H = parts.H();
  double product = 0;
  double sweep = 0;
  if (parts.root() != nullptr) {
    product = sweep = 4 * static_cast<double>(parts.root()->nonZeros());
  } else {
    const double inverse = 4 * parts.inertia().entries_of_factor();
    product = 4 * static_cast<double>(H.nonZeros()) + inverse;
    sweep = 4 * static_cast<double>(H.nonZeros()) + inverse * static_cast<double>(blocks.size());
  }
  double assembly = 0;
  for (const Scaled::Block& block : blocks) {
    const auto entries = static_cast<double>(H.middleCols(block.first, block.size).nonZeros());
    assembly += 2 * entries * entries / block.size;
  }
  const double of_lu = parts.inertia().by_lu() ? 2 : 1;  // of Cholesky's work
  const double solve = refinements * (of_lu * K.solve + 4 * static_cast<double>(H.nonZeros()) + product);
  return of_lu * K.factor + solves * solve + products * product + sweeps * sweep + assembly;
}

}  // namespace

bool entries_take_less(const DelassusParts& parts, const std::vector<Scaled::Block>& blocks) {
  if (blocks.empty()) return false;
  const double most = most_entries * (static_cast<double>(parts.H().nonZeros() + parts.M().nonZeros()) +
                                      parts.inertia().entries_of_factor());
  const std::optional<Blocks> of_W = blocks_of_W(parts.shares(), blocks, most);
  if (!of_W) return false;
  const Blocks of_K = blocks_of_bodies(parts.M(), parts.H(), blocks);
  // Small problems need no analysis.
  if (with_entries(most_work(*of_W)) < with_bodies(least_work(of_K), parts, blocks)) return true;
  if (with_entries(least_work(*of_W)) >= with_bodies(most_work(of_K), parts, blocks)) return false;
  const std::optional<Work> W = work_of(*of_W);
  const std::optional<Work> K = work_of(of_K);
  return W && K && with_entries(*W) < with_bodies(*K, parts, blocks);
}

}  // namespace perp::contact
