// SPDX-License-Identifier: Apache-2.0
#pragma once
/// GSL where memory ends. Its allocators call an error handler, which is global and by default ends the process; where
/// that returns, some of its functions (the LU factorization) use the null pointer. Private to ncp/.
#include <new>

namespace perp::ncp {

/// While one lives, GSL's errors on this thread come back as status codes and null pointers; on other threads they go
/// to the handler that was there, if one was set.
class GslErrors {
 public:
  GslErrors();
  GslErrors(const GslErrors&) = delete;
  GslErrors& operator=(const GslErrors&) = delete;
  ~GslErrors();
};

namespace detail {
bool call_gsl(void (*call)(void*), void* context);
}

/// Runs call(), which must leave nothing undone where GSL finds no memory in it: then it is left there, by a jump over
/// GSL's frames and call()'s own, and std::bad_alloc thrown. Pre: a GslErrors lives on this thread.
template <class Call>
void call_gsl(Call call) {
  if (!detail::call_gsl([](void* self) { (*static_cast<Call*>(self))(); }, &call)) throw std::bad_alloc();
}

/// While one lives, GSL's errors do not jump: for code with destructors that GSL calls back.
class GslCallback {
 public:
  GslCallback();
  GslCallback(const GslCallback&) = delete;
  GslCallback& operator=(const GslCallback&) = delete;
  ~GslCallback();

 private:
  void* outer_;
};

}  // namespace perp::ncp
