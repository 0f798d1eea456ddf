// SPDX-License-Identifier: Apache-2.0
#include <windows.h>
// (after windows.h)
#include <shellapi.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "app/process.hpp"
#include "app/program/signals.hpp"

namespace perp::app {
namespace {

std::string utf8(const wchar_t* text) {
  const int size = WideCharToMultiByte(CP_UTF8, 0, text, -1, nullptr, 0, nullptr, nullptr);
  std::string bytes(static_cast<std::size_t>(size), '\0');
  WideCharToMultiByte(CP_UTF8, 0, text, -1, bytes.data(), size, nullptr, nullptr);
  bytes.resize(bytes.size() - 1);  // without the zero
  return bytes;
}

}  // namespace

/// Reads them from the system: main()'s are in the machine's code page.
std::vector<std::string> arguments_of(int, char**) {
  int count = 0;
  const std::unique_ptr<wchar_t*[], decltype(&LocalFree)> words(CommandLineToArgvW(GetCommandLineW(), &count),
                                                                LocalFree);
  std::vector<std::string> arguments;
  for (int k = 0; k < count; ++k) arguments.push_back(utf8(words[static_cast<std::size_t>(k)]));
  return arguments;
}

void begin_process(char**, std::atomic<bool>& interrupted) {
  SetConsoleOutputCP(CP_UTF8);
  wait_for_signals(interrupted);
}

bool can_factor(std::ostream&) { return true; }

bool reader_has_gone() { return errno == EPIPE || errno == EINVAL; }  // EINVAL: of a pipe whose reader has closed it

void end_process(int code) {
  std::fflush(nullptr);
  std::_Exit(code);
}

}  // namespace perp::app
