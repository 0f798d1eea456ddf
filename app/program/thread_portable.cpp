// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <cstdlib>
#include <system_error>
#include <thread>
#include <utility>

#include "app/program/thread.hpp"

namespace perp::app {

bool start_thread(std::function<void()> work) {
  try {
    std::thread(std::move(work)).detach();
    return true;
  } catch (const std::system_error&) {
    return false;
  }
}

void leave(std::string_view why, int code) {
  std::fprintf(stderr, "%.*s", static_cast<int>(why.size()), why.data());
  std::_Exit(code);
}

}  // namespace perp::app
