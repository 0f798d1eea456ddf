// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A client's Jacobian: its own arrays, and the pattern that Perp solves with.
#include <cstdint>
#include <string>
#include <vector>

#include "capi/path/perp_path.h"

namespace perp::path {

/// The arrays are the same in every call, for clients may fill in the structure once. The pattern is that of the
/// structures met so far; one with a place that the pattern has not makes it grow (grow()).
class ClientJacobian {
 public:
  ClientJacobian() = default;
  ClientJacobian(int n, int nonzeros);
  /// What that takes.
  static double bytes(int n, int nonzeros);

  /// Calls jacobian_evaluation. The number of domain errors.
  int evaluate(const MCP_Interface& client, double* x);
  /// Why the structure that the client left is none; empty: it is one.
  std::string invalid() const;
  /// Whether the pattern has all places of that structure.
  bool fits();
  /// Adds the places it has not.
  void grow();
  /// Values in the pattern's order; entries of one place add up.
  void values(double* out) const;
  /// Flags in the pattern's order: linear where jac_typ says so of all entries of a place.
  std::vector<std::int8_t> linear(const Presolve_Interface& client);

  const std::int32_t* start() const { return start_.data(); }
  const std::int32_t* row() const { return row_.data(); }
  std::size_t size() const { return row_.size(); }

  // The client's, as MCP_GetJ shows them.
  int nonzeros() const { return used_; }
  int* col() { return col_.data(); }
  int* len() { return len_.data(); }
  int* client_row() { return client_row_.data(); }
  double* data() { return data_.data(); }

 private:
  template <class Each>
  void each_entry(Each each) const;

  int n_ = 0;
  int promised_ = 0;
  int used_ = 0;
  std::vector<int> col_, len_, client_row_;
  std::vector<double> data_, F_;
  // The pattern, and the place in it of each entry of the structure that was last looked at.
  std::vector<std::int32_t> start_, row_;
  std::vector<std::int32_t> place_;
  std::vector<int> known_col_, known_len_, known_row_;
};

}  // namespace perp::path
