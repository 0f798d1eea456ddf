// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The catalogue's lines for the KKT systems of kkt_bounds.cpp, kkt_inequalities.cpp and kkt_equalities.cpp. Private to
/// the collection.
#include <algorithm>
#include <array>

#include "collection/base/entry.hpp"

namespace perp::ncp::collection {

Problem hs1_kkt(), hs2_kkt(), hs3_kkt(), hs5_kkt(), hs6_kkt(), hs7_kkt(), hs15_kkt(), hs17_kkt(), hs19_kkt(),
    hs23_kkt(), hs24_kkt(), hs26_kkt(), hs29_kkt(), hs30_kkt(), hs32_kkt(), hs33_kkt(), hs36_kkt(), hs38_kkt(),
    hs41_kkt(), hs43_kkt(), hs44_kkt(), hs45_kkt(), hs53_kkt(), hs56_kkt(), hs61_kkt(), hs62_kkt(), hs64_kkt(),
    hs65_kkt(), hs66_kkt(), hs71_kkt(), hs72_kkt(), hs73_kkt(), hs74_kkt(), hs78_kkt(), hs83_kkt(), hs93_kkt(),
    hs100_kkt(), hs106_kkt(), hs110_kkt(), hs112_kkt(), hs113_kkt(), hs118_kkt();

/// A text as an argument of a template.
template <std::size_t n>
struct Text {
  constexpr Text(const char (&text)[n]) { std::ranges::copy(text, data); }  // NOLINT(google-explicit-constructor)
  char data[n]{};
};

template <Text... parts>
struct Together {
  std::array<char, (sizeof(parts.data) + ...) - sizeof...(parts)> data{};
  constexpr Together() {
    auto* at = data.begin();
    ((at = std::copy_n(parts.data, sizeof(parts.data) - 1, at)), ...);
  }
};
template <Text... parts>
inline constexpr Together<parts...> together_data;
/// The parts as one text, made by the compiler.
template <Text... parts>
inline constexpr std::string_view put_together{together_data<parts...>.data.data(),
                                               together_data<parts...>.data.size()};

/// Of a problem of Hock & Schittkowski.
template <Text problem>
constexpr Entry hs(std::string_view name, Index size, std::string_view hard, Problem (*make)()) {
  return {name, "kkt", size, put_together<"Hock & Schittkowski 1981, problem ", problem, "; KKT system">, hard, make};
}

inline constexpr std::array kkt_entries{
    hs<"1">("hs1-kkt", 2, "Rosenbrock's curved valley; the bound is passed on the way", hs1_kkt),
    hs<"2">("hs2-kkt", 2, "Rosenbrock's valley cut off by a bound; three KKT points", hs2_kkt),
    hs<"3">("hs3-kkt", 2, "nearly flat: slopes of 1e-5 beside a bound", hs3_kkt),
    hs<"5">("hs5-kkt", 2, "not convex: sines; several KKT points, a saddle between the minima", hs5_kkt),
    hs<"6">("hs6-kkt", 3, "Rosenbrock's valley as an equation; its multiplier is 0", hs6_kkt),
    hs<"7">("hs7-kkt", 3, "a nonlinear equation, a maximum as near as the minimum", hs7_kkt),
    hs<"15">("hs15-kkt", 4, "a multiplier of 700 at an upper bound, not convex", hs15_kkt),
    hs<"17">("hs17-kkt", 4, "two active constraints, one with multiplier 0: degenerate", hs17_kkt),
    hs<"19">("hs19-kkt", 4, "two circles that nearly touch, multipliers of 1e3", hs19_kkt),
    hs<"23">("hs23-kkt", 7, "five constraints meet near the minimum; not convex", hs23_kkt),
    hs<"24">("hs24-kkt", 5, "F and its slopes vanish at the origin, which is no minimum", hs24_kkt),
    hs<"26">("hs26-kkt", 4, "a singular Jacobian at the solution: slow last steps", hs26_kkt),
    hs<"29">("hs29-kkt", 4, "four mirrored minima, the origin between them", hs29_kkt),
    hs<"30">("hs30-kkt", 4, "a continuum of multipliers", hs30_kkt),
    hs<"32">("hs32-kkt", 5, "a solution at a vertex, degenerate, with an equation", hs32_kkt),
    hs<"33">("hs33-kkt", 5, "not convex; a local solution at a bound nearby", hs33_kkt),
    hs<"36">("hs36-kkt", 4, "two upper bounds and a constraint active; the origin is a degenerate KKT point", hs36_kkt),
    hs<"38 (Colville 4)">("hs38-kkt", 4, "Wood's function: a saddle on the way, bounds far away", hs38_kkt),
    hs<"41">("hs41-kkt", 5, "an upper bound beside an equation, a degenerate origin", hs41_kkt),
    hs<"43 (Rosen & Suzuki)">("hs43-kkt", 7, "free unknowns, quadratic constraints, one of three inactive", hs43_kkt),
    hs<"44">("hs44-kkt", 10, "an LCP with an indefinite matrix: several KKT points", hs44_kkt),
    hs<"45">("hs45-kkt", 5, "upper bounds are active; a continuum of degenerate KKT points near 0", hs45_kkt),
    hs<"53">("hs53-kkt", 8, "not hard: equations beside inactive bounds, affine", hs53_kkt),
    hs<"56">("hs56-kkt", 11, "periodic, with infinitely many KKT points; all but one multiplier is 0", hs56_kkt),
    hs<"61">("hs61-kkt", 5, "the Jacobian is singular at the first start; not convex", hs61_kkt),
    hs<"62">("hs62-kkt", 4, "logarithms of quotients, F of 1e4", hs62_kkt),
    hs<"64">("hs64-kkt", 4, "poles at 0, F of -1e5 at the start and x of 100 at the solution", hs64_kkt),
    hs<"65">("hs65-kkt", 4, "the start is at the wrong bounds; a sphere", hs65_kkt),
    hs<"66">("hs66-kkt", 5, "exponentials of unknowns that are exponentials", hs66_kkt),
    hs<"71">("hs71-kkt", 6, "products of degree 4, a sphere, a bound", hs71_kkt),
    hs<"72">("hs72-kkt", 6, "poles at 0, multipliers of 1e4 beside slacks of 1e-3", hs72_kkt),
    hs<"73">("hs73-kkt", 7, "a square root of squares that is not smooth at 0; a bound is active", hs73_kkt),
    hs<"74">("hs74-kkt", 9, "sines with amplitudes of 1000, phase angles in a narrow box", hs74_kkt),
    hs<"78">("hs78-kkt", 8, "equations of degree 3, all unknowns free; many KKT points", hs78_kkt),
    hs<"83 (Colville 3)">("hs83-kkt", 11, "five of 16 bounds and constraints are active; F of 1e3", hs83_kkt),
    hs<"93">("hs93-kkt", 8, "polynomials of degree 6", hs93_kkt),
    hs<"100">("hs100-kkt", 11, "sixth powers and multipliers that are 0 in half of the constraints", hs100_kkt),
    hs<"106">("hs106-kkt", 14, "terms of 1e6, multipliers of 1e-2 to 1e4", hs106_kkt),
    hs<"110">("hs110-kkt", 10, "poles of logarithms 0.001 outside the box", hs110_kkt),
    hs<"112">("hs112-kkt", 13, "logarithms with poles at 0, x down to 1e-4", hs112_kkt),
    hs<"113 (Wong 2)">("hs113-kkt", 18, "six of eight constraints are active", hs113_kkt),
    hs<"118">("hs118-kkt", 44, "nearly a linear program; degenerate", hs118_kkt),
};

}  // namespace perp::ncp::collection
