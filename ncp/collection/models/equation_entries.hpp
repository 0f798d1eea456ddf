#pragma once
/// The catalogue's lines for the systems of equations and their relatives in equations.cpp. Private to the collection.
#include <array>

#include "ncp/collection/base/entry.hpp"

namespace perp::ncp::collection {

Problem chandrasekhar(std::string name, double c);
Problem boundary_value_obstacle_own(), broyden_banded(), broyden_ncp_own(), broyden_tridiagonal(),
    brown_almost_linear(), chebyquad(), discrete_boundary_value(), discrete_integral_equation(), helical_valley(),
    powell_badly_scaled(), powell_singular(), rosenbrock(), trigonometric(), trigonometric_ncp_own(),
    variably_dimensioned(), wood();

inline constexpr std::array equation_entries{
    Entry{"boundary-value-obstacle-own", "equations", 50,
          "own data: the discrete boundary value problem above an obstacle",
          "the contact set must be found; steep far away", boundary_value_obstacle_own},
    Entry{"broyden-banded", "equations", 10, "More, Garbow & Hillstrom 1981, ACM Trans. Math. Software 7, problem 31",
          "far starts: cubes of 100", broyden_banded},
    Entry{"broyden-ncp-own", "equations", 40, "own data: Broyden's tridiagonal function from a planted point",
          "not monotone; a quarter of the indices are degenerate", broyden_ncp_own},
    Entry{"broyden-tridiagonal", "equations", 10,
          "More, Garbow & Hillstrom 1981, ACM Trans. Math. Software 7, problem 30",
          "far starts, where the other branch of each parabola is nearer", broyden_tridiagonal},
    Entry{"brown-almost-linear", "equations", 10,
          "More, Garbow & Hillstrom 1981, ACM Trans. Math. Software 7, problem 27",
          "J is close to singular on the way; products of ten unknowns", brown_almost_linear},
    Entry{"chandrasekhar", "equations", 50, "Chandrasekhar 1960, as in Kelley 1995, section 5.6; c = 0.9, 50 nodes",
          "dense; poles behind far starts", [] { return chandrasekhar("chandrasekhar", 0.9); }},
    Entry{"chandrasekhar-1", "equations", 50, "Chandrasekhar 1960, as in Kelley 1995, section 5.6; c = 1, 50 nodes",
          "J is singular at the solution: slow last steps", [] { return chandrasekhar("chandrasekhar-1", 1); }},
    Entry{"chebyquad", "equations", 7, "More, Garbow & Hillstrom 1981, ACM Trans. Math. Software 7, problem 35",
          "J is singular where two unknowns are equal; polynomials of degree 7", chebyquad},
    Entry{"discrete-boundary-value", "equations", 10,
          "More, Garbow & Hillstrom 1981, ACM Trans. Math. Software 7, problem 28",
          "not hard: a sparse M-function, started near", discrete_boundary_value},
    Entry{"discrete-integral-equation", "equations", 10,
          "More, Garbow & Hillstrom 1981, ACM Trans. Math. Software 7, problem 29",
          "not hard: dense, nearly the identity", discrete_integral_equation},
    Entry{"helical-valley", "equations", 3, "More, Garbow & Hillstrom 1981, ACM Trans. Math. Software 7, problem 7",
          "a branch cut that a step may cross", helical_valley},
    Entry{"powell-badly-scaled", "equations", 2,
          "More, Garbow & Hillstrom 1981, ACM Trans. Math. Software 7, problem 3",
          "x1 is 1e-5 and x2 is 9; exponentials", powell_badly_scaled},
    Entry{"powell-singular", "equations", 4, "More, Garbow & Hillstrom 1981, ACM Trans. Math. Software 7, problem 13",
          "J has rank 2 at the solution", powell_singular},
    Entry{"rosenbrock", "equations", 2, "More, Garbow & Hillstrom 1981, ACM Trans. Math. Software 7, problem 1",
          "a curved valley", rosenbrock},
    Entry{"trigonometric", "equations", 10, "More, Garbow & Hillstrom 1981, ACM Trans. Math. Software 7, problem 26",
          "several solutions; merit functions have local minima", trigonometric},
    Entry{"trigonometric-ncp-own", "equations", 20, "own data: the trigonometric function from a planted point",
          "periodic, not monotone; a quarter of the indices are degenerate", trigonometric_ncp_own},
    Entry{"variably-dimensioned", "equations", 10,
          "More, Garbow & Hillstrom 1981, ACM Trans. Math. Software 7, problem 25", "cubes of sums: F of 1e10 far away",
          variably_dimensioned},
    Entry{"wood", "equations", 4, "More, Garbow & Hillstrom 1981, ACM Trans. Math. Software 7, problem 14",
          "a saddle on the way", wood},
};

}  // namespace perp::ncp::collection
