// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the tests of app/ share: a folder of their own, files, and small AMPL models.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "app/program/program.hpp"

namespace perp::app::test {

/// A folder that lives as long as the object.
class Folder {
 public:
  Folder() {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::temp_directory_path() /
            ("perp-" + std::to_string(getpid()) + "-" + info->test_suite_name() + "-" + info->name());
    std::filesystem::create_directories(path_);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::string operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

inline void write(const std::string& path, const std::string& content) { std::ofstream(path) << content; }

inline std::string read(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

/// The words with which the call is refused.
template <class Call>
std::string refused(const Call& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "(accepted)";
}

/// What completion offers for the last of the words.
inline std::string offered(const std::string& words) {
  const Folder folder;
  const std::string out = folder / "out";
  const std::string script = "source '" PERP_SOURCE_DIR "/app/perp.bash'; COMP_WORDS=('" PERP_PROGRAM "' " + words +
                             "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _perp 2>/dev/null; echo \" ${COMPREPLY[*]} \"";
  write(folder / "completion.sh", script);
  EXPECT_EQ(std::system(("bash '" + folder / "completion.sh" + "' > '" + out + "'").c_str()),
            0);  // NOLINT(cert-env33-c)
  return read(out);
}

/// Output and errors of a call in process.
struct Captured {
  std::ostringstream out, err;
  Streams streams{out, err};
};

/// The ten lines an .nl file begins with, for models whose rows are all nonlinear (Gay, "Writing .nl files", 2005).
inline std::string nl_header(int n_var, int n_con, int equations, int cc, int nonzeros) {
  std::ostringstream text;
  text << "g3 1 1 0\n " << n_var << ' ' << n_con << " 0 0 " << equations << "\n " << n_con << " 0 0 " << cc
       << " 0 0\n 0 0\n " << n_var << " 0 0\n 0 0 0 1\n 0 0 0 0 0\n " << nonzeros << " 0\n 0 0\n 0 0 0 0 0\n";
  return text.str();
}

/// x complements F(x), an expression in Polish prefix form; `bounds` is the line of the b segment, x >= 0 by default.
inline std::string scalar_nl(const std::string& F, double start, const std::string& bounds = "2 0") {
  std::ostringstream text;
  text << nl_header(1, 1, 0, 1, 1) << "C0\n"
       << F << "x1\n0 " << start << "\nr\n5 " << (bounds == "3" ? 0 : 1) << " 1\nb\n"
       << bounds << "\nk0\nJ0 1\n0 0\n";
  return text.str();
}

/// 0 <= x _|_ x^2 - 2 >= 0, solved by sqrt(2).
inline std::string sqrt2_nl() { return scalar_nl("o1\no5\nv0\nn2\nn2\n", 1); }
/// 0 <= x _|_ x - x - (1 + x^2) >= 0 has no solution, and the range of F does not show it.
inline std::string infeasible_nl() { return scalar_nl("o1\no1\nv0\nv0\no0\nn1\no5\nv0\nn2\n", 1); }
/// 0 <= x _|_ (x - 1)^2 - 1.01 >= 0 from 0, close to a local minimum of the merit functions (Billups 1995).
inline std::string billups_nl() { return scalar_nl("o1\no5\no1\nv0\nn1\nn2\nn1.01\n", 0); }
/// log(x) = 0, x free, from 0, where it is not defined, and no bound says on which side it is.
inline std::string undefined_nl() { return scalar_nl("o43\nv0\n", 0, "3"); }

/// sqrt2_nl with the side inequality x^2 <= 10 (not active at the solution).
inline std::string side_inequality_nl() {
  return nl_header(1, 2, 0, 1, 2) +
         "C0\no1\no5\nv0\nn2\nn2\nC1\no5\nv0\nn2\nx1\n0 1\nr\n5 1 1\n1 10\nb\n2 0\nk0\nJ0 1\n0 0\nJ1 1\n0 0\n";
}

/// Two variables, one complementarity condition.
inline std::string nonsquare_nl() {
  return nl_header(2, 1, 0, 1, 2) + "C0\no0\nv0\nv1\nr\n5 1 1\nb\n2 0\n2 0\nk1\n1\nJ0 2\n0 0\n1 0\n";
}

/// exp(-x_i) = 0 for i = 1..n, x free: Newton's method adds 1 to x a step and never arrives, so that a run with a
/// tiny tolerance lasts hundreds of iterations.
inline std::string endless_nl(int n) {
  std::ostringstream text;
  text << nl_header(n, n, n, 0, n);
  for (int i = 0; i < n; ++i) text << "C" << i << "\no44\no16\nv" << i << "\n";
  text << "r\n";
  for (int i = 0; i < n; ++i) text << "4 0\n";
  text << "b\n";
  for (int i = 0; i < n; ++i) text << "3\n";
  text << "k" << n - 1 << "\n";
  for (int i = 1; i < n; ++i) text << i << "\n";
  for (int i = 0; i < n; ++i) text << "J" << i << " 1\n" << i << " 0\n";
  return text.str();
}

}  // namespace perp::app::test
