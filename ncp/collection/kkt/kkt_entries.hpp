#pragma once
/// The catalogue's lines for the KKT systems of kkt_bounds.cpp, kkt_inequalities.cpp and kkt_equalities.cpp. Private to
/// the collection.
#include <array>

#include "ncp/collection/base/entry.hpp"

namespace perp::ncp::collection {

Problem hs1_kkt();
Problem hs2_kkt();
Problem hs3_kkt();
Problem hs5_kkt();
Problem hs6_kkt();
Problem hs7_kkt();
Problem hs15_kkt();
Problem hs17_kkt();
Problem hs19_kkt();
Problem hs23_kkt();
Problem hs24_kkt();
Problem hs26_kkt();
Problem hs29_kkt();
Problem hs30_kkt();
Problem hs32_kkt();
Problem hs33_kkt();
Problem hs36_kkt();
Problem hs38_kkt();
Problem hs41_kkt();
Problem hs43_kkt();
Problem hs44_kkt();
Problem hs45_kkt();
Problem hs53_kkt();
Problem hs56_kkt();
Problem hs61_kkt();
Problem hs62_kkt();
Problem hs64_kkt();
Problem hs65_kkt();
Problem hs66_kkt();
Problem hs71_kkt();
Problem hs72_kkt();
Problem hs73_kkt();
Problem hs74_kkt();
Problem hs78_kkt();
Problem hs83_kkt();
Problem hs93_kkt();
Problem hs100_kkt();
Problem hs106_kkt();
Problem hs110_kkt();
Problem hs112_kkt();
Problem hs113_kkt();
Problem hs118_kkt();

inline constexpr std::array kkt_entries{
    Entry{"hs1-kkt", "kkt", 2, "Hock & Schittkowski 1981, problem 1; KKT system",
          "Rosenbrock's curved valley; the bound is passed on the way", hs1_kkt},
    Entry{"hs2-kkt", "kkt", 2, "Hock & Schittkowski 1981, problem 2; KKT system",
          "Rosenbrock's valley cut off by a bound; three KKT points", hs2_kkt},
    Entry{"hs3-kkt", "kkt", 2, "Hock & Schittkowski 1981, problem 3; KKT system",
          "nearly flat: slopes of 1e-5 beside a bound", hs3_kkt},
    Entry{"hs5-kkt", "kkt", 2, "Hock & Schittkowski 1981, problem 5; KKT system",
          "not convex: sines; several KKT points, a saddle between the minima", hs5_kkt},
    Entry{"hs6-kkt", "kkt", 3, "Hock & Schittkowski 1981, problem 6; KKT system",
          "Rosenbrock's valley as an equation; its multiplier is 0", hs6_kkt},
    Entry{"hs7-kkt", "kkt", 3, "Hock & Schittkowski 1981, problem 7; KKT system",
          "a nonlinear equation, a maximum as near as the minimum", hs7_kkt},
    Entry{"hs15-kkt", "kkt", 4, "Hock & Schittkowski 1981, problem 15; KKT system",
          "a multiplier of 700 at an upper bound, not convex", hs15_kkt},
    Entry{"hs17-kkt", "kkt", 4, "Hock & Schittkowski 1981, problem 17; KKT system",
          "two active constraints, one with multiplier 0: degenerate", hs17_kkt},
    Entry{"hs19-kkt", "kkt", 4, "Hock & Schittkowski 1981, problem 19; KKT system",
          "two circles that nearly touch, multipliers of 1e3", hs19_kkt},
    Entry{"hs23-kkt", "kkt", 7, "Hock & Schittkowski 1981, problem 23; KKT system",
          "five constraints meet near the minimum; not convex", hs23_kkt},
    Entry{"hs24-kkt", "kkt", 5, "Hock & Schittkowski 1981, problem 24; KKT system",
          "F and its slopes vanish at the origin, which is no minimum", hs24_kkt},
    Entry{"hs26-kkt", "kkt", 4, "Hock & Schittkowski 1981, problem 26; KKT system",
          "a singular Jacobian at the solution: slow last steps", hs26_kkt},
    Entry{"hs29-kkt", "kkt", 4, "Hock & Schittkowski 1981, problem 29; KKT system",
          "four mirrored minima, the origin between them", hs29_kkt},
    Entry{"hs30-kkt", "kkt", 4, "Hock & Schittkowski 1981, problem 30; KKT system", "a continuum of multipliers",
          hs30_kkt},
    Entry{"hs32-kkt", "kkt", 5, "Hock & Schittkowski 1981, problem 32; KKT system",
          "a solution at a vertex, degenerate, with an equation", hs32_kkt},
    Entry{"hs33-kkt", "kkt", 5, "Hock & Schittkowski 1981, problem 33; KKT system",
          "not convex; a local solution at a bound nearby", hs33_kkt},
    Entry{"hs36-kkt", "kkt", 4, "Hock & Schittkowski 1981, problem 36; KKT system",
          "two upper bounds and a constraint active; the origin is a degenerate KKT point", hs36_kkt},
    Entry{"hs38-kkt", "kkt", 4, "Hock & Schittkowski 1981, problem 38 (Colville 4); KKT system",
          "Wood's function: a saddle on the way, bounds far away", hs38_kkt},
    Entry{"hs41-kkt", "kkt", 5, "Hock & Schittkowski 1981, problem 41; KKT system",
          "an upper bound beside an equation, a degenerate origin", hs41_kkt},
    Entry{"hs43-kkt", "kkt", 7, "Hock & Schittkowski 1981, problem 43 (Rosen & Suzuki); KKT system",
          "free unknowns, quadratic constraints, one of three inactive", hs43_kkt},
    Entry{"hs44-kkt", "kkt", 10, "Hock & Schittkowski 1981, problem 44; KKT system",
          "an LCP with an indefinite matrix: several KKT points", hs44_kkt},
    Entry{"hs45-kkt", "kkt", 5, "Hock & Schittkowski 1981, problem 45; KKT system",
          "upper bounds are active; a continuum of degenerate KKT points near 0", hs45_kkt},
    Entry{"hs53-kkt", "kkt", 8, "Hock & Schittkowski 1981, problem 53; KKT system",
          "not hard: equations beside inactive bounds, affine", hs53_kkt},
    Entry{"hs56-kkt", "kkt", 11, "Hock & Schittkowski 1981, problem 56; KKT system",
          "periodic, with infinitely many KKT points; all but one multiplier is 0", hs56_kkt},
    Entry{"hs61-kkt", "kkt", 5, "Hock & Schittkowski 1981, problem 61; KKT system",
          "the Jacobian is singular at the first start; not convex", hs61_kkt},
    Entry{"hs62-kkt", "kkt", 4, "Hock & Schittkowski 1981, problem 62; KKT system", "logarithms of quotients, F of 1e4",
          hs62_kkt},
    Entry{"hs64-kkt", "kkt", 4, "Hock & Schittkowski 1981, problem 64; KKT system",
          "poles at 0, F of -1e5 at the start and x of 100 at the solution", hs64_kkt},
    Entry{"hs65-kkt", "kkt", 4, "Hock & Schittkowski 1981, problem 65; KKT system",
          "the start is at the wrong bounds; a sphere", hs65_kkt},
    Entry{"hs66-kkt", "kkt", 5, "Hock & Schittkowski 1981, problem 66; KKT system",
          "exponentials of unknowns that are exponentials", hs66_kkt},
    Entry{"hs71-kkt", "kkt", 6, "Hock & Schittkowski 1981, problem 71; KKT system",
          "products of degree 4, a sphere, a bound", hs71_kkt},
    Entry{"hs72-kkt", "kkt", 6, "Hock & Schittkowski 1981, problem 72; KKT system",
          "poles at 0, multipliers of 1e4 beside slacks of 1e-3", hs72_kkt},
    Entry{"hs73-kkt", "kkt", 7, "Hock & Schittkowski 1981, problem 73; KKT system",
          "a square root of squares that is not smooth at 0; a bound is active", hs73_kkt},
    Entry{"hs74-kkt", "kkt", 9, "Hock & Schittkowski 1981, problem 74; KKT system",
          "sines with amplitudes of 1000, phase angles in a narrow box", hs74_kkt},
    Entry{"hs78-kkt", "kkt", 8, "Hock & Schittkowski 1981, problem 78; KKT system",
          "equations of degree 3, all unknowns free; many KKT points", hs78_kkt},
    Entry{"hs83-kkt", "kkt", 11, "Hock & Schittkowski 1981, problem 83 (Colville 3); KKT system",
          "five of 16 bounds and constraints are active; F of 1e3", hs83_kkt},
    Entry{"hs93-kkt", "kkt", 8, "Hock & Schittkowski 1981, problem 93; KKT system", "polynomials of degree 6",
          hs93_kkt},
    Entry{"hs100-kkt", "kkt", 11, "Hock & Schittkowski 1981, problem 100; KKT system",
          "sixth powers and multipliers that are 0 in half of the constraints", hs100_kkt},
    Entry{"hs106-kkt", "kkt", 14, "Hock & Schittkowski 1981, problem 106; KKT system",
          "terms of 1e6, multipliers of 1e-2 to 1e4", hs106_kkt},
    Entry{"hs110-kkt", "kkt", 10, "Hock & Schittkowski 1981, problem 110; KKT system",
          "poles of logarithms 0.001 outside the box", hs110_kkt},
    Entry{"hs112-kkt", "kkt", 13, "Hock & Schittkowski 1981, problem 112; KKT system",
          "logarithms with poles at 0, x down to 1e-4", hs112_kkt},
    Entry{"hs113-kkt", "kkt", 18, "Hock & Schittkowski 1981, problem 113 (Wong 2); KKT system",
          "six of eight constraints are active", hs113_kkt},
    Entry{"hs118-kkt", "kkt", 44, "Hock & Schittkowski 1981, problem 118; KKT system",
          "nearly a linear program; degenerate", hs118_kkt},
};

}  // namespace perp::ncp::collection
