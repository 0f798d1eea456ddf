// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What every method's loop shares: counted and guarded evaluation, limits, observers, the best point, the verdict.
/// Private to ncp/.
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "ncp/problem/counted_mcp.hpp"
#include "ncp/problem/words.hpp"
#include "ncp/run/judge.hpp"
#include "ncp/run/observe.hpp"
#include "ncp/run/options.hpp"
#include "ncp/run/result.hpp"
#include "ncp/run/transform.hpp"

namespace perp::ncp {

class Run;
/// What is done in a run, from x0 on, until the run ends: a method, or several in turn.
using Body = std::function<void(Run&, In x0)>;

/// What a run within another one gets of what is left of the limits, and what becomes of its records.
struct Share {
  int iterations = std::numeric_limits<int>::max();  ///< at most
  int F_evals = std::numeric_limits<int>::max();     ///< at most
  int pivots = std::numeric_limits<int>::max();      ///< at most
  std::optional<double> tol{};                       ///< of its own problem; none: that of the run it is in
  bool shown = true;                                 ///< to the observer
  bool start_shown = true;
};

/// When a residual last fell by a tenth.
class Progress {
 public:
  /// Of an attempt that begins after so many iterations.
  explicit Progress(int iteration = 0) : iteration_(iteration) {}
  void met(double residual, int iteration) {
    if (!(residual < 0.9 * mark_)) return;
    mark_ = residual;
    iteration_ = iteration;
    time_ = std::chrono::steady_clock::now();
  }
  /// Iterations since then, and seconds.
  int iterations(int now) const { return now - iteration_; }
  double seconds() const { return Seconds(std::chrono::steady_clock::now() - time_).count(); }

 private:
  double mark_ = infinity;
  int iteration_;
  std::chrono::steady_clock::time_point time_ = std::chrono::steady_clock::now();
};

/// "solution found: the natural residual is 1.2e-10".
std::string solution_found(const Residual& residual);

class Run {
 public:
  /// Word::Preliminary: of a run within another one, whose solution that one judges on its own problem.
  Run(const Mcp& mcp, const Stop& stop, const Observer& observer, Judge::Word word = Judge::Word::Last);

  const Mcp& mcp() const { return counted_.mcp(); }
  const Box& box() const { return mcp().box(); }
  CountedMcp& counted() { return counted_; }
  Stats& stats() { return stats_; }
  const Stats& stats() const { return stats_; }
  int iterations() const { return stats_.iterations; }

  /// F and, unless a method does without, J at the projection of x0. False with the verdict made if they are not
  /// defined there.
  bool start(In x0, Point& point, bool with_J = true);
  /// F and J at x; false if one of them is not defined there.
  bool evaluate(Point& point) { return counted_.eval(point.x, point.F) && counted_.jacobian(point.x, point.J); }

  /// Judges the iterate's projection onto the box, tells the observers and looks at the limits. False: the run is over,
  /// with a verdict.
  bool go_on(const Point& point, Iteration it);
  /// Of iterations or evaluations.
  bool at_limit() const { return iterations() >= stop_.max_iterations || F_evals() >= stop_.max_F_evals; }
  /// The tolerance of the judge.
  double tol() const { return stop_.tol; }
  /// What is left of the limits.
  Stop left() const;
  /// Whether Iteration::way is asked for.
  bool shows_ways() const { return observer_.ways; }
  /// For subproblems: has somebody asked to stop?
  bool interrupted() const { return stop_.interrupt != nullptr && *stop_.interrupt; }
  std::chrono::steady_clock::time_point deadline() const { return deadline_; }

  /// Ends the run. Solved cannot be said: the judge says it, and where nothing is proven it looks at the best point
  /// once more: SolvedToRounding.
  void end(Status status, std::string message, std::string advice);
  /// Ends the run as Infeasible if the multipliers `y` of rows (may be empty), or bounds carried from row to row, prove
  /// that no point has a natural residual of at most the tolerance. `words` say why.
  bool disprove(const Vec& y, const std::string& words);
  /// Ends it so with a proof that is there.
  void end_infeasible(Infeasibility proof, std::string message);
  bool ended() const { return status_.has_value(); }
  Status status() const { return *status_; }  ///< Pre: ended()
  struct Verdict {
    Status status;
    std::string message, advice;
    Infeasibility proof{};
  };
  Verdict verdict() const { return {*status_, message_, advice_, proof_}; }  ///< Pre: ended()
  bool accepted() const { return status_ == Status::Solved || status_ == Status::SolvedToRounding; }
  /// Whether stop.max_stall, and iterations enough, have passed without progress, so that no further attempt is worth
  /// its time.
  bool stalled() const;
  double idle() const { return progress_.seconds(); }  ///< [s] without progress
  /// Sets a test that is called before each new attempt; if it returns true, no attempt follows.
  void give_up_where(std::function<bool()> hopeless) { hopeless_ = std::move(hopeless); }
  bool hopeless() const { return hopeless_ && hopeless_(); }
  /// Of several attempts that all got stuck. Pre: not accepted().
  void replace_verdict(Verdict verdict);
  /// A run of its own on `mcp`, within what is left of this one's limits, whose records count on from this one's. Its
  /// outcome means nothing to this run yet: see take() and charge().
  Result within(const Mcp& mcp, const Share& share, In x0, const Body& body);
  /// The same on the transformed problem, from there(x0); records, point, basis and residual come back, and of what was
  /// accepted there the problem itself is the judge. `accepted_there` tells of it, if given.
  Result within(const Transform& way, const Share& share, In x0, const Body& body, bool* accepted_there = nullptr);
  /// Withdraws a verdict that another attempt may better (stuck(Status)); its iterations count on from here, and its
  /// first record says what it is.
  void resume(std::string attempt);
  int F_evals() const { return stats_.F_evals + counted_.F_evals(); }
  int J_evals() const { return stats_.J_evals + counted_.J_evals(); }
  /// What begins with the next record of a run within this one.
  void next_attempt(std::string attempt) { attempt_ = std::move(attempt); }
  /// For the end of the message, whatever the verdict; nothing if empty.
  void remark(const std::string& text);
  /// Another run's outcome on the same problem: its statistics, its point if it is better, its basis if it has one, and
  /// its verdict.
  void take(const Result& other);
  /// The statistics alone, and the verdict where a limit of this run has ended the other one.
  void charge(const Result& other);
  /// The point alone, if it is better.
  void take_point(const Result& other);
  /// A judged record of a point that no method came to by a step. False: somebody asked to stop, and the run is over.
  bool show(const Vec& x, Iteration it, Residual& residual);
  /// Sets the basis that the first PathSearch of the run begins with.
  void warm(std::vector<lcp::Cell> basis) { warm_basis_ = std::move(basis); }
  const std::vector<lcp::Cell>& warm_basis() const { return warm_basis_; }
  std::vector<lcp::Cell> take_warm_basis() { return std::exchange(warm_basis_, {}); }
  /// For Result::basis.
  void keep_basis(std::vector<lcp::Cell> basis) { basis_ = std::move(basis); }
  const std::vector<lcp::Cell>& basis() const { return basis_; }
  /// The best point of the box so far, with F there.
  const Vec& best() const { return best_.x; }
  double best_residual() const { return best_.residual.natural; }
  /// A best point from before the residual fell to a tenth and less, and its residual; empty if there was none.
  const Judged& earlier() const { return earlier_; }
  /// The verdict with the best point; x0, F not evaluated, where no point was met.
  Result result(In x0);

  const std::string equation(Index i) const { return mcp().equation_name(i); }

 private:
  /// The observer, for a run within this one: its records count on from here.
  Observer counting_on(bool start_shown);
  std::string take_attempt() { return std::exchange(attempt_, {}); }
  Result within(const Mcp& mcp, const Stop& limits, const Observer& shown, In x0, std::vector<lcp::Cell> basis,
                const Body& body, Judge::Word word);
  /// If a limit of this run has ended the other one, this run too.
  bool ended_with(const Result& other);
  /// Of the projection of `point`: an answer lies in the box.
  Judged judged(const Point& point);
  /// Interrupted, TimeLimit or IterationLimit, in this run's numbers.
  void end_at(Status limit, std::string advice);
  /// Whether the attempt that runs has come to nothing for too long.
  bool attempt_stalled() const;
  /// Takes a better point.
  void keep_best(Judged&& better);
  /// Makes the verdict Solved if the judge says so (Judge::solved()); J there, if it is known.
  bool solved(Judged& judged, const SpMat* J = nullptr);
  /// The best point is Solved after all, or SolvedToRounding.
  bool settled();
  /// Returns what is proven of this problem, with the multipliers of a proof on a transformed one; no bound if that is
  /// less than the tolerance.
  Infeasibility proven(const Vec& y) const;
  /// The same by a certificate of this problem, if it holds.
  Infeasibility proven(std::optional<lcp::Refutation> refutation) const;

  CountedMcp counted_;
  const Stop& stop_;
  Judge judge_;
  const Observer& observer_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point deadline_;
  Stats stats_;  // its evaluations are those of other runs; this one's are counted_'s
  std::optional<Status> status_;
  std::string message_, advice_;
  Infeasibility proof_;
  int offset_ = 0;       // iterations of earlier attempts
  std::string attempt_;  // that begins
  Judged best_;
  Judged decade_, earlier_;       // best points; earlier_ of ten times decade_'s residual, or more
  Progress progress_, attempts_;  // of the best point; of the attempt that runs
  std::vector<lcp::Cell> basis_, warm_basis_;
  std::function<bool()> hopeless_;
};

/// Ends that another method, start or perturbation may better.
bool stuck(Status status);
/// "; the best point has natural residual ..., worst in equation ...", for results that are not solved.
std::string words_on_best(const Mcp& mcp, const Result& result);

}  // namespace perp::ncp
