// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A problem of a client's, between its solves.
#include <vector>

#include "capi/path/jacobian.hpp"
#include "capi/path/perp_path.h"

struct _MCP {  // NOLINT(bugprone-reserved-identifier): as its clients declare it
  MCP_Interface client{};
  Presolve_Interface presolve{};
  bool has_presolve = false;
  bool affine = false;

  // Of the last solve; infinite bounds are 1e20.
  std::vector<double> x{};
  std::vector<double> lower{};
  std::vector<double> upper{};
  std::vector<double> F{};
  std::vector<int> basis{};
  perp::path::ClientJacobian jacobian{};
};
