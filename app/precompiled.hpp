// cmake/precompiled.hpp for the program.
#include "cmake/precompiled.hpp"
//
#include <fmt/format.h>

#include <nlohmann/json.hpp>
