#pragma once
/// The errors of polygons over K, doubly logarithmic: a panel for each error, all of one scale, with guides that fall
/// like 1/K and 1/K^2. Polygons in the disk and about it differ in colour (Okabe & Ito's, which colour-blind people can
/// tell apart), in dashes and in the mark; the fitted power stands at each line's end.
#include <string>

#include "app/contact/studies/facets.hpp"

namespace perp::app::contacts {

std::string facets_svg(const FacetStudy& study);

}  // namespace perp::app::contacts
