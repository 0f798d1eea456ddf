// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The wall between C and C++: nothing is thrown across it.
#include <cstdint>
#include <stdexcept>
#include <string>

#include "capi/forced_unwind.hpp"
#include "capi/perp.h"

namespace perp::capi {

/// What a function of the interface fails with.
class Refusal : public std::runtime_error {
 public:
  Refusal(perp_code code, const std::string& what) : std::runtime_error(what), code_(code) {}
  perp_code code() const { return code_; }

 private:
  perp_code code_;
};

/// Throws PERP_BAD_ARGUMENT: "ARGUMENT: WHY".
[[noreturn]] void refuse(const std::string& argument, const std::string& why);
/// Throws if it is null.
void require(const void* pointer, const char* argument);
/// Throws PERP_BAD_INTERFACE unless a program compiled for this interface may run here.
void require_interface(std::int32_t interface);

/// Writes it to error, if there is one.
std::int32_t report(perp_error* error, perp_code code, const char* message);
/// The code of the exception that is being handled, and its words.
std::int32_t report_exception(perp_error* error);

/// Runs body(). An exception becomes a code and words; a thread that is being cancelled goes on unwinding.
template <class Body>
std::int32_t guarded(perp_error* error, Body body) {
  try {
    body();
    return report(error, PERP_OK, "");
  } catch (const ForcedUnwind&) {
    throw;
  } catch (...) {
    return report_exception(error);
  }
}

/// The same of a function that makes something for *made, which is null where it fails.
template <class Handle, class Make>
std::int32_t guarded_make(Handle** made, const char* argument, perp_error* error, Make make) {
  if (made == nullptr) return guarded(error, [&] { require(made, argument); });
  *made = nullptr;
  return guarded(error, [&] { *made = make().release(); });
}

/// Copies as much as fits, with a NUL. Throws if there is no place.
void copy_text(const std::string& text, char* out, std::int64_t size, const char* argument);

}  // namespace perp::capi
