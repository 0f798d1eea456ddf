// SPDX-License-Identifier: Apache-2.0
// The seam to AMPL's library, past the checker: what it says when it fails becomes a ModelError, and the process goes
// on. Would catch an error jump that is not set.
#include "ncp/ampl/asl_problem.hpp"
#include "nl_text.hpp"

namespace perp::ncp::ampl {
namespace {

const std::string header = text({.cc = 1});
const std::string logarithm = "C0\no43\nv0\nr\n5 1 1\nb\n2 0\nk0\nJ0 1\n0 0\n";
constexpr AslProblem::Sizes sizes{.n_var = 1, .n_con = 1, .n_obj = 0, .n_cc = 1, .nonzeros = 1};

std::string refusal(const std::string& file, const std::string& segments, AslProblem::Sizes expected = sizes) {
  const TempFolder folder;
  folder.write("m.nl", file);
  try {
    const AslProblem problem(folder.path() + "/m", segments, expected);
  } catch (const ModelError& e) {
    return e.what();
  }
  return "";
}

TEST(Library, ReadsTheSegmentsFromMemory) {
  const TempFolder folder;
  folder.write("m.nl", header + "not looked at\n");
  const AslProblem problem(folder.path() + "/m", logarithm, sizes);
  double x = 1, c = 7, J = 7;
  EXPECT_TRUE(problem.values(&x, &c));
  EXPECT_TRUE(problem.jacobian(&x, &J));
  EXPECT_EQ(c, 0);
  EXPECT_EQ(J, 1);
  x = -1;
  EXPECT_FALSE(problem.values(&x, &c));
  EXPECT_FALSE(problem.jacobian(&x, &J));
  EXPECT_EQ(problem.values_by_row(&x, &c).defined, std::vector<char>{0});
}

TEST(Library, ItsErrorsAreExceptions) {
  // (Once in a C segment, the library leaks its scratch memory where it fails.)
  EXPECT_THAT(refusal(header, "r\n5 1 1\nQ\n"), testing::HasSubstr("AMPL's library cannot read the file: bad line 13"));
  EXPECT_THAT(refusal(header, "C5\no43\n"), testing::HasSubstr("bad line 11"));
  EXPECT_THAT(refusal(header, "r\n9\n"), testing::HasSubstr("bad line 12"));
  EXPECT_THAT(refusal(header, "b\n2 "), testing::HasSubstr("Premature end of file"));
  EXPECT_THAT(refusal("g3 1 1 0\n 1 1 0\n", logarithm), testing::HasSubstr("header"));
}

TEST(Library, AFileThatChangedIsRefused) {
  AslProblem::Sizes other = sizes;
  other.n_var = 2;
  EXPECT_THAT(refusal(header, logarithm, other), testing::HasSubstr("changed while it was being read"));
}

}  // namespace
}  // namespace perp::ncp::ampl
