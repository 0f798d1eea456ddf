// SPDX-License-Identifier: Apache-2.0
#include "ncp/problem/model_structure.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <span>
#include <tuple>
#include <unordered_map>

#include "lcp/linalg/structure.hpp"
#include "ncp/problem/words.hpp"

namespace perp::ncp {
namespace {

using Indices = std::vector<Index>;
using lcp::StructurePart;

constexpr std::size_t few = 5;         // rows that a person looks through
constexpr std::size_t most_parts = 3;  // told

std::string listed(const Indices& indices, const NameAt& name) {
  std::string text;
  for (std::size_t k = 0; k < std::min(few, indices.size()); ++k)
    text += (k == 0 ? "" : k + 1 == indices.size() ? " and " : ", ") + name(indices[k]);
  return indices.size() > few ? text + " and " + std::to_string(indices.size() - few) + " more" : text;
}

struct Multiple {
  Index first, second;
  double factor;      ///< second = factor * first, up to a constant
  bool same = false;  ///< without one
};
std::uint64_t mixed(std::uint64_t a) {  // the finalizer of splitmix64
  a = (a ^ (a >> 30U)) * 0xBF58476D1CE4E5B9U;
  a = (a ^ (a >> 27U)) * 0x94D049BB133111EBU;
  return a ^ (a >> 31U);
}

/// Rows of the same variables that change in proportion.
std::vector<Multiple> multiples(const ModelStructure& model) {
  std::vector<Multiple> found;
  if (model.changes.rows() != model.pattern.rows()) return found;
  struct Row {
    std::uint64_t key;
    double angle;  ///< of the first two changes: multiples have the same one
    Index i;
  };
  std::vector<Row> rows;
  for (Index i = 0; i < model.pattern.rows(); ++i) {
    if (!model.imposes[at(i)] || !model.changes.row(i).allFinite() || model.changes.row(i).isZero(0)) continue;
    const double x = model.changes(i, 0), y = model.changes(i, 1);
    rows.push_back({model.keys[at(i)], x != 0 ? std::atan(y / x) : 0, i});
  }
  std::ranges::sort(rows, {}, [](const Row& row) { return std::tuple(row.key, row.angle, row.i); });
  constexpr double equal = 1e-9;      // relative difference of changes: they are some 10 roundings off
  constexpr std::size_t most = 1000;  // rows of one direction that are compared
  for (std::size_t begin = 0, end = 0; begin < rows.size(); begin = end) {
    for (end = begin + 1;
         end < rows.size() && rows[end].key == rows[begin].key && rows[end].angle - rows[end - 1].angle <= 100 * equal;)
      ++end;
    const auto cluster = std::span(rows).subspan(begin, end - begin);
    std::ranges::sort(cluster, {}, &Row::i);
    for (std::size_t b = 1; b < std::min(most, cluster.size()); ++b)
      for (std::size_t a = 0; a < b; ++a) {
        const Index first = cluster[a].i, second = cluster[b].i;
        const Eigen::Vector3d u = model.changes.row(first);
        const Eigen::Vector3d v = model.changes.row(second);
        const double factor = u.dot(v) / u.squaredNorm();
        if ((v - factor * u).norm() > equal * v.norm()) continue;
        // Conditions on opposite sides of an interval are in order; one and the same twice is not.
        const bool equations = model.complement[at(first)] < 0 && model.complement[at(second)] < 0;
        const bool same = std::abs(factor * model.values[first] - model.values[second]) <=
                          equal * (v.norm() + std::abs(model.values[second]));
        if (!equations && !(same && std::abs(factor - 1) <= equal)) continue;
        found.push_back({first, second, factor, same});
        break;
      }
  }
  std::ranges::sort(found, {}, &Multiple::second);
  return found;
}

/// Of a part of many, those to look at first.
Indices suspects(const Indices& all, const std::function<int(Index)>& rank) {
  int best = 0;
  for (const Index k : all) best = std::max(best, rank(k));
  Indices chosen;
  for (const Index k : all)
    if (rank(k) == best) chosen.push_back(k);
  return chosen;
}

/// Parts that have rows in common become one, as long as a person can look through it.
std::vector<StructurePart> joined(std::vector<StructurePart> parts) {
  std::vector<StructurePart> out;
  for (StructurePart& part : parts) {
    const auto with = std::ranges::find_if(out, [&](const StructurePart& other) {
      StructurePart both;
      std::ranges::set_union(other.rows, part.rows, std::back_inserter(both.rows));
      return both.rows.size() < other.rows.size() + part.rows.size() && both.rows.size() <= few;
    });
    if (with == out.end()) {
      out.push_back(std::move(part));
      continue;
    }
    StructurePart both;
    std::ranges::set_union(with->rows, part.rows, std::back_inserter(both.rows));
    std::ranges::set_union(with->columns, part.columns, std::back_inserter(both.columns));
    *with = std::move(both);
  }
  return out;
}

/// Overdetermined parts, the empty rows first, as one.
std::vector<StructurePart> parts_of(const SpMat& A, const std::function<bool(Index)>& imposes) {
  Indices entries(at(A.rows()), 0);
  for (Index k = 0; k < A.nonZeros(); ++k) ++entries[at(A.innerIndexPtr()[k])];
  const auto empty_rows = at(static_cast<Index>(std::ranges::count(entries, 0)));
  auto parts = lcp::overdetermined_parts(A, 10 * most_parts + empty_rows, lcp::Entries::Stored);
  std::erase_if(parts, [&](const StructurePart& p) { return p.columns.empty() || !imposes(p.rows.front()); });
  parts = joined(std::move(parts));
  StructurePart empty;
  for (Index i = 0; i < A.rows(); ++i)
    if (entries[at(i)] == 0 && imposes(i)) empty.rows.push_back(i);
  if (!empty.rows.empty()) parts.insert(parts.begin(), std::move(empty));
  return parts;
}

std::string too_many(const ModelStructure& model, const StructurePart& part, const Namesakes& names) {
  if (part.columns.empty())
    return part.rows.size() == 1 ? "row " + model.row(part.rows.front()) + " has no variable"
                                 : "rows without a variable: " + listed(part.rows, model.row);
  std::string text = "too many equations: " + quantity(std::ssize(part.rows), "row") + " (" +
                     listed(part.rows, model.row) + ") for " + quantity(std::ssize(part.columns), "variable") + " (" +
                     listed(part.columns, model.variable) + ")";
  if (part.rows.size() <= few) return text;
  // Conditions have the variable that the modeller gave them.
  const Indices first = suspects(
      part.rows, [&](Index i) { return (model.complement[at(i)] < 0 ? 2 : 0) + (names.rows[at(i)] != 0 ? 1 : 0); });
  return first.size() < part.rows.size() ? text + ", of which look first at " + listed(first, model.row) : text;
}

std::string too_few(const ModelStructure& model, const StructurePart& part, const Namesakes& names,
                    const std::vector<char>& complemented) {
  if (part.columns.empty())  // of the transpose
    return part.rows.size() == 1
               ? "variable " + model.variable(part.rows.front()) + " is in no row: nothing determines it"
               : "in no row, so that nothing determines them: " + listed(part.rows, model.variable);
  std::string text = "too few equations: " + quantity(std::ssize(part.rows), "variable") + " (" +
                     listed(part.rows, model.variable) + ") in " + quantity(std::ssize(part.columns), "row") + " (" +
                     listed(part.columns, model.row) + ")";
  if (part.rows.size() <= few) return text;
  const Indices first = suspects(part.rows, [&](Index j) {
    if (complemented[at(j)]) return 0;
    return 4 + (model.bounded[at(j)] ? 2 : 0) + (names.variables[at(j)] ? 1 : 0);
  });
  return first.size() < part.rows.size() ? text + ", of which look first at " + listed(first, model.variable) : text;
}

/// "lambda_e1 has no row": variables without a namesake that no sentence has named yet.
void tell_nameless(const ModelStructure& model, const Namesakes& names, std::vector<Fault>& found) {
  Indices alone;
  for (Index j = 0; j < model.pattern.cols(); ++j)
    if (names.variables[at(j)]) alone.push_back(j);
  if (alone.empty() || alone.size() > few) return;
  if (std::ranges::find(found, alone, &Fault::variables) != found.end()) return;
  // The example: a pair that is named most alike.
  const std::string first = model.variable(alone.front());
  Index like = -1;
  std::ptrdiff_t longest = -1;
  for (Index j = 0; j < model.pattern.cols(); ++j) {
    if (names.row_of[at(j)] < 0) continue;
    const std::string name = model.variable(j);
    const std::ptrdiff_t common = std::ranges::mismatch(name, first).in1 - name.begin();
    if (common > longest) longest = common, like = j;
  }
  found.push_back({.text = "by their names most variables have a row, as " + model.variable(like) + " has " +
                           model.row(names.row_of[at(like)]) + ", and " + listed(alone, model.variable) +
                           (alone.size() == 1 ? " has none" : " have none"),
                   .variables = std::move(alone),
                   .by_pattern = false});
}

/// "row e7 is missing": families of rows that have every index of a run but one.
void tell_gaps(const ModelStructure& model, std::vector<Fault>& found) {
  std::map<std::string, std::vector<long>> numbers;
  for (Index i = 0; i < model.pattern.rows(); ++i)
    if (const auto [family, index] = split_name(model.row(i));
        !index.empty() && index.front() != '[' && index.size() < 10)
      numbers[family].push_back(std::stol(index));
  for (auto& [family, list] : numbers) {
    std::ranges::sort(list);
    std::vector<long> gaps;
    for (std::size_t k = 1; k < list.size(); ++k)
      if (list[k] == list[k - 1] + 2) gaps.push_back(list[k] - 1);
    if (gaps.size() == 1 && list.back() - list.front() == std::ssize(list) && list.size() >= 4)
      found.push_back({.text = "of the rows " + family + std::to_string(list.front()) + " to " + family +
                               std::to_string(list.back()) + " one is missing: " + family +
                               std::to_string(gaps.front()),
                       .by_pattern = false});
  }
}

}  // namespace

std::pair<std::string, std::string> split_name(const std::string& name) {
  if (const auto bracket = name.find('['); bracket != std::string::npos)
    return {name.substr(0, bracket), name.substr(bracket)};
  std::size_t digits = name.size();
  while (digits > 0 && std::isdigit(static_cast<unsigned char>(name[digits - 1]))) --digits;
  return {name.substr(0, digits), name.substr(digits)};
}

Namesakes namesakes(Index m, Index n, const NameAt& row, const NameAt& variable) {
  std::vector<std::string> rows, variables;
  for (Index i = 0; i < m; ++i) rows.push_back(row(i));
  for (Index j = 0; j < n; ++j) variables.push_back(variable(j));
  Namesakes out{Indices(at(m), -1), Indices(at(n), -1), std::vector<char>(at(m), 0), std::vector<char>(at(n), 0)};
  // `longer` = prefix + `shorter`.
  const auto pair_up = [](const std::vector<std::string>& longer, const std::vector<std::string>& shorter,
                          Indices& of_longer, Indices& of_shorter) {
    constexpr std::size_t enough = 3;  // pairs that show a habit
    std::unordered_map<std::string, std::size_t> index;
    for (std::size_t k = 0; k < shorter.size(); ++k) index.emplace(shorter[k], k);
    std::map<std::string, std::vector<std::pair<std::size_t, std::size_t>>> habits;
    for (std::size_t k = 0; k < longer.size(); ++k)
      for (std::size_t p = 0; p < std::min<std::size_t>(longer[k].size(), 16); ++p)
        if (const auto it = index.find(longer[k].substr(p)); it != index.end())
          habits[longer[k].substr(0, p)].emplace_back(k, it->second);
    for (const auto& [prefix, pairs] : habits) {
      if (pairs.size() < enough) continue;
      for (const auto& [a, b] : pairs) {
        if (of_shorter[b] >= 0) continue;
        of_shorter[b] = static_cast<Index>(a);
        if (of_longer[a] < 0) of_longer[a] = static_cast<Index>(b);
      }
    }
  };
  pair_up(rows, variables, out.variable_of, out.row_of);
  pair_up(variables, rows, out.row_of, out.variable_of);
  const auto without = [](const Indices& partners, std::vector<char>& alone) {
    if (std::ranges::count(partners, -1) * 2 >= std::ssize(partners)) return;
    for (std::size_t k = 0; k < partners.size(); ++k) alone[k] = partners[k] < 0 ? 1 : 0;
  };
  without(out.variable_of, out.rows);
  without(out.row_of, out.variables);
  return out;
}

std::vector<std::uint64_t> row_keys(const SpMat& A, bool zeros) {
  std::vector<std::uint64_t> keys(at(A.rows()), 0);
  for (Index j = 0; j < A.cols(); ++j)
    for (SpMat::InnerIterator it(A, j); it; ++it)
      if (zeros || it.value() != 0) keys[at(it.row())] += mixed(static_cast<std::uint64_t>(j) + 1);
  return keys;
}

ModelStructure structure_of(const Mcp& mcp, const Vec* F, const SpMat* J) {
  const Box& box = mcp.box();
  const bool constant = J != nullptr && mcp.is_affine();  // then an entry that is 0 is none
  const SpMat& entries = constant ? *J : mcp.jacobian_pattern();
  const auto counts = [&](const SpMat::InnerIterator& it) { return !constant || it.value() != 0; };
  const Index n = mcp.size();
  ModelStructure s{.pattern = SpMat(n, n),
                   .complement = Indices(at(n), -1),
                   .imposes = std::vector<char>(at(n), 1),
                   .bounded = std::vector<char>(at(n), 0),
                   .row = [&mcp](Index i) { return mcp.equation_name(i); },
                   .variable = [&mcp](Index j) { return mcp.variable_name(j); }};
  std::vector<char> left_out(at(n), 0);
  bool matched = true;  // by the diagonal
  for (Index j = 0; j < n; ++j) {
    bool alone = true, diagonal = false;
    for (SpMat::InnerIterator it(entries, j); it; ++it) {
      if (!counts(it)) continue;
      diagonal = diagonal || it.row() == j;
      alone = alone && it.row() == j;
    }
    matched = matched && (diagonal || !box.is_free(j));
    if (box.is_free(j)) continue;
    s.bounded[at(j)] = 1;
    s.complement[at(j)] = j;
    left_out[at(j)] = alone || box.is_fixed(j) ? 1 : 0;
  }
  if (matched) {
    s.pattern.setIdentity();
  } else {
    std::vector<Eigen::Triplet<double>> kept;
    for (Index j = 0; j < n; ++j) {
      if (s.bounded[at(j)]) kept.emplace_back(static_cast<int>(j), static_cast<int>(j), 1);
      if (left_out[at(j)]) continue;
      for (SpMat::InnerIterator it(entries, j); it; ++it)
        if (counts(it) && !left_out[at(it.row())]) kept.emplace_back(it.row(), it.col(), 1);
    }
    s.pattern.setFromTriplets(kept.begin(), kept.end());
  }
  s.keys = row_keys(entries, !constant);
  if (F == nullptr || J == nullptr) return s;
  Eigen::MatrixXd steps(n, 3);
  for (Index j = 0; j < n; ++j)
    for (Index k = 0; k < steps.cols(); ++k) steps(j, k) = std::sin(1.7 * static_cast<double>((j + 1) * (k + 1)));
  s.changes = *J * steps;
  s.values = *F;
  return s;
}

std::vector<Fault> faults(const ModelStructure& model) {
  std::vector<Fault> found;
  const Index m = model.pattern.rows(), n = model.pattern.cols();
  auto over = parts_of(model.pattern, [&](Index i) { return model.imposes[at(i)] != 0; });
  const auto under = parts_of(model.pattern.transpose(), [](Index) { return true; });
  const std::vector<Multiple> same = multiples(model);
  if (over.empty() && under.empty() && same.empty()) return found;
  std::vector<char> complemented(at(n), 0);
  for (const Index j : model.complement)
    if (j >= 0) complemented[at(j)] = 1;
  const auto long_part = [](const StructurePart& part) { return part.rows.size() > few && !part.columns.empty(); };
  const bool by_name = m < n || std::ranges::any_of(over, long_part) || std::ranges::any_of(under, long_part);
  const Namesakes names = by_name ? namesakes(m, n, model.row, model.variable) : Namesakes{};
  for (std::size_t k = 0; k < std::min(most_parts, same.size()); ++k)
    found.push_back({.text = "row " + model.row(same[k].second) + " repeats row " + model.row(same[k].first) +
                             (std::abs(same[k].factor - 1) < 1e-9 ? "" : ", " + number(same[k].factor) + " times") +
                             (same[k].same ? "" : ", but for constants"),
                     .rows = {same[k].first, same[k].second},
                     .by_pattern = false});
  const auto all_multiples = [&](const StructurePart& part) {
    return part.rows.size() > few && std::ranges::any_of(same, [&](const Multiple& pair) {
             return std::ranges::binary_search(part.rows, pair.second);
           });
  };
  std::erase_if(over, all_multiples);
  for (std::size_t k = 0; k < std::min(most_parts, over.size()); ++k)
    found.push_back({too_many(model, over[k], names), over[k].rows, over[k].columns});
  if (over.size() > most_parts) found.push_back({"and more rows that are too many"});
  for (std::size_t k = 0; k < std::min(most_parts, under.size()); ++k)
    found.push_back({too_few(model, under[k], names, complemented), under[k].columns, under[k].rows});
  if (under.size() > most_parts) found.push_back({"and more variables"});
  if (m < n) {
    tell_gaps(model, found);
    tell_nameless(model, names, found);
  }
  return found;
}

}  // namespace perp::ncp
