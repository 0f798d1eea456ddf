#pragma once
/// The paths of the ball under the cyclic load, seen from above, over each other: a panel for each load, and a closer
/// view where some paths are so long that others would be small. Laws differ in colour (Okabe & Ito's, which
/// colour-blind people can tell apart), in dashes and in the mark at the end of each cycle; Coulomb's law is black and
/// wide.
#include <span>
#include <string>

#include "app/contact/studies/ball.hpp"

namespace perp::app::contacts {

std::string ball_svg(std::span<const BallScene> scenes);

}  // namespace perp::app::contacts
