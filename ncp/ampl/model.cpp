// SPDX-License-Identifier: Apache-2.0
#include "ncp/ampl/model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lcp/io/file_path.hpp"
#include "lcp/io/output_file.hpp"
#include "lcp/vi/polyhedron.hpp"
#include "ncp/ampl/asl_problem.hpp"
#include "ncp/ampl/exchanged.hpp"
#include "ncp/ampl/linearity.hpp"
#include "ncp/ampl/model_enclosure.hpp"
#include "ncp/ampl/names.hpp"
#include "ncp/ampl/nl_check.hpp"
#include "ncp/ampl/pairing.hpp"
#include "ncp/ampl/sol.hpp"
#include "ncp/interval/undefined.hpp"

namespace perp::ncp::ampl {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// The path without its ".nl".
std::string stub_of(const std::string& path) { return path.ends_with(".nl") ? path.substr(0, path.size() - 3) : path; }

std::string file_name(const std::string& path) {
  const std::u8string name = lcp::file_path(path).filename().u8string();
  return {name.begin(), name.end()};
}

SolFormat sol_format(const NlHeader& header) {
  return {header.binary, header.options, header.tolerance, header.n_con, header.n_var};
}

AslProblem::Sizes sizes_of(const NlHeader& h) {
  return {h.n_var, h.n_con, h.n_obj, h.n_cc, h.jacobian_nonzeros, h.defined(), h.binary};
}

/// STUB.sol, unless it is, by a link, one of the model's own files.
void write_answer(const std::string& stub, const std::string& content) {
  const std::string path = stub + ".sol";
  for (const char* ending : {".nl", ".col", ".row"})
    if (lcp::same_file(path, stub + ending))
      throw ModelError(bad_file, path + ": cannot be written: it is the input " + stub + ending);
  write_whole(path, content);
}

class AslModel final : public Model {
 public:
  AslModel(const std::string& stub, const std::string& bytes, NlModel nl, Names names)
      : stub_(stub),
        nl_(std::move(nl)),
        names_(std::move(names)),
        pairing_(pair(nl_, names_)),
        jacobian_(map_jacobian(nl_, pairing_)),
        affine_(std::ranges::all_of(nl_.mentions, [](const auto& row) { return row.empty(); })),
        linear_(ampl::linear_entries(nl_, pairing_, jacobian_)),
        enclosure_(model_enclosure(nl_, pairing_, jacobian_)),
        asl_(stub, nl_.segments(bytes), sizes_of(nl_.header)),
        start_(Vec::Zero(pairing_.box.size())),
        rows_(nl_.rows.size(), 0.0),
        nonzeros_(at(nl_.header.jacobian_nonzeros), 0.0) {
    point_.assign(at(nl_.header.n_var), 0.0);
    for (Index u = 0; u < n_var(); ++u) start_[u] = nl_.start[at(pairing_.variables[at(u)])];
    if (pairing_.multipliers > 0) C_ = polyhedron_of_multipliers();
    all_used_ = std::find(pairing_.used.begin(), pairing_.used.end(), 0) == pairing_.used.end();
  }

  const Box& box() const override { return pairing_.box; }
  const SpMat& jacobian_pattern() const override { return jacobian_.pattern; }
  bool eval(In x, Out F) const override;
  bool jacobian(In x, SpMat& J) const override;

  bool is_affine() const override { return affine_; }
  std::vector<bool> linear_entries() const override { return linear_; }
  const Enclosure* enclosure() const override { return enclosure_.get(); }
  std::optional<Expressions> expressions() const override { return model_expressions(nl_, pairing_); }
  const lcp::Polyhedron* polyhedron() const override { return C_ ? &*C_ : nullptr; }
  std::string name() const override { return file_name(stub_); }
  std::string variable_name(Index i) const override { return unknown_name(pairing_, names_, i); }
  std::string equation_name(Index i) const override { return ampl::equation_name(pairing_, names_, i); }

  const Vec& start() const override { return start_; }
  Index n_var() const override { return static_cast<Index>(pairing_.variables.size()); }
  Index side_inequalities() const override { return size() - n_var() - pairing_.multipliers; }
  bool has_names() const override { return names_.complete(); }
  bool has_objective() const override { return nl_.header.n_obj > 0; }
  std::vector<Computed> computed(In x) const override;
  std::vector<std::string> remarks() const override;
  void write_sol(const std::string& message, In x, int solve_result_num) const override;

 private:
  /// The model's variables, auxiliary ones 0.
  const double* point(In x) const {
    for (std::size_t u = 0; u < pairing_.variables.size(); ++u)
      point_[at(pairing_.variables[u])] = x[static_cast<Index>(u)];
    return point_.data();
  }
  lcp::Polyhedron polyhedron_of_multipliers() const;
  /// c(x); in the rows known to be undefined NaN, or infinity (of whatever sign) after an overflow. false: rows were
  /// left out.
  bool values_of_rows(In x) const;
  /// v at the x of values_of_rows(); nan where that is not defined.
  double value_of(const Auxiliary& v) const { return (v.bound - rows_[at(v.row)]) / v.coefficient; }

  std::string stub_;
  NlModel nl_;
  Names names_;
  Pairing pairing_;
  JacobianMap jacobian_;
  bool affine_;  // no row's expression mentions a variable: all of them are constants
  std::vector<bool> linear_;
  std::unique_ptr<Enclosure> enclosure_;
  AslProblem asl_;
  Vec start_;
  std::optional<lcp::Polyhedron> C_{};
  bool all_used_ = true;                  // every row takes part in F
  mutable std::vector<double> point_;     // see point()
  mutable std::vector<double> rows_;      // c(x); not finite where it is not defined
  mutable std::vector<double> nonzeros_;  // of c'(x)
};

bool AslModel::values_of_rows(In x) const {
  if (asl_.values(point(x), rows_.data())) return true;
  const AslProblem::RowByRow outcome = asl_.values_by_row(point_.data(), rows_.data());
  if (!outcome.evaluated) {
    std::fill(rows_.begin(), rows_.end(), 0.0);
    if (outcome.definition < nl_.header.defined())
      for (int i : nl_.rows_using(outcome.definition)) rows_[at(i)] = outcome.definition_overflow ? infinity : nan;
    return false;
  }
  for (std::size_t i = 0; i < rows_.size(); ++i)
    if (!outcome.defined[i]) rows_[i] = outcome.overflow[i] ? infinity : nan;
  return true;  // an undefined row that is not used does no harm
}

bool AslModel::eval(In x, Out F) const {
  bool defined = values_of_rows(x);
  for (Index u = 0; u < size(); ++u) {
    const Equation& e = pairing_.equations[at(u)];
    const double v = e.of_row ? rows_[at(e.index)] : point_[at(e.index)];
    F[u] = e.sign * (v - e.bound) - (e.side ? x[u] : 0.0);
    if (e.condition >= 0) F[u] += rows_[at(e.condition)];
  }
  if (pairing_.multipliers > 0) F += pairing_.forces * x;
  return defined && F.allFinite();
}

/// Each multiplier has a row and one side of it, b <= A x; a constant of the row is in b.
lcp::Polyhedron AslModel::polyhedron_of_multipliers() const {
  const Index m = pairing_.multipliers, n = size() - m;
  const SpMat forces = pairing_.forces.topRightCorner(n, m);
  const PointValues constants(nl_.expressions.graph, std::vector<double>(nl_.variables.size(), 0));
  lcp::Polyhedron C{.A = -SpMat(forces.transpose()),
                    .rows = {Vec(m), Vec::Constant(m, infinity)},
                    .box = {box().lower.head(n), box().upper.head(n)}};
  for (Index k = 0; k < m; ++k) {
    const Equation& e = pairing_.equations[at(n + k)];
    C.rows.lower[k] = e.sign * (e.bound - constants[nl_.expressions.rows[at(e.index)]]);
    if (!std::isfinite(C.rows.lower[k]))
      throw ModelError(bad_file, nl_.at(nl_.rows[at(e.index)].place) + ": the constant of constraint " +
                                     names_.row(e.index) + ", a row of the polyhedron, is not defined");
    if (box().is_free(n + k)) C.rows.upper[k] = C.rows.lower[k];
  }
  return C;
}

bool AslModel::jacobian(In x, SpMat& J) const {
  if (!asl_.jacobian(point(x), nonzeros_.data()) &&
      (all_used_ || !asl_.jacobian_of(pairing_.used, point_.data(), nonzeros_.data())))
    return false;
  double* values = J.valuePtr();
  for (std::size_t k = 0; k < jacobian_.entries.size(); ++k) {
    const JacobianMap::Entry& entry = jacobian_.entries[k];
    values[k] = entry.nonzero < 0 ? entry.factor : entry.factor * nonzeros_[at(entry.nonzero)];
    if (!std::isfinite(values[k])) return false;
  }
  return true;
}

std::vector<std::string> AslModel::remarks() const {
  std::vector<std::string> text;
  if (has_objective())
    text.emplace_back("the objective is not used: the conditions of a square model determine its solution");
  if (std::string pairs = exchanged(pairing_, jacobian_, names_); !pairs.empty()) text.push_back(std::move(pairs));
  const std::string conditions = twice(nl_, pairing_, names_), sides = without_row(nl_, names_);
  if (!conditions.empty() || !sides.empty())
    text.push_back(conditions + (conditions.empty() || sides.empty() ? "" : "; ") + sides);
  return text;
}

std::vector<Model::Computed> AslModel::computed(In x) const {
  std::vector<Computed> all;
  if (pairing_.auxiliaries.empty()) return all;
  const bool defined = values_of_rows(x);
  for (const Auxiliary& v : pairing_.auxiliaries) {
    const std::string name = names_.variable(v.variable), row = names_.row(v.row);
    const std::string condition = name.substr(0, name.rfind('.'));
    if (condition.size() < name.size() && (row == condition + ".bc" || row == condition + ".ve")) continue;
    all.push_back({name, row, defined ? value_of(v) : nan});
  }
  return all;
}

void AslModel::write_sol(const std::string& message, In x, int solve_result_num) const {
  const std::string path = stub_ + ".sol";
  if (x.size() != n_var())
    throw ModelError(bad_file, path + ": x has " + std::to_string(x.size()) + " entries, the model has " +
                                   std::to_string(n_var()) + " variables");
  for (Index i = 0; i < x.size(); ++i)
    if (!std::isfinite(x[i])) throw ModelError(bad_file, path + ": " + variable_name(i) + " is " + number(x[i]));
  const bool defined = pairing_.auxiliaries.empty() || values_of_rows(x);
  point(x);
  std::vector<double> all = point_;
  for (const Auxiliary& v : pairing_.auxiliaries) {
    const double value = value_of(v);
    all[at(v.variable)] = defined && std::isfinite(value) ? value : nl_.start[at(v.variable)];
  }
  write_answer(stub_, sol_text(sol_format(nl_.header), message, all, solve_result_num));
}

}  // namespace

std::unique_ptr<Model> read_model(const std::string& path) {
  const std::string stub = stub_of(path);
  const std::string file = stub + ".nl";
  const std::string bytes = read_file(file);
  NlModel nl = check_nl(file, bytes);
  const Names names(stub, nl.header.n_var, nl.header.n_con);
  try {
    return std::make_unique<AslModel>(stub, bytes, std::move(nl), names);
  } catch (const ModelError& refused) {
    if (names.complete()) throw;
    std::vector<std::string> parts = refused.parts();
    parts.emplace_back(advice_on_names);
    throw ModelError(refused.code(), std::string(refused.what()) + "; " + advice_on_names, std::move(parts));
  }
}

void write_failed_sol(const std::string& path, const std::string& message, int solve_result_num) {
  const std::string stub = stub_of(path);
  SolFormat format;
  try {
    const std::string bytes = read_file(stub + ".nl");
    NlTokens tokens(stub + ".nl", bytes);
    format = sol_format(read_header(tokens, bytes.size()));
  } catch (const ModelError&) {
    // Text without sizes then: the caller says why in its message.
  }
  write_answer(stub, sol_text(format, message, {}, solve_result_num));
}

}  // namespace perp::ncp::ampl
