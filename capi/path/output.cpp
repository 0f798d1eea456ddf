// SPDX-License-Identifier: Apache-2.0
/// Output and errors.
#include <array>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <utility>
#include <vector>

#include "capi/path/thread_state.hpp"

namespace perp::path {

ThreadState& this_thread() {
  thread_local ThreadState state;
  return state;
}

namespace {

template <class Each>
void each_file(const ThreadState& state, int mode, Each each) {
  for (const auto& [bit, file] : std::array<std::pair<int, FILE*>, 3>{
           {{Output_Log, state.log}, {Output_Status, state.status}, {Output_Listing, state.listing}}})
    if ((mode & bit) != 0 && file != nullptr) each(file);
}

}  // namespace

void tell(int mode, const std::string& text) {
  const ThreadState& state = this_thread();
  if (state.output.print != nullptr) {
    std::vector<char> own(text.begin(), text.end());  // the client may write into it
    own.push_back('\0');
    state.output.print(state.output.output_data, mode, own.data());
    return;
  }
  each_file(state, mode, [&](FILE* file) { std::fputs(text.c_str(), file); });
}

void warn(const std::string& text) {
  tell(Output_Log, text + "\n");
  const Error_Interface& error = this_thread().error;
  if (error.warning == nullptr) return;
  std::vector<char> own(text.begin(), text.end());
  own.push_back('\0');
  error.warning(error.error_data, own.data());
}

}  // namespace perp::path

using perp::path::this_thread;

void Output_SetInterface(Output_Interface* i) { this_thread().output = i == nullptr ? Output_Interface{} : *i; }
void Output_Default(void) { this_thread().output = {}; }
void Output_SetLog(FILE* file) { this_thread().log = file; }
void Output_SetStatus(FILE* file) { this_thread().status = file; }
void Output_SetListing(FILE* file) { this_thread().listing = file; }

void Output_Printf(int mode, const char* format, ...) {
  if (format == nullptr) return;
  std::va_list arguments;
  va_start(arguments, format);
  std::va_list again;
  va_copy(again, arguments);
  const int length = std::vsnprintf(nullptr, 0, format, arguments);
  va_end(arguments);
  if (length > 0) {
    std::string text(static_cast<std::size_t>(length) + 1, '\0');
    std::vsnprintf(text.data(), text.size(), format, again);
    text.pop_back();
    perp::path::tell(mode, text);
  }
  va_end(again);
}

void Output_Flush(int mode) {
  const perp::path::ThreadState& state = this_thread();
  if (state.output.print == nullptr)
    perp::path::each_file(state, mode, [](FILE* file) { std::fflush(file); });
  else if (state.output.flush != nullptr)
    state.output.flush(state.output.output_data, mode);
}

void Error_SetInterface(Error_Interface* i) { this_thread().error = i == nullptr ? Error_Interface{} : *i; }

void* Memory_Allocate(unsigned long bytes) { return std::malloc(bytes); }
void Memory_Free(void* memory) { std::free(memory); }
