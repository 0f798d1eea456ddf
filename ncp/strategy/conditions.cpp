// SPDX-License-Identifier: Apache-2.0
#include "ncp/strategy/conditions.hpp"

#include <algorithm>

#include "lcp/cholesky/symmetric.hpp"
#include "lcp/classes/classify.hpp"
#include "lcp/linalg/quasi_definite.hpp"
#include "ncp/analysis/function_classes.hpp"
#include "ncp/strategy/structured_run.hpp"

namespace perp::ncp {
namespace {

/// Variables beyond which auto takes interior points and iterative linear algebra early: pivoting solves smaller
/// problems in milliseconds.
constexpr Index large = 2000;

/// Returns the classes that ranges of F prove, where that costs less than a few iterations.
FunctionClasses proven_classes(const Mcp& mcp, In x) {
  constexpr Index most_variables = 300;
  if (mcp.is_affine() || mcp.size() > most_variables || mcp.enclosure() == nullptr) return {};
  return function_classes(mcp, x, {.minors_to = 10, .samples = 0});
}

/// Returns whether J + eps I has an L S L' with the signs of its rows, some R_i != 0 making R J symmetric, as where |R|
/// J is positive semidefinite. Costs a factorization of what interior points factor.
bool quasi_definite(const SpMat& J) {
  constexpr double eps = 1e-6;  // above the rounding of J's entries
  lcp::QuasiDefinite ldlt;
  return ldlt.analyze(lcp::with_diagonal(J)) && ldlt.factor(Vec::Constant(J.rows(), eps));
}

}  // namespace

std::optional<Scaling> factors_at(Run& run, const Vec& x) {
  SpMat J = run.mcp().jacobian_pattern();
  if (!run.counted().jacobian(x, J)) return std::nullopt;
  Scaling factors = scaling(run.mcp(), J);
  return factors.helps() ? std::optional(std::move(factors)) : std::nullopt;
}

std::string_view words_of(Condition condition) {
  switch (condition) {
    case Condition::Affine:
      return "the problem is affine";
    case Condition::Nonlinear:
      return "the problem is nonlinear";
    case Condition::NotMonotone:
      return "the Jacobian is not known to be positive semidefinite";
    case Condition::QuasiDefinite:
      return "the Jacobian has an L S L' with the signs of its rows, as that of a monotone F has";
    case Condition::Large:
      return "n > 2000";
    case Condition::Symmetric:
      return "the Jacobian is symmetric";
    case Condition::Unsymmetric:
      return "the Jacobian is not symmetric";
    case Condition::UniformP:
      return "F is proven to be a uniform P-function";
    case Condition::Scalable:
      return "scaling brings the entries of the Jacobian together";
    case Condition::Rescalable:
      return "scaling brings the entries of the Jacobian at the best point together";
    case Condition::Triangular:
      return "the Jacobian is block triangular";
    case Condition::Cold:
      return "no warm basis is given";
  }
  return "";
}

bool Facts::hold(const std::vector<Condition>& conditions) {
  return std::ranges::all_of(conditions, [this](Condition condition) { return holds(condition); });
}

bool Facts::holds(Condition condition) {
  const Mcp& mcp = run_.mcp();
  const auto symmetric = [&] {
    if (!symmetric_) symmetric_ = lcp::symmetric(start_.J);
    return *symmetric_;
  };
  switch (condition) {
    case Condition::Affine:
      return mcp.is_affine();
    case Condition::Nonlinear:
      return !mcp.is_affine();
    case Condition::NotMonotone:
      if (!monotone_) monotone_ = lcp::positive_semidefinite(start_.J, {.dense_to = 0}).yes();
      return !*monotone_;
    case Condition::QuasiDefinite:
      return quasi_definite(start_.J);
    case Condition::Large:
      return mcp.size() > large;
    case Condition::Symmetric:
      return symmetric();
    case Condition::Unsymmetric:
      return !symmetric();
    case Condition::UniformP:
      return proven_classes(mcp, start_.x).uniform_p.answer == lcp::Answer::Yes;
    case Condition::Scalable:
      return scaling(mcp, start_.J).helps();
    case Condition::Rescalable:
      return factors_at(run_, run_.best()).has_value();
    case Condition::Triangular:
      return block_triangular(run_, start_.x);
    case Condition::Cold:
      return run_.warm_basis().empty();
  }
  return false;
}

std::string words_on_existence(const Mcp& mcp, In x) {
  const FunctionClasses classes = proven_classes(mcp, x);
  if (classes.strongly_monotone.answer == lcp::Answer::Yes)
    return "there is exactly one solution, as F is proven to be strongly monotone";
  if (classes.uniform_p.answer == lcp::Answer::Yes)
    return "there is exactly one solution, as F is proven to be a uniform P-function";
  return {};
}

}  // namespace perp::ncp
