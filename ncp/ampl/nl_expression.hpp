// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The expression trees of an .nl file, checked while they are passed over. The grammar is that of the operators'
/// opcodes (Gay, "Writing .nl files", table 6) with numeric and logical expressions kept apart; beyond it, only what
/// AMPL's library evaluates and differentiates correctly is let through.
#include <vector>

#include "ncp/ampl/nl_header.hpp"
#include "ncp/ampl/nl_tokens.hpp"
#include "ncp/interval/expression_graph.hpp"

namespace perp::ncp::ampl {

/// Deepest nesting of an expression. AMPL's library recurses: 240 bytes of stack a level when it reads. Engines of
/// JavaScript end calls of WebAssembly that are some 4000 levels deep.
#ifdef __wasm__
inline constexpr int max_depth = 2000;
#else
inline constexpr int max_depth = 10000;
#endif

/// An expression mentions a variable (index < n_var) or a defined variable (n_var + its number).
struct Mention {
  int index = 0;
  bool derivative = false;  ///< its derivative counts (it does not within conditions, round(), ...)
};

/// Who reads the expression decides which defined variables it may mention.
enum class Reader { Both, Constraint, Objective };

/// The defined variables seen so far: what a later expression may mention.
class DefinedVariables {
 public:
  explicit DefinedVariables(const NlHeader& header)
      : header_(header),
        seen_(static_cast<std::size_t>(header.defined()), 0),
        derivative_(static_cast<std::size_t>(header.defined()), 0) {}

  /// The number of a defined variable (0-based, after the n_var variables) is now defined. Variables of a single row
  /// belong to the expression that follows them: `end_row` ends their life.
  void define(int number, bool derivative) {
    seen_[static_cast<std::size_t>(number)] = number < header_.defined_shared() ? shared : row_;
    derivative_[static_cast<std::size_t>(number)] = derivative ? 1 : 0;
  }
  bool has_derivative(int number) const { return derivative_[static_cast<std::size_t>(number)] != 0; }
  void end_row() { ++row_; }
  bool defined(int number) const { return seen_[static_cast<std::size_t>(number)] != 0; }
  /// Why `number` may not be mentioned by `reader`; nullptr if it may. `self` is the number being defined, or -1.
  const char* objection(int number, Reader reader, int self) const;
  /// Which readers the defined variable itself is for.
  Reader group(int number) const;

 private:
  static constexpr int shared = 1;
  const NlHeader& header_;
  std::vector<int> seen_;
  std::vector<char> derivative_;
  int row_ = 2;
};

/// The expressions of a model for ranges. What has no derivative in AMPL's library, and what depends on a condition, is
/// kept as unknown.
struct NlGraph {
  ExpressionGraph graph;
  std::vector<ExpressionGraph::Node> definitions;  ///< of each defined variable
  std::vector<ExpressionGraph::Node> rows;         ///< of each row, without its linear part
};

struct ExpressionKind {
  int nodes = 0;
  ExpressionGraph::Node root = -1;
  bool derivative = false;  ///< is there one with respect to any variable? (not of numbers, counts, round(), ...)
  bool branches = false;    ///< has it min, max or if?
};

/// Passes over one expression, appends what it mentions, and puts it into the graph.
ExpressionKind check_expression(NlTokens& tokens, const NlHeader& header, const DefinedVariables& defined,
                                Reader reader, int self, std::vector<Mention>& mentions, NlGraph& graph);

}  // namespace perp::ncp::ampl
