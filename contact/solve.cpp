#include "contact/solve.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "contact/referee.hpp"

namespace perp::contact {
namespace {

template <class Value>
std::string refusal(const char* option, const Value& value, const char* range) {
  std::ostringstream why;
  why << option << " is " << value << "; it must be " << range;
  return why.str();
}

std::optional<std::string> invalid_method(const GlockerHomotopy& m) {
  const HomotopyOptions& o = m.options;
  if (!(o.delta_share > 0 && o.delta_share < 10)) return refusal("delta_share", o.delta_share, "in (0, 10)");
  if (!(o.eps_share >= 0 && o.eps_share < 10)) return refusal("eps_share", o.eps_share, "in [0, 10)");
  if (!(o.least_centring > 0 && o.least_centring < 1)) return refusal("least_centring", o.least_centring, "in (0, 1)");
  if (!(o.to_boundary > 0 && o.to_boundary < 1)) return refusal("to_boundary", o.to_boundary, "in (0, 1)");
  if (!(o.neighbourhood > 0 && o.neighbourhood < 1)) return refusal("neighbourhood", o.neighbourhood, "in (0, 1)");
  if (m.max_iterations < 1) return refusal("max_iterations", m.max_iterations, "at least 1");
  if (m.sweeps < 0) return refusal("sweeps", m.sweeps, "at least 0");
  if (!(m.polish_at > 0)) return refusal("polish_at", m.polish_at, "positive");
  return std::nullopt;
}

std::optional<std::string> invalid_method(const GlockerNcp& m) {
  if (m.stages < 1) return refusal("stages", m.stages, "at least 1");
  if (auto why = invalid(m.formulation)) return why;
  return ncp::invalid(m.method);
}

}  // namespace

std::string_view to_string(Status status) {
  switch (status) {
    case Status::Solved:
      return "Solved";
    case Status::NoProgress:
      return "NoProgress";
    case Status::TimeLimit:
      return "TimeLimit";
    case Status::Interrupted:
      return "Interrupted";
  }
  return "?";
}

std::optional<std::string> invalid(const Options& options) {
  if (!(options.tol > 0)) return refusal("tol", options.tol, "positive");
  if (!(options.max_time.count() >= 0)) return refusal("max_time", options.max_time.count(), "at least 0 s");
  return std::visit([](const auto& m) { return invalid_method(m); }, options.method);
}

Referee::Referee(const Problem& problem, const Scaled& scaled, const Options& options)
    : problem_(problem), scaled_(scaled), options_(options), best_(Vec::Zero(scaled.size())) {
  result_.residual = residual(problem, Vec::Zero(scaled.whole));
  last_ = best_metric_ = std::max(result_.residual.siconos, result_.residual.rr9118);
  if (best_metric_ <= options.tol) result_.status = Status::Solved;
}

bool Referee::judge(In r, Record record) {
  last_ = lcp::infinity;
  if (r.allFinite()) {
    const Residual now = residual(problem_, scaled_.expand(r));
    record.k = static_cast<int>(result_.history.size());
    record.siconos = now.siconos;
    record.rr9118 = now.rr9118;
    result_.history.push_back(record);
    last_ = std::max(now.siconos, now.rr9118);
    if (last_ < best_metric_) {
      best_metric_ = last_;
      best_ = r;
      result_.residual = now;
    }
  }
  if (best_metric_ <= options_.tol) result_.status = Status::Solved;
  return over();
}

bool Referee::over() {
  if (result_.status == Status::NoProgress) {
    if (options_.interrupt != nullptr && *options_.interrupt)
      result_.status = Status::Interrupted;
    else if (seconds_left() <= 0)
      result_.status = Status::TimeLimit;
  }
  return result_.status != Status::NoProgress;
}

double Referee::seconds_left() const {
  return std::chrono::duration<double>(options_.max_time - (std::chrono::steady_clock::now() - begin_)).count();
}

Result Referee::result(const std::string& message) {
  result_.solution.r = scaled_.expand(best_);
  result_.solution.u = problem_.W * result_.solution.r + problem_.q;
  std::ostringstream text;
  if (result_.status == Status::Solved)
    text << "solved: ";
  else if (result_.status == Status::TimeLimit)
    text << "the time limit of " << options_.max_time.count() << " s was reached: ";
  else if (result_.status == Status::Interrupted)
    text << "interrupted: ";
  else
    text << message << ": ";
  text.precision(3);
  text << "the natural map is " << result_.residual.siconos << " (largest of |q|, |r|, |u|) and "
       << result_.residual.rr9118 << " (|q|), relative";
  if (result_.status != Status::Solved && result_.residual.worst >= 0)
    text << "; worst at contact " << result_.residual.worst + 1;
  result_.message = text.str();
  result_.stats.time = std::chrono::steady_clock::now() - begin_;
  return std::move(result_);
}

Result solve(const Problem& problem, const Options& options) {
  check(problem);
  if (const auto why = invalid(options)) throw std::invalid_argument("contact::solve: " + *why);
  if (options.start.size() != 0 && (options.start.size() != problem.q.size() || !options.start.allFinite()))
    throw std::invalid_argument("contact::solve: the start has " + std::to_string(options.start.size()) +
                                " entries, or some that are not finite; the problem has " +
                                std::to_string(problem.q.size()));
  const bool scale = std::visit([](const auto& m) { return m.scaling; }, options.method);
  const Scaled coordinates = scaled(problem, scale);
  Referee referee(problem, coordinates, options);
  const Vec start = options.start.size() > 0 ? coordinates.reduce(options.start) : Vec();
  if (!referee.over()) {
    if (const auto* homotopy = std::get_if<GlockerHomotopy>(&options.method))
      run_homotopy(referee, coordinates, *homotopy, start);
    else
      run_ncp(referee, coordinates, std::get<GlockerNcp>(options.method), start);
  }
  return referee.result("no attempt comes closer");
}

}  // namespace perp::contact
