// SPDX-License-Identifier: Apache-2.0
// FCLIB files of contacts with rolling friction.
#include <gtest/gtest.h>

#include "contact/contact_support.hpp"
#include "contact/io/fclib.hpp"
#include "contact/io/fclib_support.hpp"

namespace perp::contact {
namespace {

using lcp::FileError;
using support::Dense;
using support::Random;
using support::vec;

// Local and global, 2D and 3D, written and read back; in the groups of rolling friction. Catches a mu_r that is lost, a
// file with both kinds of group.
TEST(Fclib, RollingFriction) {
  const Folder folder;
  Random random(9);
  for (const int d : {3, 5}) {
    Global g{.M = support::sparse(2 * Dense::Identity(4, 4)), .H = support::sparse(random.normals(4, 2 * d))};
    g.G = SpMat(4, 0);
    g.f = random.normals(4);
    g.w = random.normals(2 * d);
    const Problem p = condense(g, vec({0.5, 0.25}), d, {}, vec({0.125, 0}));
    for (const FclibForm form : {FclibForm::Given, FclibForm::Local}) {
      write_fclib(folder / "x.hdf5", {.problem = p}, form);
      const Problem back = read_fclib(folder / "x.hdf5").problem;
      EXPECT_EQ(back.dimension, d);
      EXPECT_EQ(back.mu, p.mu);
      EXPECT_EQ(back.mu_r, p.mu_r);
      EXPECT_EQ(back.global != nullptr, form == FclibForm::Given);
      EXPECT_EQ(Dense(back.W.matrix()), Dense(p.W.matrix()));
      EXPECT_EQ(back.q, p.q);
    }
  }
  Datasets both = small_local();
  both["/fclib_local_rolling/spacedim"] = Ints{3};
  EXPECT_THROW(parse_fclib(bytes_of(both), "x.hdf5"), FileError);
  Datasets without;
  for (const auto& [path, data] : small_local())
    without[path.starts_with("/fclib_local") ? "/fclib_local_rolling" + path.substr(12) : path] = data;
  EXPECT_THROW(parse_fclib(bytes_of(without), "x.hdf5"), FileError);  // no mu_r
  without["/fclib_local_rolling/vectors/mu_r"] = Doubles{0.1};
  EXPECT_THROW(parse_fclib(bytes_of(without), "x.hdf5"), FileError);  // 2 entries a contact
}

}  // namespace
}  // namespace perp::contact
