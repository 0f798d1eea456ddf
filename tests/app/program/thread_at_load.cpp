// SPDX-License-Identifier: Apache-2.0
/// A library that makes a thread when it is loaded, before main(), as OpenBLAS does.
#include <unistd.h>

#include <thread>

namespace {

const struct AtLoad {
  AtLoad() {
    std::thread([] {
      for (;;) pause();
    }).detach();
  }
} at_load;

}  // namespace
