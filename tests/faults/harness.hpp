// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Runs a call again and again; each time another of its requests for memory fails.
#include <functional>
#include <new>
#include <string>

#include "faults/injector.hpp"

namespace perp::faults {

/// What came of one call.
struct Outcome {
  bool out_of_memory = false;  ///< and it says so
  bool right = false;          ///< judged afterwards, with memory
  std::string all{};           ///< everything the call answered: the same for the same call
};

/// The call: its library part runs in attempt().
using Scenario = std::function<Outcome(long k)>;

/// Runs `part` armed with k. True: it ended; false: std::bad_alloc came out of it.
template <class Part>
bool attempt(long k, Part part) {
  try {
    const Armed armed(k);
    part();
  } catch (const std::bad_alloc&) {
    return false;
  }
  return true;
}

/// Expects of every k (or of about `some` of them, README.md): out of memory or right, and the same as ever in the call
/// that follows. Prints the figures.
void every_request_fails_once(const std::string& name, const Scenario& scenario, long some = 60);

}  // namespace perp::faults
