// SPDX-License-Identifier: Apache-2.0
#include "app/contact/contact.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <sstream>

#include "app/contact/run/report.hpp"
#include "app/contact/run/run.hpp"
#include "app/problem/problem.hpp"
#include "app/program/files.hpp"
#include "app/report/json.hpp"
#include "contact/io/fclib.hpp"
#include "lcp/lu/sparse_lu.hpp"

namespace perp::app::contacts {

namespace {

/// Flags that make no sense.
void check_request(const ContactRequest& request, std::size_t problems) {
  if (problems == 0)
    throw InputError("which problem? FILE, or NAME:SIZE[:SEED[:MU]] of a generator, as in spheres:100");
  if (!(request.tol > 0) || !std::isfinite(request.tol))
    throw input_error("--tol {:g}: a tolerance is positive", request.tol);
  if (!(request.time_limit > 0)) throw input_error("--time-limit {:g}: a limit is positive", request.time_limit);
  if (request.fclib_out == "-") throw InputError("--fclib-out -: that goes to a file");
  if (!request.fclib_out.empty() && problems > 1)
    throw input_error("--fclib-out {}: goes with one problem, not with {}", request.fclib_out, problems);
}

/// A refusal is not written as JSON where these do not fit.
bool files_fit(const ContactRequest& request, Streams streams) {
  const std::vector<FileUse> outputs{{"--json", request.json}, {"--fclib-out", request.fclib_out}};
  return outputs_fit(outputs, files_of(request.problems), streams);
}

/// v of the bodies and lambda, of M v = H r + G lambda + f, 0 = G' v + b; nothing if the matrix is singular.
void add_body_velocities(const contact::Global& global, contact::FclibPoint& point) {
  const lcp::Index m = global.M.rows();
  const lcp::Index bilateral = global.b.size();
  lcp::SparseLu lu;
  if (lu.factor(contact::saddle_point(global.M, global.G)) != lcp::LuStatus::Ok) return;
  lcp::Vec right(m + bilateral);
  right << global.H * point.r + global.f, -global.b;
  lcp::Vec v(m + bilateral);
  lu.solve_refined(right, v);
  point.v = v.head(m);
  point.l = -v.tail(bilateral);
}

void write_solution(const std::string& path, const Loaded& loaded, const Run& run) {
  contact::Fclib file{.problem = loaded.problem,
                      .title = loaded.label,
                      .description = fmt::format("solution: {}, {}, by perp {}: {}", run.variant.label(),
                                                 to_string(run.status), version_number(), run.message)};
  file.solution = contact::FclibPoint{.u = run.solution.u, .r = run.solution.r};
  if (loaded.problem.global) add_body_velocities(*loaded.problem.global, *file.solution);
  contact::write_fclib(path, file);
}

class Command {
 public:
  Command(const ContactRequest& request, Streams streams, const std::atomic<bool>* interrupt)
      : request_(request),
        streams_(streams),
        interrupt_(interrupt),
        log_(request.json == "-" ? streams.err : streams.out) {}

  ExitCode run() {
    std::vector<std::string> problems = request_.problems;
    problems.insert(problems.end(), request_.generated.begin(), request_.generated.end());
    std::string why = refusal("", [&] {
      check_request(request_, problems.size());
      variant_ = parse_variant(request_.variant);
      for (const std::string& name : request_.generated)
        if (!is_generated(name)) generate(name);  // says why
    });
    if (why.empty() && shows(LogLevel::Warning))
      for (const std::string& note : variant_.applied.notes) streams_.err << "perp: note: " << note << '\n';
    if (!why.empty()) return refuse(problems.empty() ? "" : problems[0], why);
    for (std::size_t k = 0; k < problems.size() && !stopped(); ++k) {
      if (k > 0 && shows(LogLevel::Info)) log_ << '\n';
      take(problems[k]);
    }
    if (all_.size() > 1 && shows(LogLevel::Summary)) {
      log_ << '\n';
      print_summaries(log_, all_);
    }
    if (all_.size() < problems.size()) code_ = std::max(code_, exit_unsolved);  // interrupted
    log_.flush();
    const std::string json = problems.size() == 1 && json_.size() == 1 ? json_[0] : runs_json(json_, code_);
    return deliver_json(request_.json, json, streams_) ? code_ : exit_input;
  }

 private:
  bool shows(LogLevel level) const { return request_.log_level >= level; }
  bool stopped() const { return interrupt_ != nullptr && interrupt_->load(); }

  ExitCode refuse(const std::string& problem, const std::string& why) {
    streams_.err << "perp: " << why << '\n';
    std::ostringstream said;  // that it cannot be written, again
    deliver_json(request_.json, refused_json(problem, why), {streams_.out, said});
    return exit_input;
  }

  /// One problem, from its file to its lines; its JSON is kept.
  void take(const std::string& name) {
    Summary summary;
    summary.label = name;
    const auto take_it = [&] {
      const double seconds = variant_.applied.seconds.value_or(request_.time_limit);
      const double tol = variant_.applied.tol.value_or(request_.tol);
      const Patience limits = patience(std::chrono::duration<double>(seconds), interrupt_);
      end_by(limits.deadline);
      const std::shared_ptr<const Loaded> kept = load_within(limits, name);
      const Loaded& loaded = *kept;
      if (shows(LogLevel::Info)) print_heading(log_, loaded, variant_, tol);
      log_.flush();
      summary.run = run_within(limits, kept, variant_, {.tol = tol, .seconds = seconds});
      writing_takes(patience_with_writing(loaded.problem.q.size()));
      const Run& run = summary.run;
      print(loaded, run);
      const ExitCode code = run.solved ? exit_solved : exit_unsolved;
      code_ = std::max(code_, code);
      json_.push_back(request_.json.empty() ? "{}" : run_json(loaded, run, code));
      if (!request_.fclib_out.empty()) write_solution(request_.fclib_out, loaded, run);
    };
    try {
      summary.refused = refusal(name, take_it);
    } catch (const OutOfTime& out) {
      streams_.err << "perp: " << out.what() << '\n';
      code_ = std::max(code_, exit_unsolved);
      summary.run.status = out.status();
      json_.resize(all_.size());
      json_.push_back(no_point_json(name, out));
    }
    end_by(Clock::time_point::max());
    if (!summary.refused.empty()) {
      streams_.err << "perp: " << summary.refused << '\n';
      code_ = exit_input;
      json_.resize(all_.size());
      json_.push_back(refused_json(name, summary.refused));
    }
    all_.push_back(std::move(summary));
  }

  void print(const Loaded& loaded, const Run& run) {
    if (shows(LogLevel::Debug)) print_history(log_, run);
    if (shows(LogLevel::Info)) {
      log_ << '\n';
      print_contacts(log_, loaded.problem, run, request_.full);
      log_ << '\n';
    }
    if (!shows(LogLevel::Summary)) return;
    if (!shows(LogLevel::Info)) log_ << loaded.label << '\n';
    print_verdict(log_, loaded.problem, run);
    if (shows(LogLevel::Info)) {
      log_ << '\n';
      print_judge(log_, loaded.problem, run);
    }
  }

  const ContactRequest& request_;
  Streams streams_;
  const std::atomic<bool>* interrupt_;
  std::ostream& log_;
  Variant variant_;
  ExitCode code_ = exit_solved;
  std::vector<Summary> all_;
  std::vector<std::string> json_;
};

}  // namespace

ExitCode solve_contact(const ContactRequest& request, Streams streams, const std::atomic<bool>* interrupt) {
  if (!files_fit(request, streams)) return exit_input;
  return Command(request, streams, interrupt).run();
}

}  // namespace perp::app::contacts
