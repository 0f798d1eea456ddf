// SPDX-License-Identifier: Apache-2.0
// Which derivatives a model declares constant. Would catch a presolve that trusts a row which is not affine.
#include "nl_text.hpp"
#include "support/matrices.hpp"

namespace perp::ncp::ampl {
namespace {

using support::Random;

// v3 = 2 x1 + x0^2 and  F0 = v3 + x2,  F1 = x0 - x2 + 5,  F2 = (if x1 > 0 then 1 else 2) + x2, all variables free.
std::string model(bool row_2_has_entries) {
  return text({.vars = 3, .cons = 3, .cc = 3, .nonzeros = row_2_has_entries ? 7 : 5, .con = 1}) +
         "V3 1 0\n1 2\no5\nv0\nn2\nC0\nv3\nC1\nn5\nC2\no35\no29\nv1\nn0\nn1\nn2\n"
         "r\n5 0 1\n5 0 2\n5 0 3\nb\n3\n3\n3\n" +
         (row_2_has_entries ? "k2\n2\n4\n" : "k2\n2\n3\n") + "J0 3\n0 0\n1 0\n2 1\nJ1 2\n0 1\n2 -1\n" +
         (row_2_has_entries ? "J2 2\n1 0\n2 1\n" : "");
}

// By hand, by columns. Variables within a defined variable count as nonlinear, and so does everything in a row that
// jumps where a condition changes.
TEST(Linearity, LooksThroughDefinedVariables) {
  const auto m = read_text(model(true));
  EXPECT_EQ(m->linear_entries(), (std::vector<bool>{false, true, false, false, true, true, false}));
  EXPECT_EQ(read_text(binary_twin(model(true)))->linear_entries(), m->linear_entries());
}

// F2 jumps and has no entry: no flag could say so, and an empty row would pass for a constant.
TEST(Linearity, IsUnknownWhereARowWithoutEntriesVaries) {
  const auto m = read_text(model(false));
  EXPECT_EQ(m->jacobian_pattern().nonZeros(), 5);
  EXPECT_TRUE(m->linear_entries().empty());
}

// The declared entries have one value wherever J is defined, and rows with nothing else are affine:
// F_i(y) - F_i(x) = J_i (y - x).
void expect_true_promises(const Model& m, unsigned seed) {
  const std::vector<bool> linear = m.linear_entries();
  if (linear.empty()) return;
  ASSERT_EQ(static_cast<Index>(linear.size()), m.jacobian_pattern().nonZeros());
  Random random(seed);
  SpMat J = m.jacobian_pattern(), K = J;
  const auto point = [&] { return Vec(m.start() + random.normals(m.size())); };
  Vec F(m.size()), G(m.size());
  for (int trial = 0; trial < 20; ++trial) {
    const Vec x = point(), y = point();
    if (!m.eval(x, F) || !m.eval(y, G) || !m.jacobian(x, J) || !m.jacobian(y, K)) continue;
    std::vector<char> affine(static_cast<std::size_t>(m.size()), 1);
    for (Index k = 0; k < J.nonZeros(); ++k) {
      if (!linear[static_cast<std::size_t>(k)]) affine[static_cast<std::size_t>(J.innerIndexPtr()[k])] = 0;
      EXPECT_TRUE(!linear[static_cast<std::size_t>(k)] || J.valuePtr()[k] == K.valuePtr()[k]) << m.name();
    }
    const Vec difference = G - F - J * (y - x);
    for (Index i = 0; i < m.size(); ++i)
      EXPECT_TRUE(affine[static_cast<std::size_t>(i)] == 0 ||
                  std::abs(difference[i]) <= 1e-9 * (1 + std::abs(F[i]) + std::abs(G[i])))
          << m.equation_name(i);
  }
}

TEST(Linearity, PromisesAreKept) {
  unsigned seed = 1;
  for (const std::string& content : rich_models()) expect_true_promises(*read_text(content), seed++);
  expect_true_promises(*read_text(model(true)), seed++);
  for (const std::string& path : samples()) {
    std::unique_ptr<Model> m;
    try {
      m = read_model(path);
    } catch (const ModelError&) {
      continue;  // not an MCP
    }
    if (m->size() <= 2000) expect_true_promises(*m, seed++);
  }
}

}  // namespace
}  // namespace perp::ncp::ampl
