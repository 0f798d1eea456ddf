// SPDX-License-Identifier: Apache-2.0
/// The program `perp`: its streams and exit codes. app/command_line.cpp reads what it is asked for.
#include <array>
#include <atomic>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>

#include "app/command_line.hpp"
#include "app/commands/ampl_driver.hpp"
#include "app/process.hpp"
#include "app/program/bounded_call.hpp"
#include "app/program/files.hpp"

namespace {

using namespace perp::app;

std::atomic<bool> interrupted{false};

/// Whether the command may factor a matrix.
bool factors(const std::vector<std::string>& arguments) {
  constexpr std::array<std::string_view, 3> commands{"solve", "inspect", "contact"};
  return !arguments.empty() && std::ranges::find(commands, arguments[0]) != commands.end();
}

/// A reader who has gone is no error, a full disk is. (errno may be of an earlier write, or lost.)
int checked_output(int code) {
  std::cout.flush();
  if (std::cout) return code;
  if (reader_has_gone()) return code;
  std::cerr << "perp: standard output cannot be written\n";
  return code == exit_internal ? code : exit_input;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    begin_process(argv, interrupted);
    const Guard guard(interrupted);
    std::vector<std::string> arguments = arguments_of(argc, argv);
    std::string program = "perp";
    if (!arguments.empty()) {
      program = std::filesystem::path(arguments[0]).stem().string();  // on Windows without ".exe"
      arguments.erase(arguments.begin());
    }
    const PrintableStream out(std::cout);
    PrintableStream err(std::cerr);
    const Streams streams{std::cout, std::cerr, &err.raw()};
    const bool ampl = is_ampl_call(program, arguments);
    if ((ampl || factors(arguments)) && !can_factor(streams.err)) return exit_input;
    const int code =
        ampl ? ampl_driver({.program = program,
                            .arguments = arguments,
                            .environment = [](const char* name) -> const char* { return std::getenv(name); }},
                           streams, &interrupted)
             : run_command(arguments, streams, &interrupted);
    const int checked = checked_output(code);
    if (calls_left_behind()) end_process(checked);  // they use what the destructors of the program would take away
    return checked;
  } catch (const std::bad_alloc&) {
    std::cerr << "perp: out of memory\n";
  } catch (const std::exception& error) {
    std::cerr << "perp: internal error: " << error.what() << '\n';
  } catch (...) {
    std::cerr << "perp: internal error\n";
  }
  return exit_internal;
}
