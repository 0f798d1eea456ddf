#pragma once
/// Options of a variant's method, key=value (`--option`): those of `perp methods` for methods of ncp/ and lcp/, and of
/// contact/ its own (contact::describe): of auto, of homotopy, and of glocker by another method.
#include <string>

#include "app/contact/run/variant.hpp"

namespace perp::app::contacts {

/// Sets what the variant's options say in its solver, and the notes. Throws InputError naming key, value and what is
/// known: no such key, a value that makes no sense, an option that a flag sets (--method, --tol, --time-limit), a
/// variant whose method has none.
void set_options(Variant& variant);

/// The keys of auto beside the homotopy's, of the homotopy, and of Glocker's NCP, as --help writes them.
std::string auto_keys();
std::string homotopy_keys();
std::string glocker_keys();

}  // namespace perp::app::contacts
