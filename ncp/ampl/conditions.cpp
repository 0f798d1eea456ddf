// SPDX-License-Identifier: Apache-2.0
#include "ncp/ampl/conditions.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "ncp/ampl/model.hpp"
#include "ncp/interval/undefined.hpp"

namespace perp::ncp::ampl {
namespace {

/// Marks each variable that occurs in an expression.
std::vector<char> in_expressions(const NlModel& model) {
  std::vector<char> in_expression(at(model.header.n_var + model.header.defined()), 0);
  for (const auto* lists : {&model.mentions, &model.definitions})
    for (const std::vector<Mention>& mentions : *lists)
      for (const Mention& m : mentions) in_expression[at(m.index)] = 1;
  return in_expression;
}

double coefficient(const NlModel& model, std::size_t row, int v) {
  const std::vector<int>& variables = model.row_variables[row];
  return model.coefficients[row][at(std::ranges::find(variables, v) - variables.begin())];
}

/// Number of rows with the variable.
int rows_of(const NlModel& model, int v) { return model.column_start[at(v) + 1] - model.column_start[at(v)]; }

/// Returns for each variable the last equation that it is in, or -1.
std::vector<int> equations_of_variables(const NlModel& model) {
  std::vector<int> equation(model.variables.size(), -1);
  for (std::size_t i = 0; i < model.rows.size(); ++i)
    if (is_equation(model.rows[i]))
      for (const int j : model.row_variables[i]) equation[at(j)] = static_cast<int>(i);
  return equation;
}

/// Returns for each row that complements a variable the equation of its auxiliary variable, or -1.
std::vector<int> auxiliary_equations(const NlModel& model, const std::vector<char>& complemented,
                                     const std::vector<char>& in_expression) {
  const std::vector<int> defining = equations_of_variables(model);
  std::vector<int> equations(model.rows.size(), -1);
  std::vector<char> taken(model.rows.size(), 0);
  for (std::size_t i = 0; i < model.rows.size(); ++i) {
    if (model.rows[i].complement < 0 || model.row_variables[i].size() != 1 || !model.mentions[i].empty()) continue;
    const int v = model.row_variables[i].front();
    if (!is_free(model.variables[at(v)]) || complemented[at(v)] || in_expression[at(v)] || rows_of(model, v) != 2)
      continue;
    if (defining[at(v)] < 0 || taken[at(defining[at(v)])]) continue;
    const double c = coefficient(model, i, v), a = coefficient(model, at(defining[at(v)]), v);
    if (c == 0 || std::abs(c) != std::abs(a)) continue;
    equations[i] = defining[at(v)];
    taken[at(defining[at(v)])] = 1;
  }
  return equations;
}

/// Nothing: row i, whose auxiliary variable row e defines, is no such condition, or the bound would be rounded.
std::optional<Turned> turned(const NlModel& model, const PointValues& constants, const std::vector<char>& taken,
                             const std::vector<int>& equation_of, const std::vector<char>& in_expression, std::size_t i,
                             int e) {
  const int u = model.row_variables[i].front(), v = model.rows[i].complement;
  const NlRange& range = model.variables[at(v)];
  if (range.lower != 0 || range.upper != infinity || in_expression[at(v)] || rows_of(model, v) != 1) return {};
  const std::vector<int>& variables = model.row_variables[at(e)];
  if (variables.size() != 2 || !model.mentions[at(e)].empty()) return {};
  const int x = variables[variables[0] == u ? 1 : 0], f = equation_of[at(v)];
  if (!is_free(model.variables[at(x)]) || taken[at(x)] || f < 0 || f == e) return {};
  const double of_v = coefficient(model, at(f), v);
  if (std::abs(of_v) != 1) return {};
  if (constants[model.expressions.rows[i]] != 0 || constants[model.expressions.rows[at(e)]] != 0) return {};
  // s (b - a x) >= 0, s = 1 or -1.
  const double s = coefficient(model, i, u) == coefficient(model, at(e), u) ? 1 : -1;
  const double a = coefficient(model, at(e), x), b = model.rows[at(e)].lower, bound = b / a;
  if (!std::isfinite(bound) || std::fma(bound, a, -b) != 0) return {};
  const bool above = s * a < 0;
  return Turned{.variable = x, .above = above, .bound = bound, .equation = f, .sign = above ? -of_v : of_v};
}

}  // namespace

bool is_equation(const NlRange& row) { return row.complement < 0 && !row.polyhedron && row.lower == row.upper; }

Conditions conditions(const NlModel& model) {
  std::vector<char> complemented(model.variables.size(), 0);
  for (const NlRange& row : model.rows)
    if (row.complement >= 0) complemented[at(row.complement)] = 1;
  const std::vector<char> in_expression = in_expressions(model);
  const std::vector<int> defining = auxiliary_equations(model, complemented, in_expression);
  const std::vector<int> equation_of = equations_of_variables(model);
  std::vector<char> spoken_for = complemented;  // those, and variables that a condition consists of
  for (std::size_t i = 0; i < model.rows.size(); ++i)
    if (model.rows[i].complement >= 0 && model.row_variables[i].size() == 1)
      spoken_for[at(model.row_variables[i].front())] = 1;
  const PointValues constants(model.expressions.graph, std::vector<double>(model.variables.size(), 0));
  Conditions found{.complement = std::vector<int>(model.rows.size(), -1),
                   .own = std::vector<Equation>(model.variables.size()),
                   .gone_row = std::vector<char>(model.rows.size(), 0),
                   .gone = std::vector<char>(model.variables.size(), 0)};
  for (std::size_t i = 0; i < model.rows.size(); ++i) {
    found.complement[i] = model.rows[i].complement;
    if (defining[i] < 0) continue;
    const int v = model.row_variables[i].front(), e = defining[i];
    const double a = coefficient(model, at(e), v), b = model.rows[at(e)].lower;
    const int condition = static_cast<int>(i);
    found.auxiliaries.push_back({v, e, a, b});
    found.gone_row[i] = found.gone_row[at(e)] = found.gone[at(v)] = 1;
    found.used.insert(found.used.end(), {condition, e});
    if (const auto turn = turned(model, constants, spoken_for, equation_of, in_expression, i, e);
        turn && !found.gone_row[at(turn->equation)]) {
      const int f = turn->equation, y = model.rows[i].complement, x = turn->variable;
      found.own[at(x)] = {.index = f, .sign = turn->sign, .bound = model.rows[at(f)].lower, .condition = condition};
      found.auxiliaries.push_back({y, f, coefficient(model, at(f), y), model.rows[at(f)].lower});
      found.gone_row[at(f)] = found.gone[at(y)] = spoken_for[at(x)] = 1;
      found.used.push_back(f);
      found.complement[i] = x;
      found.turns.push_back(*turn);
      continue;
    }
    found.own[at(model.rows[i].complement)] = {
        .index = e, .sign = coefficient(model, i, v) == a ? -1.0 : 1.0, .bound = b, .condition = condition};
  }
  return found;
}

}  // namespace perp::ncp::ampl
