// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Options that several methods have.
#include "lcp/fields.hpp"
#include "lcp/lu/sparse_lu.hpp"

namespace perp::lcp {

void describe_lu(LuBackend& lu, Fields& fields);
void describe_memory(int& memory, Fields& fields);
/// Steps of a method for affine problems.
void describe_iterations(Index& limit, Fields& fields);

}  // namespace perp::lcp
