// SPDX-License-Identifier: Apache-2.0
// Which row gives which variable's F (Ferris, Fourer & Gay 1999, section 4; the AMPL/PATH driver's conventions), with
// values worked out by hand. Would catch a wrong partner, sign, right-hand side, bound or constant.
#include <sstream>

#include "nl_text.hpp"

namespace perp::ncp::ampl {
namespace {

using testing::ElementsAre;

std::vector<std::string> variable_names(const Model& m) {
  std::vector<std::string> names;
  for (Index i = 0; i < m.size(); ++i) names.push_back(m.variable_name(i));
  return names;
}

std::vector<std::string> equation_names(const Model& m) {
  std::vector<std::string> names;
  for (Index i = 0; i < m.size(); ++i) names.push_back(m.equation_name(i));
  return names;
}

// Rows that complement variables in another order; box = the variables' bounds. The constants 5 and -7 stay in F.
TEST(Pairing, ComplementarityRows) {
  const auto m = read_text(text({.vars = 2, .cons = 2, .cc = 2, .nonzeros = 3}) +
                           "C0\nn5\nC1\no0\nn-7\no5\nv1\nn2\nx1\n1 2\nr\n5 1 2\n5 3 1\nb\n0 -1 4\n2 0.5\nk1\n1\n"
                           "J0 2\n0 3\n1 4\nJ1 1\n1 0\n");
  ASSERT_EQ(m->size(), 2);
  EXPECT_EQ(m->n_var(), 2);
  EXPECT_EQ(m->side_inequalities(), 0);
  EXPECT_EQ(m->box().lower, (Vec{{-1, 0.5}}));
  EXPECT_EQ(m->box().upper, (Vec{{4, infinity}}));
  EXPECT_EQ(m->start(), (Vec{{0, 2}}));
  EXPECT_EQ(values(*m, Vec{{10, 3}}), (Vec{{9 - 7, 30 + 12 + 5}}));
  EXPECT_EQ(jacobian(*m, Vec{{10, 3}}), (Eigen::MatrixXd{{0, 6}, {3, 4}}));
  EXPECT_THAT(equation_names(*m), ElementsAre("_scon[2]", "_scon[1]"));
}

// Equations take the variables no row complements, in order; those become free and F is row - right-hand side.
TEST(Pairing, EquationsTakeWhatIsLeft) {
  const auto m = read_text(text({.vars = 3, .cons = 3, .eqns = 2, .cc = 1, .nonzeros = 4}) +
                           "C0\nn0\nC1\nn0\nC2\nn0\nr\n4 10\n5 2 2\n0 -3 -3\nb\n3\n1 6\n3\nk2\n2\n3\n"
                           "J0 2\n0 2\n2 1\nJ1 1\n1 1\nJ2 1\n0 5\n");
  ASSERT_EQ(m->size(), 3);
  EXPECT_EQ(m->box().lower, (Vec{{-infinity, -infinity, -infinity}}));
  EXPECT_EQ(m->box().upper, (Vec{{infinity, 6, infinity}}));
  EXPECT_EQ(values(*m, Vec{{1, 2, 3}}), (Vec{{2 + 3 - 10, 2, 5 + 3}}));
  EXPECT_EQ(jacobian(*m, Vec::Zero(3)), (Eigen::MatrixXd{{2, 0, 1}, {0, 1, 0}, {5, 0, 0}}));
}

// Kind 0: the row is an equation, its variable free.
TEST(Pairing, KindZeroIsAnEquationOfAFreeVariable) {
  const auto m = read_text(text({.cc = 1}) + "C0\nn-2\nr\n5 0 1\nb\n3\nk0\nJ0 1\n0 4\n");
  EXPECT_EQ(m->box().lower[0], -infinity);
  EXPECT_EQ(m->box().upper[0], infinity);
  EXPECT_EQ(values(*m, Vec{{3}}), (Vec{{10}}));
}

// A kind may name a bound that is infinite: it is never active, so the condition is the same one.
TEST(Pairing, KindMayNameAnInfiniteBound) {
  const auto m = read_text(text({.cc = 1}) + "C0\nn-2\nr\n5 3 1\nb\n2 1\nk0\nJ0 1\n0 4\n");
  EXPECT_EQ(m->box().lower[0], 1);
  EXPECT_EQ(m->box().upper[0], infinity);
}

// Inequality rows and bounds on variables of equations: F_y = c - b - y or b - c - y, y >= 0, two for a range.
TEST(Pairing, SideInequalities) {
  const auto m = read_text(text({.vars = 2, .cons = 6, .eqns = 2, .nonzeros = 10}) +
                           "C0\nn0\nC1\no5\nv0\nn2\nC2\nn0\nC3\nn1\nC4\nn0\nC5\nn0\n"
                           "x2\n0 1\n1 2\nr\n4 1\n2 -1\n1 8\n0 -2 5\n3\n4 2\nb\n0 -4 9\n1 7\nk1\n5\n"
                           "J0 2\n0 1\n1 1\nJ1 1\n0 0\nJ2 2\n0 1\n1 3\nJ3 1\n1 2\nJ4 2\n0 7\n1 7\nJ5 2\n0 1\n1 -1\n");
  ASSERT_EQ(m->size(), 2 + 4 + 3);
  EXPECT_EQ(m->side_inequalities(), 7);
  EXPECT_THAT(variable_names(*m), ElementsAre("_svar[1]", "_svar[2]", "side[_scon[2]]", "side[_scon[3]]",
                                              "side_lower[_scon[4]]", "side_upper[_scon[4]]", "side_lower[_svar[1]]",
                                              "side_upper[_svar[1]]", "side_upper[_svar[2]]"));
  EXPECT_THAT(equation_names(*m), ElementsAre("_scon[1]", "_scon[6]", "side[_scon[2]]", "side[_scon[3]]",
                                              "side_lower[_scon[4]]", "side_upper[_scon[4]]", "side_lower[_svar[1]]",
                                              "side_upper[_svar[1]]", "side_upper[_svar[2]]"));
  Vec lower = Vec::Zero(9);
  lower.head(2).setConstant(-infinity);
  EXPECT_EQ(m->box().lower, lower);
  EXPECT_EQ(m->box().upper, Vec::Constant(9, infinity));
  Vec start = Vec::Zero(9);
  start.head(2) << 1, 2;
  EXPECT_EQ(m->start(), start);

  Vec x(9);
  x << 3, 4, 0.5, 1, 2, 3, 0.25, 0.75, 6;
  const Vec expected{
      {3 + 4 - 1, 3 - 4 - 2, 9 + 1 - 0.5, 8 - 15 - 1, 8 + 1 + 2 - 2, 5 - 9 - 3, 3 + 4 - 0.25, 9 - 3 - 0.75, 7 - 4 - 6}};
  EXPECT_EQ(values(*m, x), expected);
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(9, 9);
  J.topLeftCorner(9, 2) << 1, 1, 1, -1, 6, 0, -1, -3, 0, 2, 0, -2, 1, 0, -1, 0, 0, -1;
  J.bottomRightCorner(7, 7) = -Eigen::MatrixXd::Identity(7, 7);
  EXPECT_EQ(jacobian(*m, x), J);
  EXPECT_EQ(describe(*m, check_jacobian(*m, x)), "");
  // No column of the pattern is empty: that is what the y in its own equation is for.
  for (Index j = 0; j < 9; ++j)
    EXPECT_GT(m->jacobian_pattern().outerIndexPtr()[j + 1], m->jacobian_pattern().outerIndexPtr()[j]);
}

// A fixed variable of an equation: both its bounds are side inequalities.
TEST(Pairing, FixedVariables) {
  const auto m = read_text(text({.vars = 2, .cons = 2, .eqns = 1, .cc = 1, .nonzeros = 2}) +
                           "C0\nn0\nC1\nn0\nr\n4 1\n5 3 2\nb\n4 2\n4 5\nk1\n1\nJ0 1\n0 1\nJ1 1\n1 1\n");
  ASSERT_EQ(m->size(), 4);
  EXPECT_EQ(m->box().lower, (Vec{{-infinity, 5, 0, 0}}));
  EXPECT_EQ(m->box().upper, (Vec{{infinity, 5, infinity, infinity}}));
  EXPECT_EQ(values(*m, Vec{{2.5, 5, 0.125, 0.25}}), (Vec{{1.5, 5, 0.5 - 0.125, -0.5 - 0.25}}));
}

// Names come from .col and .row; where those are short, AMPL's defaults follow. CR LF ends are cut.
TEST(Pairing, Names) {
  const TempFolder folder;
  const std::string path = folder.write(
      "m.nl", text({.vars = 2, .cons = 3, .eqns = 2, .nonzeros = 3}) +
                  "C0\nn0\nC1\nn0\nC2\nn0\nr\n4 1\n2 0\n4 1\nb\n2 0\n3\nk1\n2\nJ0 1\n0 1\nJ1 1\n0 1\nJ2 1\n1 1\n");
  folder.write("m.col", "Price['wheat']\r\n");
  folder.write("m.row", "balance\nlimit[1]\n");
  for (const std::string& given : {path, path.substr(0, path.size() - 3)}) {
    const auto m = read_model(given);
    EXPECT_EQ(m->name(), "m");
    EXPECT_THAT(variable_names(*m),
                ElementsAre("Price['wheat']", "_svar[2]", "side[limit[1]]", "side_lower[Price['wheat']]"));
    EXPECT_THAT(equation_names(*m), ElementsAre("balance", "_scon[3]", "side[limit[1]]", "side_lower[Price['wheat']]"));
  }
}

// The header's own number of equations is not trusted: Pyomo counts complementarity rows of kind 0 there.
TEST(Pairing, CountsEquationsItself) {
  EXPECT_EQ(read_text(text({.eqns = 1, .cc = 1}) + "C0\nn-2\nr\n5 0 1\nb\n3\nk0\nJ0 1\n0 4\n")->size(), 1);
}

/// As Pyomo writes  0 <= F(x, y)  _|_  x >= 0  and  y = 1 - x:  v is free and in two rows, `condition` v + 5 of them.
std::string with_auxiliary(const char* condition = "1", const char* definition = "1", const char* bounds_of_v = "3") {
  return text({.vars = 3, .cons = 3, .eqns = 2, .cc = 1, .nonzeros = 6}) +
         "C0\nn5\nC1\no5\nv1\nn2\nC2\nn0\nx3\n0 9\n1 4\n2 6\nr\n5 1 2\n4 -3\n4 1\nb\n" + bounds_of_v +
         "\n2 0\n3\nk2\n2\n4\nJ0 1\n0 " + condition + "\nJ1 3\n0 " + definition + "\n1 -2\n2 7\nJ2 2\n1 1\n2 1\n";
}

// v = -3 - x^2 + 2 x - 7 y is no unknown: F_x = v + 5. Both rows belong to one condition, and are called so.
TEST(Pairing, AuxiliaryVariablesOfConditionsAreNoUnknowns) {
  for (const bool minus : {false, true}) {
    const TempFolder folder;
    folder.write("m.col", "c.bv\nx\ny\n");
    folder.write("m.row", "c[1].c\nc[1].bc\nbalance\n");
    const auto m = read_model(folder.write("m.nl", with_auxiliary("1", minus ? "-1" : "1")));
    ASSERT_EQ(m->size(), 2);
    EXPECT_EQ(m->n_var(), 2);
    EXPECT_THAT(variable_names(*m), ElementsAre("x", "y"));
    EXPECT_THAT(equation_names(*m), ElementsAre("c[1]", "balance"));
    EXPECT_EQ(m->box().lower, (Vec{{0, -infinity}}));
    EXPECT_EQ(m->start(), (Vec{{4, 6}}));
    const double sign = minus ? -1 : 1;  // x = 2, y = 3: v = sign (-3 - 4 + 4 - 21)
    EXPECT_EQ(values(*m, Vec{{2, 3}}), (Vec{{sign * -24 + 5, 4}}));
    EXPECT_EQ(jacobian(*m, Vec{{2, 3}}), (Eigen::MatrixXd{{sign * -2, sign * -7}, {1, 1}}));
    EXPECT_EQ(m->linear_entries(), (std::vector<bool>{false, true, true, true}));
    // The file that answers has v, too: 0, 0, 0 after the sizes stand for no duals.
    m->write_sol("m", Vec{{2, 3}}, 0);
    const std::string sol = read_bytes(folder.path() + "/m.sol");
    EXPECT_NE(sol.find((minus ? "\n24\n2\n3\n" : "\n-24\n2\n3\n")), std::string::npos) << sol;
    EXPECT_THROW(m->write_sol("m", Vec{{1, 2, 3}}, 0), ModelError);
  }
}

// A bound on v, a coefficient that would round, or another row with v: then v is an unknown like any other.
TEST(Pairing, OtherVariablesStay) {
  EXPECT_EQ(read_text(with_auxiliary("3"))->n_var(), 3);
  EXPECT_EQ(read_text(with_auxiliary("1", "1", "2 0"))->n_var(), 3);
  EXPECT_EQ(read_text(text({.vars = 2, .cons = 2, .eqns = 1, .cc = 1, .nonzeros = 3}) +
                      "C0\nn0\nC1\no43\nv0\nr\n5 1 2\n4 0\nb\n3\n2 0\nk1\n2\nJ0 1\n0 1\nJ1 2\n0 0\n1 1\n")
                ->n_var(),
            2);
}

// Two auxiliary variables in one equation: only one can be computed from it.
/// What Pyomo 6.10 writes of  0 <= a x - b _|_ x + y - 3 >= 0  and  0 <= y _|_ 2 y - x + 5 >= 0: variables c1.bv, x,
/// c1.v, y, c2.bv.
std::string of_two_expressions(double a, double b) {
  std::ostringstream nl;
  nl << text({.vars = 5, .cons = 5, .eqns = 3, .cc = 2, .nonzeros = 10})
     << "C0\nn0\nC1\nn0\nC2\nn0\nC3\nn0\nC4\nn0\nx1\n1 4\nr\n5 1 3\n4 " << -b
     << "\n4 -3\n5 1 4\n4 5\nb\n3\n3\n2 0\n2 0\n3\nk4\n2\n5\n6\n8\nJ0 1\n0 1\nJ1 2\n0 1\n1 " << -a
     << "\nJ2 3\n1 -1\n2 1\n3 -1\nJ3 1\n4 1\nJ4 3\n1 1\n3 -2\n4 1\n";
  return nl.str();
}

// x - 1, 2x - 1 and 1 - x are bounds of x; 3x - 1 would be rounded, and stays an equation. Catches a box or a sign that
// is that of another side, and auxiliary values that answer nothing.
TEST(Pairing, AConditionOfTwoExpressionsIsOneOfItsVariable) {
  struct Side {
    double a, b, lower, upper, sign;
  };
  for (const Side& c : {Side{1, 1, 1, infinity, 1}, Side{2, 1, 0.5, infinity, 1}, Side{-1, -1, -infinity, 1, -1}}) {
    const TempFolder folder;
    folder.write("m.col", "c1.bv\nx\nc1.v\ny\nc2.bv\n");
    folder.write("m.row", "c1.c\nc1.bc\nc1.e\nc2.c\nc2.bc\n");
    const auto m = read_model(folder.write("m.nl", of_two_expressions(c.a, c.b)));
    ASSERT_EQ(m->size(), 2) << c.a;
    EXPECT_THAT(variable_names(*m), ElementsAre("x", "y"));
    EXPECT_THAT(equation_names(*m), ElementsAre("c1", "c2"));
    EXPECT_EQ(m->box().lower, (Vec{{c.lower, 0}}));
    EXPECT_EQ(m->box().upper, (Vec{{c.upper, infinity}}));
    EXPECT_EQ(values(*m, Vec{{7, 3}}), (Vec{{c.sign * 7, 4}}));
    EXPECT_EQ(jacobian(*m, Vec{{7, 3}}), (Eigen::MatrixXd{{c.sign, c.sign}, {-1, 2}}));
    m->write_sol("m", Vec{{7, 3}}, 0);
    std::ostringstream all;
    all << '\n' << c.a * 7 - c.b << "\n7\n7\n3\n4\n";  // v = F, whatever the side
    EXPECT_THAT(read_bytes(folder.path() + "/m.sol"), testing::HasSubstr(all.str()));
  }
  EXPECT_EQ(read_text(of_two_expressions(3, 1))->size(), 3);
}

TEST(Pairing, AnEquationDefinesOneAuxiliaryVariable) {
  const auto m = read_text(text({.vars = 4, .cons = 4, .eqns = 2, .cc = 2, .nonzeros = 6}) +
                           "C0\nn0\nC1\nn0\nC2\nn0\nC3\nn0\nr\n5 1 3\n5 1 4\n4 1\n4 2\nb\n3\n3\n2 0\n2 0\nk3\n2\n4\n5\n"
                           "J0 1\n0 1\nJ1 1\n1 1\nJ2 2\n0 1\n1 -1\nJ3 2\n2 1\n3 1\n");
  EXPECT_EQ(m->n_var(), 3);
  EXPECT_EQ(values(*m, Vec{{5, 2, 3}}), (Vec{{2 + 3 - 2, 1 + 5, 5}}));
}

TEST(Pairing, ObjectivesAreIgnored) {
  EXPECT_TRUE(read_text(rich_models()[0])->has_objective());
  EXPECT_FALSE(read_text(rich_models()[1])->has_objective());
}

}  // namespace
}  // namespace perp::ncp::ampl
