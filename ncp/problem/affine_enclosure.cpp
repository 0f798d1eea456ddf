// SPDX-License-Identifier: Apache-2.0
#include "ncp/problem/affine_enclosure.hpp"

#include <algorithm>

namespace perp::ncp {
namespace {

using lcp::at;
using lcp::Index;

class AffineEnclosure final : public Enclosure {
 public:
  explicit AffineEnclosure(const lcp::AffineMcp& problem) : problem_(problem) {}

  void values(std::span<const Interval> X, std::span<Interval> F, std::span<char> defined) const override {
    std::ranges::fill(defined, 1);
    std::copy_n(problem_.q.data(), F.size(), F.begin());
    for (Index j = 0; j < problem_.M.cols(); ++j)
      for (lcp::SpMat::InnerIterator it(problem_.M, j); it; ++it) F[at(it.row())] += it.value() * X[at(j)];
  }

  void jacobian(std::span<const Interval>, std::span<Interval> J, std::span<char> known) const override {
    std::copy_n(problem_.M.valuePtr(), J.size(), J.begin());
    std::ranges::fill(known, 1);
  }

 private:
  const lcp::AffineMcp& problem_;
};

}  // namespace

std::unique_ptr<Enclosure> affine_enclosure(const lcp::AffineMcp& problem) {
  return std::make_unique<AffineEnclosure>(problem);
}

}  // namespace perp::ncp
