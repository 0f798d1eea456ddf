// SPDX-License-Identifier: Apache-2.0
/// Parts of a model that are no complementarity conditions: every output says what becomes of them.
#include "ncp/settings/model_notes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/commands/ampl_driver.hpp"
#include "app/commands/solve.hpp"
#include "app/json.hpp"
#include "app/support.hpp"

namespace perp::app {
namespace {

using testing::HasSubstr;

/// Text, JSON and .sol file of a model.
void expect_note(const std::string& nl, const std::string& note) {
  const test::Folder folder;
  test::write(folder / "m.nl", nl);
  test::Captured captured;
  solve({.problem = folder / "m.nl", .json = folder / "out.json"}, captured.streams);
  const std::string out = captured.out.str();
  ASSERT_THAT(out, HasSubstr("Note: " + note));
  EXPECT_LT(out.find("Note: "), out.find("variable  ")) << "before the table: " << out;
  const test::Json notes = test::parse_json(test::read(folder / "out.json"))["notes"];
  ASSERT_FALSE(notes.empty());
  EXPECT_THAT(notes.back().get<std::string>(), HasSubstr(note));
  test::Captured ampl;
  ampl_driver({.arguments = {folder / "m", "-AMPL"}}, ampl.streams);
  std::string sol = test::read(folder / "m.sol");
  for (char& c : sol)
    if (c == '\n') c = ' ';  // the message may be broken into lines
  EXPECT_THAT(sol, HasSubstr("Note: " + note.substr(0, 20)));
}

// sqrt(2) minimises nothing. Catches a solution that passes for an optimum.
TEST(ModelNotes, AnObjectiveIsNotUsed) {
  std::string nl = test::sqrt2_nl();
  nl.replace(nl.find("\n 1 1 0"), 7, "\n 1 1 1");
  nl.insert(nl.find("x1\n"), "O0 0\nn5\n");
  expect_note(nl, "the objective is not used");
}

// Three conditions of the form 0 <= x_i _|_ x_i - 1 >= 0, of which the last one has lost its variable: an equation, and
// x_3 >= 0 a side inequality. Catches a slip that passes for a model.
TEST(ModelNotes, AVariableWithBoundsThatNoRowComplements) {
  expect_note(test::nl_header(3, 3, 1, 2, 3) +
                  "C0\nv0\nC1\nv1\nC2\nv2\nr\n5 1 1\n5 1 2\n4 1\nb\n2 0\n2 0\n2 0\nk2\n1\n2\nJ0 1\n0 0\nJ1 1\n1 0\n"
                  "J2 1\n2 0\n",
              "no row complements _svar[3], which has bounds: they are side inequalities");
}

// 0 <= q _|_ p - q - 1 >= 0 and 0 <= w _|_ q + p - 10 >= 0 with w = q, as Pyomo writes a second condition on q; p >= 0
// has none. Catches a slip that ends in some solution of many.
TEST(ModelNotes, AConditionTwice) {
  expect_note(test::nl_header(3, 3, 1, 2, 6) +
                  "C0\nn-1\nC1\nn-10\nC2\nn0\nr\n5 1 1\n5 1 3\n4 0\nb\n2 0\n2 0\n2 0\nk2\n3\n5\nJ0 2\n0 -1\n1 1\n"
                  "J1 2\n0 1\n1 1\nJ2 2\n0 -1\n2 1\n",
              "_svar[1] is in two conditions, _scon[1] and _scon[2]; no row complements _svar[2], which has bounds");
}

// x^2 = 2, and the side inequality x^2 <= 1 wants 1 less. Catches "no progress" that does not say why.
TEST(ModelNotes, SideInequalitiesThatHoldTheSolutionOut) {
  std::string nl = test::side_inequality_nl();
  nl.replace(nl.find("\n1 10\n"), 6, "\n1 1\n");
  expect_note(nl, "without its side inequalities the model has a solution, which violates side[_scon[2]] (by 1)");
}

// exp(x) + 0.1 = 0 is refuted by its range, 0 x = 1 by its row. Catches a proof of which nobody says whether it can be
// checked.
TEST(ModelNotes, ProofsSayHowTheyCanBeChecked) {
  const test::Folder folder;
  const auto solved = [&](const std::string& nl, const std::string& by, const std::string& words) {
    test::write(folder / "m.nl", nl);
    test::Captured captured;
    solve({.problem = folder / "m.nl", .json = folder / "out.json"}, captured.streams);
    EXPECT_THAT(captured.out.str(), HasSubstr(words));
    const test::Json json = test::parse_json(test::read(folder / "out.json"));
    EXPECT_EQ(json["status"], "Infeasible");
    EXPECT_EQ(json["proven_by"], by);
    EXPECT_EQ(json["certificate"].is_null(), by == "ranges");
    test::Captured ampl;
    ampl_driver({.arguments = {folder / "m", "-AMPL"}}, ampl.streams);
    EXPECT_EQ(ampl.out.str().find("contradict each other") == std::string::npos, by == "ranges") << ampl.out.str();
  };
  solved(test::scalar_nl("o0\no44\nv0\nn0.1\n", 0, "3"), "ranges", "Proof: by the ranges of F");
  solved(
      test::nl_header(2, 2, 2, 0, 4) + "C0\nn0\nC1\nn0\nr\n4 1\n4 3\nb\n3\n3\nk1\n2\nJ0 2\n0 1\n1 1\nJ1 2\n0 2\n1 2\n",
      "certificate", "contradict each other; --json writes the certificate");
}

}  // namespace
}  // namespace perp::app
