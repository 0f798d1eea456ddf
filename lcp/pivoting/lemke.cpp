// SPDX-License-Identifier: Apache-2.0
#include "lcp/pivoting/lemke.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "lcp/judge/result.hpp"
#include "lcp/judge/shared_options.hpp"
#include "lcp/pivoting/normal_path.hpp"
#include "lcp/pivoting/split_free.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {
namespace {

std::optional<PivotEnd> limit(const LemkeOptions& options, const PivotResult& result) {
  if (options.interrupted && options.interrupted()) return PivotEnd::Interrupted;
  if (std::chrono::steady_clock::now() >= options.deadline) return PivotEnd::TimeLimit;
  if (result.pivots >= options.max_pivots) return PivotEnd::PivotLimit;
  return std::nullopt;
}

/// What depends on the problem.
void check_lengths(const LemkeOptions& options, Index n) {
  if (!options.cells.empty() && static_cast<Index>(options.cells.size()) != n)
    refuse_input("lemke: the warm basis has ", options.cells.size(), " cells, the problem ", n, " variables");
  if (options.cover == Cover::Given && options.covering.size() != n)
    refuse_input("lemke: the covering vector has ", options.covering.size(), " entries, the problem ", n);
}

/// The kinks of a path, thinned out where they are too many.
class Kinks {
 public:
  Kinks(const LemkeOptions& options, std::vector<Breakpoint>& path)
      : on_(options.keep_path), limit_(std::max<std::size_t>(2, options.path_limit)), path_(path) {}
  void add(const NormalPath& at) {
    if (!on_ || count_++ % stride_ != 0) return;
    if (path_.size() >= limit_) {
      for (std::size_t k = 1; 2 * k < path_.size(); ++k) path_[k] = std::move(path_[2 * k]);
      path_.resize((path_.size() + 1) / 2);
      stride_ *= 2;
      if ((count_ - 1) % stride_ != 0) return;
    }
    path_.push_back({at.t(), at.equilibrated_x()});
  }
  void finish(const NormalPath& at) {
    if (!on_) return;
    path_.push_back({at.t(), at.equilibrated_x()});
    for (Breakpoint& kink : path_) at.make_original(kink.x);
  }

 private:
  bool on_;
  std::size_t limit_;
  std::size_t stride_ = 1;
  std::size_t count_ = 0;
  std::vector<Breakpoint>& path_;
};

bool has_free(const Box& box) {
  for (Index i = 0; i < box.size(); ++i)
    if (box.is_free(i)) return true;
  return false;
}

/// A path from a ray is not followed where free variables have dependent columns; they are in `dependent` then.
PivotResult follow(const AffineMcp& problem, In start, const LemkeOptions& options, std::vector<Index>& dependent) {
  PivotResult result;
  const auto owner = std::make_shared<NormalPath>(problem, start, options);
  NormalPath& path = *owner;
  Kinks kinks(options, result.path);
  bool on_the_way = path.begin(result);
  // The factors of a split problem are not those of its last piece.
  const bool may_split = options.start == LemkeStart::Ray && !options.keep_basis && has_free(problem.box);
  if (on_the_way && may_split && result.repaired > 0) dependent = path.waiting();
  on_the_way = on_the_way && dependent.empty();
  while (on_the_way) {
    kinks.add(path);
    if (const auto end = limit(options, result)) {
      result.end = *end;
      break;
    }
    on_the_way = path.advance(result);
  }
  kinks.finish(path);
  result = path.finish(std::move(result));
  if (options.keep_basis && result.solved() && path.whole()) result.last_piece = owner;
  return result;
}

/// After paths that lost their digits.
constexpr int restarts = 3;

}  // namespace

std::string_view to_string(PivotEnd end) {
  using enum PivotEnd;
  static constexpr std::pair<PivotEnd, std::string_view> words[] = {{Solved, "solved"},
                                                                    {Ray, "ray"},
                                                                    {Loop, "loop"},
                                                                    {SingularBasis, "singular basis"},
                                                                    {PivotLimit, "pivot limit"},
                                                                    {TimeLimit, "time limit"},
                                                                    {Interrupted, "interrupted"},
                                                                    {Inaccurate, "inaccurate"}};
  return word_of(end, words);
}

void describe(LemkeOptions& l, Fields& f) {
  describe_lu(l.basis.lu, f);
  f.add("minor_iteration_limit", &l.max_pivots, at_least(0),
        "limit of pivots for one linearised problem, and never more than 1000 + 20 n; or for Lemke's method alone",
        "max_pivots");
  f.choice("lemke_cover", &l.cover, {{"ones", Cover::Ones}, {"generic", Cover::Generic}, {"spread", Cover::Spread}},
           "Lemke's covering vector: ones (the textbook's e), generic (random about e in equilibrated units) or spread "
           "(log-uniform over three decades)");
  f.add("lemke_seed", &l.seed, between(0, std::numeric_limits<int>::max()), "seed of the perturbation and of the ray",
        "seed");
  // Inner tolerances that no run was seen to depend on.
  f.add("pivot_tolerance", &l.pivot_tol, strictly_between(0, 1), {});
  f.add("lemke_perturbation", &l.perturbation, between(0, 1e100), {});
  f.add("refactor_every", &l.basis.refactor_every, at_least(1), {});
  f.add("lemke.residual_tol", &l.residual_tol, above(0), {});
  f.add("lemke.feasibility_tol", &l.feasibility_tol, at_least(0), {});
  f.add("lemke.singular_rcond", &l.singular_rcond, {.high = 1, .open_high = true}, {});
  f.add("lemke.basis.fill_limit", &l.basis.fill_limit, {.open_low = true}, {});
  f.add("lemke.basis.unstable_tol", &l.basis.unstable_tol, {.high = 1, .open_high = true}, {});
  f.add("lemke.basis.singular_tol", &l.basis.singular_tol, {.high = 1, .open_high = true}, {});
  f.add("lemke.doubtful_pivot", &l.doubtful_pivot, at_least(0), {});
  for (Index i = 0; l.cover == Cover::Given && i < l.covering.size(); ++i)
    f.check(above(0).has(l.covering[i]), "lemke.covering", l.covering[i], "positive");
}

void describe_start(LemkeStart& start, Fields& f) {
  f.choice("lemke_start", &start,  // only PathSearch can start from a ray in the first iteration alone
           {{"automatic", LemkeStart::Regular}, {"first", LemkeStart::Regular}, {"always", LemkeStart::Ray}},
           lemke_start_help);
}

Vec chord_step(const PivotResult& result, In r) { return result.last_piece->chord_step(r); }

PivotResult lemke(const AffineMcp& problem, In start, const LemkeOptions& options) {
  check_input("lemke", problem, start);
  refuse_invalid("lemke", options);
  check_lengths(options, problem.size());

  std::vector<Index> dependent;
  PivotResult result = follow(problem, start, options, dependent);
  if (!dependent.empty()) {
    const SplitFree split(problem, std::move(dependent), options);
    return split.back(lemke(split.problem(), split.there(start), split.there(options)));
  }
  // A path that lost its digits on the way has mostly gone astray by a cell or two: a new one from its end gets there.
  for (int k = 0; k < restarts && result.end == PivotEnd::Inaccurate; ++k) {
    LemkeOptions again = options;
    again.start = LemkeStart::Regular;
    again.cells = result.cells;
    again.seed += static_cast<unsigned>(k);
    again.max_pivots = options.max_pivots - result.pivots;
    PivotResult next = follow(problem, result.x, again, dependent);
    next.pivots += result.pivots;
    next.refactorizations += result.refactorizations;
    next.path.insert(next.path.begin(), result.path.begin(), result.path.end());
    if (next.end != PivotEnd::Solved && next.residual > result.residual) next.end = PivotEnd::Inaccurate;
    result = std::move(next);
  }
  return result;
}

}  // namespace perp::lcp
