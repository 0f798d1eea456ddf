#pragma once
/// Options of a variant's method, key=value (`--option`): those of `perp methods` for methods of ncp/ and lcp/, and of
/// contact/ its own: of auto and of homotopy the fields of contact::Auto, contact::GlockerHomotopy and
/// contact::HomotopyOptions, of glocker by another method also delta, eps, stages and scaling of contact::GlockerNcp.
#include <string>
#include <vector>

#include "app/contact/variant.hpp"
#include "contact/solve.hpp"
#include "ncp/solve.hpp"

namespace perp::app::contacts {

/// What runs; which of them follows from the variant.
struct MethodOptions {
  contact::Auto automatic{};
  contact::GlockerHomotopy homotopy{};
  contact::GlockerNcp glocker{};
  ncp::Method method{};              ///< of ncp1, and of affine laws but for "auto"
  std::vector<std::string> notes{};  ///< options without effect, and why
};

/// Throws InputError naming key, value and what is known: no such key, a value that makes no sense, an option that a
/// flag sets (--method, --tol, --time-limit), a variant whose method has none.
MethodOptions method_options(const Variant& variant);

/// The keys of auto beside the homotopy's, of the homotopy, and of Glocker's NCP, as --help writes them.
std::string auto_keys();
std::string homotopy_keys();
std::string glocker_keys();

}  // namespace perp::app::contacts
