// SPDX-License-Identifier: Apache-2.0
#include "ncp/ampl/model_enclosure.hpp"

#include <algorithm>
#include <vector>

#include "ncp/problem/mcp.hpp"

namespace perp::ncp::ampl {
namespace {

/// The elementary functions come from a C library that ends the process where memory is short: so much is asked for
/// beforehand, by somebody who can say no.
void require_some_memory() {
  constexpr std::size_t enough = 1 << 16;
  ::operator delete(::operator new(enough));
}

class ModelEnclosure final : public Enclosure {
 public:
  ModelEnclosure(const NlModel& model, const Pairing& pairing, const JacobianMap& map)
      : model_(model), pairing_(pairing), map_(map) {}

  double work() const override { return model_.expressions.graph.work(); }
  void values(std::span<const Interval> X, std::span<Interval> F, std::span<char> defined) const override;
  void jacobian(std::span<const Interval> X, std::span<Interval> J, std::span<char> known) const override;
  std::vector<UndefinedOperation> undefined(std::span<const double> x, bool derivatives,
                                            const NameOf& name) const override;

 private:
  ExpressionGraph::Node root(int row) const { return model_.expressions.rows[at(row)]; }
  Interval row(int row, std::span<const Interval> X, const ExpressionGraph::Ranges& ranges) const;
  /// Ranges of the model's variables, auxiliary ones 0.
  std::vector<Interval> point(std::span<const Interval> X) const {
    std::vector<Interval> all(model_.variables.size(), Interval(0));
    for (std::size_t u = 0; u < pairing_.variables.size(); ++u) all[at(pairing_.variables[u])] = X[u];
    return all;
  }

  const NlModel& model_;
  const Pairing& pairing_;
  const JacobianMap& map_;
};

Interval ModelEnclosure::row(int row, std::span<const Interval> X, const ExpressionGraph::Ranges& ranges) const {
  Interval value = ranges.values[at(root(row))];
  const std::vector<int>& variables = model_.row_variables[at(row)];
  for (std::size_t k = 0; k < variables.size() && value != Interval::all(); ++k)
    if (const double c = model_.coefficients[at(row)][k]; c != 0) value += c * X[at(variables[k])];
  return value;
}

void ModelEnclosure::values(std::span<const Interval> X, std::span<Interval> F, std::span<char> defined) const {
  if (work() > 0) require_some_memory();
  const std::vector<Interval> all = point(X);
  const ExpressionGraph::Ranges ranges = model_.expressions.graph.ranges(all);
  for (std::size_t u = 0; u < F.size(); ++u) {
    const Equation& e = pairing_.equations[u];
    const Interval v = e.of_row ? row(e.index, all, ranges) : all[at(e.index)];
    F[u] = e.sign * (v - e.bound);
    if (e.condition >= 0) F[u] = F[u] + row(e.condition, all, ranges);
    if (e.side) F[u] = F[u] - X[u];
    if (!defined.empty()) defined[u] = e.of_row ? ranges.defined[at(root(e.index))] : char{1};
  }
  for (Index u = 0; u < pairing_.forces.cols(); ++u)
    for (SpMat::InnerIterator it(pairing_.forces, u); it; ++it) F[at(it.row())] += it.value() * X[at(u)];
}

void ModelEnclosure::jacobian(std::span<const Interval> X, std::span<Interval> J, std::span<char> known) const {
  require_some_memory();
  const ExpressionGraph& graph = model_.expressions.graph;
  const ExpressionGraph::Ranges ranges = graph.ranges(point(X));
  for (std::size_t u = 0; u < known.size(); ++u) {
    const Equation& e = pairing_.equations[u];
    known[u] = e.of_row ? ranges.smooth[at(root(e.index))] : 1;
  }
  // Of each row the entries that the model's own Jacobian has, in its order: by columns, rows ascending.
  std::vector<int> next(model_.column_start.begin(), model_.column_start.end() - 1);
  std::vector<Interval> nonzeros(static_cast<std::size_t>(model_.header.jacobian_nonzeros));
  std::vector<Interval> derivatives(at(model_.header.n_var));
  std::vector<char> visited(graph.size(), 0);
  for (int i = 0; i < model_.header.n_con; ++i) {
    const bool smooth = ranges.smooth[at(root(i))] != 0;
    if (smooth) graph.add_derivatives(root(i), ranges, derivatives, visited);
    const std::vector<int>& variables = model_.row_variables[at(i)];
    for (std::size_t k = 0; k < variables.size(); ++k) {
      const auto j = at(variables[k]);
      nonzeros[at(next[j]++)] = smooth ? model_.coefficients[at(i)][k] + derivatives[j] : Interval::all();
      derivatives[j] = 0;
    }
  }
  for (std::size_t k = 0; k < map_.entries.size(); ++k) {
    const JacobianMap::Entry& entry = map_.entries[k];
    J[k] = entry.nonzero < 0 ? Interval(entry.factor) : entry.factor * nonzeros[at(entry.nonzero)];
  }
}

std::vector<UndefinedOperation> ModelEnclosure::undefined(std::span<const double> x, bool derivatives,
                                                          const NameOf& name) const {
  std::vector<double> all(model_.variables.size(), 0.0);
  for (std::size_t u = 0; u < pairing_.variables.size(); ++u) all[at(pairing_.variables[u])] = x[u];
  const PointValues values(model_.expressions.graph, all);
  const NameOf model_name = [&](int j) { return name(pairing_.unknowns[at(j)]); };
  std::vector<UndefinedOperation> found;
  for (std::size_t u = 0; u < pairing_.equations.size(); ++u) {
    if (!pairing_.equations[u].of_row) continue;
    for (UndefinedOperation& operation : values.undefined(root(pairing_.equations[u].index), derivatives, model_name)) {
      operation.row = static_cast<int>(u);
      for (BoundedVariable& j : operation.variables)
        j = {.index = pairing_.unknowns[at(j.index)],
             .bounds = {model_.variables[at(j.index)].lower, model_.variables[at(j.index)].upper}};
      found.push_back(std::move(operation));
    }
  }
  return found;
}

/// Writes the model's graph in another's unknowns, and sums of its rows.
class WrittenRows {
 public:
  using Node = ExpressionGraph::Node;

  WrittenRows(const NlModel& model, const Pairing& pairing, ExpressionGraph& graph)
      : model_(model), unknowns_(pairing.unknowns), graph_(graph) {
    const ExpressionGraph& from = model.expressions.graph;
    for (Node k = 0; k < static_cast<Node>(from.size()); ++k) nodes_.push_back(copy(from.entry(k)));
  }
  /// x_j; auxiliary ones are 0.
  Node variable(int j) {
    const int u = unknowns_[at(j)];
    return u < 0 ? graph_.constant(0) : graph_.variable(u);
  }
  Node row(int i) {
    std::vector<Node> terms{nodes_[at(model_.expressions.rows[at(i)])]};
    const std::vector<int>& variables = model_.row_variables[at(i)];
    for (std::size_t k = 0; k < variables.size(); ++k)
      if (const double c = model_.coefficients[at(i)][k]; c != 0) terms.push_back(times(c, variable(variables[k])));
    return graph_.sum(terms);
  }
  Node times(double c, Node a) { return graph_.binary(Operation::Multiply, graph_.constant(c), a); }

 private:
  Node copy(const ExpressionGraph::Entry& e) {
    switch (e.operation) {
      case Operation::Constant:
        return graph_.constant(e.value);
      case Operation::Variable:
        return variable(e.a);
      case Operation::Unknown:
        return graph_.unknown();
      default:
        return ExpressionGraph::is_binary(e.operation) ? graph_.binary(e.operation, nodes_[at(e.a)], nodes_[at(e.b)])
                                                       : graph_.unary(e.operation, nodes_[at(e.a)]);
    }
  }

  const NlModel& model_;
  const std::vector<int>& unknowns_;
  ExpressionGraph& graph_;
  std::vector<Node> nodes_{};  ///< of the model's
};

}  // namespace

Expressions model_expressions(const NlModel& model, const Pairing& pairing) {
  Expressions out;
  ExpressionGraph& graph = out.graph;
  WrittenRows written(model, pairing, graph);
  const SpMat forces = pairing.forces.transpose();
  for (std::size_t u = 0; u < pairing.equations.size(); ++u) {
    const Equation& e = pairing.equations[u];
    const ExpressionGraph::Node v = e.of_row ? written.row(e.index) : written.variable(e.index);
    std::vector<ExpressionGraph::Node> terms{e.sign == 1 ? v : written.times(e.sign, v),
                                             graph.constant(-e.sign * e.bound)};
    if (e.condition >= 0) terms.push_back(written.row(e.condition));
    if (e.side) terms.push_back(graph.unary(Operation::Negate, graph.variable(static_cast<int>(u))));
    for (SpMat::InnerIterator it(forces, static_cast<Index>(u)); it; ++it)
      terms.push_back(written.times(it.value(), graph.variable(static_cast<int>(it.row()))));
    out.rows.push_back(graph.sum(terms));
  }
  return out;
}

std::unique_ptr<Enclosure> model_enclosure(const NlModel& model, const Pairing& pairing, const JacobianMap& map) {
  return std::make_unique<ModelEnclosure>(model, pairing, map);
}

}  // namespace perp::ncp::ampl
