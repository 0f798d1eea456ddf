// SPDX-License-Identifier: Apache-2.0
// Families by name and size, as the command line gives them.
#include "collection/sized.hpp"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <new>
#include <sstream>

#include "ncp/problem/residual.hpp"

namespace {

using namespace perp::ncp;
using namespace perp::ncp::collection;
using ::testing::HasSubstr;

Problem of(const std::string& argument) {
  const std::size_t colon = argument.find(':');
  return make(*find_family(argument.substr(0, colon)), argument.substr(colon + 1));
}

std::string refusal(const std::string& argument) {
  try {
    of(argument);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

/// The least sizes of a family as text: "4x1x1".
std::string least(const Family& family) {
  std::string text;
  for (const SizeArgument& argument : family.arguments()) {
    if (!text.empty()) text += 'x';
    text += std::to_string(argument.least);
  }
  return text;
}

/// The family's example with sizes above 100 divided by ten, which keeps their relations.
std::string smaller_example(const Family& family) {
  std::string text;
  std::istringstream sizes(std::string(family.example.substr(0, family.example.find(':'))));
  for (std::string size; std::getline(sizes, size, 'x');) {
    long n = std::stol(size);
    while (n > 100 && n >= 10 * family.arguments()[0].least) n /= 10;
    text.append(text.empty() ? "" : "x").append(std::to_string(n));
  }
  return family.seeded() ? text + ":7" : text;
}

// Each is an entry at some size; a problem like its example has the entry's starts; the least sizes are those of its
// maker, and the planted solution is one there too. Catches: a maker under another's name, an example with too few
// sizes or without sense, a least size that crashes.
TEST(Sized, EveryFamilyKeepsItsPromises) {
  ASSERT_GE(families().size(), 37u);
  for (const Family& family : families()) {
    SCOPED_TRACE(family.name);
    const Entry* entry = find(family.name);
    ASSERT_NE(entry, nullptr);
    for (const std::string& sizes : {smaller_example(family), least(family)}) {
      SCOPED_TRACE(sizes);
      const Problem problem = make(family, sizes);
      EXPECT_EQ(problem.mcp->name(), family.name);
      ASSERT_EQ(problem.starts.size(), entry->make().starts.size());
      for (const Vec& start : problem.starts) EXPECT_NO_THROW(check_input(*problem.mcp, start));
      for (const KnownSolution& known : problem.solutions)
        EXPECT_LT(residual(*problem.mcp, known.x).natural, 1e-11 * (1 + known.x.lpNorm<Eigen::Infinity>()));
    }
    EXPECT_EQ(std::string(family.example).find(':') != std::string::npos, family.seeded());
    for (const SizeArgument& argument : family.arguments()) {
      EXPECT_GE(argument.least, 1);
      EXPECT_GT(argument.most, argument.least);
    }
  }
}

// What a family is said to need at least must be needed: else sizes that fit are refused. Five vectors of 8 bytes and
// two entries of 12 an unknown (56 bytes), or the entries of a dense triangle.
TEST(Sized, RefusesForLackOfMemoryOnlyWhatNeedsIt) {
  for (const Family& family : families()) {
    SCOPED_TRACE(family.name);
    const std::string sizes = smaller_example(family);
    double sum = 0;
    double product = family.arguments().size() == 1 ? -1 : 1;
    std::istringstream in(sizes.substr(0, sizes.find(':')));
    for (std::string size; std::getline(in, size, 'x');) {
      sum += std::stod(size);
      product *= product < 0 ? -std::stod(size) * std::stod(size) : std::stod(size);
    }
    const Problem problem = make(family, sizes);
    const auto n = static_cast<double>(problem.mcp->size());
    const auto entries = static_cast<double>(problem.mcp->jacobian_pattern().nonZeros());
    const double needs = 40 * n + 12 * entries;
    if (family.growth == Growth::Dense)
      EXPECT_LE(product / 2, entries);
    else
      EXPECT_LE(56 * (family.growth == Growth::Grid ? product : sum), needs * 1.05);
  }
}

// The largest sizes are refused with the figure before anything is built: in a child that may not have the memory.
TEST(Sized, TooLargeForTheMachine) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers need more address space than the limit";
#endif
  const pid_t child = fork();
  if (child == 0) {
    const rlimit limit{rlim_t{1} << 34, RLIM_INFINITY};
    setrlimit(RLIMIT_AS, &limit);
    try {
      of("obstacle:20000x20000");
    } catch (const std::bad_alloc& error) {
      _exit(std::string(error.what()).starts_with("vectors and matrix need 22 GB, ") ? 0 : 2);
    }
    _exit(1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
}

// Catches: sizes exchanged on their way to the maker, a seed lost.
TEST(Sized, SizesAndSeedArrive) {
  const Problem economy = of("walras-own:12x5x7:3");
  EXPECT_EQ(economy.mcp->size(), 24);
  EXPECT_EQ(economy.mcp->variable_name(4), "y[5]");
  EXPECT_EQ(economy.mcp->variable_name(16), "p[12]");
  EXPECT_EQ(of("american-put-own:3x5").mcp->variable_name(5), "v[1,2]");
  EXPECT_EQ(of("bimatrix-own:3x5").mcp->variable_name(3), "y[1]");
  EXPECT_EQ(of("lq-control-own:7").mcp->size(), 35);
  EXPECT_EQ(of("nash-own:12").solutions[0].x, of("nash-own:12:1").solutions[0].x);
  EXPECT_NE(of("nash-own:12:2").solutions[0].x, of("nash-own:12:1").solutions[0].x);
  EXPECT_EQ(of("nash-own:12:4294967295").mcp->size(), 12);
}

// Catches: half a size taken for a whole one, numbers that overflow to small ones, sizes that end in a crash.
TEST(Sized, RefusesWithNameValueAndWhatIsExpected) {
  for (const char* argument : {"walras-own:", "walras-own:4", "walras-own:4x1", "walras-own:4x1x1x1", "walras-own::1"})
    EXPECT_THAT(refusal(argument),
                HasSubstr("expected walras-own:GOODSxSECTORSxHOUSEHOLDS[:SEED], as in walras-own:400x300x300:7"))
        << argument;
  EXPECT_THAT(refusal("walras-own:4x1"), HasSubstr("walras-own: 3 sizes are needed, '4x1' has 2"));
  EXPECT_THAT(refusal("obstacle:3x"), HasSubstr("obstacle: '' is no size; expected obstacle:MxN, as in"));
  for (const char* argument : {"obstacle:3xb", "obstacle:3x4.5", "obstacle:3x4 ", "obstacle: 3x4", "obstacle:+3x4"})
    EXPECT_THAT(refusal(argument), HasSubstr("is no size")) << argument;
  EXPECT_THAT(refusal("obstacle:0x4"), HasSubstr("obstacle: M is 0; it must be at least 1"));
  EXPECT_THAT(refusal("lq-control-own:-5"), HasSubstr("lq-control-own: T is -5; it must be at least 1"));
  EXPECT_THAT(refusal("nash-own:9"), HasSubstr("nash-own: firms is 9; it must be at least 10"));
  EXPECT_THAT(refusal("nash-own:1000000"), HasSubstr("nash-own: firms is 1000000; it must be at most 10000"));
  EXPECT_THAT(refusal("murty-exp:51"), HasSubstr("murty-exp: n is 51; it must be at most 50"));
  EXPECT_THAT(refusal("traffic-own:1x5"), HasSubstr("traffic-own: M is 1; it must be at least 2"));
  EXPECT_THAT(refusal("lq-control-own:99999999999999999999"), HasSubstr("size 99999999999999999999 is out of range"));
  EXPECT_THAT(refusal("walras-own:5x5x1"), HasSubstr("walras-own: goods - sectors is 0"));
  EXPECT_THAT(refusal("obstacle:3x4:1"), HasSubstr("obstacle: it has no seed, '1' is given"));
  EXPECT_THAT(refusal("nash-own:10:x"), HasSubstr("'x' is no seed"));
  EXPECT_THAT(refusal("nash-own:10:-1"), HasSubstr("seed -1 is not from 0 to 4294967295"));
  EXPECT_THAT(refusal("nash-own:10:4294967296"), HasSubstr("seed 4294967296 is not from 0 to 4294967295"));
  EXPECT_THAT(refusal("nash-own:10:1:2"), HasSubstr("more than one seed"));
}

TEST(Sized, FamiliesByName) {
  EXPECT_EQ(find_family("kojshin"), nullptr);
  EXPECT_EQ(find_family("walras-own-1000"), nullptr);
  EXPECT_EQ(syntax(*find_family("traffic-own")), "traffic-own:MxN[:SEED]");
  EXPECT_EQ(limits(*find_family("bimatrix-own")), "m from 1 to 10000, n from 1 to 10000");
}

}  // namespace
