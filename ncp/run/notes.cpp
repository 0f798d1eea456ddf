// SPDX-License-Identifier: Apache-2.0
#include "ncp/run/notes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ncp/problem/model_structure.hpp"
#include "ncp/run/judge.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {
namespace {

constexpr double far = 1e3;  // of the tolerance

/// Rows of one kind: the worst is told, the others are counted.
struct Kind {
  Index worst = -1;
  double largest = 0;
  Index count = 0;
  void add(Index i, double size) {
    ++count;
    if (!(size > largest) && worst >= 0) return;
    worst = i;
    largest = size;
  }
  std::string others() const { return count > 1 ? "; so it is in " + quantity(count - 1, "other equation") : ""; }
};

std::string subject(const Mcp& mcp, const Result& result, Index i) {
  return "equation " + mcp.equation_name(i) + " is " + number(result.F[i]);
}

std::string variable(const Mcp& mcp, Index i) { return "variable " + mcp.variable_name(i); }

/// F_i moves by so much where every x_j moves by tol max(1, |x_j|), or by what rounds, n_i + 2 times eightfold: less
/// than that is no news.
Vec noise(const SpMat& J, In x, const lcp::RowTerms& terms, double tol) {
  Vec out = Vec::Zero(x.size());
  for (Index j = 0; j < J.cols(); ++j)
    for (SpMat::InnerIterator it(J, j); it; ++it) out[it.row()] += std::abs(it.value()) * std::max(1.0, std::abs(x[j]));
  for (Index i = 0; i < x.size(); ++i)
    out[i] *= std::max(tol, 8.0 * (terms.entries[i] + 2) * std::numeric_limits<double>::epsilon());
  return out;
}

void add_notes(const Mcp& mcp, const Stop& stop, const SpMat& J, const lcp::RowTerms& terms, Result& result) {
  const Box& box = mcp.box();
  Vec rounding;  // once it is asked for
  const auto beyond_noise = [&](Index i, double F) {
    if (rounding.size() == 0) rounding = noise(J, result.x, terms, stop.tol);
    return F > rounding[i];
  };
  Kind unbalanced;
  Kind near_bound;
  Kind narrow;
  for (Index i = 0; i < result.x.size(); ++i) {
    const double x = result.x[i];
    const double F = std::abs(result.F[i]);
    const bool excused = at_its_bound(box, i, x, result.F[i]);
    const double width = box.upper[i] - box.lower[i];
    if (width > 0 && width <= stop.tol && F > far * stop.tol)
      narrow.add(i, F);
    else if (!excused && F > far * stop.tol)
      near_bound.add(i, F);
    else if (!excused && F > far * stop.tol * terms.size[i] && beyond_noise(i, F))
      unbalanced.add(i, F / terms.size[i]);
  }
  if (unbalanced.count > 0) {
    const Index i = unbalanced.worst;
    result.notes.push_back(subject(mcp, result, i) + ", below the tolerance, but its terms are of size " +
                           number(terms.size[i]) + " there: it is balanced to " + number(100 * unbalanced.largest) +
                           " % only" + unbalanced.others() + "; scale the equation, or ask for --tol-relative");
  }
  if (near_bound.count > 0) {
    const Index i = near_bound.worst;
    const bool lower = result.x[i] - box.lower[i] < box.upper[i] - result.x[i];
    result.notes.push_back(subject(mcp, result, i) + ", excused because " + variable(mcp, i) +
                           " is within the tolerance of its " + (lower ? "lower" : "upper") +
                           " bound, but at the bound itself the point is no solution" + near_bound.others() +
                           "; scale the variable");
  }
  if (narrow.count > 0) {
    const Index i = narrow.worst;
    result.notes.push_back(subject(mcp, result, i) + ", which says nothing: the bounds of " + variable(mcp, i) +
                           " are " + number(box.upper[i] - box.lower[i]) +
                           " apart, less than the tolerance, and every point between them passes" + narrow.others());
  }
}

/// Tells of rows that are too many or too few: in the message where no solution was found.
void tell_structure(const Mcp& mcp, const SpMat* J, Result& result) {
  for (const Fault& fault : faults(structure_of(mcp, &result.F, J)))
    if (result.accepted())
      result.notes.push_back(fault.text);
    else
      result.message += "; " + fault.text;
}

}  // namespace

double imbalance(const Mcp& mcp, const SpMat& J, In x, In F, double tol) {
  const lcp::RowTerms terms = row_terms(J, x, F);
  const Vec rounding = noise(J, x, terms, tol);
  double worst = 0;
  for (Index i = 0; i < x.size(); ++i)
    if (const double size = std::abs(F[i]); size > rounding[i] && !at_its_bound(mcp.box(), i, x[i], F[i]))
      worst = std::max(worst, size / terms.size[i]);
  return worst;
}

namespace {

/// J at x, of an affine problem its own; null where it is not defined.
std::shared_ptr<const SpMat> jacobian_at(const Mcp& mcp, const Vec& x) {
  if (const lcp::AffineMcp* own = mcp.affine()) return {std::shared_ptr<const void>(), &own->M};
  const auto J = std::make_shared<SpMat>(mcp.jacobian_pattern());
  return CountedMcp(mcp).jacobian(x, *J) ? J : nullptr;
}

}  // namespace

std::shared_ptr<const SpMat> annotate(const Mcp& mcp, const Stop& stop, Result& result) {
  const bool finite = result.F.size() == mcp.size() && result.F.allFinite() && result.x.allFinite();
  const auto known = finite ? jacobian_at(mcp, result.x) : nullptr;
  tell_structure(mcp, known.get(), result);
  if (!known) return known;
  const SpMat& J = *known;
  const lcp::RowTerms terms = row_terms(J, result.x, result.F);
  const lcp::Accuracy accuracy = lcp::accuracy(row_residuals(mcp.box(), result.x, result.F), terms);
  result.relative = accuracy.relative;
  result.relative_row = accuracy.worst;
  if (result.solved()) {
    add_notes(mcp, stop, J, terms, result);
  } else if (result.residual.natural <= stop.tol) {
    result.message += "; the tolerance is met, but |F_i| <= tol_relative t_i is not, off the bounds";
    result.advice = "scale the equations, or ask for a larger relative tolerance (--tol-relative)";
  }
  return known;
}

}  // namespace perp::ncp
