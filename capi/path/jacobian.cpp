// SPDX-License-Identifier: Apache-2.0
#include "capi/path/jacobian.hpp"

#include <algorithm>
#include <utility>

namespace perp::path {

namespace {

// Beyond what was promised: a client that writes more is found out before it does harm.
constexpr std::size_t guard = 16;
constexpr int untouched = -0x5EED;

}  // namespace

double ClientJacobian::bytes(int n, int nonzeros) {
  constexpr double a_row = sizeof(double) + 2 * sizeof(int) + sizeof(std::int32_t);
  constexpr double a_nonzero = sizeof(double) + 2 * sizeof(int);  // the rows are kept for comparison
  return a_row * n + a_nonzero * nonzeros;
}

ClientJacobian::ClientJacobian(int n, int nonzeros)
    : n_(n),
      promised_(nonzeros),
      col_(static_cast<std::size_t>(n), 0),
      len_(static_cast<std::size_t>(n), 0),
      client_row_(static_cast<std::size_t>(nonzeros) + guard, untouched),
      data_(static_cast<std::size_t>(nonzeros) + guard, 0.0),
      F_(static_cast<std::size_t>(n), 0.0),
      start_(static_cast<std::size_t>(n) + 1, 0) {}

int ClientJacobian::evaluate(const MCP_Interface& client, double* x) {
  used_ = promised_;
  return client.jacobian_evaluation(client.interface_data, n_, x, 0, F_.data(), &used_, col_.data(), len_.data(),
                                    client_row_.data(), data_.data());
}

std::string ClientJacobian::invalid() const {
  if (std::any_of(client_row_.end() - static_cast<std::ptrdiff_t>(guard), client_row_.end(),
                  [](int row) { return row != untouched; }))
    return "jacobian_evaluation writes more than the " + std::to_string(promised_) +
           " nonzeros that problem_size has promised";
  std::size_t entries = 0;
  for (std::size_t j = 0; j < col_.size(); ++j) {
    const auto column = [j] { return "jacobian_evaluation: column " + std::to_string(j + 1); };
    if (len_[j] < 0 || (len_[j] > 0 && (col_[j] < 1 || len_[j] > promised_ - col_[j] + 1)))
      return column() + " has " + std::to_string(len_[j]) + " entries from " + std::to_string(col_[j]) +
             " on, which are not within the " + std::to_string(promised_) + " nonzeros that problem_size has promised";
    entries += static_cast<std::size_t>(len_[j]);
    if (entries > static_cast<std::size_t>(promised_))
      return "jacobian_evaluation: the columns to " + std::to_string(j + 1) + " have " + std::to_string(entries) +
             " entries, more than the " + std::to_string(promised_) + " that problem_size has promised";
    for (int k = 0; k < len_[j]; ++k) {
      const int row = client_row_[static_cast<std::size_t>(col_[j]) - 1 + static_cast<std::size_t>(k)];
      if (row < 1 || row > n_)
        return column() + " has an entry in row " + std::to_string(row == untouched ? 0 : row) + " of " +
               std::to_string(n_);
    }
  }
  return "";
}

/// Calls each(j, row, index into data), from 0.
template <class Each>
void ClientJacobian::each_entry(Each each) const {
  for (std::size_t j = 0; j < col_.size(); ++j)
    for (int k = 0; k < len_[j]; ++k) {
      const auto index = static_cast<std::size_t>(col_[j]) - 1 + static_cast<std::size_t>(k);
      each(j, client_row_[index] - 1, index);
    }
}

bool ClientJacobian::fits() {
  if (col_ == known_col_ && len_ == known_len_ && client_row_ == known_row_) return true;
  std::vector<std::int32_t> place;
  bool all = true;
  each_entry([&](std::size_t j, int row, std::size_t) {
    const auto begin = row_.begin() + start_[j];
    const auto end = row_.begin() + start_[j + 1];
    const auto found = std::lower_bound(begin, end, row);
    all = all && found != end && *found == row;
    place.push_back(static_cast<std::int32_t>(found - row_.begin()));
  });
  if (!all) return false;
  place_ = std::move(place);
  known_col_ = col_;
  known_len_ = len_;
  known_row_ = client_row_;
  return true;
}

void ClientJacobian::grow() {
  std::vector<std::vector<std::int32_t>> columns(col_.size());
  for (std::size_t j = 0; j < col_.size(); ++j)
    columns[j].assign(row_.begin() + start_[j], row_.begin() + start_[j + 1]);
  each_entry([&](std::size_t j, int row, std::size_t) { columns[j].push_back(row); });
  row_.clear();
  for (std::size_t j = 0; j < col_.size(); ++j) {
    std::sort(columns[j].begin(), columns[j].end());
    columns[j].erase(std::unique(columns[j].begin(), columns[j].end()), columns[j].end());
    row_.insert(row_.end(), columns[j].begin(), columns[j].end());
    start_[j + 1] = static_cast<std::int32_t>(row_.size());
  }
  known_col_.clear();  // its places are others now
  fits();
}

void ClientJacobian::values(double* out) const {
  std::fill_n(out, row_.size(), 0.0);
  std::size_t entry = 0;
  each_entry([&](std::size_t, int, std::size_t index) { out[place_[entry++]] += data_[index]; });
}

std::vector<std::int8_t> ClientJacobian::linear(const Presolve_Interface& client) {
  std::size_t last = 0;
  each_entry([&](std::size_t, int, std::size_t index) { last = std::max(last, index + 1); });
  std::vector<int> types(last, 1);
  client.jac_typ(client.presolve_data, static_cast<int>(last), types.data());
  std::vector<std::int8_t> flags(row_.size(), 1);
  std::size_t entry = 0;
  each_entry([&](std::size_t, int, std::size_t index) {
    if (types[index] != 0) flags[static_cast<std::size_t>(place_[entry])] = 0;
    ++entry;
  });
  return flags;
}

}  // namespace perp::path
