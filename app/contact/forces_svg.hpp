// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The impulses of a run in their friction cones, seen from above: contact by contact the disk |r_T| <= mu r_N, all
/// drawn of one size, with r_T in it and r_N as a bar beside it; and all of them in one disk. What sticks, slips or is
/// open differs in colour (Okabe & Ito's, which colour-blind people can tell apart), in the shape of the mark and in
/// the rim. In 2D the disk is an interval.
#include <string>

#include "app/contact/run/run.hpp"

namespace perp::app::contacts {

/// Beyond these only the contacts with the largest r_N are drawn.
inline constexpr lcp::Index most_drawn = 3000;

std::string forces_svg(const Loaded& loaded, const Run& run);

}  // namespace perp::app::contacts
