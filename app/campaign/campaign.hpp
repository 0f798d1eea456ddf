// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What a campaign was asked to do, DIR/campaign.json: written before the first cell, never changed.
#include <string>
#include <utility>
#include <vector>

#include "app/campaign/campaign_file.hpp"

namespace perp::app::compare {

struct AskedMethod {
  std::string label{};  ///< as it was written: "semismooth:cfunction=min:tol=1e-9", or an external's NAME
  std::string name{};   ///< of `perp methods`; of an external program NAME
  std::vector<std::string> options{};  ///< key=value, in the order given
  std::string command{};               ///< of an external program, {tol} not filled in; empty for ours
  std::vector<std::pair<std::string, std::string>> in_force{};  ///< every option that applies, with its value
  bool external() const { return !command.empty(); }

  static void fields(auto& f, auto& method) {
    f("label", method.label);
    f("name", method.name);
    f("options", method.options);
    f.derived("external", method.external());
    f.pairs("in_force", method.in_force);
    f.optional("command", method.command);
  }
};

struct AskedProblem {
  std::string name{};  ///< of the collection, NAME:SIZE, or a file's without its folder
  std::string file{};  ///< with its whole path; empty for the collection
  std::string cls{};   ///< class in the collection; "nl", "dat" for files
  long long n = 0;
  long long nonzeros = 0;  ///< of the Jacobian's pattern
  bool affine = false;
  int starts = 1;             ///< that take part: 1 to starts
  int known_solutions = 0;    ///< listed in the collection
  std::string no_solution{};  ///< why there is none, if that is known
  std::string denied_by{};    ///< set by settle(): the method that has proven it here; not in campaign.json
  std::string crc{};          ///< CRC-32 of a file's content
  bool by_pattern = false;    ///< a file that nobody named: left out, with a note, where it is refused
  bool solvable() const { return no_solution.empty(); }
  /// Is it taken to have a solution, so that a program that says otherwise without a proof is wrong? (Of a file nobody
  /// knows.)
  bool known_solvable() const { return solvable() && file.empty(); }

  static constexpr int most_starts = 10'000;  ///< what nobody runs, and a damaged file may ask for
  static void fields(auto& f, auto& problem) {
    f("name", problem.name);
    f("class", problem.cls);
    f("n", problem.n);
    f("nonzeros", problem.nonzeros);
    f("affine", problem.affine);
    f("starts", problem.starts, 1, most_starts);
    f("known_solutions", problem.known_solutions);
    f.derived("solvable", problem.solvable());
    f("no_solution", problem.no_solution);
    f.optional("file", problem.file);
    f.optional("crc", problem.crc);
  }
};

struct Machine {
  std::string cpu{};
  int cores = 0;  ///< that this process may use
  long long memory_mb = 0;
  std::string system{};  ///< kernel and its release

  static Machine here();

  static void fields(auto& f, auto& machine) {
    f("cpu", machine.cpu);
    f("cores", machine.cores);
    f("memory_mb", machine.memory_mb);
    f("system", machine.system);
  }
};

/// A part of a campaign's cells: those with numbers number, number + of, number + 2 of, ... from 1.
struct Shard {
  int number = 1;
  int of = 1;
  bool has(std::size_t cell) const {
    return cell % static_cast<std::size_t>(of) + 1 == static_cast<std::size_t>(number);
  }
};
/// "3/7"; "" is the whole. Throws InputError.
Shard parse_shard(const std::string& text);

struct Campaign {
  std::vector<AskedMethod> methods{};
  std::vector<AskedProblem> problems{};
  int starts = 0;              ///< at most so many of each problem; 0: all
  double tol = 1e-6;           ///< of the judge, and of the methods where their options name no other
  double time_limit = 60;      ///< s, wall clock, of a run
  long long memory_mb = 4096;  ///< resident, of a run
  int restarts = 0;            ///< at most so many after a failure
  unsigned seed = 1;           ///< of their starts
  int jobs = 1;
  std::string shard{};                   ///< of all cells, those that are run here: "3/7"; empty: all
  std::string version{};                 ///< of perp
  std::string build{};                   ///< CRC-32 of the program's file
  std::vector<std::string> libraries{};  ///< linked, with their versions
  Machine machine{};
  std::vector<std::string> command_line{};
  std::string date{};  ///< UTC, ISO 8601

  std::size_t pairs() const;  ///< of a problem and a start
  std::size_t cells() const { return methods.size() * pairs(); }

  static constexpr const char* format = "campaign";
  static constexpr const char* command = "perp compare";
  static void fields(auto& f, auto& campaign) {
    f("version", campaign.version);
    f("build", campaign.build);
    f("libraries", campaign.libraries);
    f("date", campaign.date);
    f("command_line", campaign.command_line);
    f("machine", campaign.machine);
    f("tol", campaign.tol);
    f("time_limit", campaign.time_limit);
    f("memory_limit_mb", campaign.memory_mb);
    f("restarts", campaign.restarts, 0);
    f("seed", campaign.seed);
    f.or_zero("starts", campaign.starts, "all");
    f("jobs", campaign.jobs);
    f.optional("shard", campaign.shard);
    f("methods", campaign.methods);
    f("problems", campaign.problems);
  }
};

/// Sets version, build, libraries, machine and date.
void stamp(Campaign& campaign);

/// Throws InputError saying what is missing, of another type or more than anybody runs.
Campaign parse_campaign(const std::string& json);
/// Of DIR/campaign.json. Throws InputError naming the file.
Campaign read_campaign(const std::string& dir);

/// What cells of `now` would not fit beside those of `before`: one line a difference, "tol: 1e-06 there, 1e-08 here".
/// Jobs, build, machine, command line and date may differ.
std::vector<std::string> differences(const Campaign& before, const Campaign& now);

}  // namespace perp::app::compare
