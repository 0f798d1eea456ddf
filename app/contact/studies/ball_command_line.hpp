#pragma once
/// The command line of `perp contact ball`.
#include <CLI/App.hpp>
#include <atomic>

#include "app/contact/studies/ball.hpp"

namespace perp::app::contacts {

/// Adds it to `perp contact`; what it is called with goes to `request`, which must outlive `contact`.
CLI::App* add_ball_command(CLI::App& contact, BallRequest& request);

/// Runs it if it was called; its exit code. What stands before `ball` is refused.
int run_ball_command(const CLI::App& contact, const BallRequest& request, Streams streams,
                     const std::atomic<bool>* interrupt);

}  // namespace perp::app::contacts
