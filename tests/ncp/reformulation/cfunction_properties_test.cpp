// SPDX-License-Identifier: Apache-2.0
// The table CFunction::properties, by examples and counterexamples of each claim.
#include <gtest/gtest.h>

#include <cmath>

#include "cfunction_cases.hpp"

namespace perp::ncp {
namespace {

using cases::functions;
using cases::Random;
using support::Dense;
using support::sparse;
using support::vec;

bool monotone_level_sets(const CFunction& c) { return c.properties.level_sets.find("monotone") != std::string::npos; }
bool for_p0(const CFunction& c) { return c.properties.stationary_points == "P0-functions"; }

struct Gradient {
  double merit;
  Vec g;  ///< H' Phi
};
/// Of 1/2 ||Phi||^2 for F(x) = M x + q on R^n_+.
Gradient gradient(const CFunction& c, const Dense& M, const Vec& q, const Vec& x) {
  Reformulation at;
  const Vec h = Vec::Ones(x.size());
  reformulate(c, Box::nonnegative(x.size()), x, M * x + q, h, M * h, at);
  return {0.5 * at.Phi.squaredNorm(), at.Da.cwiseProduct(at.Phi) + M.transpose() * at.Db.cwiseProduct(at.Phi)};
}

// smooth_merit: the gradient phi (da, db) of 1/2 phi^2 comes to the same limit from all sides of the kinks. Not so for
// the minima: (t, 0) and (0, t) at a tie. Catches a function that is called smooth but has a kink where phi != 0: a
// line search on its merit may then find no descent.
TEST(Properties, MeritIsContinuouslyDifferentiableWhereSaid) {
  Random random(1);
  for (const CFunction& c : functions()) {
    double jump = 0;
    for (int k = 0; k < 2000; ++k) {
      const double t = random.uniform(0.5, 2);
      const double p = c.parameter ? c.parameter->value : 1;
      const double weight_a = c.name == "min-rho-b" ? p : 1;
      const double weight_b = c.name == "min-rho-a" ? p : 1;
      for (const auto& [a, b] : {std::pair{t, 0.0},
                                 {0.0, t},
                                 {0.0, 0.0},
                                 {weight_a * t, weight_b * t},
                                 {t, -t},
                                 {-weight_a * t, -weight_b * t},
                                 {-t, 0.0}}) {
        const auto at = [&c, x = a, y = b](double ha, double hb) {
          const CValue v = c.at(x + 1e-13 * ha, y + 1e-13 * hb, ha, hb);
          return std::pair{v.phi * v.da, v.phi * v.db};
        };
        const double angle = random.uniform(0, 6.28);
        const auto [a1, b1] = at(std::cos(angle), std::sin(angle));
        const auto [a2, b2] = at(-std::cos(angle), -std::sin(angle));
        const double size = std::max({1e-6, std::abs(a1), std::abs(b1), std::abs(a2), std::abs(b2)});
        jump = std::max({jump, std::abs(a1 - a2) / size, std::abs(b1 - b2) / size});
      }
    }
    if (c.smooth_merit)
      EXPECT_LT(jump, 1e-3) << c.name << " " << (c.parameter ? c.parameter->value : 0);
    else
      EXPECT_GT(jump, 0.1) << c.name;
  }
}

// Facchinei & Pang 2003, section 9.1.2. F(x) = 1: monotone, every x > 0 strictly feasible. Psi(x) for x -> inf tends to
// infinity exactly where the table speaks of monotone F. F(x) = x, a uniform P-function: Psi tends to infinity both
// ways for all. Catches a claim too much and a claim too little.
TEST(Properties, LevelSetsAreBoundedWhereSaid) {
  for (const CFunction& c : functions()) {
    const double far = c.at(1e12, 1, 1, 1).phi;
    if (monotone_level_sets(c))
      EXPECT_GT(far, 1e9) << c.name;
    else
      EXPECT_LT(far, 1e3) << c.name;
    EXPECT_GT(c.at(1e12, 1e12, 1, 1).phi, 1e6) << c.name;
    EXPECT_LT(c.at(-1e12, -1e12, 1, 1).phi, -1e6) << c.name;
  }
}

// The monotone LCP with M = [0 -1; 1 0], q = (2, 0), solved by x = 0. At (5, 1), F = (1, 5): min(x, F) = (1, 1), and
// its element [0 -1; 0 1] gives H'Phi = 0: a stationary point that is no solution. P0-functions have none for those
// that the table says so of (Facchinei & Kanzow 1997; De Luca, Facchinei & Kanzow 1996, theorem 21).
TEST(Properties, MinIsStationaryAtANonSolutionOfAMonotoneProblem) {
  const Dense M = (Dense(2, 2) << 0, -1, 1, 0).finished();
  EXPECT_EQ(gradient(natural_min(), M, vec({2, 0}), vec({5, 1})).g, vec({0, 0}));
  EXPECT_EQ(gradient(natural_min(), M, vec({2, 0}), vec({5, 1})).merit, 1);
  for (const CFunction& c : functions())
    if (for_p0(c)) {
      EXPECT_GT(gradient(c, M, vec({2, 0}), vec({5, 1})).g.norm(), 1e-12) << c.name;
    }
}

// F(x) = x + 2 is strongly monotone; x = 0 solves. At x = -1 (38f) has phi = -1, phi' = b + a = 0. Catches a claim that
// its stationary points are solutions for any class.
TEST(Properties, EvtushenkoPurtovIsStationaryAtANonSolutionOfAStronglyMonotoneProblem) {
  const Dense M = Dense::Ones(1, 1);
  EXPECT_EQ(gradient(evtushenko_purtov(), M, vec({2}), vec({-1})).g[0], 0);
  EXPECT_EQ(gradient(evtushenko_purtov(), M, vec({2}), vec({-1})).merit, 0.5);
  for (const CFunction& c : functions())
    if (for_p0(c)) {
      EXPECT_LT(gradient(c, M, vec({2}), vec({-1})).g[0], -1e-8) << c.name;
    }
}

// Random P0-matrices M = D + K with D >= 0 diagonal, at times 0, and K skew, points of all signs: H'Phi = 0 only where
// Phi = 0, for the functions of which the table says so; the reason is da, db > 0 wherever phi != 0, checked as well.
TEST(Properties, P0FunctionsHaveNoOtherStationaryPoints) {
  Random random(3);
  for (const CFunction& c : functions()) {
    if (!for_p0(c)) continue;
    for (int k = 0; k < 500; ++k) {
      const Index n = 4;
      Dense M = Dense::Zero(n, n);
      Vec q(n);
      Vec x(n);
      for (Index i = 0; i < n; ++i) {
        if (random.chance(0.5)) M(i, i) = random.uniform(0, 2);
        for (Index j = 0; j < i; ++j) M(i, j) = -(M(j, i) = random.normal());
        q[i] = random.normal();
        x[i] = random.chance(0.2) ? 0 : random.normal();
      }
      const Gradient at = gradient(c, M, q, x);
      if (at.merit > 0) {
        ASSERT_GT(at.g.norm(), 1e-9 * std::sqrt(at.merit)) << c.name;
      }
      const Vec F = M * x + q;
      for (Index i = 0; i < n; ++i)
        if (const CValue v = c.at(x[i], F[i], 1, 1); v.phi != 0) {
          ASSERT_TRUE(v.da > 0 && v.db > 0) << c.name << " at " << x[i] << ", " << F[i];
        }
    }
  }
}

// The LCP with M = 1, q = 0: x = 0 is degenerate and regular. Limits of d Phi / dx from inside and outside of the
// orthant vanish exactly for those called singular at degenerate solutions. Catches a wrong line of the table.
TEST(Properties, DegenerateSolutionsAreSingularWhereSaid) {
  for (const CFunction& c : functions()) {
    double least = infinity;
    for (int angle = 0; angle < 360; ++angle) {
      const double turn = angle * 3.141592653589793 / 180;
      const CValue v = c.at(0, 0, std::cos(turn), std::sin(turn));
      least = std::min(least, std::abs(v.da) + std::abs(v.db));
    }
    if (c.properties.singular_at_degenerate)
      EXPECT_EQ(least, 0) << c.name;
    else
      EXPECT_GT(least, 1e-6) << c.name;
  }
}

// Strong semismoothness at z: |phi(z + h) - phi(z) - phi'(z + h) h| <= C |h|^2 (Facchinei & Pang 2003,
// definition 7.4.2), at the kinks of all functions, with h down to 1e-6. Catches an element that is of the wrong piece.
TEST(Properties, StronglySemismoothAtKinks) {
  Random random(4);
  for (const CFunction& c : functions()) {
    ASSERT_TRUE(c.properties.strongly_semismooth) << c.name;
    for (int k = 0; k < 2000; ++k) {
      const double t = random.uniform(0.5, 2);
      const double rho = c.parameter ? c.parameter->value : 1;
      const double ta = c.name == "min-rho-b" ? rho * t : t;
      const double tb = c.name == "min-rho-a" ? rho * t : t;
      const bool linear = !c.smooth_merit;  // kinks at ties alone
      const auto [a, b] = random.chance(0.3)             ? std::pair{0.0, 0.0}
                          : linear || random.chance(0.5) ? std::pair{ta, tb}
                                                         : std::pair{t, 0.0};
      const auto [ha, hb] = cases::direction(random);
      const double s = std::pow(10, -random.uniform(3, 6));
      const CValue at = c.at(a, b, ha, hb);
      const CValue near = c.at(a + s * ha, b + s * hb, ha, hb);
      const double bound = 1e5 * (1 + std::abs(near.da) + std::abs(near.db)) * (ha * ha + hb * hb) * s * s;
      ASSERT_LE(std::abs(near.phi - at.phi - s * (near.da * ha + near.db * hb)), bound + 1e-15 * (std::abs(at.phi) + 1))
          << c.name << " at " << a << ", " << b << " + " << s << " (" << ha << ", " << hb << ")";
    }
  }
}

}  // namespace
}  // namespace perp::ncp
