// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The families of problems in any size, by name: NAME:SIZE[xSIZE...][:SEED], as in walras-own:400x300x300:7. The names
/// are those of entries(), which has them at some sizes.
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "collection/collection.hpp"

namespace perp::ncp::collection {

/// A size that a family asks for. `most` keeps matrices within 32-bit indices, dense ones within some gigabytes.
struct SizeArgument {
  std::string_view name;
  Index least = 1;
  Index most = 1;
};

/// How a problem grows with its sizes.
enum class Growth {
  Linear,  ///< unknowns and entries with their sum
  Grid,    ///< with their product, or the square of the only one
  Dense,   ///< entries with their product, or the square of the only one
};

struct Family {
  std::string_view name;
  SizeArgument sizes[3];     ///< the first ones that have a name
  std::string_view example;  ///< sizes that make sense, with a seed if it takes one: "400x300x300:7"
  std::variant<Problem (*)(Index), Problem (*)(Index, Index), Problem (*)(Index, unsigned),
               Problem (*)(Index, Index, unsigned), Problem (*)(Index, Index, Index, unsigned)>
      maker;
  Growth growth = Growth::Linear;

  std::span<const SizeArgument> arguments() const;
  bool seeded() const { return maker.index() >= 2; }
};

std::span<const Family> families();                ///< sorted by name
const Family* find_family(std::string_view name);  ///< nullptr if there is none
std::string syntax(const Family& family);          ///< "walras-own:GOODSxSECTORSxHOUSEHOLDS[:SEED]"
std::string limits(const Family& family);          ///< "goods from 4 to 10000000, sectors ..."

/// The problem of "400x300x300:7", the text behind the name; the seed is 1 if it is left out. Throws
/// std::invalid_argument with argument, value and what is expected: more or fewer sizes than the family has, one beyond
/// its limits, a seed that is none or is not taken; lcp::NotEnoughMemory if its vectors and matrix alone would not fit.
Problem make(const Family& family, std::string_view sizes);

}  // namespace perp::ncp::collection
