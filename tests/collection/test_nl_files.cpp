// SPDX-License-Identifier: Apache-2.0
// The collection as .nl files: written by running each problem's own F on expressions, read back by AMPL's library.
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "each_entry.hpp"
#include "model_checks.hpp"
#include "ncp/ampl/model.hpp"
#include "ncp/ampl/nl_writer.hpp"
#include "ncp/interval/enclosure.hpp"
#include "ncp/problem/residual.hpp"

namespace perp::ncp::collection {
namespace {

struct File {
  std::filesystem::path path;
  File() {
    static int number = 0;
    path = std::filesystem::temp_directory_path() /
           ("perp-nl-" + std::to_string(::getpid()) + "-" + std::to_string(number++) + ".nl");
  }
  ~File() { std::filesystem::remove(path); }
  std::unique_ptr<ampl::Model> read(const std::string& text) const {
    std::ofstream(path) << text;
    return ampl::read_model(path.string());
  }
};

class NlFile : public EachEntry {};

/// Near a start or a solution, within the box.
Vec some_point(const Problem& p, std::mt19937& random, int k) {
  const std::size_t which = static_cast<std::size_t>(k) % (p.starts.size() + p.solutions.size());
  Vec x = which < p.starts.size() ? p.starts[which] : p.solutions[which - p.starts.size()].x;
  std::normal_distribution<double> noise(0, 0.05);
  if (k >= static_cast<int>(p.starts.size()))
    for (double& entry : x) entry += noise(random) * (1 + std::abs(entry));
  return lcp::project(p.mcp->box(), x);
}

// Each problem, each start: the same box, start, F and J at points near the starts and the known solutions. Catches a
// formula that is not the problem's, a term lost by simplification, and entries of J that the file does not declare.
TEST_P(NlFile, IsTheSameProblem) {
  if (entry.size > 1200) GTEST_SKIP() << "large: a smaller one of the family is looked at";
  const Problem p = entry.make();
  const File file;
  std::unique_ptr<ampl::Model> model;
  for (const Vec& start : p.starts) {
    const auto text = ampl::nl_text(*p.mcp, start);
    ASSERT_TRUE(text);
    model = file.read(*text);
    ASSERT_EQ(model->start(), start);
  }
  const Index n = p.mcp->size();
  ASSERT_EQ(model->size(), n);
  EXPECT_EQ(model->box().lower, p.mcp->box().lower);
  EXPECT_EQ(model->box().upper, p.mcp->box().upper);
  std::mt19937 random(5);
  SpMat J = p.mcp->jacobian_pattern(), G = model->jacobian_pattern();
  int compared = 0;
  for (int k = 0; k < 20; ++k) {
    const Vec x = some_point(p, random, k);
    Vec F(n), H(n);
    if (!p.mcp->eval(x, F)) continue;
    ASSERT_TRUE(model->eval(x, H)) << k;
    if (!p.mcp->jacobian(x, J)) continue;
    ASSERT_TRUE(model->jacobian(x, G)) << k;
    // Of rows whose terms are large, rounding is.
    const lcp::RowTerms terms = row_terms(J, x, F);
    for (Index i = 0; i < n; ++i) ASSERT_LE(std::abs(F[i] - H[i]), 1e-9 * (1 + terms.size[i])) << k << ", row " << i;
    const SpMat difference = J - G;
    const double size = 1 + J.coeffs().cwiseAbs().maxCoeff();
    for (Index j = 0; j < n; ++j)
      for (SpMat::InnerIterator it(difference, j); it; ++it)
        ASSERT_LE(std::abs(it.value()), 1e-9 * size) << k << ", entry " << it.row() << ", " << j;
    ++compared;
  }
  EXPECT_GT(compared, 5);
}

// Ranges over a point hold F there, and over a box F at its points. Catches an expression that is not the function.
TEST_P(NlFile, RangesHoldTheValues) {
  if (entry.size > 250) GTEST_SKIP() << "large";
  const Problem p = entry.make();
  const Enclosure* enclosure = p.mcp->enclosure();
  if (enclosure == nullptr) GTEST_SKIP() << "affine, or a model without ranges";
  const Index n = p.mcp->size();
  std::mt19937 random(6);
  std::uniform_real_distribution<double> part(0, 1);
  for (int k = 0; k < 10; ++k) {
    const Vec x = some_point(p, random, k), y = some_point(p, random, k + 7);
    std::vector<Interval> X(static_cast<std::size_t>(n)), F(X.size()), J;
    for (Index i = 0; i < n; ++i) X[lcp::at(i)] = {std::min(x[i], y[i]), std::max(x[i], y[i])};
    enclosure->values(X, F);
    std::vector<char> known(X.size());
    J.resize(lcp::at(p.mcp->jacobian_pattern().nonZeros()));
    enclosure->jacobian(X, J, known);
    Vec between = x, f(n);
    for (int t = 0; t < 3; ++t) {
      if (t > 0)
        for (Index i = 0; i < n; ++i)
          between[i] = X[lcp::at(i)].lower + part(random) * (X[lcp::at(i)].upper - X[lcp::at(i)].lower);
      SpMat slopes = p.mcp->jacobian_pattern();
      if (!p.mcp->eval(between, f) || !p.mcp->jacobian(between, slopes)) continue;
      const lcp::RowTerms terms = row_terms(slopes, between, f);
      for (Index i = 0; i < n; ++i) {
        const double slack = 1e-9 * (1 + terms.size[i]);
        ASSERT_TRUE(f[i] >= F[lcp::at(i)].lower - slack && f[i] <= F[lcp::at(i)].upper + slack)
            << f[i] << " not in " << F[lcp::at(i)].lower << ", " << F[lcp::at(i)].upper;
      }
      const double size = 1e-9 * (1 + slopes.coeffs().cwiseAbs().maxCoeff());
      for (Index q = 0, j = 0; j < n; ++j)
        for (SpMat::InnerIterator it(slopes, j); it; ++it, ++q) {
          if (known[lcp::at(it.row())] == 0) continue;
          ASSERT_TRUE(it.value() >= J[lcp::at(q)].lower - size && it.value() <= J[lcp::at(q)].upper + size)
              << it.row() << ", " << j;
        }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Collection, NlFile, each_name(), test_name);

}  // namespace
}  // namespace perp::ncp::collection
