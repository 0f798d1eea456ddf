#pragma once
/// The command line of `perp compare`.
#include <CLI/App.hpp>

#include "app/compare/compare.hpp"

namespace perp::app::compare {

/// Adds the command; what it is called with goes to `request`, which must outlive `app`.
CLI::App* add_command(CLI::App& app, CompareRequest& request);

}  // namespace perp::app::compare
