// SPDX-License-Identifier: Apache-2.0
#pragma once
/// How options are written (ncp/settings/assignments.hpp), by the names of app/.
#include "ncp/settings/assignments.hpp"

namespace perp::app {

using settings::Assignment;
using settings::lowercase;
using settings::parse_assignment;
using settings::parse_options_file;
using settings::parse_words;
using settings::read_options_file;

}  // namespace perp::app
