// SPDX-License-Identifier: Apache-2.0
#include "lcp/classes/classify.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <stdexcept>

#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::matrix;
using support::Random;
using support::sparse;
using support::vec;

/// All principal minors, each by its own determinant: the least, relative to Hadamard's bound.
double least_minor(const Dense& A) {
  double least = infinity;
  for (int set = 1; set < (1 << A.rows()); ++set) {
    std::vector<Index> alpha;
    for (Index i = 0; i < A.rows(); ++i)
      if ((set >> i) & 1) alpha.push_back(i);
    const Dense B = A(alpha, alpha);
    double bound = 1;
    for (Index i = 0; i < B.rows(); ++i) bound *= B.row(i).norm();
    least = std::min(least, bound > 0 ? B.determinant() / bound : 0);
  }
  return least;
}

/// What a No or Yes claims, recomputed.
void expect_witnesses(const SpMat& M, const Diagnosis& d, const std::string& what) {
  const auto form = [&](const Property& p) { return p.vector.dot(M * p.vector); };
  const auto nonnegative = [](const Vec& v) { return v.minCoeff() >= 0 && v.maxCoeff() > 0; };
  for (const auto& [name, property] : d.all()) EXPECT_FALSE(property->reason.empty()) << what << ": " << name;
  if (d.positive_semidefinite.no()) {
    EXPECT_LT(form(d.positive_semidefinite), 0) << what;
  }
  if (d.positive_definite.no()) {
    EXPECT_LE(form(d.positive_definite), 1e-12 * M.norm()) << what;
  }
  if (d.p.no() && d.p.vector.size() > 0) {
    const Vec v = d.p.vector;
    EXPECT_FALSE(v.isZero(0)) << what;
    EXPECT_LE((v.array() * (M * v).array()).maxCoeff(), 1e-12 * M.norm()) << what;
  }
  if (d.p.no() && d.p.vector.size() == 0) {
    EXPECT_LE(Dense(M)(d.p.indices, d.p.indices).determinant(), 1e-12) << what;
  }
  if (d.p0.no()) {
    EXPECT_LT(Dense(M)(d.p0.indices, d.p0.indices).determinant(), 0) << what;
  }
  for (const Property* property : {&d.copositive, &d.strictly_copositive, &d.copositive_plus})
    if (property->no()) {
      EXPECT_TRUE(nonnegative(property->vector)) << what;
    }
  if (d.copositive.no()) {
    EXPECT_LT(form(d.copositive), 0) << what;
  }
  if (d.strictly_copositive.no()) {
    EXPECT_LE(form(d.strictly_copositive), 1e-12 * M.norm()) << what;
  }
}

void expect_implications(const Diagnosis& d, const std::string& what) {
  const auto implies = [&](const Property& a, const Property& b) {
    EXPECT_FALSE(a.yes() && b.no()) << what << ": " << a.reason << " / " << b.reason;
  };
  implies(d.strictly_dominant, d.h_plus);
  implies(d.positive_definite, d.p);
  implies(d.positive_definite, d.strictly_copositive);
  implies(d.positive_semidefinite, d.p0);
  implies(d.positive_semidefinite, d.copositive_plus);
  implies(d.strictly_copositive, d.copositive_plus);
  implies(d.copositive_plus, d.copositive);
  implies(d.h_plus, d.p);
  implies(d.m, d.p);
  implies(d.p, d.p0);
}

// The examples of Cottle, Pang & Stone 1992 and of the literature, one for each boundary between two classes: catches a
// test that decides one class by another.
TEST(Classify, KnownMatrices) {
  const Diagnosis skew = classify(matrix({{0, 1}, {-1, 0}}));
  EXPECT_TRUE(skew.positive_semidefinite.yes());
  EXPECT_TRUE(skew.positive_definite.no());
  EXPECT_TRUE(skew.copositive_plus.yes());
  EXPECT_TRUE(skew.p.no());
  EXPECT_TRUE(skew.p0.yes());
  EXPECT_TRUE(skew.symmetric.no());

  // P, not positive definite: I + 4 above the diagonal. All strong components are single.
  const Diagnosis triangle = classify(matrix({{1, 4}, {0, 1}}));
  EXPECT_TRUE(triangle.p.yes());
  EXPECT_TRUE(triangle.positive_semidefinite.no());
  EXPECT_TRUE(triangle.strictly_copositive.yes());

  // Copositive, not copositive-plus: v = e_1 has v'Mv = 0, (M + M')v = (0, 1).
  const Diagnosis weak = classify(matrix({{0, 1}, {0, 0}}));
  EXPECT_TRUE(weak.copositive.yes());
  EXPECT_TRUE(weak.copositive_plus.no());
  EXPECT_TRUE(weak.strictly_copositive.no());

  // Horn's form: copositive, neither semidefinite nor nonnegative, nor the sum of two such.
  Dense horn(5, 5);
  horn << 1, -1, 1, 1, -1, -1, 1, -1, 1, 1, 1, -1, 1, -1, 1, 1, 1, -1, 1, -1, -1, 1, 1, -1, 1;
  const Diagnosis h = classify(sparse(horn));
  EXPECT_TRUE(h.copositive.yes()) << h.copositive.reason;
  EXPECT_TRUE(h.strictly_copositive.no());
  EXPECT_TRUE(h.copositive_plus.no()) << h.copositive_plus.reason;
  EXPECT_TRUE(h.positive_semidefinite.no());
  horn(0, 1) = horn(1, 0) = -1.001;
  EXPECT_TRUE(classify(sparse(horn)).copositive.no());

  // Neumann's Laplacian: a singular M-matrix, semidefinite, P0.
  const Diagnosis path = classify(matrix({{1, -1, 0}, {-1, 2, -1}, {0, -1, 1}}));
  EXPECT_TRUE(path.positive_semidefinite.yes());
  EXPECT_TRUE(path.positive_definite.no()) << path.positive_definite.reason;
  EXPECT_TRUE(path.m.no());
  EXPECT_TRUE(path.p0.yes());
  EXPECT_TRUE(path.strictly_copositive.no());

  // Munson's P-matrix that is not semidefinite, Murty's (triangular), Fathi's (definite, ill-conditioned).
  EXPECT_TRUE(classify(matrix({{1, 2, 3}, {0, 1, -1}, {0, 1, 1}})).p.yes());
  EXPECT_TRUE(classify(support::murty(500)).p.yes());
  const SpMat L = support::murty(16);
  const Diagnosis fathi = classify(SpMat(L.transpose() * L));
  EXPECT_TRUE(fathi.positive_definite.yes()) << fathi.positive_definite.reason;

  // Geiger & Kanzow: M-matrix; no entries at all: n = 0; zero matrix.
  EXPECT_TRUE(classify(support::tridiagonal(50, -1, 4, -1)).m.yes());
  EXPECT_TRUE(classify(SpMat(0, 0)).positive_definite.yes());
  const Diagnosis zero = classify(SpMat(3, 3));
  EXPECT_TRUE(zero.positive_semidefinite.yes() && zero.positive_definite.no() && zero.p0.yes() && zero.p.no());
}

// Random dense matrices of order 5 against every principal minor, and sampled nonnegative vectors: catches a wrong
// recursion, a wrong witness, a claim that does not hold.
TEST(Classify, AgainstBruteForce) {
  Random random(3);
  int p = 0;
  int not_p = 0;
  int copositive = 0;
  int not_copositive = 0;
  for (int repeat = 0; repeat < 600; ++repeat) {
    const Index n = random.integer(1, 5);
    Dense A = random.normals(n, n) + random.uniform(0, 3) * Dense::Identity(n, n);
    if (random.chance(0.3)) A = A.unaryExpr([](double a) { return std::round(a); }).eval();
    if (random.chance(0.3)) A = (A + A.transpose()).eval();
    const Vec scale = Vec::NullaryExpr(n, [&] { return std::pow(10, random.uniform(-4, 4)); });
    if (random.chance(0.3)) A = (scale.asDiagonal() * A * scale.asDiagonal()).eval();
    const SpMat M = sparse(A);
    const Diagnosis d = classify(M);
    const std::string what = "matrix " + std::to_string(repeat);
    expect_witnesses(M, d, what);
    expect_implications(d, what);
    const double least = least_minor(A);
    if (std::abs(least) > 1e-9) {
      EXPECT_EQ(to_string(d.p.answer), least > 0 ? "yes" : "no") << what;
    }
    if (least > -1e-12) {
      EXPECT_FALSE(d.p0.no()) << what;
    }
    p += d.p.yes();
    not_p += d.p.no();
    copositive += d.copositive.yes();
    not_copositive += d.copositive.no();
    EXPECT_NE(d.copositive.answer, Answer::NotDecided) << what;
    for (int sample = 0; sample < 300 && !d.copositive.no(); ++sample) {
      const Vec v = random.normals(n).cwiseMax(0).cwiseQuotient(scale);
      EXPECT_GE(v.dot(M * v), -1e-10 * v.cwiseAbs().dot(M.cwiseAbs() * v)) << what;
    }
    const Eigen::SelfAdjointEigenSolver<Dense> eigen(Dense(A + A.transpose()));
    const double lambda = eigen.eigenvalues()[0] / eigen.eigenvalues().cwiseAbs().maxCoeff();
    if (lambda < -1e-9) {
      EXPECT_TRUE(d.positive_semidefinite.no()) << what;
    }
    if (lambda > 1e-9) {
      EXPECT_TRUE(d.positive_definite.yes()) << what;
    }
  }
  EXPECT_GT(std::min({p, not_p, copositive, not_copositive}), 60);
}

// The families of which one knows the class at any size: catches a test that is right for small n only.
TEST(Classify, LargeFamilies) {
  Random random(5);
  const Index n = 3000;
  EXPECT_TRUE(classify(support::h_plus(n, 3, random)).p.yes());
  EXPECT_TRUE(classify(support::m_matrix(n, 3, random)).m.yes());
  const Diagnosis scaled = classify(support::p_matrix(n, 2, random));
  EXPECT_TRUE(scaled.h_plus.yes()) << scaled.h_plus.reason;
  EXPECT_TRUE(scaled.strictly_dominant.no());
  const Diagnosis psd = classify(support::psd_plus_skew(n, 2, random));
  EXPECT_TRUE(psd.positive_semidefinite.yes()) << psd.positive_semidefinite.reason;
  EXPECT_FALSE(psd.positive_definite.yes());
  EXPECT_TRUE(psd.copositive_plus.yes());
  SpMat indefinite = support::psd_plus_skew(n, 2, random);
  for (Index i = 0; i < n; ++i) indefinite.coeffRef(i, i) += 1e-3;
  EXPECT_TRUE(classify(indefinite).positive_definite.yes());
  for (Index i = 0; i < n; ++i) indefinite.coeffRef(i, i) -= 2e-3;
  const Diagnosis no = classify(indefinite);
  EXPECT_TRUE(no.positive_semidefinite.no()) << no.positive_semidefinite.reason;
  expect_witnesses(indefinite, no, "shifted");
}

/// D M D with D_i = 2^k_i: in the same classes but for dominance.
SpMat congruent(const Dense& A, const std::vector<int>& k) {
  return sparse(Dense::NullaryExpr(A.rows(), A.cols(), [&](Index i, Index j) {
    return std::ldexp(A(i, j), k[static_cast<std::size_t>(i)] + k[static_cast<std::size_t>(j)]);
  }));
}

// M 2^k is in the same classes, up to the ends of the numbers; catches sums, products and forms that overflow, where a
// comparison of infinities or an underflow to zero decides.
TEST(Classify, AnswersAreThoseOfAnyMultiple) {
  Random random(7);
  for (int repeat = 0; repeat < 60; ++repeat) {
    const Index n = random.integer(1, 5);
    Dense A = (4 * random.normals(n, n)).array().round();
    A.diagonal().array() += random.integer(0, 8);
    if (random.chance(0.3)) A = (A + A.transpose()).eval();
    if (random.chance(0.3)) A = (A * A.transpose()).eval();
    const Diagnosis d = classify(sparse(A));
    for (const int k : {-506, -300, 300, 500}) {
      const SpMat M = congruent(A, std::vector<int>(static_cast<std::size_t>(n), k));
      const Diagnosis scaled = classify(M);
      for (std::size_t c = 0; c < d.all().size(); ++c)
        EXPECT_EQ(to_string(scaled.all()[c].second->answer), to_string(d.all()[c].second->answer))
            << d.all()[c].first << " of matrix " << repeat << " 2^" << 2 * k << ": " << scaled.all()[c].second->reason
            << " / " << d.all()[c].second->reason;
      EXPECT_EQ(to_string(positive_semidefinite(M).answer), to_string(d.positive_semidefinite.answer)) << repeat;
    }
  }
}

// With entries from 1e-300 to 1e300 in one matrix, what is said may be less, never something else.
TEST(Classify, SaysNothingFalseOfEntriesOfAllSizes) {
  Random random(8);
  for (int repeat = 0; repeat < 200; ++repeat) {
    const Index n = random.integer(2, 5);
    Dense A = (4 * random.normals(n, n)).array().round();
    A.diagonal().array() += random.integer(0, 8);
    std::vector<int> k;
    for (Index i = 0; i < n; ++i) k.push_back(random.integer(-500, 500));
    const Diagnosis d = classify(sparse(A));
    const Diagnosis scaled = classify(congruent(A, k));
    for (std::size_t c = 0; c < d.all().size(); ++c) {
      const auto [name, property] = scaled.all()[c];
      if (name.find("dominant") != std::string_view::npos || property->answer == Answer::NotDecided) continue;
      EXPECT_EQ(to_string(property->answer), to_string(d.all()[c].second->answer))
          << name << " of matrix " << repeat << ": " << property->reason << " / " << d.all()[c].second->reason;
    }
  }
}

// det M = 1 - prod |M_ij| < 0 for this cycle, each of whose rows lacks less than tol of dominance. Catches a theorem on
// dominant matrices applied to one that is dominant up to rounding.
TEST(Classify, DominanceUpToRoundingProvesNothing) {
  const Index n = 10;
  Dense A = Dense::Identity(n, n);
  for (Index i = 0; i < n; ++i) A(i, (i + 1) % n) = i + 1 < n ? -1 - 1.9e-13 : -1 + 2.2e-13;
  const Diagnosis d = classify(sparse(A));
  for (const Property* property : {&d.h_plus, &d.m, &d.p, &d.positive_definite})
    EXPECT_FALSE(property->yes()) << property->reason;
  EXPECT_EQ(d.dominant.reason.find("to rounding: "), 0u) << d.dominant.reason;
}

// A Yes that rounding may have made says so, and so do those that follow from it.
TEST(Classify, SaysWhereAYesIsToRounding) {
  for (const SpMat& M : {matrix({{1, 1 + 4e-15}, {1 + 4e-15, 1}}), matrix({{1, 2 + 4e-15}, {0.5, 1}}),
                         matrix({{1, -1}, {-1, 1 - 1e-15}})}) {
    const Diagnosis d = classify(M);
    for (const Property* property : {&d.p0, &d.positive_semidefinite, &d.dominant})
      if (property->yes()) {
        EXPECT_TRUE(property->to_rounding) << property->reason;
      }
  }
  EXPECT_EQ(classify(matrix({{1, -1}, {-1, 1 - 1e-15}})).copositive.reason.find("to rounding: "), 0u);
}

// a d - b c = 2^-78, -2^-52 and so on, which rounds to 0: catches "no" on the word of a computed zero, and a strict
// dominance by one bit that is not seen.
TEST(Classify, ZerosByRoundingRefuteNothing) {
  const double e = 0x1p-26;
  const Diagnosis definite = classify(matrix({{1 + e, 1}, {1, 1 - e + 0x1p-52}}));
  EXPECT_FALSE(definite.p.no()) << definite.p.reason;
  EXPECT_FALSE(definite.positive_definite.no()) << definite.positive_definite.reason;
  EXPECT_FALSE(definite.strictly_copositive.no());
  const Diagnosis z = classify(matrix({{3, -3 - 0x1p-51}, {-3 + 0x1p-51, 3}}));
  EXPECT_FALSE(z.p.no()) << z.p.reason;
  EXPECT_FALSE(z.m.no()) << z.m.reason;
  EXPECT_TRUE(classify(matrix({{0.3, -0.3 + 0x1p-54}, {0.1, 0.7}})).strictly_dominant.yes());
  // Three rows whose determinant is exactly 0, and what rounds to it.
  EXPECT_TRUE(classify(matrix({{2, 3, 1}, {1, 2, 1}, {1, 1, 0}})).p.no());
  EXPECT_TRUE(classify(matrix({{1, 2, 1}, {-2, 4, 2}, {1, 2, 1}})).p.no());
}

// Above the limits the answer is NotDecided and says why; catches a guess.
TEST(Classify, SaysWhatItDoesNotKnow) {
  Random random(6);
  Dense A = random.normals(30, 30);
  A.diagonal().setConstant(20);
  const Diagnosis d = classify(sparse(A), {.factor_to = 0, .dense_to = 0, .minors_to = 5, .p0_to = 5, .sweeps = 1});
  for (const Property* property : {&d.positive_definite, &d.p, &d.p0, &d.copositive}) {
    EXPECT_EQ(property->answer, Answer::NotDecided) << property->reason;
    EXPECT_FALSE(property->reason.empty());
  }
}

// Fixed variables do not count, upper bounds reflect; witnesses are vectors of the problem.
TEST(Classify, TheBox) {
  const SpMat M = matrix({{2, 1, 0}, {1, 2, 0}, {5, 5, -1}});
  AffineMcp problem{.M = M, .q = Vec::Zero(3), .box = Box::nonnegative(3)};
  EXPECT_TRUE(classify(problem).p.no());
  EXPECT_TRUE(classify(problem).z.no());
  problem.box.upper[2] = 0;
  problem.box.lower[1] = -infinity;
  problem.box.upper[1] = 0;
  const Diagnosis d = classify(problem);
  EXPECT_TRUE(d.positive_definite.yes());
  EXPECT_TRUE(d.m.yes()) << "z_2 <= 0 reflects the signs off the diagonal";
  EXPECT_TRUE(d.cone);
  EXPECT_FALSE(d.bounded);
  problem.box.lower = vec({0, 0, -1});
  problem.box.upper = vec({0, 1, 1});
  const Diagnosis bounded = classify(problem);
  EXPECT_TRUE(bounded.bounded);
  ASSERT_TRUE(bounded.positive_semidefinite.no());
  EXPECT_EQ(bounded.positive_semidefinite.vector.size(), 3);
  EXPECT_LT(bounded.positive_semidefinite.vector.dot(M * bounded.positive_semidefinite.vector), 0);
  EXPECT_EQ(bounded.p.indices, std::vector<Index>{2});
}

TEST(Classify, GuaranteesFollowTheClasses) {
  const auto says = [](const Diagnosis& d, const std::string& words) {
    for (const Guarantee& g : d.guarantees())
      if (g.statement.find(words) != std::string::npos) return true;
    return false;
  };
  const Diagnosis p = classify(matrix({{1, 4}, {0, 1}}));
  EXPECT_TRUE(says(p, "exactly one solution"));
  EXPECT_FALSE(says(p, "interior points"));
  const Diagnosis skew = classify(matrix({{0, 1}, {-1, 0}}));
  EXPECT_TRUE(says(skew, "interior points"));
  EXPECT_TRUE(says(skew, "proves it infeasible"));
  EXPECT_FALSE(says(skew, "exactly one solution"));
  AffineMcp free{.M = matrix({{1, 4}, {0, 1}}), .q = Vec::Zero(2), .box = Box::free(2)};
  EXPECT_FALSE(says(classify(free), "Lemke"));
  // aa' with a = (1/3, 0.7), rounded: semidefinite but for that, and so is what follows; strictly copositive exactly.
  const double a = 1. / 3, b = 0.7;
  const Diagnosis rounded = classify(matrix({{a * a, a * b}, {a * b, b * b}}));
  ASSERT_TRUE(rounded.positive_semidefinite.yes() && rounded.positive_semidefinite.to_rounding);
  for (const char* words : {"to rounding: interior points", "to rounding: the solutions form a convex polyhedron",
                            "to rounding: the solutions are the minima", "to rounding: M + eps D is P"})
    EXPECT_TRUE(says(rounded, words)) << words;
  EXPECT_FALSE(says(rounded, "to rounding: a solution exists for every q"));
  EXPECT_FALSE(says(skew, "to rounding"));
}

TEST(Classify, RefusesBadInput) {
  EXPECT_THROW(classify(SpMat(2, 3)), std::invalid_argument);
  EXPECT_THROW(classify(matrix({{std::nan("")}})), std::invalid_argument);
  EXPECT_THROW(classify(matrix({{1}}), {.tol = 0}), std::invalid_argument);
  EXPECT_THROW(classify(matrix({{1}}), {.minors_to = 40}), std::invalid_argument);
}

}  // namespace
}  // namespace perp::lcp
