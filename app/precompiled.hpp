// SPDX-License-Identifier: Apache-2.0
// cmake/precompiled.hpp for the program.
#include "cmake/precompiled.hpp"
//

#include <nlohmann/json.hpp>
