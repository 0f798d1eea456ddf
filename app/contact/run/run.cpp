// SPDX-License-Identifier: Apache-2.0
#include "app/contact/run/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <mutex>
#include <new>
#include <utility>

#include "app/program/program.hpp"
#include "contact/io/read.hpp"
#include "contact/scenes/generators.hpp"
#include "lcp/io/file_path.hpp"

namespace perp::app::contacts {

namespace {

std::string_view name_of(const std::string& argument) {
  return std::string_view(argument).substr(0, argument.find(':'));
}

bool known_generator(std::string_view name) {
  return std::ranges::any_of(contact::generators(), [&](const auto& entry) { return entry.name == name; });
}

std::string generator_names() {
  std::vector<std::string_view> names;
  for (const contact::GeneratorEntry& entry : contact::generators()) names.push_back(entry.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string similar(std::string_view name) {
  std::vector<std::string_view> names;
  for (const contact::GeneratorEntry& entry : contact::generators()) names.push_back(entry.name);
  return did_you_mean(name, names);
}

template <class Number>
Number parse_number(const std::string& argument, std::string_view digits, const char* what) {
  Number value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size() || digits.empty())
    throw input_error("'{}': '{}' is no {}; NAME:SIZE[:SEED[:MU]] is meant, as in spheres:100:7", argument, digits,
                      what);
  return value;
}

/// What a run and whoever waits for it share. The run may be left behind: it owns all it uses.
struct Shared {
  std::shared_ptr<const Loaded> loaded;
  std::mutex mutex;
  lcp::Vec best{};  // r
  Run run{};        // one that came back
  bool out_of_memory = false;
};

}  // namespace

bool is_generated(const std::string& argument) {
  std::error_code ignored;
  return argument.find(':') != std::string::npos && known_generator(name_of(argument)) &&
         !std::filesystem::exists(lcp::file_path(argument), ignored);
}

std::vector<FileUse> files_of(const std::vector<std::string>& arguments) {
  std::vector<FileUse> files;
  for (const std::string& argument : arguments)
    if (!is_generated(argument)) files.push_back({"", argument});
  return files;
}

Loaded generate(const std::string& argument) {
  const std::string_view name = name_of(argument);
  if (!known_generator(name))
    throw input_error("'{}': '{}' is none of {}.{}", argument, name, generator_names(), similar(name));
  if (name.size() == argument.size()) throw input_error("'{0}': how many contacts? {0}:100, say", argument);
  std::string_view rest = std::string_view(argument).substr(name.size() + 1);
  const auto next = [&rest] {  // what is before the next colon, or nothing
    const std::size_t colon = std::min(rest.find(':'), rest.size());
    const std::string_view part = rest.substr(0, colon);
    rest.remove_prefix(std::min(colon + 1, rest.size()));
    return part;
  };
  const bool seeded = rest.find(':') != std::string_view::npos;
  const auto size = parse_number<lcp::Index>(argument, next(), "number of contacts");
  if (size < 1) throw input_error("'{}': at least 1 contact is needed", argument);
  const bool rubbed = rest.find(':') != std::string_view::npos;
  const unsigned seed = seeded ? parse_number<unsigned>(argument, next(), "seed") : 1U;
  Loaded loaded{argument, contact::make_scene(name, size, seed).problem()};
  if (rubbed) {
    const auto mu = parse_number<double>(argument, rest, "coefficient of friction");
    if (!(mu >= 0) || !std::isfinite(mu)) throw input_error("'{}': mu is {} and must be >= 0", argument, mu);
    loaded.problem.mu.setConstant(mu);
  }
  return loaded;
}

std::string with_friction(const std::string& argument, double mu) {
  const auto colons = std::ranges::count(argument, ':');
  if (!is_generated(argument)) throw input_error("--mu: '{}' is not a problem that is made", argument);
  if (colons > 2) throw input_error("--mu: '{}' has a coefficient of friction", argument);
  return fmt::format("{}{}:{}", argument, colons == 1 ? ":1" : "", mu);
}

Loaded load(const std::string& argument) {
  std::error_code ignored;
  if (is_generated(argument)) return generate(argument);
  if (std::filesystem::is_directory(lcp::file_path(argument), ignored))
    throw input_error("'{}' is a directory, not a file", argument);
  if (!std::filesystem::exists(lcp::file_path(argument), ignored))
    throw input_error("there is no file '{}'; problems that can be made, as NAME:SIZE[:SEED[:MU]]: {}.{}", argument,
                      generator_names(), similar(name_of(argument)));
  return {argument, contact::read_problem(argument)};
}

Run run(const contact::Problem& problem, const Variant& variant, const Limits& limits) {
  return {contact::run(problem, variant, limits), variant, limits};
}

std::shared_ptr<const Loaded> load_within(const Patience& patience, const std::string& argument) {
  const auto loaded = std::make_shared<std::shared_ptr<const Loaded>>();
  const auto given_up =
      bounded_call([loaded, argument] { *loaded = std::make_shared<const Loaded>(load(argument)); }, patience);
  if (given_up)
    throw OutOfTime(*given_up, fmt::format("'{}' was being {}", argument, is_generated(argument) ? "made" : "read"));
  return *loaded;
}

Run run_within(const Patience& patience, std::shared_ptr<const Loaded> loaded, const Variant& variant,
               const Limits& limits) {
  const Clock::time_point begin = Clock::now();
  const auto shared = std::make_shared<Shared>();
  shared->loaded = std::move(loaded);
  Limits within = limits;
  within.seconds = std::clamp(std::chrono::duration<double>(patience.deadline - begin).count(), 0.0, limits.seconds);
  within.interrupt = patience.interrupt;
  within.better = [&s = *shared](const lcp::Vec& r) {
    const std::lock_guard lock(s.mutex);
    s.best = r;
  };
  const auto call = [shared, variant, within] {
    try {
      shared->run = contacts::run(shared->loaded->problem, variant, within);
    } catch (const std::bad_alloc&) {
      shared->out_of_memory = true;
    }
  };
  const auto given_up = bounded_call(call, patience);
  if (!given_up && !shared->out_of_memory) {
    shared->run.limits = limits;
    return std::move(shared->run);
  }
  Run run;
  run.variant = variant;
  run.limits = limits;
  const bool interrupted = given_up == GivenUp::Interrupted;
  run.status = !given_up ? Status::OutOfMemory : interrupted ? Status::Interrupted : Status::TimeLimit;
  run.message = !given_up ? "out of memory; this is the best point met until then"
                          : fmt::format(
                                "{} in a phase that did not end within 0.2 s; this is the best point met until "
                                "then",
                                interrupted ? "interrupted" : "the time limit was reached");
  {
    const std::lock_guard lock(shared->mutex);
    run.solution.r = shared->best;
  }
  const contact::Problem& problem = shared->loaded->problem;
  if (run.solution.r.size() == 0) run.solution.r = lcp::Vec::Zero(problem.q.size());
  run.solution.u = contact::velocities(problem, run.solution.r);
  run.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  contact::judge(run, problem, variant);
  return run;
}

}  // namespace perp::app::contacts
