// SPDX-License-Identifier: Apache-2.0
#include "contact/model/forms.hpp"

#include <utility>
#include <vector>

namespace perp::contact {
namespace {

/// Spheres, walls, arches, stacks, chains and inclines of 10 to 3,000 contacts get the form that takes fewer
/// instructions: chains and up to 200 spheres, with ratios up to 2.05, are solved by entries, all others, above 2.12,
/// by bodies.
constexpr double most_entries = 2.1;

/// Counts the entries of W, in blocks of contacts that share a body, until there are more than `most`.
double entries_of_W(const SpMat& shares, const std::vector<Scaled::Block>& blocks, double most) {
  std::vector<std::vector<std::size_t>> contacts(at(shares.rows()));  // of each body
  const auto for_bodies = [&](const Scaled::Block& block, const auto& take) {
    for (int k = 0; k < block.size; ++k)
      for (SpMat::InnerIterator it(shares, block.first + k); it; ++it) take(contacts[at(it.row())]);
  };
  for (std::size_t a = 0; a < blocks.size(); ++a)
    for_bodies(blocks[a], [a](std::vector<std::size_t>& of_body) {
      if (of_body.empty() || of_body.back() != a) of_body.push_back(a);
    });
  std::vector<std::size_t> seen(blocks.size(), blocks.size());  // with which contact last
  double entries = 0;
  for (std::size_t a = 0; a < blocks.size() && entries <= most; ++a)
    for_bodies(blocks[a], [&](const std::vector<std::size_t>& of_body) {
      for (const std::size_t b : of_body)
        if (std::exchange(seen[b], a) != a) entries += blocks[a].size * blocks[b].size;
    });
  return entries;
}

}  // namespace

bool entries_take_less(const DelassusParts& parts, const std::vector<Scaled::Block>& blocks) {
  if (blocks.empty()) return false;
  const double most = most_entries * (static_cast<double>(parts.H().nonZeros() + parts.M().nonZeros()) +
                                      parts.inertia().entries_of_factor());
  return entries_of_W(parts.shares(), blocks, most) <= most;
}

}  // namespace perp::contact
