// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A run as JSON, for programs; docs/schema/ describes it.
#include <span>
#include <string>

#include "app/report/bounded_run.hpp"
#include "app/report/report.hpp"

namespace perp::app {

/// Numbers with as many digits (up to 17) as reading back the same double takes; infinities as "inf" and "-inf", NaN as
/// "nan".
std::string solve_json(const Report& report);
/// Input that was refused: status "InputError".
std::string refused_json(const std::string& problem, const std::string& message);
/// The time was over, or somebody asked to end, before there was a point: status "TimeLimit" or "Interrupted".
std::string no_point_json(const std::string& problem, const OutOfTime& why);

/// One entry of the collection, with everything about it, and several, with what the table says.
std::string problem_json(const ncp::collection::Entry& entry);
std::string list_json(std::span<const ncp::collection::Entry* const> entries);

/// Writes what --json PATH asks for: "" is nothing, "-" standard output. False: it could not be written, and `err` says
/// so.
bool deliver_json(const std::string& path, const std::string& content, Streams streams);
/// Says on `err` why `problem` was refused, and as JSON what --json PATH asks for; exit_input.
ExitCode deliver_refusal(const std::string& path, const std::string& problem, const std::string& why, Streams streams);

}  // namespace perp::app
