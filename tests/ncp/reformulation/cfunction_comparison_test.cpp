// SPDX-License-Identifier: Apache-2.0
/// The C-functions against each other, on problems on which they differ for a known reason: what a table of their
/// properties says, measured. All functions, and those with a parameter at several values of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "collection/collection.hpp"
#include "ncp/problem/residual.hpp"
#include "ncp/reformulation/cfunction.hpp"
#include "ncp/strategy/solve.hpp"

namespace perp::ncp {
namespace {

std::vector<CFunction> everything() {
  std::vector<CFunction> all(cfunctions().begin(), cfunctions().end());
  all.insert(all.end(), cfunction_grid().begin(), cfunction_grid().end());
  return all;
}

std::string label(const CFunction& c) {
  return c.parameter ? c.name + " (" + std::to_string(c.parameter->value) + ")" : c.name;
}

/// phi and its partials along the generic direction (1, 2).
CValue phi(const CFunction& c, double a, double b) { return c.at(a, b, 1, 2); }

/// ||Phi|| of the iterates of the undamped Newton method x+ = x - phi / phi', of one equation phi(x, F(x)) = 0.
std::vector<double> newton(const CFunction& c, double x, const std::function<std::pair<double, double>(double)>& F) {
  std::vector<double> errors;
  for (int k = 0; k < 60 && std::isfinite(x); ++k) {
    const auto [f, slope] = F(x);
    const CValue at = c.at(x, f, 1, slope);
    errors.push_back(std::abs(std::min(x, f)));
    const double derivative = at.da + at.db * slope;
    if (errors.back() < 1e-14 || derivative == 0) break;
    x -= at.phi / derivative;
  }
  return errors;
}

/// p with e_{k+1} = C e_k^p, from the last three errors above rounding; large where the end is reached in a step.
double order(std::vector<double> errors) {
  while (errors.size() > 3 && errors.back() < 1e-13) errors.pop_back();
  if (errors.size() < 3) return 99;
  const std::size_t n = errors.size();
  return std::log(errors[n - 1] / errors[n - 2]) / std::log(errors[n - 2] / errors[n - 3]);
}

// A regular solution, x = 1 of 0 <= x _|_ x^3 + x - 2: every function converges quadratically, whatever its parameter
// (De Luca, Facchinei & Kanzow 1996). Catches a wrong partial: convergence would be linear.
TEST(CFunctionComparison, QuadraticAtARegularSolution) {
  const auto F = [](double x) { return std::pair(x * x * x + x - 2, 3 * x * x + 1); };
  for (const CFunction& c : everything()) {
    const std::vector<double> errors = newton(c, 1.001, F);
    EXPECT_LT(errors.back(), 1e-12) << label(c);
    EXPECT_GT(order(errors), 1.5) << label(c);
  }
}

// How near is near: from x = 1.2, where F = 0.93, min(x, rho F) with rho >= 10 looks at x alone, steps to 0, where F =
// -2 makes it look at F, and so on for ever. The smaller rho is, the wider Newton's own domain of attraction is here.
TEST(CFunctionComparison, RhoDecidesTheDomainOfAttraction) {
  const auto F = [](double x) { return std::pair(x * x * x + x - 2, 3 * x * x + 1); };
  for (const double rho : {0.01, 0.1, 1.0}) EXPECT_LT(newton(min_rho_b(rho), 1.2, F).back(), 1e-12) << rho;
  for (const double rho : {10.0, 100.0}) EXPECT_GT(newton(min_rho_b(rho), 1.2, F).back(), 0.1) << rho;
  for (const double rho : {1.0, 10.0, 100.0}) EXPECT_LT(newton(min_rho_a(rho), 1.2, F).back(), 1e-12) << rho;
  for (const double rho : {0.01, 0.1}) EXPECT_GT(newton(min_rho_a(rho), 1.2, F).back(), 0.1) << rho;
}

// A degenerate solution, x = F(x) = 0 with F = x + x^2. All functions that are semismooth with regular elements keep
// the order. Evtushenko & Purtov's has gradient 0 there: Newton's method halves the error, the order is 1. Catches a
// property that is claimed and not there, and one that is there and not claimed.
TEST(CFunctionComparison, DegenerateSolutionsTellEvtushenkoPurtov) {
  const auto F = [](double x) { return std::pair(x + x * x, 1 + 2 * x); };
  for (const CFunction& c : everything()) {
    const std::vector<double> errors = newton(c, 0.1, F);
    if (c.properties.singular_at_degenerate) {
      ASSERT_GT(errors.size(), 20U) << label(c);
      EXPECT_NEAR(errors[20] / errors[19], 0.5, 0.05) << label(c);
    } else {
      EXPECT_LT(errors.size(), 12U) << label(c);
      EXPECT_LT(errors.back(), 1e-12) << label(c);
    }
  }
  EXPECT_TRUE(evtushenko_purtov().properties.singular_at_degenerate);
}

/// ||min(x, F)|| of the iterates that the method recorded, from that point.
std::vector<double> recorded(const Mcp& mcp, const Vec& start, const CFunction& c) {
  std::vector<double> residuals;
  const Result result =
      solve(mcp, start, SemismoothNewton{.stop = {.tol = 1e-13}, .cfunction = c}, [&](const Iteration& it) {
        residuals.push_back(it.residual);
        return Next::Continue;
      });
  return residuals;
}

// The two solutions of Kojima and Shindo's problem, by the records of the method itself: (1, 0, 3, 0) is regular and
// not degenerate, every function is quadratic there; at (sqrt(6)/2, 0, 0, 1/2), where x_3 = F_3 = 0, Evtushenko and
// Purtov's takes many steps that each divide the residual by a small number, and so may Luo and Tseng's, whose elements
// vanish there, too. Catches a method that loses the order its functions have.
TEST(CFunctionComparison, OrderFromTheRecordsOfTheMethod) {
  const collection::Problem given = collection::find("kojshin")->make();
  for (const CFunction& c : everything()) {
    const std::vector<double> regular = recorded(*given.mcp, Vec{{1.001, 0.0005, 2.999, 0.0005}}, c);
    EXPECT_LE(regular.size(), 9U) << label(c);
    EXPECT_LT(regular.back(), 1e-12) << label(c);
    EXPECT_GT(order(regular), 1.5) << label(c);
    const std::vector<double> degenerate =
        recorded(*given.mcp, Vec{{std::sqrt(6) / 2 + 1e-3, 5e-4, 1e-3, 0.5 - 1e-3}}, c);
    if (c.name == "evtushenko-purtov") {
      EXPECT_GT(degenerate.size(), 12U) << label(c);
    } else if (!c.properties.singular_at_degenerate) {
      EXPECT_LE(degenerate.size(), 9U) << label(c);
    }
  }
}

// The same zeros, at every parameter: the solutions of named problems, and no other point near them. Catches a function
// whose zeros depend on its parameter.
TEST(CFunctionComparison, AllHaveTheSameSolutions) {
  std::mt19937 random(4);
  std::normal_distribution<double> noise;
  for (const char* name : {"kojshin", "josephy", "mathiesen", "murty", "nash5"}) {
    const collection::Problem given = collection::find(name)->make();
    const Index n = given.mcp->size();
    Vec F(n), Phi(n);
    for (const auto& known : given.solutions) {
      ASSERT_TRUE(given.mcp->eval(known.x, F));
      const double exact = residual(given.mcp->box(), known.x, F).natural;
      for (const CFunction& c : everything()) {
        reformulate(c, given.mcp->box(), known.x, F, Phi);
        EXPECT_LE(Phi.lpNorm<Eigen::Infinity>(), 1e4 * exact * (1 + F.lpNorm<Eigen::Infinity>()) + 1e-12)
            << name << ", " << label(c);
      }
    }
    for (int k = 0; k < 20; ++k) {
      const Vec x =
          lcp::project(given.mcp->box(), given.starts[0] + Vec::NullaryExpr(n, [&](Index) { return noise(random); }));
      if (!given.mcp->eval(x, F) || residual(given.mcp->box(), x, F).natural < 1e-3) continue;
      for (const CFunction& c : everything()) {
        reformulate(c, given.mcp->box(), x, F, Phi);
        EXPECT_GT(Phi.norm(), 1e-12) << name << ", " << label(c);
      }
    }
  }
}

// Level sets along the ray x = t -> inf with F = 1, the case of a monotone F that is not coercive: the functions whose
// value has a bound there leave Psi's level sets open; those with a product a b close them (Chen, Chen & Kanzow 2000;
// Luo & Tseng 1997). Along F = -1 all must grow.
TEST(CFunctionComparison, LevelSetsAlongARay) {
  const std::vector<std::string> closed{"penalised-fischer-burmeister", "evtushenko-purtov", "luo-tseng"};
  for (const CFunction& c : everything()) {
    const double near = std::abs(phi(c, 1e4, 1).phi), far = std::abs(phi(c, 1e8, 1).phi);
    const bool grows = std::ranges::find(closed, c.name) != closed.end();
    if (grows)
      EXPECT_GT(far, 1e3 * near) << label(c);
    else
      EXPECT_LE(far, 1.01 * near + 1e-9) << label(c);
    EXPECT_LT(phi(c, 1e8, -1).phi, -1e-3) << label(c);
    EXPECT_LT(phi(c, -1e8, 1).phi, -1e3 * std::min(1.0, c.parameter ? c.parameter->value : 1.0)) << label(c);
  }
}

// F = 2 - x is not P0. The merit of every function that is symmetric in a and b is stationary at x = F(x) = 1, which is
// no solution; min(a, rho b) with rho != 1 has its kink at x = 2 rho / (1 + rho). Catches a merit that claims less.
TEST(CFunctionComparison, StationaryPointsThatAreNoSolutions) {
  for (const CFunction& c : everything()) {
    const bool shifted = c.name.starts_with("min-rho");
    const double rho = shifted ? c.parameter->value : 1;
    // Where the two pieces of min(a, rho b), or of min(rho a, b), meet on the line a + b = 2.
    const double x = c.name == "min-rho-b" ? 2 * rho / (1 + rho) : shifted ? 2 / (1 + rho) : 1;
    const auto merit = [&](double at) {
      const double value = phi(c, at, 2 - at).phi;
      return 0.5 * value * value;
    };
    const double here = merit(x), h = 1e-3;
    EXPECT_GT(here, 0) << label(c);
    EXPECT_GT(here, merit(x - h)) << label(c) << ": a maximum along the line";
    EXPECT_GT(here, merit(x + h)) << label(c);
    if (c.name == "fischer-burmeister") {
      const CValue at = phi(c, 1, 1);
      EXPECT_NEAR(at.da - at.db, 0, 1e-15);
    }
  }
}

// F = 1000 (x - 1), whose unit is a thousandth of that of x: rho = 0.001 would be the scale that fits. The smaller rho
// is, the more min(x, rho F) sees of F where x is small. Catches rho that has no effect, or the opposite one.
TEST(CFunctionComparison, RhoIsAScale) {
  const double x = 1.001, F = 1000 * (x - 1);  // F = 1: x is near the solution in its own units, F is not in its
  EXPECT_NEAR(phi(min_rho_b(0.01), x, F).phi, 0.01, 1e-12);
  EXPECT_NEAR(phi(min_rho_b(100), x, F).phi, x, 1e-12);
  EXPECT_NEAR(phi(min_rho_a(0.01), x, F).phi, 0.01 * x, 1e-12);
  EXPECT_NEAR(phi(min_rho_a(100), x, F).phi, F, 1e-9);
  for (const double a : {-2.0, 0.3, 5.0})
    for (const double b : {-1.0, 0.7, 4.0}) {
      EXPECT_EQ(phi(min_rho_b(1), a, b).phi, std::min(a, b)) << "at rho = 1 all three are one function";
      EXPECT_EQ(phi(min_rho_a(1), a, b).phi, std::min(a, b));
      EXPECT_EQ(phi(natural_min(), a, b).phi, std::min(a, b));
      for (const double rho : {0.01, 0.1, 10.0, 100.0})
        EXPECT_NEAR(phi(min_rho_a(rho), a, b).phi, rho * phi(min_rho_b(1 / rho), a, b).phi, 1e-12) << rho;
    }
}

// Cubic growth: F = x^3 at x = 0, degenerate and with F' = 0. Elements are singular or nearly so for all; the error
// falls by a constant factor. Catches a claim of fast convergence where there is none.
TEST(CFunctionComparison, NobodyIsFastAtAFlatSolution) {
  const auto F = [](double x) { return std::pair(x * x * x, 3 * x * x); };
  for (const CFunction& c : everything()) {
    if (c.name == "min" || c.name.starts_with("min-rho")) continue;  // they choose one piece, here the linear one
    EXPECT_GT(newton(c, 0.5, F).size(), 8U) << label(c);
  }
}

// What it costs to solve: semismooth Newton by each function on five named problems from their first starts. Margins
// hold under every BLAS: 4 of 5 at least, but for the extreme parameters, which may fail and may not claim.
TEST(CFunctionComparison, OnNamedProblems) {
  std::map<std::string, int> solved;
  for (const CFunction& c : everything()) {
    int count = 0;
    for (const char* name : {"kojshin", "josephy", "mathiesen", "choi", "nash5"}) {
      const collection::Problem given = collection::find(name)->make();
      const Result result = solve(*given.mcp, given.starts[0], SemismoothNewton{.cfunction = c});
      if (result.solved()) {
        ++count;
        EXPECT_LE(residual(*given.mcp, result.x).natural, 1e-8) << name << ", " << label(c);
      }
    }
    solved[label(c)] = count;
  }
  for (const CFunction& c : cfunctions())
    if (c.name != "evtushenko-purtov" && c.name != "luo-tseng") {
      EXPECT_GE(solved[label(c)], 4) << label(c);
    }
  EXPECT_EQ(solved["fischer-burmeister"], 5);
}

/// Pairs solved of those of the collection with at most 20 unknowns, from two starts of each.
int solved_of_the_collection(const CFunction& c) {
  int count = 0;
  for (const collection::Entry& entry : collection::entries()) {
    if (entry.size > 20) continue;
    const collection::Problem given = entry.make();
    for (std::size_t k = 0; k < std::min<std::size_t>(2, given.starts.size()); ++k)
      count += solve(*given.mcp, given.starts[k], SemismoothNewton{.cfunction = c}).solved() ? 1 : 0;
  }
  return count;
}

// What the collection tells, in differences of which rounding makes a third at most (bench/results/collection.md has
// the table, and how much a BLAS changes): products help, singular elements do not, and rho is no formality. Counted
// were 153, 152, 141, 128, 143 and 132 of 162 with the reference BLAS, and no number was more than 2 away with four
// kernels of OpenBLAS (Prescott, Nehalem, Sandybridge, Haswell). Catches a function that has lost what it is chosen
// for.
TEST(CFunctionComparison, OverTheCollection) {
  const int luo = solved_of_the_collection(luo_tseng()), penalised = solved_of_the_collection(cfunctions()[4]);
  const int fischer = solved_of_the_collection(fischer_burmeister());
  const int evtushenko = solved_of_the_collection(evtushenko_purtov());
  const int small = solved_of_the_collection(min_rho_b(0.01)), large = solved_of_the_collection(min_rho_b(100));
  EXPECT_GE(luo, evtushenko + 15);
  EXPECT_GE(penalised, fischer + 4);
  EXPECT_GE(fischer, evtushenko + 6);
  EXPECT_GE(small, large + 5);
}

}  // namespace
}  // namespace perp::ncp
