// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Whether a solver is better off with the entries of W = H' M^-1 H or with its parts (delassus.hpp). This is told
/// before any number of either, from the patterns of W and of the bodies' matrix M + H E H' and the symbolic analysis
/// of their Cholesky factors. Private to contact/.
#include "contact/model/scaling.hpp"

namespace perp::contact {

/// Whether the operations of a solve are fewer with the entries of W: those of Cholesky's factorization, of solves with
/// its factors, which by bodies are refined, and of products. Never where W has more than three times the entries of H,
/// M and M's factor, for which no more than so many are counted.
bool entries_take_less(const DelassusParts& parts, const std::vector<Scaled::Block>& blocks);

}  // namespace perp::contact
