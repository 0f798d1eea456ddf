// SPDX-License-Identifier: Apache-2.0
#include "contact/laws/first_ncp.hpp"

#include <algorithm>
#include <sstream>

#include "contact/model/checks.hpp"
#include "lcp/words.hpp"

namespace perp::contact {
FirstNcp::FirstNcp(const Problem& problem, bool scale) : dimension_(problem.dimension), mu_(problem.mu) {
  check(problem);
  check_no_rolling("the first NCP", problem);
  units_ = scale ? Units::of(problem.W, problem.q) : Units::none();
  W_ = problem.W.matrix() * (units_.impulse / units_.velocity);
  q_ = problem.q / units_.velocity;
  name_ = "first NCP";
  if (!problem.name.empty()) name_.append(" of ").append(problem.name);
  Index size = 0;
  unknown_.assign(at(q_.size()), -1);
  for (Index a = 0; a < mu_.size(); ++a) {
    first_.push_back(size);
    const Index impulses = frictional(a) ? dimension_ : 1;
    for (Index c = 0; c < impulses; ++c) unknown_[at(dimension_ * a + c)] = size + c;
    size += frictional(a) ? dimension_ + 1 : 1;
  }
  box_ = ncp::Box::nonnegative(size);
  std::vector<Eigen::Triplet<double, int>> entries;
  const auto entry = [&entries](Index i, Index j) {
    entries.emplace_back(static_cast<int>(i), static_cast<int>(j), 0.);
  };
  for (Index j = 0; j < W_.cols(); ++j)
    for (SpMat::InnerIterator it(W_, j); it; ++it)
      if (unknown_[at(j)] >= 0 && unknown_[at(it.row())] >= 0) entry(unknown_[at(it.row())], unknown_[at(j)]);
  for (Index a = 0; a < mu_.size(); ++a) {
    const Index r_N = first_[at(a)];
    entry(r_N, r_N);
    for (Index i = r_N + 1; frictional(a) && i < kappa(a); ++i) {
      box_.lower[i] = -lcp::infinity;
      for (Index j = r_N; j <= kappa(a); ++j) entry(i, j);
      entry(kappa(a), i);
    }
    if (frictional(a)) entry(kappa(a), r_N);
  }
  pattern_ = SpMat(size, size);
  pattern_.setFromTriplets(entries.begin(), entries.end());
}

Vec FirstNcp::impulses(In x) const {
  Vec r = Vec::Zero(q_.size());
  for (Index i = 0; i < r.size(); ++i)
    if (unknown_[at(i)] >= 0) r[i] = x[unknown_[at(i)]];
  return r;
}

bool FirstNcp::eval(In x, lcp::Out F) const {
  const Vec r = impulses(x);
  const Vec u = W_ * r + q_;
  const Index T = dimension_ - 1;
  for (Index a = 0; a < mu_.size(); ++a) {
    const Index r_N = first_[at(a)];
    F[r_N] = u[dimension_ * a];
    if (!frictional(a)) continue;
    const auto r_T = r.segment(dimension_ * a + 1, T);
    F.segment(r_N + 1, T) = x[kappa(a)] * r_T + mu_[a] * r[dimension_ * a] * u.segment(dimension_ * a + 1, T);
    F[kappa(a)] = mu_[a] * r[dimension_ * a] - r_T.norm();
  }
  return F.allFinite();
}

bool FirstNcp::jacobian(In x, SpMat& J) const {
  const Vec r = impulses(x);
  const Vec u = W_ * r + q_;
  const Index T = dimension_ - 1;
  J.coeffs().setZero();
  for (Index j = 0; j < W_.cols(); ++j)
    for (SpMat::InnerIterator it(W_, j); it; ++it) {
      const Index row = unknown_[at(it.row())];
      if (row < 0 || unknown_[at(j)] < 0) continue;
      const Index a = it.row() / dimension_;
      const bool normal = it.row() % dimension_ == 0;
      J.coeffRef(row, unknown_[at(j)]) = (normal ? 1 : mu_[a] * r[dimension_ * a]) * it.value();
    }
  for (Index a = 0; a < mu_.size(); ++a) {
    if (!frictional(a)) continue;
    const Index r_N = first_[at(a)];
    const Index k = kappa(a);
    const Vec r_T = r.segment(dimension_ * a + 1, T);
    const double length = r_T.norm();
    const Vec direction = length > 0 ? Vec(r_T / length) : Vec::Zero(T);
    J.coeffRef(k, r_N) = mu_[a];
    for (Index t = 0; t < T; ++t) {
      const Index i = r_N + 1 + t;
      J.coeffRef(k, i) = -direction[t];
      J.coeffRef(i, k) = r_T[t];
      J.coeffRef(i, i) += x[k];
      J.coeffRef(i, r_N) += mu_[a] * u[dimension_ * a + 1 + t];
    }
  }
  return J.coeffs().allFinite();
}

/// The rows of u_N; in those of sigma, r_N.
std::vector<bool> FirstNcp::linear_entries() const {
  std::vector<bool> normal(at(size()), false);
  for (const Index i : first_) normal[at(i)] = true;
  std::vector<bool> flags;
  flags.reserve(at(pattern_.nonZeros()));
  for (Index j = 0; j < pattern_.cols(); ++j)
    for (SpMat::InnerIterator it(pattern_, j); it; ++it) {
      const bool slack_of_r_N = box_.lower[it.row()] == 0 && normal[at(j)];
      flags.push_back(normal[at(it.row())] || slack_of_r_N);
    }
  return flags;
}

std::string FirstNcp::label(Index i, const char* normal, const char* tangential, const char* last) const {
  const auto next = std::upper_bound(first_.begin(), first_.end(), i);
  const Index a = static_cast<Index>(next - first_.begin()) - 1;
  const Index c = i - first_[at(a)];
  std::ostringstream text;
  text << (c == 0 ? normal : c == dimension_ ? last : tangential);
  if (c > 0 && c < dimension_) text << c;
  text << "[" << a << "]";
  return text.str();
}

std::string FirstNcp::variable_name(Index i) const { return label(i, "r_N", "r_T", "kappa"); }
std::string FirstNcp::equation_name(Index i) const { return label(i, "u_N", "slip_T", "sigma"); }

Vec FirstNcp::start() const {
  Vec x = Vec::Zero(size());
  for (Index a = 0; a < mu_.size(); ++a) {
    x[first_[at(a)]] = 1;
    if (frictional(a)) x[kappa(a)] = 1;
  }
  return x;
}

Solution FirstNcp::recover(In x) const {
  if (x.size() != size()) {
    refuse_input(name_, ": the point has ", x.size(), " entries, the problem ", size());
  }
  const Vec r = impulses(x);
  return {units_.impulse * r, units_.velocity * (W_ * r + q_)};
}

}  // namespace perp::contact
