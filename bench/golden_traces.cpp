// SPDX-License-Identifier: Apache-2.0
/// A hash of every record of every preset on every problem and start of the collection, under limits of iterations
/// alone. What is to change nothing leaves this list as it was, on one machine and one BLAS; `diff` tells what it
/// changed.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <type_traits>

#include "collection/collection.hpp"
#include "ncp/strategy/presets.hpp"

namespace {

using namespace perp::ncp;

/// FNV-1a.
class Hash {
 public:
  void bytes(const void* data, std::size_t n) {
    const auto* p = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < n; ++i) value_ = (value_ ^ p[i]) * 1099511628211U;
  }
  template <class T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T> Hash& operator<<(T value) {
    bytes(&value, sizeof value);
    return *this;
  }
  Hash& operator<<(const std::string& text) {
    bytes(text.data(), text.size());
    return *this;
  }
  Hash& operator<<(const Vec& v) {
    bytes(v.data(), static_cast<std::size_t>(v.size()) * sizeof(double));
    return *this;
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 14695981039346656037U;
};

/// Without the counters of evaluations, which are columns of their own.
void add(Hash& hash, const Iteration& it) {
  hash << it.k << it.residual << it.worst << it.merit << it.step << it.prox << it.mu << it.pivots << it.backtracks
       << it.kind << it.linear << it.crash << it.changes << it.inside << it.attempt;
  if (it.x != nullptr) hash << *it.x;
  if (it.problem != nullptr) hash << it.problem->size();
  if (it.way == nullptr) return;
  hash << it.way->T << it.way->on_path;
  for (const auto& kink : it.way->kinks) hash << kink.t << kink.x;
}

void add(Hash& hash, const Stats& s) {
  hash << s.iterations << s.crash_iterations << s.factorizations << s.krylov_iterations << s.pivots << s.presolved
       << s.restarts << s.gradient_steps << s.watchdogs << s.unchecked_steps << s.chord_steps << s.backtracks
       << s.ray_starts << s.rank_deficient << s.proximal_steps;
}

void trace(const Preset& preset, const collection::Entry& entry, const collection::Problem& problem, std::size_t start,
           int iterations) {
  Method method = preset.method;
  stop(method).max_iterations = iterations;
  stop(method).max_F_evals = 100 * iterations;
  stop(method).max_time = std::chrono::hours(24);
  Hash records, answer, counts, words;
  const Observer observer = of_ways([&records](const Iteration& it) {
    add(records, it);
    return Next::Continue;
  });
  std::string status;
  Result result;
  try {
    result = solve(*problem.mcp, problem.starts[start], method, observer);
    status = to_string(result.status);
  } catch (const std::exception& error) {
    status = "refused";
    result.message = error.what();
  }
  answer << result.x << result.F << result.residual.natural;
  for (const auto cell : result.basis) answer << cell;
  add(counts, result.stats);
  words << result.message << result.advice;
  for (const auto& note : result.notes) words << note;
  std::printf("%s,%s,%zu,%s,%d,%d,%d,%016llx,%016llx,%016llx,%016llx\n", std::string(preset.name).c_str(),
              std::string(entry.name).c_str(), start + 1, status.c_str(), result.stats.iterations, result.stats.F_evals,
              result.stats.J_evals, static_cast<unsigned long long>(records.value()),
              static_cast<unsigned long long>(answer.value()), static_cast<unsigned long long>(counts.value()),
              static_cast<unsigned long long>(words.value()));
}

}  // namespace

/// bench_golden_traces [ITERATIONS [SIZE [PRESET]]]: of problems up to SIZE variables.
int main(int argc, char** argv) {
  const int iterations = argc > 1 ? std::atoi(argv[1]) : 100;
  const Index size = argc > 2 ? std::atoi(argv[2]) : 1000;
  std::printf("preset,problem,start,status,iterations,F,J,records,answer,counts,words\n");
  for (const auto& entry : collection::entries()) {
    if (entry.size > size) continue;
    const auto problem = entry.make();
    for (const Preset& preset : presets())
      if (argc <= 3 || preset.name == argv[3])
        for (std::size_t start = 0; start < problem.starts.size(); ++start)
          trace(preset, entry, problem, start, iterations);
    std::fflush(stdout);
  }
}
