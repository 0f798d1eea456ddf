// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Calls that are not waited for for ever. Factorizations, readers and devices look at no clock and at no flag: they
/// run on a thread of their own, which is left behind where it does not come back.
#include <atomic>
#include <chrono>
#include <functional>
#include <optional>

namespace perp::app {

using Clock = std::chrono::steady_clock;

/// How long a call is waited for.
struct Patience {
  Clock::time_point deadline = Clock::time_point::max();
  const std::atomic<bool>* interrupt = nullptr;  ///< may be null
};
/// From now on; without a deadline where the limit is longer than any clock.
Patience patience(std::chrono::duration<double> limit, const std::atomic<bool>* interrupt);

/// Why a call was left behind.
enum class GivenUp { TimeLimit, Interrupted };

/// Calls that look at the limits themselves get so long after them to come back with what they have.
inline constexpr std::chrono::milliseconds grace{200};

/// Runs `work` on a thread of its own and waits for it; what it throws is thrown here. Where it has not ended `grace`
/// after the deadline or after the flag was set, it is left behind and goes on until the process ends: `work` must own
/// all it uses, and the process must not run into its own destructors (calls_left_behind()). Where no thread can be
/// made it runs on this one.
std::optional<GivenUp> bounded_call(std::function<void()> work, const Patience& patience);

/// Whether a call goes on that nobody waits for: then the process ends by _exit.
bool calls_left_behind();

/// Ends the process, wherever its other threads are, if it is still there 0.9 s after the flag was set, or after what
/// end_by() says: for what is no bounded_call().
class Guard {
 public:
  /// Begins to watch. `interrupt` outlives the process' last command.
  explicit Guard(const std::atomic<bool>& interrupt);
};
/// The program has to have ended at that time; `max()` takes it back.
void end_by(Clock::time_point time);
/// A result is there and is being written, which may take so long although the user, or the clock, has asked to end.
void writing_takes(std::chrono::duration<double> time);

}  // namespace perp::app
