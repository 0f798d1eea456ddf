// SPDX-License-Identifier: Apache-2.0
#include "collection/sized.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <vector>

#include "collection/base/build.hpp"
#include "collection/random/random_ncps.hpp"
#include "collection/scalable/generators.hpp"
#include "lcp/memory.hpp"
#include "lcp/words.hpp"

namespace perp::ncp::collection {

namespace {

constexpr Index sparse = 10'000'000;
constexpr Index dense = 10'000;
constexpr Index side = 20'000;  // of a grid

constexpr std::array family_table{
    Family{"ahn", {{"n", 1, sparse}}, "1000", ahn},
    Family{"american-put-own", {{"steps", 1, side}, {"N", 1, side}}, "100x400", american_put_own, Growth::Grid},
    Family{"bimatrix-own", {{"m", 1, dense}, {"n", 1, dense}}, "30x20:3", bimatrix_own, Growth::Dense},
    Family{"bratu-own", {{"M", 1, side}, {"N", 1, side}}, "300x300", bratu_own, Growth::Grid},
    Family{"ehl-kost", {{"N", 3, dense}}, "200", ehl_kost, Growth::Dense},
    Family{"fathi", {{"n", 1, dense}}, "100", fathi, Growth::Dense},
    Family{"geiger-kanzow", {{"n", 1, sparse}}, "1000", geiger_kanzow},
    Family{"infeasible-monotone-own", {{"n", 2, sparse}}, "1000:2", infeasible_monotone_own},
    Family{"infeasible-row-own", {{"n", 1, sparse}}, "1000:2", infeasible_row_own},
    Family{"journal-bearing", {{"M", 1, side}, {"N", 1, side}}, "300x300", journal_bearing, Growth::Grid},
    Family{"lq-control-own", {{"T", 1, sparse}}, "100000", lq_control_own},
    Family{"murty", {{"n", 1, dense}}, "30", murty, Growth::Dense},
    Family{"murty-exp", {{"n", 1, 50}}, "20", murty_exp},
    Family{"murty-lower", {{"n", 1, dense}}, "30", murty_lower, Growth::Dense},
    Family{"nash-own", {{"firms", 10, dense}}, "500:2", nash_own, Growth::Dense},
    Family{"obstacle", {{"M", 1, side}, {"N", 1, side}}, "300x300", obstacle, Growth::Grid},
    Family{"obstacle-bump-own", {{"N", 1, 5000}}, "100", obstacle_bump_own, Growth::Grid},
    Family{"random-bimatrix-own", {{"m", 1, dense}, {"n", 1, dense}}, "30x20:3", random_bimatrix_own, Growth::Dense},
    Family{"random-boxed-ncp-own", {{"n", 2, sparse}}, "1000:5", random_boxed_ncp_own},
    Family{"random-copositive-own", {{"n", 2, sparse}}, "1000:5", random_copositive_own},
    Family{"random-copositive-plus-own", {{"n", 4, sparse}}, "1000:5", random_copositive_plus_own},
    Family{"random-degenerate-ncp-own", {{"n", 2, sparse}}, "1000:5", random_degenerate_ncp_own},
    Family{"random-degenerate-own", {{"n", 2, sparse}}, "1000:5", random_degenerate_own},
    Family{"random-exponential-ncp-own", {{"n", 2, sparse}}, "1000:5", random_exponential_ncp_own},
    Family{"random-ill-conditioned-ncp-own", {{"n", 2, sparse}}, "1000:5", random_ill_conditioned_ncp_own},
    Family{"random-monotone-ncp-own", {{"n", 2, sparse}}, "1000:5", random_monotone_ncp_own},
    Family{"random-p-own", {{"n", 2, sparse}}, "1000:5", random_p_own},
    Family{"random-p0-ncp-own", {{"n", 4, sparse}}, "1000:5", random_p0_ncp_own},
    Family{"random-pd-own", {{"n", 1, sparse}}, "1000:5", random_pd_own},
    Family{"random-psd-own", {{"n", 2, sparse}}, "1000:5", random_psd_own},
    Family{"random-strictly-copositive-own", {{"n", 2, sparse}}, "1000:5", random_strictly_copositive_own},
    Family{"random-z-own", {{"n", 1, sparse}}, "1000:5", random_z_own},
    Family{"spatial-price-own", {{"regions", 2, sparse}}, "2000:2", spatial_price_own},
    Family{"torsion", {{"M", 1, side}, {"N", 1, side}}, "300x300", torsion, Growth::Grid},
    Family{"traffic-own", {{"M", 2, 4000}, {"N", 2, 4000}}, "50x50:2", traffic_own, Growth::Grid},
    Family{"vanderpol-own", {{"T", 40, sparse}}, "10000", vanderpol_own},
    Family{"walras-own",
           {{"goods", 4, sparse}, {"sectors", 1, sparse}, {"households", 1, sparse}},
           "400x300x300:7",
           walras_own},
};
static_assert(std::ranges::is_sorted(family_table, {}, &Family::name));

[[noreturn]] void refuse(const Family& family, const std::string& why) {
  refuse_input(family.name, ": ", why, "; expected ", syntax(family), ", as in ", family.name, ":", family.example);
}

std::string quoted(std::string_view text) { return std::string("'").append(text).append("'"); }

/// The whole number that the text is; what Index does not hold is refused.
Index whole_number(const Family& family, std::string_view text, const char* what) {
  Index number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (text.empty() || end != text.data() + text.size() || error == std::errc::invalid_argument)
    refuse(family, quoted(text) + " is no " + what);
  if (error == std::errc::result_out_of_range)
    refuse(family, std::string(what) + " " + std::string(text) + " is out of range");
  return number;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t at = text.find(separator); at != std::string_view::npos; at = text.find(separator)) {
    parts.push_back(text.substr(0, at));
    text.remove_prefix(at + 1);
  }
  parts.push_back(text);
  return parts;
}

/// At least so many bytes: bounds, start and values of F of 8 each and two entries of 12 for every unknown; the entries
/// of dense matrices, or of their triangles.
double least_memory(const Family& family, const Index* n) {
  const std::size_t count = family.arguments().size();
  double sum = 0;
  double product = count == 1 ? static_cast<double>(n[0]) : 1;
  for (std::size_t k = 0; k < count; ++k) {
    sum += static_cast<double>(n[k]);
    product *= static_cast<double>(n[k]);
  }
  constexpr double unknown = 56;
  constexpr double entry = 12.0 / 2;
  return family.growth == Growth::Linear ? unknown * sum : (family.growth == Growth::Grid ? unknown : entry) * product;
}

unsigned seed_of(const Family& family, std::string_view text) {
  if (!family.seeded()) refuse(family, "it has no seed, " + quoted(text) + " is given");
  const Index seed = whole_number(family, text, "seed");
  constexpr Index most = std::numeric_limits<unsigned>::max();
  if (seed < 0 || seed > most)
    refuse(family, "seed " + std::to_string(seed) + " is not from 0 to " + std::to_string(most));
  return static_cast<unsigned>(seed);
}

}  // namespace

std::span<const SizeArgument> Family::arguments() const {
  const auto* end = std::ranges::find_if(sizes, [](const SizeArgument& size) { return size.name.empty(); });
  return {std::begin(sizes), end};
}

std::span<const Family> families() { return family_table; }

const Family* find_family(std::string_view name) {
  const auto* found = std::ranges::find(family_table, name, &Family::name);
  return found == family_table.end() ? nullptr : found;
}

std::string syntax(const Family& family) {
  std::string text(family.name);
  char separator = ':';
  for (const SizeArgument& argument : family.arguments()) {
    text += separator;
    for (const char letter : argument.name)
      text += letter >= 'a' && letter <= 'z' ? static_cast<char>(letter - 'a' + 'A') : letter;
    separator = 'x';
  }
  return family.seeded() ? text + "[:SEED]" : text;
}

std::string limits(const Family& family) {
  std::string text;
  for (const SizeArgument& argument : family.arguments())
    text += std::string(text.empty() ? "" : ", ")
                .append(argument.name)
                .append(" from ")
                .append(std::to_string(argument.least))
                .append(" to ")
                .append(std::to_string(argument.most));
  return text;
}

Problem make(const Family& family, std::string_view sizes) {
  const std::vector<std::string_view> parts = split(sizes, ':');
  if (parts.size() > 2) refuse(family, quoted(sizes) + " has more than one seed");
  const std::span<const SizeArgument> arguments = family.arguments();
  const std::vector<std::string_view> given = split(parts[0], 'x');
  if (given.size() != arguments.size())
    refuse(family, std::to_string(arguments.size()) + (arguments.size() == 1 ? " size is" : " sizes are") +
                       " needed, " + quoted(parts[0]) + " has " + std::to_string(given.size()));
  Index n[3] = {};
  for (std::size_t k = 0; k < arguments.size(); ++k) {
    n[k] = whole_number(family, given[k], "size");
    require_between(family.name, arguments[k].name, n[k], arguments[k].least, arguments[k].most);
  }
  lcp::require_memory(least_memory(family, n), "vectors and matrix");
  const unsigned seed = parts.size() == 2 ? seed_of(family, parts[1]) : 1;
  const Overloaded call{[&](Problem (*made)(Index)) { return made(n[0]); },
                        [&](Problem (*made)(Index, Index)) { return made(n[0], n[1]); },
                        [&](Problem (*made)(Index, unsigned)) { return made(n[0], seed); },
                        [&](Problem (*made)(Index, Index, unsigned)) { return made(n[0], n[1], seed); },
                        [&](Problem (*made)(Index, Index, Index, unsigned)) { return made(n[0], n[1], n[2], seed); }};
  return std::visit(call, family.maker);
}

}  // namespace perp::ncp::collection
