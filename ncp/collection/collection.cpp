#include "ncp/collection/collection.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "ncp/collection/kkt/kkt_entries.hpp"
#include "ncp/collection/models/classic_entries.hpp"
#include "ncp/collection/models/equation_entries.hpp"
#include "ncp/collection/models/problems.hpp"
#include "ncp/collection/random/random_entries.hpp"
#include "ncp/collection/scalable/generators.hpp"
#include "ncp/collection/scalable/scalable_entries.hpp"
#include "ncp/problem/words.hpp"

namespace perp::ncp::collection {

namespace {

constexpr std::array first{
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
    Entry{"infeasible-monotone-own", "lcp", 50, "own data: 50 rows, seed 1",
          "no solution, positive semidefinite, sparse", [] { return infeasible_monotone_own(50, 1); }},
    Entry{"infeasible-monotone-own-500", "lcp", 500, "own data: 500 rows, seed 1",
          "no solution, positive semidefinite, sparse", [] { return infeasible_monotone_own(500, 1); }},
    Entry{"infeasible-ncp-own", "lcp", 2, "own data: F = (-exp(-x2), 1 + x1^2)",
          "no solution, not linear: residuals fall on the way to infinity", infeasible_ncp_own},
    Entry{"infeasible-own", "lcp", 2, "own data: M = [1 -1; -1 1], q = (-1, 1/2)",
          "no solution, monotone: it must be proven, not looped on", infeasible_own},
    Entry{"infeasible-row-own", "lcp", 50, "own data: 50 rows, seed 1",
          "no solution, not copositive: a ray alone is no proof", [] { return infeasible_row_own(50, 1); }},
    Entry{"infeasible-row-own-500", "lcp", 500, "own data: 500 rows, seed 1",
          "no solution, not copositive: a ray alone is no proof", [] { return infeasible_row_own(500, 1); }},
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
    Entry{"random-copositive-own", "lcp", 50, "own data: 50 rows, seed 1",
          "copositive only: a ray of Lemke's method proves nothing", [] { return random_copositive_own(50, 1); }},
    Entry{"random-copositive-plus-own", "lcp", 50, "own data: 50 rows, seed 1",
          "neither semidefinite nor strictly copositive, yet Lemke's method must solve it",
          [] { return random_copositive_plus_own(50, 1); }},
    Entry{"random-copositive-plus-own-500", "lcp", 500, "own data: 500 rows, seed 1",
          "neither semidefinite nor strictly copositive, yet Lemke's method must solve it",
          [] { return random_copositive_plus_own(500, 1); }},
    Entry{"random-degenerate-own", "lcp", 50, "own data: 50 rows, seed 1",
          "half of the indices have z = F = 0; M + M' singular", [] { return random_degenerate_own(50, 1); }},
    Entry{"random-degenerate-own-1000", "lcp", 1000, "own data: 1000 rows, seed 1",
          "half of the indices have z = F = 0; M + M' singular", [] { return random_degenerate_own(1000, 1); }},
    Entry{"random-p-own", "lcp", 50, "own data: 50 rows, seed 1",
          "a P-matrix, indefinite, columns over two orders of magnitude", [] { return random_p_own(50, 1); }},
    Entry{"random-p-own-1000", "lcp", 1000, "own data: 1000 rows, seed 1",
          "a P-matrix, indefinite, columns over two orders of magnitude", [] { return random_p_own(1000, 1); }},
    Entry{"random-pd-own", "lcp", 50, "own data: 50 rows, seed 1", "not hard: positive definite, sparse, not symmetric",
          [] { return random_pd_own(50, 1); }},
    Entry{"random-pd-own-1000", "lcp", 1000, "own data: 1000 rows, seed 1",
          "not hard: positive definite, sparse, not symmetric", [] { return random_pd_own(1000, 1); }},
    Entry{"random-psd-own", "lcp", 50, "own data: 50 rows, seed 1", "monotone, M + M' of half the rank",
          [] { return random_psd_own(50, 1); }},
    Entry{"random-psd-own-1000", "lcp", 1000, "own data: 1000 rows, seed 1", "monotone, M + M' of half the rank",
          [] { return random_psd_own(1000, 1); }},
    Entry{"random-strictly-copositive-own", "lcp", 50, "own data: 50 rows, seed 1",
          "nonnegative and indefinite: several solutions", [] { return random_strictly_copositive_own(50, 1); }},
    Entry{"random-strictly-copositive-own-500", "lcp", 500, "own data: 500 rows, seed 1",
          "nonnegative and indefinite: several solutions", [] { return random_strictly_copositive_own(500, 1); }},
    Entry{"random-z-own", "lcp", 50, "own data: 50 rows, seed 1",
          "Z, not P: several solutions, the least feasible point is one", [] { return random_z_own(50, 1); }},
    Entry{"random-z-own-500", "lcp", 500, "own data: 500 rows, seed 1",
          "Z, not P: several solutions, the least feasible point is one", [] { return random_z_own(500, 1); }},
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
    Entry{"hs34-kkt", "kkt", 5, "Hock & Schittkowski 1981, problem 34; KKT system",
          "an upper bound is active with F < 0; exponential of an exponential", hs34_kkt},
    Entry{"hs35-kkt", "kkt", 4, "Hock & Schittkowski 1981, problem 35 (Beale); KKT system",
          "not hard: a convex quadratic program every method must solve", hs35_kkt},
    Entry{"hs76-kkt", "kkt", 7, "Hock & Schittkowski 1981, problem 76; KKT system",
          "not hard: a convex quadratic program with inactive constraints", hs76_kkt},
    Entry{"josephy", "tiny", 4, "Josephy 1979, Univ. of Wisconsin-Madison, MRC report 1965",
          "linearised at 0 it has no solution; not monotone", josephy},
    Entry{"kojshin", "tiny", 4, "Kojima & Shindo 1986, J. Oper. Res. Soc. Japan 29, 352-374",
          "two solutions, one degenerate; linearised at 0 it has none", kojshin},
    Entry{"munson1", "tiny", 3, "Munson 2000, Univ. of Wisconsin-Madison, PhD thesis",
          "an LCP with a P-matrix that is not positive semidefinite", munson1},
    Entry{"watson4", "tiny", 5, "Watson 1979, SIAM J. Control Optim. 17, 36-46, problem 4",
          "exp of a sum of squares: overflows far away", watson4},
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

constexpr auto table = sorted(first, classic_entries, equation_entries, kkt_entries, random_entries, scalable);

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
