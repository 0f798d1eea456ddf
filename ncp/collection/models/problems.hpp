#pragma once
/// The makers behind entries(), one a problem; formulas and sources stand with their definitions. Private to the
/// collection.
#include "ncp/collection/base/entry.hpp"

namespace perp::ncp::collection {

// tiny.cpp
Problem kojshin();
Problem josephy();
Problem munson1();
Problem billups();
Problem watson4();
// ncp/collection/kkt/kkt.cpp
Problem hs34_kkt();
Problem hs35_kkt();
Problem hs76_kkt();
Problem colvnlp();
Problem colvdual();
// economics.cpp
Problem mathiesen();
Problem kehoe();
// ncp/collection/scalable/games.cpp
Problem nash10();
// choi.cpp
Problem choi();
// distillation.cpp
Problem hydroc06();
Problem methan08();
// tinloi.cpp
Problem tinloi42();
// pies.cpp
Problem pies();
// ncp/collection/scalable/lcps.cpp
Problem cottle2();
Problem cottle4();
Problem infeasible_own();
Problem infeasible_ncp_own();

}  // namespace perp::ncp::collection
