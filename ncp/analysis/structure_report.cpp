// SPDX-License-Identifier: Apache-2.0
#include "ncp/analysis/structure_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <sstream>

#include "lcp/linalg/blocks.hpp"
#include "lcp/lu/sparse_lu.hpp"
#include "lcp/words.hpp"
#include "ncp/problem/counted_mcp.hpp"
#include "ncp/problem/words.hpp"

namespace perp::ncp {
namespace {

using Indices = std::vector<Index>;

constexpr std::size_t few = 5;        // names in a list
constexpr double at_bound = 1e-10;    // relative to 1 + |bound|
constexpr double parallel = 1e-12;    // relative difference of entries
constexpr double singular = 1e-13;    // reciprocal condition of the equilibrated block
constexpr double null = 1e-9;         // || y'B || for || y || = 1, equilibrated: as good as 0
constexpr double takes_part = 1e-3;   // share of the largest entry of a null vector
constexpr std::size_t few_pairs = 3;  // parallel pairs told

/// J_AA without entries that are zero.
SpMat block_of(const SpMat& J, const Indices& block) {
  SpMat B = lcp::principal_block(J, block);
  B.prune([](Index, Index, double value) { return value != 0; });
  return B;
}

Indices renumbered(const Indices& indices, const Indices& block) {
  Indices out;
  for (const Index i : indices) out.push_back(block[at(i)]);
  return out;
}

Indices empty_columns(const SpMat& A) {
  Indices empty;
  for (Index j = 0; j < A.cols(); ++j)
    if (A.outerIndexPtr()[j] == A.outerIndexPtr()[j + 1]) empty.push_back(j);
  return empty;
}

struct Pair {
  Index first, second;
  double factor;  ///< second = factor * first
};
/// Columns of A that are multiples of an earlier one, found by their pattern and their entries to six digits.
std::vector<Pair> parallel_columns(const SpMat& A) {
  std::vector<std::pair<std::uint64_t, Index>> keys;
  for (Index j = 0; j < A.cols(); ++j) {
    std::uint64_t key = 1;
    double first = 0;
    const auto mix = [&key](std::uint64_t value) {
      key = (key ^ value) * 0x9E3779B97F4A7C15U;
      key ^= key >> 29U;
    };
    for (SpMat::InnerIterator it(A, j); it; ++it) {
      if (first == 0) first = it.value();
      mix(static_cast<std::uint64_t>(it.row()));
      mix(static_cast<std::uint64_t>(std::llround(std::clamp(it.value() / first, -1e9, 1e9) * 1e6)));
    }
    if (first != 0) keys.emplace_back(key, j);
  }
  std::sort(keys.begin(), keys.end());
  const auto factor = [&](Index a, Index b) {  // 0: not parallel
    SpMat::InnerIterator p(A, a), q(A, b);
    const double t = q.value() / p.value();
    for (; p && q; ++p, ++q)
      if (p.row() != q.row() || !(std::abs(q.value() - t * p.value()) <= parallel * std::abs(q.value()))) return 0.0;
    return p || q ? 0.0 : t;
  };
  std::vector<Pair> pairs;
  for (std::size_t k = 1; k < keys.size(); ++k) {
    if (keys[k].first != keys[k - 1].first) continue;
    if (const double t = factor(keys[k - 1].second, keys[k].second); t != 0)
      pairs.push_back({keys[k - 1].second, keys[k].second, t});
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.first < b.first; });
  return pairs;
}

/// The matrix with rows and columns divided by their largest entries, so that units do not pass for singularity.
SpMat equilibrated(SpMat B) {
  double* values = B.valuePtr();
  for (int sweep = 0; sweep < 3; ++sweep) {
    Vec row_max = Vec::Zero(B.rows());
    for (Index p = 0; p < B.nonZeros(); ++p) {
      double& largest = row_max[B.innerIndexPtr()[p]];
      largest = std::max(largest, std::abs(values[p]));
    }
    for (Index j = 0; j < B.cols(); ++j) {
      double column_max = 0;
      for (Index p = B.outerIndexPtr()[j]; p < B.outerIndexPtr()[j + 1]; ++p) {
        values[p] /= row_max[B.innerIndexPtr()[p]];
        column_max = std::max(column_max, std::abs(values[p]));
      }
      for (Index p = B.outerIndexPtr()[j]; p < B.outerIndexPtr()[j + 1]; ++p) values[p] /= column_max;
    }
  }
  return B;
}

/// Indices with a share in y, || y ||_inf = 1, where y'B (or B y) is as good as 0; empty if there is no such y. Inverse
/// iteration with B + delta I, which is regular for almost all delta; but hardly so where left and right null vector
/// are nearly orthogonal, and then the iterates after the first are rounding: the best one counts.
struct NullVectors {
  Indices rows, columns;
};
NullVectors null_vectors(const SpMat& B) {
  NullVectors found;
  lcp::SparseLu lu;
  const lcp::LuStatus status = lu.factor(B);
  if (status != lcp::LuStatus::Ok && status != lcp::LuStatus::Singular) return found;
  if (status == lcp::LuStatus::Ok && lu.rcond() > singular) return found;
  SpMat identity(B.rows(), B.cols());
  identity.setIdentity();
  if (lu.factor(B + 1e-11 * identity) != lcp::LuStatus::Ok) return found;
  const auto iterate = [&](bool transposed) {
    Vec y(B.rows()), z(B.rows());
    for (Index i = 0; i < y.size(); ++i) y[i] = 1 + 0.5 * std::sin(static_cast<double>(i + 1));  // like no null vector
    Vec best = y;
    double least = lcp::infinity;
    for (int k = 0; k < 3; ++k) {
      transposed ? lu.solve_transposed(y, z) : lu.solve(y, z);
      const double size = z.lpNorm<Eigen::Infinity>();
      if (!(size > 0) || !std::isfinite(size)) return Indices{};
      y = z / size;
      const Vec product = transposed ? Vec(B.transpose() * y) : Vec(B * y);
      if (product.lpNorm<Eigen::Infinity>() < least) {
        least = product.lpNorm<Eigen::Infinity>();
        best = y;
      }
    }
    Indices share;
    if (least <= null)
      for (Index i = 0; i < best.size(); ++i)
        if (std::abs(best[i]) >= takes_part) share.push_back(i);
    return share;
  };
  found.rows = iterate(true);
  found.columns = iterate(false);
  return found;
}

std::string pairs_text(const std::vector<Pair>& pairs, const Indices& block, const char* what,
                       const std::function<std::string(Index)>& name) {
  std::ostringstream text;
  for (std::size_t k = 0; k < std::min(pairs.size(), few_pairs); ++k) {
    text << (k > 0 ? ", " : "") << what << ' ' << name(block[at(pairs[k].second)]) << " is " << pairs[k].factor
         << " times that of " << name(block[at(pairs[k].first)]);
  }
  if (pairs.size() > few_pairs) text << " (and " << pairs.size() - few_pairs << " more such pairs)";
  return text.str();
}

/// Of a block that no structure explains.
std::vector<std::string> numerical(const Mcp& mcp, const SpMat& B, const Indices& block) {
  std::vector<std::string> found;
  const auto equation = [&](Index i) { return mcp.equation_name(i); };
  const auto variable = [&](Index i) { return mcp.variable_name(i); };
  if (const auto rows = parallel_columns(B.transpose()); !rows.empty())
    found.push_back(pairs_text(rows, block, "the gradient of equation", equation));
  if (const auto columns = parallel_columns(B); !columns.empty())
    found.push_back(pairs_text(columns, block, "the column of variable", variable));
  if (!found.empty()) return found;
  const NullVectors null_space = null_vectors(equilibrated(B));
  const Indices rows = renumbered(null_space.rows, block);
  const Indices columns = renumbered(null_space.columns, block);
  if (!rows.empty())
    found.push_back(rows.size() == 1 ? "equation " + equation(rows[0]) + " hardly changes"
                                     : "a combination of " + quantity(std::ssize(rows), "equation") +
                                           " does not change with any variable (" + listed_equations(mcp, rows) + ")");
  if (!columns.empty())
    found.push_back(columns.size() == 1 ? "variable " + variable(columns[0]) + " hardly changes any equation"
                                        : quantity(std::ssize(columns), "variable") +
                                              " can move together without changing any equation (" +
                                              listed_variables(mcp, columns) + ")");
  return found;
}

void expect_sizes(const Mcp& mcp, const SpMat& J, In x, In F) {
  const Index n = mcp.size();
  if (J.rows() == n && J.cols() == n && x.size() == n && F.size() == n) return;
  refuse_input(mcp.name(), ": explain_singularity: J is ", J.rows(), " x ", J.cols(), ", x has ", x.size(),
               " entries, F ", F.size(), ", for ", n, " variables");
}

}  // namespace

std::string listed(std::size_t count, const std::function<std::string(std::size_t)>& name) {
  const std::size_t shown = count <= few + 1 ? count : few;
  std::string text;
  for (std::size_t k = 0; k < shown; ++k) text += (k == 0 ? "" : k + 1 == count ? " and " : ", ") + name(k);
  return count > shown ? text + " and " + std::to_string(count - shown) + " more" : text;
}

std::string listed_variables(const Mcp& mcp, const Indices& variables) {
  return listed(variables.size(), [&](std::size_t k) { return mcp.variable_name(variables[k]); });
}

std::string listed_equations(const Mcp& mcp, const Indices& equations) {
  return listed(equations.size(), [&](std::size_t k) { return mcp.equation_name(equations[k]); });
}

std::vector<std::string> describe_parts(const Mcp& mcp, const lcp::StructurePart& over,
                                        const lcp::StructurePart& under) {
  std::vector<std::string> text;
  if (!over.columns.empty())
    text.push_back("too many equations: " + quantity(std::ssize(over.rows), "row") + " (" +
                   listed_equations(mcp, over.rows) + ") for " + quantity(std::ssize(over.columns), "variable") + " (" +
                   listed_variables(mcp, over.columns) + ")");
  if (!under.rows.empty())
    text.push_back("too many unknowns: " + quantity(std::ssize(under.columns), "variable") + " (" +
                   listed_variables(mcp, under.columns) + ") in " + quantity(std::ssize(under.rows), "row") + " (" +
                   listed_equations(mcp, under.rows) + ")");
  return text;
}

std::vector<Index> active_block(const Box& box, In x, In F) {
  Indices block;
  for (Index i = 0; i < box.size(); ++i) {
    const double l = box.lower[i], u = box.upper[i];
    if (l == u) continue;
    const bool at_lower = std::isfinite(l) && x[i] - l <= at_bound * (1 + std::abs(l));
    const bool at_upper = std::isfinite(u) && u - x[i] <= at_bound * (1 + std::abs(u));
    if ((!at_lower || F[i] < 0) && (!at_upper || F[i] > 0)) block.push_back(i);
  }
  return block;
}

std::string explain_singularity(const Mcp& mcp, const SpMat& J, In x, In F) {
  expect_sizes(mcp, J, x, F);
  if (!x.allFinite() || !F.allFinite() || !J.coeffs().allFinite()) return {};
  const Indices block = active_block(mcp.box(), x, F);
  if (block.empty()) return {};
  const SpMat B = block_of(J, block);
  std::vector<std::string> found;
  const lcp::Structure parts = lcp::dulmage_mendelsohn(B);
  if (parts.rank < B.rows()) {
    const Indices rows = renumbered(empty_columns(B.transpose()), block);
    const Indices columns = renumbered(empty_columns(B), block);
    if (!rows.empty())
      found.push_back((rows.size() == 1 ? "1 equation depends on none of them ("
                                        : std::to_string(rows.size()) + " equations depend on none of them (") +
                      listed_equations(mcp, rows) + ")");
    if (!columns.empty())
      found.push_back((columns.size() == 1
                           ? "1 variable is in none of their equations ("
                           : std::to_string(columns.size()) + " variables are in none of their equations (") +
                      listed_variables(mcp, columns) + ")");
    const auto original = [&](const lcp::StructurePart& part) {
      return lcp::StructurePart{renumbered(part.rows, block), renumbered(part.columns, block)};
    };
    // Empty rows and columns have been told.
    lcp::StructurePart over = original(parts.over), under = original(parts.under);
    std::erase_if(over.rows, [&](Index i) { return std::binary_search(rows.begin(), rows.end(), i); });
    std::erase_if(under.columns, [&](Index j) { return std::binary_search(columns.begin(), columns.end(), j); });
    for (std::string& text : describe_parts(mcp, over, under)) found.push_back(std::move(text));
  } else {
    found = numerical(mcp, B, block);
  }
  if (found.empty()) return {};
  std::string text =
      "the Jacobian of the " + quantity(std::ssize(block), "variable") + " off their bounds is singular: ";
  if (block.size() == 1) text = "the Jacobian of the variable off its bounds is singular: ";
  for (std::size_t k = 0; k < found.size(); ++k) text += (k > 0 ? "; " : "") + found[k];
  return text;
}

}  // namespace perp::ncp
