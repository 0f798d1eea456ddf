#pragma once
/// What a campaign's processes do: `perp compare-worker TASK`, a hidden command with a JSON object as its argument.
/// Each writes its answer to FOLDER/result.json, as a whole or not at all, and x as raw doubles to FOLDER/x.bin.
///
///     describe   size, starts, ... of a problem
///     solve      one run of a method
///     external   one run of somebody else's program by AMPL's convention, on a private copy of the model
///     judge      the natural residual at FOLDER/x.bin, of the problem built anew
#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "app/campaign/campaign.hpp"
#include "app/campaign/start.hpp"

namespace perp::app::compare {

struct Task {
  enum class Role { Describe, Solve, External, Judge };
  Role role = Role::Describe;
  std::string problem{};               ///< name or file
  int start = 1;                       ///< from 1
  std::string method{};                ///< label
  std::string name{};                  ///< of the method
  std::vector<std::string> options{};  ///< of it
  std::string command{};               ///< External
  double tol = 1e-6;
  double time_limit = 60;  ///< s from the process' start; a method is told to end a little before
  Perturbation rule{};
  std::string folder{};  ///< its own
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
};

std::string task_json(const Task& task);
Task parse_task(const std::string& json);
/// Of FOLDER/result.json.
Answer read_answer(const std::string& folder);

/// The command itself; its exit code. `interrupt` ends a run, with the best point so far.
int worker(const std::string& task, const std::atomic<bool>* interrupt);

/// Every k-th of them, the first and the last one always, at most longest_curve.
std::vector<double> thinned(const std::vector<double>& curve);

}  // namespace perp::app::compare
