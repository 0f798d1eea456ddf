// SPDX-License-Identifier: Apache-2.0
#include "ncp/methods/gsl_errors.hpp"

#include <gsl/gsl_errno.h>

#include <atomic>
#include <csetjmp>
#include <mutex>
#include <string_view>
#include <utility>

namespace perp::ncp {
namespace {

thread_local int mine = 0;                     // GslErrors of this thread
thread_local std::jmp_buf* back_to = nullptr;  // where want of memory leads, if anywhere
std::mutex lock;
int holders = 0;  // GslErrors of the process
std::atomic<gsl_error_handler_t*> before{nullptr};

/// Vectors and matrices are made of a struct and a block: where there is no block they free the struct and say so
/// themselves.
bool frees_and_calls_again(const std::string_view reason) {
  return reason.ends_with("block struct") || reason.ends_with("block data");
}

void handle(const char* reason, const char* file, int line, int error) {
  if (mine == 0) {
    if (gsl_error_handler_t* handler = before) handler(reason, file, line, error);
  } else if (error == GSL_ENOMEM && back_to != nullptr && !frees_and_calls_again(reason)) {
    std::longjmp(*back_to, 1);
  }
}

}  // namespace

GslErrors::GslErrors() {
  const std::lock_guard guard(lock);
  if (holders++ == 0) before = gsl_set_error_handler(handle);
  ++mine;
}

GslErrors::~GslErrors() {
  const std::lock_guard guard(lock);
  if (--holders == 0) gsl_set_error_handler(before);
  --mine;
}

bool detail::call_gsl(void (*call)(void*), void* context) {
  std::jmp_buf here;
  std::jmp_buf* const outer = back_to;
  if (setjmp(here) != 0) {
    back_to = outer;
    return false;
  }
  back_to = &here;
  call(context);
  back_to = outer;
  return true;
}

GslCallback::GslCallback() : outer_(std::exchange(back_to, nullptr)) {}
GslCallback::~GslCallback() { back_to = static_cast<std::jmp_buf*>(outer_); }

}  // namespace perp::ncp
