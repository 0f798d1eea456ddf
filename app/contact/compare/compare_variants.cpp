// SPDX-License-Identifier: Apache-2.0
#include "app/contact/compare/compare_variants.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <mutex>
#include <ostream>

#include "app/campaign/threads.hpp"
#include "app/compare/compare.hpp"
#include "app/compare/journal.hpp"
#include "app/contact/compare/campaign.hpp"
#include "app/contact/compare/variants_report.hpp"
#include "app/contact/run/report.hpp"
#include "app/contact/run/run.hpp"
#include "app/problem/problem.hpp"
#include "app/program/bounded_call.hpp"
#include "app/program/files.hpp"
#include "app/report/json.hpp"
#include "app/text/table.hpp"

namespace perp::app::contacts {

namespace {

namespace fs = std::filesystem;

void check_request(const CompareVariantsRequest& request) {
  if (request.tol && (!(*request.tol > 0) || !std::isfinite(*request.tol)))
    throw input_error("--tol {:g}: a tolerance is positive", *request.tol);
  if (request.time_limit && (!(*request.time_limit > 0) || !std::isfinite(*request.time_limit)))
    throw input_error("--time-limit {:g}: a limit is positive", *request.time_limit);
  if (request.memory_mb && *request.memory_mb < 1)
    throw input_error("--memory-limit {}: at least 1 MB", *request.memory_mb);
  if (request.jobs < 1) throw input_error("--jobs {}: at least 1", request.jobs);
  check_outputs(std::vector<FileUse>{{"--json", request.json}}, files_of(request.problems));
  for (std::size_t k = 0; k < request.problems.size(); ++k)
    if (std::ranges::count(request.problems, request.problems[k]) > 1)
      throw input_error("'{}' is there twice", request.problems[k]);
}

/// All files are read once before anything runs: a misspelt name is no result. Generated problems are not made.
bool any_refused(const std::vector<std::string>& problems, std::ostream& err) {
  bool any = false;
  for (const std::string& problem : problems) {
    if (is_generated(problem)) continue;
    const std::string why = refusal(problem, [&] { load(problem); });
    if (why.empty()) continue;
    err << "perp: " << why << '\n';
    any = true;
  }
  return any;
}

/// What is asked for; what is not, as in `before` (null: none).
Campaign asked_campaign(const CompareVariantsRequest& request, const Campaign* before) {
  Campaign campaign = before != nullptr ? *before : Campaign{};
  if (request.variants || before == nullptr) {
    campaign.variants.clear();
    for (const Variant& variant : parse_variants(request.variants.value_or(default_variants)))
      campaign.variants.push_back(variant.label());
  }
  campaign.tol = request.tol.value_or(campaign.tol);
  campaign.time_limit = request.time_limit.value_or(campaign.time_limit);
  campaign.memory_mb = request.memory_mb.value_or(campaign.memory_mb);
  campaign.version = version_number();
  std::vector<std::string> problems = request.problems;
  if (problems.empty())
    for (const CampaignProblem& problem : campaign.problems) problems.push_back(problem.argument());
  campaign.problems.clear();
  for (const std::string& problem : problems) campaign.problems.push_back(campaign_problem(problem));
  return campaign;
}

class Comparing {
 public:
  Comparing(const CompareVariantsRequest& request, Streams streams, const std::atomic<bool>* interrupt)
      : request_(request), streams_(streams), stopper_(interrupt) {}

  int run() {
    check_utf8(request_.out);
    if (!begin()) return exit_input;
    check_files();
    lock_ = std::make_unique<compare::DirectoryLock>(request_.out);
    if (!resumed_) write_file(request_.out + "/campaign.json", compare::campaign_json(campaign_));
    journal_ = std::make_unique<compare::JournalOf<Cell>>(request_.out);
    const std::size_t total = take_up();
    streams_.err << fmt::format("perp: {} x {}: {}{}\n",
                                count(static_cast<long long>(campaign_.variants.size()), "variant"),
                                count(static_cast<long long>(campaign_.problems.size()), "problem"),
                                count(static_cast<long long>(total), "cell"),
                                comparison_.cells.empty() ? "" : fmt::format(", {} of them to do", pending_.size()));
    std::error_code ignored;
    fs::remove_all(work_folder(), ignored);  // of a campaign that was killed
    // Problem by problem, so that what is seen first is comparable.
    compare::in_threads(pending_.size(), request_.jobs, stopper_, [&](std::size_t k, int thread) {
      one(*pending_[k].problem, pending_[k].variant, thread, total);
    });
    fs::remove_all(work_folder(), ignored);
    std::ranges::sort(comparison_.cells, {}, [&](const Cell& cell) { return order(cell); });
    write_files();
    return finish(total);
  }

 private:
  void note(const std::string& text) { streams_.err << "perp: note: " << text << '\n'; }

  /// A new campaign, or the one in the folder. False: problems were refused, each with its reason.
  bool begin() {
    resumed_ = request_.resume && compare::holds_campaign(request_.out);
    if (request_.problems.empty() && !resumed_)
      throw InputError(request_.resume
                           ? fmt::format("--resume: there is no campaign in '{}'", request_.out)
                           : std::string("--compare: which problems? FILE..., or NAME:SIZE[:SEED] of a generator"));
    if (request_.resume && !resumed_) note(fmt::format("there is no campaign in '{}' yet: one begins", request_.out));
    if (!resumed_) {
      if (request_.variants) parse_variants(*request_.variants);  // before files are read
      if (any_refused(request_.problems, streams_.err)) return false;
      campaign_ = asked_campaign(request_, nullptr);
      compare::make_directory(request_.out, true);
      return true;
    }
    const Campaign before = compare::campaign_in(request_.out, compare::campaign_of<Campaign>);
    std::vector<std::string> problems = request_.problems;
    for (const CampaignProblem& problem : before.problems)
      if (request_.problems.empty()) problems.push_back(problem.argument());
    if (any_refused(problems, streams_.err)) return false;
    const std::vector<std::string> found = differences(before, asked_campaign(request_, &before));
    if (!found.empty())
      throw input_error("--resume: '{}' holds another campaign:\n  {}", request_.out, fmt::join(found, "\n  "));
    campaign_ = before;
    return true;
  }

  /// The files of the folder are neither problems nor each other.
  void check_files() const {
    std::vector<FileUse> inputs;
    for (const CampaignProblem& problem : campaign_.problems) inputs.push_back({"", problem.file});
    std::vector<FileUse> outputs{{"--json", request_.json}};
    for (const char* name :
         {"lock", "campaign.json", "cells.jsonl", "cells.csv", "cells.json", "profile.svg", "report.html"})
      outputs.push_back({"", fmt::format("{}/{}", request_.out, name)});
    check_apart(outputs, inputs);
  }

  /// Cells that are there and cells to do; how many there are in all.
  std::size_t take_up() {
    comparison_ = {.tol = campaign_.tol, .time_limit = campaign_.time_limit, .memory_mb = campaign_.memory_mb};
    comparison_.variants = campaign_.variants;
    for (const CampaignProblem& problem : campaign_.problems) comparison_.problems.push_back(problem.name);
    for (const std::string& dropped : journal_->before().dropped)
      note(fmt::format("{}/cells.jsonl, {}: left out, its cell runs again", request_.out, dropped));
    comparison_.cells = journal_->before().cells;
    for (const CampaignProblem& problem : campaign_.problems)
      for (const std::string& variant : campaign_.variants)
        if (comparison_.find(variant, problem.name) == nullptr) pending_.push_back({&problem, parse_variant(variant)});
    return campaign_.cells();
  }

  int finish(std::size_t total) {
    const bool complete = comparison_.cells.size() == total;
    std::ostream& out = request_.json == "-" ? streams_.err : streams_.out;
    print_comparison(out, comparison_);
    out << fmt::format("\n{0}/report.html shows it; {0}/cells.csv has every cell, {0}/profile.svg the profile.\n",
                       request_.out);
    if (!complete)
      streams_.err << fmt::format(
          "perp: interrupted; {} of {} cells are done. 'perp contact --compare --out {} --resume' goes on\n",
          comparison_.cells.size(), total, shell_quoted(request_.out));
    if (!deliver_json(request_.json, cells_json(comparison_.cells), streams_)) return exit_input;
    return complete ? static_cast<int>(exit_solved) : compare::exit_interrupted;
  }

  std::string work_folder() const { return fs::absolute(request_.out) / "work"; }
  std::pair<std::ptrdiff_t, std::ptrdiff_t> order(const Cell& cell) const {
    return {std::ranges::find(comparison_.problems, cell.problem) - comparison_.problems.begin(),
            std::ranges::find(comparison_.variants, cell.variant) - comparison_.variants.begin()};
  }

  void one(const CampaignProblem& problem, const Variant& variant, int thread, std::size_t total) {
    const std::string folder = fmt::format("{}/{}", work_folder(), thread);
    fs::remove_all(folder);
    fs::create_directories(folder);
    std::vector<std::string> words{"contact", problem.argument()};
    for (const std::string& flag : variant.flags()) words.push_back(flag);
    for (const std::string& flag : {std::string("--tol"), fmt::format("{}", campaign_.tol), std::string("--time-limit"),
                                    fmt::format("{}", campaign_.time_limit)})
      words.push_back(flag);
    const std::string command = fmt::format("perp {}", fmt::join(words, " "));
    for (const char* flag : {"--log-level", "quiet", "--json"}) words.emplace_back(flag);
    words.push_back(folder + "/result.json");
    words.insert(words.begin(), request_.program);
    const compare::ProcessLimits limits{.seconds = 2 * campaign_.time_limit + request_.reading,
                                        .memory_mb = campaign_.memory_mb};
    const compare::ProcessEnd end =
        compare::run_process({.arguments = words, .log = folder + "/log", .limits = limits}, stopper_.flag());
    if (end.why == compare::ProcessEnd::Why::NotStarted)
      throw input_error("a process for '{}' cannot be started: {}", problem.name, end.error);
    if (end.why == compare::ProcessEnd::Why::Interrupted) return;
    Cell cell = cell_of(end, read_text(folder + "/result.json"), limits);
    cell.variant = variant.label();
    cell.problem = problem.name;
    cell.exact = variant.exact();
    cell.command = command;
    if (cell.status == "Interrupted" && stopper_.look()) return;
    const bool over = cell.seconds > campaign_.time_limit;
    if (over && cell.solved()) cell.message = fmt::format("solved after {:.3g} s, beyond the limit", cell.seconds);
    if (over && (cell.solved() || cell.outcome == Outcome::Failed)) cell.outcome = Outcome::TimeLimit;
    add(std::move(cell), total);
  }

  /// Finished cells are on the disk, whatever comes.
  void add(Cell cell, std::size_t total) {
    journal_->add(cell);
    const std::scoped_lock lock(mutex_);
    comparison_.cells.push_back(std::move(cell));
    const Cell& added = comparison_.cells.back();
    streams_.err << fmt::format("perp: {} of {}: {}, {}: {} after {}\n", comparison_.cells.size(), total, added.problem,
                                added.variant, compare::to_string(added.outcome), seconds_text(added.seconds))
                 << std::flush;
  }

  void write_files() const {
    app::write_files(
        std::vector<std::pair<std::string, std::string>>{{request_.out + "/cells.csv", cells_csv(comparison_.cells)},
                                                         {request_.out + "/cells.json", cells_json(comparison_.cells)},
                                                         {request_.out + "/profile.svg", profile_svg(comparison_)},
                                                         {request_.out + "/report.html", report_html(comparison_)}});
  }

  struct Pending {
    const CampaignProblem* problem;
    Variant variant;
  };
  const CompareVariantsRequest& request_;
  Streams streams_;
  compare::Stopper stopper_;
  bool resumed_ = false;
  Campaign campaign_;
  std::unique_ptr<compare::DirectoryLock> lock_;
  std::unique_ptr<compare::JournalOf<Cell>> journal_;
  std::vector<Pending> pending_;
  Comparison comparison_;
  std::mutex mutex_;
};

}  // namespace

int compare_variants(const CompareVariantsRequest& request, Streams streams, const std::atomic<bool>* interrupt) {
  leave_with(compare::exit_interrupted);
  int code = exit_input;
  const std::string why = refusal("", [&] {
    check_request(request);
    code = Comparing(request, streams, interrupt).run();
  });
  if (!why.empty()) streams.err << "perp: " << why << '\n';
  return code;
}

}  // namespace perp::app::contacts
