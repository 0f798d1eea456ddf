// SPDX-License-Identifier: Apache-2.0
#include "capi/matrix.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "capi/guard.hpp"
#include "lcp/memory.hpp"

namespace perp::capi {

namespace {

constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max() - 1;

/// "M_row", or "row" where there is but one matrix.
template <class Integer>
std::string argument(const Columns<Integer>& given, const char* part) {
  return given.name.empty() ? part : given.name + "_" + part;
}

template <class Integer>
void check_starts(const Columns<Integer>& given) {
  require(given.start, argument(given, "start").c_str());
  const std::string name = argument(given, "start");
  if (given.start[0] != 0) refuse(name, "entry 1 is " + std::to_string(given.start[0]) + " and must be 0");
  for (Index j = 0; j < given.columns; ++j)
    if (given.start[j + 1] < given.start[j])
      refuse(name, "entry " + std::to_string(j + 2) + " is " + std::to_string(given.start[j + 1]) +
                       ", less than the one before, " + std::to_string(given.start[j]));
  if (given.start[given.columns] > most)
    refuse(name, "there are " + std::to_string(given.start[given.columns]) + " entries, more than 2^31 - 2");
}

/// Whether the rows of each column ascend.
template <class Integer>
bool check_rows(const Columns<Integer>& given) {
  bool ascending = true;
  for (Index j = 0; j < given.columns; ++j)
    for (Integer k = given.start[j]; k < given.start[j + 1]; ++k) {
      const Integer i = given.row[k];
      if (i < 0 || i >= given.rows)
        refuse(argument(given, "row"), "entry " + std::to_string(k + 1) + " (of column " + std::to_string(j + 1) +
                                           ") is " + std::to_string(i) + ", and must be within 0 and " +
                                           std::to_string(given.rows - 1));
      if (k > given.start[j] && given.row[k - 1] >= i) ascending = false;
    }
  return ascending;
}

template <class Integer>
void check_values(const Columns<Integer>& given) {
  for (Index j = 0; j < given.columns; ++j)
    for (Integer k = given.start[j]; k < given.start[j + 1]; ++k)
      if (!std::isfinite(given.value[k]))
        refuse(argument(given, "value"), "entry " + std::to_string(k + 1) + " (row " +
                                             std::to_string(given.row[k] + 1) + ", column " + std::to_string(j + 1) +
                                             ") is " + std::to_string(given.value[k]) + ", no finite number");
}

/// Where each entry goes so that rows ascend. Refuses a place given twice.
template <class Integer>
std::vector<Index> places(const Columns<Integer>& given) {
  std::vector<Index> order(static_cast<std::size_t>(given.start[given.columns]));
  std::iota(order.begin(), order.end(), Index{0});
  std::vector<Index> place(order.size());
  for (Index j = 0; j < given.columns; ++j) {
    const auto begin = order.begin() + given.start[j];
    const auto end = order.begin() + given.start[j + 1];
    std::sort(begin, end, [&](Index a, Index b) { return given.row[a] < given.row[b]; });
    const auto twice = std::adjacent_find(begin, end, [&](Index a, Index b) { return given.row[a] == given.row[b]; });
    if (twice != end)
      refuse(argument(given, "row"),
             "row " + std::to_string(given.row[*twice] + 1) + " stands twice in column " + std::to_string(j + 1));
    for (auto entry = begin; entry != end; ++entry) place[lcp::at(*entry)] = entry - order.begin();
  }
  return place;
}

template <class Integer>
Matrix checked(const Columns<Integer>& given) {
  check_starts(given);
  const auto nonzeros = static_cast<Index>(given.start[given.columns]);
  if (nonzeros > 0) require(given.row, argument(given, "row").c_str());
  const bool ascending = check_rows(given);
  const bool valued = !given.pattern && nonzeros > 0;
  if (valued) {
    require(given.value, argument(given, "value").c_str());
    check_values(given);
  }
  constexpr double an_entry = sizeof(double) + sizeof(int);
  lcp::require_memory((an_entry + (ascending ? 0 : 2 * sizeof(Index))) * static_cast<double>(nonzeros),
                      "the " + std::to_string(nonzeros) + " entries of " + argument(given, "start"));
  Matrix matrix;
  if (!ascending) matrix.place = places(given);
  SpMat& M = matrix.entries;
  M.resize(given.rows, given.columns);
  M.resizeNonZeros(nonzeros);
  std::copy_n(given.start, given.columns + 1, M.outerIndexPtr());
  const auto place = [&](Index k) { return ascending ? k : matrix.place[lcp::at(k)]; };
  for (Index k = 0; k < nonzeros; ++k) M.innerIndexPtr()[place(k)] = static_cast<int>(given.row[k]);
  for (Index k = 0; k < nonzeros; ++k) M.valuePtr()[place(k)] = valued ? given.value[k] : 0;
  return matrix;
}

}  // namespace

Matrix matrix_of(const Columns<std::int32_t>& given) { return checked(given); }
Matrix matrix_of(const Columns<std::int64_t>& given) { return checked(given); }

void check_size(std::int64_t n, const char* argument) {
  if (n < 0 || n > most) refuse(argument, std::to_string(n) + " is not within 0 and 2^31 - 2");
}

Vec vector_of(const double* values, Index n, const char* argument) {
  if (n > 0) require(values, argument);
  Vec copy(n);
  std::copy_n(values, n, copy.data());
  for (Index i = 0; i < n; ++i)
    if (!std::isfinite(copy[i]))
      refuse(argument, "entry " + std::to_string(i + 1) + " is " + std::to_string(copy[i]) + ", no finite number");
  return copy;
}

lcp::Box box_of(const double* lower, const double* upper, Index n) {
  lcp::require_memory(2 * sizeof(double) * static_cast<double>(n), "the bounds of " + std::to_string(n) + " variables");
  lcp::Box box = lcp::Box::nonnegative(n);
  if (lower != nullptr) std::copy_n(lower, n, box.lower.data());
  if (upper != nullptr) std::copy_n(upper, n, box.upper.data());
  if (const auto i = box.first_invalid()) {
    const bool low = std::isnan(box.lower[*i]) || box.lower[*i] == lcp::infinity;
    refuse(low ? "lower" : "upper", "[lower, upper] of entry " + std::to_string(*i + 1) + " is [" +
                                        std::to_string(box.lower[*i]) + ", " + std::to_string(box.upper[*i]) +
                                        "], which is no interval");
  }
  return box;
}

}  // namespace perp::capi
