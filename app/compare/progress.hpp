// SPDX-License-Identifier: Apache-2.0
#pragma once
/// How far a campaign is, on a terminal as one line that is rewritten, elsewhere as a line now and then.
#include <array>
#include <chrono>
#include <cstddef>
#include <iosfwd>
#include <mutex>
#include <set>
#include <span>
#include <string>

#include "app/campaign/cell.hpp"

namespace perp::app::compare {

class Progress {
 public:
  /// Of `total` cells those in `before` are there already; `width` of the terminal, 0 where there is none. Not to solve
  /// problems without a solution is honest, and no failure.
  Progress(std::ostream& out, std::size_t total, std::span<const Cell> before, int width,
           std::set<std::string> without_solution = {});

  void add(const Cell& cell);
  void tick();  ///< shows that time goes on
  void end();   ///< takes the line away, or says how it ended

  /// "  412/1250  solved 371  failed 35  limits 6  3:20 left"; `now`: seconds since the beginning.
  std::string line(double now) const;

 private:
  void show(bool always);
  void count(const Cell& cell);

  std::ostream& out_;
  std::size_t total_, before_, done_;
  int width_;
  std::array<std::size_t, static_cast<std::size_t>(Outcome::FalseInfeasible) + 1> counts_{};
  std::set<std::string> without_solution_;
  std::size_t honest_ = 0;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  double shown_ = -1;  ///< when, s
  std::size_t shown_done_ = 0;
  std::mutex mutex_;
};

/// "12 s", "3:20", "1:02:03".
std::string duration_text(double seconds);

/// Columns of the terminal that this file descriptor is; 0 if it is none.
int terminal_width(int file);

}  // namespace perp::app::compare
