#pragma once
/// Ctrl-C during a solve. Python's own handler only leaves a note, which nobody reads while linear algebra runs.
#include <atomic>

namespace perp::python {

/// The thread that Python runs handlers of signals in.
void remember_main_thread(unsigned long identifier);
bool on_main_thread();

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

}  // namespace perp::python
