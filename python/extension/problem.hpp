// SPDX-License-Identifier: Apache-2.0
#pragma once
/// perp.Problem's other half: a problem from functions, data, a file or the collection, and what can be done with it.
#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "extension/session.hpp"

namespace perp::python {

/// An affine problem whose matrix stays where Python has it.
class AffineView final : public ncp::Mcp {
 public:
  /// M n x n where q has n entries.
  AffineView(py::handle M, Vec q, lcp::Box box);
  const lcp::Box& box() const override { return box_; }
  const SpMat& jacobian_pattern() const override { return M_.entries(); }
  bool eval(ncp::In x, ncp::Out F) const override;
  bool jacobian(ncp::In x, SpMat& J) const override;
  bool is_affine() const override { return true; }
  std::string name() const override { return "affine"; }

 private:
  Vec q_;
  lcp::Box box_;
  MatrixArgument M_;
};

class Problem {
 public:
  Problem(std::unique_ptr<ncp::Mcp> mcp, Vec start) : mcp_(std::move(mcp)), starts_{std::move(start)} {}
  Problem(std::unique_ptr<ncp::Mcp> mcp, std::vector<Vec> starts) : mcp_(std::move(mcp)), starts_(std::move(starts)) {}

  ncp::Mcp& mcp() const { return *mcp_; }
  /// Of a problem of functions, else null.
  FunctionMcp* functions() const { return dynamic_cast<FunctionMcp*>(mcp_.get()); }
  const std::vector<Vec>& starts() const { return starts_; }
  /// x0, or the problem's own start where it is None.
  Vec start_of(py::handle x0) const;

  py::object F(py::handle x) const;
  py::object jac(py::handle x) const;
  py::tuple residual(py::handle x) const;
  py::tuple solve(py::handle x0, const Wishes& wishes) const;
  py::tuple solve_all(py::handle x0, int solutions, const Wishes& wishes) const;
  py::tuple sensitivity(py::handle x, py::handle dF, py::handle dlower, py::handle dupper, py::handle direction) const;
  py::tuple check_jacobian(py::handle x) const;
  py::dict inspect(py::handle x0) const;
  py::tuple verify(py::handle x) const;

  std::string made_by{};  ///< where it is from, in words

 private:
  friend class Use;
  std::unique_ptr<ncp::Mcp> mcp_;
  std::vector<Vec> starts_;
  mutable std::atomic<bool> in_use_{false};
};

/// One thread at a time uses a problem; another one hears so.
class Use {
 public:
  explicit Use(const Problem& problem);
  ~Use();
  Use(const Use&) = delete;
  Use& operator=(const Use&) = delete;
  /// Throws what a function has thrown.
  void check() const;

 private:
  const Problem& problem_;
};

std::unique_ptr<Problem> read_nl(const std::string& path);
std::unique_ptr<Problem> from_collection(const std::string& name);

/// The functions of perp.contact.
void define_contact(py::module_& module);

}  // namespace perp::python
