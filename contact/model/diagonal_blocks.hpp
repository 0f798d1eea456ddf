// SPDX-License-Identifier: Apache-2.0
#pragma once
/// W + diag(B_a), B_a one block a contact, on the pattern of W: what a Newton step of a homotopy leaves once the
/// multipliers of each contact are eliminated. Private to contact/.
#include <vector>

#include "contact/model/scaling.hpp"

namespace perp::contact {

class DiagonalBlocks {
 public:
  explicit DiagonalBlocks(const Scaled& problem);
  /// Adds B_a = block(a), of whose rows and columns the contact's count, and `shift` on the diagonal; to W itself, not
  /// to what was there before.
  template <class Block>
  const SpMat& with(double shift, const Block& block) {
    std::size_t k = 0;
    for (std::size_t a = 0; a < sizes_.size(); ++a) {
      const Eigen::Matrix3d B = block(a);
      for (int j = 0; j < sizes_[a]; ++j)
        for (int i = 0; i < sizes_[a]; ++i, ++k)
          K_.valuePtr()[places_[k]] = values_[k] + B(i, j) + (i == j ? shift : 0);
    }
    return K_;
  }

 private:
  SpMat K_;
  std::vector<int> sizes_;      // of the blocks
  std::vector<Index> places_;   // of their entries in K's values, column by column
  std::vector<double> values_;  // theirs in W
};

}  // namespace perp::contact
