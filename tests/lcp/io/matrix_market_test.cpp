// SPDX-License-Identifier: Apache-2.0
#include "lcp/io/matrix_market.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "lcp/io/siconos_file.hpp"
#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::matrix;
using support::Random;
using support::vec;
using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

/// A file of this content, gone with the object.
class Temporary {
 public:
  explicit Temporary(const std::string& text = {}) {
    const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
    path_ = testing::TempDir() + "perp-" + test->name() + "-" + std::to_string(++count_) + ".mtx";
    std::ofstream(path_, std::ios::binary) << text;
  }
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;
  ~Temporary() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  inline static int count_ = 0;
};

Dense read(const std::string& text) { return Dense(read_matrix(Temporary(text).path())); }
Vec vector(const std::string& text, bool bounds = false) { return read_vector(Temporary(text).path(), bounds); }

/// The error without the file's name: ":line: reason".
std::string mtx_error(const std::string& text, bool of_vector = false) {
  const Temporary file(text);
  try {
    if (of_vector)
      read_vector(file.path());
    else
      read_matrix(file.path());
  } catch (const FileError& error) {
    return std::string(error.what()).substr(file.path().size());
  }
  return "read";
}

// The examples of NIST IR 5935 in small, one of each kind, with comments, blank lines, carriage returns, capitals and
// entries in any order. Catches rows and columns exchanged, the wrong triangle, a sign of the skew half.
TEST(MatrixMarket, EveryKind) {
  Dense A(2, 3);
  A << 1, 0, 2.5, 0, -3, 0;
  EXPECT_EQ(read("%%MatrixMarket matrix coordinate real general\n% one\n\n2 3 3\n2 2 -3\n1 3 +2.5\n% two\n1 1 1e0\n"),
            A);
  EXPECT_EQ(read("%%matrixmarket MATRIX Coordinate Integer GENERAL\r\n%\r\n2 3 3\r\n1 1 1\r\n1 3 2.5\r\n2 2 -3"), A);
  EXPECT_EQ(read("%%MatrixMarket matrix array real general\n2 3\n1\n0\n0\n-3\n2.5\n0\n"), A);
  Dense S(2, 2);
  S << 1, 2, 2, 3;
  EXPECT_EQ(read("%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 1\n2 1 2\n2 2 3\n"), S);
  EXPECT_EQ(read("%%MatrixMarket matrix array real symmetric\n2 2\n1\n2\n3\n"), S);
  Dense K(3, 3);
  K << 0, -1, -2, 1, 0, -3, 2, 3, 0;
  EXPECT_EQ(read("%%MatrixMarket matrix array real skew-symmetric\n3 3\n1\n2\n3\n"), K);
  EXPECT_EQ(read("%%MatrixMarket matrix coordinate real skew-symmetric\n3 3 3\n2 1 1\n3 1 2\n3 2 3\n"), K);
  EXPECT_EQ(read("%%MatrixMarket matrix coordinate pattern general\n1 2 1\n1 2\n"), Dense(matrix({{0, 1}})));
  EXPECT_EQ(read("%%MatrixMarket matrix coordinate real general\n0 0 0\n").size(), 0);
  // Entries of one place are added up, denormal numbers come as 0 or themselves.
  EXPECT_EQ(read("%%MatrixMarket matrix coordinate real general\n1 1 3\n1 1 1\n1 1 2\n1 1 4\n")(0, 0), 7);
  EXPECT_LT(read("%%MatrixMarket matrix coordinate real general\n1 1 1\n1 1 1e-400\n")(0, 0), 1e-300);
}

TEST(MatrixMarket, RefusesWhatIsNotAsAnnounced) {
  const std::string header = "%%MatrixMarket matrix coordinate real general\n";
  EXPECT_EQ(mtx_error(""), ":1: a Matrix Market file begins with %%MatrixMarket");
  EXPECT_EQ(mtx_error("2 2 1\n1 1 1\n"), ":1: a Matrix Market file begins with %%MatrixMarket");
  EXPECT_THAT(mtx_error("%%MatrixMarket matrix coordinate real\n1 1 0\n"), HasSubstr(":1: the header has 4 words"));
  EXPECT_THAT(mtx_error("%%MatrixMarket matrix coordinate complex general\n1 1 0\n"), HasSubstr("'complex'"));
  EXPECT_THAT(mtx_error("%%MatrixMarket matrix coordinate real hermitian\n1 1 0\n"), HasSubstr("'hermitian'"));
  EXPECT_THAT(mtx_error("%%MatrixMarket vector coordinate real general\n1 1 0\n"), HasSubstr("'vector'"));
  EXPECT_THAT(mtx_error("%%MatrixMarket matrix array pattern general\n1 1\n"), HasSubstr("pattern"));
  EXPECT_THAT(mtx_error("%%MatrixMarket matrix coordinate real symmetric\n1 2 0\n"), HasSubstr(":2: "));
  EXPECT_THAT(mtx_error(header + "-1 2 0\n"), HasSubstr(":2: the size -1 x 2"));
  EXPECT_THAT(mtx_error(header + "99999999999 2 0\n"), HasSubstr("out of range"));
  EXPECT_THAT(mtx_error(header + "2 2 1.5\n"), HasSubstr("the number of entries is '1.5'"));
  EXPECT_EQ(mtx_error(header + "%\n2 2 1\n3 1 1\n"), ":4: the place (3, 1) is not in a matrix of 2 x 2");
  EXPECT_EQ(mtx_error(header + "2 2 1\n1 0 1\n"), ":3: the place (1, 0) is not in a matrix of 2 x 2");
  EXPECT_THAT(mtx_error(header + "2 2 2\n1 1 1\n"), HasSubstr("the file ends after 1 of 2 entries"));
  EXPECT_THAT(mtx_error(header + "2 2 2000000000\n1 1 1\n"), HasSubstr("the file ends after 1 of 2000000000"));
  EXPECT_THAT(mtx_error(header + "2 2 1\n1 1 1\n2 2 1\n"), HasSubstr(":4: there is more text"));
  EXPECT_THAT(mtx_error(header + "2 2 1\n1 1 nan\n"), HasSubstr(":3: the value is nan"));
  EXPECT_THAT(mtx_error(header + "2 2 1\n1 1 1e999\n"), HasSubstr(":3: the value is inf"));
  EXPECT_THAT(mtx_error(header + "2 2 1\n1 1 1x\n"), HasSubstr(":3: '1x' is not a number"));
  EXPECT_THAT(mtx_error(header + "2 2 1\n1 1"), HasSubstr("ends before its last value"));
  EXPECT_THAT(mtx_error("%%MatrixMarket matrix coordinate real skew-symmetric\n2 2 1\n1 1 1\n"), HasSubstr("diagonal"));
  EXPECT_THROW(read_matrix("/nonexistent/x.mtx"), FileError);
  EXPECT_THROW(read_matrix(testing::TempDir()), FileError);
}

TEST(MatrixMarket, Vectors) {
  EXPECT_EQ(vector("%%MatrixMarket matrix array real general\n3 1\n1\n2\n3\n"), vec({1, 2, 3}));
  EXPECT_EQ(vector("%%MatrixMarket matrix array real general\n1 3\n1\n2\n3\n"), vec({1, 2, 3}));
  EXPECT_EQ(vector("%%MatrixMarket matrix coordinate real general\n3 1 1\n2 1 5\n"), vec({0, 5, 0}));
  EXPECT_EQ(vector("1\n2.5\n% a comment\n-3e1\n"), vec({1, 2.5, -30}));
  EXPECT_THAT(mtx_error("%%MatrixMarket matrix array real general\n2 2\n1\n2\n3\n4\n", true), HasSubstr("2 x 2"));
  EXPECT_THAT(mtx_error("1\ninf\n", true), HasSubstr(":2: "));
  EXPECT_THAT(mtx_error("1\nnan\n", true), HasSubstr(":2: "));
  // Bounds: infinite in every spelling, and from 1e20 on.
  EXPECT_EQ(vector("inf\n-inf\nInfinity\n-INF\n1e30\n-1e20\n1e19\n0\n", true),
            vec({infinity, -infinity, infinity, -infinity, infinity, -infinity, 1e19, 0}));
  EXPECT_EQ(vector("%%MatrixMarket matrix array real general\n2 1\n-inf\n1e308\n", true), vec({-infinity, infinity}));
}

// What is written reads back bit by bit: the shortest digits that do, extreme numbers, empty rows and columns.
TEST(MatrixMarket, RoundTrips) {
  Random random(1);
  for (int run = 0; run < 20; ++run) {
    const Index n = random.integer(1, 30);
    SpMat A = support::from(n, support::scatter(n, 2, random));
    for (Index k = 0; k < A.nonZeros(); ++k) A.valuePtr()[k] *= std::pow(10, random.integer(-300, 300));
    const Temporary file;
    write_matrix(file.path(), A, "two lines\nof comment");
    EXPECT_EQ(Dense(read_matrix(file.path())), Dense(A));
    const Vec v = random.normals(n);
    write_vector(file.path(), v);
    EXPECT_EQ(read_vector(file.path()), v);
  }
  const Temporary file;
  const double largest = std::numeric_limits<double>::max();
  const double least = std::numeric_limits<double>::denorm_min();
  write_vector(file.path(), vec({0.1, 1.0 / 3, -largest, least, 1e100}));
  EXPECT_EQ(read_vector(file.path()), vec({0.1, 1.0 / 3, -largest, least, 1e100}));
  write_matrix(file.path(), matrix({{0.1}}));
  EXPECT_THAT(read_file(file.path()), EndsWith("\n1 1 1\n1 1 0.1\n"));
  EXPECT_THROW(write_matrix("/nonexistent/x.mtx", matrix({{1}})), FileError);
}

// The Laplacian of a 300 x 300 grid, shuffled: 450000 entries, sorted into columns.
TEST(MatrixMarket, LargeAndUnsorted) {
  Random random(2);
  const int N = 300;
  std::string text = "%%MatrixMarket matrix coordinate real general\n";
  support::Triplets entries;
  for (int k = 0; k < N * N; ++k) {
    entries.emplace_back(k, k, 4);
    if (k % N > 0) entries.emplace_back(k, k - 1, -1);
    if (k % N + 1 < N) entries.emplace_back(k, k + 1, -1.5);
    if (k >= N) entries.emplace_back(k, k - N, -1);
    if (k + N < N * N) entries.emplace_back(k, k + N, -1);
  }
  for (std::size_t k = entries.size(); k > 1; --k)
    std::swap(entries[k - 1], entries[static_cast<std::size_t>(random.integer(0, static_cast<int>(k) - 1))]);
  text += std::to_string(N * N) + " " + std::to_string(N * N) + " " + std::to_string(entries.size()) + "\n";
  for (const auto& e : entries)
    text += std::to_string(e.row() + 1) + " " + std::to_string(e.col() + 1) + " " + std::to_string(e.value()) + "\n";
  const SpMat A = read_matrix(Temporary(text).path());
  EXPECT_EQ(A.nonZeros(), static_cast<Index>(entries.size()));
  EXPECT_EQ((A - support::from(N * N, entries)).norm(), 0);
  for (Index j = 0; j < A.cols(); ++j)
    EXPECT_TRUE(std::is_sorted(A.innerIndexPtr() + A.outerIndexPtr()[j], A.innerIndexPtr() + A.outerIndexPtr()[j + 1]));
}

// Both halves of a symmetric matrix would be added up to twice of it; sizes that do not fit and sums that overflow are
// no matrix either.
TEST(MatrixMarket, RefusesWhatWouldBeReadWrong) {
  const std::string path = testing::TempDir() + "perp-" + std::to_string(getpid()) + "-wrong.mtx";
  const auto refusal = [&](const std::string& text) -> std::string {
    std::ofstream(path) << "%%MatrixMarket matrix coordinate real " << text;
    try {
      (void)read_matrix(path);
    } catch (const FileError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal("symmetric\n2 2 2\n2 1 3\n1 2 3\n"),
              testing::HasSubstr(":4: the place (1, 2) is above the diagonal"));
  EXPECT_THAT(refusal("general\n1 1 2\n1 1 1e308\n1 1 1e308\n"), testing::HasSubstr("infinity"));
  std::remove(path.c_str());
}

/// Why a child that may have 16 GB of addresses, and no more, refuses the file; "accepted".
template <class Read>
std::string refused_in_child(const std::string& text, const Read& read_it) {
  const Temporary file(text);
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) return "pipe";
  const pid_t child = fork();
  if (child == 0) {
    const rlimit limit{rlim_t{1} << 34, RLIM_INFINITY};
    setrlimit(RLIMIT_AS, &limit);
    std::string why = "accepted";
    try {
      read_it(file.path());
    } catch (const FileError& error) {
      why = error.what();
    }
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    if (usage.ru_maxrss > 1 << 20) why += "; it took " + std::to_string(usage.ru_maxrss / 1024) + " MB";
    _exit(::write(ends[1], why.data(), why.size()) > 0 ? 0 : 1);
  }
  close(ends[1]);
  std::string why(500, ' ');
  const ssize_t size = ::read(ends[0], why.data(), why.size());
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  why.resize(size > 0 && status == 0 ? static_cast<std::size_t>(size) : 0);
  return why;
}

// Issue 17: 60 bytes that announce 2e9 rows took gigabytes. What cannot be in the file is refused whatever memory there
// is; absent entries are legal, and only lists over rows and columns that do not fit are refused, with the figure.
TEST(MatrixMarket, AnnouncedSizes) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers need more address space than the limit";
#endif
  const auto matrix_of = [](const std::string& path) { (void)read_matrix(path); };
  const auto vector_of = [](const std::string& path) { (void)read_vector(path); };
  const std::string head = "%%MatrixMarket matrix ";
  EXPECT_THAT(refused_in_child(head + "coordinate real general\n2000000000 2000000000 1\n1 1 1\n", matrix_of),
              AllOf(HasSubstr(":2: the lists of a matrix of 2000000000 x 2000000000 need 32 GB, "),
                    HasSubstr(" are available"), Not(HasSubstr("took"))));
  EXPECT_THAT(refused_in_child(head + "coordinate real general\n2147483647 1 1\n1 1 1\n", vector_of),
              AllOf(HasSubstr(":2: the values of a vector of 2147483647 need 17 GB, "), Not(HasSubstr("took"))));
  EXPECT_THAT(refused_in_child(head + "array real general\n2000000000 1\n1\n", vector_of),
              AllOf(HasSubstr(":4: the file ends after 1 of 2000000000 entries"), Not(HasSubstr("took"))));
  EXPECT_THAT(refused_in_child(head + "array real general\n40000 40000\n1\n", matrix_of),
              AllOf(HasSubstr(":4: the file ends after 1 of 1600000000 entries"), Not(HasSubstr("took"))));
  EXPECT_THAT(refused_in_child(head + "coordinate real general\n2 2 2000000000\n1 1 1\n", matrix_of),
              AllOf(HasSubstr(":4: the file ends after 1 of 2000000000"), Not(HasSubstr("took"))));
  EXPECT_EQ(refused_in_child(head + "coordinate real general\n1000000 1000000 1\n1 1 1\n", matrix_of), "accepted");
}

// A file that some editors have saved: the mark is no part of the text, nor of the reason for a refusal (issue 17:
// "a Matrix Market file begins with %%MatrixMarket").
TEST(MatrixMarket, ByteOrderMarks) {
  const std::string mark = "\xEF\xBB\xBF";
  EXPECT_EQ(read_matrix(Temporary(mark + "%%MatrixMarket matrix array real general\n1 1\n7\n").path()).coeff(0, 0), 7);
  EXPECT_EQ(read_vector(Temporary(mark + "7\n8\n").path()), vec({7, 8}));
  EXPECT_EQ(read_vector(Temporary(mark + "%%MatrixMarket matrix array real general\n1 1\n7\n").path()), vec({7}));
  EXPECT_EQ(read_siconos_lcp(Temporary(mark + "1\n0\n1 1\n1 1\n2\n-4\n").path()).problem.q, vec({-4}));
  for (const char* wide : {"\xFF\xFE%", "\xFE\xFF%"})
    for (const bool whole : {true, false}) try {
        const Temporary file(wide);
        if (whole)
          (void)read_matrix(file.path());
        else
          (void)read_vector(file.path());
        ADD_FAILURE();
      } catch (const FileError& error) {
        EXPECT_THAT(error.what(), HasSubstr(":1: it is text in UTF-16"));
      }
}

}  // namespace
}  // namespace perp::lcp
