// SPDX-License-Identifier: Apache-2.0
// What is no complementarity problem is refused with AMPL's codes and a message a person can act on.
#include <sys/stat.h>

#include <algorithm>
#include <climits>

#include "ncp/strategy/solve.hpp"
#include "nl_text.hpp"

namespace perp::ncp::ampl {
namespace {

const std::string two_rows = "C0\nn0\nC1\nn0\nr\n4 1\n4 2\nb\n3\n3\n3\nk2\n2\n3\nJ0 2\n0 1\n1 1\nJ1 2\n0 1\n2 1\n";

TEST(Refusals, NotSquare) {
  expect_refused(text({.vars = 3, .cons = 2, .eqns = 2, .nonzeros = 4}) + two_rows, nonsquare,
                 {"not square", "2 equations and 0 complementarity conditions for 3 variables", "_svar[3]"});
  expect_refused(
      text({.cons = 2, .eqns = 2, .nonzeros = 2}) + "C0\nn0\nC1\nn0\nr\n4 1\n4 2\nb\n3\nk0\nJ0 1\n0 1\nJ1 1\n0 1\n",
      nonsquare, {"2 equations", "1 variable;", "row _scon[2] repeats row _scon[1]"});
  EXPECT_EQ(nonsquare, 504);
}

TEST(Refusals, NotSquareListsFiveNames) {
  std::string s = text({.vars = 9, .cons = 1, .eqns = 1}) + "C0\nn0\nr\n4 1\nb\n";
  for (int i = 0; i < 9; ++i) s += "3\n";
  s += "k8\n";
  for (int i = 0; i < 8; ++i) s += "1\n";
  expect_refused(s + "J0 1\n0 1\n", nonsquare, {"_svar[2], _svar[3], _svar[4], _svar[5], _svar[6] and 3 more"});
}

// min x + y over 0 <= x _|_ x + y - 1 >= 0, y in [0, 1]: y is the objective's to choose. Catches a refusal in words of
// kinds and bounds.
TEST(Refusals, AnObjectiveThatHasVariablesToChoose) {
  expect_refused(text({.vars = 2, .cons = 1, .objs = 1, .cc = 1, .nonzeros = 2, .gradient = 2}) +
                     "C0\nn0\nO0 0\nn0\nr\n5 1 1\nb\n0 0 1\n0 0 1\nk1\n1\nJ0 2\n0 1\n1 1\nG0 2\n0 1\n1 1\n",
                 nonsquare, {"MPEC", "1 complementarity condition and 0 equations leave 1 variable to the objective"});
}

// min x + y over x + y = 1 has no condition at all. Catches a refusal that counts rows.
TEST(Refusals, AnObjectiveWithoutConditions) {
  expect_refused(text({.vars = 2, .cons = 1, .objs = 1, .eqns = 1, .nonzeros = 2, .gradient = 2}) +
                     "C0\nn0\nO0 0\nn0\nr\n4 1\nb\n3\n3\nk1\n1\nJ0 2\n0 1\n1 1\nG0 2\n0 1\n1 1\n",
                 nonsquare,
                 {"an optimisation problem: it has no complementarity condition", "1 equation leaves 1 variable"});
}

// 0 <= x _|_ x - f - 1 >= 0 and 0 <= y _|_ y + f - 1 >= 0 as Pyomo writes them, with c1.bv and c2.bv; f >= 0 has no
// condition. Catches counts and names of what the writer has added.
TEST(Refusals, NotSquareSpeaksOfTheModelersRows) {
  const TempFolder folder;
  folder.write("m.col", "c1.bv\nx\nf\nc2.bv\ny\n");
  folder.write("m.row", "c1.c\nc1.bc\nc2.c\nc2.bc\n");
  const std::string nl = folder.write(
      "m.nl",
      text({.vars = 5, .cons = 4, .eqns = 2, .cc = 2, .nonzeros = 8}) +
          "C0\nn0\nC1\nn0\nC2\nn0\nC3\nn0\nr\n5 1 2\n4 -1\n5 1 5\n4 -1\nb\n3\n2 0\n2 0\n3\n2 0\nk4\n2\n3\n5\n7\n"
          "J0 1\n0 1\nJ1 3\n0 1\n1 -1\n2 1\nJ2 1\n3 1\nJ3 3\n2 -1\n3 1\n4 -1\n");
  try {
    read_model(nl);
    ADD_FAILURE() << "not refused";
  } catch (const ModelError& error) {
    EXPECT_THAT(error.what(),
                testing::AllOf(testing::HasSubstr("0 equations and 2 complementarity conditions for 3 variables"),
                               testing::HasSubstr("no row complements f, which has bounds"),
                               testing::Not(testing::HasSubstr(".bv")), testing::Not(testing::HasSubstr(".bc"))));
  }
}

// x = 1, 2x = 1, y = 3 in every order of the rows, and without an equation for one of two variables: the rows in x
// alone are named, and the variable that is in no row. Catches blame for whatever comes last in the file.
TEST(Refusals, NotSquareNamesThePartThatIsToBlame) {
  std::vector<int> order{0, 1, 2};
  do {
    std::string s = text({.vars = 2, .cons = 3, .eqns = 3, .nonzeros = 3}) + "C0\nn0\nC1\nn0\nC2\nn0\nr\n";
    std::string j;
    std::vector<std::string> names(3);
    for (int i = 0; i < 3; ++i) {
      const int row = order[static_cast<std::size_t>(i)];
      s += row == 2 ? "4 3\n" : "4 1\n";
      j += "J" + std::to_string(i) + " 1\n" + (row == 0 ? "0 1\n" : row == 1 ? "0 2\n" : "1 1\n");
      names[static_cast<std::size_t>(row)] = "_scon[" + std::to_string(i + 1) + "]";
    }
    const auto [first, second] = std::minmax(names[0], names[1]);
    expect_refused(s + "b\n3\n3\nk1\n2\n" + j, nonsquare,
                   {"too many equations: 2 rows (" + first + " and " + second + ") for 1 variable (_svar[1])",
                    "row " + second + " repeats row " + first, ", but for constants"});
  } while (std::ranges::next_permutation(order).found);
  expect_refused(text({.vars = 2, .cons = 1, .eqns = 1}) + "C0\nn0\nr\n4 2\nb\n3\n3\nk1\n0\nJ0 1\n1 1\n", nonsquare,
                 {"variable _svar[1] is in no row"});
}

// Optimality conditions of min z over z = x^2 + y^2 (e1), x + y >= 1 (e2), x - y >= -1 (e3), x >= y - 5 (e4), without
// row e1: that variable z is in no row is told, and that lambda_e1 is the one without its row. Catches names that are
// not read.
TEST(Refusals, NotSquareNamesTheVariableWithoutItsRow) {
  const TempFolder folder;
  folder.write("m.row", "d_x\nd_y\nd_z\ne2\ne3\ne4\n");
  folder.write("m.col", "x\ny\nz\nlambda_e1\nlambda_e2\nlambda_e3\nlambda_e4\n");
  const std::string nl = folder.write(
      "m.nl",
      text({.vars = 7, .cons = 6, .eqns = 3, .cc = 3, .nonzeros = 17}) +
          "C0\no2\nv0\nv3\nC1\no2\nv1\nv3\nC2\nn0\nC3\nn0\nC4\nn0\nC5\nn0\nr\n4 0\n4 0\n4 1\n5 1 5\n5 1 6\n5 1 "
          "7\nb\n3\n3\n3\n3\n2 0\n2 0\n2 0\nk6\n4\n8\n8\n11\n13\n15\nJ0 5\n0 0\n3 0\n4 -1\n5 -1\n6 -1\nJ1 5\n1 0\n3 "
          "0\n4 -1\n5 1\n6 1\nJ2 1\n3 1\nJ3 2\n0 1\n1 1\nJ4 2\n0 1\n1 -1\nJ5 2\n0 1\n1 -1\n");
  try {
    read_model(nl);
    ADD_FAILURE() << "not refused";
  } catch (const ModelError& error) {
    EXPECT_EQ(error.code(), nonsquare);
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("variable z is in no row"),
                                             testing::HasSubstr("as lambda_e2 has e2, and lambda_e1 has none")));
  }
}

// The square model x = 1, 2x = 1 in x and y: what is wrong with it is told with whatever the solve says.
TEST(Refusals, SquareButSingularIsTold) {
  const auto model = read_text(text({.vars = 2, .cons = 2, .eqns = 2, .nonzeros = 2}) +
                               "C0\nn0\nC1\nn0\nr\n4 1\n4 1\nb\n3\n3\nk1\n2\nJ0 1\n0 1\nJ1 1\n0 2\n");
  const Result result = solve(*model, model->start(), automatic());
  EXPECT_FALSE(result.accepted());
  EXPECT_THAT(result.message,
              testing::AllOf(testing::HasSubstr("2 rows (_scon[1] and _scon[2]) for 1 variable (_svar[1])"),
                             testing::HasSubstr("variable _svar[2] is in no row")));
}

TEST(Refusals, InconsistentBounds) {
  expect_refused(text({.cc = 1}) + "C0\nn0\nr\n5 3 1\nb\n0 2 1.5\nk0\nJ0 1\n0 1\n", 200,
                 {"model.nl:16: ", "variable _svar[1]", "lower 2 > upper 1.5"});
  expect_refused(text({.cons = 2, .cc = 1, .nonzeros = 2}) +
                     "C0\nn0\nC1\nn0\nr\n5 1 1\n0 1 -1\nb\n2 0\nk0\nJ0 1\n0 1\nJ1 1\n0 1\n",
                 200, {"model.nl:17: ", "constraint _scon[2]", "lower 1 > upper -1"});
}

TEST(Refusals, InconsistentBoundsUseNames) {
  const TempFolder folder;
  const std::string path = folder.write("m.nl", text({.cc = 1}) + "C0\nn0\nr\n5 3 1\nb\n0 2 1\nk0\nJ0 1\n0 1\n");
  folder.write("m.col", "price\n");
  try {
    read_model(path);
    FAIL();
  } catch (const ModelError& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("variable price"));
  }
}

// The row says that only a lower bound counts; the box would let F < 0 at the upper one.
TEST(Refusals, KindThatContradictsTheBounds) {
  for (const char* r : {"5 0 1", "5 1 1", "5 2 1"}) {
    expect_refused(text({.cc = 1}) + "C0\nn0\nr\n" + r + "\nb\n0 0 5\nk0\nJ0 1\n0 1\n", bad_file,
                   {"model.nl:14: ", "_scon[1] complements variable _svar[1]", std::string("kind ") + r[2], "[0, 5]",
                    "their kind is 3"});
  }
}

TEST(Refusals, IntegerVariables) {
  const std::string body = "C0\nn0\nC1\nn0\nr\n5 1 1\n5 1 2\nb\n2 0\n2 0\nk1\n1\nJ0 1\n0 1\nJ1 1\n1 1\n";
  const Header h{.vars = 2, .cons = 2, .cc = 2, .nonzeros = 2};
  Header linear = h;
  linear.integers = 1;
  expect_refused(text(linear) + body, bad_file, {"1 integer or binary variables", "_svar[2]"});
  Header binary = h;
  binary.discrete = " 2 0 0 0 0";
  expect_refused(text(binary) + body, bad_file, {"2 integer or binary variables", "_svar[1]"});
  Header nonlinear_one = h;
  nonlinear_one.discrete = " 0 0 0 1 0";
  expect_refused(text(nonlinear_one) + body, bad_file, {"1 integer or binary variables", "_svar[2]"});
}

TEST(Refusals, ForeignThings) {
  const std::string body = "C0\nn0\nr\n5 1 1\nb\n2 0\nk0\nJ0 1\n0 1\n";
  expect_refused(text({.cc = 1, .functions = 1}) + "F0 1 -1 gsl_sf_gamma\n" + body, bad_file,
                 {"model.nl:11: ", "imported function gsl_sf_gamma"});
  expect_refused(text({.cc = 1, .functions = 1}) + body, bad_file, {"1 imported functions"});
  expect_refused(text({.cc = 1, .logical = 1}) + body, bad_file, {"1 logical constraints"});
  std::string network = text({.cc = 1}) + body;
  network.replace(network.find("\n 0 0\t# network"), 5, "\n 0 1");
  expect_refused(network, bad_file, {"network"});
  std::string arcs = text({.cc = 1}) + body;
  arcs.replace(arcs.find("\n 0 0 0 1\t# linear network"), 3, "\n 1");
  expect_refused(arcs, bad_file, {"network"});
}

void expect_file_refused(const std::string& path, const std::string& part) {
  try {
    read_model(path);
    ADD_FAILURE() << path;
  } catch (const ModelError& e) {
    EXPECT_EQ(e.code(), bad_file);
    EXPECT_THAT(e.what(), testing::AllOf(testing::HasSubstr(".nl: "), testing::HasSubstr(part)));
  }
}

TEST(Refusals, FilesThatAreNone) {
  const TempFolder folder;
  expect_file_refused(folder.path() + "/absent", "No such file");
  expect_file_refused(folder.write("empty.nl", ""), "is empty");
  ASSERT_EQ(mkdir((folder.path() + "/folder.nl").c_str(), 0755), 0);
  expect_file_refused(folder.path() + "/folder", "is a directory");
  ASSERT_EQ(mkfifo((folder.path() + "/pipe.nl").c_str(), 0644), 0);
  expect_file_refused(folder.path() + "/pipe", "not a regular file");
  expect_file_refused("/dev/null.nl", "No such file");
}

}  // namespace
}  // namespace perp::ncp::ampl
