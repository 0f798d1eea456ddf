#pragma once
/// `perp cfunctions`: the catalogue of C-functions and smoothings.
#include "app/program/program.hpp"

namespace perp::app {

/// Prints formula, parameter with range, properties and reference of each.
int print_cfunctions(Streams streams);

}  // namespace perp::app
