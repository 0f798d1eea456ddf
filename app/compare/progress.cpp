// SPDX-License-Identifier: Apache-2.0
#include "app/compare/progress.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <ostream>

namespace perp::app::compare {

namespace {

constexpr double every_terminal = 0.1;  // s
constexpr double every_other = 30;      // s, or where another tenth is done
constexpr int least_width = 40;

struct Group {
  const char* name;
  std::array<Outcome, 2> outcomes;
};
constexpr std::array groups{Group{"solved", {Outcome::Solved, Outcome::Infeasible}},
                            Group{"to rounding", {Outcome::SolvedToRounding, Outcome::SolvedToRounding}},
                            Group{"failed", {Outcome::Failed, Outcome::Unclaimed}},
                            Group{"false", {Outcome::FalseConvergence, Outcome::FalseInfeasible}},
                            Group{"limits", {Outcome::TimeLimit, Outcome::MemoryLimit}},
                            Group{"crashed", {Outcome::Crashed, Outcome::Garbage}},
                            Group{"n/a", {Outcome::NotApplicable, Outcome::NotApplicable}}};

}  // namespace

std::string duration_text(double seconds) {
  const auto s = static_cast<long long>(std::ceil(seconds));
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{}:{:02}", s / 60, s % 60);
  return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

int terminal_width(int file) {
  if (isatty(file) == 0) return 0;
  winsize size{};
  return ioctl(file, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? std::max<int>(size.ws_col, least_width) : 80;
}

Progress::Progress(std::ostream& out, std::size_t total, std::span<const Cell> before, int width,
                   std::set<std::string> without_solution)
    : out_(out),
      total_(total),
      before_(before.size()),
      done_(before.size()),
      width_(width),
      without_solution_(std::move(without_solution)),
      shown_done_(before.size()) {
  for (const Cell& cell : before) count(cell);
}

void Progress::count(const Cell& cell) {
  const bool honest = cell.outcome == Outcome::Failed && without_solution_.contains(cell.problem);
  ++(honest ? honest_ : counts_.at(static_cast<std::size_t>(cell.outcome)));
}

std::string Progress::line(double now) const {
  std::string text = fmt::format("{}/{}", done_, total_);
  for (const Group& group : groups) {
    std::size_t n = counts_.at(static_cast<std::size_t>(group.outcomes[0]));
    if (group.outcomes[1] != group.outcomes[0]) n += counts_.at(static_cast<std::size_t>(group.outcomes[1]));
    if (n > 0) text += fmt::format("  {} {}", group.name, n);
  }
  if (honest_ > 0) text += fmt::format("  honest {}", honest_);
  if (done_ > before_ && done_ < total_)
    text += fmt::format(
        "  {} left", duration_text(now / static_cast<double>(done_ - before_) * static_cast<double>(total_ - done_)));
  return text;
}

void Progress::add(const Cell& cell) {
  const std::scoped_lock lock(mutex_);
  ++done_;
  count(cell);
  show(false);
}

void Progress::tick() {
  const std::scoped_lock lock(mutex_);
  show(false);
}

void Progress::show(bool always) {
  const double now = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  const bool due = width_ > 0 ? now - shown_ >= every_terminal || shown_ < 0
                              : now - std::max(shown_, 0.0) >= every_other ||
                                    done_ * 10 / std::max<std::size_t>(total_, 1) >
                                        shown_done_ * 10 / std::max<std::size_t>(total_, 1);
  if (!due && !always) return;
  shown_ = now;
  shown_done_ = done_;
  std::string text = line(now);
  if (width_ == 0) {
    out_ << "perp: " << text << std::endl;
    return;
  }
  const int room = width_ - static_cast<int>(text.size()) - 4;
  constexpr int least_bar = 8;
  constexpr int longest_bar = 40;
  if (room >= least_bar) {
    const int bar = std::min(room, longest_bar);
    const auto filled = static_cast<int>(static_cast<double>(bar) * static_cast<double>(done_) /
                                         static_cast<double>(std::max<std::size_t>(total_, 1)));
    text = fmt::format("[{:.<{}}] {}", std::string(static_cast<std::size_t>(filled), '#'), bar, text);
  }
  out_ << "\r\033[K" << text.substr(0, static_cast<std::size_t>(width_) - 1) << std::flush;
}

void Progress::end() {
  const std::scoped_lock lock(mutex_);
  if (width_ > 0)
    out_ << "\r\033[K" << std::flush;
  else if (shown_done_ != done_)
    show(true);
}

}  // namespace perp::app::compare
