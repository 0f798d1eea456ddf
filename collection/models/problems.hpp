// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The makers behind entries(), one a problem; formulas and sources stand with their definitions. Private to the
/// collection.
#include "collection/base/entry.hpp"

namespace perp::ncp::collection {

// tiny.cpp
Problem kojshin(), josephy(), munson1(), billups(), watson4();
// collection/kkt/kkt.cpp
Problem hs34_kkt(), hs35_kkt(), hs76_kkt(), colvnlp(), colvdual();
// economics.cpp, choi.cpp, distillation.cpp, tinloi.cpp, pies.cpp, ring.cpp
Problem mathiesen(), mathiesen_2(), mathiesen_3(), kehoe(), choi(), hydroc06(), methan08(), tinloi42(), pies(),
    bertsekas(), freebert(), gafni();
// classics.cpp
Problem nash5(), cyclic3_own(), cube_vertices_own(), simplex_own(), feasible_unsolvable_own(), hilbert_own();
// equations.cpp
Problem chandrasekhar(std::string name, double c);
Problem boundary_value_obstacle_own(), broyden_banded(), broyden_ncp_own(), broyden_tridiagonal(),
    brown_almost_linear(), chebyquad(), discrete_boundary_value(), discrete_integral_equation(), helical_valley(),
    powell_badly_scaled(), powell_singular(), rosenbrock(), trigonometric(), trigonometric_ncp_own(),
    variably_dimensioned(), wood();
// collection/scalable/games.cpp, collection/scalable/lcps.cpp
Problem nash10(), cottle2(), cottle4(), infeasible_own(), infeasible_ncp_own();

}  // namespace perp::ncp::collection
