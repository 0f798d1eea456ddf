// SPDX-License-Identifier: Apache-2.0
#include "contact/model/velocities.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include "contact/model/residual.hpp"
#include "lcp/exact_sum.hpp"

namespace perp::contact {
namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();
/// What u may be wrong by, of itself, before its row is added up without rounding.
constexpr double wanted = 1e-14;

/// Row i of u for those that are asked for.
void add_exactly(const Problem& problem, In r, const std::vector<char>& asked, Vec& u) {
  std::vector<Index> place(asked.size(), -1);
  std::vector<Index> rows;
  for (Index i = 0; i < u.size(); ++i)
    if (asked[at(i)] != 0) {
      place[at(i)] = static_cast<Index>(rows.size());
      rows.push_back(i);
    }
  std::vector<lcp::ExactSum> sums(rows.size());
  for (Index j = 0; j < r.size(); ++j)
    for (SpMat::InnerIterator it(problem.W, j); it; ++it)
      if (const Index k = place[at(it.row())]; k >= 0) sums[at(k)].add_product(it.value(), r[j]);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    sums[k].add(problem.q[rows[k]]);
    u[rows[k]] = sums[k].value();
  }
}

}  // namespace

Velocities exact_velocities(const Problem& problem, In r) {
  const Index n = problem.q.size();
  Velocities out{.u = problem.q, .terms = problem.q.cwiseAbs()};
  Vec errors = Vec::Zero(n);
  std::vector<int> entries(at(n), 0);
  for (Index j = 0; j < n; ++j) {
    if (r[j] == 0) continue;
    for (SpMat::InnerIterator it(problem.W, j); it; ++it) {
      const Index i = it.row();
      const lcp::TwoParts product = lcp::two_product(it.value(), r[j]);
      const lcp::TwoParts sum = lcp::two_sum(out.u[i], product.value);
      out.u[i] = sum.value;
      errors[i] += sum.error + product.error;
      out.terms[i] += std::abs(product.value);
      ++entries[at(i)];
    }
  }
  std::vector<char> asked(at(n), 0);
  bool any = false;
  for (Index i = 0; i < n; ++i) {
    out.u[i] += errors[i];
    if (entries[at(i)] == 0) continue;
    const double rounding = eps * (entries[at(i)] + 2);
    if (std::isfinite(out.u[i]) && rounding * rounding * out.terms[i] > wanted * std::abs(out.u[i])) {
      asked[at(i)] = 1;
      any = true;
    }
  }
  if (any) add_exactly(problem, r, asked, out.u);
  return out;
}

Vec velocities(const Problem& problem, In r) { return exact_velocities(problem, r).u; }

}  // namespace perp::contact
