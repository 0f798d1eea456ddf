// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Contact problems one after another, as the steps of a simulation: each begins near the impulses of the one before.
///     Sequence sequence({.variant = variant_of("glocker")});
///     for (;;) { const Run run = sequence.step(problem, keys); ... }
/// A key names a contact from step to step: the pair of bodies and the feature that touch, say. A contact whose key the
/// last solved step had begins with its impulse of then, any other with 0. The components are those of the contact's
/// own frame (N, T1[, T2]): frames should turn with the bodies and not jump. Without keys contact a is the a-th of the
/// last step.
/// `auto` follows the solution first, by Newton's method and more (contact/solvers/follow.hpp). Where a method does not
/// get from there to a solution, it begins again without a start, in the time that is left. The judge is the same as
/// ever: nothing is solved because the step before was.
#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>

#include "contact/solvers/run.hpp"

namespace perp::contact {

using ContactKey = std::uint64_t;
class Follower;

/// Impulses by the names of their contacts.
class KeptImpulses {
 public:
  /// Returns those of these contacts, d entries each; 0 of contacts that are new. Empty, a cold start, if none is
  /// known. Throws std::invalid_argument if two keys are the same.
  Vec start(int dimension, std::span<const ContactKey> keys) const;
  /// Forgets all others. r has d entries a key.
  void keep(int dimension, std::span<const ContactKey> keys, In r);
  void forget() { impulses_.clear(); }

 private:
  std::unordered_map<ContactKey, Vec> impulses_{};
};

struct SequenceOptions {
  Variant variant{};   ///< affine laws and ncp1 always begin cold
  RunLimits limits{};  ///< of one step; its `start` is not used
  bool warm = true;    ///< false: every step cold
};

struct SequenceStats {
  long steps = 0;
  long solved = 0;
  long warm = 0;        ///< solved from the step before
  long followed = 0;    ///< of them by the follower, of `auto`
  long cold_again = 0;  ///< begun again without a start
  double seconds = 0;
  long factorizations = 0;
  long iterations = 0;  ///< Run::steps()
};

class Sequence {
 public:
  explicit Sequence(SequenceOptions options = {});
  ~Sequence();
  Sequence(Sequence&&) noexcept;
  Sequence& operator=(Sequence&&) noexcept;

  /// Solves the next problem by contact::run. `keys`: empty, or one a contact. Throws std::invalid_argument for what
  /// run() refuses, for another number of keys, and for two that are the same.
  Run step(const Problem& problem, std::span<const ContactKey> keys = {});
  /// The next step begins cold.
  void forget() { kept_.forget(); }
  const SequenceStats& stats() const { return stats_; }

 private:
  Run run_once(const Problem& problem, Vec start, double seconds);
  bool follows(const Problem& problem) const;
  Run follow(const Problem& problem, const Vec& start);
  Run warm_step(const Problem& problem, Vec start);
  void count(const Run& run);

  SequenceOptions options_;
  SequenceStats stats_{};
  KeptImpulses kept_{};
  std::unique_ptr<Stats> spent_ = std::make_unique<Stats>();  // by the follower in this step
  std::unique_ptr<Follower> follower_;
};

}  // namespace perp::contact
