// SPDX-License-Identifier: Apache-2.0
// Rows with the suffix polyhedron are A of a variational inequality over {b <= A x <= c, l <= x <= u}
// (ncp/ampl/model.hpp; Facchinei & Pang 2003, proposition 1.2.1), judged by the projection. Would catch a multiplier
// with the wrong sign, a polyhedron other than that of the rows, ranges that forget A'lambda, and a verdict by
// multipliers.
#include <random>
#include <sstream>

#include "lcp/vi/vi.hpp"
#include "ncp/interval/enclosure.hpp"
#include "ncp/interval/expression.hpp"
#include "ncp/settings/session.hpp"
#include "ncp/strategy/lists.hpp"
#include "nl_text.hpp"

namespace perp::ncp::ampl {
namespace {

using testing::HasSubstr;

/// F = (x_1^3 - 8, x_1 + x_2) on x >= 0 and x_1 + x_2 >= 3, + 2 in the row: 2 as its constant, 5 as its bound.
const std::string cubic = text({.vars = 2, .cons = 3, .cc = 2, .nonzeros = 5}) +
                          "S1 1 polyhedron\n1 1\nS0 1 polyhedron\n0 1\nC0\no0\no5\nv0\nn3\nn-8\nC1\nn2\nC2\nn0\n"
                          "x2\n0 1\n1 1\nr\n5 3 1\n2 5\n5 3 2\nb\n2 0\n2 0\nk1\n3\n"
                          "J0 1\n0 0\nJ1 2\n0 1\n1 1\nJ2 2\n0 1\n1 1\n";

settings::Outcome solved(const Model& model) {
  return settings::Session{.mcp = model, .x0 = model.start(), .model = &model}.run();
}

// lambda = x_1 + x_2 = 3, x_1^3 = 11.
TEST(Polyhedron, BySuffix) {
  const auto m = read_text(cubic);
  ASSERT_EQ(m->size(), 3);
  EXPECT_EQ(m->n_var(), 2);
  EXPECT_EQ(m->side_inequalities(), 0);
  EXPECT_EQ(m->variable_name(2), "multiplier[_scon[2]]");
  EXPECT_EQ(m->equation_name(2), "_scon[2]");
  ASSERT_NE(m->polyhedron(), nullptr);
  EXPECT_EQ(Eigen::MatrixXd(m->polyhedron()->A), (Eigen::MatrixXd{{1, 1}}));
  EXPECT_EQ(m->polyhedron()->rows.lower[0], 3);
  EXPECT_EQ(values(*m, Vec{{1, 2, 10}}), (Vec{{1 - 8 - 10, 3 - 10, 0}}));
  const settings::Outcome outcome = solved(*m);
  ASSERT_TRUE(outcome.result.solved()) << outcome.result.message;
  ASSERT_TRUE(outcome.vi.has_value());
  EXPECT_EQ(outcome.result.residual.natural, outcome.vi->residual);
  const double x = std::cbrt(11);
  EXPECT_LE((outcome.result.x - Vec{{x, 3 - x, 3}}).lpNorm<Eigen::Infinity>(), 1e-8);
}

// A suffix of 0 is none, and so is one of a variable: x_2 >= 3 - x_1 is a side inequality then.
TEST(Polyhedron, OnlyRowsWithANumber) {
  std::string without = cubic;
  without.replace(without.find("\n1 1\nS0"), 4, "\n1 0");
  const auto m = read_text(without);
  EXPECT_EQ(m->polyhedron(), nullptr);
  EXPECT_EQ(m->side_inequalities(), 1);
}

TEST(Polyhedron, RefusesRowsThatAreNone) {
  expect_refused(
      text({.vars = 2, .cons = 3, .cc = 2, .nonzeros = 5}) +
          "S1 1 polyhedron\n0 1\nC0\no0\no5\nv0\nn3\nn-8\nC1\nn2\nC2\nn0\nr\n5 3 1\n2 5\n5 3 2\nb\n2 0\n2 0\n"
          "k1\n3\nJ0 1\n0 0\nJ1 2\n0 1\n1 1\nJ2 2\n0 1\n1 1\n",
      bad_file, {"_scon[1]", "not linear", "polyhedron"});
  expect_refused(
      text({.vars = 2, .cons = 3, .cc = 2, .nonzeros = 5}) +
          "S1 1 polyhedron\n2 1\nC0\no0\no5\nv0\nn3\nn-8\nC1\nn2\nC2\nn0\nr\n5 3 1\n2 5\n5 3 2\nb\n2 0\n2 0\n"
          "k1\n3\nJ0 1\n0 0\nJ1 2\n0 1\n1 1\nJ2 2\n0 1\n1 1\n",
      bad_file, {"_scon[3]", "complements a variable", "polyhedron"});
}

/// One variable x >= 0, F complements it, and a row x >= bound, or a constant more.
std::string line(const std::string& F, const std::string& coefficient, const std::string& bound,
                 const std::string& constant = "n0\n") {
  return text({.cons = 2, .cc = 1, .nonzeros = 2}) + "S1 1 polyhedron\n1 1\nC0\n" + F + "C1\n" + constant +
         "x1\n0 1\nr\n5 1 1\n2 " + bound + "\nb\n2 0\nk0\nJ0 1\n0 " + coefficient + "\nJ1 1\n0 1\n";
}

// F = sqrt(x) + 1 and its solution 0, where F' is not defined. Catches a judge that asks for more than F.
TEST(Polyhedron, SolutionWithoutADerivative) {
  const auto m = read_text(line("o0\no39\nv0\nn1\n", "0", "-1"));
  const lcp::ViResult judged = judge_vi(*m, Vec::Zero(1), {.tol = 1e-8});
  EXPECT_TRUE(judged.solved()) << judged.message;
  EXPECT_TRUE(solved(*m).result.solved());
}

// F = -x on x >= 1: no solution, which an enumeration proves that leaves no multipliers. Catches a proof that is lost.
TEST(Polyhedron, ProofByEnumerationStays) {
  const auto m = read_text(line("n0\n", "-1", "1"));
  const settings::Outcome outcome = solved(*m);
  EXPECT_EQ(outcome.result.status, Status::Infeasible) << outcome.result.message;
  EXPECT_GT(outcome.result.proof.residual_bound, 0.1);
}

// 1e-9 (x^3 - 8) is below the tolerance at the start. Catches --tol-relative that goes unheard.
TEST(Polyhedron, RelativeToleranceCounts) {
  const auto m = read_text(line("o2\nn1e-9\no0\no5\nv0\nn3\nn-8\n", "0", "0.5"));
  settings::Settings strict;
  strict.method = automatic({.tol_relative = 1e-6, .max_iterations = 0});
  EXPECT_FALSE(
      (settings::Session{.mcp = *m, .x0 = m->start(), .settings = strict, .model = m.get()}.run().result.accepted()));
}

// Multipliers of one x would count as solutions.
TEST(Polyhedron, RefusesToLookForSeveral) {
  const auto m = read_text(cubic);
  settings::Settings several;
  several.solutions = 5;
  EXPECT_THROW((settings::Session{.mcp = *m, .x0 = m->start(), .settings = several, .model = m.get()}.run()),
               settings::InputError);
}

TEST(Polyhedron, RefusesConstantsThatAreNoNumbers) {
  for (const char* constant : {"o43\nn-1\n", "o44\nn1000\n"})
    expect_refused(line("n0\n", "1", "1", constant), bad_file, {"_scon[2]", "not defined"});
}

/// A model F(x) = M x + q + exp(x_i / 4) on rows of every kind: it, and its polyhedron as it was drawn.
struct Drawn {
  std::string nl;
  lcp::Polyhedron C;
};
Drawn drawn(std::mt19937& random, bool affine) {
  const auto number = [&](int from, int to) { return std::uniform_int_distribution<int>(from, to)(random); };
  const int n = number(1, 6), m = number(1, 6);
  std::ostringstream C, r, b, J;
  Drawn out{.nl = "", .C = {.A = SpMat(m, n), .rows = Box::free(m), .box = Box::free(n)}};
  Eigen::MatrixXd M = Eigen::MatrixXd::Identity(n, n) * 3;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < i; ++j) M(i, j) = number(-2, 2), M(j, i) = -M(i, j);
  const int first = number(0, n);  // the polyhedron's rows stand among the others
  std::vector<int> marked, rows;
  for (int i = 0; i < n; ++i) rows.push_back(i);
  for (int i = 0; i < m; ++i) rows.insert(rows.begin() + first, n + m - 1 - i);
  int equations = 0;
  for (int k = 0; k < n + m; ++k) {
    const int i = rows[lcp::at(k)];
    C << "C" << k << "\n";
    J << "J" << k << " " << n << "\n";
    for (int j = 0; j < n; ++j) {
      const double a = i < n ? M(i, j) : number(-2, 2);
      if (i >= n) out.C.A.coeffRef(i - n, j) = a;
      J << j << " " << a << "\n";
    }
    if (i < n) {
      C << (affine ? "n" + std::to_string(number(-9, 9)) + "\n" : "o44\no3\nv" + std::to_string(i) + "\nn4\n");
      r << "5 3 " << i + 1 << "\n";
      continue;
    }
    marked.push_back(k);
    C << "n0\n";
    const int kind = number(0, 4), low = number(-5, -1), high = kind == 4 ? low : number(0, 5);
    equations += kind == 4;
    if (kind != 1 && kind != 3) out.C.rows.lower[i - n] = low;
    if (kind != 2 && kind != 3) out.C.rows.upper[i - n] = high;
    r << kind << (kind == 3 ? "" : " " + std::to_string(kind == 1 ? high : low));
    r << (kind == 0 ? " " + std::to_string(high) : "") << "\n";
  }
  for (int j = 0; j < n; ++j) {
    out.C.box.lower[j] = -8;
    out.C.box.upper[j] = 8;
    b << "0 -8 8\n";
  }
  std::ostringstream head, k;
  head << text({.vars = n, .cons = n + m, .eqns = equations, .cc = n, .nonzeros = n * (n + m)});
  head << "S1 " << m << " polyhedron\n";
  for (const int row : marked) head << row << " 1\n";
  k << "k" << n - 1 << "\n";
  for (int j = 1; j < n; ++j) k << j * (n + m) << "\n";
  out.nl = head.str() + C.str() + "r\n" + r.str() + "b\n" + b.str() + k.str() + J.str();
  return out;
}

// A law: F of the file is F - A'lambda and A x - b, in numbers, in derivatives, in ranges and as it is written down;
// and what is called solved is so by the judge over the polyhedron that was drawn.
TEST(Polyhedron, RandomModels) {
  std::mt19937 random(11);
  int found = 0, proven = 0;
  for (int run = 0; run < 200; ++run) {
    const auto [nl, C] = drawn(random, run % 2 == 0);
    const auto m = read_text(nl);
    const Index n = C.size(), size = m->size();
    const Vec z = Vec::Random(size);
    Vec x = z;
    x.tail(size - n).setZero();
    // F is that at multipliers of 0, and A'lambda.
    const Eigen::MatrixXd J = jacobian(*m, z);
    EXPECT_EQ(J.topRightCorner(n, size - n), -J.bottomLeftCorner(size - n, n).transpose());
    EXPECT_LE((values(*m, z) - values(*m, x) - J.rightCols(size - n) * z.tail(size - n)).lpNorm<Eigen::Infinity>(),
              1e-12);
    EXPECT_LE(check_jacobian(*m, z).worst, 1e-6) << run;
    std::vector<Interval> X, F(lcp::at(size), Interval(0));
    for (const double entry : z) X.emplace_back(entry);
    m->enclosure()->values(X, F, {});
    const auto written = m->expressions()->graph.ranges(X);
    for (Index i = 0; i < size; ++i) {
      const double value = values(*m, z)[i];
      const Interval& other = written.values[lcp::at(m->expressions()->rows[lcp::at(i)])];
      EXPECT_TRUE(F[lcp::at(i)].lower <= value + 1e-12 && value - 1e-12 <= F[lcp::at(i)].upper);
      EXPECT_TRUE(other.lower <= value + 1e-12 && value - 1e-12 <= other.upper);
    }
    const settings::Outcome outcome = solved(*m);
    const Vec at = outcome.result.x.head(n);
    if (outcome.result.solved()) {
      ++found;
      lcp::Projector projector(C);
      Vec of_x = outcome.result.x;
      of_x.tail(size - n).setZero();
      const lcp::Limits limits{.tol = 1.01e-8};
      const auto judged = lcp::judge_vi(projector, at, values(*m, of_x).head(n), 0, Vec::Ones(n), {}, limits);
      EXPECT_TRUE(judged.accepted()) << run << ": " << judged.message;
    } else {
      ASSERT_EQ(outcome.result.status, Status::Infeasible) << run << outcome.result.message;
      SpMat identity(n, n);
      identity.setIdentity();
      EXPECT_EQ(lcp::solve_vi({identity, Vec::Zero(n), C}).status, Status::Infeasible) << run;
      EXPECT_GT(outcome.result.proof.residual_bound, 0) << run;
      ++proven;
    }
  }
  EXPECT_GT(found, 50);
  EXPECT_GT(proven, 5);
}

}  // namespace
}  // namespace perp::ncp::ampl
