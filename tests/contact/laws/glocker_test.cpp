// SPDX-License-Identifier: Apache-2.0
/// Glocker's NCP: derivatives, closed forms, both encodings, and what the normalised row changes.
#include "contact/laws/glocker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "contact/model/residual.hpp"
#include "glocker_support.hpp"
#include "ncp/problem/residual.hpp"
#include "ncp/strategy/solve.hpp"

namespace perp::contact {
namespace {

using support::Random;
using support::vec;
using test::one_contact;
using test::one_contact_solution;
using test::solvable_problem;
using testing::HasSubstr;

std::vector<GlockerOptions> variants(double delta = 0.1, double eps = 0.05) {
  std::vector<GlockerOptions> all;
  for (const Encoding encoding : {Encoding::A, Encoding::B})
    for (const DiskRow row : {DiskRow::Original, DiskRow::Normalised}) all.push_back({encoding, row, delta, eps});
  return all;
}

std::string label(const GlockerOptions& o) {
  return std::string(o.encoding == Encoding::A ? "A" : "B") + (o.row == DiskRow::Original ? ", original" : "");
}

// J against differences of F, at random points, at r = 0, for negative r_N (g without cancellation), large multipliers;
// in 3D, 2D and with frictionless contacts. Catches every wrong derivative and entries outside the pattern.
TEST(Glocker, JacobiansMatchDifferences) {
  Random random(1);
  for (const int dimension : {2, 3})
    for (int k = 0; k < 10; ++k) {
      const Problem problem = solvable_problem(dimension, 4, 6, random, 0.3);
      for (const GlockerOptions& options : variants()) {
        const Glocker mcp(scaled(problem), options);
        const Index n = mcp.size();
        std::vector<Vec> points{mcp.start(), Vec::Zero(n), 3 * random.normals(n), 1e3 * random.normals(n)};
        Vec pulled = random.normals(n);
        for (Index a = 0; a < problem.contacts(); ++a) pulled[mcp.first(a)] = -5;
        points.push_back(pulled);
        for (const Vec& x : points) {
          const ncp::JacobianCheck check = ncp::check_jacobian(mcp, x);
          EXPECT_LE(check.worst, 1e-5) << label(options) << ' ' << dimension << "D: " << ncp::describe(mcp, check);
          EXPECT_FALSE(check.outside_pattern);
        }
      }
    }
}

// One contact, W = I, in closed form: open, sticking, slipping. The multipliers of start_at() solve the NCP up to
// delta, in both encodings. Catches a wrong sign of the slip, of a facet, a factor of kappa_D.
TEST(Glocker, ClosedFormsOfOneContact) {
  for (const double mu : {0.3, 1.0})
    for (const Vec& q : {vec({1, 2, -1}), vec({-1, 0.1, -0.1}), vec({-1, 2, 1}), vec({-1, -3, 0}), vec({-2, 0, -5}),
                         vec({1, 2}), vec({-1, 0.05}), vec({-1, 2}), vec({-1, -2})}) {
      const Problem problem = one_contact(q, mu);
      const Vec r = one_contact_solution(q, mu);
      ASSERT_LE(residual(problem, r).natural, 1e-15);
      const Scaled coordinates = scaled(problem);
      for (const GlockerOptions& options : variants(1e-12, 0)) {
        const Glocker mcp(coordinates, options);
        const Vec z = mcp.start_at(coordinates.reduce(r));
        EXPECT_LE(ncp::residual(mcp, z).natural, 1e-10) << label(options) << " q = " << q.transpose();
        EXPECT_LE((mcp.recover(z) - r).norm(), 1e-12);
      }
    }
}

// The other way round: what solves the NCP obeys the law. Random problems in 2D, where the NCP is affine, and in 3D, by
// PathSearch. Catches an encoding with solutions of its own.
TEST(Glocker, SolutionsObeyTheLaw) {
  Random random(2);
  int solved = 0;
  for (const int dimension : {2, 3})
    for (int k = 0; k < 10; ++k) {
      const Problem problem = solvable_problem(dimension, 3, 12, random, 0.2);
      for (const Encoding encoding : {Encoding::A, Encoding::B}) {
        const Glocker mcp(scaled(problem), {.encoding = encoding, .delta = 1e-10});
        EXPECT_EQ(mcp.is_affine(), dimension == 2 || problem.mu.maxCoeff() == 0);
        const ncp::Result result = ncp::solve(mcp, mcp.start(), ncp::path({.stop = {.tol = 1e-11}}));
        if (!result.solved()) continue;
        ++solved;
        EXPECT_LE(residual(problem, mcp.recover(result.x)).siconos, 1e-5) << dimension << "D";
      }
    }
  EXPECT_GE(solved, 36);
}

// At a point of encoding A, the point of B with s_i = sigma_i has the same F where they have rows in common. Catches a
// transcription of one that the other does not have.
TEST(Glocker, EncodingsAgree) {
  Random random(3);
  for (int k = 0; k < 20; ++k) {
    const Problem problem = solvable_problem(3, 2, 5, random);
    for (const DiskRow row : {DiskRow::Original, DiskRow::Normalised}) {
      const Glocker A(scaled(problem), {.encoding = Encoding::A, .row = row, .delta = 0.1});
      const Glocker B(scaled(problem), {.encoding = Encoding::B, .row = row, .delta = 0.1});
      // B's unknowns at random; kappa_1, kappa_2 of A are B's rows.
      const Vec b = random.normals(B.size()).cwiseAbs();
      Vec F_B(b.size());
      ASSERT_TRUE(B.eval(b, F_B));
      const Vec r = B.impulses(b);
      Vec a(A.size());
      for (Index c = 0; c < 2; ++c)
        a.segment(7 * c, 7) << r.segment(3 * c, 3), F_B[5 * c + 1], F_B[5 * c + 2], b[5 * c + 3], b[5 * c + 4];
      Vec F_A(a.size());
      ASSERT_TRUE(A.eval(a, F_A));
      for (Index c = 0; c < 2; ++c) {
        EXPECT_NEAR(F_A[7 * c], F_B[5 * c], 1e-10);  // u_N
        EXPECT_NEAR(F_A[7 * c + 1], 0, 1e-10);       // the stationarity that kappa_1, kappa_2 were solved from
        EXPECT_NEAR(F_A[7 * c + 2], 0, 1e-10);
        EXPECT_NEAR(F_A[7 * c + 3], b[5 * c + 1], 1e-10);  // sigma_1 = s_1
        EXPECT_NEAR(F_A[7 * c + 4], b[5 * c + 2], 1e-10);
        EXPECT_NEAR(F_A[7 * c + 5], F_B[5 * c + 3], 1e-10);  // sigma_3
        EXPECT_NEAR(F_A[7 * c + 6], F_B[5 * c + 4], 1e-10);  // sigma_D
      }
    }
  }
}

// The README's claim: at r = 0 the original row and column of kappa_D vanish, the normalised ones do not, for any
// delta; and g sigma_D of the normalised row tends to the original one as delta -> 0, linearly where r_N > 0.
TEST(Glocker, TheOriginalRowVanishesAtOpenContacts) {
  Random random(4);
  const Problem problem = solvable_problem(3, 3, 9, random);
  for (const Encoding encoding : {Encoding::A, Encoding::B})
    for (const DiskRow row : {DiskRow::Original, DiskRow::Normalised}) {
      const Glocker mcp(scaled(problem), {.encoding = encoding, .row = row, .delta = 1e-6});
      SpMat J = mcp.jacobian_pattern();
      ASSERT_TRUE(mcp.jacobian(mcp.start_at(Vec::Zero(9)), J));
      const Eigen::MatrixXd dense = J;
      for (Index a = 0; a < 3; ++a) {
        const Index D = mcp.first(a + 1) - 1;
        const double size = dense.row(D).norm() + dense.col(D).norm();
        if (row == DiskRow::Original) {
          EXPECT_EQ(size, 0);
        } else {
          EXPECT_GE(dense.row(D).norm(), 0.5);  // g' = 1/2 at r_N = 0
        }
      }
    }
  for (const double delta : {1e-2, 1e-4, 1e-6}) {
    const Glocker original(scaled(problem), {.encoding = Encoding::A, .row = DiskRow::Original});
    const Glocker normalised(scaled(problem), {.encoding = Encoding::A, .delta = delta});
    Vec x = random.normals(original.size());
    x[0] = 1.5;
    Vec F(x.size());
    Vec G(x.size());
    ASSERT_TRUE(original.eval(x, F) && normalised.eval(x, G));
    EXPECT_NEAR(x[0] * G[6], F[6], 20 * delta * delta * (1 + x.squaredNorm()));
  }
}

// Names say which contact and which part. Options that make no sense are refused.
TEST(Glocker, NamesAndRefusals) {
  const Scaled coordinates = scaled(one_contact(vec({-1, 2, 1}), 0.5));
  const Glocker A(coordinates, {.encoding = Encoding::A});
  EXPECT_EQ(A.variable_name(6), "kappa_D[1]");
  EXPECT_EQ(A.equation_name(0), "u_N[1]");
  const Glocker B(coordinates, {.encoding = Encoding::B});
  EXPECT_EQ(B.variable_name(1), "s_1[1]");
  EXPECT_EQ(B.equation_name(4), "sigma_D[1]");
  EXPECT_THAT([&] { Glocker(coordinates, {.delta = 0}); },
              testing::ThrowsMessage<std::invalid_argument>(HasSubstr("delta is 0")));
  EXPECT_THAT([&] { Glocker(coordinates, {.eps = -1}); },
              testing::ThrowsMessage<std::invalid_argument>(HasSubstr("eps is -1")));
}

// Scaling: the law is the same in both coordinates; frictionless contacts lose their tangents; columns have whole
// blocks.
TEST(Scaling, KeepsTheLaw) {
  Random random(5);
  for (const int dimension : {2, 3})
    for (int k = 0; k < 10; ++k) {
      Problem problem = solvable_problem(dimension, 5, 8, random, 0.3);
      problem.q *= 1e3;
      const Scaled coordinates = scaled(problem);
      const Vec back = random.normals(coordinates.size());
      EXPECT_LE((coordinates.reduce(coordinates.expand(back)) - back).norm(), 1e-12 * back.norm());
      // u = q_s M^-1 u~ row by row: impulse_i u_i is proportional to u~_i.
      const Vec u = problem.W * coordinates.expand(back) + problem.q;
      const Vec scaled_u = coordinates.W * back + coordinates.q;
      double ratio = 0;
      for (Index i = 0; i < back.size(); ++i) {
        const double now = scaled_u[i] / (coordinates.impulse[i] * u[coordinates.rows[static_cast<std::size_t>(i)]]);
        if (i == 0) ratio = now;
        EXPECT_NEAR(now / ratio, 1, 1e-9);
      }
      for (const Scaled::Block& block : coordinates.blocks)
        for (Index j = 0; j < coordinates.size(); ++j) {
          int entries = 0;
          for (SpMat::InnerIterator it(coordinates.W.matrix(), j); it; ++it)
            entries += it.row() >= block.first && it.row() < block.first + block.size ? 1 : 0;
          const bool own = j >= block.first && j < block.first + block.size;
          EXPECT_TRUE(entries == block.size || (entries == 0 && !own));
        }
    }
}

// The scaled natural map is zero at the closed forms and nowhere near; with alpha it is that of W + alpha I,
// q - alpha centre.
TEST(Scaling, NaturalMap) {
  for (const Vec& q : {vec({1, 2, -1}), vec({-1, 0.1, -0.1}), vec({-1, 2, 1}), vec({-1, 2})}) {
    const Problem problem = one_contact(q, 0.5);
    const Scaled coordinates = scaled(problem);
    Vec r = coordinates.reduce(one_contact_solution(q, 0.5));
    EXPECT_LE(natural_map(coordinates, r), 1e-15);
    Vec off = r;
    off[0] += 0.1;
    EXPECT_GE(natural_map(coordinates, off), 1e-3);
    Scaled proximal = coordinates;
    const Vec centre = Vec::Ones(q.size());
    proximal.W = proximal.W.plus(0.3);
    proximal.q -= 0.3 * centre;
    EXPECT_NEAR(natural_map(proximal, off), natural_map(coordinates, off, centre, 0.3), 1e-14);
  }
}

}  // namespace
}  // namespace perp::contact
