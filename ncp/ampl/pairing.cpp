// SPDX-License-Identifier: Apache-2.0
#include "ncp/ampl/pairing.hpp"

#include <algorithm>
#include <climits>
#include <cmath>
#include <optional>

#include "ncp/ampl/model.hpp"
#include "ncp/interval/undefined.hpp"
#include "ncp/problem/model_structure.hpp"
#include "ncp/problem/words.hpp"

namespace perp::ncp::ampl {
namespace {

bool is_equation(const NlRange& row) { return row.complement < 0 && row.lower == row.upper; }

std::string interval(const NlRange& r) { return "[" + number(r.lower) + ", " + number(r.upper) + "]"; }

// AMPL's order of variables: nonlinear in both, in constraints only, in objectives only, then linear; within each of
// the nonlinear groups the integer ones are last, and the linear ones end with the binary and the integer ones.
int first_integer(const NlHeader& h) {
  const int both = std::max(h.nonlinear_var_both, 0);
  if (h.integer_both > 0) return both - h.integer_both;
  if (h.integer_con > 0) return h.nonlinear_var_con - h.integer_con;
  if (h.integer_obj > 0) return h.nonlinear_var_obj - h.integer_obj;
  if (h.binary_var > 0 || h.integer_var > 0) return h.n_var - h.binary_var - h.integer_var;
  return -1;
}

void refuse_integers(const NlModel& model, const Names& names) {
  const NlHeader& h = model.header;
  const long long count = 0LL + h.binary_var + h.integer_var + h.integer_both + h.integer_con + h.integer_obj;
  if (count == 0) return;
  const int first = std::clamp(first_integer(h), 0, h.n_var - 1);
  throw ModelError(bad_file, model.file + ": the model has " + std::to_string(count) +
                                 " integer or binary variables, the first is " + names.variable(first) +
                                 "; a complementarity problem has none");
}

void refuse_empty_ranges(const NlModel& model, const Names& names) {
  const auto check = [&](const NlRange& r, const std::string& what) {
    if (r.lower > r.upper)
      throw ModelError(inconsistent_bounds, model.at(r.place) + ": inconsistent bounds on " + what + ": lower " +
                                                number(r.lower) + " > upper " + number(r.upper));
  };
  for (std::size_t j = 0; j < model.variables.size(); ++j)
    check(model.variables[j], "variable " + names.variable(static_cast<int>(j)));
  for (std::size_t i = 0; i < model.rows.size(); ++i)
    check(model.rows[i], "constraint " + names.row(static_cast<int>(i)));
}

// Fewer conditions than variables leave the rest to an objective: a mathematical program with equilibrium constraints.
void refuse_mpec(const NlModel& model) {
  const auto conditions = std::ranges::count_if(model.rows, [](const NlRange& row) { return row.complement >= 0; });
  const auto equations = std::ranges::count_if(model.rows, is_equation);
  const auto left = std::ssize(model.variables) - conditions - equations;
  if (model.header.n_obj == 0 || conditions == 0 || left <= 0) return;
  throw ModelError(nonsquare, model.file + ": the model is an MPEC, an optimisation problem with equilibrium " +
                                  "constraints: its " + quantity(conditions, "complementarity condition") + " and " +
                                  quantity(equations, "equation") + " leave " + quantity(left, "variable") +
                                  " to the objective; Perp solves models whose conditions determine all variables, " +
                                  "and uses no objective");
}

// The bounds decide (the AMPL/PATH driver's rule). A kind that names a bound which is infinite changes nothing: such a
// bound is never active. One that leaves out a finite bound states another condition than the box does.
void refuse_contradictions(const NlModel& model, const Names& names) {
  for (std::size_t i = 0; i < model.rows.size(); ++i) {
    const NlRange& row = model.rows[i];
    if (row.complement < 0) continue;
    const NlRange& variable = model.variables[at(row.complement)];
    const int finite = (std::isfinite(variable.lower) ? 1 : 0) | (std::isfinite(variable.upper) ? 2 : 0);
    if ((finite & ~row.bounds) == 0) continue;
    throw ModelError(bad_file, model.at(row.place) + ": constraint " + names.row(static_cast<int>(i)) +
                                   " complements variable " + names.variable(row.complement) + " with kind " +
                                   std::to_string(row.bounds) + ", which contradicts the variable's bounds " +
                                   interval(variable) + " (their kind is " + std::to_string(finite) + ")");
  }
}

void refuse_double_complements(const NlModel& model, const Names& names, const std::vector<char>& complemented) {
  std::vector<int> first(model.variables.size(), -1);
  for (std::size_t i = 0; i < model.rows.size(); ++i) {
    const int j = model.rows[i].complement;
    if (j < 0) continue;
    if (first[at(j)] < 0) {
      first[at(j)] = static_cast<int>(i);
      continue;
    }
    std::vector<std::string> without;
    for (std::size_t k = 0; k < model.variables.size(); ++k)
      if (!complemented[k] && (std::isfinite(model.variables[k].lower) || std::isfinite(model.variables[k].upper)))
        without.push_back(names.variable(static_cast<int>(k)));
    std::string message = model.at(model.rows[i].place) + ": rows " + names.row(first[at(j)]) + " and " +
                          names.row(static_cast<int>(i)) + " both complement variable " + names.variable(j);
    if (!without.empty()) message += "; no row complements " + Names::list(without) + ", which has bounds";
    throw ModelError(bad_file, message);
  }
}

/// Rows and variables as they are written, with what rows change by between points where most of them are defined.
ModelStructure structure_of(const NlModel& model, const Names& names) {
  const auto m = static_cast<Index>(model.rows.size());
  const auto n = static_cast<Index>(model.variables.size());
  ModelStructure s{.pattern = SpMat(m, n),
                   .own = SpMat(m, n),
                   .complement = {},
                   .changes = Eigen::MatrixXd::Zero(m, 3),
                   .row = [&names](Index i) { return names.row(static_cast<int>(i)); },
                   .variable = [&names](Index j) { return names.variable(static_cast<int>(j)); }};
  std::vector<Eigen::Triplet<double>> entries, complements;
  for (Index i = 0; i < m; ++i) {
    const NlRange& row = model.rows[at(i)];
    s.complement.push_back(row.complement);
    s.imposes.push_back(row.complement >= 0 || is_equation(row) ? 1 : 0);
    if (!s.imposes.back()) continue;
    if (row.complement >= 0) complements.emplace_back(static_cast<int>(i), row.complement, 1);
    for (const int j : model.row_variables[at(i)]) entries.emplace_back(static_cast<int>(i), j, 1);
  }
  s.own.setFromTriplets(entries.begin(), entries.end());
  entries.insert(entries.end(), complements.begin(), complements.end());
  s.pattern.setFromTriplets(entries.begin(), entries.end());
  for (const NlRange& v : model.variables)
    s.bounded.push_back(std::isfinite(v.lower) || std::isfinite(v.upper) ? 1 : 0);
  Vec base;
  for (int k = 0; k <= s.changes.cols(); ++k) {
    Vec x(n);
    for (Index j = 0; j < n; ++j)
      x[j] = std::clamp(0.6 + 0.3 * std::sin(1.7 * static_cast<double>(j + 1) * (k + 1)), model.variables[at(j)].lower,
                        std::max(model.variables[at(j)].lower, model.variables[at(j)].upper));
    const PointValues values(model.expressions.graph, {x.data(), at(n)});
    Vec c(m);
    for (Index i = 0; i < m; ++i) {
      c[i] = values[model.expressions.rows[at(i)]];
      for (std::size_t e = 0; e < model.row_variables[at(i)].size(); ++e)
        c[i] += model.coefficients[at(i)][e] * x[model.row_variables[at(i)][e]];
    }
    if (k == 0)
      s.values = base = c;
    else
      s.changes.col(k - 1) = c - base;
  }
  return s;
}

void refuse_nonsquare(const NlModel& model, const Names& names, const std::vector<char>& complemented) {
  std::ptrdiff_t conditions = 0, equations = 0;
  for (const NlRange& row : model.rows) {
    if (row.complement >= 0)
      ++conditions;
    else if (is_equation(row))
      ++equations;
  }
  if (equations == std::ranges::count(complemented, 0)) return;
  std::string message = model.file + ": the model is not square: " + quantity(equations, "equation") + " and " +
                        quantity(conditions, "complementarity condition") + " for " +
                        quantity(std::ssize(complemented), "variable");
  for (const std::string& fault : faults(structure_of(model, names))) message += "; " + fault;
  throw ModelError(nonsquare, message);
}

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

bool is_free(const NlRange& range) { return range.lower == -infinity && range.upper == infinity; }

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

/// A condition  0 <= v _|_ u >= 0  whose u is an affine function of one free variable x, and whose v stands for F: the
/// bound u >= 0 is one of x, and x complements F.
struct Turned {
  int variable = 0;   ///< x
  bool above = true;  ///< x >= bound; else x <= bound
  double bound = 0;
  int equation = 0;  ///< of v
  double sign = 1;   ///< F = sign (row(x) - its bound), at v = 0
};
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

// Adds an unknown y >= 0 with F_y = sign (v - bound) - y.
void add_side(Pairing& pairing, std::vector<Equation>& sides, bool of_row, int index, const NlRange& range) {
  if (of_row && (std::isfinite(range.lower) || std::isfinite(range.upper))) pairing.used[at(index)] = 1;
  if (std::isfinite(range.lower)) sides.push_back({of_row, index, 1, range.lower, true});
  if (std::isfinite(range.upper)) sides.push_back({of_row, index, -1, range.upper, true});
}

bool two_sided(const Pairing& pairing, Index u) {
  const Equation& e = pairing.equations[at(u)];
  const auto same = [&](Index v) {
    return v >= 0 && at(v) < pairing.equations.size() && pairing.equations[at(v)].side &&
           pairing.equations[at(v)].of_row == e.of_row && pairing.equations[at(v)].index == e.index;
  };
  return same(u - 1) || same(u + 1);
}

std::string side_name(const Pairing& pairing, const Names& names, Index u) {
  const Equation& e = pairing.equations[at(u)];
  const char* which = e.of_row && !two_sided(pairing, u) ? "side[" : e.sign > 0 ? "side_lower[" : "side_upper[";
  return which + (e.of_row ? names.row(e.index) : names.variable(e.index)) + "]";
}

}  // namespace

Pairing pair(const NlModel& model, const Names& names) {
  refuse_integers(model, names);
  refuse_empty_ranges(model, names);
  refuse_mpec(model);
  refuse_contradictions(model, names);
  const auto n_var = static_cast<int>(model.variables.size());
  std::vector<char> complemented(model.variables.size(), 0);
  for (const NlRange& row : model.rows)
    if (row.complement >= 0) complemented[at(row.complement)] = 1;
  refuse_double_complements(model, names, complemented);
  refuse_nonsquare(model, names, complemented);

  Pairing pairing;
  pairing.used.assign(model.rows.size(), 0);
  const std::vector<char> in_expression = in_expressions(model);
  const std::vector<int> defining = auxiliary_equations(model, complemented, in_expression);
  const std::vector<int> equation_of = equations_of_variables(model);
  std::vector<char> gone_row(model.rows.size(), 0), gone(model.variables.size(), 0);
  std::vector<char> paired = complemented;      // variables that have their row
  std::vector<char> spoken_for = complemented;  // those, and variables that a condition consists of
  for (std::size_t i = 0; i < model.rows.size(); ++i)
    if (model.rows[i].complement >= 0 && model.row_variables[i].size() == 1)
      spoken_for[at(model.row_variables[i].front())] = 1;
  std::vector<Turned> turns;
  const PointValues constants(model.expressions.graph, std::vector<double>(model.variables.size(), 0));
  std::vector<Equation> own(model.variables.size()), sides;
  for (std::size_t i = 0; i < model.rows.size(); ++i) {
    if (defining[i] < 0) continue;
    const int v = model.row_variables[i].front(), e = defining[i];
    const double a = coefficient(model, at(e), v), b = model.rows[at(e)].lower;
    const int condition = static_cast<int>(i);
    pairing.auxiliaries.push_back({v, e, a, b});
    gone_row[at(e)] = gone[at(v)] = pairing.used[i] = pairing.used[at(e)] = 1;
    if (const auto turn = turned(model, constants, spoken_for, equation_of, in_expression, i, e);
        turn && !gone_row[at(turn->equation)]) {
      const int f = turn->equation, y = model.rows[i].complement;
      own[at(turn->variable)] = {
          .index = f, .sign = turn->sign, .bound = model.rows[at(f)].lower, .condition = condition};
      pairing.auxiliaries.push_back({y, f, coefficient(model, at(f), y), model.rows[at(f)].lower});
      gone_row[at(f)] = gone[at(y)] = pairing.used[at(f)] = paired[at(turn->variable)] = 1;
      spoken_for[at(turn->variable)] = 1;
      turns.push_back(*turn);
      continue;
    }
    own[at(model.rows[i].complement)] = {
        .index = e, .sign = coefficient(model, i, v) == a ? -1.0 : 1.0, .bound = b, .condition = condition};
  }
  int next = 0;  // the first variable that may still be without an equation
  for (std::size_t i = 0; i < model.rows.size(); ++i) {
    const NlRange& row = model.rows[i];
    const auto index = static_cast<int>(i);
    if (defining[i] >= 0 || gone_row[i]) continue;
    if (row.complement >= 0) {
      own[at(row.complement)] = {.index = index};
      pairing.used[i] = 1;
    } else if (is_equation(row)) {
      while (paired[at(next)] || gone[at(next)]) ++next;
      own[at(next++)] = {.index = index, .bound = row.lower};
      pairing.used[i] = 1;
    } else {
      add_side(pairing, sides, true, index, row);
    }
  }
  for (int j = 0; j < n_var; ++j)
    if (!complemented[at(j)] && !gone[at(j)]) add_side(pairing, sides, false, j, model.variables[at(j)]);

  pairing.unknowns.assign(model.variables.size(), -1);
  for (int j = 0; j < n_var; ++j) {
    if (gone[at(j)]) continue;
    pairing.unknowns[at(j)] = static_cast<int>(pairing.variables.size());
    pairing.variables.push_back(j);
    pairing.equations.push_back(own[at(j)]);
  }
  pairing.equations.insert(pairing.equations.end(), sides.begin(), sides.end());
  pairing.box = Box::free(static_cast<Index>(pairing.equations.size()));
  for (std::size_t u = 0; u < pairing.variables.size(); ++u) {
    const int j = pairing.variables[u];
    if (!complemented[at(j)]) continue;
    pairing.box.lower[static_cast<Index>(u)] = model.variables[at(j)].lower;
    pairing.box.upper[static_cast<Index>(u)] = model.variables[at(j)].upper;
  }
  for (const Turned& turn : turns)
    (turn.above ? pairing.box.lower : pairing.box.upper)[pairing.unknowns[at(turn.variable)]] = turn.bound;
  pairing.box.lower.tail(static_cast<Index>(sides.size())).setZero();
  return pairing;
}

std::string without_row(const NlModel& model, const Names& names) {
  std::vector<char> complemented(model.variables.size(), 0);
  for (const NlRange& row : model.rows)
    if (row.complement >= 0) complemented[at(row.complement)] = 1;
  std::vector<int> alone;
  std::size_t others = 0;
  for (std::size_t j = 0; j < model.variables.size(); ++j)
    if (std::isfinite(model.variables[j].lower) || std::isfinite(model.variables[j].upper))
      complemented[j] ? void(++others) : alone.push_back(static_cast<int>(j));
  constexpr std::size_t few = 5;  // names that a person reads
  if (alone.empty() || alone.size() > few || alone.size() > others) return {};
  const NameAt row = [&](Index i) { return names.row(static_cast<int>(i)); };
  const NameAt variable = [&](Index j) { return names.variable(static_cast<int>(j)); };
  const std::vector<Index> rows = namesakes(std::ssize(model.rows), std::ssize(model.variables), row, variable).row_of;
  std::vector<std::string> variables, by_name;
  for (const int j : alone) {
    variables.push_back(names.variable(j));
    if (rows[at(j)] >= 0) by_name.push_back(row(rows[at(j)]));
  }
  const bool one = alone.size() == 1;
  return "no row complements " + Names::list(variables) +
         (one ? ", which has bounds: they are" : ", which have bounds: these are") + " side inequalities" +
         (by_name.empty() ? "" : "; by the names its row would be " + Names::list(by_name));
}

JacobianMap map_jacobian(const NlModel& model, const Pairing& pairing) {
  const auto n = static_cast<Index>(pairing.equations.size());
  // Where each row's entries are among the nonzeros by columns.
  std::vector<int> next = model.column_start;
  std::vector<std::vector<int>> nonzero(model.rows.size());
  for (std::size_t i = 0; i < model.rows.size(); ++i)
    for (int j : model.row_variables[i]) nonzero[i].push_back(next[at(j)]++);

  std::vector<std::vector<std::pair<int, JacobianMap::Entry>>> columns(at(n));  // (row, entry), rows ascending
  long long count = 0;
  for (Index u = 0; u < n; ++u) {
    const Equation& e = pairing.equations[at(u)];
    const auto add = [&](Index column, JacobianMap::Entry entry) {
      columns[at(column)].emplace_back(static_cast<int>(u), entry);
      ++count;
    };
    if (e.of_row) {
      const std::vector<int>& variables = model.row_variables[at(e.index)];
      for (std::size_t k = 0; k < variables.size(); ++k)
        if (const int unknown = pairing.unknowns[at(variables[k])]; unknown >= 0)
          add(unknown, {nonzero[at(e.index)][k], e.sign});
    } else {
      add(pairing.unknowns[at(e.index)], {-1, e.sign});
    }
    if (e.side) add(u, {-1, -1.0});
  }
  if (count > INT_MAX) throw ModelError(bad_file, model.file + ": the Jacobian has more than 2^31 - 1 nonzeros");

  JacobianMap map;
  map.pattern.resize(n, n);
  map.pattern.reserve(static_cast<Index>(count));
  map.entries.reserve(static_cast<std::size_t>(count));
  for (Index j = 0; j < n; ++j) {
    map.pattern.startVec(j);
    for (const auto& [row, entry] : columns[at(j)]) {
      map.pattern.insertBack(row, j) = 1;
      map.entries.push_back(entry);
    }
  }
  map.pattern.finalize();
  return map;
}

std::string unknown_name(const Pairing& pairing, const Names& names, Index u) {
  return at(u) < pairing.variables.size() ? names.variable(pairing.variables[at(u)]) : side_name(pairing, names, u);
}

std::string equation_name(const Pairing& pairing, const Names& names, Index u) {
  if (at(u) >= pairing.variables.size()) return side_name(pairing, names, u);
  const Equation& e = pairing.equations[at(u)];
  const std::string row = names.row(e.index);
  if (e.condition < 0) return row;
  // Pyomo calls the two rows of a condition NAME.c and NAME.bc.
  const std::string condition = names.row(e.condition);
  const std::string name = condition.substr(0, condition.rfind('.'));
  return name.size() < condition.size() && name == row.substr(0, row.rfind('.')) ? name : condition;
}

}  // namespace perp::ncp::ampl
