// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Starts of the runs after a failure.
///
/// Run k = 1, 2, ... after the first one begins at
///     x_i = mid(l_i, x0_i + d_k (1 + |x0_i|) u_i, u_i),   d_k = min(2^(k-1) / 10, 1),   u_i uniform in [-1, 1),
/// where the u_i are those of a generator (64-bit Mersenne twister) seeded with the campaign's seed, the problem's
/// name, the number of the start and k: not with the method, so that all methods get the same starts.
#include <string>
#include <string_view>

#include "ncp/problem/mcp.hpp"

namespace perp::app::compare {

struct Perturbation {
  unsigned seed = 1;
  std::string problem{};
  int start = 1;
  int run = 0;  ///< k; 0: x0 itself

  static void fields(auto& f, auto& rule) {
    f("seed", rule.seed);
    f("problem", rule.problem);
    f("start", rule.start);
    f("run", rule.run);
  }
};

ncp::Vec perturbed(const ncp::Box& box, ncp::In x0, const Perturbation& rule);

/// The .nl file with its initial guess replaced by the first entries of x. Throws InputError for a binary one.
std::string nl_with_start(std::string_view text, ncp::In x);

}  // namespace perp::app::compare
