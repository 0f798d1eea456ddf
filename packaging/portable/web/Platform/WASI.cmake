# SPDX-License-Identifier: Apache-2.0
# What CMake 3.25 does not know of this system.
set(UNIX 1)
set(CMAKE_EXECUTABLE_SUFFIX .wasm)
list(APPEND CMAKE_SYSTEM_PREFIX_PATH /)
