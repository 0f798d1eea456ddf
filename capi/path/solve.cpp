// SPDX-License-Identifier: Apache-2.0
/// Path_Solve().
#include <algorithm>
#include <cmath>
#include <exception>
#include <string>

#include "capi/forced_unwind.hpp"
#include "capi/path/client_problem.hpp"
#include "capi/path/thread_state.hpp"

namespace perp::path {

namespace {

double statistic(const perp_result* result, const char* name) {
  return perp_result_real(perp_result_part(result, "stats", 0), name);
}

int count(const perp_result* result, const char* name) { return static_cast<int>(statistic(result, name)); }

MCP_Termination termination_of(const perp_result* result, const OptionSet& options) {
  switch (perp_result_status(result)) {
    case PERP_SOLVED:
      return MCP_Solved;
    case PERP_INFEASIBLE:
      return MCP_Infeasible;
    case PERP_EVALUATION_FAILED:
      return MCP_DomainError;
    case PERP_ITERATION_LIMIT: {
      const std::string most = options.get("cumulative_iteration_limit");
      const bool pivots = most != "-" && statistic(result, "pivots") >= std::stod(most);
      return pivots ? MCP_MinorIterationLimit : MCP_MajorIterationLimit;
    }
    case PERP_TIME_LIMIT:
      return MCP_TimeLimit;
    case PERP_INTERRUPTED:
      return MCP_UserInterrupt;
    case PERP_NOT_APPLICABLE:
    case PERP_NO_MEMORY:
      return MCP_Error;
    default:  // stuck somehow: also solved to rounding, which clients must not take for a solution
      return MCP_NoProgress;
  }
}

/// What a basis is to a client: basic, at its lower bound, at its upper one, fixed.
int basis_type(int cell) { return cell == PERP_BELOW ? 3 : cell == PERP_ABOVE ? 4 : cell == PERP_FIXED ? 5 : 1; }

int cell_at(const MCP& m, std::size_t i) {
  if (m.lower[i] == m.upper[i]) return PERP_FIXED;
  return m.x[i] <= m.lower[i] ? PERP_BELOW : m.x[i] >= m.upper[i] ? PERP_ABOVE : PERP_INSIDE;
}

void keep(MCP& m, const perp_result* result) {
  std::copy_n(perp_result_reals(result, "x"), m.x.size(), m.x.data());
  std::copy_n(perp_result_reals(result, "F"), m.F.size(), m.F.data());
  const std::int8_t* basis = perp_result_cells(result, "basis");
  for (std::size_t i = 0; i < m.x.size(); ++i) m.basis[i] = basis_type(basis != nullptr ? basis[i] : cell_at(m, i));
}

/// The run's options and callbacks, taken back at its end.
class Listening {
 public:
  explicit Listening(const OptionSet& options) : solver_(options.solver()) {
    if (this_thread().heard())
      perp_solver_set_log(
          solver_, [](const char* line, void*) { tell(Output_Log, std::string(line) + "\n"); }, nullptr, nullptr);
    perp_solver_set_progress(solver_, progress, this, nullptr);
  }
  ~Listening() {
    perp_solver_set_log(solver_, nullptr, nullptr, nullptr);
    perp_solver_set_progress(solver_, nullptr, nullptr, nullptr);
    perp_solver_set_basis(solver_, 0, nullptr, nullptr);
  }
  Listening(const Listening&) = delete;
  Listening& operator=(const Listening&) = delete;
  double step() const { return step_; }

 private:
  static std::int32_t progress(const perp_iteration* iteration, void* user) {
    static_cast<Listening*>(user)->step_ = iteration->step;
    return 0;
  }
  perp_solver* solver_;
  double step_ = 0;
};

/// Solves, and again from the best point where the Jacobian's pattern has grown.
Result solved(ClientProblem& client, const OptionSet& options, const MCP& m, bool named) {
  std::vector<double> from = m.x;
  const std::vector<std::int8_t> basis = client.basis();
  if (!basis.empty() && perp_solver_set_basis(options.solver(), client.n(), basis.data(), nullptr) != PERP_OK)
    throw End{MCP_Error, "basis: not taken"};
  for (;;) {
    const Problem problem = client.problem(named);
    perp_result* made = nullptr;
    perp_error error{};
    const std::int32_t code = perp_solve(options.solver(), problem.get(), from.data(), &made, &error);
    Result result(made);
    if (client.grown()) {
      if (result != nullptr) std::copy_n(perp_result_reals(result.get(), "x"), from.size(), from.data());
      continue;
    }
    if (code != PERP_OK) throw End{MCP_Error, error.message};
    if (!client.mistake().empty()) throw End{MCP_Error, client.mistake()};
    return result;
  }
}

struct Told {
  double distance = 0;
  double step = 0;
};

/// Fields before byte 84 only.
void inform(Information* information, const ClientProblem& client, const perp_result* result, const Told& told) {
  if (information == nullptr) return;
  information->residual = perp_result_real(result, "residual");
  information->distance = told.distance;
  information->steplength = told.step;
  information->total_time = statistic(result, "time_s");
  information->basis_time = statistic(result, "linear_time_s");
  information->major_iterations = count(result, "iterations");
  information->minor_iterations = count(result, "pivots");
  information->crash_iterations = count(result, "crash_iterations");
  information->function_evaluations = client.F_evaluations();
  information->jacobian_evaluations = client.J_evaluations();
  information->gradient_steps = count(result, "gradient_steps");
  information->restarts = count(result, "restarts");
}

void inform_of_nothing(Information* information, int told) {
  if (information == nullptr) return;
  information->residual = 0;
  information->distance = information->steplength = 0;
  information->total_time = information->basis_time = 0;
  information->major_iterations = information->minor_iterations = information->crash_iterations = 0;
  information->function_evaluations = information->jacobian_evaluations = 0;
  information->gradient_steps = information->restarts = 0;
  information->generated_output = told;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

MCP_Termination run(MCP& m, Information* information, const OptionSet& options) {
  const bool log = options.on("output") && this_thread().heard();
  const int wanted = information == nullptr ? 0 : information->generate_output;
  inform_of_nothing(information, log ? Output_Log : 0);
  if (log) tell(Output_Log, std::string(Path_Version()) + "\n");
  ClientProblem client(m);
  client.ask();
  if (client.n() == 0) return MCP_Solved;
  const std::vector<double> start = m.x;
  const Listening listening(options);
  const Result result = solved(client, options, m, log);
  keep(m, result.get());
  inform(information, client, result.get(), {.distance = distance(m.x, start), .step = listening.step()});
  const MCP_Termination termination = termination_of(result.get(), options);
  if (wanted != 0 && options.on("output")) {
    tell(wanted, std::string("\n ** EXIT - ") + perp_status_name(perp_result_status(result.get())) + ": " +
                     perp_result_text(result.get(), "message", 0) + ".\n");
    if (information != nullptr) information->generated_output = wanted;
  }
  return termination;
}

/// Calls start and, whatever happens, finish.
MCP_Termination framed(MCP& m, Information* information, const OptionSet& options) {
  const MCP_Interface& client = m.client;
  if (client.start != nullptr) client.start(client.interface_data);
  MCP_Termination termination = MCP_Error;
  try {
    termination = run(m, information, options);
  } catch (const End& end) {
    warn(" ** " + end.why);
    termination = end.termination;
  } catch (const perp::ForcedUnwind&) {  // the thread is being cancelled
    throw;
  } catch (const std::exception& error) {
    warn(std::string(" ** ") + error.what());
  } catch (...) {
    warn(" ** a callback threw an exception");
  }
  const Presolve_Interface& presolve = m.presolve;
  if (presolve.finish_pre != nullptr) presolve.finish_pre(presolve.presolve_data);
  if (presolve.finish_post != nullptr) presolve.finish_post(presolve.presolve_data);
  if (client.finish != nullptr) client.finish(client.interface_data, m.x.data());
  return termination;
}

}  // namespace

}  // namespace perp::path

MCP_Termination Path_Solve(MCP* m, Information* information) {
  using namespace perp::path;  // NOLINT(google-build-using-namespace)
  try {
    if (m == nullptr) {
      warn(" ** Path_Solve: its MCP is NULL");
      return MCP_Error;
    }
    std::shared_ptr<OptionSet> options = this_thread().options.lock();
    if (options == nullptr) options = std::make_shared<OptionSet>();
    return framed(*m, information, *options);
  } catch (const perp::ForcedUnwind&) {
    throw;
  } catch (...) {  // no memory for a message, or the client's own output threw
    return MCP_Error;
  }
}
