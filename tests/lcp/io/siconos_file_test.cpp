// SPDX-License-Identifier: Apache-2.0
#include "lcp/io/siconos_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "lcp/pivoting/block_pivoting.hpp"
#include "lcp/pivoting/pivoting_support.hpp"
#include "lcp/pivoting/principal_pivoting.hpp"
#include "lcp/solve/enumeration.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::vec;
using testing::HasSubstr;

const std::filesystem::path shared = std::filesystem::path(PERP_SOURCE_DIR) / ".." / "shared" / "data";

AffineMcp recorded(const char* name) { return read_siconos_lcp((shared / "lcp" / name).string()).problem; }

#define SKIP_WITHOUT_DATA(folder) \
  if (!std::filesystem::exists(shared / (folder))) GTEST_SKIP() << "there is no " << (shared / (folder)).string()

std::string dat_error(const std::string& text, bool mlcp = false) {
  try {
    if (mlcp)
      parse_siconos_mlcp(text, "x.dat");
    else
      parse_siconos_lcp(text, "x.dat");
  } catch (const FileError& error) {
    return error.what();
  }
  return "read";
}

// By columns, as the library that writes these files reads them. Catches a transposed M.
TEST(SiconosFile, DenseLcpByColumns) {
  const SiconosLcp lcp = parse_siconos_lcp("2\n0\n2\n2\n2\t2\n1 2\n3 4e0\n-5 +6\n\nSome text, 1992\n", "x");
  Dense M(2, 2);
  M << 1, 3, 2, 4;
  EXPECT_EQ(Dense(lcp.problem.M), M);
  EXPECT_EQ(lcp.problem.q, vec({-5, 6}));
  EXPECT_EQ(lcp.problem.box.lower, Vec(Vec::Zero(2)));
  EXPECT_EQ(lcp.z.size(), 0);
  const SiconosLcp known = parse_siconos_lcp("1 0 1 1 1 1 2 -1 0.5 0", "x");
  EXPECT_EQ(known.z, vec({0.5}));
  EXPECT_EQ(known.w, vec({0}));
  EXPECT_EQ(parse_siconos_lcp("0 0 0 0 0 0", "x").problem.size(), 0);
}

// Storage 1, blocks of 1 and 2 rows (tests/contact/io/dat_file_test.cpp breaks such files in every place). Catches
// blocks at another's place, and a transposed one.
TEST(SiconosFile, BlockSparseLcp) {
  const std::string text = "3\n1\n3 3\n3\n2 2\n1 3\n1 3\n3 3\n0 2 3\n0 1 1\n0 1\n1 2 3\n2 4 5 0 7\n-1 -2 -3\n";
  const SiconosLcp lcp = parse_siconos_lcp(text, "x");
  Dense M(3, 3);
  M << 1, 2, 3, 0, 4, 0, 0, 5, 7;
  EXPECT_EQ(Dense(lcp.problem.M), M);
  EXPECT_EQ(lcp.problem.M.nonZeros(), 6);
  EXPECT_EQ(lcp.problem.q, vec({-1, -2, -3}));
  EXPECT_EQ(parse_siconos_lcp(text + "0 0 1 2 3 4", "x").w, vec({2, 3, 4}));
  EXPECT_EQ(dat_error("2\n1\n2 3"), "x.dat:3: M is 2 x 3, not 2 x 2");
  EXPECT_THAT(dat_error("3\n1\n3 3\n1\n1 1\n2\n3\n2 1\n0 1\n0\n0 1 2 3\n1 2 3"), HasSubstr("the last is 2, not 3"));
}

TEST(SiconosFile, RefusesBadLcps) {
  EXPECT_EQ(dat_error(""), "x.dat:1: the file ends where n should be");
  EXPECT_EQ(dat_error("-1 0"), "x.dat:1: n is -1, not within 0 and 2147483647");
  EXPECT_EQ(dat_error("1.5"), "x.dat:1: n is '1.5', not an integer");
  EXPECT_EQ(dat_error("99999999999999999999"), "x.dat:1: n is '99999999999999999999', not an integer");
  EXPECT_THAT(dat_error("2\n3\n2 2"), HasSubstr("the storage type is 3, not within 0 and 2"));
  EXPECT_EQ(dat_error("2\n0\n2 3 2 3"), "x.dat:3: M is 2 x 3, not 2 x 2");
  EXPECT_THAT(dat_error("2 0 2 2 2 1"), HasSubstr("differs from the first, 2 x 2"));
  EXPECT_THAT(dat_error("2000000000 0 2000000000 2000000000 2000000000 2000000000 1 2"),
              HasSubstr("more than the rest"));
  EXPECT_EQ(dat_error("1\n0\n1 1\n1 1\nnan\n1"), "x.dat:5: M has an entry nan");
  EXPECT_EQ(dat_error("1\n0\n1 1\n1 1\n1e999\n1"), "x.dat:5: M has an entry 1e999");
  EXPECT_EQ(dat_error("1\n0\n1 1\n1 1\n1\n-inf"), "x.dat:6: q has an entry -inf");
  EXPECT_EQ(dat_error("1\n0\n1 1\n1 1\n1x\n1"), "x.dat:5: M: '1x' is not a number");
  EXPECT_THAT(dat_error("1\n0\n1 1\n1 1\n1\n"), HasSubstr("x.dat:6: the file ends where q should be"));
  EXPECT_EQ(dat_error("2 0 2 2 2 2 1 2 3 4\n5 \n       "), "x.dat:3: the file ends where q should be");
  EXPECT_EQ(dat_error("1 0 1 1 1 1 2 -1\n7"), "x.dat:2: 1 numbers after the problem, neither none nor a solution of 2");
  EXPECT_EQ(dat_error("1 0 1 1 1 1 2 -1 text"), "x.dat:1: 'text' after the last number on its line");
  EXPECT_EQ(dat_error("1 0 1 1 1 1 2 -1\ntext"), "read");
}

// n = 1, m = 2, every entry different: M by columns, A .. D by rows.
const char* const both = R"(1
1
1
2
0 1 3
0 1
0
3
3
3	3
1 2 3
4 5 6
7 8 9
-1 -2 -3
1
5 8
6 9
4 7
2
3
-1
-2 -3 0.000 3.000 5.000 0.000 )";

TEST(SiconosFile, MlcpInBothForms) {
  const SiconosMlcp file = parse_siconos_mlcp(both, "x");
  const Mlcp& p = file.mlcp;
  EXPECT_EQ(Dense(p.A), Dense::Constant(1, 1, 1));
  EXPECT_EQ(Dense(p.C), Dense(vec({4, 7}).transpose()));
  EXPECT_EQ(Dense(p.D), Dense(vec({2, 3})));
  Dense B(2, 2);
  B << 5, 8, 6, 9;
  EXPECT_EQ(Dense(p.B), B);
  EXPECT_EQ(p.a, vec({-1}));
  EXPECT_EQ(p.b, vec({-2, -3}));
  EXPECT_EQ(file.v, vec({0, 3}));
  EXPECT_EQ(file.w, vec({5, 0}));
  // The blocks alone.
  const SiconosMlcp blocks = parse_siconos_mlcp("0 1 1 2\n1\n5 8\n6 9\n4 7\n2\n3\n-1\n-2 -3", "x");
  EXPECT_EQ(Dense(to_affine(blocks.mlcp).M), Dense(to_affine(p).M));
  EXPECT_EQ(to_affine(blocks.mlcp).q, to_affine(p).q);
}

// Conditions before and between the equations: the blocks are gathered. M(i, j) = 10 i + j (from 1).
TEST(SiconosFile, InterleavedBlocks) {
  const SiconosMlcp file =
      parse_siconos_mlcp("1 0 2 1\n0 1 2 3\n0 1 0\n0 3 3 3 3\n11 21 31\n12 22 32\n13 23 33\n1 2 3\n", "x");
  EXPECT_EQ(file.equations, (std::vector<Index>{0, 2}));
  EXPECT_EQ(file.conditions, (std::vector<Index>{1}));
  Dense A(2, 2);
  A << 11, 13, 31, 33;
  EXPECT_EQ(Dense(file.mlcp.A), A);
  EXPECT_EQ(Dense(file.mlcp.C), Dense(vec({12, 32})));
  EXPECT_EQ(Dense(file.mlcp.D), Dense(vec({21, 23}).transpose()));
  EXPECT_EQ(file.mlcp.B.coeff(0, 0), 22);
  EXPECT_EQ(file.mlcp.a, vec({1, 3}));
  EXPECT_EQ(file.mlcp.b, vec({2}));
}

TEST(SiconosFile, RefusesBadMlcps) {
  const auto with = [](const std::string& old, const std::string& text) {
    std::string changed = both;
    changed.replace(changed.find(old), old.size(), text);
    return dat_error(changed, true);
  };
  EXPECT_EQ(with("1", "1"), "read");
  EXPECT_EQ(dat_error("0 0 1 1", true), "x.dat:1: both storage flags are 0: there is no problem");
  EXPECT_EQ(dat_error("2 0", true), "x.dat:1: the first storage flag is 2, not within 0 and 1");
  EXPECT_THAT(dat_error("1 1 1000000000 1000000000", true), HasSubstr("more than the rest of the file can hold"));
  EXPECT_EQ(with("0 1 3\n", "0 2 3\n"), "x.dat:6: the blocks have 2 equations for 1 free unknowns");
  EXPECT_EQ(with("0 1 3\n", "1 3\n"), "x.dat:5: the first block's first row is 1, not within 0 and 0");
  EXPECT_EQ(with("0 1 3\n", "0 1 1 3\n"), "x.dat:5: a block's first row is 1, not within 2 and 3");
  EXPECT_EQ(with("0 1 3\n", "0 1 4\n"), "x.dat:5: a block's first row is 4, not within 2 and 3");
  EXPECT_EQ(with("0 1\n", "0 2\n"), "x.dat:6: a block's type is 2, not within 0 and 1");
  EXPECT_THAT(with("3\n3\n3\t3", "4\n3\n4\t3"), HasSubstr("M is 4 x 3: 1 equations more than unknowns"));
  EXPECT_EQ(with("6 9\n4 7", "6 9\n4 7.5"), "x.dat:18: C(1, 2) is 7.5, but (M, q) has 7 there");
  EXPECT_EQ(with("-2 -3 0.000", "-2 -4 0.000"), "x.dat:22: b(2) is -4, but (M, q) has -3 there");
  EXPECT_THAT(with("5.000 0.000", "5.000"), HasSubstr("3 numbers after the problem, neither none nor a solution of 5"));
  EXPECT_THAT(with("\n-2 -3 0.000 3.000 5.000 0.000", ""), HasSubstr("b has 2 x 1 entries, more than the rest"));
}

// Without u no number of it can be missing: the one after the problem cannot be the end of (v, w), which was read from
// before the beginning of the list.
TEST(SiconosFile, KnownSolutionWithoutFreeUnknowns) {
  EXPECT_EQ(dat_error("0 1 0 1 1 7 0", true), "x.dat:1: 1 numbers after the problem, neither none nor a solution of 2");
  EXPECT_EQ(parse_siconos_mlcp("0 1 0 1 1 -7 7 0", "x").v, vec({7}));
}

// M by blocks, which MLCPs may have as well: u first, then v.
TEST(SiconosFile, BlockSparseMlcp) {
  const SiconosMlcp file =
      parse_siconos_mlcp("1 0 1 1\n0 1 2\n0 1\n1 2 2\n1\n1 1\n2\n2\n2 1\n0 1\n0\n0 1 2 3 4\n5 6\n", "x");
  EXPECT_EQ(file.mlcp.A.coeff(0, 0), 1);
  EXPECT_EQ(file.mlcp.D.coeff(0, 0), 2);
  EXPECT_EQ(file.mlcp.C.coeff(0, 0), 3);
  EXPECT_EQ(file.mlcp.B.coeff(0, 0), 4);
}

TEST(SiconosFile, NoSuchFile) {
  EXPECT_THROW(read_siconos_lcp("/nonexistent/x.dat"), FileError);
  EXPECT_THROW(read_siconos_mlcp(PERP_SOURCE_DIR), FileError);
}

void expect_solutions(const char* name, const std::vector<Vec>& isolated, int continua) {
  SCOPED_TRACE(name);
  const AffineMcp problem = recorded(name);
  const Solutions all = enumerate(problem);
  EXPECT_TRUE(all.complete) << all.message;
  int found = 0;
  for (const Solution& s : all.found) {
    EXPECT_LE(support::violation(problem, s.z), 2e-9 * (1 + norm_inf(problem.q)));
    if (s.dimension > 0)
      --continua;
    else
      ++found;
  }
  EXPECT_EQ(continua, 0);
  EXPECT_EQ(found, static_cast<int>(isolated.size()));
  for (const Vec& z : isolated)
    EXPECT_TRUE(std::any_of(all.found.begin(), all.found.end(), [&](const Solution& s) {
      return s.dimension == 0 && norm_inf(s.z - z) < 1e-10;
    })) << z.transpose();
}

// The recorded LCPs with solutions by hand: the examples of Cottle, Pang & Stone (2009), Pang's isolated solution (1,
// 0, 0), unstable: a perturbed q has none.
TEST(SiconosFile, RecordedLcpsInFull) {
  SKIP_WITHOUT_DATA("lcp");
  expect_solutions("lcp_CPS_1.dat", {}, 1);                // the segment z_1 + z_2 = 1
  expect_solutions("lcp_CPS_2.dat", {vec({0, 1, 3})}, 0);  // example 4.4.7
  expect_solutions("lcp_CPS_3.dat", {vec({0.1, 0, 0.1, 0}), vec({0, 1, 0, 1}) / 15, vec({1, 4, 1, 4}) / 90}, 0);
  expect_solutions("lcp_CPS_5.dat", {}, 1);  // the ray z_2 = z_1 + 1
  expect_solutions("lcp_Pang_isolated_sol.dat", {vec({1, 0, 0})}, 0);
  expect_solutions("lcp_deudeu.dat", {vec({4, 7}) / 3}, 0);
  expect_solutions("lcp_exp_murty.dat", {vec({0, 0, 0, 0, 0, 1})}, 0);
  const AffineMcp perturbed = recorded("lcp_Pang_isolated_sol_perturbed.dat");
  const Result none = enumeration(perturbed, Vec::Zero(3));
  EXPECT_EQ(none.status, Status::Infeasible);
  EXPECT_THAT(none.message, HasSubstr("all 2^3 cells examined"));
  EXPECT_TRUE(proves_infeasible(perturbed, Vec::Unit(3, 0)));
}

// n = 9, on which another enumeration fails; n = 26, positive definite with entries from 1e-1 to 1e5.
TEST(SiconosFile, RecordedLcpsThatAreHard) {
  SKIP_WITHOUT_DATA("lcp");
  const AffineMcp fails = recorded("lcp_enum_fails.dat");
  ASSERT_EQ(fails.size(), 9);
  const Solutions all = enumerate(fails);
  EXPECT_TRUE(all.complete) << all.message;
  for (const Solution& s : all.found) {
    EXPECT_LT(support::violation(fails, s.z), 1e-9);
    EXPECT_EQ(s.dimension, 0);
  }
  EXPECT_EQ(all.found.size(), 1U);
  const AffineMcp mmc = recorded("lcp_mmc.dat");
  ASSERT_EQ(mmc.size(), 26);
  for (const Result& result :
       {block_pivoting(mmc, Vec::Zero(26)), block_pivoting(mmc, Vec::Zero(26), {.p_max = 0, .components = false}),
        principal_pivoting(mmc, Vec::Zero(26))})
    expect_solved(mmc, result, "mmc");
}

// The recorded MLCPs, by enumeration: as an affine MCP, reduced where A is regular (not in the diode bridges), against
// the solutions in the files (those of PD and diodeBridge20 belong to other data).
TEST(SiconosFile, RecordedMlcps) {
  SKIP_WITHOUT_DATA("mlcp");
  for (const std::string name : {"PD", "RCD", "deudeu", "diodeBridge", "diodeBridge20", "m2n1", "relay2"}) {
    SCOPED_TRACE(name);
    const SiconosMlcp file = read_siconos_mlcp((shared / "mlcp" / (name + "_mlcp.dat")).string());
    const bool of_another = name == "PD" || name == "diodeBridge20";
    const Mlcp& p = file.mlcp;
    const AffineMcp direct = to_affine(p);
    const Result d = enumeration(direct, Vec::Zero(direct.size()));
    expect_solved(direct, d, "direct");
    const MlcpPoint point = from_affine(p, d.z);
    EXPECT_LT(residual(p, point), 1e-9);
    const SchurReduction schur(p);
    const bool bridge = of_another || name == "diodeBridge";
    EXPECT_EQ(to_string(schur.status()), bridge ? "singular" : "ok");
    if (!bridge) {
      const Result r = enumeration(schur.problem(), Vec::Zero(p.b.size()));
      expect_solved(schur.problem(), r, "reduced");
      EXPECT_LT(residual(p, schur.recover(r.z)), 1e-9);
      EXPECT_LT(norm_inf(r.z - point.v), 1e-9);
    }
    EXPECT_EQ(file.v.size(), name == "RCD" ? 0 : p.b.size());
    if (file.v.size() > 0 && !of_another) {
      EXPECT_LT(norm_inf(point.v - file.v), 1e-3);
      EXPECT_LT(norm_inf(point.w - file.w), 1e-3);
    }
  }
  const std::string rectangular = (shared / "mlcp" / "Rectangular_mlcp.dat").string();
  try {
    read_siconos_mlcp(rectangular);
    ADD_FAILURE() << "read";
  } catch (const FileError& error) {
    EXPECT_EQ(error.what(), rectangular + ":9: M is 3 x 2: 1 equations more than unknowns");
  }
}

}  // namespace
}  // namespace perp::lcp
