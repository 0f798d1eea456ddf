// SPDX-License-Identifier: Apache-2.0
#include "contact/solvers/sequence.hpp"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <unordered_set>
#include <utility>
#include <vector>

#include "contact/solvers/follow.hpp"
#include "lcp/words.hpp"

namespace perp::contact {
namespace {

long factorizations_of(const Run& run) {
  for (const auto& [what, n] : run.counts)
    if (what == "factorizations") return n;
  return 0;
}

void check_keys(std::span<const ContactKey> keys) {
  std::unordered_set<ContactKey> met;
  for (std::size_t a = 0; a < keys.size(); ++a)
    if (!met.insert(keys[a]).second)
      refuse_input("contact sequence: the key ", keys[a], " of contact ", a, " is that of another contact, too");
}

}  // namespace

Vec KeptImpulses::start(int dimension, std::span<const ContactKey> keys) const {
  check_keys(keys);
  Vec r = Vec::Zero(dimension * static_cast<Index>(keys.size()));
  bool known = false;
  for (std::size_t a = 0; a < keys.size(); ++a) {
    const auto found = impulses_.find(keys[a]);
    if (found == impulses_.end() || found->second.size() != dimension) continue;
    r.segment(dimension * static_cast<Index>(a), dimension) = found->second;
    known = true;
  }
  return known ? r : Vec();
}

void KeptImpulses::keep(int dimension, std::span<const ContactKey> keys, In r) {
  impulses_.clear();
  for (std::size_t a = 0; a < keys.size(); ++a)
    impulses_[keys[a]] = r.segment(dimension * static_cast<Index>(a), dimension);
}

Sequence::Sequence(SequenceOptions options)
    : options_(std::move(options)), follower_(std::make_unique<Follower>(*spent_)) {}
Sequence::~Sequence() = default;
Sequence::Sequence(Sequence&&) noexcept = default;
Sequence& Sequence::operator=(Sequence&&) noexcept = default;

void Sequence::count(const Run& run) {
  stats_.seconds += run.seconds;
  stats_.factorizations += factorizations_of(run);
  stats_.iterations += run.steps();
}

Run Sequence::run_once(const Problem& problem, Vec start, double seconds) {
  RunLimits limits = options_.limits;
  limits.start = std::move(start);
  limits.seconds = seconds;
  Run run = contact::run(problem, options_.variant, limits);
  count(run);
  return run;
}

/// By the follower; not solved where that fails.
Run Sequence::follow(const Problem& problem, const Vec& start) {
  const auto begin = std::chrono::steady_clock::now();
  const auto spent = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); };
  const RunLimits& limits = options_.limits;
  check(problem);
  const Scaled& coordinates = follower_->take(problem);
  const Judge is_a_solution(problem);
  Residual last;
  Vec u;
  Origin by = Origin::WarmStart;
  const auto accept = [&](const Vec& r, Origin made_by) {
    const Vec impulses = coordinates.expand(r);
    if (!impulses.allFinite()) return false;
    by = made_by;
    last = is_a_solution(impulses, u);
    return accepted(last, limits.tol);
  };
  const auto stop = [&] { return spent() > limits.seconds || (limits.interrupt != nullptr && *limits.interrupt); };
  *spent_ = {};
  const std::optional<Vec> found = follower_->from(coordinates.reduce(start), accept, stop);
  Run run;
  run.counts = {{"iterations", spent_->iterations},
                {"sweeps", spent_->sweeps},
                {"newton_steps", spent_->newton_steps},
                {"factorizations", spent_->factorizations}};
  if (found) {
    run.status = Status::Solved;
    run.solved = true;
    run.solved_by = to_string(by);
    run.message = "solved: followed from the step before";
    run.solution.r = coordinates.expand(*found);
    run.solution.u = std::move(u);  // of the point that was judged last
    run.residual = last;
    run.seconds = spent();  // as of contact::run: the states are told afterwards
    run.states = states(problem, run.solution);
    ++stats_.followed;
  } else {
    run.seconds = spent();
  }
  count(run);
  return run;
}

/// Contacts with two disks are none of the follower's.
bool Sequence::follows(const Problem& problem) const { return options_.variant.automatic() && !problem.rolls(); }

/// From the step before, then cold.
Run Sequence::warm_step(const Problem& problem, Vec start) {
  Run run = follows(problem) ? follow(problem, start) : run_once(problem, std::move(start), options_.limits.seconds);
  if (run.solved) ++stats_.warm;
  const bool final = run.solved || run.status == Status::Interrupted || run.status == Status::Infeasible;
  const double left = options_.limits.seconds - run.seconds;
  // The follower gives up by itself: auto must be asked even if it took all of the time.
  if (final || (left <= 0 && !follows(problem))) return run;
  ++stats_.cold_again;
  Run again = run_once(problem, {}, std::max(left, 0.0));
  again.seconds += run.seconds;
  return again;
}

Run Sequence::step(const Problem& problem, std::span<const ContactKey> keys) {
  std::vector<ContactKey> by_order;
  if (keys.empty()) {
    by_order.resize(static_cast<std::size_t>(problem.contacts()));
    std::iota(by_order.begin(), by_order.end(), ContactKey{0});
    keys = by_order;
  }
  if (static_cast<Index>(keys.size()) != problem.contacts())
    refuse_input("contact sequence: there are ", keys.size(), " keys and ", problem.contacts(), " contacts");
  const long followed = stats_.followed;
  Vec start = options_.warm ? kept_.start(problem.dimension, keys) : Vec();
  Run run = start.size() > 0 ? warm_step(problem, std::move(start)) : run_once(problem, {}, options_.limits.seconds);
  ++stats_.steps;
  if (run.solved) {
    ++stats_.solved;
    kept_.keep(problem.dimension, keys, run.solution.r);
    if (options_.warm && follows(problem) && stats_.followed == followed)
      follower_->remember(follower_->take(problem).reduce(run.solution.r));
  }
  return run;
}

}  // namespace perp::contact
