// SPDX-License-Identifier: Apache-2.0
#include "ncp/run/observe.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ostream>
#include <utility>

namespace perp::ncp {

namespace {

/// The state of a table: which part of it the next row belongs to.
class Table {
 public:
  Table(std::ostream& out, const Mcp& mcp, TableOptions options) : out_(out), mcp_(mcp), options_(options) {}

  void show(const Iteration& it) {
    if (!it.attempt.empty()) {
      part_ = Part::None;
      if (options_.restarts) {
        out_ << (any_ ? "\n" : "") << "Restart: " << it.attempt << '\n';
        any_ = false;  // no empty line below it
      }
    }
    if (it.crash)
      show_crash(it);
    else
      show_major(it);
    previous_ = it;
    previous_.x = nullptr;
    previous_.way = nullptr;
    previous_.problem = nullptr;
  }

 private:
  enum class Part { None, Crash, Major };

  void show_crash(const Iteration& it) {
    const bool first = std::exchange(part_, Part::Crash) != Part::Crash;
    crash_ = first ? 0 : crash_ + 1;
    if (!options_.crash) return;
    if (first) head("Crash Log", "major  func  diff  size   residual    step   prox      inorm (label)\n");
    if (crash_ % std::max(options_.crash_frequency, 1) != 0) return;
    print("%5d %5d ", crash_, it.F_evals);
    count(it.changes);
    count(it.inside);
    numbers(it, it.kind == 'C');
  }

  void show_major(const Iteration& it) {
    const Part before = std::exchange(part_, Part::Major);
    if (!options_.major) return;
    if (before != Part::Major)
      head("Major Iteration Log", "major minor  func  grad   residual    step type   prox      inorm (label)\n");
    if (before == Part::Crash) {  // begins where the crash ended
      Iteration begin = previous_;
      begin.kind = 'I';
      major_row(begin);
    }
    const bool begins = it.kind == 'I' || !it.attempt.empty();  // R alone may be josephy's partial step
    if (begins || it.k % std::max(options_.major_frequency, 1) == 0) major_row(it);
  }

  void major_row(const Iteration& it) {
    print("%5d %5d ", it.k, it.pivots);
    print("%5d %5d ", it.F_evals, it.J_evals);
    const bool moved = it.kind != 'I' && it.attempt.empty();
    numbers(it, moved);
  }

  /// residual, step, type, prox, inorm, label.
  void numbers(const Iteration& it, bool moved) {
    if (it.merit > 0 || it.residual == 0)
      print("%10.4e", std::sqrt(2 * it.merit));
    else
      out_ << std::string(10, ' ');
    if (moved)
      print(" %7.1e", it.step);
    else
      out_ << std::string(8, ' ');
    if (!it.crash || part_ == Part::Major) out_ << "   " << it.linear << it.kind;
    if (const double prox = it.prox > 0 ? it.prox : it.mu; prox > 0)
      print(" %6.0e", prox);
    else
      out_ << std::string(7, ' ');
    print(" %10.4e ", it.residual);
    if (it.worst >= 0) out_ << '(' << mcp_.equation_name(it.worst) << ')';
    out_ << '\n';
  }

  void head(const char* name, const char* columns) {
    out_ << (std::exchange(any_, true) ? "\n" : "") << name << '\n' << columns;
  }
  void count(Index n) {
    if (n >= 0)
      print("%5d ", static_cast<int>(n));
    else
      out_ << std::string(6, ' ');
  }
  template <class... Values>
  void print(const char* format, Values... values) {
    char text[64];
    std::snprintf(text, sizeof text, format, values...);
    out_ << text;
  }

  std::ostream& out_;
  const Mcp& mcp_;
  TableOptions options_;
  Iteration previous_;
  Part part_ = Part::None;
  int crash_ = 0;
  bool any_ = false;
};

}  // namespace

Observer print_table(std::ostream& out, const Mcp& mcp, TableOptions options) {
  return [table = Table(out, mcp, options)](const Iteration& it) mutable {
    table.show(it);
    return Next::Continue;
  };
}

Observer record(std::vector<Iteration>& records) {
  return [&records](const Iteration& it) {
    records.push_back(it);
    records.back().x = nullptr;
    records.back().way = nullptr;
    records.back().problem = nullptr;
    return Next::Continue;
  };
}

Observer stop_when(const std::atomic<bool>& flag) {
  return [&flag](const Iteration&) { return flag ? Next::Stop : Next::Continue; };
}

Observer of_ways(Observer observer) {
  observer.ways = true;
  return observer;
}

Observer all(std::vector<Observer> observers) {
  const bool ways = std::ranges::any_of(observers, &Observer::ways);
  Observer told = [observers = std::move(observers)](const Iteration& it) {
    Next next = Next::Continue;
    for (const Observer& observer : observers)
      if (observer && observer(it) == Next::Stop) next = Next::Stop;
    return next;
  };
  return ways ? of_ways(std::move(told)) : told;
}

}  // namespace perp::ncp
