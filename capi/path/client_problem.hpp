// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A client's problem as one of perp.h: what its callbacks say, asked and checked.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "capi/path/mcp.hpp"
#include "capi/perp.h"

namespace perp::path {

struct Free {
  void operator()(perp_problem* problem) const { perp_problem_free(problem); }
  void operator()(perp_result* result) const { perp_result_free(result); }
};
using Problem = std::unique_ptr<perp_problem, Free>;
using Result = std::unique_ptr<perp_result, Free>;

/// Ends a solve before there is a result.
struct End {
  MCP_Termination termination;
  std::string why;
};

/// One Path_Solve of an MCP.
class ClientProblem {
 public:
  explicit ClientProblem(MCP& m) : m_(m) {}

  /// Asks for sizes, bounds, start and the structure at the start. Throws End.
  void ask();
  /// The problem with the pattern met so far; `named`: with the client's names. Throws End.
  Problem problem(bool named);
  /// Whether the last solve ended because the Jacobian has a place that its pattern had not. It has now.
  bool grown();
  /// The basis to begin with; empty: none.
  std::vector<std::int8_t> basis() const;

  int n() const { return n_; }
  int F_evaluations() const { return F_evaluations_; }
  int J_evaluations() const { return J_evaluations_; }
  /// What the client did wrong in a callback; empty: nothing.
  const std::string& mistake() const { return mistake_; }

 private:
  static std::int32_t call_F(std::int64_t n, const double* x, double* F, void* user);
  static std::int32_t call_J(std::int64_t n, std::int64_t nonzeros, const double* x, double* value, void* user);
  std::int32_t evaluate_F(const double* x, double* F);
  std::int32_t evaluate_J(const double* x, double* value);
  void ask_structure();
  void name(perp_problem* problem) const;

  MCP& m_;
  int n_ = 0;
  std::vector<double> x_{};                           // for callbacks, which may write into it
  std::optional<std::vector<std::int8_t>> linear_{};  // flags of the pattern
  int F_evaluations_ = 0;
  int J_evaluations_ = 0;
  bool grows_ = false;
  std::string mistake_{};
};

}  // namespace perp::path
