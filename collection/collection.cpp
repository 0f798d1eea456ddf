// SPDX-License-Identifier: Apache-2.0
#include "collection/collection.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "collection/kkt/kkt_entries.hpp"
#include "collection/models/problems.hpp"
#include "collection/random/random_ncps.hpp"
#include "collection/scalable/generators.hpp"
#include "ncp/problem/words.hpp"

namespace perp::ncp::collection {

namespace {

/// Of a problem of More, Garbow & Hillstrom.
template <Text problem>
constexpr Entry mgh(std::string_view name, Index size, std::string_view hard, Problem (*make)()) {
  return {name, "equations",
          size, put_together<"More, Garbow & Hillstrom 1981, ACM Trans. Math. Software 7, problem ", problem>,
          hard, make};
}

/// Of a made problem of so many rows.
template <Problem (*make)(Index, unsigned), Index n>
constexpr Entry of_rows(std::string_view name, std::string_view problem_class, std::string_view hard) {
  static_assert(n == 50 || n == 500 || n == 1000);
  return {
      name,
      problem_class,
      n,
      n == 50 ? "own data: 50 rows, seed 1" : n == 500 ? "own data: 500 rows, seed 1" : "own data: 1000 rows, seed 1",
      hard,
      [] { return make(n, 1); }};
}

constexpr std::array others{
    Entry{"hydroc06", "chemical", 29, "Fletcher's hydrocarbon column, 6 stages, in More 1990",
          "free variables; temperatures of 100 beside fractions of 0.01; exponentials", hydroc06},
    Entry{"methan08", "chemical", 31, "Fletcher's methanol column, 8 stages, in More 1990",
          "free variables; flows of 1000 beside fractions; exponentials", methan08},
    Entry{"kehoe", "economics", 10, "Kehoe 1985, Quart. J. Econ. 100, 119-147",
          "three equilibria; free variables and a fixed one; poles at p = 0", kehoe},
    Entry{"mathiesen", "economics", 4, "Mathiesen 1987, Math. Prog. 37, 1-18; parameters (.9, 5, 3)",
          "a ray of solutions, the Jacobian singular at each of them", mathiesen},
    Entry{"walras-own", "economics", 100, "own data: 40 goods, 30 sectors, 30 households, seed 1",
          "sparse; incomes free, a numeraire fixed; poles at p = 0; idle sectors",
          [] { return walras_own(40, 30, 30, 1); }},
    Entry{"walras-own-1000", "economics", 1000, "own data: 400 goods, 300 sectors, 300 households, seed 1",
          "as walras-own, at a size where sparsity counts", [] { return walras_own(400, 300, 300, 1); }},
    Entry{"bimatrix-own", "games", 22, "own data: 12 x 10 strategies, seed 1",
          "an LCP with zero diagonal blocks, several solutions; singular bases",
          [] { return bimatrix_own(12, 10, 1); }},
    Entry{"bimatrix-own-50", "games", 50, "own data: 30 x 20 strategies, seed 1",
          "as bimatrix-own: Newton methods stall, paths of Lemke's method get very long",
          [] { return bimatrix_own(30, 20, 1); }},
    Entry{"choi", "games", 14, "Choi, DeSarbo & Harker 1990, Management Science 36, 175-199",
          "dense and costly, one variable fixed; F fades at high prices: far points pass for solutions", choi},
    Entry{"nash-own", "games", 100, "own data: 100 firms in the manner of nash10, seed 1",
          "as nash10; firms at q = 0 with steep slopes", [] { return nash_own(100, 1); }},
    Entry{"nash10", "games", 10, "Harker's ten firms, after Murphy, Sherali & Soyster 1982",
          "powers: not defined for q < 0, infinite slopes at q = 0", nash10},
    Entry{"ahn", "lcp", 128, "Ahn 1983, Math. Prog. 26, 295-315: tridiag(1, 4, -2)",
          "not hard: a sparse P-matrix, not symmetric", [] { return ahn(128); }},
    Entry{"cottle2", "lcp", 2, "a small example attributed to Cottle",
          "not hard: symmetric positive definite, both rows active", cottle2},
    Entry{"cottle4", "lcp", 4, "a small quadratic program attributed to Cottle",
          "positive semidefinite, neither symmetric nor definite", cottle4},
    Entry{"fathi", "lcp", 32, "Fathi 1979, Math. Prog. 17, 335-344",
          "symmetric positive definite, ill-conditioned; exponential for pivoting methods", [] { return fathi(32); }},
    Entry{"geiger-kanzow", "lcp", 128, "Geiger & Kanzow 1996, Comput. Optim. Appl. 5, 155-173: tridiag(-1, 4, -1)",
          "not hard: a sparse M-matrix, every variable positive", [] { return geiger_kanzow(128); }},
    of_rows<infeasible_monotone_own, 50>("infeasible-monotone-own", "lcp",
                                         "no solution, positive semidefinite, sparse"),
    of_rows<infeasible_monotone_own, 500>("infeasible-monotone-own-500", "lcp",
                                          "no solution, positive semidefinite, sparse"),
    Entry{"infeasible-ncp-own", "lcp", 2, "own data: F = (-exp(-x2), 1 + x1^2)",
          "no solution, not linear: residuals fall on the way to infinity", infeasible_ncp_own},
    Entry{"infeasible-own", "lcp", 2, "own data: M = [1 -1; -1 1], q = (-1, 1/2)",
          "no solution, monotone: it must be proven, not looped on", infeasible_own},
    of_rows<infeasible_row_own, 50>("infeasible-row-own", "lcp",
                                    "no solution, not copositive: a ray alone is no proof"),
    of_rows<infeasible_row_own, 500>("infeasible-row-own-500", "lcp",
                                     "no solution, not copositive: a ray alone is no proof"),
    Entry{"murty", "lcp", 16, "Murty 1978, Math. Prog. Study 7; explcp of MCPLIB",
          "a P-matrix; pivoting rules may need 2^n pivots", [] { return murty(16); }},
    Entry{"murty-60", "lcp", 60, "Murty 1978, Math. Prog. Study 7; explcp of MCPLIB",
          "least-index rules would take 2^60 pivots", [] { return murty(60); }},
    Entry{"murty-exp", "lcp", 16, "Murty 1978, Math. Prog. Study 7, with his right-hand side",
          "Lemke's method with covering vector e takes 2^n pivots", [] { return murty_exp(16); }},
    Entry{"murty-exp-50", "lcp", 50, "Murty 1978, Math. Prog. Study 7, with his right-hand side",
          "2^50 pivots for Lemke's method; a substitution for who sees the triangle", [] { return murty_exp(50); }},
    Entry{"murty-lower", "lcp", 16, "Murty 1978, Math. Prog. Study 7; transposed",
          "a P-matrix; pivoting rules may need 2^n pivots", [] { return murty_lower(16); }},
    Entry{"obstacle-bump-own", "lcp", 900, "own data: a membrane over a bump, 30 x 30",
          "the contact set must be found; F is 1e-9 around it", [] { return obstacle_bump_own(30); }},
    Entry{"random-bimatrix-own", "lcp", 40, "own data: 20 x 20 strategies, seed 1",
          "no solution is planted; one exists (Nash 1951)", [] { return random_bimatrix_own(20, 20, 1); }},
    of_rows<random_copositive_own, 50>("random-copositive-own", "lcp",
                                       "copositive only: a ray of Lemke's method proves nothing"),
    of_rows<random_copositive_plus_own, 50>(
        "random-copositive-plus-own", "lcp",
        "neither semidefinite nor strictly copositive, yet Lemke's method must solve it"),
    of_rows<random_copositive_plus_own, 500>(
        "random-copositive-plus-own-500", "lcp",
        "neither semidefinite nor strictly copositive, yet Lemke's method must solve it"),
    of_rows<random_degenerate_own, 50>("random-degenerate-own", "lcp",
                                       "half of the indices have z = F = 0; M + M' singular"),
    of_rows<random_degenerate_own, 1000>("random-degenerate-own-1000", "lcp",
                                         "half of the indices have z = F = 0; M + M' singular"),
    of_rows<random_p_own, 50>("random-p-own", "lcp", "a P-matrix, indefinite, columns over two orders of magnitude"),
    of_rows<random_p_own, 1000>("random-p-own-1000", "lcp",
                                "a P-matrix, indefinite, columns over two orders of magnitude"),
    of_rows<random_pd_own, 50>("random-pd-own", "lcp", "not hard: positive definite, sparse, not symmetric"),
    of_rows<random_pd_own, 1000>("random-pd-own-1000", "lcp", "not hard: positive definite, sparse, not symmetric"),
    of_rows<random_psd_own, 50>("random-psd-own", "lcp", "monotone, M + M' of half the rank"),
    of_rows<random_psd_own, 1000>("random-psd-own-1000", "lcp", "monotone, M + M' of half the rank"),
    of_rows<random_strictly_copositive_own, 50>("random-strictly-copositive-own", "lcp",
                                                "nonnegative and indefinite: several solutions"),
    of_rows<random_strictly_copositive_own, 500>("random-strictly-copositive-own-500", "lcp",
                                                 "nonnegative and indefinite: several solutions"),
    of_rows<random_z_own, 50>("random-z-own", "lcp", "Z, not P: several solutions, the least feasible point is one"),
    of_rows<random_z_own, 500>("random-z-own-500", "lcp",
                               "Z, not P: several solutions, the least feasible point is one"),
    Entry{"tinloi42", "mechanics", 42, "Tin-Loi & Tseng 2003, Comput. Methods Appl. Mech. Engrg. 192, 1377-1388",
          "an LCP with an indefinite matrix and two solutions; dense Lemke codes lose accuracy", tinloi42},
    Entry{"american-put-own", "pde", 800, "own data: 20 steps x 40 prices, implicit Euler",
          "not symmetric; early exercise must be found at every step; v - payoff fades to 0 without touching",
          [] { return american_put_own(20, 40); }},
    Entry{"bratu-own", "pde", 900, "own data: Bratu's equation, lambda = 6, 30 x 30", "near a fold; several solutions",
          [] { return bratu_own(30, 30); }},
    Entry{"journal-bearing", "pde", 900, "Averick, Carter, More & Xue 1992, MINPACK-2, section 4.2; 30 x 30",
          "a long thin domain: couplings of very different strength", [] { return journal_bearing(30, 30); }},
    Entry{"obstacle", "pde", 2500, "MCPLIB's obstacle, Dirkse & Ferris 1995; 50 x 50", "two contact sets must be found",
          [] { return obstacle(50, 50); }},
    Entry{"torsion", "pde", 900, "Averick, Carter, More & Xue 1992, MINPACK-2, section 4.1; 30 x 30",
          "most of the bar is plastic; the start is at the wrong bounds", [] { return torsion(30, 30); }},
    Entry{"billups", "tiny", 1, "Billups 1995, Univ. of Wisconsin-Madison, PhD thesis",
          "merit functions have a local minimum near 0 that is no solution", billups},
    Entry{"colvdual", "kkt", 20, "Colville 1968, problem 2 (HS117); KKT system",
          "not monotone: merit functions have stationary points that are no solutions", colvdual},
    Entry{"colvnlp", "kkt", 15, "Colville 1968, problem 1 (HS86); KKT system",
          "which of 10 constraints and 5 bounds are active must be found", colvnlp},
    hs<"34">("hs34-kkt", 5, "an upper bound is active with F < 0; exponential of an exponential", hs34_kkt),
    hs<"35 (Beale)">("hs35-kkt", 4, "not hard: a convex quadratic program every method must solve", hs35_kkt),
    hs<"76">("hs76-kkt", 7, "not hard: a convex quadratic program with inactive constraints", hs76_kkt),
    Entry{"josephy", "tiny", 4, "Josephy 1979, Univ. of Wisconsin-Madison, MRC report 1965",
          "linearised at 0 it has no solution; not monotone", josephy},
    Entry{"kojshin", "tiny", 4, "Kojima & Shindo 1986, J. Oper. Res. Soc. Japan 29, 352-374",
          "two solutions, one degenerate; linearised at 0 it has none", kojshin},
    Entry{"munson1", "tiny", 3, "Munson 2000, Univ. of Wisconsin-Madison, PhD thesis",
          "an LCP with a P-matrix that is not positive semidefinite", munson1},
    Entry{"watson4", "tiny", 5, "Watson 1979, SIAM J. Control Optim. 17, 36-46, problem 4",
          "exp of a sum of squares: overflows far away", watson4},
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
    Entry{"boundary-value-obstacle-own", "equations", 50,
          "own data: the discrete boundary value problem above an obstacle",
          "the contact set must be found; steep far away", boundary_value_obstacle_own},
    mgh<"31">("broyden-banded", 10, "far starts: cubes of 100", broyden_banded),
    Entry{"broyden-ncp-own", "equations", 40, "own data: Broyden's tridiagonal function from a planted point",
          "not monotone; a quarter of the indices are degenerate", broyden_ncp_own},
    mgh<"30">("broyden-tridiagonal", 10, "far starts, where the other branch of each parabola is nearer",
              broyden_tridiagonal),
    mgh<"27">("brown-almost-linear", 10, "J is close to singular on the way; products of ten unknowns",
              brown_almost_linear),
    Entry{"chandrasekhar", "equations", 50, "Chandrasekhar 1960, as in Kelley 1995, section 5.6; c = 0.9, 50 nodes",
          "dense; poles behind far starts", [] { return chandrasekhar("chandrasekhar", 0.9); }},
    Entry{"chandrasekhar-1", "equations", 50, "Chandrasekhar 1960, as in Kelley 1995, section 5.6; c = 1, 50 nodes",
          "J is singular at the solution: slow last steps", [] { return chandrasekhar("chandrasekhar-1", 1); }},
    mgh<"35">("chebyquad", 7, "J is singular where two unknowns are equal; polynomials of degree 7", chebyquad),
    mgh<"28">("discrete-boundary-value", 10, "not hard: a sparse M-function, started near", discrete_boundary_value),
    mgh<"29">("discrete-integral-equation", 10, "not hard: dense, nearly the identity", discrete_integral_equation),
    mgh<"7">("helical-valley", 3, "a branch cut that a step may cross", helical_valley),
    mgh<"3">("powell-badly-scaled", 2, "x1 is 1e-5 and x2 is 9; exponentials", powell_badly_scaled),
    mgh<"13">("powell-singular", 4, "J has rank 2 at the solution", powell_singular),
    mgh<"1">("rosenbrock", 2, "a curved valley", rosenbrock),
    mgh<"26">("trigonometric", 10, "several solutions; merit functions have local minima", trigonometric),
    Entry{"trigonometric-ncp-own", "equations", 20, "own data: the trigonometric function from a planted point",
          "periodic, not monotone; a quarter of the indices are degenerate", trigonometric_ncp_own},
    mgh<"25">("variably-dimensioned", 10, "cubes of sums: F of 1e10 far away", variably_dimensioned),
    mgh<"14">("wood", 4, "a saddle on the way", wood),
    of_rows<random_boxed_ncp_own, 50>("random-boxed-ncp-own", "random",
                                      "all kinds of bounds: one-sided, two-sided, free, fixed"),
    of_rows<random_boxed_ncp_own, 1000>("random-boxed-ncp-own-1000", "random",
                                        "all kinds of bounds: one-sided, two-sided, free, fixed"),
    of_rows<random_degenerate_ncp_own, 50>("random-degenerate-ncp-own", "random", "half of the indices have x = F = 0"),
    of_rows<random_degenerate_ncp_own, 1000>("random-degenerate-ncp-own-1000", "random",
                                             "half of the indices have x = F = 0"),
    of_rows<random_exponential_ncp_own, 50>("random-exponential-ncp-own", "random",
                                            "exponentials: Newton steps from 0 lead to where F is not defined"),
    of_rows<random_ill_conditioned_ncp_own, 50>("random-ill-conditioned-ncp-own", "random",
                                                "entries of J over eight orders of magnitude, x over four"),
    of_rows<random_monotone_ncp_own, 50>("random-monotone-ncp-own", "random",
                                         "not hard: strictly monotone, sparse, not symmetric"),
    of_rows<random_monotone_ncp_own, 1000>("random-monotone-ncp-own-1000", "random",
                                           "not hard: strictly monotone, sparse, not symmetric"),
    of_rows<random_p0_ncp_own, 50>("random-p0-ncp-own", "random",
                                   "P0, not monotone; J is singular at the start 0 and wherever a cube's unknown is 0"),
    of_rows<random_p0_ncp_own, 1000>(
        "random-p0-ncp-own-1000", "random",
        "P0, not monotone; J is singular at the start 0 and wherever a cube's unknown is 0"),
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
    Entry{"bertsekas", "networks", 15,
          "Bertsekas & Gafni 1982, Math. Prog. Study 17, 139-159; as in netlib's AMPL models",
          "a traffic equilibrium with delays of merging streams: J is not symmetric", bertsekas},
    Entry{"freebert", "networks", 15, "bertsekas with free times", "as bertsekas, with equations for the demands",
          freebert},
    Entry{"gafni", "networks", 5, "bertsekas with flows only",
          "as bertsekas, in a box: which ways are used must be found", gafni},
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

/// The parts of the catalogue as one, sorted by class, then name.
template <std::size_t... sizes>
constexpr auto sorted(const std::array<Entry, sizes>&... parts) {
  std::array<Entry, (sizes + ...)> all{};
  auto* at = all.begin();
  ((at = std::ranges::copy(parts, at).out), ...);
  std::ranges::sort(all, {}, [](const Entry& entry) { return std::pair(entry.problem_class, entry.name); });
  return all;
}

constexpr auto table = sorted(others, kkt_entries);

}  // namespace

std::span<const Entry> entries() { return table; }

const Entry* find(std::string_view name) {
  const auto found = std::ranges::find(table, name, &Entry::name);
  return found == table.end() ? nullptr : &*found;
}

std::vector<std::string_view> similar(std::string_view name) {
  std::vector<std::pair<std::size_t, std::string_view>> close;
  for (const Entry& entry : table) {
    const std::size_t near = std::max<std::size_t>(1, entry.name.size() / 3);
    // The distance is the difference of the lengths at least; a name may be megabytes long.
    if (name.size() > entry.name.size() + near) continue;
    const bool prefix = name.size() >= 2 && entry.name.starts_with(name);
    if (!prefix && entry.name.size() > name.size() + near) continue;
    const std::size_t distance = prefix ? 0 : edit_distance(name, entry.name);
    if (distance <= near) close.emplace_back(distance, entry.name);
  }
  std::ranges::sort(close);
  std::vector<std::string_view> names;
  names.reserve(close.size());
  for (const auto& [distance, candidate] : close) names.push_back(candidate);
  return names;
}

}  // namespace perp::ncp::collection
