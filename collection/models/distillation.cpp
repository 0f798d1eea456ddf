// SPDX-License-Identifier: Apache-2.0
/// Fletcher's distillation columns, in More 1990, "A collection of nonlinear model problems": nonlinear equations as
/// MCPs with free variables.
#include <cmath>
#include <span>
#include <vector>

#include "collection/base/build.hpp"
#include "collection/models/distillation_tables.hpp"
#include "collection/models/problems.hpp"

namespace perp::ncp::collection {

namespace {

using distillation_tables::Column;

/// The part of z = (x_11, x_12, ..., x_nm, t_1, ..., t_n, V_1, ..., V_{n-1}).
Index at_x(const Column& column, int i, int j) { return i * column.m + j; }
Index at_t(const Column& column, int i) { return column.n * column.m + i; }
Index at_V(const Column& column, int i) { return column.n * (column.m + 1) + i; }
Index size(const Column& column) { return column.n * (column.m + 2) - 1; }

/// a + a1 t + a2 t^2
template <class T>
T quadratic(double a, double a1, double a2, const T& t) {
  return a + t * (a1 + a2 * t);
}

/// What stage i holds: composition x of the liquid and y of the vapour, and their enthalpies.
template <class T>
struct Stage {
  T x[Column::max_components], y[Column::max_components];
  T liquid_enthalpy = 0, vapour_enthalpy = 0;
};

template <class T>
std::vector<Stage<T>> stages(const Column& column, Row<const T> z) {
  using std::exp;
  std::vector<Stage<T>> made(static_cast<std::size_t>(column.n));
  for (int i = 0; i < column.n; ++i) {
    Stage<T>& stage = made[static_cast<std::size_t>(i)];
    const T& t = z[at_t(column, i)];
    for (int j = 0; j < column.m; ++j) {
      stage.x[j] = z[at_x(column, i, j)];
      stage.y[j] = exp(column.a[j] + column.b[j] / (column.c[j] + t)) * stage.x[j] / column.pressure[i];
      stage.liquid_enthalpy += stage.x[j] * quadratic(column.al[j], column.al1[j], column.al2[j], t);
      stage.vapour_enthalpy += stage.y[j] * quadratic(column.be[j], column.be1[j], column.be2[j], t);
    }
  }
  return made;
}

/// The flows past the stages 0, ..., n - 2: V_i up from stage i, L_i down from stage i + 1.
template <class T>
struct Flows {
  const Column& column;
  Row<const T> z;
  const T& V(int i) const { return z[at_V(column, i)]; }
  T L(int i) const { return i < column.feed_stage ? V(i) + column.bottoms : V(i) - column.distillate; }
};

/// Balance at stage i < n - 1 of a quantity with the content liquid(i) and vapour(i) a unit of flow.
template <class T, class Liquid, class Vapour>
T balance(const Flows<T>& flow, int i, const Liquid& liquid, const Vapour& vapour) {
  T sum = flow.L(i) * liquid(i + 1) - flow.V(i) * vapour(i);
  if (i == 0) return sum - flow.column.bottoms * liquid(0);
  return sum + flow.V(i - 1) * vapour(i - 1) - flow.L(i - 1) * liquid(i);
}

template <class T>
void column_equations(const Column& column, Row<const T> z, const Row<T>& F) {
  const std::vector<Stage<T>> stage = stages(column, z);
  const Flows<T> flow{column, z};
  const auto at = [&](int i) -> const Stage<T>& { return stage[static_cast<std::size_t>(i)]; };
  const int last = column.n - 1, k = column.feed_stage;
  for (int i = 0; i < last; ++i) {
    T heat = balance(
        flow, i, [&](int s) { return at(s).liquid_enthalpy; }, [&](int s) { return at(s).vapour_enthalpy; });
    if (i == 0) heat += column.heat;
    for (int j = 0; j < column.m; ++j) {
      T mass = balance(
          flow, i, [&](int s) { return at(s).x[j]; }, [&](int s) { return at(s).y[j]; });
      const double t = column.feed_temperature;
      if (i == k) {
        mass += column.feed_liquid[j];
        heat += column.feed_liquid[j] * quadratic(column.al[j], column.al1[j], column.al2[j], t);
      } else if (i == k + 1) {
        mass += column.feed_vapour[j];
        heat += column.feed_vapour[j] * quadratic(column.be[j], column.be1[j], column.be2[j], t);
      }
      F[at_x(column, i, j)] = 1e-2 * mass;
    }
    F[at_V(column, i)] = 1e-6 * heat;
  }
  for (int j = 0; j < column.m; ++j) F[at_x(column, last, j)] = at(last - 1).y[j] - at(last).x[j];
  for (int i = 0; i < column.n; ++i) {
    T sum = -1;
    for (int j = 0; j < column.m; ++j) sum += at(i).y[j];
    F[at_t(column, i)] = sum;
  }
}

/// Names with stage and component, and the block tridiagonal pattern: stage i meets its neighbours alone.
Shape shape(const Column& column) {
  const Index n = size(column);
  Shape made{column.name, Box::free(n), Names(static_cast<std::size_t>(n)), Names(static_cast<std::size_t>(n)),
             SpMat(n, n)};
  std::vector<int> stage_of(static_cast<std::size_t>(n));
  const auto label = [&](Index at, int stage, const std::string& place, const char* variable, const char* equation) {
    const auto index = static_cast<std::size_t>(at);
    stage_of[index] = stage;
    made.variables[index] = element(variable, place);
    made.equations[index] = element(equation, place);
  };
  for (int i = 0; i < column.n; ++i) {
    const std::string number = std::to_string(i + 1);
    for (int j = 0; j < column.m; ++j) label(at_x(column, i, j), i, number + "," + std::to_string(j + 1), "x", "mass");
    label(at_t(column, i), i, number, "t", "vapour_sum");
    if (i + 1 < column.n) label(at_V(column, i), i, number, "V", "heat");
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (Index row = 0; row < n; ++row)
    for (Index col = 0; col < n; ++col)
      if (std::abs(stage_of[static_cast<std::size_t>(row)] - stage_of[static_cast<std::size_t>(col)]) <= 1)
        entries.emplace_back(row, col, 1.0);
  made.pattern.setFromTriplets(entries.begin(), entries.end());
  return made;
}

/// n stages counted from the reboiler, m components. Liquid compositions x_ij, temperatures t_i, vapour flows V_i; with
/// bottoms b and distillate d the liquid flows are L_i = V_i + b below the feed and V_i - d above it. Vapour
/// compositions and enthalpies:
///     y_ij = exp(a_j + b_j / (c_j + t_i)) x_ij / pi_i,
///     h_i = sum_j x_ij (al_j + al1_j t_i + al2_j t_i^2),     H_i = sum_j y_ij (be_j + be1_j t_i + be2_j t_i^2).
/// Equations: 1e-2 x the balance of every component and 1e-6 x that of heat (q at stage 1) for the stages 1..n-1, with
/// the feed's liquid and vapour entering at two neighbouring stages; y_{n-1} = x_n at the total condenser; sum_j y_ij
/// = 1.
Problem distillation(const Column& column, std::span<const double> start, std::span<const double> solution) {
  Problem p;
  p.mcp = make_problem(shape(column), [&column](const auto& z, const auto& F) {
    for (int i = 0; i < column.n; ++i)
      for (int j = 0; j < column.m; ++j)
        if (!above(z[at_t(column, i)], -column.c[j])) return false;  // the pole of Antoine's equation
    column_equations(column, z, F);
    return true;
  });
  const auto as_vec = [](std::span<const double> values) {
    return Vec(Eigen::Map<const Vec>(values.data(), static_cast<Index>(values.size())));
  };
  p.starts = {as_vec(start), shaken(as_vec(start), 0.02), shaken(as_vec(solution), 0.05)};
  p.solutions = {{"Fletcher", as_vec(solution), 1e-9}};
  return p;
}

}  // namespace

Problem hydroc06() {
  return distillation(distillation_tables::hydroc06, distillation_tables::hydroc06_start,
                      distillation_tables::hydroc06_solution);
}

Problem methan08() {
  return distillation(distillation_tables::methan08, distillation_tables::methan08_start,
                      distillation_tables::methan08_solution);
}

}  // namespace perp::ncp::collection
