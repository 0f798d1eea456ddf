// SPDX-License-Identifier: Apache-2.0
/// Auto: a list of methods, and the loop that runs it.
#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "lcp/cholesky/symmetric.hpp"
#include "lcp/classes/classify.hpp"
#include "lcp/solve/solve.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {
namespace {

using If = Condition;

Lemke covered(Cover cover) {
  Lemke lemke;
  lemke.options.cover = cover;
  return lemke;
}

Lemke from_start() {
  Lemke lemke = covered(Cover::Ones);
  lemke.options.start = LemkeStart::Regular;
  return lemke;
}

std::vector<Attempt> automatic_list() {
  return {{.method = Lemke{},
           .title = "lemke with few pivots",
           .when = {If::FewRows},
           .pivots = 0,
           .pivots_a_row = 2,
           .reason = "most problems need about n pivots, which take less than to tell the class of M",
           .worth = "without it definite problems of 12 to 48 rows take 4 to 7 times as long"},
          {.method = BoundQp{},
           .when = {If::Large, If::Convex},
           .reason = "multigrid",
           .worth = "obstacle problems of a million unknowns"},
          {.method = BlockPivoting{.max_iterations = 100},
           .when = {If::P},
           .reason = "mostly five rounds, each a factorization; beside skew matrices they take 2^n",
           .worth = "Murty's problems, on which others take 2^n pivots"},
          {.method = InteriorPoint{},
           .when = {If::Monotone},
           .reason = "some twenty factorizations, whatever the active set",
           .worth = "without it 7 of 111 programs are lost, and the others take more than twice the time in all"},
          {.method = Lemke{}, .when = {If::Pivotable}, .reason = "solves or refutes copositive-plus and P-matrices"},
          {.method = covered(Cover::Spread),
           .title = "lemke with a widely spread covering vector",
           .when = {If::Pivotable},
           .reason = "another path",
           .worth = "1 of 501 problems of the collection and random ones is lost without it"},
          {.method = LemkeHowson{},
           .when = {If::Pivotable},
           .reason = "bimatrix games",
           .worth = "27 of 501 are lost without it"},
          {.method = from_start(),
           .title = "lemke from the start",
           .when = {If::Pivotable},
           .reason = "another path",
           .worth = "2 of 501 are lost without it"},
          {.method = Enumeration{},
           .when = {If::FewCells},
           .reason = "all cells: a solution, or the proof that there is none"}};
}

constexpr Index few_rows = 100;
constexpr Index large = 2000;
constexpr Index pivotable = 20'000;
constexpr Index few_cells = 20;  // a million cells

/// Decides conditions on a problem, and says what of it makes them hold, each once it is asked for.
class Facts {
 public:
  explicit Facts(const AffineMcp& problem) : problem_(problem) {}

  /// Returns the reasons; nothing if one of the conditions does not hold.
  std::optional<std::string> hold(const std::vector<Condition>& conditions) {
    std::string reasons;
    for (const Condition condition : conditions) {
      const std::optional<std::string> reason = holds(condition);
      if (!reason) return std::nullopt;
      if (!reason->empty()) reasons += (reasons.empty() ? "" : ", ") + *reason;
    }
    return reasons;
  }

 private:
  std::optional<std::string> holds(Condition condition) {
    const Index n = problem_.size();
    const auto if_so = [condition](bool holds) {
      return holds ? std::optional(std::string(words_of(condition))) : std::nullopt;
    };
    const auto silently = [](bool holds) { return holds ? std::optional(std::string()) : std::nullopt; };
    switch (condition) {
      case If::FewRows:
        return if_so(n <= few_rows);
      case If::Large:
        return silently(n > large);
      case If::Pivotable:
        return silently(n <= pivotable);
      case If::FewCells:
        return if_so(cells() <= few_cells);
      case If::Convex:
        return if_so(symmetric() && !form().no());
      case If::P:
        if (!positive_diagonal()) return std::nullopt;
        for (const auto& [property, text] : {std::pair{&classes().m, "an M-matrix"},
                                             {&classes().h_plus, "an H-matrix with positive diagonal"},
                                             {&classes().positive_definite, "positive definite"},
                                             {&classes().p, "a P-matrix"}})
          if (property->yes()) return text_of("M is ", text, ": ", property->reason);
        return std::nullopt;
      case If::Monotone:
        if (!form().yes()) return std::nullopt;
        return text_of("M is positive semidefinite: ", form().reason);
    }
    return std::nullopt;
  }

  ClassifyOptions cheap() {
    // Large symmetric M are the QP's, whatever their factors would say.
    return {.factor_to = problem_.size() > large && symmetric() ? 0 : 50'000,
            .dense_to = 100,
            .minors_to = 12,
            .p0_to = 0,
            .copositive_to = 0};
  }
  const Diagnosis& classes() {
    if (!classes_) classes_ = classify(problem_, cheap());
    return *classes_;
  }
  /// Tells whether v'Mv is never negative.
  const Property& form() {
    if (classes_) return classes_->positive_semidefinite;
    if (!form_) form_ = positive_semidefinite(problem_, cheap());
    return *form_;
  }
  bool symmetric() {
    if (!symmetric_) symmetric_ = lcp::symmetric(problem_.M);
    return *symmetric_;
  }
  /// P-matrices have one.
  bool positive_diagonal() const {
    for (Index i = 0; i < problem_.size(); ++i)
      if (!problem_.box.is_fixed(i) && !(problem_.M.coeff(i, i) > 0)) return false;
    return true;
  }

  Index cells() const {  // variables that have more than one place
    Index count = 0;
    const Box& box = problem_.box;
    for (Index i = 0; i < box.size(); ++i)
      count += box.lower[i] < box.upper[i] && (box.lower[i] > -infinity || box.upper[i] < infinity);
    return count;
  }

  const AffineMcp& problem_;
  std::optional<Diagnosis> classes_;
  std::optional<Property> form_;
  std::optional<bool> symmetric_;
};

std::string title_of(const Attempt& attempt) {
  return std::string(attempt.title.empty() ? name(attempt.method) : attempt.title);
}

/// Runs the attempt within its pivots.
Result run(const Attempt& attempt, const AffineMcp& problem, In start, const Limits& limits) {
  Method method = attempt.method;
  if (auto* lemke = std::get_if<Lemke>(&method)) {
    const auto n = static_cast<int>(std::min<Index>(problem.size(), 1'000'000));
    lemke->options.max_pivots = std::min(lemke->options.max_pivots, attempt.pivots + attempt.pivots_a_row * n);
  }
  return solve_in_order(problem, start, method, limits);
}

}  // namespace

Auto::Auto() : list(automatic_list()) {}

std::string_view words_of(Condition condition) {
  switch (condition) {
    case If::FewRows:
      return "n <= 100";
    case If::Large:
      return "n > 2000";
    case If::Pivotable:
      return "n <= 20,000";
    case If::FewCells:
      return "at most 20 variables have a bound";
    case If::Convex:
      return "M is symmetric and not known to be indefinite";
    case If::P:
      return "M is a P-matrix";
    case If::Monotone:
      return "M is positive semidefinite";
  }
  return "";
}

void describe(Auto& m, Fields& f) {
  for (Attempt& attempt : m.list) std::visit([&](auto& method) { describe(method, f); }, attempt.method);
}

Result automatic(const AffineMcp& problem, In start, const Auto& method, const Limits& limits) {
  check_input("auto", problem, start, limits);
  Result best = judged(problem, start, limits, Status::Stalled, "the list of methods is empty");
  if (best.solved()) return best;
  Facts facts(problem);
  std::string tried;
  long iterations = 0;
  int factorizations = 0;
  bool settled = false;
  for (const Attempt& attempt : method.list) {
    const std::optional<std::string> why = facts.hold(attempt.when);
    if (!why) continue;
    Result result = run(attempt, problem, start, limits);
    iterations += result.iterations;
    factorizations += result.factorizations;
    settled = result.accepted() || result.status == Status::Infeasible || limits.reached().has_value();
    if (settled)
      result.message =
          text_of(title_of(attempt), " (", why->empty() ? attempt.reason : std::string_view(*why), ')',
                  result.message.empty() ? "" : ": ", result.message, tried.empty() ? "" : "; tried before: ", tried);
    tried += text_of(tried.empty() ? "" : ", ", title_of(attempt), ": ", result.status);
    if (settled || result.residual < best.residual) best = std::move(result);
    if (settled) break;
  }
  best.iterations = iterations;
  best.factorizations = factorizations;
  if (settled) return best;
  best.status = Status::Stalled;
  best.message = "no method settled the problem; tried: " + tried;
  return best;
}

}  // namespace perp::lcp
