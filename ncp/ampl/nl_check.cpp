// SPDX-License-Identifier: Apache-2.0
#include "ncp/ampl/nl_check.hpp"

#include <algorithm>
#include <climits>

#include "ncp/ampl/model.hpp"

namespace perp::ncp::ampl {
namespace {

/// Reads the segments in the order in which they come.
class Segments {
 public:
  Segments(NlTokens& tokens, NlModel& model)
      : tokens_(tokens),
        model_(model),
        header_(model.header),
        defined_(header_),
        row_place_(at(header_.n_con), 0),
        row_anchor_(at(header_.n_con), 0),
        has_gradient_(at(header_.n_obj), 0),
        has_objective_(at(header_.n_obj), 0),
        has_jacobian_(at(header_.n_con), 0),
        column_count_(at(header_.n_var), 0),
        last_row_(at(header_.n_var), -1),
        polyhedron_(at(header_.n_con), 0) {}

  void run() {
    while (!tokens_.at_end()) segment(tokens_.kind());
    finish();
  }

 private:
  void segment(char kind);
  void constraint();
  void objective();
  void defined_variable();
  void suffix();
  void function();
  void ranges(std::vector<NlRange>& ranges, bool rows);
  NlRange range(const char* what, bool row);
  void initial_guess(const char* what, int n, double* values);
  void columns(bool counts);
  void jacobian();
  void gradient();
  void finish();
  void check_columns() const;
  void check_mentions() const;
  void once(char kind, bool& seen) {
    if (seen) tokens_.fail(std::string("second segment ") + kind);
    seen = true;
  }

  NlTokens& tokens_;
  NlModel& model_;
  const NlHeader& header_;
  DefinedVariables defined_;
  std::vector<Place> row_place_;         // of the C segment; 0: none yet
  std::vector<std::size_t> row_anchor_;  // where its expression begins if it needs an anchor, else 0
  std::vector<char> has_gradient_, has_objective_, has_jacobian_;
  std::vector<int> column_count_;
  std::vector<int> last_row_;     // the last row to name the variable in its J segment
  std::vector<char> polyhedron_;  // rows with that suffix
  std::vector<int> declared_columns_;
  int nonzeros_ = 0;
  int owner_ = 0;             // the single row that the V segments just read are for; 0: none
  bool expressions_ = false;  // a C or O segment has been read
  bool seen_r_ = false, seen_b_ = false, seen_k_ = false, seen_x_ = false, seen_d_ = false;
};

void Segments::segment(char kind) {
  if (owner_ != 0 && kind != 'V' && kind != 'C' && kind != 'O')
    tokens_.fail("a V segment for a single constraint or objective has to be followed by that one's segment");
  switch (kind) {
    case 'C':
      return constraint();
    case 'O':
      return objective();
    case 'V':
      return defined_variable();
    case 'F':
      return function();
    case 'L':
      tokens_.fail("logical constraint, of which the header declares none");
    case 'S':
      return suffix();
    case 'r':
      once(kind, seen_r_);
      tokens_.close();
      return ranges(model_.rows, true);
    case 'b':
      once(kind, seen_b_);
      tokens_.close();
      return ranges(model_.variables, false);
    case 'x':
      once(kind, seen_x_);
      return initial_guess("variable", header_.n_var, model_.start.data());
    case 'd':
      once(kind, seen_d_);
      return initial_guess("constraint", header_.n_con, nullptr);
    case 'k':
    case 'K':
      once(kind, seen_k_);
      return columns(kind == 'K');
    case 'J':
      return jacobian();
    case 'G':
      return gradient();
    default:
      tokens_.fail(std::string("expected a segment (one of C O V F L S r b x d k K J G), found \"") +
                   (kind > ' ' && kind <= '~' ? kind : '?') + "\"");
  }
}

void Segments::constraint() {
  const int row = tokens_.integer("constraint", 0, header_.n_con - 1);
  if (row_place_[at(row)] != 0) tokens_.fail("second segment C" + std::to_string(row));
  row_place_[at(row)] = tokens_.place();
  tokens_.close();
  const std::size_t begin = tokens_.offset();
  std::vector<Mention>& mentions = model_.mentions[at(row)];
  const ExpressionKind kind =
      check_expression(tokens_, header_, defined_, Reader::Constraint, -1, mentions, model_.expressions);
  model_.expressions.rows[at(row)] = kind.root;
  // The library starts the derivative of a row at the last thing it read that has one: not that of a lone variable,
  // and that of a definition before a row without derivative.
  if (kind.branches || (kind.nodes == 1 && !mentions.empty()) || (owner_ != 0 && !kind.derivative))
    row_anchor_[at(row)] = begin;
  defined_.end_row();
  owner_ = 0;
  expressions_ = true;
}

void Segments::objective() {
  const int k = tokens_.integer("objective", 0, header_.n_obj - 1);
  tokens_.integer("sense of the objective", 0, 1);
  if (has_objective_[at(k)]) tokens_.fail("second segment O" + std::to_string(k));
  has_objective_[at(k)] = 1;
  tokens_.close();
  const std::size_t begin = tokens_.offset();
  std::vector<Mention> mentions;
  if (check_expression(tokens_, header_, defined_, Reader::Objective, -1, mentions, model_.expressions).branches)
    model_.anchors.push_back({begin, 0});
  defined_.end_row();
  owner_ = 0;
  expressions_ = true;
}

void Segments::defined_variable() {
  const int index = tokens_.integer("defined variable", header_.n_var, header_.n_var + header_.defined() - 1);
  const int terms = tokens_.integer("number of linear terms", 0, INT_MAX);
  const int owner =
      tokens_.integer("constraint or objective of the defined variable", 0, header_.n_con + header_.n_obj);
  tokens_.close();
  const int self = index - header_.n_var;
  const std::string name = "defined variable v" + std::to_string(index);
  if (defined_.defined(self)) tokens_.fail("second definition of " + name);
  if ((owner > 0) != (self >= header_.defined_shared()))
    tokens_.fail(name + (owner > 0 ? " is for a single row, but not among" : " is for several rows, but among") +
                 " the header's last two counts of defined variables");
  if (owner_ != 0 && owner != owner_)
    tokens_.fail(name + " comes between the definitions for a single row and that row");
  if (owner == 0 && expressions_) tokens_.fail(name + " is for several rows, but comes after the first C or O segment");
  owner_ = owner;
  std::vector<Mention>& mentions = model_.definitions[at(self)];
  ExpressionGraph& graph = model_.expressions.graph;
  std::vector<ExpressionGraph::Node> sum;
  for (int i = 0; i < terms; ++i) {
    tokens_.item();
    mentions.push_back({tokens_.integer("variable", 0, header_.n_var - 1), true});
    const double coefficient = tokens_.real("coefficient");
    sum.push_back(
        graph.binary(Operation::Multiply, graph.constant(coefficient), graph.variable(mentions.back().index)));
    tokens_.close();
  }
  const std::size_t begin = tokens_.offset();
  const ExpressionKind kind =
      check_expression(tokens_, header_, defined_, defined_.group(self), self, mentions, model_.expressions);
  sum.push_back(kind.root);
  model_.expressions.definitions[at(self)] = graph.sum(sum);
  if (kind.branches) model_.anchors.push_back({begin, 0});
  defined_.define(self, terms > 0 || kind.derivative);
}

void Segments::function() {
  tokens_.integer("function", 0, header_.n_func - 1);
  tokens_.integer("type of the function", INT_MIN, INT_MAX);
  tokens_.integer("number of arguments", INT_MIN, INT_MAX);
  const std::string name = tokens_.word("name of the function");
  tokens_.close();
  tokens_.fail("the model needs the imported function " + name + ", which is not available here");
}

void Segments::suffix() {
  const int kind = tokens_.integer("kind of the suffix", 0, 7);
  const int of = kind & 3;
  const int n = of == 0 ? header_.n_var : of == 1 ? header_.n_con : of == 2 ? header_.n_obj : 1;
  const int values = tokens_.integer("number of suffix values", 1, n);
  const bool polyhedron = tokens_.word("name of the suffix") == polyhedron_suffix && of == 1;
  tokens_.close();
  for (int i = 0; i < values; ++i) {
    tokens_.item();
    const int index = tokens_.integer("index of a suffix value", 0, n - 1);
    const double value = kind & 4 ? tokens_.real("suffix value") : tokens_.integer("suffix value", INT_MIN, INT_MAX);
    if (polyhedron) polyhedron_[at(index)] = value != 0;
    tokens_.close();
  }
}

void Segments::ranges(std::vector<NlRange>& ranges, bool rows) {
  const int n = rows ? header_.n_con : header_.n_var;
  ranges.reserve(at(n));
  int conditions = 0;
  for (int i = 0; i < n; ++i) {
    ranges.push_back(range(rows ? "constraint" : "variable", rows));
    if (ranges.back().complement < 0) continue;
    ++conditions;
  }
  if (rows && conditions != header_.n_cc)
    tokens_.fail("the header declares " + std::to_string(header_.n_cc) + " complementarity conditions, the rows have " +
                 std::to_string(conditions));
}

NlRange Segments::range(const char* what, bool row) {
  NlRange r;
  const char kind = tokens_.kind();
  r.place = tokens_.place();
  r.lower = -infinity;
  r.upper = infinity;
  switch (kind) {
    case '0':
      r.lower = tokens_.real("lower bound");
      r.upper = tokens_.real("upper bound");
      break;
    case '1':
      r.upper = tokens_.real("upper bound");
      break;
    case '2':
      r.lower = tokens_.real("lower bound");
      break;
    case '3':
      break;
    case '4':
      r.lower = r.upper = tokens_.real(row ? "right-hand side" : "value of the fixed variable");
      break;
    case '5':
      if (row) {
        r.bounds = tokens_.integer("kind of complementarity", 0, 3);
        r.complement = tokens_.integer("complemented variable", 1, header_.n_var) - 1;
        break;
      }
      [[fallthrough]];
    default:
      tokens_.fail(std::string("expected the bounds of a ") + what + " (kind 0 to " + (row ? "5" : "4") +
                   "), found \"" + (kind > ' ' && kind <= '~' ? kind : '?') + "\"");
  }
  tokens_.close();
  return r;
}

void Segments::initial_guess(const char* what, int n, double* values) {
  const int given = tokens_.integer("number of initial values", 0, n);
  tokens_.close();
  for (int i = 0; i < given; ++i) {
    tokens_.item();
    const int index = tokens_.integer(what, 0, n - 1);
    const double value = tokens_.real("initial value");
    tokens_.close();
    if (values != nullptr) values[index] = value;
  }
}

void Segments::columns(bool counts) {
  const int n = tokens_.integer("number of Jacobian columns less one", 0, INT_MAX);
  if (n != header_.n_var - 1)
    tokens_.fail("segment k has " + std::to_string(n) +
                 " columns, expected n_var - 1 = " + std::to_string(header_.n_var - 1));
  tokens_.close();
  declared_columns_.assign(1, 0);
  declared_columns_.reserve(at(n) + 2);
  for (int j = 0; j < n; ++j) {
    tokens_.item();
    const int last = declared_columns_.back();
    const int value = tokens_.integer("Jacobian column length", counts ? 0 : last, header_.jacobian_nonzeros);
    tokens_.close();
    if (counts && value > header_.jacobian_nonzeros - last)
      tokens_.fail("the Jacobian columns have more than the declared " + std::to_string(header_.jacobian_nonzeros) +
                   " nonzeros");
    declared_columns_.push_back(counts ? last + value : value);
  }
  declared_columns_.push_back(header_.jacobian_nonzeros);
}

void Segments::jacobian() {
  if (!seen_k_) tokens_.fail("segment J comes before segment k");
  const int row = tokens_.integer("constraint", 0, header_.n_con - 1);
  const int n = tokens_.integer("number of Jacobian entries", 1, header_.n_var);
  if (has_jacobian_[at(row)]) tokens_.fail("second segment J" + std::to_string(row));
  has_jacobian_[at(row)] = 1;
  tokens_.close();
  if (n > header_.jacobian_nonzeros - nonzeros_)
    tokens_.fail("the J segments have more than the declared " + std::to_string(header_.jacobian_nonzeros) +
                 " nonzeros");
  nonzeros_ += n;
  std::vector<int>& variables = model_.row_variables[at(row)];
  for (int i = 0; i < n; ++i) {
    tokens_.item();
    const int j = tokens_.integer("variable", 0, header_.n_var - 1);
    const double coefficient = tokens_.real("coefficient");
    tokens_.close();
    if (last_row_[at(j)] == row)
      tokens_.fail("variable " + std::to_string(j) + " occurs twice in segment J" + std::to_string(row));
    last_row_[at(j)] = row;
    ++column_count_[at(j)];
    variables.push_back(j);
    model_.coefficients[at(row)].push_back(coefficient);
  }
}

void Segments::gradient() {
  const int k = tokens_.integer("objective", 0, header_.n_obj - 1);
  const int n = tokens_.integer("number of gradient entries", 1, header_.n_var);
  if (has_gradient_[at(k)]) tokens_.fail("second segment G" + std::to_string(k));
  has_gradient_[at(k)] = 1;
  tokens_.close();
  int last = -1;  // the library relies on the order
  for (int i = 0; i < n; ++i) {
    tokens_.item();
    const int j = tokens_.integer("variable", 0, header_.n_var - 1);
    tokens_.real("coefficient");
    tokens_.close();
    if (j <= last) tokens_.fail("the variables of segment G" + std::to_string(k) + " are not in ascending order");
    last = j;
  }
}

void Segments::finish() {
  const auto missing = [&](const std::string& what) { tokens_.fail("the file ends without " + what); };
  if (owner_ != 0) missing("the constraint or objective of its last V segment");
  if (header_.n_func > 0) missing("the F segments of " + std::to_string(header_.n_func) + " imported functions");
  if (!seen_b_) missing("segment b, the bounds of the variables");
  if (!seen_r_ && header_.n_con > 0) missing("segment r, the bounds of the constraints");
  for (int i = 0; i < header_.n_con; ++i)
    if (row_place_[at(i)] == 0) missing("segment C" + std::to_string(i));
  for (int i = 0; i < header_.n_obj; ++i)
    if (!has_objective_[at(i)]) missing("segment O" + std::to_string(i));
  for (int i = 0; i < header_.defined(); ++i)
    if (!defined_.defined(i)) missing("segment V" + std::to_string(header_.n_var + i));
  if (nonzeros_ != header_.jacobian_nonzeros)
    tokens_.fail("the header declares " + std::to_string(header_.jacobian_nonzeros) +
                 " Jacobian nonzeros, the J segments have " + std::to_string(nonzeros_));
  check_columns();
  check_mentions();
  for (std::size_t i = 0; i < polyhedron_.size(); ++i) model_.rows[i].polyhedron = polyhedron_[i] != 0;
  for (std::size_t i = 0; i < row_anchor_.size(); ++i) {
    const std::vector<int>& variables = model_.row_variables[i];
    if (row_anchor_[i] != 0) model_.anchors.push_back({row_anchor_[i], variables.empty() ? 0 : variables.front()});
  }
  std::sort(model_.anchors.begin(), model_.anchors.end(),
            [](const NlAnchor& a, const NlAnchor& b) { return a.offset < b.offset; });
}

void Segments::check_columns() const {
  std::vector<int>& start = model_.column_start;
  start.assign(1, 0);
  for (int count : column_count_) start.push_back(start.back() + count);
  for (std::size_t j = 0; seen_k_ && j < start.size(); ++j) {
    if (start[j] != declared_columns_[j])
      tokens_.fail("segment k puts " + std::to_string(declared_columns_[j]) + " nonzeros before variable " +
                   std::to_string(j) + ", the J segments " + std::to_string(start[j]));
  }
}

// A derivative goes only where the row's J segment has an entry for it.
void Segments::check_mentions() const {
  std::vector<int> listed(at(header_.n_var + header_.defined()), -1);
  std::vector<const std::vector<Mention>*> open;
  for (int row = 0; row < header_.n_con; ++row) {
    for (int j : model_.row_variables[at(row)]) listed[at(j)] = row;
    open.assign(1, &model_.mentions[at(row)]);
    while (!open.empty()) {
      const std::vector<Mention>& mentions = *open.back();
      open.pop_back();
      for (const Mention& m : mentions) {
        if (!m.derivative || listed[at(m.index)] == row) continue;
        if (m.index < header_.n_var)
          throw ModelError(bad_file, tokens_.at(row_place_[at(row)]) + ": constraint " + std::to_string(row) +
                                         " depends on variable " + std::to_string(m.index) + ", but segment J" +
                                         std::to_string(row) + " has no entry for it");
        listed[at(m.index)] = row;
        open.push_back(&model_.definitions[at(m.index - header_.n_var)]);
      }
    }
  }
}

}  // namespace

std::string NlModel::at(Place place) const {
  return header.binary ? file + ": byte " + std::to_string(place) : file + ":" + std::to_string(place);
}

std::string NlModel::segments(std::string_view bytes) const {
  std::string result;
  const auto integer = [&](char kind, int value) {
    result += kind;
    if (header.binary)
      result.append(reinterpret_cast<const char*>(&value), sizeof value);
    else
      result.append(std::to_string(value)).append("\n");
  };
  std::size_t from = header.body;
  for (const NlAnchor& anchor : anchors) {
    result.append(bytes.substr(from, anchor.offset - from));
    integer('o', 0);  // plus
    integer('o', 2);  // times
    integer('l', 0);
    integer('v', anchor.variable);
    from = anchor.offset;
  }
  return result.append(bytes.substr(from));
}

std::vector<int> NlModel::rows_using(int number) const {
  // A definition mentions only earlier ones.
  std::vector<char> uses(definitions.size(), 0);
  uses[static_cast<std::size_t>(number)] = 1;
  const auto depends = [&](const std::vector<Mention>& list) {
    return std::any_of(list.begin(), list.end(), [&](const Mention& m) {
      return m.index >= header.n_var && uses[static_cast<std::size_t>(m.index - header.n_var)];
    });
  };
  for (std::size_t d = static_cast<std::size_t>(number) + 1; d < definitions.size(); ++d)
    uses[d] = depends(definitions[d]) ? 1 : 0;
  std::vector<int> found;
  for (std::size_t i = 0; i < mentions.size(); ++i)
    if (depends(mentions[i])) found.push_back(static_cast<int>(i));
  return found;
}

NlModel check_nl(const std::string& file, std::string_view bytes) {
  NlTokens tokens(file, bytes);
  NlModel model;
  model.file = file;
  model.header = read_header(tokens, bytes.size());
  const NlHeader& h = model.header;
  if (h.n_lcon > 0)
    tokens.fail("the model has " + std::to_string(h.n_lcon) +
                " logical constraints, which no complementarity problem has");
  if (h.network_con > 0 || h.network_var > 0)
    tokens.fail("the model has network constraints or arcs, which are not supported: write them as equations");
  model.start.assign(at(h.n_var), 0.0);
  model.row_variables.resize(at(h.n_con));
  model.mentions.resize(at(h.n_con));
  model.coefficients.resize(at(h.n_con));
  model.definitions.resize(at(h.defined()));
  model.expressions.rows.resize(at(h.n_con));
  model.expressions.definitions.resize(at(h.defined()));
  Segments(tokens, model).run();
  return model;
}

}  // namespace perp::ncp::ampl
