// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Options by their names (ncp/settings/settings.hpp), by the names of app/.
#include "app/options/methods.hpp"
#include "app/options/options_text.hpp"
#include "ncp/settings/settings.hpp"

namespace perp::app {

using settings::Applied;
using settings::apply_options;
using settings::describe;
using settings::fields_of;
using settings::ignored_options;
using settings::note_limits_of_size;
using settings::Option;
using settings::options;
using settings::Output;
using settings::path_options;
using settings::set;
using settings::Settings;
using settings::Switch;
using settings::Unknown;
using settings::UnknownOption;
using settings::value_text;

}  // namespace perp::app
