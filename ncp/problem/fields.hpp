// SPDX-License-Identifier: Apache-2.0
#pragma once
/// lcp/fields.hpp, by the names of ncp/.
#include "lcp/fields.hpp"

namespace perp::ncp {

using perp::above;
using perp::above_up_to;
using perp::alternatives;
using perp::at_least;
using perp::between;
using perp::Field;
using perp::Fields;
using perp::Flag;
using perp::Parameter;
using perp::Range;
using perp::Seconds;
using perp::strictly_between;
using perp::takes;
using perp::Target;
using perp::Words;

}  // namespace perp::ncp
