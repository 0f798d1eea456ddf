#pragma once
/// load() and run() within their limits, whatever they are doing when those are reached.
#include <memory>

#include "app/bounded_run.hpp"
#include "app/contact/run.hpp"

namespace perp::app::contacts {

/// Throws what load() does, and OutOfTime.
std::shared_ptr<const Loaded> load_within(const Patience& patience, const std::string& argument);

/// run() with the limits, of which the time is what is left of `patience`. Where it does not come back: the best point
/// met, judged, with status TimeLimit or Interrupted.
Run run_within(const Patience& patience, std::shared_ptr<const Loaded> loaded, const Variant& variant,
               const Limits& limits);

}  // namespace perp::app::contacts
