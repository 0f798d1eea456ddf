// SPDX-License-Identifier: Apache-2.0
#include "ncp/ampl/pairing.hpp"

#include <algorithm>
#include <climits>
#include <cmath>

#include "ncp/ampl/conditions.hpp"
#include "ncp/ampl/model.hpp"
#include "ncp/interval/undefined.hpp"
#include "ncp/problem/model_structure.hpp"
#include "ncp/problem/words.hpp"

namespace perp::ncp::ampl {
namespace {

bool is_bounded(const NlRange& range) { return std::isfinite(range.lower) || std::isfinite(range.upper); }

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

// Fewer conditions than variables leave the rest to an objective: an optimisation problem, with or without equilibrium
// constraints.
void refuse_optimisation(const NlModel& model) {
  const auto conditions = std::ranges::count_if(model.rows, [](const NlRange& row) { return row.complement >= 0; });
  const auto equations = std::ranges::count_if(model.rows, is_equation);
  const auto left = std::ssize(model.variables) - conditions - equations;
  if (model.header.n_obj == 0 || left <= 0) return;
  const std::string leave = quantity(equations, "equation") +
                            (conditions == 0 && equations == 1 ? " leaves " : " leave ") + quantity(left, "variable");
  throw ModelError(nonsquare,
                   model.file + ": the model is an " +
                       (conditions == 0 ? "optimisation problem: it has no complementarity condition, and its " + leave
                                        : "MPEC, an optimisation problem with equilibrium constraints: its " +
                                              quantity(conditions, "complementarity condition") + " and " + leave) +
                       " to the objective; Perp solves models whose conditions determine all variables, and uses no "
                       "objective");
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
    const char* where = row.bounds == 0   ? "at no bound"
                        : row.bounds == 1 ? "at its lower bound alone"
                                          : "at its upper bound alone";
    throw ModelError(bad_file,
                     model.at(row.place) + ": constraint " + names.row(static_cast<int>(i)) + " complements variable " +
                         names.variable(row.complement) + " " + where + " (kind " + std::to_string(row.bounds) +
                         "), and the variable has the bounds " + interval(variable) + " (their kind is " +
                         std::to_string(finite) +
                         "): the condition does not say what holds at the other bound. Give it all of them (AMPL: l <= "
                         "x <= u complements F; Pyomo: import perp.pyomo, and complements(F, inequality(l, x, u)))");
  }
}

void refuse_bent_polyhedra(const NlModel& model, const Names& names) {
  for (std::size_t i = 0; i < model.rows.size(); ++i) {
    const NlRange& row = model.rows[i];
    const char* wrong = !row.polyhedron              ? nullptr
                        : !model.mentions[i].empty() ? "is not linear"
                        : row.complement >= 0        ? "complements a variable"
                                                     : nullptr;
    if (wrong != nullptr)
      throw ModelError(bad_file, model.at(row.place) + ": constraint " + names.row(static_cast<int>(i)) + " " + wrong +
                                     ", and has the suffix " + std::string(polyhedron_suffix) +
                                     ": the rows A x of a polyhedron are linear, and complement nothing");
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

/// Pyomo calls the two rows of a condition NAME.c and NAME.bc.
std::string row_name(const Equation& e, const Names& names) {
  const std::string row = names.row(e.index);
  if (e.condition < 0) return row;
  const std::string condition = names.row(e.condition);
  const std::string name = condition.substr(0, condition.rfind('.'));
  return name.size() < condition.size() && name == row.substr(0, row.rfind('.')) ? name : condition;
}

/// The variables with bounds that no row complements, where they are few and most have one: a slip of the modeller's
/// more often than not.
std::vector<int> without_condition(const NlModel& model) {
  std::vector<char> complemented(model.variables.size(), 0);
  for (const NlRange& row : model.rows)
    if (row.complement >= 0) complemented[at(row.complement)] = 1;
  std::vector<int> alone;
  std::size_t others = 0;
  for (std::size_t j = 0; j < model.variables.size(); ++j)
    if (is_bounded(model.variables[j])) complemented[j] ? void(++others) : alone.push_back(static_cast<int>(j));
  constexpr std::size_t few = 5;  // names that a person reads
  if (alone.size() > few || alone.size() > others) alone.clear();
  return alone;
}

/// "no row complements x3, which has bounds".
std::string told(const std::vector<int>& without, const Names& names) {
  std::vector<std::string> variables;
  for (const int j : without) variables.push_back(names.variable(j));
  return "no row complements " + Names::list(variables) +
         (without.size() == 1 ? ", which has bounds" : ", which have bounds");
}

/// Rows and variables without those that only spell conditions, and what rows change by between points where most of
/// them are defined.
ModelStructure structure_of(const NlModel& model, const Names& names, const Conditions& found) {
  std::vector<Index> column(model.variables.size(), -1);
  std::vector<int> variables;
  for (std::size_t j = 0; j < column.size(); ++j) {
    if (found.gone[j]) continue;
    column[j] = std::ssize(variables);
    variables.push_back(static_cast<int>(j));
  }
  std::vector<Equation> rows;
  std::vector<Index> complement;
  const auto add = [&](const Equation& row, int variable) {
    rows.push_back(row);
    complement.push_back(variable >= 0 ? column[at(variable)] : -1);
  };
  for (std::size_t i = 0; i < model.rows.size(); ++i) {
    const NlRange& row = model.rows[i];
    if (!found.gone_row[i])
      add({.index = static_cast<int>(i), .bound = row.complement < 0 ? row.lower : 0}, row.complement);
    else if (const int x = found.complement[i]; x >= 0)
      add(found.own[at(x)], x);
  }
  const auto m = std::ssize(rows), n = std::ssize(variables);
  ModelStructure s{.pattern = SpMat(m, n),
                   .complement = complement,
                   .changes = Eigen::MatrixXd::Zero(m, 3),
                   .row = [rows, &names](Index i) { return row_name(rows[at(i)], names); },
                   .variable = [variables, &names](Index j) { return names.variable(variables[at(j)]); }};
  std::vector<Eigen::Triplet<double>> entries, complements;
  for (Index i = 0; i < m; ++i) {
    s.imposes.push_back(complement[at(i)] >= 0 || is_equation(model.rows[at(rows[at(i)].index)]) ? 1 : 0);
    if (!s.imposes.back()) continue;
    if (complement[at(i)] >= 0) complements.emplace_back(static_cast<int>(i), complement[at(i)], 1);
    for (const int j : model.row_variables[at(rows[at(i)].index)])
      if (column[at(j)] >= 0) entries.emplace_back(static_cast<int>(i), column[at(j)], 1);
  }
  s.pattern.setFromTriplets(entries.begin(), entries.end());
  s.keys = row_keys(s.pattern);
  entries.insert(entries.end(), complements.begin(), complements.end());
  s.pattern.setFromTriplets(entries.begin(), entries.end());
  for (const int j : variables) s.bounded.push_back(is_bounded(model.variables[at(j)]) ? 1 : 0);
  Vec base;
  for (int k = 0; k <= s.changes.cols(); ++k) {
    std::vector<double> x(model.variables.size(), 0);
    for (const int j : variables)
      x[at(j)] =
          std::clamp(0.6 + 0.3 * std::sin(1.7 * static_cast<double>(j + 1) * (k + 1)), model.variables[at(j)].lower,
                     std::max(model.variables[at(j)].lower, model.variables[at(j)].upper));
    const PointValues values(model.expressions.graph, x);
    const auto value_of = [&](int row) {
      double c = values[model.expressions.rows[at(row)]];
      for (std::size_t e = 0; e < model.row_variables[at(row)].size(); ++e)
        c += model.coefficients[at(row)][e] * x[at(model.row_variables[at(row)][e])];
      return c;
    };
    Vec F(m);
    for (Index i = 0; i < m; ++i) {
      const Equation& row = rows[at(i)];
      F[i] = row.sign * (value_of(row.index) - row.bound) + (row.condition >= 0 ? value_of(row.condition) : 0);
    }
    if (k == 0)
      s.values = base = F;
    else
      s.changes.col(k - 1) = F - base;
  }
  return s;
}

void refuse_nonsquare(const NlModel& model, const Names& names, const Conditions& found) {
  std::ptrdiff_t conditions = 0, equations = 0;
  for (std::size_t i = 0; i < model.rows.size(); ++i) {
    if (found.complement[i] >= 0)
      ++conditions;
    else if (!found.gone_row[i] && is_equation(model.rows[i]))
      ++equations;
  }
  const auto variables = std::ranges::count(found.gone, 0);
  if (equations + conditions == variables) return;
  std::vector<std::string> parts{"the model is not square: " + quantity(equations, "equation") + " and " +
                                 quantity(conditions, "complementarity condition") + " for " +
                                 quantity(variables, "variable")};
  for (Fault& fault : faults(structure_of(model, names, found))) parts.push_back(std::move(fault.text));
  if (const auto without = without_condition(model); equations + conditions < variables && !without.empty())
    parts.push_back(told(without, names));
  std::string message = model.file + ":";
  for (const std::string& part : parts) message += (&part == &parts.front() ? " " : "; ") + part;
  throw ModelError(nonsquare, message, std::move(parts));
}

// Adds an unknown y >= 0 with F_y = sign (v - bound) - y.
void add_side(Pairing& pairing, std::vector<Equation>& sides, bool of_row, int index, const NlRange& range) {
  if (of_row && (std::isfinite(range.lower) || std::isfinite(range.upper))) pairing.used[at(index)] = 1;
  if (std::isfinite(range.lower)) sides.push_back({of_row, index, 1, range.lower, true});
  if (std::isfinite(range.upper)) sides.push_back({of_row, index, -1, range.upper, true});
}

/// One multiplier of an equation, or one of each finite side.
void add_multipliers(Pairing& pairing, std::vector<Equation>& multipliers, int index, const NlRange& row) {
  const auto add = [&](double sign, double bound) {
    multipliers.push_back({.index = index, .sign = sign, .bound = bound, .multiplier = true});
    pairing.used[at(index)] = 1;
  };
  if (std::isfinite(row.lower)) add(1, row.lower);
  if (std::isfinite(row.upper) && row.upper != row.lower) add(-1, row.upper);
}

SpMat forces(const NlModel& model, const Pairing& pairing) {
  const auto n = std::ssize(pairing.equations);
  std::vector<Eigen::Triplet<double>> entries;
  for (Index u = n - pairing.multipliers; u < n; ++u) {
    const Equation& e = pairing.equations[at(u)];
    const std::vector<int>& variables = model.row_variables[at(e.index)];
    for (std::size_t k = 0; k < variables.size(); ++k)
      if (const double a = model.coefficients[at(e.index)][k]; a != 0)
        entries.emplace_back(pairing.unknowns[at(variables[k])], static_cast<int>(u), -e.sign * a);
  }
  SpMat out(n, n);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

bool two_sided(const Pairing& pairing, Index u) {
  const Equation& e = pairing.equations[at(u)];
  const auto same = [&](Index v) {
    return v >= 0 && at(v) < pairing.equations.size() && pairing.equations[at(v)].side == e.side &&
           pairing.equations[at(v)].multiplier == e.multiplier && pairing.equations[at(v)].of_row == e.of_row &&
           pairing.equations[at(v)].index == e.index;
  };
  return same(u - 1) || same(u + 1);
}

std::string added_name(const Pairing& pairing, const Names& names, Index u) {
  const Equation& e = pairing.equations[at(u)];
  const char* which = e.of_row && !two_sided(pairing, u) ? "[" : e.sign > 0 ? "_lower[" : "_upper[";
  return (e.multiplier ? "multiplier" : "side") + (which + (e.of_row ? names.row(e.index) : names.variable(e.index))) +
         "]";
}

}  // namespace

Pairing pair(const NlModel& model, const Names& names) {
  refuse_integers(model, names);
  refuse_empty_ranges(model, names);
  refuse_optimisation(model);
  refuse_contradictions(model, names);
  const auto n_var = static_cast<int>(model.variables.size());
  std::vector<char> complemented(model.variables.size(), 0);
  for (const NlRange& row : model.rows)
    if (row.complement >= 0) complemented[at(row.complement)] = 1;
  refuse_double_complements(model, names, complemented);
  refuse_bent_polyhedra(model, names);
  const Conditions found = conditions(model);
  refuse_nonsquare(model, names, found);

  Pairing pairing;
  pairing.used.assign(model.rows.size(), 0);
  for (const int i : found.used) pairing.used[at(i)] = 1;
  pairing.auxiliaries = found.auxiliaries;
  std::vector<Equation> own = found.own, sides, multipliers;
  std::vector<char> paired = complemented;  // variables that have their row
  for (const Turned& turn : found.turns) paired[at(turn.variable)] = 1;
  int next = 0;  // the first variable that may still be without an equation
  for (std::size_t i = 0; i < model.rows.size(); ++i) {
    const NlRange& row = model.rows[i];
    const auto index = static_cast<int>(i);
    if (found.gone_row[i]) continue;
    if (row.polyhedron) {
      add_multipliers(pairing, multipliers, index, row);
    } else if (row.complement >= 0) {
      own[at(row.complement)] = {.index = index};
      pairing.used[i] = 1;
    } else if (is_equation(row)) {
      while (paired[at(next)] || found.gone[at(next)]) ++next;
      own[at(next++)] = {.index = index, .bound = row.lower};
      pairing.used[i] = 1;
    } else {
      add_side(pairing, sides, true, index, row);
    }
  }
  for (int j = 0; j < n_var; ++j)
    if (!complemented[at(j)] && !found.gone[at(j)]) add_side(pairing, sides, false, j, model.variables[at(j)]);

  pairing.unknowns.assign(model.variables.size(), -1);
  for (int j = 0; j < n_var; ++j) {
    if (found.gone[at(j)]) continue;
    pairing.unknowns[at(j)] = static_cast<int>(pairing.variables.size());
    pairing.variables.push_back(j);
    pairing.equations.push_back(own[at(j)]);
  }
  for (const auto* added : {&sides, &multipliers})
    pairing.equations.insert(pairing.equations.end(), added->begin(), added->end());
  pairing.multipliers = std::ssize(multipliers);
  pairing.forces = forces(model, pairing);
  pairing.box = Box::free(static_cast<Index>(pairing.equations.size()));
  for (std::size_t u = 0; u < pairing.variables.size(); ++u) {
    const int j = pairing.variables[u];
    if (!complemented[at(j)]) continue;
    pairing.box.lower[static_cast<Index>(u)] = model.variables[at(j)].lower;
    pairing.box.upper[static_cast<Index>(u)] = model.variables[at(j)].upper;
  }
  for (const Turned& turn : found.turns)
    (turn.above ? pairing.box.lower : pairing.box.upper)[pairing.unknowns[at(turn.variable)]] = turn.bound;
  for (Index u = std::ssize(pairing.variables); u < pairing.box.size(); ++u) {
    const Equation& e = pairing.equations[at(u)];
    if (!e.multiplier || model.rows[at(e.index)].lower != model.rows[at(e.index)].upper) pairing.box.lower[u] = 0;
  }
  return pairing;
}

std::string without_row(const NlModel& model, const Names& names) {
  const std::vector<int> alone = without_condition(model);
  if (alone.empty()) return {};
  const NameAt row = [&](Index i) { return names.row(static_cast<int>(i)); };
  const NameAt variable = [&](Index j) { return names.variable(static_cast<int>(j)); };
  const std::vector<Index> rows = namesakes(std::ssize(model.rows), std::ssize(model.variables), row, variable).row_of;
  std::vector<std::string> by_name;
  for (const int j : alone)
    if (rows[at(j)] >= 0) by_name.push_back(row(rows[at(j)]));
  return told(alone, names) + (alone.size() == 1 ? ": they are" : ": these are") + " side inequalities" +
         (by_name.empty() ? "" : "; by the names its row would be " + Names::list(by_name));
}

std::string twice(const NlModel& model, const Pairing& pairing, const Names& names) {
  const auto condition_of = [&](int j) -> const Equation* {
    const int u = pairing.unknowns[at(j)];
    if (u < 0 || pairing.box.is_free(u)) return nullptr;
    return &pairing.equations[at(u)];
  };
  for (std::size_t i = 0; i < model.rows.size(); ++i) {
    const std::vector<int>& pair = model.row_variables[i];
    if (!is_equation(model.rows[i]) || pair.size() != 2 || !model.mentions[i].empty()) continue;
    for (const int k : {0, 1}) {
      const int alias = pair[at(k)], x = pair[at(1 - k)];
      const Equation *own = condition_of(x), *other = condition_of(alias);
      if (own != nullptr && other != nullptr && model.column_start[at(alias) + 1] == model.column_start[at(alias)] + 1)
        return names.variable(x) + " is in two conditions, " + row_name(*own, names) + " and " +
               row_name(*other, names);
    }
  }
  return {};
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
  for (Index u = n - pairing.multipliers; u < n; ++u)
    for (SpMat::InnerIterator it(pairing.forces, u); it; ++it, ++count)
      columns[at(u)].emplace_back(static_cast<int>(it.row()), JacobianMap::Entry{-1, it.value()});
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
  return at(u) < pairing.variables.size() ? names.variable(pairing.variables[at(u)]) : added_name(pairing, names, u);
}

std::string equation_name(const Pairing& pairing, const Names& names, Index u) {
  const Equation& e = pairing.equations[at(u)];
  return e.side || (e.multiplier && two_sided(pairing, u)) ? added_name(pairing, names, u) : row_name(e, names);
}

}  // namespace perp::ncp::ampl
