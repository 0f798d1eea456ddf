// SPDX-License-Identifier: Apache-2.0
/// Rolling friction: 5 entries a contact in 3D, 3 in 2D. Source: Acary & Bourrier, Coulomb friction with rolling
/// resistance as a cone complementarity problem, Eur. J. Mech. A Solids 85 (2021) 104046.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "contact/contact_support.hpp"
#include "contact/existence/existence.hpp"
#include "contact/laws/glocker.hpp"
#include "contact/solvers/run.hpp"
#include "contact/solvers/sequence.hpp"
#include "contact/solvers/solve.hpp"
#include "ncp/problem/mcp.hpp"
#include "ncp/problem/residual.hpp"
#include "ncp/strategy/solve.hpp"

namespace perp::contact {
namespace {

using support::Dense;
using support::Random;
using support::sparse;
using support::vec;
using testing::HasSubstr;

/// A contact with W = diag(1/2, 1/2, .., 5/4, ..): mass 2 kg, moments 4/5 kg m^2.
Problem rolling_point(const Vec& q, double mu, double mu_r) {
  const Index d = q.size();
  Vec W = Vec::Constant(d, 1.25);
  W.head(1 + (d - 1) / 2).setConstant(0.5);
  Problem p{.dimension = static_cast<int>(d), .q = q, .mu = vec({mu}), .mu_r = vec({mu_r})};
  p.W = sparse(W.asDiagonal());
  return p;
}

/// W = H'H of m rows, q = H'v + w with w inside K*: a solution exists (contact/existence/existence.hpp).
Problem solvable_rolling(int d, Index n, Index m, Random& random, double without = 0) {
  const Dense H = random.normals(m, d * n);
  Problem p{.dimension = d, .q = H.transpose() * random.normals(m), .mu = Vec(n), .mu_r = Vec(n)};
  const Dense W = H.transpose() * H;
  p.W = sparse(0.5 * (W + W.transpose()));  // bit by bit, as proofs want it
  for (Index a = 0; a < n; ++a) {
    p.mu[a] = random.chance(without) ? 0 : random.uniform(0.1, 1);
    p.mu_r[a] = random.chance(without) ? 0 : random.uniform(0.05, 0.5);
    p.q[d * a] += random.uniform(0.01, 0.5);
  }
  p.name = "rolling";
  return p;
}

State state(const Problem& p, const Vec& r) { return states(p, r).at(0).state; }

// The 2 kg ball arrives with u_N = -3: r_N = 6. It sticks, rolls or slips by what friction and rolling friction can
// stop, disk by disk, for W is diagonal; |m_R| = mu_r r_N where it rolls on. Each wrong in one thing is no solution.
TEST(Rolling, ClosedForms) {
  const Problem sticks = rolling_point(vec({-3, 0.6, -0.8, 0.3, 0.4}), 0.4, 0.1);
  const Vec stuck = vec({6, -1.2, 1.6, -0.24, -0.32});
  EXPECT_LE(residual(sticks, stuck).largest(), 1e-15);
  EXPECT_EQ(state(sticks, stuck), State::Stick);

  const Problem rolls = rolling_point(vec({-3, 0.6, -0.8, 3, -4}), 0.4, 0.1);
  const Vec rolled = vec({6, -1.2, 1.6, -0.36, 0.48});  // w_R = (3, -4) (1 - 1.25 * 0.6 / 5)
  EXPECT_LE(residual(rolls, rolled).largest(), 1e-15);
  EXPECT_EQ(state(rolls, rolled), State::Roll);
  EXPECT_NEAR(states(rolls, rolled)[0].margin, 5 - 1.25 * 0.6, 1e-15);

  const Problem both = rolling_point(vec({-3, 3, -4, 3, -4}), 0.1, 0.1);
  const Vec slid = vec({6, -0.36, 0.48, -0.36, 0.48});
  EXPECT_LE(residual(both, slid).largest(), 1e-15);
  EXPECT_EQ(state(both, slid), State::Slip);

  const Problem opens = rolling_point(vec({1, 3, -4, 3, -4}), 0.1, 0.1);
  EXPECT_LE(residual(opens, Vec::Zero(5)).largest(), 1e-15);
  EXPECT_EQ(state(opens, Vec::Zero(5)), State::Open);

  const Residual turned = residual(both, vec({6, -0.36, 0.48, -0.48, 0.36}));
  EXPECT_LE(std::max({turned.cone_share, turned.normal_share}), 1e-15);
  EXPECT_GT(turned.slip_share, 0.01);
  EXPECT_GT(turned.siconos, 0.01);
  EXPECT_GT(residual(both, vec({6, -0.36, 0.48, -0.36, 0.49})).cone_share, 1e-4);
  EXPECT_GT(residual(both, vec({6, -0.36, 0.48, 0, 0})).slip_share, 0.01);
}

TEST(Rolling, ClosedFormsInThePlane) {
  const Problem rolls = rolling_point(vec({-3, 0.6, -4}), 0.4, 0.1);
  const Vec rolled = vec({6, -1.2, 0.6});
  EXPECT_LE(residual(rolls, rolled).largest(), 1e-15);
  EXPECT_EQ(state(rolls, rolled), State::Roll);
  EXPECT_GT(residual(rolls, vec({6, -1.2, -0.6})).slip_share, 0.01);
}

// Metres and millimetres: q_R stays, what has a length changes. The published metrics mix units, the others do not.
// Catches rolling velocities that are added to sliding ones as they are.
TEST(Rolling, SharesDoNotDependOnUnits) {
  Random random(3);
  for (int k = 0; k < 20; ++k) {
    const Problem metres = solvable_rolling(5, 3, 9, random);
    const Vec r = random.normals(15);
    Vec u_unit = Vec::Constant(15, 1000);  // velocities: m/s to mm/s, 1/s as they are
    for (Index a = 0; a < 3; ++a) u_unit.segment(5 * a + 3, 2).setOnes();
    const Vec r_unit = 1e6 * u_unit.cwiseInverse();  // the work u.r is 1e6 times as large in mm^2
    Problem millimetres = metres;
    millimetres.q = u_unit.cwiseProduct(metres.q);
    millimetres.mu_r = 1000 * metres.mu_r;
    millimetres.W = sparse(u_unit.asDiagonal() * Dense(metres.W.matrix()) * r_unit.cwiseInverse().asDiagonal());
    const Residual one = residual(metres, r);
    const Residual other = residual(millimetres, r_unit.cwiseProduct(r));
    EXPECT_NEAR(other.cone_share / one.cone_share, 1, 1e-9);
    EXPECT_NEAR(other.normal_share / one.normal_share, 1, 1e-9);
    EXPECT_NEAR(other.slip_share / one.slip_share, 1, 1e-9);
    EXPECT_NEAR(other.scaled / one.scaled, 1, 1e-9);
  }
}

// mu_r = 0 on every contact: the solutions are those without the rolling rows. Catches rows of a disk that has none.
TEST(Rolling, WithoutRollingFrictionIsCoulombs) {
  Random random(4);
  for (int k = 0; k < 10; ++k) {
    Problem p = solvable_rolling(5, 4, 30, random);
    p.mu_r.setZero();
    const Result result = solve(p, {.method = Nsgs{}});
    ASSERT_TRUE(result.solved()) << result.message;
    std::vector<Index> rows;  // those of N and the first disk
    for (Index a = 0; a < 4; ++a)
      for (Index i = 0; i < 3; ++i) rows.push_back(5 * a + i);
    Problem sliding = p;
    sliding.dimension = 3;
    sliding.mu_r.resize(0);
    sliding.W = support::sparse(Dense(Dense(p.W.matrix())(rows, rows)));
    sliding.q = p.q(rows);
    EXPECT_TRUE(accepted(residual(sliding, Vec(result.solution.r(rows))), 1e-8));
  }
}

// In 2D and 3D, with contacts that do not roll, or slide without friction, among them: by each method that says it
// knows them. The others refuse.
TEST(Rolling, IsSolvedOrRefused) {
  Random random(5);
  for (const int d : {3, 5})
    for (int k = 0; k < 5; ++k) {
      const Problem p = solvable_rolling(d, 4, 3 * d, random, 0.2);
      int solved = 0;
      for (const MethodEntry& entry : methods()) {
        Result result;
        try {
          result = solve(p, {.max_time = std::chrono::seconds(5), .method = entry.method});
        } catch (const std::invalid_argument& error) {
          EXPECT_THAT(error.what(), HasSubstr("rolling friction"));
          continue;
        }
        if (entry.name == "auto" || entry.name == "nsgs") {
          EXPECT_TRUE(result.solved()) << entry.name << ' ' << d << ' ' << k << ": " << result.message;
        }
        if (!result.solved()) continue;
        EXPECT_TRUE(accepted(residual(p, result.solution.r), 1e-8)) << entry.name;
        ++solved;
      }
      EXPECT_GE(solved, 3) << d << ' ' << k;
    }
}

// J against differences of F in both encodings and with both rows of the disks, in 2D and 3D, with contacts that have
// one disk or none among them. Catches a disk's terms in the other's rows.
TEST(Rolling, JacobiansOfGlockersNcpMatchDifferences) {
  Random random(7);
  for (const int d : {3, 5})
    for (int k = 0; k < 5; ++k) {
      const Scaled coordinates = scaled(solvable_rolling(d, 4, 6, random, 0.3));
      for (const Encoding encoding : {Encoding::A, Encoding::B})
        for (const DiskRow row : {DiskRow::Original, DiskRow::Normalised}) {
          const Glocker mcp(coordinates, {.encoding = encoding, .row = row, .delta = 0.1, .eps = 0.1});
          for (const Vec& x : {mcp.start(), Vec(3 * random.normals(mcp.size()))}) {
            const ncp::JacobianCheck check = ncp::check_jacobian(mcp, x);
            EXPECT_LE(check.worst, 1e-5) << d << "D: " << ncp::describe(mcp, check);
            EXPECT_FALSE(check.outside_pattern);
          }
        }
    }
}

// The closed forms' multipliers solve the NCP up to delta; a method for NCPs comes to a solution of the law.
TEST(Rolling, GlockersNcpIsThisLaw) {
  const Problem both = rolling_point(vec({-3, 3, -4, 3, -4}), 0.1, 0.1);
  const Scaled coordinates = scaled(both);
  const Vec slid = vec({6, -0.36, 0.48, -0.36, 0.48});
  for (const Encoding encoding : {Encoding::A, Encoding::B}) {
    const Glocker mcp(coordinates, {.encoding = encoding, .delta = 1e-12});
    const Vec z = mcp.start_at(coordinates.reduce(slid));
    EXPECT_LE(ncp::residual(mcp, z).natural, 1e-10);
    EXPECT_LE((mcp.recover(z) - slid).norm(), 1e-12);
  }
  Random random(10);
  int solved = 0;
  for (int k = 0; k < 10; ++k) {
    const Problem p = solvable_rolling(5, 3, 12, random, 0.1);
    solved += solve(p, {.max_time = std::chrono::seconds(5), .method = GlockerNcp{.method = ncp::path()}}).solved();
  }
  EXPECT_GE(solved, 9);
}

// Weights that squeeze a body prove that there is no solution, whatever friction and rolling friction do; velocities
// inside K*_mu that there is one. Catches a witness that leaves out mu_r |w_R|.
TEST(Rolling, ExistenceIsDecided) {
  Random random(6);
  int witnesses = 0;
  for (int k = 0; k < 20; ++k) {
    const Problem p = solvable_rolling(5, 3, 12, random);
    EXPECT_FALSE(find_infeasibility(p));
    const std::optional<Witness> witness = find_witness(p);
    if (!witness) continue;
    ++witnesses;
    const Vec u = p.W * witness->r + p.q;
    for (Index a = 0; a < 3; ++a)
      EXPECT_GT(u[5 * a], p.mu[a] * u.segment(5 * a + 1, 2).norm() + p.mu_r[a] * u.segment(5 * a + 3, 2).norm());
  }
  EXPECT_GE(witnesses, 18);

  Dense H = Dense::Zero(5, 10);  // between two walls, along the first coordinate
  H.leftCols(5).setIdentity();
  H.rightCols(5).setIdentity();
  H(0, 5) = -1;
  Problem squeezed{.dimension = 5, .q = Vec::Zero(10), .mu = vec({0.5, 0.5}), .mu_r = vec({0.1, 0.1})};
  squeezed.W = sparse(H.transpose() * H);
  squeezed.q[0] = squeezed.q[5] = -1;
  const Result result = solve(squeezed, {.max_time = std::chrono::seconds(2)});
  EXPECT_EQ(result.status, Status::Infeasible) << result.message;

  // One contact whose normal impulse turns it towards the wall: -g in K* with g = W e_N, for W_NN <= 0 of this
  // unsymmetric W, but not if its rolling part is longer than -W_NN / mu_r.
  Problem alone{.dimension = 3, .q = vec({-1, 0, 0}), .mu = vec({0.5}), .mu_r = vec({0.25})};
  alone.W = sparse((Dense(3, 3) << -1, 0, 3, 0, 1, 0, 0, 0, 1).finished());
  EXPECT_EQ(infeasibility_radius(alone, vec({1})), lcp::infinity);
  alone.mu_r[0] = 0.5;
  EXPECT_LT(infeasibility_radius(alone, vec({1})), 3);
}

// Followers of sequences know one disk. Catches a system of three entries a contact that is given five.
TEST(Rolling, SequencesGoOn) {
  Sequence sequence;
  for (const double push : {0.6, 0.7, 2.5}) {
    const contact::Run run = sequence.step(rolling_point(vec({-3, push, -0.8, 0.3, 0.4}), 0.4, 0.1));
    EXPECT_TRUE(run.solved) << push << ": " << run.message;
  }
  EXPECT_EQ(sequence.stats().solved, 3);
}

TEST(Rolling, IsChecked) {
  Problem p = rolling_point(vec({-3, 0, 0, 0, 0}), 0.4, 0.1);
  p.mu_r = Vec();
  EXPECT_THROW(check(p), std::invalid_argument);
  p.mu_r = vec({-0.1});
  EXPECT_THROW(check(p), std::invalid_argument);
  p.mu_r = vec({0.1, 0.1});
  EXPECT_THROW(check(p), std::invalid_argument);
  p = rolling_point(vec({-3, 0, 0}), 0.4, 0.1);
  EXPECT_NO_THROW(check(p));
  p.dimension = 4;
  EXPECT_THROW(check(p), std::invalid_argument);
  EXPECT_THROW(run(rolling_point(vec({-3, 0, 0, 0, 0}), 0.4, 0.1), variant_of("inner:8")), std::invalid_argument);
  EXPECT_THROW(run(rolling_point(vec({-3, 0, 0, 0, 0}), 0.4, 0.1), variant_of("ncp1")), std::invalid_argument);
}

}  // namespace
}  // namespace perp::contact
