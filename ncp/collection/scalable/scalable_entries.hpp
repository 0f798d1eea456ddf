#pragma once
/// The catalogue's control problems, contacts and networks. Private to the collection.
#include <array>

#include "ncp/collection/models/problems.hpp"
#include "ncp/collection/scalable/generators.hpp"

namespace perp::ncp::collection {

inline constexpr std::array scalable{
    Entry{"lq-control-own", "control", 100, "own data: 20 stages, quadratic costs, linear dynamics",
          "states and adjoints free, controls in a box", [] { return lq_control_own(20); }},
    Entry{"lq-control-own-1000", "control", 1000, "own data: 200 stages, quadratic costs, linear dynamics",
          "as lq-control-own; a basis has long chains", [] { return lq_control_own(200); }},
    Entry{"lq-control-own-10000", "control", 10'000, "own data: 2000 stages, quadratic costs, linear dynamics",
          "as lq-control-own, at a size where sparsity counts", [] { return lq_control_own(2000); }},
    Entry{"vanderpol-own", "control", 200, "own data: van der Pol's oscillator along a reference, 40 steps",
          "not monotone; a limit cycle that the control is too weak to leave at once",
          [] { return vanderpol_own(40); }},
    Entry{"vanderpol-own-1000", "control", 1000, "own data: van der Pol's oscillator along a reference, 200 steps",
          "as vanderpol-own", [] { return vanderpol_own(200); }},
    Entry{"vanderpol-own-10000", "control", 10'000, "own data: van der Pol's oscillator along a reference, 2000 steps",
          "as vanderpol-own; rows of 1 / h = 200", [] { return vanderpol_own(2000); }},
    Entry{"ehl-kost", "mechanics", 101, "Kostreva 1984, Int. J. Numer. Methods Fluids 4, 377-397; 100 points",
          "dense, ill-scaled: an exponential of the pressure times a cube of the gap", [] { return ehl_kost(100); }},
    Entry{"ehl-kost-20", "mechanics", 21, "Kostreva 1984, Int. J. Numer. Methods Fluids 4, 377-397; 20 points",
          "as ehl-kost, coarse", [] { return ehl_kost(20); }},
    Entry{"ehl-kost-50", "mechanics", 51, "Kostreva 1984, Int. J. Numer. Methods Fluids 4, 377-397; 50 points",
          "as ehl-kost, less fine", [] { return ehl_kost(50); }},
    Entry{"pies", "networks", 42, "Hogan 1975, an energy market; as in Josephy 1979 and MCPLIB",
          "an LP whose right-hand side depends on its prices; capacities, free values", pies},
    Entry{"spatial-price-own", "networks", 105, "own data: 25 regions, seed 1",
          "which of the arcs are used must be found; J is singular where nothing is shipped",
          [] { return spatial_price_own(25, 1); }},
    Entry{"spatial-price-own-1138", "networks", 1138, "own data: 240 regions, seed 1", "as spatial-price-own",
          [] { return spatial_price_own(240, 1); }},
    Entry{"traffic-own", "networks", 252, "own data: 4 x 4 nodes, 4 destinations, seed 1",
          "monotone; J is singular at 0 and where destinations share ways; unused ways as short as used ones",
          [] { return traffic_own(4, 4, 1); }},
    Entry{"traffic-own-1148", "networks", 1148, "own data: 8 x 8 nodes, 4 destinations, seed 1", "as traffic-own",
          [] { return traffic_own(8, 8, 1); }},
    Entry{"traffic-own-4860", "networks", 4860, "own data: 16 x 16 nodes, 4 destinations, seed 1",
          "as traffic-own, at a size where sparsity counts", [] { return traffic_own(16, 16, 1); }},
};

}  // namespace perp::ncp::collection
