#pragma once
/// The makers behind entries(), one a problem; formulas and sources stand with their definitions. Private to the
/// collection.
#include "ncp/collection/base/entry.hpp"

namespace perp::ncp::collection {

// tiny.cpp
Problem kojshin(), josephy(), munson1(), billups(), watson4();
// ncp/collection/kkt/kkt.cpp
Problem hs34_kkt(), hs35_kkt(), hs76_kkt(), colvnlp(), colvdual();
// economics.cpp, choi.cpp, distillation.cpp, tinloi.cpp, pies.cpp
Problem mathiesen(), kehoe(), choi(), hydroc06(), methan08(), tinloi42(), pies();
// ncp/collection/scalable/games.cpp, ncp/collection/scalable/lcps.cpp
Problem nash10(), cottle2(), cottle4(), infeasible_own(), infeasible_ncp_own();

}  // namespace perp::ncp::collection
