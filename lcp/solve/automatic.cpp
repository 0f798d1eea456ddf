// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>
#include <utility>

#include "lcp/cholesky/symmetric.hpp"
#include "lcp/classes/classify.hpp"
#include "lcp/linalg/quasi_definite.hpp"
#include "lcp/solve/solve.hpp"

namespace perp::lcp {
namespace {

/// Runs methods in turn until one settles the problem; keeps the best point and tells what was tried.
class Attempts {
 public:
  Attempts(const AffineMcp& problem, In start, const Limits& limits)
      : problem_(problem), start_(start), limits_(limits) {}

  /// Whether the problem is settled now: solved, proven infeasible, or the run stopped.
  bool run(const Method& method, const std::string& label, const std::string& why) {
    return run(method, start_, label, why);
  }
  bool run(const Method& method, const Vec& start, const std::string& label, const std::string& why) {
    Result result = solve(problem_, start, method, limits_);
    const std::string before = tried_.empty() ? "" : "; tried before: " + tried_;
    const long iterations = best_.iterations + result.iterations;
    const int factorizations = best_.factorizations + result.factorizations;
    const bool stopped = limits_.reached().has_value();
    settled_ = result.accepted() || result.status == Status::Infeasible || stopped;
    if (settled_)
      result.message = label + (why.empty() ? "" : " (" + why + ")") + (result.message.empty() ? "" : ": ") +
                       result.message + before;
    if (!tried_.empty()) tried_ += ", ";
    tried_ += label + ": " + std::string(to_string(result.status));
    if (best_.z.size() == 0 || settled_ || result.residual < best_.residual) best_ = std::move(result);
    best_.iterations = iterations;
    best_.factorizations = factorizations;
    return settled_;
  }

  Result end() {
    if (!settled_) {
      best_.status = Status::Stalled;
      best_.message = "no method settled the problem; tried: " + tried_;
    }
    return std::move(best_);
  }

 private:
  const AffineMcp& problem_;
  const Vec start_;
  const Limits& limits_;
  Result best_;
  std::string tried_;
  bool settled_ = false;
};

/// Sizes up to which a method is worth its time here; larger problems go to the next.
constexpr Index pivoting_to = 20'000;   // Lemke's method makes about n pivots
constexpr Index factored_qp_to = 2000;  // below, block pivoting's dense steps cost less than a hierarchy of grids
constexpr Index enumerated_to = 14;     // bounded variables: 2^14 cells are nothing
constexpr Index enumerated_at_last_to = 20;

Lemke covered(Cover cover, unsigned seed, Index n) {
  Lemke lemke;
  lemke.options.cover = cover;
  lemke.options.seed = seed;
  lemke.options.max_pivots = 1000 + 20 * static_cast<int>(std::min<Index>(n, 1'000'000));
  return lemke;
}

/// Pivots that take about what interior points do where no signs make M symmetric: some twenty sparse LUs, each as long
/// as some thirty pivots. Elsewhere the L S L' of interior points is quicker.
constexpr int pivots_before_interior_points = 600;
/// Up to so many rows 2 n pivots take less than to tell the class of M; most problems need about n.
constexpr Index few_rows = 100;

Index cells(const Box& box) {  // variables that have more than one place
  Index count = 0;
  for (Index i = 0; i < box.size(); ++i)
    count += box.lower[i] < box.upper[i] && (box.lower[i] > -infinity || box.upper[i] < infinity);
  return count;
}

/// Large symmetric M are the QP's, whatever their factors would say.
ClassifyOptions cheap(const SpMat& M) {
  ClassifyOptions options;
  options.minors_to = 12;
  options.p0_to = 0;
  options.copositive_to = 8;
  options.dense_to = 100;
  if (M.rows() > factored_qp_to && symmetric(M)) options.factor_to = 0;
  return options;
}

/// The methods that the class of M promises something of. True: settled.
bool try_by_class(Attempts& attempts, const AffineMcp& problem, const Diagnosis& d, unsigned seed) {
  const Index n = problem.size();
  const Property& psd = d.positive_semidefinite;
  if (d.symmetric.yes() && !psd.no() && n > factored_qp_to &&
      attempts.run(BoundQp{}, "qp",
                   "M is symmetric, " + (psd.yes() ? "positive semidefinite: " + psd.reason
                                                   : std::string("not known to be indefinite"))))
    return true;
  for (const auto& [property, text] : {std::pair{&d.m, "an M-matrix"},
                                       {&d.h_plus, "an H-matrix with positive diagonal"},
                                       {&d.positive_definite, "positive definite"},
                                       {&d.p, "a P-matrix"}})
    if (property->yes()) {
      if (attempts.run(BlockPivoting{}, "block-pivoting", std::string("M is ") + text + ": " + property->reason))
        return true;
      break;
    }
  // From the lower bounds, exchanges of all negative F_i are Chandrasekaran's method: it finds the least feasible
  // point.
  if (d.z.yes() && !d.m.yes() && problem.box.lower.allFinite() &&
      attempts.run(BlockPivoting{}, problem.box.lower, "block-pivoting from the lower bounds", "M is a Z-matrix"))
    return true;
  if (!psd.yes() && !d.copositive_plus.yes() && !d.p.yes()) return false;
  const std::string why = psd.yes()                 ? "M is positive semidefinite: " + psd.reason
                          : d.copositive_plus.yes() ? "M is copositive-plus: " + d.copositive_plus.reason
                                                    : "M is a P-matrix: " + d.p.reason;
  if (n > few_rows && n <= pivoting_to && psd.yes() && !signs_of(problem.M)) {
    Lemke brief = covered(Cover::Ones, seed, n);
    brief.options.max_pivots = pivots_before_interior_points;
    if (attempts.run(brief, "lemke with few pivots", why)) return true;
  }
  if (psd.yes() && attempts.run(InteriorPoint{}, "interior-point", why)) return true;
  if (n > pivoting_to) return false;
  for (const auto& [cover, label] :
       {std::pair{Cover::Ones, "lemke"}, {Cover::Generic, "lemke with a generic covering vector"}})
    if (attempts.run(covered(cover, seed, n), label, why)) return true;
  return false;
}

/// What may help where nothing is known.
bool try_everything(Attempts& attempts, const AffineMcp& problem, unsigned seed) {
  const Index n = problem.size();
  const Index bounded = cells(problem.box);
  const std::string why = "M is in no class with a promise";
  const auto pivot = [&](unsigned first, unsigned last) {
    for (unsigned k = first; k < last; ++k)
      for (const auto& [cover, label] : {std::pair{Cover::Ones, "lemke"},
                                         {Cover::Generic, "lemke with a generic covering vector"},
                                         {Cover::Spread, "lemke with a widely spread covering vector"}})
        if (attempts.run(covered(cover, seed + k, n), label, why)) return true;
    return false;
  };
  if (n <= pivoting_to && pivot(0, 1)) return true;
  if (bounded <= enumerated_to && attempts.run(Enumeration{}, "enumeration", "few cells")) return true;
  Lemke regular = covered(Cover::Ones, seed, n);
  regular.options.start = LemkeStart::Regular;
  if (n <= pivoting_to &&
      (attempts.run(LemkeHowson{}, "lemke-howson", why) || attempts.run(regular, "lemke from the start", why)))
    return true;
  if (attempts.run(BlockPivoting{}, "block-pivoting", why)) return true;
  if (n <= pivoting_to && pivot(1, 4)) return true;
  return bounded <= enumerated_at_last_to && attempts.run(Enumeration{}, "enumeration", "few cells");
}

}  // namespace

Result automatic(const AffineMcp& problem, In start, const Auto& method, const Limits& limits) {
  check_input("auto", problem, start, limits);
  const Result at_start = judged(problem, start, limits, Status::Stalled, {});
  if (at_start.solved()) return at_start;
  Attempts attempts(problem, start, limits);
  if (const Index n = problem.size(); n <= few_rows) {
    Lemke brief = covered(Cover::Ones, method.seed, n);
    brief.options.max_pivots = 2 * static_cast<int>(n);
    if (attempts.run(brief, "lemke", "few rows")) return attempts.end();
  }
  const Diagnosis diagnosis = classify(problem, cheap(problem.M));
  if (!try_by_class(attempts, problem, diagnosis, method.seed)) try_everything(attempts, problem, method.seed);
  return attempts.end();
}

}  // namespace perp::lcp
