// SPDX-License-Identifier: Apache-2.0
#include "capi/path/client_problem.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lcp/memory.hpp"

namespace perp::path {

namespace {

constexpr double path_infinity = 1e20;
constexpr double bytes_a_variable = 4 * sizeof(double) + sizeof(int);
constexpr double infinity = std::numeric_limits<double>::infinity();

double bound(double given) { return given >= path_infinity ? infinity : given <= -path_infinity ? -infinity : given; }

std::vector<double> bounds(const std::vector<double>& given) {
  std::vector<double> all(given.size());
  std::transform(given.begin(), given.end(), all.begin(), bound);
  return all;
}

using Namer = void (*)(void* id, int i, char* name, int size);

/// Names of the client's; none where it has no function for them.
std::vector<std::string> names(Namer namer, void* id, int n) {
  std::vector<std::string> all;
  for (int i = 1; namer != nullptr && i <= n; ++i) {
    std::array<char, 256> name{};
    namer(id, i, name.data(), static_cast<int>(name.size()) - 1);
    all.emplace_back(name.data());
  }
  return all;
}

std::vector<const char*> pointers(const std::vector<std::string>& names) {
  std::vector<const char*> all(names.size());
  std::transform(names.begin(), names.end(), all.begin(), [](const std::string& name) { return name.c_str(); });
  return all;
}

}  // namespace

void ClientProblem::ask() {
  const MCP_Interface& client = m_.client;
  if (client.problem_size == nullptr) throw End{MCP_Error, "problem_size is NULL"};
  if (client.bounds == nullptr) throw End{MCP_Error, "bounds is NULL"};
  if (client.function_evaluation == nullptr) throw End{MCP_Error, "function_evaluation is NULL"};
  if (client.jacobian_evaluation == nullptr) throw End{MCP_Error, "jacobian_evaluation is NULL"};
  int nonzeros = 0;
  client.problem_size(client.interface_data, &n_, &nonzeros);
  if (n_ < 0 || nonzeros < 0)
    throw End{MCP_Error, "problem_size answers " + std::to_string(n_) + " variables and " + std::to_string(nonzeros) +
                             " nonzeros"};
  const auto size = static_cast<std::size_t>(n_);
  lcp::require_memory(bytes_a_variable * n_ + ClientJacobian::bytes(n_, nonzeros),
                      "the " + std::to_string(n_) + " variables and " + std::to_string(nonzeros) +
                          " nonzeros that problem_size promises");
  m_.x.assign(size, 0);
  m_.F.assign(size, 0);
  m_.lower.assign(size, -path_infinity);
  m_.upper.assign(size, path_infinity);
  m_.basis.assign(size, 0);
  m_.jacobian = ClientJacobian(n_, nonzeros);
  if (n_ == 0) return;
  client.bounds(client.interface_data, n_, m_.x.data(), m_.lower.data(), m_.upper.data());
  for (std::size_t i = 0; i < size; ++i) {
    const double low = bound(m_.lower[i]);
    const double high = bound(m_.upper[i]);
    if (!(low <= high) || low == infinity || high == -infinity)
      throw End{MCP_BoundError, "bounds: those of variable " + std::to_string(i + 1) + " are " +
                                    std::to_string(m_.lower[i]) + " and " + std::to_string(m_.upper[i])};
    m_.x[i] = std::isfinite(m_.x[i]) ? std::clamp(m_.x[i], low, high) : std::clamp(0.0, low, high);
  }
  ask_structure();
}

/// F goes first, as clients may know J from it. Where either is not defined at the start, solve() says why, or starts
/// nearby; it needs J's pattern for that.
void ClientProblem::ask_structure() {
  std::vector<double> F(m_.x.size());
  evaluate_F(m_.x.data(), F.data());
  ++J_evaluations_;
  x_ = m_.x;
  const bool unknown = m_.jacobian.evaluate(m_.client, x_.data()) != 0;
  const std::string why = m_.jacobian.invalid();
  if (unknown && (!why.empty() || m_.jacobian.nonzeros() == 0))
    throw End{MCP_DomainError, "the Jacobian is not defined at the start, and its pattern is not known"};
  if (!why.empty()) throw End{MCP_Error, why};
  m_.jacobian.grow();
  const Presolve_Interface& presolve = m_.presolve;
  if (presolve.start_pre != nullptr) presolve.start_pre(presolve.presolve_data);
  if (m_.affine)
    linear_.emplace(m_.jacobian.size(), 1);
  else if (m_.has_presolve && presolve.jac_typ != nullptr)
    linear_ = m_.jacobian.linear(presolve);
  if (presolve.start_post != nullptr) presolve.start_post(presolve.presolve_data);
}

Problem ClientProblem::problem(bool named) {
  perp_problem* made = nullptr;
  perp_error error{};
  const std::vector<double> lower = bounds(m_.lower);
  const std::vector<double> upper = bounds(m_.upper);
  const perp_matrix pattern{.form = PERP_COLUMNS_INT32,
                            .lent = 0,
                            .rows = n_,
                            .columns = n_,
                            .start = m_.jacobian.start(),
                            .index = m_.jacobian.row(),
                            .value = nullptr};
  if (perp_problem_create(PERP_INTERFACE, n_, lower.data(), upper.data(), &pattern, call_F, call_J, this, &made,
                          &error) != PERP_OK)
    throw End{MCP_Error, error.message};
  Problem problem(made);
  perp_problem_count_from(made, 1, nullptr);  // as PATH does
  static constexpr std::int8_t none = 1;      // flags of no entry are a promise, too: F is constant
  if (linear_) perp_problem_set_linear(made, linear_->empty() ? &none : linear_->data(), nullptr);
  if (named) name(made);
  return problem;
}

void ClientProblem::name(perp_problem* problem) const {
  const std::vector<std::string> variables = names(m_.client.variable_name, m_.client.interface_data, n_);
  const std::vector<std::string> equations = names(m_.client.constraint_name, m_.client.interface_data, n_);
  perp_problem_set_names(problem, variables.empty() ? nullptr : pointers(variables).data(),
                         equations.empty() ? nullptr : pointers(equations).data(), nullptr);
}

bool ClientProblem::grown() {
  if (!grows_) return false;
  grows_ = false;
  m_.jacobian.grow();
  linear_.reset();  // those flags were for another pattern
  return true;
}

std::int32_t ClientProblem::call_F(std::int64_t /*n*/, const double* x, double* F, void* user) {
  return static_cast<ClientProblem*>(user)->evaluate_F(x, F);
}
std::int32_t ClientProblem::call_J(std::int64_t /*n*/, std::int64_t /*nonzeros*/, const double* x, double* value,
                                   void* user) {
  return static_cast<ClientProblem*>(user)->evaluate_J(x, value);
}

std::int32_t ClientProblem::evaluate_F(const double* x, double* F) {
  ++F_evaluations_;
  x_.assign(x, x + n_);
  std::fill_n(F, n_, std::numeric_limits<double>::quiet_NaN());  // what is not set is not defined
  return m_.client.function_evaluation(m_.client.interface_data, n_, x_.data(), F) == 0 ? PERP_DEFINED : PERP_UNDEFINED;
}

std::int32_t ClientProblem::evaluate_J(const double* x, double* value) {
  ++J_evaluations_;
  x_.assign(x, x + n_);
  if (m_.jacobian.evaluate(m_.client, x_.data()) != 0) return PERP_UNDEFINED;
  mistake_ = m_.jacobian.invalid();
  if (!mistake_.empty()) return PERP_STOP;
  if (!m_.jacobian.fits()) {
    grows_ = true;
    return PERP_STOP;
  }
  m_.jacobian.values(value);
  return PERP_DEFINED;
}

std::vector<std::int8_t> ClientProblem::basis() const {
  if (m_.client.basis == nullptr) return {};
  std::vector<int> given(m_.x.size(), 0);
  m_.client.basis(m_.client.interface_data, n_, given.data());
  if (std::all_of(given.begin(), given.end(), [](int one) { return one < 1 || one > 5; })) return {};
  std::vector<std::int8_t> cells;
  for (std::size_t i = 0; i < given.size(); ++i) {
    static constexpr std::array of_type{
        -1, PERP_INSIDE + 0, PERP_INSIDE + 0, PERP_BELOW + 0, PERP_ABOVE + 0, PERP_FIXED + 0};
    const bool known = given[i] >= 1 && given[i] <= 5;
    const int at_value = m_.x[i] <= m_.lower[i] ? PERP_BELOW : m_.x[i] >= m_.upper[i] ? PERP_ABOVE : PERP_INSIDE;
    cells.push_back(static_cast<std::int8_t>(known ? of_type[static_cast<std::size_t>(given[i])] : at_value));
  }
  return cells;
}

}  // namespace perp::path
