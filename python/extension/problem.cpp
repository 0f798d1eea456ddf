// SPDX-License-Identifier: Apache-2.0
#include "extension/problem.hpp"
#include "extension/interrupt.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "ncp/ampl/model.hpp"
#include "ncp/analysis/sensitivity.hpp"
#include "ncp/collection/collection.hpp"
#include "ncp/strategy/deflation.hpp"

namespace perp::python {

AffineView::AffineView(py::handle M, Vec q, lcp::Box box)
    : q_(std::move(q)), box_(std::move(box)), M_(M, "M", q_.size(), q_.size()) {}

bool AffineView::eval(ncp::In x, ncp::Out F) const {
  F = q_;
  F.noalias() += M_.entries() * x;
  return F.allFinite();
}

bool AffineView::jacobian(ncp::In /*x*/, SpMat& J) const {
  std::copy_n(M_.entries().valuePtr(), M_.entries().nonZeros(), J.valuePtr());
  return true;
}

Use::Use(const Problem& problem) : problem_(problem) {
  if (problem.in_use_.exchange(true))
    throw std::runtime_error(
        "this problem is in use: one thread at a time uses a problem, and a problem's functions "
        "do not use the problem");
  if (FunctionMcp* functions = problem.functions()) functions->begin(nullptr);
}

Use::~Use() {
  if (FunctionMcp* functions = problem_.functions()) functions->end();
  problem_.in_use_ = false;
}

void Use::check() const {
  if (const FunctionMcp* functions = problem_.functions(); functions != nullptr && functions->failure())
    std::rethrow_exception(functions->failure());
}

Vec Problem::start_of(py::handle x0) const {
  return x0.is_none() ? starts_.front() : vector_of(x0, mcp_->size(), "x0");
}

py::object Problem::F(py::handle x) const {
  const Vec point = vector_of(x, mcp_->size(), "x");
  const Use use(*this);
  Vec F = Vec::Constant(mcp_->size(), std::numeric_limits<double>::quiet_NaN());
  const bool defined = mcp_->eval(point, F);
  use.check();
  if (!defined && F.allFinite()) F.setConstant(std::numeric_limits<double>::quiet_NaN());
  return array_of(F);
}

py::object Problem::jac(py::handle x) const {
  const Vec point = vector_of(x, mcp_->size(), "x");
  const Use use(*this);
  SpMat J = mcp_->jacobian_pattern();
  const bool defined = mcp_->jacobian(point, J);
  use.check();
  if (!defined) J.coeffs().setConstant(std::numeric_limits<double>::quiet_NaN());
  return scipy_of(J);
}

py::tuple Problem::residual(py::handle x) const {
  const Vec point = vector_of(x, mcp_->size(), "x");
  const Use use(*this);
  const ncp::Residual residual = ncp::residual(*mcp_, point);
  use.check();
  return py::make_tuple(residual.natural, residual.worst);
}

py::tuple Problem::solve(py::handle x0, const Wishes& wishes) const {
  const Vec start = start_of(x0);
  const Use use(*this);
  return solved(*mcp_, functions(), start, wishes);
}

py::tuple Problem::solve_all(py::handle x0, int solutions, const Wishes& wishes) const {
  const Vec start = start_of(x0);
  if (solutions < 1) refuse("solutions", fmt::format("is {}, and must be at least 1", solutions));
  const Use use(*this);
  Session session(*mcp_, functions(), wishes);
  session.prepare(start);
  ncp::AllSolutions all;
  const settings::Settings& settings = session.options().settings;
  const py::object interrupt = session.run([&] {
    all = ncp::solve_all(*mcp_, start, settings.method, {.solutions = solutions}, session.observer(),
                         settings.method_name);
  });
  py::list found;
  for (ncp::FoundSolution& one : all.found)
    found.append(py::make_tuple(result_of(std::move(one.result), functions(), nullptr), one.how, one.singular));
  return py::make_tuple(found, result_of(std::move(all.first), functions(), nullptr), all.attempts, all.duplicates,
                        all.message, stats_of(all.stats, functions()), interrupt);
}

namespace {

/// n x m: a matrix, or a vector of n numbers for m = 1.
SpMat derivative_of(py::handle given, Index n, Index m, const std::string& name) {
  if (!is_sparse(given)) {
    const Doubles numbers = doubles_of(given, name);
    if (numbers.ndim() == 1) return MatrixArgument(numbers.attr("reshape")(-1, 1), name, n, 1).entries();
    if (m < 0) {
      if (numbers.ndim() != 2)
        refuse(name, fmt::format("has shape {}, and must have shape ({}, m)", shape_text(numbers), n));
      m = numbers.shape(1);
    }
    return MatrixArgument(numbers, name, n, m).entries();
  }
  if (m < 0) m = shape_of(given, name).second;
  return MatrixArgument(given, name, n, m).entries();
}

py::array_t<double> matrix_array(const Eigen::MatrixXd& matrix) {
  py::array_t<double> array({matrix.rows(), matrix.cols()});
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Map<Rows>(array.mutable_data(), matrix.rows(), matrix.cols()) = matrix;
  return array;
}

}  // namespace

py::tuple Problem::sensitivity(py::handle x, py::handle dF, py::handle dlower, py::handle dupper,
                               py::handle direction) const {
  const Index n = mcp_->size();
  const Vec point = vector_of(x, n, "x");
  ncp::ParameterDerivatives parameters{.dF = derivative_of(dF, n, -1, "dF")};
  const Index m = parameters.dF.cols();
  if (!dlower.is_none()) parameters.dl = derivative_of(dlower, n, m, "dlower");
  if (!dupper.is_none()) parameters.du = derivative_of(dupper, n, m, "dupper");
  const Vec dp = direction.is_none() ? Vec() : vector_of(direction, m, "direction");
  const Use use(*this);
  ncp::Sensitivity found;
  {
    const Released released;
    found = direction.is_none() ? ncp::sensitivity(*mcp_, point, parameters)
                                : ncp::sensitivity(*mcp_, point, parameters, dp);
  }
  use.check();
  py::list states;
  for (const ncp::Activity state : found.states) states.append(std::string(to_string(state)));
  return py::make_tuple(std::string(to_string(found.status)), found.known(), found.message, matrix_array(found.dx),
                        matrix_array(found.dF), states,
                        py::array_t<Index>(static_cast<py::ssize_t>(found.degenerate.size()), found.degenerate.data()),
                        found.rcond, found.strongly_regular, found.residual.natural);
}

py::tuple Problem::check_jacobian(py::handle x) const {
  const Vec point = start_of(x);
  const Use use(*this);
  ncp::JacobianCheck check;
  {
    const Released released;
    check = ncp::check_jacobian(*mcp_, point);
  }
  use.check();
  if (!check.defined) refuse("x", "F or jac is not defined there, or nowhere near");
  return py::make_tuple(check.worst, check.row, check.col, check.given, check.difference, check.outside_pattern,
                        ncp::describe(*mcp_, check));
}

py::tuple Problem::verify(py::handle x) const {
  const Vec point = vector_of(x, mcp_->size(), "x");
  const Use use(*this);
  ncp::Verified found;
  {
    const Released released;
    found = ncp::verify(*mcp_, point);
  }
  use.check();
  return verified_of(found);
}

std::unique_ptr<Problem> read_nl(const std::string& path) {
  std::unique_ptr<ncp::ampl::Model> model;
  {
    const Released released;
    model = ncp::ampl::read_model(path);
  }
  Vec start = model->start();
  auto problem = std::make_unique<Problem>(std::move(model), std::move(start));
  problem->made_by = path;
  return problem;
}

std::unique_ptr<Problem> from_collection(const std::string& name) {
  const ncp::collection::Entry* entry = ncp::collection::find(name);
  if (entry == nullptr) {
    const auto near = ncp::collection::similar(name);
    refuse("name", "there is no problem '" + name + "' in the collection" + settings::did_you_mean(name, near));
  }
  ncp::collection::Problem made = entry->make();
  auto problem = std::make_unique<Problem>(std::move(made.mcp), std::move(made.starts));
  problem->made_by = entry->source;
  return problem;
}

}  // namespace perp::python
