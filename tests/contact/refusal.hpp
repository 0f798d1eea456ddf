// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The words of a refusal.
#include <exception>
#include <string>

namespace perp::contact::test {

/// The message of the exception; "" where there is none.
template <class Act>
std::string refusal_of(const Act& act) {
  try {
    act();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

}  // namespace perp::contact::test
