// SPDX-License-Identifier: Apache-2.0
#include "ncp/problem/lifted_vi.hpp"

#include <string>
#include <vector>

#include "lcp/words.hpp"

namespace perp::ncp {
namespace {

class LiftedVi final : public Mcp {
 public:
  /// The linear part is that of M = 0, q = 0.
  LiftedVi(const Mcp& mcp, const lcp::Polyhedron& C, int first)
      : mcp_(mcp),
        C_(C),
        first_(first),
        linear_(lcp::lifted({SpMat(mcp.size(), mcp.size()), Vec::Zero(mcp.size()), C})),
        J_(mcp.jacobian_pattern()),
        F_(mcp.size()) {
    // Each entry remembers where it comes from: k of J's pattern, or the linear part.
    const Index n = mcp_.size();
    SpMat marked = J_;
    for (Index k = 0; k < marked.nonZeros(); ++k) marked.valuePtr()[k] = static_cast<double>(k + 1);
    marked.conservativeResize(linear_.size(), linear_.size());
    SpMat linear = linear_.M;
    for (Index k = 0; k < linear.nonZeros(); ++k) linear.valuePtr()[k] = 0;
    pattern_ = marked + linear;
    pattern_.makeCompressed();
    source_.resize(lcp::at(pattern_.nonZeros()));
    const std::vector<bool> flags = mcp_.linear_entries();
    linear_entries_.assign(source_.size(), true);
    for (Index j = 0, at_entry = 0; j < pattern_.cols(); ++j)
      for (SpMat::InnerIterator it(pattern_, j); it; ++it, ++at_entry) {
        const bool of_F = it.row() < n && j < n;
        const auto k = static_cast<Index>(it.value()) - 1;
        source_[lcp::at(at_entry)] = of_F ? k : -1;
        constant_.push_back(of_F ? 0 : linear_.M.coeff(it.row(), j));
        if (of_F) linear_entries_[lcp::at(at_entry)] = !flags.empty() && flags[lcp::at(k)];
      }
  }

  const Box& box() const override { return linear_.box; }
  const SpMat& jacobian_pattern() const override { return pattern_; }
  bool eval(In z, Out F) const override {
    F = linear_.q;
    F.noalias() += linear_.M * z;
    if (!mcp_.eval(z.head(mcp_.size()), F_)) return false;
    F.head(mcp_.size()) += F_;
    return F.allFinite();
  }
  bool jacobian(In z, SpMat& J) const override {
    if (!mcp_.jacobian(z.head(mcp_.size()), J_)) return false;
    for (std::size_t k = 0; k < source_.size(); ++k)
      J.valuePtr()[k] = source_[k] >= 0 ? J_.valuePtr()[source_[k]] : constant_[k];
    return true;
  }
  bool is_affine() const override { return mcp_.is_affine(); }
  std::vector<bool> linear_entries() const override { return linear_entries_; }
  const lcp::Polyhedron* polyhedron() const override { return &C_; }
  JacobianWork jacobian_work() const override { return mcp_.jacobian_work(); }
  std::string name() const override { return mcp_.name(); }
  std::string variable_name(Index i) const override {
    return i < mcp_.size() ? mcp_.variable_name(i) : row_name("lambda", "s", i);
  }
  std::string equation_name(Index i) const override {
    return i < mcp_.size() ? mcp_.equation_name(i) : row_name("A", "lambda", i);
  }

 private:
  /// Names a multiplier, or the s of a row.
  std::string row_name(const char* multiplier, const char* s, Index i) const {
    const Index k = i - mcp_.size(), m = C_.A.rows();
    const Index row = k < m ? k : SpMat::InnerIterator(pattern_, i).row() - mcp_.size();  // the one entry of its column
    std::string name = k < m ? multiplier : s;
    return name.append("[").append(std::to_string(row + first_)).append("]");
  }

  const Mcp& mcp_;
  lcp::Polyhedron C_;
  int first_;
  lcp::AffineMcp linear_;
  SpMat pattern_{};
  std::vector<Index> source_{};
  std::vector<double> constant_{};
  std::vector<bool> linear_entries_{};
  mutable SpMat J_;
  mutable Vec F_;
};

}  // namespace

std::unique_ptr<Mcp> lifted(const Mcp& mcp, const SpMat& A, const Box& rows, int first) {
  lcp::Polyhedron C{.A = A, .rows = rows, .box = mcp.box()};
  if (const auto why = C.invalid()) refuse_input(*why);
  return std::make_unique<LiftedVi>(mcp, C, first);
}

Vec lifted_point(const Mcp& lifted, In x, In lambda) {
  const lcp::Polyhedron& C = *lifted.polyhedron();
  Vec z = Vec::Zero(lifted.size());
  z.head(x.size()) = x;
  z.segment(x.size(), lambda.size()) = lambda;
  const Vec Ax = C.A * x;
  const SpMat& pattern = lifted.jacobian_pattern();
  for (Index s = x.size() + C.A.rows(); s < z.size(); ++s)  // its column has the one entry of its row
    for (SpMat::InnerIterator it(pattern, s); it; ++it) z[s] = Ax[it.row() - x.size()];
  return lcp::project(lifted.box(), z);
}

}  // namespace perp::ncp
