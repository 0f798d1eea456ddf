// SPDX-License-Identifier: Apache-2.0
// .sol files, read back by a reader of this file's own and by AMPL's (fread_sol). Would catch anything that makes AMPL
// or Pyomo misread an answer, and half-written files.
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <sstream>

#include "ncp/ampl/sol.hpp"
#include "nl_text.hpp"

#include <asl.h>
#undef n_var
#undef n_con
#undef write_sol

namespace perp::ncp::ampl {
namespace {

struct Sol {
  std::string message;
  std::vector<int> options;  // without their number
  int n_con = -1, n_var = -1;
  std::vector<double> dual, x;
  int code = -1;
};

Sol parse_text(const std::string& content) {
  std::istringstream in(content);
  Sol sol;
  std::string line;
  while (std::getline(in, line) && !line.empty()) sol.message += line + "\n";
  EXPECT_TRUE(std::getline(in, line) && line == "Options");
  int n = 0, duals = 0, values = 0;
  in >> n;
  for (int i = 0, o = 0; i < n && in >> o; ++i) sol.options.push_back(o);
  in >> sol.n_con >> duals >> sol.n_var >> values;
  double value = 0;
  for (int i = 0; i < duals && in >> value; ++i) sol.dual.push_back(value);
  for (int i = 0; i < values && in >> value; ++i) sol.x.push_back(value);
  std::string objno;
  int number_of_objective = -1;
  in >> objno >> number_of_objective >> sol.code;
  EXPECT_EQ(objno, "objno");
  EXPECT_EQ(number_of_objective, 0);
  in >> std::ws;
  EXPECT_TRUE(in.eof());
  return sol;
}

// Fortran records: length, content, length.
std::vector<std::string> records(const std::string& content) {
  std::vector<std::string> found;
  for (std::size_t at = 0; at < content.size();) {
    int length = -1, again = -2;
    std::memcpy(&length, content.data() + at, 4);
    found.push_back(content.substr(at + 4, static_cast<std::size_t>(length)));
    std::memcpy(&again, content.data() + at + 4 + length, 4);
    EXPECT_EQ(length, again);
    at += 8 + static_cast<std::size_t>(length);
  }
  return found;
}

template <class T>
std::vector<T> unpack(const std::string& bytes, std::size_t from = 0) {
  std::vector<T> values((bytes.size() - from) / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), bytes.data() + from, values.size() * sizeof(T));
  return values;
}

Sol parse_binary(const std::string& content) {
  const std::vector<std::string> r = records(content);
  Sol sol;
  EXPECT_EQ(r.size(), 7U);
  EXPECT_EQ(r[0], "binary");
  sol.message = r[1] + "\n";
  EXPECT_EQ(r[2], "");
  EXPECT_EQ(r[3].substr(0, 7), "Options");
  const std::vector<int> numbers = unpack<int>(r[3], 7);
  EXPECT_EQ(numbers.size(), static_cast<std::size_t>(numbers[0]) + 5);
  sol.options.assign(numbers.begin() + 1, numbers.end() - 4);
  sol.n_con = numbers[numbers.size() - 4];
  sol.n_var = numbers[numbers.size() - 2];
  EXPECT_EQ(r[4], "");
  sol.x = unpack<double>(r[5]);
  EXPECT_EQ(static_cast<int>(sol.x.size()), numbers.back());
  EXPECT_EQ(unpack<int>(r[6])[0], 0);
  sol.code = unpack<int>(r[6])[1];
  return sol;
}

/// A model in AMPL's library, for its own writer and reader of .sol files.
class Library {
 public:
  explicit Library(const std::string& stub) : asl_(ASL_alloc(ASL_read_fg)) {
    FILE* nl = jac0dim_ASL(asl_, const_cast<char*>(stub.c_str()), 0);
    EXPECT_NE(nl, nullptr);
    fg_read_ASL(asl_, nl, 0);
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
  ~Library() { ASL_free(&asl_); }

  std::string write(const std::string& path, const char* message, double* x, int code) {
    asl_->p.solve_code_ = code;
    asl_->i.amplflag_ = 1;
    EXPECT_EQ(write_solf_ASL(asl_, const_cast<char*>(message), x, nullptr, nullptr, path.c_str()), 0);
    return read_bytes(path);
  }
  /// The message, x and the code of STUB.sol.
  Sol read() {
    Sol sol;
    double *x = nullptr, *y = nullptr;
    char* message = read_sol_ASL(asl_, &x, &y);
    EXPECT_EQ(y, nullptr);
    if (message == nullptr) {
      ADD_FAILURE() << "the library cannot read the file";
      return sol;
    }
    sol.message = message;
    if (x != nullptr) sol.x.assign(x, x + asl_->i.n_var_);
    sol.code = asl_->p.solve_code_;
    free(message);
    free(x);
    return sol;
  }

 private:
  ASL* asl_;
};

const std::string three_rows =
    text({.vars = 2, .cons = 3, .cc = 2, .nonzeros = 3}) +
    "C0\nn0\nC1\nn0\nC2\nn0\nr\n5 1 1\n5 1 2\n2 0\nb\n2 0\n2 0\nk1\n1\nJ0 1\n0 1\nJ1 1\n1 1\nJ2 1\n1 1\n";

class SolFile : public testing::TestWithParam<bool> {
 protected:
  std::string path() const { return folder_.path() + "/m.sol"; }
  TempFolder folder_;
  std::string nl_ = folder_.write("m.nl", GetParam() ? binary_twin(three_rows) : three_rows);
  Sol parse() const { return GetParam() ? parse_binary(read_bytes(path())) : parse_text(read_bytes(path())); }
};

TEST_P(SolFile, RoundTrip) {
  const auto m = read_model(nl_);
  ASSERT_EQ(m->size(), 3);
  const Vec x{{1.0 / 3, -4.9406564584124654e-324}};
  m->write_sol("Perp 1.0.0: solved.\n\n3 iterations\n", x, 0);
  const Sol own = parse();
  std::vector<Sol> all{own};
  // Debian 12's library refuses binary files without dual values, its own ones as well (mended since).
  if (!GetParam()) all.push_back(Library(folder_.path() + "/m").read());
  for (const Sol& sol : all) {
    EXPECT_EQ(sol.message, "Perp 1.0.0: solved.\n \n3 iterations\n");
    EXPECT_EQ(sol.x, (std::vector<double>{x[0], x[1]}));
    EXPECT_EQ(sol.code, 0);
  }
  EXPECT_EQ(own.options, (std::vector<int>{1, 1, 0}));
  EXPECT_EQ(own.n_con, 3);
  EXPECT_EQ(own.n_var, 2);
  EXPECT_TRUE(own.dual.empty());
  m->write_sol("again", x, 400);  // replaces the first
  EXPECT_EQ(parse().code, 400);
  EXPECT_EQ(parse().message, "again\n");
}

// Byte for byte what AMPL's library writes.
TEST_P(SolFile, AsTheLibraryWritesIt) {
  const auto m = read_model(nl_);
  Vec x{{1.0 / 3, -250.75}};
  m->write_sol("two\nlines", x, 201);
  EXPECT_EQ(read_bytes(path()),
            Library(folder_.path() + "/m").write(folder_.path() + "/other.sol", "two\nlines", x.data(), 201));
  write_failed_sol(nl_, "nothing", 504);
  EXPECT_EQ(read_bytes(path()),
            Library(folder_.path() + "/m").write(folder_.path() + "/other.sol", "nothing", nullptr, 504));
}

TEST_P(SolFile, FailedModels) {
  write_failed_sol(folder_.path() + "/m", "not square", 504);
  const Sol own = parse();
  std::vector<Sol> all{own};
  if (!GetParam()) all.push_back(Library(folder_.path() + "/m").read());
  for (const Sol& sol : all) {
    EXPECT_EQ(sol.message, "not square\n");
    EXPECT_TRUE(sol.x.empty());
  }
  EXPECT_EQ(own.code, 504);
  EXPECT_EQ(own.n_var, 2);
  EXPECT_EQ(own.n_con, 3);
}

INSTANTIATE_TEST_SUITE_P(Forms, SolFile, testing::Bool(),
                         [](const auto& given) { return given.param ? "binary" : "text"; });

TEST(Sol, UnreadableHeader) {
  const TempFolder folder;
  folder.write("m.nl", "garbage");
  write_failed_sol(folder.path() + "/m.nl", "garbage", 500);
  const Sol sol = parse_text(read_bytes(folder.path() + "/m.sol"));
  EXPECT_EQ(sol.code, 500);
  EXPECT_EQ(sol.n_var, 0);
}

TEST(Sol, NoOptions) {
  EXPECT_EQ(sol_text({.options = {0}, .n_con = 1, .n_var = 1}, "done", std::vector<double>{2.5}, 0),
            "done\n\n2.5\nobjno 0 0\n");
}

// The tolerance of format lines with option 3, as AMPL's reader expects it back.
TEST(Sol, Tolerance) {
  EXPECT_EQ(sol_text({.options = {3, 1, 3, 0}, .tolerance = 1e-6, .n_con = 1, .n_var = 1}, "", {}, 0),
            "\nOptions\n5\n1\n3\n0\n1\n0\n1\n0\n1e-06\nobjno 0 0\n");
  std::string s = three_rows;
  s.replace(0, 8, "g3 1 3 0 1e-06");
  const TempFolder folder;
  const auto m = read_model(folder.write("m.nl", s));
  m->write_sol("ok", Vec{{1, 2}}, 0);
  EXPECT_EQ(Library(folder.path() + "/m").read().x, (std::vector<double>{1, 2}));
}

TEST(Sol, RefusesWhatNobodyCanRead) {
  const auto m = read_text(three_rows);
  EXPECT_THROW(m->write_sol("", Vec{{1, NAN}}, 0), ModelError);
  EXPECT_THROW(m->write_sol("", Vec::Zero(3), 0), ModelError);
}

TEST(Sol, CannotBeWritten) {
  const TempFolder folder;
  const auto m = read_model(folder.write("m.nl", three_rows));
  // The place is taken by a folder: the rename fails, and the temporary file goes.
  ASSERT_EQ(mkdir((folder.path() + "/m.sol").c_str(), 0755), 0);
  try {
    m->write_sol("x", Vec{{1, 2}}, 0);
    FAIL();
  } catch (const ModelError& e) {
    EXPECT_THAT(e.what(),
                testing::AllOf(testing::HasSubstr("m.sol: cannot be written: "), testing::HasSubstr("directory")));
  }
  int entries = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++entries;
  EXPECT_EQ(entries, 2);
  EXPECT_THROW(write_failed_sol(folder.path() + "/absent/m", "x", 500), ModelError);
}

TEST(Sol, ReadOnlyFolder) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write anywhere";
  const TempFolder folder;
  const auto m = read_model(folder.write("m.nl", three_rows));
  ASSERT_EQ(chmod(folder.path().c_str(), 0555), 0);
  EXPECT_THROW(m->write_sol("x", Vec{{1, 2}}, 0), ModelError);
  chmod(folder.path().c_str(), 0755);
}

// A write that fails halfway, as on a full disk: the old file stays, the temporary one goes.
TEST(Sol, DiskThatFillsUp) {
  const TempFolder folder;
  const std::string path = folder.write("m.sol", "old");
  struct rlimit limit {};
  getrlimit(RLIMIT_FSIZE, &limit);
  const rlim_t most = limit.rlim_cur;
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  limit.rlim_cur = 4096;
  setrlimit(RLIMIT_FSIZE, &limit);
  std::string message;
  try {
    write_whole(path, std::string(100000, 'x'));
  } catch (const ModelError& e) {
    message = e.what();
  }
  limit.rlim_cur = most;
  setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, handler);
  EXPECT_THAT(message,
              testing::AllOf(testing::HasSubstr("m.sol: cannot be written: "), testing::HasSubstr("too large")));
  EXPECT_EQ(read_bytes(path), "old");
  int entries = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++entries;
  EXPECT_EQ(entries, 1);
}

}  // namespace
}  // namespace perp::ncp::ampl
