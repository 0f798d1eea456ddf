// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The calls of the system that bounded_call() makes.
#include <functional>
#include <string_view>

namespace perp::app {

/// Runs `work`, which throws nothing, on a thread of its own that nobody waits for. Its stack is as deep as the first
/// thread's: AMPL's expressions are evaluated by recursion. It takes no signals, which are for the first thread and for
/// whoever waits for them. False where no thread can be made.
bool start_thread(std::function<void()> work);

/// Ends the process at once, wherever its other threads are: they may hold the streams.
[[noreturn]] void leave(std::string_view why, int code);

}  // namespace perp::app
