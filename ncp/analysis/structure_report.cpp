// SPDX-License-Identifier: Apache-2.0
#include "ncp/analysis/structure_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <sstream>

#include "lcp/linalg/blocks.hpp"
#include "lcp/linalg/plainly_regular.hpp"
#include "lcp/linalg/quasi_definite.hpp"
#include "lcp/lu/sparse_lu.hpp"
#include "lcp/words.hpp"
#include "ncp/problem/counted_mcp.hpp"
#include "ncp/problem/residual.hpp"
#include "ncp/problem/words.hpp"

namespace perp::ncp {
namespace {

using Indices = std::vector<Index>;

constexpr std::size_t few = 5;                // names in a list
constexpr double at_bound = 1e-10;            // relative to 1 + |bound|
constexpr double parallel = 1e-12;            // relative difference of entries
constexpr double singular = 1e-13;            // reciprocal condition of the equilibrated block
constexpr double singular_direction = 1e-11;  // || B y || for || y || = 1 that needs no condition number
constexpr double null = 1e-9;                 // || y'B || for || y || = 1, equilibrated: as good as 0
constexpr double takes_part = 1e-3;           // share of the largest entry of a null vector
constexpr std::size_t few_pairs = 3;          // parallel pairs told

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

/// The matrix with rows and columns divided by their largest entries, so that units do not pass for singularity. Sets
/// the factors of its columns.
SpMat equilibrated(SpMat B, Vec* columns = nullptr) {
  double* values = B.valuePtr();
  if (columns != nullptr) *columns = Vec::Ones(B.cols());
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
      if (columns != nullptr && column_max > 0) (*columns)[j] /= column_max;
    }
  }
  return B;
}

/// Factors of B + delta I for a square B that is singular to working precision. They are symmetric ones where B is a
/// quadratic program's, which takes a fifth of the time, else those of an LU.
class Shifted {
 public:
  /// Nothing if B is regular, or if it cannot be factored.
  static std::optional<Shifted> if_singular(const SpMat& B, double least_rcond = singular) {
    if (least_rcond <= singular && lcp::plainly_regular(B)) return std::nullopt;
    std::optional<Shifted> shifted(std::in_place);
    bool regular = false;
    if (shifted->factor_symmetric(B, regular) || (!regular && shifted->factor_by_lu(B, least_rcond))) return shifted;
    return std::nullopt;
  }

  /// y, || y ||_inf = 1, where B y (or y'B) is as good as 0; empty if there is no such y. By inverse iteration, which
  /// is hardly one where left and right null vector are nearly orthogonal, and then the iterates after the first are
  /// rounding: the best one counts.
  Vec null_vector(const SpMat& B, bool transposed, double most = null) {
    Vec y = generic(B.rows()), best = y;
    double least = lcp::infinity;
    for (int k = 0; k < 3; ++k) {
      const Vec z = solved(y, transposed);
      const double size = z.lpNorm<Eigen::Infinity>();
      if (!(size > 0) || !std::isfinite(size)) return {};
      y = z / size;
      const Vec product = transposed ? Vec(B.transpose() * y) : Vec(B * y);
      if (product.lpNorm<Eigen::Infinity>() < least) {
        least = product.lpNorm<Eigen::Infinity>();
        best = y;
      }
    }
    return least <= most ? best : Vec{};
  }

 private:
  /// A vector like no null vector.
  static Vec generic(Index n) {
    return Vec::NullaryExpr(n, [](Index i) { return 1 + 0.5 * std::sin(static_cast<double>(i + 1)); });
  }

  /// False without a null vector. `regular`: there is none, as a solution for a generic vector is short.
  bool factor_symmetric(const SpMat& B, bool& regular) {
    constexpr double delta = 1e-8;  // the root of the rounding: neither it nor the factors' error hides the other
    symmetric_.emplace();
    const SpMat M = lcp::with_diagonal(B);
    if (symmetric_->analyze(M) && symmetric_->factor(Vec::Constant(M.rows(), delta))) {
      // With a null vector the solution is about 1 / (delta sqrt(n)) long at the least.
      const double length = solved(generic(B.rows()), false).lpNorm<Eigen::Infinity>();
      regular = length < 0.01 / delta / std::sqrt(static_cast<double>(B.rows()));
      if (!regular && null_vector(B, false, singular_direction).size() > 0) return true;
    }
    symmetric_.reset();
    return false;
  }

  bool factor_by_lu(const SpMat& B, double least_rcond) {
    const lcp::LuStatus status = lu_.factor(B);
    if (status != lcp::LuStatus::Ok && status != lcp::LuStatus::Singular) return false;
    if (status == lcp::LuStatus::Ok && lu_.rcond() > least_rcond) return false;
    SpMat identity(B.rows(), B.cols());
    identity.setIdentity();
    return lu_.factor(B + 1e-11 * identity) == lcp::LuStatus::Ok;
  }

  /// With R (B + delta I) symmetric, the transpose of B + delta I is R (B + delta I) R^-1.
  Vec solved(const Vec& b, bool transposed) {
    Vec x(b.size());
    if (symmetric_) {
      const Vec& R = symmetric_->rows();
      symmetric_->solve(transposed ? Vec(b.cwiseQuotient(R)) : b, x);
      if (transposed) x = x.cwiseProduct(R);
    } else {
      transposed ? lu_.solve_transposed(b, x) : lu_.solve(b, x);
    }
    return x;
  }

  std::optional<lcp::QuasiDefinite> symmetric_;
  lcp::SparseLu lu_{lcp::LuBackend::General};
};

Indices share_of(const Vec& y) {
  Indices out;
  for (Index i = 0; i < y.size(); ++i)
    if (std::abs(y[i]) >= takes_part) out.push_back(i);
  return out;
}

/// Indices with a share in null vectors of the equilibrated B.
struct NullVectors {
  Indices rows, columns;
};
NullVectors null_vectors(const SpMat& B, Shifted& shifted) {
  return {share_of(shifted.null_vector(B, true)), share_of(shifted.null_vector(B, false))};
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

std::string moving_together(const Mcp& mcp, const Indices& variables) {
  return quantity(std::ssize(variables), "variable") + " can move together without changing any equation (" +
         listed_variables(mcp, variables) + ")";
}

/// Explains a block that no structure explains. `shifted`: its factors, equilibrated, where they are known.
std::vector<std::string> numerical(const Mcp& mcp, const SpMat& B, const Indices& block, Shifted* shifted) {
  std::vector<std::string> found;
  const auto equation = [&](Index i) { return mcp.equation_name(i); };
  const auto variable = [&](Index i) { return mcp.variable_name(i); };
  if (const auto rows = parallel_columns(B.transpose()); !rows.empty())
    found.push_back(pairs_text(rows, block, "the gradient of equation", equation));
  if (const auto columns = parallel_columns(B); !columns.empty())
    found.push_back(pairs_text(columns, block, "the column of variable", variable));
  if (!found.empty()) return found;
  const SpMat even = equilibrated(B);
  std::optional<Shifted> own;
  if (shifted == nullptr && !(own = Shifted::if_singular(even))) return found;
  const NullVectors null_space = null_vectors(even, own ? *own : *shifted);
  const Indices rows = renumbered(null_space.rows, block);
  const Indices columns = renumbered(null_space.columns, block);
  if (!rows.empty())
    found.push_back(rows.size() == 1 ? "equation " + equation(rows[0]) + " hardly changes"
                                     : "a combination of " + quantity(std::ssize(rows), "equation") +
                                           " does not change with any variable (" + listed_equations(mcp, rows) + ")");
  if (!columns.empty())
    found.push_back(columns.size() == 1 ? "variable " + variable(columns[0]) + " hardly changes any equation"
                                        : moving_together(mcp, columns));
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

namespace {

std::string explanation(const Mcp& mcp, const SpMat& B, const Indices& block, Shifted* shifted) {
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
    found = numerical(mcp, B, block, shifted);
  }
  if (found.empty()) return {};
  std::string text =
      "the Jacobian of the " + quantity(std::ssize(block), "variable") + " off their bounds is singular: ";
  if (block.size() == 1) text = "the Jacobian of the variable off its bounds is singular: ";
  for (std::size_t k = 0; k < found.size(); ++k) text += (k > 0 ? "; " : "") + found[k];
  return text;
}

}  // namespace

std::string explain_singularity(const Mcp& mcp, const SpMat& J, In x, In F) {
  expect_sizes(mcp, J, x, F);
  if (!x.allFinite() || !F.allFinite() || !J.coeffs().allFinite()) return {};
  const Indices block = active_block(mcp.box(), x, F);
  return block.empty() ? std::string() : explanation(mcp, block_of(J, block), block, nullptr);
}

namespace {

/// Whether a point of the box in the direction d is a solution, too: of those as far from x as 1 + |x|, a tenth and a
/// hundredth of it, the farthest one where F is defined decides, so that a flat F does not pass for a constant one.
bool another_solution(const Mcp& mcp, In x, const Vec& d, double tol) {
  CountedMcp counted(mcp);
  Vec F;
  const double unit = (1 + x.lpNorm<Eigen::Infinity>()) / d.lpNorm<Eigen::Infinity>();
  for (const double sign : {1.0, -1.0})
    for (const double t : {1.0, 0.1, 0.01}) {
      const Vec z = x + sign * t * unit * d;
      if (lcp::project(mcp.box(), z) != z || !counted.eval(z, F)) continue;
      if (residual(mcp.box(), z, F).natural <= tol) return true;
      break;
    }
  return false;
}

/// Variables that can be moved, alone, and are in no equation.
Indices in_no_equation(const Mcp& mcp, const SpMat& J, In x, In F, double tol) {
  const Box& box = mcp.box();
  Indices out;
  for (Index j = 0; j < J.cols(); ++j) {
    bool empty = true;
    for (SpMat::InnerIterator it(J, j); it && empty; ++it) empty = it.value() == 0;
    if (!empty || box.lower[j] == box.upper[j] || std::abs(F[j]) > tol) continue;
    if (another_solution(mcp, x, Vec::Unit(x.size(), j), tol)) out.push_back(j);
  }
  return out;
}

}  // namespace

std::string undetermined(const Mcp& mcp, const SpMat& J, In x, In F, double tol) {
  expect_sizes(mcp, J, x, F);
  if (!x.allFinite() || !F.allFinite() || !J.coeffs().allFinite()) return {};
  constexpr Index most = 100'000;  // rows that are factored: it may take as long as the solve
  const std::string many = "the solution is not the only one: ";
  const bool rough = mcp.jacobian_work().by == JacobianWork::By::Differences;
  constexpr double differences = 1e-6;  // they are good to the root of the rounding, and to a hundred times that here
  const Indices block = active_block(mcp.box(), x, F);
  Vec columns;
  std::optional<Shifted> shifted;
  SpMat B;
  if (!block.empty() && std::ssize(block) <= most)
    shifted = Shifted::if_singular(B = equilibrated(block_of(J, block), &columns), rough ? differences : singular);
  if (!shifted) {
    const Indices loose = in_no_equation(mcp, J, x, F, tol);
    if (loose.empty()) return {};
    return many + (loose.size() == 1 ? "variable " : "variables ") + listed_variables(mcp, loose) +
           (loose.size() == 1 ? " is in no equation" : " are in no equation");
  }
  const std::string why = explanation(mcp, block_of(J, block), block, &*shifted);
  const Vec y = shifted->null_vector(B, false, rough ? differences : null);
  Vec d = Vec::Zero(x.size());
  for (Index k = 0; k < y.size(); ++k) d[block[at(k)]] = y[k] * columns[k];
  const bool more = y.size() > 0 && another_solution(mcp, x, d, tol);
  if (more) return many + (why.empty() ? moving_together(mcp, renumbered(share_of(y), block)) : why);
  return why.empty() ? why : "the solution is perhaps not the only one: " + why;
}

}  // namespace perp::ncp
