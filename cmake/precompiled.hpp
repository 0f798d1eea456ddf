// What nearly every file includes, compiled once (CMakeLists.txt). Every file still names what it uses.
#include "lcp/eigen_memory.hpp"
//
#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>
