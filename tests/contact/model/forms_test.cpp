// SPDX-License-Identifier: Apache-2.0
/// Which form of W a solve takes.
#include "contact/model/forms.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "contact/scenes/generators.hpp"
#include "contact/solvers/referee.hpp"
#include "support/matrices.hpp"

namespace perp::contact {
namespace {

using support::Dense;
using support::Random;
using support::sparse;

bool takes_entries(const Problem& problem) { return scaled(problem).W.parts() == nullptr; }

/// One body of `size` velocities, all of which M couples, with these contacts.
Problem one_body(Index size, Index contacts, Random& random) {
  const Dense X = random.normals(size, size);
  const Dense M = X * X.transpose() + static_cast<double>(size) * Dense::Identity(size, size);
  return condense({.M = sparse(0.5 * (M + M.transpose())),
                   .H = sparse(random.normals(size, 3 * contacts)),
                   .G = SpMat(size, 0),
                   .f = random.normals(size),
                   .w = random.normals(3 * contacts),
                   .b = Vec(0)},
                  Vec::Constant(contacts, 0.5));
}

/// A lattice of n^3 nodes with three velocities each, of which M couples neighbours; its floor touches.
Problem lattice(int n) {
  const int m = 3 * n * n * n;
  std::vector<Eigen::Triplet<double>> M;
  std::vector<Eigen::Triplet<double>> H;
  int columns = 0;
  for (int i = 0; i < m; ++i) {
    M.emplace_back(i, i, 8);
    const int node = i / 3;
    const int next[] = {node % n + 1 < n ? i + 3 : m, node / n % n + 1 < n ? i + 3 * n : m, i + 3 * n * n};
    for (const int j : next) {
      if (j >= m) continue;
      M.emplace_back(i, j, -1.2);
      M.emplace_back(j, i, -1.2);
    }
    if (i < 3 * n * n) H.emplace_back(i, columns++, 1);  // the first is the normal
  }
  Global g{.M = SpMat(m, m), .H = SpMat(m, columns), .G = SpMat(m, 0), .f = -Vec::Ones(m)};
  g.M.setFromTriplets(M.begin(), M.end());
  g.H.setFromTriplets(H.begin(), H.end());
  g.w = Vec::Zero(columns);
  return condense(std::move(g), Vec::Constant(columns / 3, 0.3));
}

// Links of a chain, a body of 60 coupled velocities with two contacts and an elastic one have small W; a wall and a
// body with 40 contacts large ones. Catches a comparison that is the wrong way round, or that one of the two never
// wins.
TEST(Forms, EntriesWhereTheyTakeLess) {
  Random random(3);
  EXPECT_TRUE(takes_entries(make_scene("chain", 60).problem()));
  EXPECT_TRUE(takes_entries(one_body(60, 2, random)));
  EXPECT_TRUE(takes_entries(lattice(8)));
  EXPECT_FALSE(takes_entries(make_scene("wall", 60).problem()));
  EXPECT_FALSE(takes_entries(make_scene("spheres", 1000).problem()));
  EXPECT_FALSE(takes_entries(one_body(6, 40, random)));
}

// Catches entries that are not those of the coordinates, and a form with which scenes are not solved.
TEST(Forms, BothAreSolved) {
  Random random(4);
  for (const char* name : {"chain", "wall", "stack", "spheres"}) {
    const Problem problem = make_scene(name, 60).problem();
    const Scaled parts = scaled(problem, true, WForm::Parts);
    const Scaled entries = scaled(problem, true, WForm::Entries);
    ASSERT_TRUE(parts.W.parts() && !entries.W.parts()) << name;
    const Vec r = random.normals(parts.size());
    EXPECT_LE((parts.W * r - entries.W * r).norm(), 1e-12 * (parts.W * r).norm()) << name;
    for (const Scaled& coordinates : {parts, entries}) {
      const Options options{};
      Referee referee(problem, coordinates, options);
      run_auto(referee, coordinates, Auto{}, Vec());
      EXPECT_TRUE(referee.result("").solved()) << name;
    }
  }
}

}  // namespace
}  // namespace perp::contact
