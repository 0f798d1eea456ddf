// SPDX-License-Identifier: Apache-2.0
// cmake/precompiled.hpp for tests.
#include "cmake/precompiled.hpp"
//
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lcp/dense_factors.hpp"
