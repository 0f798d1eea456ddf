#include "app/contact/compare_variants.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <ostream>
#include <sstream>
#include <thread>

#include "app/compare/compare.hpp"
#include "app/compare/journal.hpp"
#include "app/contact/report.hpp"
#include "app/contact/run.hpp"
#include "app/contact/variants_report.hpp"
#include "app/json.hpp"
#include "app/problem.hpp"
#include "app/table.hpp"

namespace perp::app::contacts {

namespace {

namespace fs = std::filesystem;

std::string slurp(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

void check_request(const CompareVariantsRequest& request) {
  if (request.problems.empty())
    throw InputError("--compare: which problems? FILE..., or NAME:SIZE[:SEED] of a generator");
  if (!(request.tol > 0) || !std::isfinite(request.tol))
    throw InputError(fmt::format("--tol {:g}: a tolerance is positive", request.tol));
  if (!(request.time_limit > 0) || !std::isfinite(request.time_limit))
    throw InputError(fmt::format("--time-limit {:g}: a limit is positive", request.time_limit));
  if (request.memory_mb < 1) throw InputError(fmt::format("--memory-limit {}: at least 1 MB", request.memory_mb));
  if (request.jobs < 1) throw InputError(fmt::format("--jobs {}: at least 1", request.jobs));
  for (std::size_t k = 0; k < request.problems.size(); ++k)
    if (std::ranges::count(request.problems, request.problems[k]) > 1)
      throw InputError(fmt::format("'{}' is there twice", request.problems[k]));
}

class Campaign {
 public:
  Campaign(const CompareVariantsRequest& request, Streams streams, const std::atomic<bool>* interrupt)
      : request_(request), streams_(streams), interrupt_(interrupt), variants_(parse_variants(request.variants)) {
    comparison_ = {.problems = request.problems,
                   .tol = request.tol,
                   .time_limit = request.time_limit,
                   .memory_mb = request.memory_mb};
    for (const Variant& variant : variants_) comparison_.variants.push_back(variant.label());
  }

  int run() {
    compare::make_directory(request_.out, true);
    const std::size_t total = variants_.size() * request_.problems.size();
    streams_.err << fmt::format("perp: {} x {}: {}\n", count(static_cast<long long>(variants_.size()), "variant"),
                                count(static_cast<long long>(request_.problems.size()), "problem"),
                                count(static_cast<long long>(total), "cell"));
    in_threads(total);
    std::error_code ignored;
    fs::remove_all(work_folder(), ignored);
    std::ranges::sort(comparison_.cells, {}, [&](const Cell& cell) { return order(cell); });
    write_files(true);
    const bool complete = comparison_.cells.size() == total;
    std::ostream& out = request_.json == "-" ? streams_.err : streams_.out;
    print_comparison(out, comparison_);
    out << fmt::format("\n{0}/report.html shows it; {0}/cells.csv has every cell, {0}/profile.svg the profile.\n",
                       request_.out);
    if (!complete)
      streams_.err << fmt::format("perp: interrupted; {} of {} cells are done\n", comparison_.cells.size(), total);
    if (!deliver_json(request_.json, cells_json(comparison_.cells), streams_)) return exit_input;
    return complete ? static_cast<int>(exit_solved) : compare::exit_interrupted;
  }

 private:
  std::string work_folder() const { return fs::absolute(request_.out) / "work"; }
  bool stopped() const { return failed_ || (interrupt_ != nullptr && interrupt_->load()); }
  std::pair<std::ptrdiff_t, std::ptrdiff_t> order(const Cell& cell) const {
    return {std::ranges::find(comparison_.problems, cell.problem) - comparison_.problems.begin(),
            std::ranges::find(comparison_.variants, cell.variant) - comparison_.variants.begin()};
  }

  /// Problem by problem, so that what is seen first is comparable. Rethrows the first failure.
  void in_threads(std::size_t total) {
    std::atomic<std::size_t> next{0};
    std::exception_ptr failure;
    const auto work = [&](int thread) {
      try {
        for (std::size_t k = next++; k < total && !stopped(); k = next++)
          one(request_.problems[k / variants_.size()], variants_[k % variants_.size()], thread, total);
      } catch (...) {
        const std::scoped_lock lock(mutex_);
        if (!failure) failure = std::current_exception();
        failed_ = true;
      }
    };
    std::vector<std::thread> others;
    for (int t = 1; t < request_.jobs; ++t) others.emplace_back(work, t);
    work(0);
    for (std::thread& other : others) other.join();
    if (failure) std::rethrow_exception(failure);
  }

  void one(const std::string& problem, const Variant& variant, int thread, std::size_t total) {
    const std::string folder = fmt::format("{}/{}", work_folder(), thread);
    fs::remove_all(folder);
    fs::create_directories(folder);
    std::vector<std::string> words{"contact", fs::exists(problem) ? std::string(fs::absolute(problem)) : problem};
    for (const std::string& flag : variant.flags()) words.push_back(flag);
    for (const std::string& flag : {std::string("--tol"), fmt::format("{:g}", request_.tol),
                                    std::string("--time-limit"), fmt::format("{:g}", request_.time_limit)})
      words.push_back(flag);
    const std::string command = fmt::format("perp {}", fmt::join(words, " "));
    for (const char* flag : {"--log-level", "quiet", "--json"}) words.emplace_back(flag);
    words.push_back(folder + "/result.json");
    words.insert(words.begin(), request_.program);
    const compare::ProcessLimits limits{.seconds = 2 * request_.time_limit + request_.reading,
                                        .memory_mb = request_.memory_mb};
    const compare::ProcessEnd end =
        compare::run_process({.arguments = words, .log = folder + "/log", .limits = limits}, interrupt_);
    if (end.why == compare::ProcessEnd::Why::NotStarted)
      throw InputError(fmt::format("a process for '{}' cannot be started: {}", problem, end.error));
    if (end.why == compare::ProcessEnd::Why::Interrupted) return;
    Cell cell = cell_of(end, slurp(folder + "/result.json"), limits);
    cell.variant = variant.label();
    cell.problem = problem;
    cell.exact = variant.exact();
    cell.command = command;
    if (cell.status == "Interrupted" && stopped()) return;
    const bool over = cell.seconds > request_.time_limit;
    if (over && cell.solved()) cell.message = fmt::format("solved after {:.3g} s, beyond the limit", cell.seconds);
    if (over && (cell.solved() || cell.outcome == Outcome::Failed)) cell.outcome = Outcome::TimeLimit;
    add(std::move(cell), total);
  }

  /// Finished cells are on the disk, whatever comes.
  void add(Cell cell, std::size_t total) {
    const std::scoped_lock lock(mutex_);
    streams_.err << fmt::format("perp: {} of {}: {}, {}: {} after {}\n", comparison_.cells.size() + 1, total,
                                cell.problem, cell.variant, compare::to_string(cell.outcome),
                                seconds_text(cell.seconds))
                 << std::flush;
    comparison_.cells.push_back(std::move(cell));
    write_files(false);
  }

  void write_files(bool all) const {
    write_file(request_.out + "/cells.csv", cells_csv(comparison_.cells));
    if (!all) return;
    write_file(request_.out + "/cells.json", cells_json(comparison_.cells));
    write_file(request_.out + "/profile.svg", profile_svg(comparison_));
    write_file(request_.out + "/report.html", report_html(comparison_));
  }

  const CompareVariantsRequest& request_;
  Streams streams_;
  const std::atomic<bool>* interrupt_;
  std::vector<Variant> variants_;
  Comparison comparison_;
  std::mutex mutex_;
  std::atomic<bool> failed_{false};
};

/// All files are read once before anything runs: a misspelt name is no result. Generated problems are not made.
bool refused_problems(const CompareVariantsRequest& request, Streams streams) {
  bool any = false;
  for (const std::string& problem : request.problems) {
    if (is_generated(problem)) continue;
    const std::string why = refusal(problem, [&] { load(problem); });
    if (why.empty()) continue;
    streams.err << "perp: " << why << '\n';
    any = true;
  }
  return any;
}

}  // namespace

int compare_variants(const CompareVariantsRequest& request, Streams streams, const std::atomic<bool>* interrupt) {
  int code = exit_input;
  const std::string why = refusal("", [&] {
    check_request(request);
    Campaign campaign(request, streams, interrupt);
    if (!refused_problems(request, streams)) code = campaign.run();
  });
  if (!why.empty()) streams.err << "perp: " << why << '\n';
  return code;
}

}  // namespace perp::app::contacts
