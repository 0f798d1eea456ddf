// SPDX-License-Identifier: Apache-2.0
// The KKT systems of Hock & Schittkowski's problems against what the book prints: minimum and its value. Catches: a
// wrong coefficient that moves the solution; the objective's derivatives are then those of another problem.
#include <gtest/gtest.h>

#include <cmath>

#include "collection/collection.hpp"
#include "collection/kkt/kkt_entries.hpp"
#include "ncp/problem/residual.hpp"

namespace perp::ncp::collection {
namespace {

struct Printed {
  std::string_view name;
  double value;
  std::vector<double> x;
};

// Hock & Schittkowski 1981, as printed there; hs106, which is less exact there, from Liang et al. 2006, CEC problem
// g10.
const std::vector<Printed>& printed() {
  static const std::vector<Printed> all{
      {"hs1-kkt", 0, {1, 1}},
      {"hs2-kkt", 0.0504261879, {1.224370749, 1.5}},
      {"hs3-kkt", 0, {0, 0}},
      {"hs5-kkt", -1.913222955, {-0.5471975511965976, -1.5471975511965976}},
      {"hs6-kkt", 0, {1, 1}},
      {"hs7-kkt", -1.7320508075688772, {0, 1.7320508075688772}},
      {"hs15-kkt", 306.5, {0.5, 2}},
      {"hs17-kkt", 1, {0, 0}},
      {"hs19-kkt", -6961.81381, {14.095, 0.84296079}},
      {"hs23-kkt", 2, {1, 1}},
      {"hs24-kkt", -1, {3, 1.732050808}},
      {"hs26-kkt", 0, {1, 1, 1}},
      {"hs29-kkt", -22.627417, {4, 2.828427125, 2}},
      {"hs30-kkt", 1, {1, 0, 0}},
      {"hs32-kkt", 1, {0, 0, 1}},
      {"hs33-kkt", -4.585786438, {0, 1.414213562, 1.414213562}},
      {"hs36-kkt", -3300, {20, 11, 15}},
      {"hs38-kkt", 0, {1, 1, 1, 1}},
      {"hs41-kkt", 1.925925926, {0.6666666667, 0.3333333333, 0.3333333333, 2}},
      {"hs43-kkt", -44, {0, 1, 2, -1}},
      {"hs44-kkt", -15, {0, 3, 0, 4}},
      {"hs45-kkt", 1, {1, 2, 3, 4, 5}},
      {"hs53-kkt", 4.093023256, {-0.7674418605, 0.2558139535, 0.6279069767, -0.1162790698, 0.2558139535}},
      {"hs56-kkt", -3.456, {2.4, 1.2, 1.2}},
      {"hs61-kkt", -143.6461422, {5.326770157, -2.118998639, 3.210464239}},
      {"hs62-kkt", -26272.51448, {0.6178126908, 0.328202223, 0.05398508606}},
      {"hs64-kkt", 6299.842428, {108.7347175, 85.12613942, 204.3247078}},
      {"hs65-kkt", 0.9535288567, {3.650461821, 3.65046168, 4.6204170507}},
      {"hs66-kkt", 0.5181632741, {0.1841264879, 1.202167873, 3.327322322}},
      {"hs71-kkt", 17.0140173, {1, 4.7429994, 3.8211503, 1.3794082}},
      {"hs72-kkt", 727.67937, {193.4071, 179.5475, 185.0186, 168.7062}},
      {"hs73-kkt", 29.894378, {0.6355216, -1.2e-12, 0.3127019, 0.05177655}},
      {"hs74-kkt", 5126.4981, {679.9453, 1026.067, 0.1188764, -0.3962336}},
      {"hs78-kkt", -2.91970041, {-1.717142, 1.595708, 1.827248, -0.7636429, -0.7636435}},
      {"hs83-kkt", -30665.53867, {78, 33, 29.99526, 45, 36.77581}},
      {"hs93-kkt", 135.075961, {5.332666, 4.656744, 10.43299, 12.0823, 0.7526074, 0.87865084}},
      {"hs100-kkt", 680.6300573, {2.330499, 1.951372, -0.4775414, 4.365726, -0.624487, 1.038131, 1.594227}},
      {"hs106-kkt",
       7049.24802052867,
       {579.306685017979589, 1359.97067807935605, 5109.97065743133317, 182.01769963061534, 295.601173702746792,
        217.982300369384632, 286.41652592786852, 395.601173702746735}},
      {"hs110-kkt",
       -45.77846971,
       {9.35025655, 9.35025655, 9.35025655, 9.35025655, 9.35025655, 9.35025655, 9.35025655, 9.35025655, 9.35025655,
        9.35025655}},
      {"hs113-kkt",
       24.3062091,
       {2.171996, 2.363683, 8.773926, 5.095984, 0.9906548, 1.430574, 1.321644, 9.828726, 8.280092, 8.375927}},
      {"hs118-kkt", 664.82045, {8, 49, 3, 1, 56, 0, 1, 63, 6, 3, 70, 12, 5, 77, 18}},
  };
  return all;
}

TEST(Kkt, MinimaAreThePrintedOnes) {
  for (const Printed& book : printed()) {
    const Problem problem = find(book.name)->make();
    ASSERT_TRUE(problem.objective) << book.name;
    const Vec& x = problem.solutions.at(0).x;
    EXPECT_NEAR(problem.objective(x), book.value, 2e-6 * std::max(1.0, std::abs(book.value))) << book.name;
    for (std::size_t i = 0; i < book.x.size(); ++i)
      EXPECT_NEAR(x[static_cast<Index>(i)], book.x[i], 1e-5 * std::max(1.0, std::abs(book.x[i])))
          << book.name << ' ' << i;
  }
}

// The book's point of problem 112, of value -47.707579, is no minimum. That of Liang et al. 2006, CEC problem g14, is
// one up to the 1e-4 by which it may violate the equations; the program is convex.
TEST(Kkt, Problem112AsRevised) {
  const Problem problem = find("hs112-kkt")->make();
  const Vec& x = problem.solutions.at(0).x;
  EXPECT_NEAR(problem.objective(x), -47.76109085936586, 1e-9);
  const double g14[] = {0.0406684113216282, 0.147721240492452,    0.783205732104114,  0.00141433931889084,
                        0.485293636780388,  0.000693183051556082, 0.0274052040687766, 0.0179509660214818,
                        0.0373268186859717, 0.0968844604336845};
  for (Index i = 0; i < 10; ++i) EXPECT_NEAR(x[i], g14[i], 1e-4);
}

// Every KKT system has its objective, and F's first rows are its gradient where the multipliers are 0. Catches: a sign.
TEST(Kkt, GradientIsThatOfTheObjective) {
  for (const Entry& entry : kkt_entries) {
    const Problem problem = entry.make();
    Vec z = problem.starts[0];
    Vec F(z.size());
    for (double& number : z) number += 0.01 * (1 + std::abs(number));
    Index n = 0;
    while (n < z.size() && problem.mcp->variable_name(n).starts_with("x")) ++n;
    z.tail(z.size() - n).setZero();
    ASSERT_TRUE(problem.mcp->eval(z, F)) << entry.name;
    for (Index i = 0; i < n; ++i) {
      Vec up = z, down = z;
      const double h = 1e-5 * std::max(0.1, std::abs(z[i]));
      up[i] += h;
      down[i] -= h;
      const double slope = (problem.objective(up) - problem.objective(down)) / (up[i] - down[i]);
      const double scale = std::abs(problem.objective(z)) * 1e-11 / h;
      EXPECT_NEAR(F[i], slope, 1e-5 * (1 + std::abs(slope)) + scale) << entry.name << ' ' << i;
    }
  }
}

// A quadratic program's KKT system says that it is affine, and is. Catches: a term of degree 3 behind that promise.
TEST(Kkt, QuadraticProgramsAreAffine) {
  for (const char* name : {"hs3-kkt", "hs44-kkt", "hs53-kkt", "hs118-kkt"}) {
    const Problem problem = find(name)->make();
    EXPECT_TRUE(problem.mcp->is_affine()) << name;
    const Index n = problem.mcp->size();
    Vec at0(n), at1(n), at2(n);
    problem.mcp->eval(Vec::Zero(n), at0);
    problem.mcp->eval(Vec::Ones(n), at1);
    problem.mcp->eval(2 * Vec::Ones(n), at2);
    EXPECT_LT((at2 - 2 * at1 + at0).lpNorm<Eigen::Infinity>(), 1e-12) << name;
  }
  EXPECT_FALSE(find("hs43-kkt")->make().mcp->is_affine());
}

// hs30's multiplier may be anything in [0, 1]. Catches: the continuum that the entry is there for.
TEST(Kkt, AContinuumOfMultipliers) {
  const Problem problem = find("hs30-kkt")->make();
  for (const double lambda : {0.0, 0.25, 0.9, 1.0})
    EXPECT_EQ(residual(*problem.mcp, Vec({{1, 0, 0, lambda}})).natural, 0);
  EXPECT_GT(residual(*problem.mcp, Vec({{1, 0, 0, 1.01}})).natural, 0.01);
}

}  // namespace
}  // namespace perp::ncp::collection
