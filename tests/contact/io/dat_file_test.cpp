// SPDX-License-Identifier: Apache-2.0
#include "contact/io/dat_file.hpp"

#include <gmock/gmock.h>

#include <sstream>
#include <string>

#include "contact/contact_support.hpp"
#include "contact/refusal.hpp"

namespace perp::contact {
namespace {

using support::Dense;
using support::Random;
using support::vec;
using testing::HasSubstr;

std::string dat_error(const std::string& text) {
  return test::refusal_of([&] { parse_dat(text, "x.dat"); });
}

const std::string local_2d = "2\n1\n0\n2\n2\n2 2\n1 2\n3 4\n-5 6e0\n0.25\n";

/// Block rows of 2 and 2 rows, three blocks.
const std::string blocks_2d =
    "2 2 1 4 4 3 2 2\n2 4\n2 4\n3 3\n0 2 3\n0 1 1\n0 1 2 3 4\n1 5 6 7 8\n2 9 10 0 12\n-1 -2 -3 -4\n0.5 0.25\n0\n";

/// m = 2, one contact in 2D: M = diag(2, 4), H = [1 3; 2 4], f = (2, 4), w = (10, 20), mu = 0.5.
const std::string global_2d = "2 1\n0 2 2\n2 2\n2 0 0 4\n0 2 2\n2 2\n1 2 3 4\n2 4\n10 20\n0.5\n1\n";

// By columns, as the library that writes these files reads them. Catches a transposed W.
TEST(DatFile, Dense) {
  const Problem p = parse_dat(local_2d, "x.dat");
  EXPECT_EQ(p.dimension, 2);
  EXPECT_EQ(Dense(p.W.matrix()), (Dense(2, 2) << 1, 3, 2, 4).finished());
  EXPECT_EQ(p.q, vec({-5, 6}));
  EXPECT_EQ(p.mu, vec({0.25}));
  EXPECT_EQ(p.name, "x.dat");
  EXPECT_FALSE(p.global);
  EXPECT_EQ(Dense(parse_dat(local_2d + "1", "x").W.matrix()), Dense(p.W.matrix()));  // the flag
  EXPECT_EQ(parse_dat("3 0 0 0 0 0 0", "x").contacts(), 0);
}

// Blocks by columns at their places; zeros are not stored.
TEST(DatFile, Blocks) {
  const Problem p = parse_dat(blocks_2d, "x.dat");
  Dense W(4, 4);
  W << 1, 3, 5, 7, 2, 4, 6, 8, 0, 0, 9, 0, 0, 0, 10, 12;
  EXPECT_EQ(Dense(p.W.matrix()), W);
  EXPECT_EQ(p.W.matrix().nonZeros(), 11);
  EXPECT_EQ(p.q, vec({-1, -2, -3, -4}));
  // Trailing empty block rows may be left out of the list of starts.
  const Problem q = parse_dat("2 2 1 4 4 1 2 2\n2 4\n2 4\n2 1\n0 1\n1\n0 1 2 3 4\n-1 -2 -3 -4\n0.5 0.25", "x");
  EXPECT_EQ(Dense(q.W.matrix()).topRightCorner(2, 2), (Dense(2, 2) << 1, 3, 2, 4).finished());
  EXPECT_EQ(q.W.matrix().nonZeros(), 4);
}

// W = H' M^-1 H, q = H' M^-1 f + w by hand.
TEST(DatFile, Global) {
  const Problem p = parse_dat(global_2d, "x.dat");
  EXPECT_TRUE(Dense(p.W.matrix()).isApprox((Dense(2, 2) << 1.5, 3.5, 3.5, 8.5).finished(), 1e-15));
  EXPECT_TRUE(p.q.isApprox(vec({13, 27}), 1e-15));
  ASSERT_TRUE(p.global);
  EXPECT_EQ(p.global->f, vec({2, 4}));
  EXPECT_EQ(p.global->G.cols(), 0);
}

// The same problem in both storages.
TEST(DatFile, RecordedStoragesAgree) {
  SKIP_WITHOUT_RECORDED_PROBLEMS();
  const Problem dense = recorded("FC3D_Example1.dat");
  const Problem blocks = recorded("FC3D_Example1_SBM.dat");
  EXPECT_EQ(Dense(dense.W.matrix()), Dense(blocks.W.matrix()));
  EXPECT_EQ(dense.q, blocks.q);
  EXPECT_EQ(dense.mu, blocks.mu);
}

std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos);
  return text.replace(at, from.size(), to);
}

enum class Form { Full, Triplets, Columns };

/// The matrix as Siconos writes it (NM_write_in_file; CSparseMatrix_print_in_file), with all digits.
std::string written(const SpMat& A, Form form) {
  std::ostringstream out;
  out.precision(17);
  out << (form == Form::Full ? 0 : 2) << '\n' << A.rows() << '\n' << A.cols() << '\n';
  if (form == Form::Full) {
    out << A.rows() << '\t' << A.cols() << '\n';
    const Dense entries(A);
    for (const double a : entries.reshaped()) out << a << ' ';
    out << '\n';
    return out.str();
  }
  const bool columns = form == Form::Columns;
  out << (columns ? 2 : 1) << "\nCSparse Version 3.1.9, May 4, 2016.  Copyright (c) Timothy A. Davis, 2006-2016\n"
      << (columns ? "" : "triplet: ") << A.rows() << "-by-" << A.cols() << ", nzmax: " << A.nonZeros() + 1
      << " nnz: " << A.nonZeros() << (columns ? ", 1-norm: 7152.83\n" : "\n");
  for (Index j = 0; j < A.cols(); ++j) {
    const int* p = A.outerIndexPtr() + j;
    if (columns) out << "    col " << j << " : locations " << p[0] << " to " << p[1] - 1 << '\n';
    for (SpMat::InnerIterator it(A, j); it; ++it)
      out << "    " << it.row() << ' ' << (columns ? "" : std::to_string(j) + ' ') << ": " << it.value() << '\n';
  }
  return out.str();
}

std::string written(const Vec& v) {
  std::ostringstream out;
  out.precision(17);
  out << v.transpose() << '\n';
  return out.str();
}

std::string written(int d, const Vec& mu, const std::string& between) {
  return std::to_string(d) + '\n' + std::to_string(mu.size()) + '\n' + between + written(mu);
}

// Local and global problems in 2D and 3D, with and without contacts, are the same in every storage. Catches rows taken
// for columns, empty columns, a global problem that is taken for a local one.
TEST(DatFile, CompressedMatricesAreTheDenseOnes) {
  support::Random random(4);
  for (const int d : {2, 3})
    for (const Index n : {0, 1, 5})
      for (int k = 0; k < 5; ++k) {
        const Index m = 3 * random.integer(1, 4);
        const auto sparse = [&](Index rows, Index columns) {
          return support::sparse(
              Dense::NullaryExpr(rows, columns, [&] { return random.chance(0.4) ? random.normal() : 0; }));
        };
        const SpMat W = sparse(d * n, d * n);
        const Vec masses = Vec::NullaryExpr(m, [&] { return random.uniform(0.1, 10); });
        const SpMat M = support::sparse(Dense(masses.asDiagonal()));
        const SpMat H = sparse(m, d * n);
        const Vec q = random.normals(d * n);
        const Vec f = random.normals(m);
        const Vec mu = random.normals(n).cwiseAbs();
        std::vector<Problem> local;
        std::vector<Problem> global;
        for (const Form form : {Form::Full, Form::Triplets, Form::Columns}) {
          local.push_back(parse_dat(written(d, mu, written(W, form) + written(q)), "local"));
          const std::string matrices = written(M, form) + written(H, form);
          global.push_back(parse_dat(written(d, mu, matrices + written(f) + written(q)), "global"));
        }
        for (const Problem& p : local) {
          EXPECT_EQ(Dense(p.W.matrix()), Dense(W));
          EXPECT_EQ(p.q, q);
          EXPECT_EQ(p.mu, mu);
        }
        for (const Problem& p : global) {
          ASSERT_TRUE(p.global);
          EXPECT_EQ(Dense(p.global->M), Dense(M));
          EXPECT_EQ(Dense(p.global->H), Dense(H));
          EXPECT_EQ(p.q, global[0].q);
        }
      }
}

/// W = [1 3; 2 4] by columns.
const std::string columns_2d =
    written(2, vec({0.25}), written(support::matrix({{1, 3}, {2, 4}}), Form::Columns) + "-5 6\n");

TEST(DatFile, RefusesWhatIsNotCompressed) {
  EXPECT_EQ(dat_error(columns_2d), "");
  EXPECT_EQ(dat_error(with(columns_2d, "\n2\nCSparse", "\n3\nCSparse")),
            "x.dat:6: the form of a compressed matrix (1: triplets, 2: columns) is 3, not within 1 and 2");
  EXPECT_EQ(dat_error(with(columns_2d, "CSparse", "(null)")), "x.dat:7: '(null)' stands where 'CSparse' should be");
  EXPECT_EQ(dat_error(with(columns_2d, "2-by-2", "2-by-3")), "x.dat:8: '2-by-3,' stands where '2-by-2,' should be");
  EXPECT_EQ(dat_error(with(columns_2d, "col 1", "col 2")), "x.dat:12: the number of a column is 2, not within 1 and 1");
  EXPECT_EQ(dat_error(with(columns_2d, "locations 2", "locations 1")),
            "x.dat:12: the place of a column's first entry is 1, not within 2 and 2");
  EXPECT_EQ(dat_error(with(columns_2d, "to 1", "to 0")), "x.dat:11: '1' stands where 'col' should be");
  EXPECT_EQ(dat_error(with(columns_2d, " 1 : 4", " 2 : 4")), "x.dat:14: the row of an entry is 2, not within 0 and 1");
  EXPECT_EQ(dat_error(with(columns_2d, "1 : 4", "1 : inf")), "x.dat:14: the first matrix, W or M, has an entry inf");
  EXPECT_EQ(dat_error(with(columns_2d, "1 : 4", "1 :4")), "x.dat:14: ':4' stands where ':' should be");
  EXPECT_THAT(dat_error(with(with(columns_2d, "\n2\n2\n2\n", "\n2\n2000000000\n2\n"), "2-by", "2000000000-by")),
              HasSubstr("more than the rest of the file can hold"));
  const std::string triplets =
      written(2, vec({0.25}), written(support::matrix({{1, 3}, {2, 4}}), Form::Triplets) + "-5 6\n");
  EXPECT_EQ(dat_error(triplets), "");
  EXPECT_EQ(dat_error(with(triplets, "1 1 : 4", "1 2 : 4")),
            "x.dat:12: the column of a triplet is 2, not within 0 and 1");
  EXPECT_EQ(dat_error(with(triplets, "nnz: 4", "nnz: 5")), "x.dat:13: the row of a triplet is -5, not within 0 and 1");
  EXPECT_EQ(dat_error(with(triplets, "triplet:", "csr:")), "x.dat:8: 'csr:' stands where 'triplet:' should be");
}

// mu_r after mu, then the flag. Of one contact with 3 entries a lone 0 or 1 is the flag, as of 3D; what Siconos writes
// of mu_r has a point. Catches a local file of rolling friction that is taken for a global one.
TEST(DatFile, RollingFriction) {
  const std::string plane = "3\n1\n0\n3\n3\n3 3\n1 0 0 0 1 0 0 0 1\n-1 2 3\n0.5\n";
  EXPECT_FALSE(parse_dat(plane, "x").rolls());
  EXPECT_FALSE(parse_dat(plane + "1", "x").rolls());
  EXPECT_EQ(parse_dat(plane + "1.0", "x").mu_r, vec({1}));
  EXPECT_EQ(parse_dat(plane + "0.25", "x").mu_r, vec({0.25}));
  const Problem p = parse_dat(plane + "0.25 1", "x");
  EXPECT_EQ(p.mu, vec({0.5}));
  EXPECT_EQ(p.mu_r, vec({0.25}));
  EXPECT_EQ(p.space(), 2);
  EXPECT_FALSE(p.global);
  EXPECT_EQ(dat_error(plane + "-0.25"), "x.dat:10: the coefficient of rolling friction of contact 0 is -0.25");
  EXPECT_EQ(dat_error(plane + "0.25 2"), "x.dat:10: the flag at the end is 2, not within 0 and 1");

  Random random(8);
  for (const Index n : {1, 2, 3}) {
    const SpMat W = support::sparse(random.normals(5 * n, 5 * n));
    const Vec q = random.normals(5 * n);
    const Vec mu = random.normals(n).cwiseAbs();
    const Vec mu_r = random.normals(n).cwiseAbs();
    const std::string head = "5\n" + std::to_string(n) + "\n";
    const Problem local = parse_dat(head + written(W, Form::Full) + written(q) + written(mu) + written(mu_r), "x");
    EXPECT_EQ(Dense(local.W.matrix()), Dense(W));
    EXPECT_EQ(local.q, q);
    EXPECT_EQ(local.mu, mu);
    EXPECT_EQ(local.mu_r, mu_r);
    EXPECT_FALSE(local.global);
    const SpMat M = support::sparse(2 * Dense::Identity(5 * n, 5 * n));
    const Problem global = parse_dat(head + written(M, Form::Columns) + written(W, Form::Triplets) + written(q) +
                                         written(q) + written(mu) + written(mu_r) + "1",
                                     "x");
    ASSERT_TRUE(global.global);
    EXPECT_EQ(global.mu_r, mu_r);
    EXPECT_TRUE(Dense(global.W.matrix()).isApprox(0.5 * Dense(W.transpose() * W), 1e-14));
    EXPECT_THAT(dat_error(head + written(W, Form::Full) + written(q) + written(mu)), HasSubstr("mu_r"));
  }
}

TEST(DatFile, Refuses) {
  EXPECT_EQ(dat_error(""), "x.dat:1: the file ends where the dimension should be");
  EXPECT_EQ(dat_error("4 1"),
            "x.dat:1: the dimension is 4; contacts have 2 or 3 entries, with rolling friction 3 or 5");
  EXPECT_EQ(dat_error("6 1"), "x.dat:1: the dimension is 6, not within 2 and 5");
  EXPECT_EQ(dat_error("3 -1"), "x.dat:1: the number of contacts is -1, not within 0 and 715827882");
  EXPECT_THAT(dat_error("3 700000000 0 3 3"), HasSubstr("more than the rest of the file can hold"));
  EXPECT_EQ(dat_error("3 1 3 3 3"), "x.dat:1: the storage type is 3, not within 0 and 2");
  EXPECT_THAT(dat_error("2 1 0 2000000000 2 2 2"), HasSubstr("more than the rest of the file can hold"));
  EXPECT_EQ(dat_error(with(local_2d, "2 2", "2 3")),
            "x.dat:6: the second pair of sizes of the first matrix, W or M, differs from the first, 2 x 2");
  EXPECT_EQ(dat_error(with(local_2d, "3 4", "nan 4")), "x.dat:8: the first matrix, W or M, has an entry nan");
  EXPECT_EQ(dat_error(with(local_2d, "3 4", "inf 4")), "x.dat:8: the first matrix, W or M, has an entry inf");
  EXPECT_EQ(dat_error(with(local_2d, "-5", "x")), "x.dat:9: q: 'x' is not a number");
  EXPECT_EQ(dat_error(with(local_2d, "0.25", "-0.25")), "x.dat:10: the coefficient of friction of contact 0 is -0.25");
  EXPECT_EQ(dat_error(with(local_2d, "0.25", "")), "x.dat:11: the file ends where mu should be");
  EXPECT_EQ(dat_error(local_2d + "2"), "x.dat:11: the flag at the end is 2, not within 0 and 1");
  EXPECT_THAT(dat_error("2 1 0 2 1 2 1 1 2 3 4 0.5"), HasSubstr("W is 2 x 1, not 2 x 2"));
  EXPECT_THAT(dat_error(with(global_2d, "0 2 2\n2 2\n1", "0 2 1\n2 1\n1")), HasSubstr("H is 2 x 1, not 2 x 2"));
  EXPECT_THAT(dat_error(with(global_2d, "2 0 0 4", "2 0 0 0")), HasSubstr("the inertia M is singular"));
  EXPECT_THAT(dat_error(global_2d + " 7"), HasSubstr("1 numbers too many"));
  EXPECT_THAT(dat_error(with(blocks_2d, "\n2 4\n", "\n2 3\n")), HasSubstr("the last is 3, not 4"));
  EXPECT_THAT(dat_error(with(blocks_2d, "0 2 3", "0 2 2")), HasSubstr("the last block row ends at block 2, not at 3"));
  EXPECT_THAT(dat_error(with(blocks_2d, "0 2 3", "0 3 2")), HasSubstr("the first block of a block row is 2"));
  EXPECT_THAT(dat_error(with(blocks_2d, "0 1 1", "0 2 1")), HasSubstr("the block column of a block is 2"));
  EXPECT_THAT(dat_error(with(blocks_2d, "0 1 1", "1 1 1")), HasSubstr("two blocks in block column 1"));
  EXPECT_THAT(dat_error(with(blocks_2d, "\n1 5", "\n5 5")), HasSubstr("the blocks do not follow 0, 1, ..: 1"));
  EXPECT_THAT(dat_error(with(blocks_2d, "3 3\n", "3 4\n")), HasSubstr("is not that of the blocks, 3"));
}

// Cut off anywhere before its last number, with one exception that the format has: "0 2 2" of H, the matrix that makes
// a problem global, may as well be q and mu of a local one.
TEST(DatFile, CutShort) {
  for (const std::string& text : {local_2d, blocks_2d, global_2d, columns_2d}) {
    const std::size_t last = text.rfind("0.");
    for (std::size_t size = 0; size < last; ++size) {
      const std::string why = dat_error(text.substr(0, size));
      const std::string left = text.substr(0, size);
      const bool exception = left.ends_with("4\n0 2 2") || left.ends_with("4\n0 2 2\n");
      EXPECT_EQ(why.empty(), exception) << left;
    }
  }
}

}  // namespace
}  // namespace perp::contact
