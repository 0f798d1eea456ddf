#include "lcp/pivoting/lemke.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "lcp/pivoting/normal_path.hpp"

namespace perp::lcp {
namespace {

std::optional<PivotEnd> limit(const LemkeOptions& options, const PivotResult& result) {
  if (options.interrupted && options.interrupted()) return PivotEnd::Interrupted;
  if (std::chrono::steady_clock::now() >= options.deadline) return PivotEnd::TimeLimit;
  if (result.pivots >= options.max_pivots) return PivotEnd::PivotLimit;
  return std::nullopt;
}

template <class... Part>
[[noreturn]] void refuse(const Part&... part) {
  std::ostringstream what;
  what << "lemke: ";
  (what << ... << part);
  throw std::invalid_argument(what.str());
}

void check_options(const LemkeOptions& options, Index n) {
  for (const auto& [name, value] : {std::pair{"residual_tol", options.residual_tol},
                                    {"pivot_tol", options.pivot_tol},
                                    {"doubtful_pivot", options.doubtful_pivot},
                                    {"feasibility_tol", options.feasibility_tol},
                                    {"perturbation", options.perturbation}})
    if (!(value >= 0) || std::isinf(value)) refuse("the option ", name, " is ", value, ", not a finite number >= 0");
  if (!options.cells.empty() && static_cast<Index>(options.cells.size()) != n)
    refuse("the warm basis has ", options.cells.size(), " cells, the problem ", n, " variables");
  if (options.cover != Cover::Given) return;
  if (options.covering.size() != n)
    refuse("the covering vector has ", options.covering.size(), " entries, the problem ", n);
  for (Index i = 0; i < n; ++i)
    if (!(options.covering[i] > 0) || std::isinf(options.covering[i]))
      refuse("the covering vector's entry of index ", i, " is ", options.covering[i], ", not positive");
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
    path_.push_back({at.t(), at.x()});
  }
  void finish(const NormalPath& at) {
    if (on_) path_.push_back({at.t(), at.x()});
  }

 private:
  bool on_;
  std::size_t limit_;
  std::size_t stride_ = 1;
  std::size_t count_ = 0;
  std::vector<Breakpoint>& path_;
};

PivotResult follow(const AffineMcp& problem, In start, const LemkeOptions& options) {
  PivotResult result;
  const auto owner = std::make_shared<NormalPath>(problem, start, options);
  NormalPath& path = *owner;
  Kinks kinks(options, result.path);
  bool on_the_way = path.begin(result);
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
  switch (end) {
    case PivotEnd::Solved:
      return "solved";
    case PivotEnd::Ray:
      return "ray";
    case PivotEnd::Loop:
      return "loop";
    case PivotEnd::SingularBasis:
      return "singular basis";
    case PivotEnd::PivotLimit:
      return "pivot limit";
    case PivotEnd::TimeLimit:
      return "time limit";
    case PivotEnd::Interrupted:
      return "interrupted";
    case PivotEnd::Inaccurate:
      return "inaccurate";
  }
  return "?";
}

Vec chord_step(const PivotResult& result, In r) { return result.last_piece->chord_step(r); }

PivotResult lemke(const AffineMcp& problem, In start, const LemkeOptions& options) {
  if (const auto why = problem.invalid()) refuse(*why);
  if (start.size() != problem.size()) refuse("the start has ", start.size(), " entries, the problem ", problem.size());
  for (Index i = 0; i < start.size(); ++i)
    if (!std::isfinite(start[i])) refuse("the start of index ", i, " is ", start[i]);
  check_options(options, problem.size());

  PivotResult result = follow(problem, start, options);
  // A path that lost its digits on the way has mostly gone astray by a cell or two: a new one from its end gets there.
  for (int k = 0; k < restarts && result.end == PivotEnd::Inaccurate; ++k) {
    LemkeOptions again = options;
    again.start = LemkeStart::Regular;
    again.cells = result.cells;
    again.seed += static_cast<unsigned>(k);
    again.max_pivots = options.max_pivots - result.pivots;
    PivotResult next = follow(problem, result.x, again);
    next.pivots += result.pivots;
    next.refactorizations += result.refactorizations;
    next.path.insert(next.path.begin(), result.path.begin(), result.path.end());
    if (next.end != PivotEnd::Solved && next.residual > result.residual) next.end = PivotEnd::Inaccurate;
    result = std::move(next);
  }
  return result;
}

}  // namespace perp::lcp
