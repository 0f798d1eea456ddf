// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Which rows of a model are too many, and which variables too few rows determine, square or not, in the model's own
/// names. Private to ncp/. By the Dulmage-Mendelsohn decomposition (lcp/linalg/structure.hpp) of the pattern, in which
/// a row that complements a variable has an entry for it: at a bound the variable is determined by that.
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "ncp/problem/mcp.hpp"

namespace perp::ncp {

using NameAt = std::function<std::string(Index)>;

struct ModelStructure {
  SpMat pattern;  ///< rows x variables, with the entries of conditions for what they complement
  /// A number for each row: equal for rows that have the same variables (row_keys()).
  std::vector<std::uint64_t> keys{};
  std::vector<Index> complement;  ///< of each row the variable that it complements; -1: none
  std::vector<char> imposes{};    ///< of each row: an equation or a condition, no inequality beside them
  std::vector<char> bounded{};    ///< of each variable: it has a finite bound
  Eigen::MatrixXd changes{};      ///< of each row between some points; NaN: not known
  Vec values{};                   ///< of each row at one point
  NameAt row;
  NameAt variable;
};

/// Names of rows that are made of names of variables, or the other way round, as d_x of x: a part of the name that all
/// of a kind share, and the rest, as "d_" and "x1", "cap" and "[gas]".
struct Namesakes {
  std::vector<Index> variable_of, row_of;  ///< of each row, and of each variable; -1: none
  std::vector<char> rows{}, variables{};   ///< 1: without one although most of the kind have one
};
/// Finds the namesakes among m rows and n variables.
Namesakes namesakes(Index m, Index n, const NameAt& row, const NameAt& variable);

/// The family of a name and its index: "cap[gas]" is "cap" and "[gas]", "e12" is "e" and "12".
std::pair<std::string, std::string> split_name(const std::string& name);

/// A number of the columns in which each row has an entry, by a hash; without the zeros, if these are none.
std::vector<std::uint64_t> row_keys(const SpMat& A, bool zeros = true);

/// The structure of a problem: variables that are in no row but their own, and those rows, are left out, as they
/// explain nothing; of a problem whose rows all have an entry of their own variable, so that none is too many, the
/// diagonal is enough. With F and J at a point, if they are given.
ModelStructure structure_of(const Mcp& mcp, const Vec* F = nullptr, const SpMat* J = nullptr);

struct Fault {
  std::string text;  ///< a sentence without a full stop
  std::vector<Index> rows{}, variables{};
  bool by_pattern = true;  ///< false: seen in numbers, which are rounded
};
/// Finds what is wrong with the structure; nothing where it is sound.
std::vector<Fault> faults(const ModelStructure& model);

}  // namespace perp::ncp
