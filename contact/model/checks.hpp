// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Parts of check(Problem), private to contact/. Each throws std::invalid_argument with what, where and the value.
#include <string>
#include <vector>

#include "contact/model/problem.hpp"

namespace perp::contact {

void check(const Global& global, Index rows);  ///< rows = d n
void check_friction(const Vec& mu);
void check_dimension(int dimension);                                ///< without rolling friction
void check_rolling(int dimension, const Vec& mu, const Vec& mu_r);  ///< with it or without

/// Refuses rolling friction, for methods that know contacts with one disk alone.
void check_no_rolling(const char* who, const Problem& problem);

/// "contact 3", "contacts 3 and 7", "contacts 1, 2, 3, 5, 8 and 9 more", the first of all having this number.
std::string contacts_text(const std::vector<Index>& contacts, Index first);

}  // namespace perp::contact
