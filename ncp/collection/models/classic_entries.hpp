#pragma once
/// The catalogue's lines for classics.cpp and for Mathiesen's further economies. Private to the collection.
#include <array>

#include "ncp/collection/base/entry.hpp"

namespace perp::ncp::collection {

// classics.cpp
Problem nash5(), cyclic3_own(), cube_vertices_own(), simplex_own(), feasible_unsolvable_own(), hilbert_own();
// economics.cpp
Problem mathiesen_2();
Problem mathiesen_3();

inline constexpr std::array classic_entries{
    Entry{"mathiesen-2-own", "economics", 4, "own data: mathiesen with parameters (.75, 1, .5)",
          "a ray of solutions, the Jacobian singular at each of them", mathiesen_2},
    Entry{"mathiesen-3-own", "economics", 4, "own data: mathiesen with parameters (.75, 1, 2)",
          "as mathiesen-2-own, with a good in excess: its price is 0", mathiesen_3},
    Entry{"nash5", "games", 5, "Murphy, Sherali & Soyster 1982, Math. Prog. 24, 92-106; five firms",
          "powers: not defined for q < 0, infinite slopes at q = 0", nash5},
    Entry{"cube-vertices-own", "lcp", 4, "own data: M = -I, q = e", "16 solutions; negative definite",
          cube_vertices_own},
    Entry{"cyclic3-own", "lcp", 3, "own data: M = [1 0 2; 2 1 0; 0 2 1], q = -e",
          "plain Newton steps on the active set cycle, although M is P", cyclic3_own},
    Entry{"feasible-unsolvable-own", "lcp", 2, "own data: M = [0 1; 0 0], q = (-1, 1)",
          "no solution although there are feasible points: no certificate of infeasibility", feasible_unsolvable_own},
    Entry{"hilbert-own", "lcp", 8, "own data: Hilbert's matrix, n = 8, a planted solution",
          "condition 1e10: far points have small residuals", hilbert_own},
    Entry{"simplex-own", "lcp", 5, "own data: M = ee', q = -e", "a continuum of solutions, rank 1", simplex_own},
};

}  // namespace perp::ncp::collection
