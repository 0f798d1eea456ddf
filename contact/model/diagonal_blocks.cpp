// SPDX-License-Identifier: Apache-2.0
#include "contact/model/diagonal_blocks.hpp"

#include <algorithm>

namespace perp::contact {

DiagonalBlocks::DiagonalBlocks(const Scaled& problem) : K_(problem.W) {
  for (const Scaled::Block& block : problem.blocks) {
    sizes_.push_back(block.size);
    for (int j = 0; j < block.size; ++j) {
      const Index col = block.first + j;
      const int* begin = K_.innerIndexPtr() + K_.outerIndexPtr()[col];
      const int* end = K_.innerIndexPtr() + K_.outerIndexPtr()[col + 1];
      const auto place = std::lower_bound(begin, end, static_cast<int>(block.first)) - K_.innerIndexPtr();
      for (int i = 0; i < block.size; ++i) {
        places_.push_back(place + i);
        values_.push_back(K_.valuePtr()[place + i]);
      }
    }
  }
}

}  // namespace perp::contact
