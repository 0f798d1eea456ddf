// cmake/precompiled.hpp for the program.
#include "cmake/precompiled.hpp"
//

#include <nlohmann/json.hpp>
