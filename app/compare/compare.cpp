// SPDX-License-Identifier: Apache-2.0
#include "app/compare/compare.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <ostream>
#include <set>

#include "app/campaign/settle.hpp"
#include "app/campaign/threads.hpp"
#include "app/compare/asked.hpp"
#include "app/compare/baseline.hpp"
#include "app/compare/journal.hpp"
#include "app/compare/outcome_table.hpp"
#include "app/compare/progress.hpp"
#include "app/comparison_report/write_report.hpp"
#include "app/program/bounded_call.hpp"
#include "app/program/files.hpp"
#include "app/text/table.hpp"
#include "app/worker/run_cell.hpp"

namespace perp::app::compare {

namespace {

namespace fs = std::filesystem;

struct Pending {
  const AskedMethod* method;
  const AskedProblem* problem;
  int start;
};

/// Problem by problem, so that what is seen first is comparable. `total`: of the campaign's shard, done or not.
std::vector<Pending> pending_cells(const Campaign& campaign, const std::vector<Cell>& done, std::size_t& total) {
  std::set<CellKey> keys;
  for (const Cell& cell : done) keys.insert(key(cell));
  const Shard shard = parse_shard(campaign.shard);
  std::vector<Pending> cells;
  std::size_t number = 0;
  total = 0;
  for (const AskedProblem& problem : campaign.problems)
    for (int start = 1; start <= problem.starts; ++start)
      for (const AskedMethod& method : campaign.methods) {
        if (!shard.has(number++)) continue;
        ++total;
        if (!keys.contains({method.label, problem.name, start})) cells.push_back({&method, &problem, start});
      }
  return cells;
}

class Comparison {
 public:
  Comparison(const CompareRequest& request, Streams streams, const std::atomic<bool>* interrupt)
      : request_(request), streams_(streams), stopper_(interrupt) {}

  int run() {
    check_utf8(request_.out);
    if (!request_.baseline.empty() && request_.shard)
      throw InputError("--baseline: compares all cells, --shard runs some of them");
    if (!request_.baseline.empty()) baseline_ = read_baseline(request_.baseline);
    std::error_code ignored;
    const bool resume = request_.resume && fs::exists(request_.out + "/campaign.json", ignored);
    if (request_.resume && !resume && !request_.problems && !request_.methods && request_.externals.empty())
      throw input_error("--resume: there is no campaign in '{}'", request_.out);
    if (request_.resume && !resume) note(fmt::format("there is no campaign in '{}' yet: one begins", request_.out));
    if (!(resume ? take_up() : begin())) return interrupted(0, 0);
    return work();
  }

 private:
  void note(const std::string& text) { streams_.err << "perp: note: " << text << '\n'; }

  /// The campaign's own files replace nothing that it reads.
  void check_files(const Campaign& campaign) const {
    std::vector<FileUse> inputs{{"--baseline", request_.baseline}};
    for (const AskedProblem& problem : campaign.problems) inputs.push_back({"", problem.file});
    check_campaign_files(request_.out, inputs);
  }

  /// What was begun. Throws InputError if it is something else.
  bool take_up() {
    const Campaign before = read_campaign(request_.out);
    std::vector<std::string> notes;
    Campaign now = asked_campaign(request_, &before, notes);
    std::erase_if(now.problems, [&](const AskedProblem& problem) {  // left out then
      return problem.by_pattern &&
             std::ranges::find(before.problems, problem.name, &AskedProblem::name) == before.problems.end();
    });
    check_resumable(request_.out, before, now);
    check_files(now);
    if (before.build != now.build) note("the program is another build than the one that began this campaign");
    if (before.machine.cpu != now.machine.cpu)
      note(fmt::format("another machine began this campaign ({}): times do not compare", before.machine.cpu));
    if (before.jobs != now.jobs)
      note(fmt::format("begun with {}, now {} at a time: times do not compare", count(before.jobs, "run"), now.jobs));
    lock_ = std::make_unique<DirectoryLock>(request_.out);
    campaign_ = before;
    campaign_.jobs = now.jobs;
    return true;
  }

  /// A new one; false if it was interrupted while problems were looked at.
  bool begin() {
    std::vector<std::string> notes;
    campaign_ = asked_campaign(request_, nullptr, notes);
    for (const std::string& text : notes) note(text);
    check_files(campaign_);
    make_directory(request_.out, true);
    lock_ = std::make_unique<DirectoryLock>(request_.out);
    try {
      if (!describe_problems()) {
        leave_nothing();
        return false;
      }
    } catch (const InputError&) {
      leave_nothing();
      throw;
    }
    write_file(request_.out + "/campaign.json", campaign_json(campaign_));
    return true;
  }

  /// Of a campaign that has not begun.
  void leave_nothing() {
    std::error_code ignored;
    fs::remove_all(work_folder(), ignored);
    fs::remove(request_.out + "/lock", ignored);
    fs::remove(request_.out, ignored);  // if empty
  }

  std::string work_folder() const { return fs::absolute(request_.out) / "work"; }
  std::unique_ptr<CellRunner> runner(int thread) {
    return std::make_unique<CellRunner>(campaign_, request_.program, fmt::format("{}/{}", work_folder(), thread),
                                        stopper_.flag());
  }
  std::vector<std::unique_ptr<CellRunner>> runners() {
    std::error_code ignored;
    fs::remove_all(work_folder(), ignored);  // of a campaign that was killed
    std::vector<std::unique_ptr<CellRunner>> all;
    all.reserve(static_cast<std::size_t>(campaign_.jobs));
    for (int t = 0; t < campaign_.jobs; ++t) all.push_back(runner(t));
    return all;
  }

  bool describe_problems() {
    std::vector<AskedProblem>& problems = campaign_.problems;
    std::vector<std::string> refused(problems.size());
    const auto all = runners();
    in_threads(
        problems.size(), campaign_.jobs, stopper_,
        [&](std::size_t k, int t) {
          try {
            if (const auto described = all[static_cast<std::size_t>(t)]->describe(problems[k]))
              problems[k] = *described;
          } catch (const InputError& error) {
            if (!problems[k].by_pattern) throw;
            refused[k] = error.what();
          }
        },
        [] {});
    std::vector<AskedProblem> kept;
    for (std::size_t k = 0; k < problems.size(); ++k) {
      if (refused[k].empty())
        kept.push_back(problems[k]);
      else
        note(fmt::format("{} is left out: {}", problems[k].name, refused[k]));
    }
    if (kept.empty() && !problems.empty()) throw InputError("--problems: every file is refused");
    problems = std::move(kept);
    return !stopper_.look();
  }

  int work() {
    Journal journal(request_.out);
    for (const std::string& dropped : journal.before().dropped)
      note(fmt::format("{}/cells.jsonl, {}: left out, its cell runs again", request_.out, dropped));
    const std::vector<Cell>& before = journal.before().cells;
    std::size_t total = 0;
    const std::vector<Pending> cells = pending_cells(campaign_, before, total);
    std::set<std::string> without_solution;
    for (const AskedProblem& problem : campaign_.problems)
      if (!problem.solvable()) without_solution.insert(problem.name);
    Progress progress(streams_.terminal != nullptr ? *streams_.terminal : streams_.err, total, before,
                      terminal_width(STDERR_FILENO), std::move(without_solution));
    streams_.err << fmt::format("perp: {} x {}: {}{}, {} at a time\n",
                                count(static_cast<long long>(campaign_.methods.size()), "method"),
                                count(static_cast<long long>(campaign_.problems.size()), "problem"),
                                count(static_cast<long long>(total), "cell"),
                                before.empty() ? "" : fmt::format(", {} of them to do", cells.size()), campaign_.jobs);
    std::atomic<std::size_t> done{total - cells.size()};
    {
      const auto all = runners();
      in_threads(
          cells.size(), campaign_.jobs, stopper_,
          [&](std::size_t k, int t) {
            const Pending& next = cells[k];
            const auto cell = all[static_cast<std::size_t>(t)]->run(*next.method, *next.problem, next.start);
            if (!cell) return;
            journal.add(*cell);
            ++done;
            progress.add(*cell);
          },
          [&] { progress.tick(); });
    }
    progress.end();
    std::error_code ignored;
    fs::remove_all(work_folder(), ignored);
    return done < total ? interrupted(done, total) : finish();
  }

  int interrupted(std::size_t done, std::size_t total) {
    if (total == 0)
      streams_.err << "perp: interrupted before the first cell; nothing is left behind\n";
    else
      streams_.err << fmt::format(
          "perp: interrupted; {} of {} cells are done. 'perp compare --out {} --resume' goes on\n", done, total,
          shell_quoted(request_.out));
    return exit_interrupted;
  }

  int finish() {
    write_report(request_.out);
    if (!campaign_.shard.empty()) {
      streams_.out << fmt::format("Shard {} is complete. 'perp report DIR... --out JOINED' joins the folders of all.\n",
                                  campaign_.shard);
      return exit_solved;
    }
    std::vector<Cell> cells = read_cells(request_.out).cells;
    settle(campaign_, cells);
    print_outcomes(streams_.out, campaign_, cells);
    print_false_claims(streams_.out, cells);
    streams_.out << fmt::format(
        "\n{0}/report.html shows and {0}/findings.txt says what came out; {0}/cells.csv has every cell.\n",
        request_.out);
    if (request_.baseline.empty()) return exit_solved;
    const BaselineComparison comparison = compare_with(baseline_, cells);
    print_comparison(streams_.out, request_.baseline, comparison);
    return comparison.regressions.empty() ? exit_solved : exit_unsolved;
  }

  const CompareRequest& request_;
  Streams streams_;
  Stopper stopper_;
  std::vector<BaselineRow> baseline_;
  Campaign campaign_;
  std::unique_ptr<DirectoryLock> lock_;
};

}  // namespace

int compare(const CompareRequest& request, Streams streams, const std::atomic<bool>* interrupt) {
  leave_with(exit_interrupted);
  try {
    return Comparison(request, streams, interrupt).run();
  } catch (const InputError& error) {
    return say_refused(streams, error.what());
  }
}

}  // namespace perp::app::compare
