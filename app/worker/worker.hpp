// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What a campaign's processes do: `perp compare-worker TASK`, a hidden command with a JSON object as its argument.
/// Each writes its answer to FOLDER/result.json, as a whole or not at all, and x as raw doubles to FOLDER/x.bin.
///
///     describe   size, starts, ... of a problem
///     solve      one run of a method
///     external   one run of somebody else's program by AMPL's convention, on a private copy of the model
///     judge      the natural residual at FOLDER/x.bin, of the problem built anew
#include <array>
#include <atomic>
#include <string>
#include <string_view>
#include <vector>

#include "app/campaign/campaign.hpp"
#include "app/campaign/start.hpp"

namespace perp::app::compare {

struct Task {
  enum class Role { Describe, Solve, External, Judge };
  Role role = Role::Describe;
  std::string problem{};  ///< name or file
  AskedMethod method{};   ///< {tol} filled in where it is external
  double tol = 1e-6;
  double time_limit = 60;  ///< s from the process' start; a method is told to end a little before
  Perturbation rule{};     ///< which start, and how it is perturbed
  std::string folder{};    ///< its own

  static constexpr std::array<std::string_view, 4> roles{"describe", "solve", "external", "judge"};
  static void fields(auto& f, auto& task) {
    f.word("role", task.role, roles);
    f("problem", task.problem);
    f("method", task.method);
    f("tol", task.tol);
    f("time_limit", task.time_limit);
    f("rule", task.rule);
    f("folder", task.folder);
  }
};

/// What came out of it.
struct Answer {
  bool complete = false;  ///< there is a result.json that can be read
  std::string refused{};  ///< the input makes no sense: why
  bool out_of_memory = false;
  std::string status{};
  bool claimed = false;
  bool to_rounding = false;  ///< Solve: says so; Judge: finds so
  bool infeasible = false;   ///< claims that there is no solution
  bool proven = false;       ///< and has a proof that we trust: ours have
  bool not_applicable = false;
  bool time_limit = false;  ///< ended by it
  std::string crashed{};    ///< External: the signal or exit code
  std::string garbage{};    ///< External: what is wrong with the .sol file
  std::string message{};
  int iterations = -1, F_evals = -1, J_evals = -1, factorizations = -1, krylov_iterations = -1;
  double seconds = 0;
  double peak_mb = 0;  ///< External: of the largest process
  std::vector<double> curve{};
  bool has_x = false;
  double natural = 0;  ///< Judge
  AskedProblem described{};

  static void fields(auto& f, auto& answer) {
    f("refused", answer.refused);
    f("out_of_memory", answer.out_of_memory);
    f("status", answer.status);
    f("claimed", answer.claimed);
    f("to_rounding", answer.to_rounding);
    f("infeasible", answer.infeasible);
    f("proven", answer.proven);
    f("not_applicable", answer.not_applicable);
    f("time_limit", answer.time_limit);
    f("crashed", answer.crashed);
    f("garbage", answer.garbage);
    f("message", answer.message);
    f("iterations", answer.iterations);
    f("F_evals", answer.F_evals);
    f("J_evals", answer.J_evals);
    f("factorizations", answer.factorizations);
    f("krylov_iterations", answer.krylov_iterations);
    f("seconds", answer.seconds);
    f("peak_mb", answer.peak_mb);
    f("curve", answer.curve);
    f("has_x", answer.has_x);
    f("natural", answer.natural);
    f("described", answer.described);
  }
};

std::string task_json(const Task& task);
Task parse_task(const std::string& json);
/// FOLDER/result.json.
void write_answer(const std::string& folder, const Answer& answer);
Answer read_answer(const std::string& folder);
/// FOLDER/x.bin.
void write_point(const std::string& folder, ncp::In x);
ncp::Vec read_point(const std::string& folder);  ///< empty if there is none

/// The command itself; its exit code. `interrupt` ends a run, with the best point so far.
int worker(const std::string& task, const std::atomic<bool>* interrupt);

/// Every k-th of them, the first and the last one always, at most longest_curve.
std::vector<double> thinned(const std::vector<double>& curve);

}  // namespace perp::app::compare
