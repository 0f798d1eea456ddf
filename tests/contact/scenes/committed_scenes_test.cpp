// SPDX-License-Identifier: Apache-2.0
/// data/contact is what the generators make, and its solutions are solutions.
#include "contact/scenes/committed_scenes.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "contact/io/fclib.hpp"
#include "contact/model/residual.hpp"

namespace perp::contact {
namespace {

const std::filesystem::path folder = std::filesystem::path(PERP_SOURCE_DIR) / "data" / "contact";

/// Up to the rounding of sines and roots, which libraries may do differently.
void expect_near(const SpMat& a, const SpMat& b, const char* what) {
  ASSERT_EQ(a.rows(), b.rows()) << what;
  ASSERT_EQ(a.cols(), b.cols()) << what;
  EXPECT_LE((a - b).norm(), 1e-7 * b.norm()) << what;
}

// Catches a generator that was changed without its files, and files that were changed by hand.
TEST(CommittedScenes, AreWhatTheGeneratorsMake) {
  for (const Scene& scene : committed_scenes()) {
    SCOPED_TRACE(scene.name);
    const Fclib file = read_fclib(committed_file(folder, scene).string());
    ASSERT_TRUE(file.problem.global);
    const Problem made = scene.problem();
    expect_near(file.problem.global->M, made.global->M, "M");
    expect_near(file.problem.global->H, made.global->H, "H");
    EXPECT_LE((file.problem.global->f - made.global->f).norm(), 1e-9 * made.global->f.norm());
    EXPECT_EQ(file.problem.global->w, made.global->w);
    EXPECT_EQ(file.problem.mu, made.mu);
    EXPECT_EQ(file.title, scene.name);
  }
}

TEST(CommittedScenes, HaveTheirSolutions) {
  for (const Scene& scene : committed_scenes()) {
    SCOPED_TRACE(scene.name);
    const Fclib file = read_fclib(committed_file(folder, scene).string());
    ASSERT_TRUE(file.solution);
    const Residual e = residual(file.problem, file.solution->r);
    EXPECT_LE(e.siconos, 1e-8);
    EXPECT_LE(e.rr9118, 1e-8);
    const Global& global = *file.problem.global;
    EXPECT_LE((global.M * file.solution->v - global.H * file.solution->r - global.f).norm(), 1e-10 * global.f.norm());
  }
}

TEST(CommittedScenes, AreTheOnlyFiles) {
  std::set<std::string> expected{"README.md"};
  for (const Scene& scene : committed_scenes()) expected.insert(scene.name + ".hdf5");
  std::set<std::string> found;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) found.insert(entry.path().filename().string());
  EXPECT_EQ(found, expected);
}

}  // namespace
}  // namespace perp::contact
