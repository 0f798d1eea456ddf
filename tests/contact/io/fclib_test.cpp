// SPDX-License-Identifier: Apache-2.0
#include "contact/io/fclib.hpp"

#include <gmock/gmock.h>
#include <gmpxx.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <optional>
#include <tuple>

#include "contact/contact_support.hpp"
#include "contact/existence/infeasible.hpp"
#include "contact/io/fclib_support.hpp"
#include "contact/model/residual.hpp"
#include "contact/refusal.hpp"

namespace perp::contact {
namespace {

using lcp::FileError;
using support::Dense;
using support::Random;
using support::vec;
using testing::HasSubstr;

Fclib parse(const Datasets& datasets) { return parse_fclib(bytes_of(datasets), "x.hdf5"); }

Dense dense(std::initializer_list<double> by_rows) {
  Dense A(2, 2);
  std::copy(by_rows.begin(), by_rows.end(), A.reshaped<Eigen::RowMajor>().begin());
  return A;
}

// Compressed rows; the arrays are longer than what p says. Catches rows taken for columns (W is made unsymmetric here)
// and a look at entries beyond p[last], which here are out of range.
TEST(Fclib, Local) {
  Datasets file = small_local();
  file["/fclib_local/W/x"] = Doubles{2, 7, 1, 3, 0, 0};
  const Fclib f = parse(file);
  EXPECT_EQ(f.problem.dimension, 2);
  EXPECT_EQ(Dense(f.problem.W.matrix()), dense({2, 7, 1, 3}));
  EXPECT_EQ(f.problem.q, vec({-1, 4}));
  EXPECT_EQ(f.problem.mu, vec({0.5}));
  EXPECT_EQ(f.problem.name, "x.hdf5");
  EXPECT_EQ(f.title, "a title");
  EXPECT_EQ(f.description, "");
  ASSERT_TRUE(f.solution);
  EXPECT_EQ(f.solution->r, vec({1, -0.5}));
  EXPECT_EQ(f.solution->u, vec({0.5, 3}));
  EXPECT_EQ(f.solution->v.size(), 0);
  ASSERT_EQ(f.guesses.size(), 1U);
  EXPECT_EQ(f.guesses[0].r, vec({0.25, 0}));
}

TEST(Fclib, CompressedColumns) {
  Datasets file = small_local();
  file["/fclib_local/W/nz"] = Ints{-1};
  file["/fclib_local/W/x"] = Doubles{2, 7, 1, 3, 0, 0};
  EXPECT_EQ(Dense(parse(file).problem.W.matrix()), dense({2, 1, 7, 3}));
}

// p is the column, i the row, whatever the library's header says; equal places add up.
TEST(Fclib, Triplets) {
  const Problem p = parse(small_global()).problem;
  ASSERT_TRUE(p.global);
  EXPECT_EQ(Dense(p.global->H), dense({1, 3, 2, 4}));
  EXPECT_EQ(Dense(p.global->M), dense({2, 0, 0, 4}));
  EXPECT_TRUE(Dense(p.W.matrix()).isApprox(dense({1.5, 3.5, 3.5, 8.5}), 1e-15));
  EXPECT_TRUE(p.q.isApprox(vec({13, 27}), 1e-15));
}

// G' v + b = 0 with G = (1, 0), b = -3 fixes v_1 = 3: W = H_2' H_2 / 4, q = H' (3, f_2 / 4) + w.
TEST(Fclib, GlobalWithConstraints) {
  Datasets file = small_global();
  file["/fclib_global/G/m"] = Ints{2};
  file["/fclib_global/G/n"] = Ints{1};
  file["/fclib_global/G/nzmax"] = Ints{1};
  file["/fclib_global/G/nz"] = Ints{-1};
  file["/fclib_global/G/p"] = Ints{0, 1};
  file["/fclib_global/G/i"] = Ints{0};
  file["/fclib_global/G/x"] = Doubles{1};
  file["/fclib_global/vectors/b"] = Doubles{-3};
  file["/solution/l"] = Doubles{7};
  const Fclib f = parse(file);
  EXPECT_TRUE(Dense(f.problem.W.matrix()).isApprox(dense({1, 2, 2, 4}), 1e-14));
  EXPECT_TRUE(f.problem.q.isApprox(vec({15, 33}), 1e-14));
  EXPECT_EQ(f.solution->l, vec({7}));
}

/// V = (V_N, 0)', R and s of one constraint.
void add_constraint(Datasets& file, double V_N, double R, double s) {
  for (const auto& [name, rows, value] : {std::tuple{"V", 2, V_N}, {"R", 1, R}}) {
    const std::string path = std::string("/fclib_local/") + name;
    file[path + "/m"] = Ints{rows};
    file[path + "/n"] = Ints{1};
    file[path + "/nzmax"] = Ints{1};
    file[path + "/nz"] = Ints{1};
    file[path + "/p"] = Ints{0};
    file[path + "/i"] = Ints{0};
    file[path + "/x"] = Doubles{value};
  }
  file["/fclib_local/vectors/s"] = Doubles{s};
}

// u = W r + V lambda + q with V' r + R lambda + s = 0: V = (1, 0)', R = -2, s = 6 gives lambda = r_N / 2 + 3.
TEST(Fclib, LocalWithConstraints) {
  Datasets file = small_local();
  add_constraint(file, 1, -2, 6);
  const Problem p = parse(file).problem;
  EXPECT_TRUE(Dense(p.W.matrix()).isApprox(dense({2.5, 1, 1, 3}), 1e-15));
  EXPECT_TRUE(p.q.isApprox(vec({2, 4}), 1e-15));
  file["/fclib_local/R/x"] = Doubles{0};
  EXPECT_THROW(parse(file), FileError);
}

/// W = diag(4 - gap, 3) less V R^-1 V' = diag(4, 0), q = (q_N, 4) less (2, 0).
Problem held_local(double gap, double q_N) {
  Datasets file = small_local();
  add_constraint(file, 6. / 7, 9. / 49, 3. / 7);
  file["/fclib_local/W/x"] = Doubles{4 - gap, 0, 0, 3, 0, 0};
  file["/fclib_local/vectors/q"] = Doubles{q_N, 4};
  return parse(file).problem;
}

// W_NN and q_N are what is left of numbers that cancel: to twice the precision they are not 0, but what the rounding of
// 6 / 7, 9 / 49 and 3 / 7 has left. Catches entries and a q that are taken away in doubles: impulses of 1e15 moved what
// does not move, and were called solutions.
TEST(Fclib, LocalConstraintsKeepWhatCancels) {
  const mpq_class V(6. / 7);
  const mpq_class R(9. / 49);
  const mpq_class s(3. / 7);
  for (const double gap : {0.0, 0x1p-49, -0x1p-48}) {
    const Problem p = held_local(gap, 2);
    const double q_N = mpq_class(2 - V * s / R).get_d();
    const double u_N = mpq_class(1e15 * (4 - gap - V * V / R) + mpq_class(p.q[0])).get_d();
    EXPECT_NEAR(p.q[0], q_N, 1e-12 * std::abs(q_N)) << gap;
    EXPECT_NEAR(velocities(p, vec({1e15, 0}))[0], u_N, 1e-12 * std::abs(u_N)) << gap;
  }
  const Problem p = held_local(0, 1);  // what is left of W_NN moves the contact by less than 1e-15
  for (const double r_N : {1e10, 1e13, 1e14}) EXPECT_FALSE(accepted(residual(p, vec({r_N, 0})), 1e-8)) << r_N;
}

// V = (2, 3), R = [3 1; 2 1], of which W_NN = 13 and q_N = 17 cancel: what is left is rounding, or as little as that,
// and r = 0 solves it if it is none. Catches an elimination that is taken for exact.
TEST(Fclib, RoundedConstraintsProveNothing) {
  Datasets file = small_local();
  for (const char* name : {"V", "R"}) {
    const std::string path = std::string("/fclib_local/") + name;
    file[path + "/m"] = Ints{2};
    file[path + "/n"] = Ints{2};
    file[path + "/nzmax"] = Ints{4};
    file[path + "/nz"] = Ints{-2};
    file[path + "/p"] = name[0] == 'V' ? Ints{0, 2, 2} : Ints{0, 2, 4};
    file[path + "/i"] = name[0] == 'V' ? Ints{0, 1} : Ints{0, 1, 0, 1};
    file[path + "/x"] = name[0] == 'V' ? Doubles{2, 3} : Doubles{3, 1, 2, 1};
  }
  file["/fclib_local/W/x"] = Doubles{13, 0, 0, 3, 0, 0};
  file["/fclib_local/vectors/s"] = Doubles{8, 7};
  file["/fclib_local/vectors/q"] = Doubles{17 - 1e-12, 4};
  file["/fclib_local/vectors/mu"] = Doubles{0};
  Problem p = parse(file).problem;
  p.W.given().coeffRef(0, 0) = 0;
  EXPECT_NEAR(p.q[0], 0, 2e-12);
  EXPECT_EQ(infeasibility_radius(p, vec({1})), 0);
  EXPECT_FALSE(find_infeasibility(p).has_value());
  p.rounding = {};
  EXPECT_GT(infeasibility_radius(p, vec({1})), 0);
}

// Other widths and byte orders, data within the object header.
TEST(Fclib, OtherTypesAndLayouts) {
  Datasets file = small_local();
  file["/fclib_local/W/p"] = Longs{0, 2, 4};
  file["/fclib_local/vectors/mu"] = Floats{0.5};
  file.erase("/fclib_local/vectors/q");
  const Folder folder;
  {
    RawFile raw(folder / "a.hdf5");
    raw.write(file);
    raw.write("/fclib_local/vectors/q", Doubles{-1, 4}, Storage::Compact);
  }
  const Problem p = read_fclib(folder / "a.hdf5").problem;
  EXPECT_EQ(Dense(p.W.matrix()), dense({2, 1, 1, 3}));
  EXPECT_EQ(p.q, vec({-1, 4}));
  EXPECT_EQ(p.mu, vec({0.5}));
}

// Recorded files announce /solution/v and store nothing: HDF5 would give zeros.
TEST(Fclib, WhatWasNeverWrittenIsNotThere) {
  const Folder folder;
  {
    RawFile raw(folder / "a.hdf5");
    Datasets file = small_local();
    file.erase("/solution/r");
    raw.write(file);
    raw.write("/solution/r", Doubles{1, 2}, Storage::NeverWritten);
  }
  const Fclib f = read_fclib(folder / "a.hdf5");
  EXPECT_EQ(f.solution->r.size(), 0);
  EXPECT_EQ(f.solution->u.size(), 2);
}

// --- refusals --------------------------------------------------------------------------------------------------------

std::string why_not(const Datasets& datasets) {
  return test::refusal_of([&] { parse(datasets); });
}

std::string why_not_with(const std::string& path, const Datasets::mapped_type& values) {
  Datasets file = path.starts_with("/fclib_global") ? small_global() : small_local();
  file[path] = values;
  return why_not(file);
}

TEST(Fclib, RefusesWrongValues) {
  const std::string l = "/fclib_local/";
  const std::string g = "/fclib_global/";
  EXPECT_EQ(why_not(small_local()), "");
  EXPECT_EQ(why_not_with(l + "vectors/mu", Doubles{-0.1}),
            "x.hdf5: /fclib_local/vectors/mu: entry 0 is -0.1, a coefficient of friction below 0");
  EXPECT_EQ(why_not_with(l + "vectors/mu", Doubles{0.5, 0.5}),
            "x.hdf5: /fclib_local/vectors/q: has 2 entries, not 4: spacedim for each entry of mu");
  EXPECT_EQ(why_not_with(l + "vectors/q", Doubles{1, NAN}), "x.hdf5: /fclib_local/vectors/q: entry 1 is nan");
  EXPECT_EQ(why_not_with(l + "W/x", Doubles{2, 1, INFINITY, 3}), "x.hdf5: /fclib_local/W: x[2] is inf");
  EXPECT_EQ(why_not_with(l + "spacedim", Ints{4}), "x.hdf5: /fclib_local/spacedim: is 4, not within 2 and 3");
  EXPECT_EQ(why_not_with(l + "spacedim", Ints{2, 2}), "x.hdf5: /fclib_local/spacedim: has 2 entries, not one");
  EXPECT_EQ(why_not_with(l + "spacedim", Doubles{2}),
            "x.hdf5: /fclib_local/spacedim: is of another type than 32- or 64-bit integers");
  EXPECT_EQ(why_not_with(l + "W/x", Ints{2, 1, 1, 3}),
            "x.hdf5: /fclib_local/W/x: is of another type than 32- or 64-bit floating point");
  EXPECT_EQ(why_not_with(l + "W/m", Ints{3}), "x.hdf5: /fclib_local/W: m x n is 3 x 2, but the vectors make it 2 x 2");
  EXPECT_THAT(why_not_with(l + "W/n", Ints{2000000000}), HasSubstr("m x n is 2 x 2000000000"));
  EXPECT_EQ(why_not_with(l + "W/nz", Ints{-3}), "x.hdf5: /fclib_local/W/nz: is -3, not within -2 and 2147483647");
  EXPECT_THAT(why_not_with(l + "W/nz", Ints{2000000000}), HasSubstr("/fclib_local/W: p has 3 entries, not 2000000000"));
  EXPECT_THAT(why_not_with(l + "W/nzmax", Ints{3}), HasSubstr("nzmax is 3, below the number of entries, 4"));
  EXPECT_THAT(why_not_with(l + "W/p", Ints{0, 2}), HasSubstr("p has 2 entries, not 3"));
  EXPECT_THAT(why_not_with(l + "W/p", Ints{1, 2, 4}), HasSubstr("p[0] is 1, not 0"));
  EXPECT_THAT(why_not_with(l + "W/p", Ints{0, 3, 2}), HasSubstr("p[2] is 2, below p[1] = 3"));
  EXPECT_THAT(why_not_with(l + "W/p", Ints{0, 2, 7}), HasSubstr("i has 6 entries, not 7"));
  EXPECT_THAT(why_not_with(l + "W/p", Longs{0, 2, 1LL << 62}), HasSubstr("i has 6 entries, not 4611686018427387904"));
  EXPECT_THAT(why_not_with(l + "W/i", Ints{0, 2, 0, 1}), HasSubstr("i[1] is 2, not within 0 and 1"));
  EXPECT_THAT(why_not_with(l + "W/i", Ints{0, 1, -1, 1}), HasSubstr("i[2] is -1, not within 0 and 1"));
  EXPECT_THAT(why_not_with(g + "H/p", Ints{0, 0, 1, 1, 2}), HasSubstr("p[4] is 2, not within 0 and 1"));
  EXPECT_THAT(why_not_with(g + "M/x", Doubles{2, 0}),
              HasSubstr("/fclib_global: condensation: the inertia M is singular"));
  EXPECT_THAT(why_not_with(g + "vectors/f", Doubles{1, 2, 3}), HasSubstr("/fclib_global/M: m x n is 2 x 2"));
  EXPECT_THAT(why_not_with("/solution/r", Doubles{1, 2, 3}), HasSubstr("/solution/r: has 3 entries, not 2"));
  EXPECT_THAT(why_not_with("/solution/r", Doubles{1, NAN}), HasSubstr("/solution/r: entry 1 is nan"));
  EXPECT_THAT(why_not_with("/guesses/number_of_guesses", Ints{2000000000}), HasSubstr("/guesses/2: is missing"));
}

// Each dataset by itself. The optional ones are told from the others by name here.
TEST(Fclib, RefusesMissingDatasets) {
  for (const Datasets& whole : {small_local(), small_global()})
    for (const auto& [path, values] : whole) {
      Datasets file = whole;
      file.erase(path);
      if (path.starts_with("/fclib_local/info") || path.starts_with("/solution") || path == "/guesses/1/r")
        EXPECT_THAT(why_not(file), testing::AnyOf("", HasSubstr("/guesses/1: is missing"))) << path;
      else
        EXPECT_THAT(why_not(file), HasSubstr(path + ": is missing")) << path;
    }
  EXPECT_THAT(why_not({{"/something", Ints{1}}}), HasSubstr("has neither /fclib_local nor /fclib_global"));
  Datasets both = small_local();
  both.merge(small_global());
  EXPECT_THAT(why_not(both), HasSubstr("has both /fclib_local and /fclib_global"));
}

/// Of the small local problem with q as told.
template <class Make>
std::string why_not_q(Make make) {
  const Folder folder;
  {
    Datasets file = small_local();
    file.erase("/fclib_local/vectors/q");
    RawFile raw(folder / "a.hdf5");
    raw.write(file);
    make(raw);
  }
  return test::refusal_of([&] { read_fclib(folder / "a.hdf5"); });
}

// Links could lead to any file of the reader's, external storage to its bytes.
TEST(Fclib, RefusesOtherStorage) {
  const std::string q = "/fclib_local/vectors/q";
  const auto stored = [&](Storage as) { return why_not_q([&](RawFile& raw) { raw.write(q, Doubles{-1, 4}, as); }); };
  EXPECT_EQ(stored(Storage::Contiguous), "");
  EXPECT_THAT(stored(Storage::Chunked), HasSubstr("h5repack"));
  EXPECT_THAT(stored(Storage::Compressed), HasSubstr("compressed"));
  EXPECT_THAT(stored(Storage::TwoDimensions), HasSubstr(q + ": has 2 dimensions, not one"));
  EXPECT_THAT(stored(Storage::NeverWritten), HasSubstr(q + ": has 2 entries, more than the file holds"));
  EXPECT_THAT(why_not_q([&](RawFile& raw) { raw.groups(q + "/"); }), HasSubstr(q + ": is no dataset"));
  EXPECT_THAT(why_not_q([&](RawFile& raw) {
                H5Lcreate_soft("/fclib_local/vectors/mu", raw.id(), q.c_str(), H5P_DEFAULT, H5P_DEFAULT);
              }),
              HasSubstr(q + ": is a symbolic or external link"));
  EXPECT_THAT(why_not_q([&](RawFile& raw) {
                H5Lcreate_external("other.hdf5", "/q", raw.id(), q.c_str(), H5P_DEFAULT, H5P_DEFAULT);
              }),
              HasSubstr("a group of the newer kind"));
  EXPECT_THAT(why_not_q([&](RawFile& raw) {
                const hsize_t size = 2;
                const hid_t space = H5Screate_simple(1, &size, nullptr);
                const hid_t made = H5Pcreate(H5P_DATASET_CREATE);
                H5Pset_external(made, "/etc/hostname", 0, 16);
                H5Dclose(H5Dcreate2(raw.id(), q.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT, made, H5P_DEFAULT));
                H5Pclose(made);
                H5Sclose(space);
              }),
              HasSubstr("another file"));
}

// --- writing ---------------------------------------------------------------------------------------------------------

/// In every bit.
bool same(const double* a, const double* b, Index size) {
  return size == 0 || std::memcmp(a, b, sizeof(double) * static_cast<std::size_t>(size)) == 0;
}

void expect_same(const SpMat& A, const SpMat& B) {
  ASSERT_EQ(A.rows(), B.rows());
  ASSERT_EQ(A.cols(), B.cols());
  ASSERT_EQ(A.nonZeros(), B.nonZeros());
  EXPECT_TRUE(std::equal(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros(), B.innerIndexPtr()));
  EXPECT_TRUE(same(A.valuePtr(), B.valuePtr(), A.nonZeros()));
}

void expect_same(const Vec& a, const Vec& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_TRUE(same(a.data(), b.data(), a.size()));
}

// Bit for bit, with stored zeros, signs of zero, denormal numbers; the same problem gives the same bytes.
TEST(Fclib, WritesWhatItReads) {
  const Folder folder;
  Random random(21);
  for (int k = 0; k < 30; ++k) {
    Fclib f;
    f.problem.dimension = k % 2 == 0 ? 2 : 3;
    const Index n = k / 5;
    const Index rows = f.problem.dimension * n;
    f.problem.W = support::from(rows, support::scatter(rows, 2, random));
    if (f.problem.W.matrix().nonZeros() > 2) {
      f.problem.W.given().valuePtr()[0] = -0.0;
      f.problem.W.given().valuePtr()[1] = 5e-324;
    }
    f.problem.q = random.normals(rows);
    f.problem.mu = random.normals(n).cwiseAbs();
    f.title = "title";
    f.description = std::string(1000, 'd');
    f.solution = FclibPoint{.r = random.normals(rows)};
    f.guesses.assign(3, FclibPoint{.u = random.normals(rows), .r = random.normals(rows)});
    write_fclib(folder / "a.hdf5", f);
    const Fclib g = read_fclib(folder / "a.hdf5");
    EXPECT_EQ(g.problem.dimension, f.problem.dimension);
    expect_same(g.problem.W.matrix(), f.problem.W.matrix());
    expect_same(g.problem.q, f.problem.q);
    expect_same(g.problem.mu, f.problem.mu);
    EXPECT_EQ(g.title, f.title);
    EXPECT_EQ(g.description, f.description);
    expect_same(g.solution->r, f.solution->r);
    EXPECT_EQ(g.solution->u.size(), 0);
    ASSERT_EQ(g.guesses.size(), 3U);
    expect_same(g.guesses[2].u, f.guesses[2].u);
    const std::string once = lcp::read_file(folder / "a.hdf5");
    write_fclib(folder / "a.hdf5", g);
    EXPECT_EQ(lcp::read_file(folder / "a.hdf5"), once);
    EXPECT_EQ(folder.files(), 1U);
  }
}

TEST(Fclib, WritesGlobalProblems) {
  const Folder folder;
  const Fclib f = parse(small_global());
  write_fclib(folder / "a.hdf5", f);
  const Problem p = read_fclib(folder / "a.hdf5").problem;
  ASSERT_TRUE(p.global);
  expect_same(p.global->M, f.problem.global->M);
  expect_same(p.global->H, f.problem.global->H);
  expect_same(p.global->f, f.problem.global->f);
  expect_same(p.global->w, f.problem.global->w);
  expect_same(p.W.matrix(), f.problem.W.matrix());
  write_fclib(folder / "a.hdf5", f, FclibForm::Local);
  EXPECT_FALSE(read_fclib(folder / "a.hdf5").problem.global);
}

// All recorded problems, also those that came as text.
TEST(Fclib, WritesRecordedProblems) {
  SKIP_WITHOUT_RECORDED_PROBLEMS();
  const Folder folder;
  for (const char* name : {"Box_Stacks-i0122-82-5.hdf5", "Capsules-i97-269.hdf5", "LMGC_GFC3D-i00501-4-00000.hdf5",
                           "GFC3D_TwoRods1.dat", "NESpheres_10_1.dat", "Capsules-i101-404.dat"}) {
    const Problem p = recorded(name);
    write_fclib(folder / "a.hdf5", {.problem = p});
    const Problem q = read_fclib(folder / "a.hdf5").problem;
    expect_same(q.W.matrix(), p.W.matrix());
    expect_same(q.q, p.q);
    EXPECT_EQ(q.global != nullptr, p.global != nullptr);
  }
}

// What was there stays where writing fails, and nothing is left beside it.
TEST(Fclib, WritesAtOnce) {
  const Folder folder;
  const Fclib good = parse(small_local());
  write_fclib(folder / "a.hdf5", good);
  const std::string before = lcp::read_file(folder / "a.hdf5");
  Fclib bad = good;
  bad.problem.q[0] = NAN;
  EXPECT_THROW(write_fclib(folder / "a.hdf5", bad), std::invalid_argument);
  bad = good;
  bad.solution->r = vec({1, 2, 3});
  EXPECT_THROW(write_fclib(folder / "a.hdf5", bad), std::invalid_argument);
  EXPECT_EQ(lcp::read_file(folder / "a.hdf5"), before);
  EXPECT_EQ(folder.files(), 1U);
  EXPECT_THROW(write_fclib(folder / "none/a.hdf5", good), FileError);
  EXPECT_THROW(write_fclib(folder / "", good), FileError);
  EXPECT_NO_THROW(write_fclib("/dev/null", good));  // which is not replaced
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
  std::filesystem::create_symlink(folder / "a.hdf5", folder / "link.hdf5");
  Fclib other = good;
  other.title = "other";
  write_fclib(folder / "link.hdf5", other);
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.hdf5"));
  EXPECT_EQ(read_fclib(folder / "a.hdf5").title, "other");
}

/// The values of a dataset, as HDF5's library reads them.
Doubles by_hdf5(hid_t file, const std::string& path) {
  const hid_t data = H5Dopen2(file, path.c_str(), H5P_DEFAULT);
  const hid_t space = H5Dget_space(data);
  Doubles values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  H5Sclose(space);
  EXPECT_GE(H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0) << path;
  H5Dclose(data);
  return values;
}

// HDF5's library is the judge of what is written without it: more guesses than a B-tree's node of the usual size has
// room for, texts, empty vectors. Catches sizes, orders of names and addresses that only our own reader takes.
TEST(Fclib, Hdf5ReadsWhatIsWritten) {
  const Folder folder;
  Fclib f = parse(small_local());
  for (int k = 0; k < 600; ++k) f.guesses.push_back({.r = vec({1.0 * k, -0.5})});
  write_fclib(folder / "a.hdf5", f);
  const hid_t file = H5Fopen((folder / "a.hdf5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  ASSERT_GE(file, 0);
  EXPECT_EQ(by_hdf5(file, "/fclib_local/spacedim"), Doubles{2});
  EXPECT_EQ(by_hdf5(file, "/fclib_local/W/nz"), Doubles{-1});
  EXPECT_EQ(by_hdf5(file, "/fclib_local/W/x"), (Doubles{2, 1, 1, 3}));
  EXPECT_EQ(by_hdf5(file, "/solution/u"), (Doubles{0.5, 3}));
  EXPECT_EQ(by_hdf5(file, "/guesses/number_of_guesses"), Doubles{601});
  for (const int k : {1, 2, 10, 17, 300, 601})
    EXPECT_EQ(by_hdf5(file, "/guesses/" + std::to_string(k) + "/r"),
              (k == 1 ? Doubles{0.25, 0} : Doubles{k - 2., -0.5}))
        << k;
  const hid_t title = H5Dopen2(file, "/fclib_local/info/title", H5P_DEFAULT);
  const hid_t type = H5Dget_type(title);
  std::string text(H5Tget_size(type), ' ');
  H5Dread(title, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data());
  EXPECT_STREQ(text.c_str(), "a title");
  H5Tclose(type);
  H5Dclose(title);
  H5G_info_t guesses;
  H5Gget_info_by_name(file, "/guesses", &guesses, H5P_DEFAULT);
  EXPECT_EQ(guesses.nlinks, 602U);
  H5Fclose(file);

  f.problem = {.dimension = 3};
  f.solution.reset();
  f.guesses.clear();
  write_fclib(folder / "empty.hdf5", f);
  const hid_t empty = H5Fopen((folder / "empty.hdf5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  ASSERT_GE(empty, 0);
  EXPECT_EQ(by_hdf5(empty, "/fclib_local/vectors/mu"), Doubles{});
  H5Fclose(empty);
}

}  // namespace
}  // namespace perp::contact
