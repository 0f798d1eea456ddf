// SPDX-License-Identifier: Apache-2.0
#include "capi/guard.hpp"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <new>

#include "lcp/io/file_error.hpp"
#include "ncp/ampl/model.hpp"
#include "ncp/settings/input_error.hpp"

namespace perp::capi {

void refuse(const std::string& argument, const std::string& why) {
  throw Refusal(PERP_BAD_ARGUMENT, argument + ": " + why);
}

void require(const void* pointer, const char* argument) {
  if (pointer == nullptr) refuse(argument, "is NULL");
}

void require_interface(std::int32_t interface) {
  constexpr std::int32_t major = 1000;
  if (interface >= 0 && interface / major == PERP_INTERFACE / major && interface <= PERP_INTERFACE) return;
  throw Refusal(PERP_BAD_INTERFACE, "interface: the program was compiled for " + std::to_string(interface) +
                                        ", this library is " + std::to_string(PERP_INTERFACE) +
                                        " (1000 major + minor); the major numbers must be equal, and the program's "
                                        "minor number not above the library's");
}

std::int32_t report(perp_error* error, perp_code code, const char* message) {
  if (error == nullptr) return code;
  error->code = code;
  const std::size_t length = std::strlen(message);
  const std::size_t room = sizeof error->message - 1;
  std::memcpy(error->message, message, std::min(length, room));
  error->message[std::min(length, room)] = '\0';
  if (length > room) std::fill_n(error->message + room - 3, 3, '.');
  return code;
}

std::int32_t report_exception(perp_error* error) {
  try {
    throw;
  } catch (const Refusal& refusal) {
    return report(error, refusal.code(), refusal.what());
  } catch (const settings::InputError& refusal) {
    return report(error, PERP_BAD_OPTION, refusal.what());
  } catch (const ncp::ampl::ModelError& refusal) {
    return report(error, PERP_BAD_FILE, refusal.what());
  } catch (const lcp::FileError& refusal) {
    return report(error, PERP_BAD_FILE, refusal.what());
  } catch (const std::invalid_argument& refusal) {
    return report(error, PERP_BAD_ARGUMENT, refusal.what());
  } catch (const std::bad_alloc& failure) {
    const bool says_why = std::strcmp(failure.what(), std::bad_alloc().what()) != 0;
    return report(error, PERP_OUT_OF_MEMORY, says_why ? failure.what() : "there is no more memory");
  } catch (const std::exception& mistake) {
    return report(error, PERP_INTERNAL, mistake.what());
  } catch (...) {
    return report(error, PERP_INTERNAL, "an exception that is none of the standard library's");
  }
}

void copy_text(const std::string& text, char* out, std::int64_t size, const char* argument) {
  require(out, argument);
  if (size < 1) refuse("size", std::to_string(size) + " leaves no room for a NUL");
  const std::size_t length = std::min(text.size(), static_cast<std::size_t>(size - 1));
  std::copy_n(text.data(), length, out);
  out[length] = '\0';
}

}  // namespace perp::capi
