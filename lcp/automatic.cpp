#include <algorithm>
#include <string>
#include <utility>

#include "lcp/solve.hpp"

namespace perp::lcp {
namespace {

/// Runs methods in turn until one settles the problem; keeps the best point and tells what was tried.
class Attempts {
 public:
  Attempts(const AffineMcp& problem, In start, const Limits& limits)
      : problem_(problem), start_(start), limits_(limits) {}

  /// Whether the problem is settled now: solved, proven infeasible, or the run stopped.
  bool run(const Method& method, const std::string& label, const std::string& why) {
    Result result = solve(problem_, start_, method, limits_);
    const std::string before = tried_.empty() ? "" : "; tried before: " + tried_;
    const long iterations = best_.iterations + result.iterations;
    const int factorizations = best_.factorizations + result.factorizations;
    const bool stopped = limits_.reached().has_value();
    settled_ = result.solved() || result.status == Status::Infeasible || stopped;
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

Lemke covered(Cover cover, unsigned seed, Index n) {
  Lemke lemke;
  lemke.options.cover = cover;
  lemke.options.seed = seed;
  lemke.options.max_pivots = 1000 + 20 * static_cast<int>(std::min<Index>(n, 1'000'000));
  return lemke;
}

}  // namespace

Result automatic(const AffineMcp& problem, In start, const Auto& method, const Limits& limits) {
  check_input("auto", problem, start, limits);
  Attempts attempts(problem, start, limits);
  const Index n = problem.size();
  if (attempts.run(covered(Cover::Ones, method.seed, n), "lemke", "")) return attempts.end();
  if (attempts.run(covered(Cover::Generic, method.seed, n), "lemke, generic covering vector", ""))
    return attempts.end();
  if (attempts.run(BlockPivoting{}, "block-pivoting", "")) return attempts.end();
  return attempts.end();
}

}  // namespace perp::lcp
