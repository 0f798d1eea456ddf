// SPDX-License-Identifier: Apache-2.0
#include "ncp/ampl/linearity.hpp"

#include <optional>

namespace perp::ncp::ampl {
namespace {

/// The variables that the expression of one row mentions, through any depth of defined variables.
class Mentioned {
 public:
  explicit Mentioned(const NlModel& model)
      : model_(model), seen_(at(model.header.n_var + model.header.defined()), {-1, false}) {}

  /// False: a variable is mentioned where it has no derivative.
  bool look_at(int row) {
    row_ = row;
    bool smooth = true;
    open_.clear();
    add(model_.mentions[at(row)], true);
    while (!open_.empty()) {
      const Mention m = open_.back();
      open_.pop_back();
      if (m.index >= model_.header.n_var)
        add(model_.definitions[at(m.index - model_.header.n_var)], m.derivative);
      else if (!m.derivative)
        smooth = false;
    }
    return smooth;
  }
  /// In the row last looked at?
  bool has(int variable) const { return seen_[at(variable)].row == row_; }

 private:
  struct Seen {
    int row;
    bool without_derivative;
  };
  /// A mention counts twice at most: with a derivative, and without one.
  void add(const std::vector<Mention>& mentions, bool derivative) {
    for (const Mention& m : mentions) {
      Seen& seen = seen_[at(m.index)];
      const bool differentiated = derivative && m.derivative;
      if (seen.row == row_ && (differentiated || seen.without_derivative)) continue;
      seen = {row_, !differentiated};
      open_.push_back({m.index, differentiated});
    }
  }

  const NlModel& model_;
  std::vector<Seen> seen_;
  std::vector<Mention> open_;
  int row_ = -1;
};

/// One flag for each nonzero of the model's own Jacobian, by columns; nothing if a row without entries is no constant.
std::optional<std::vector<bool>> linear_nonzeros(const NlModel& model, const Pairing& pairing) {
  std::vector<bool> linear(at(model.header.jacobian_nonzeros), false);
  std::vector<int> next = model.column_start;
  Mentioned mentioned(model);
  for (int i = 0; i < model.header.n_con; ++i) {
    const std::vector<int>& variables = model.row_variables[at(i)];
    const bool smooth = mentioned.look_at(i);
    if (!smooth && variables.empty() && pairing.used[at(i)]) return std::nullopt;
    for (const int j : variables) linear[at(next[at(j)]++)] = smooth && !mentioned.has(j);
  }
  return linear;
}

}  // namespace

std::vector<bool> linear_entries(const NlModel& model, const Pairing& pairing, const JacobianMap& map) {
  const std::optional<std::vector<bool>> nonzeros = linear_nonzeros(model, pairing);
  std::vector<bool> flags;
  if (!nonzeros) return flags;
  flags.reserve(map.entries.size());
  for (const JacobianMap::Entry& entry : map.entries)
    flags.push_back(entry.nonzero < 0 || (*nonzeros)[at(entry.nonzero)]);
  return flags;
}

}  // namespace perp::ncp::ampl
