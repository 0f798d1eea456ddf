// SPDX-License-Identifier: Apache-2.0
// Conditions with each other's variables. The models are min sum (x_i - i)^2 over x_i + x_(i+1) <= 4 as optimality
// conditions, f[i] of x[i] and cap[i] of mu[i]. Would catch a slip that passes for a model, and a model that passes for
// a slip.
#include "ncp/ampl/exchanged.hpp"

#include <numeric>
#include <sstream>

#include "nl_text.hpp"

namespace perp::ncp::ampl {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int goods = 4;  // x; three mu follow

/// Row k complements variable `variable[k]`; without `extra` the pattern of J is symmetric.
std::string model(const std::vector<int>& variable, bool extra = false) {
  std::vector<std::vector<std::pair<int, int>>> rows(2 * goods - 1);
  for (int i = 0; i < goods; ++i) rows[at(i)].emplace_back(i, 2);
  for (int c = 0; c + 1 < goods; ++c)
    for (const int i : {c, c + 1}) {
      rows[at(i)].emplace_back(goods + c, 1);
      rows[at(goods + c)].emplace_back(i, -1);
    }
  if (extra) rows[0].emplace_back(goods - 1, 1);
  std::ostringstream C, r, b, k, J;
  int nonzeros = 0;
  std::vector<int> columns(2 * goods - 1, 0);
  for (int i = 0; i < 2 * goods - 1; ++i) {
    std::sort(rows[at(i)].begin(), rows[at(i)].end());
    C << 'C' << i << "\nn" << (i < goods ? -2 * i : 4) << '\n';
    r << "5 1 " << variable[at(i)] + 1 << '\n';
    b << "2 0\n";
    J << 'J' << i << ' ' << rows[at(i)].size() << '\n';
    for (const auto& [j, a] : rows[at(i)]) {
      J << j << ' ' << a << '\n';
      ++columns[at(j)];
      ++nonzeros;
    }
  }
  for (int j = 0, sum = 0; j + 1 < 2 * goods - 1; ++j) k << (sum += columns[at(j)]) << '\n';
  return text({.vars = 2 * goods - 1, .cons = 2 * goods - 1, .eqns = 0, .cc = 2 * goods - 1, .nonzeros = nonzeros}) +
         C.str() + "r\n" + r.str() + "b\n" + b.str() + 'k' + std::to_string(2 * goods - 2) + '\n' + k.str() + J.str();
}

std::vector<int> in_order() {
  std::vector<int> variable(2 * goods - 1);
  std::iota(variable.begin(), variable.end(), 0);
  return variable;
}

std::vector<std::string> remarks(const std::string& nl, bool named) {
  const TempFolder folder;
  if (named) {
    folder.write("m.row", "f[1]\nf[2]\nf[3]\nf[4]\ncap_1\ncap_2\ncap_3\n");
    folder.write("m.col", "x[1]\nx[2]\nx[3]\nx[4]\nmu_1\nmu_2\nmu_3\n");
  }
  return read_model(folder.write("m.nl", nl))->remarks();
}

TEST(Exchanged, NothingIsSaidOfModelsInOrder) {
  for (const bool named : {false, true})
    for (const bool extra : {false, true}) EXPECT_THAT(remarks(model(in_order(), extra), named), IsEmpty());
}

// J of  0 <= x _|_ x + y - 1,  0 <= y _|_ y - 1  is triangular, and would be symmetric with its rows exchanged.
TEST(Exchanged, TriangularIsNoSlip) {
  EXPECT_THAT(remarks(text({.vars = 2, .cons = 2, .cc = 2, .nonzeros = 3}) +
                          "C0\nn-1\nC1\nn-1\nr\n5 1 1\n5 1 2\nb\n2 0\n2 0\nk1\n1\nJ0 2\n0 1\n1 1\nJ1 1\n1 1\n",
                      false),
              IsEmpty());
}

// Within a family and across two of them.
TEST(Exchanged, NamesGiveItAway) {
  for (const auto& [a, b] : {std::pair{1, 2}, std::pair{0, 3}, std::pair{0, 6}, std::pair{2, 5}}) {
    std::vector<int> variable = in_order();
    std::swap(variable[at(a)], variable[at(b)]);
    const auto said = remarks(model(variable, true), true);
    ASSERT_EQ(said.size(), 1U) << a << ' ' << b;
    const auto row = [](int i) {
      return i < goods ? "f[" + std::to_string(i + 1) + "]" : "cap_" + std::to_string(i - goods + 1);
    };
    const auto x = [](int i) {
      return i < goods ? "x[" + std::to_string(i + 1) + "]" : "mu_" + std::to_string(i - goods + 1);
    };
    EXPECT_THAT(said.front(), AllOf(HasSubstr("row " + row(a) + " complements " + x(b) + " and not " + x(a)),
                                    HasSubstr("row " + row(b) + " complements " + x(a) + " and not " + x(b))));
  }
}

TEST(Exchanged, ThePatternGivesItAway) {
  for (const auto& [a, b] : {std::pair{1, 2}, std::pair{0, 3}, std::pair{0, 6}, std::pair{2, 5}}) {
    std::vector<int> variable = in_order();
    std::swap(variable[at(a)], variable[at(b)]);
    const auto said = remarks(model(variable), false);
    ASSERT_EQ(said.size(), 1U) << a << ' ' << b;
    const std::string first = std::to_string(a + 1), second = std::to_string(b + 1);
    EXPECT_THAT(said.front(), HasSubstr("seem to have each other's variables"));
    EXPECT_THAT(said.front(), AllOf(HasSubstr("_scon[" + first + "]"), HasSubstr("_scon[" + second + "]")));
    EXPECT_THAT(remarks(model(variable, true), false), IsEmpty()) << "a pattern that is not symmetric either way";
  }
}

}  // namespace
}  // namespace perp::ncp::ampl
