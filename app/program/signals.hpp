// SPDX-License-Identifier: Apache-2.0
#pragma once
/// SIGINT and SIGTERM.
#include <atomic>

namespace perp::app {

/// From now on the first of them sets `interrupted`, for the run to end with its best point; the second one ends the
/// process. Those of the other threads are to be made after this.
///
/// They are waited for, not handled: METIS, which orders for CHOLMOD and UMFPACK, puts a handler of its own in the
/// place of SIGTERM's while it works; that jumps into the stack of a thread that is not there.
void wait_for_signals(std::atomic<bool>& interrupted);

/// Blocks both in this thread and those that it makes.
void block_signals();

}  // namespace perp::app
