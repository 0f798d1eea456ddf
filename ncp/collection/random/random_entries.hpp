#pragma once
/// The catalogue's lines for random_ncps.hpp. Private to the collection.
#include <array>

#include "ncp/collection/random/random_ncps.hpp"

namespace perp::ncp::collection {

inline constexpr std::array random_entries{
    Entry{"random-boxed-ncp-own", "random", 50, "own data: 50 rows, seed 1",
          "all kinds of bounds: one-sided, two-sided, free, fixed", [] { return random_boxed_ncp_own(50, 1); }},
    Entry{"random-boxed-ncp-own-1000", "random", 1000, "own data: 1000 rows, seed 1",
          "all kinds of bounds: one-sided, two-sided, free, fixed", [] { return random_boxed_ncp_own(1000, 1); }},
    Entry{"random-degenerate-ncp-own", "random", 50, "own data: 50 rows, seed 1", "half of the indices have x = F = 0",
          [] { return random_degenerate_ncp_own(50, 1); }},
    Entry{"random-degenerate-ncp-own-1000", "random", 1000, "own data: 1000 rows, seed 1",
          "half of the indices have x = F = 0", [] { return random_degenerate_ncp_own(1000, 1); }},
    Entry{"random-exponential-ncp-own", "random", 50, "own data: 50 rows, seed 1",
          "exponentials: Newton steps from 0 lead to where F is not defined",
          [] { return random_exponential_ncp_own(50, 1); }},
    Entry{"random-ill-conditioned-ncp-own", "random", 50, "own data: 50 rows, seed 1",
          "entries of J over eight orders of magnitude, x over four",
          [] { return random_ill_conditioned_ncp_own(50, 1); }},
    Entry{"random-monotone-ncp-own", "random", 50, "own data: 50 rows, seed 1",
          "not hard: strictly monotone, sparse, not symmetric", [] { return random_monotone_ncp_own(50, 1); }},
    Entry{"random-monotone-ncp-own-1000", "random", 1000, "own data: 1000 rows, seed 1",
          "not hard: strictly monotone, sparse, not symmetric", [] { return random_monotone_ncp_own(1000, 1); }},
    Entry{"random-p0-ncp-own", "random", 50, "own data: 50 rows, seed 1",
          "P0, not monotone; J is singular at the start 0 and wherever a cube's unknown is 0",
          [] { return random_p0_ncp_own(50, 1); }},
    Entry{"random-p0-ncp-own-1000", "random", 1000, "own data: 1000 rows, seed 1",
          "P0, not monotone; J is singular at the start 0 and wherever a cube's unknown is 0",
          [] { return random_p0_ncp_own(1000, 1); }},
};

}  // namespace perp::ncp::collection
