// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The exception that unwinds the stack of a thread that is being cancelled. Only GNU's library gives it a type, and it
/// must be thrown on; with other libraries nobody throws this one.
#include <version>

#ifdef __GLIBCXX__
#include <cxxabi.h>

namespace perp {
using ForcedUnwind = abi::__forced_unwind;
}  // namespace perp
#else
namespace perp {
class ForcedUnwind {};
}  // namespace perp
#endif
