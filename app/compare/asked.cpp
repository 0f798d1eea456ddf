// SPDX-License-Identifier: Apache-2.0
#include "app/compare/asked.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>

#include "app/campaign/cell.hpp"
#include "app/campaign/selection.hpp"
#include "app/worker/external.hpp"

namespace perp::app::compare {

namespace {

template <class T>
T checked(const char* flag, T value, T least, T most) {
  if (value >= least && value <= most) return value;
  throw input_error("{} {}: a number from {} to {} is asked for", flag, value, least, most);
}

int parse_starts(const std::string& text) {
  int starts = 0;
  if (text == "all") return 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), starts);
  if (error != std::errc{} || end != text.data() + text.size() || starts < 1)
    throw input_error("--starts '{}': 'all', or how many of each problem at most, from 1", text);
  return starts;
}

std::vector<AskedMethod> asked_methods(const CompareRequest& request, const Campaign* before, double tol,
                                       std::vector<std::string>& notes) {
  std::vector<AskedMethod> methods;
  const auto kept = [&](bool external) {
    for (const AskedMethod& method : before->methods)
      if (method.external() == external) methods.push_back(method);
  };
  if (before != nullptr && !request.methods)
    kept(false);
  else
    methods = select_methods(request.methods.value_or("presets"), tol, notes);
  if (before != nullptr && request.externals.empty()) kept(true);
  for (const std::string& external : request.externals) {
    methods.push_back(parse_external(external));
    const auto same = std::ranges::count(methods, methods.back().label, &AskedMethod::label);
    if (same > 1) throw input_error("--external: '{}' is given twice", methods.back().label);
    for (const std::string& word : unfilled_words(methods.back().command))
      notes.push_back(fmt::format("--external {}: {} is left to the shell as it is; only {{tol}} is filled in",
                                  methods.back().label, word));
  }
  if (methods.empty()) throw InputError("--methods: nothing is left");
  return methods;
}

std::vector<AskedProblem> asked_problems(const CompareRequest& request, const Campaign* before) {
  std::vector<AskedProblem> problems =
      before != nullptr && !request.problems ? before->problems : select_problems(request.problems.value_or("all"));
  for (AskedProblem& problem : problems) {
    if (before != nullptr) {
      const auto same = std::ranges::find(before->problems, problem.name, &AskedProblem::name);
      if (same != before->problems.end()) {
        const std::string file = problem.file;
        problem = *same;
        problem.file = file;
      }
    }
    std::error_code ignored;
    if (problem.file.empty()) continue;
    if (!std::filesystem::is_regular_file(problem.file, ignored))
      throw input_error("there is no file '{}' any more", problem.file);
    problem.crc = file_crc(problem.file);
  }
  return problems;
}

}  // namespace

Campaign asked_campaign(const CompareRequest& request, const Campaign* before, std::vector<std::string>& notes) {
  constexpr double least_tol = 1e-15;
  constexpr double longest = 1e6;
  constexpr long long most_memory = 1LL << 32;
  constexpr int most_jobs = 1024;
  constexpr int most_restarts = 1000;
  Campaign campaign;
  stamp(campaign);
  const Campaign usual;
  const Campaign& otherwise = before != nullptr ? *before : usual;
  campaign.tol = checked("--tol", request.tol.value_or(otherwise.tol), least_tol, 1.0);
  campaign.time_limit = checked("--time-limit", request.time_limit.value_or(otherwise.time_limit), 0.01, longest);
  campaign.memory_mb = checked("--memory-limit", request.memory_mb.value_or(otherwise.memory_mb), 16LL, most_memory);
  campaign.restarts = checked("--restarts", request.restarts.value_or(otherwise.restarts), 0, most_restarts);
  campaign.seed = request.seed.value_or(otherwise.seed);
  campaign.jobs =
      checked("--jobs", request.jobs.value_or(before != nullptr ? before->jobs : std::max(1, campaign.machine.cores)),
              1, most_jobs);
  campaign.starts = request.starts ? parse_starts(*request.starts) : otherwise.starts;
  campaign.methods = asked_methods(request, before, campaign.tol, notes);
  campaign.problems = asked_problems(request, before);
  campaign.shard = request.shard.value_or(otherwise.shard);
  (void)parse_shard(campaign.shard);
  campaign.command_line = request.command_line;
  return campaign;
}

void check_resumable(const std::string& dir, const Campaign& before, const Campaign& now) {
  std::vector<std::string> found = differences(before, now);
  if (before.starts != now.starts) {
    const auto text = [](int starts) { return starts == 0 ? std::string("all") : fmt::format("{}", starts); };
    found.push_back(fmt::format("--starts: {} there, {} here", text(before.starts), text(now.starts)));
  }
  if (before.shard != now.shard)
    found.push_back(fmt::format("--shard: {} there, {} here", before.shard.empty() ? "all" : before.shard, now.shard));
  if (found.empty()) return;
  throw input_error(
      "--resume: '{0}' holds a campaign that asks for something else:\n  {1}\n'--out {0} --resume' alone goes on as "
      "it was begun, another --out begins anew",
      dir, fmt::join(found, "\n  "));
}

}  // namespace perp::app::compare
