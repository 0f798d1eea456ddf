// SPDX-License-Identifier: Apache-2.0
#include "ncp/analysis/row_sums.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>

#include "lcp/exact_sum.hpp"
#include "ncp/interval/expression.hpp"

namespace perp::ncp {
namespace {

using Graph = ExpressionGraph;
using Node = Graph::Node;

/// Parts of sums that are looked at, beside the nodes: defined variables within defined variables may be written out in
/// ever more of them. Those after that are terms as they stand.
constexpr std::size_t parts_a_node = 20;

bool exact_product(double a, double b, double& product) {
  const lcp::TwoParts p = lcp::two_product(a, b);
  product = p.value;
  return std::isfinite(p.value) && p.error == 0 && (std::abs(p.value) >= 0x1p-968 || p.value == 0);
}

/// Finds for each node the first one written alike. A condition's value is like no other: nobody knows which it is.
std::vector<Node> first_alike(const Graph& graph) {
  std::vector<Node> first(graph.size());
  std::map<std::tuple<Operation, Node, Node, std::uint64_t>, Node> known;
  for (Node k = 0; k < static_cast<Node>(graph.size()); ++k) {
    const Graph::Entry& e = graph.entry(k);
    first[at(k)] = k;
    if (e.operation == Operation::Unknown || e.operation == Operation::Either) continue;
    const bool operand = e.operation != Operation::Constant && e.operation != Operation::Variable;
    Node a = operand ? first[at(e.a)] : e.a, b = Graph::is_binary(e.operation) ? first[at(e.b)] : -1;
    if ((e.operation == Operation::Add || e.operation == Operation::Multiply) && b < a) std::swap(a, b);
    first[at(k)] = known.try_emplace({e.operation, a, b, std::bit_cast<std::uint64_t>(e.value)}, k).first->second;
  }
  return first;
}

class Sums {
 public:
  Sums(const Expressions& f, const Box& box)
      : f_(f),
        lower_(box.lower.begin(), box.lower.end()),
        upper_(box.upper.begin(), box.upper.end()),
        first_(first_alike(f.graph)) {
    std::vector<Interval> X;
    for (Index j = 0; j < box.size(); ++j) X.emplace_back(box.lower[j], box.upper[j]);
    ranges_ = f.graph.ranges(X);
  }

  /// False: the row is defined nowhere.
  bool add_row(Index i) {
    row_.clear();
    constant_ = 0;
    std::vector<std::pair<Node, double>> open{{f_.rows[at(i)], 1.0}};
    while (!open.empty()) {
      const auto [node, factor] = open.back();
      open.pop_back();
      if (ranges_.values[at(node)].is_empty()) return false;
      take_apart(node, factor, open);
    }
    for (const auto& [column, c] : row_)
      if (c != 0) entries_.emplace_back(static_cast<int>(i), static_cast<int>(column), c);
    q_.push_back(constant_);
    return true;
  }

  RowSums done() {
    const auto n = std::ssize(q_), all = std::ssize(lower_);
    RowSums out{.problem = {.M = SpMat(all, all), .q = Vec::Zero(all), .box = {Vec(all), Vec(all)}},
                .rows = std::vector<char>(at(all), 0)};
    out.problem.M.setFromTriplets(entries_.begin(), entries_.end());
    out.problem.q.head(n) = Eigen::Map<const Vec>(q_.data(), n);
    out.problem.box.lower = Eigen::Map<const Vec>(lower_.data(), all);
    out.problem.box.upper = Eigen::Map<const Vec>(upper_.data(), all);
    std::fill_n(out.rows.begin(), n, char{1});
    return out;
  }

 private:
  void take_apart(Node node, double factor, std::vector<std::pair<Node, double>>& open) {
    const Graph::Entry& e = f_.graph.entry(node);
    const bool enough = ++parts_ > parts_a_node * (f_.graph.size() + f_.rows.size());
    double product = 0;
    switch (enough ? Operation::Unknown : e.operation) {
      case Operation::Constant: {
        if (!std::isfinite(e.value) || !exact_product(factor, e.value, product)) break;
        const lcp::TwoParts sum = lcp::two_sum(constant_, product);
        if (sum.error != 0 || !std::isfinite(sum.value)) break;
        constant_ = sum.value;
        return;
      }
      case Operation::Variable:
        return add(e.a, factor);
      case Operation::Add:
      case Operation::Subtract:
        open.emplace_back(e.a, factor);
        open.emplace_back(e.b, e.operation == Operation::Add ? factor : -factor);
        return;
      case Operation::Negate:
        open.emplace_back(e.a, -factor);
        return;
      case Operation::Multiply:
        for (const auto& [number, other] : {std::pair(e.a, e.b), std::pair(e.b, e.a)})
          if (f_.graph.entry(number).operation == Operation::Constant &&
              exact_product(factor, f_.graph.entry(number).value, product))
            return open.emplace_back(other, product), void();
        break;
      case Operation::Divide:
        if (f_.graph.entry(e.b).operation == Operation::Constant) {
          const double divisor = f_.graph.entry(e.b).value, quotient = factor / divisor;
          if (divisor != 0 && exact_product(quotient, divisor, product) && product == factor)
            return open.emplace_back(e.a, quotient), void();
        }
        break;
      default:
        break;
    }
    const Node first = first_[at(node)];
    const auto [term, is_new] = terms_.try_emplace(first, std::ssize(lower_));
    if (is_new) add_column(ranges_.values[at(first)]);
    add(term->second, factor);
  }

  /// Adds factor z_column to the row; to a second column of the same range where the sum of coefficients would be
  /// rounded.
  void add(Index column, double factor) {
    double& c = row_[column];
    const lcp::TwoParts sum = lcp::two_sum(c, factor);
    if (sum.error == 0 && std::isfinite(sum.value)) {
      c = sum.value;
      return;
    }
    row_[std::ssize(lower_)] = factor;
    add_column({lower_[at(column)], upper_[at(column)]});
  }

  void add_column(const Interval& range) {
    lower_.push_back(range.lower);
    upper_.push_back(range.upper);
  }

  const Expressions& f_;
  std::vector<double> lower_, upper_;  ///< of z
  std::vector<Node> first_;
  Graph::Ranges ranges_{};
  std::map<Node, Index> terms_{};  ///< their columns
  std::map<Index, double> row_{};
  double constant_ = 0;
  std::size_t parts_ = 0;
  std::vector<double> q_{};
  std::vector<Eigen::Triplet<double>> entries_{};
};

}  // namespace

std::optional<RowSums> row_sums(const Mcp& mcp) {
  const std::optional<Expressions> f = mcp.expressions();
  if (!f) return std::nullopt;
  Sums sums(*f, mcp.box());
  for (Index i = 0; i < mcp.size(); ++i)
    if (!sums.add_row(i)) return std::nullopt;
  return sums.done();
}

}  // namespace perp::ncp
