// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Work without the GIL, and what ends it: Ctrl-C, and the end of the interpreter.
#include <pybind11/pybind11.h>

#include <atomic>

namespace perp::python {

/// The thread that Python runs handlers of signals in.
void remember_main_thread(unsigned long identifier);
bool on_main_thread();

/// Python's own handler of Ctrl-C only leaves a note, which nobody reads while linear algebra runs.
/// While it lives, SIGINT sets *stop, and then does what it did before. Nothing on other threads than the main one, or
/// where SIGINT is ignored or ends the process. Solves within solves: the inner one is stopped.
class StopOnInterrupt {
 public:
  explicit StopOnInterrupt(std::atomic<bool>* stop);
  ~StopOnInterrupt();
  StopOnInterrupt(const StopOnInterrupt&) = delete;
  StopOnInterrupt& operator=(const StopOnInterrupt&) = delete;

 private:
  bool set_ = false;        // something that the destructor takes back
  bool installed_ = false;  // the handler, too
  std::atomic<bool>* outer_ = nullptr;
};

/// Registers what Python does at its end: stops what runs in other threads and waits for it, ten seconds at most. A
/// thread that asks for the GIL of an interpreter that is gone is ended where it stands, and C++ does not survive that.
void stop_at_exit();

/// While it lives the GIL is released. At the end of the interpreter *stop is set; null: waited for.
class Released {
 public:
  /// Throws std::runtime_error if the interpreter is at its end.
  explicit Released(std::atomic<bool>* stop = nullptr) : running_(stop) {}

 private:
  class Running {
   public:
    explicit Running(std::atomic<bool>* stop);
    ~Running();
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;

   private:
    std::atomic<bool>* stop_;
  };
  Running running_;  // taken back once the GIL is ours again
  pybind11::gil_scoped_release release_{};
};

}  // namespace perp::python
