// SPDX-License-Identifier: Apache-2.0
/// What people, AMPL and files of options write. The first letter says what the rest is:
///     f  a file of options          w  AMPL's words
///     v  variants of contact        s  NAME:SIZE of the collection, small                 c  of a contact scene, small
/// Options in force, written as key=value, set what they say.
#include "app/options/options.hpp"

#include <algorithm>
#include <sstream>

#include "app/contact/run/run.hpp"
#include "app/contact/run/variant.hpp"
#include "app/problem/problem.hpp"
#include "fuzz/support.hpp"

namespace {

using namespace perp;
using fuzz::require;

void apply(const std::vector<app::Assignment>& given, app::Unknown unknown, bool write) {
  app::Applied applied = app::apply_options(given, unknown);
  if (!write) return;
  const auto in_force = [](app::Settings& settings) {
    std::vector<app::Assignment> all;
    for (const ncp::Field& field : app::fields_of(settings).options())
      if (const std::string value = app::value_text(field); value != "-")
        all.push_back({std::string(field.key), value, "written"});
    return all;
  };
  const std::vector<app::Assignment> written = in_force(applied.settings);
  app::Applied again = app::apply_options(written);
  require(std::ranges::equal(written, in_force(again.settings), {}, &app::Assignment::value, &app::Assignment::value),
          "an option that is written sets what it says");
}

/// Numbers that make nothing large: each small, and their product. What is after the second colon is a seed.
bool small(std::string_view text) {
  constexpr long most = 40;
  constexpr long most_together = 400;
  const std::size_t first = std::min(text.find(':'), text.size());
  long together = 1;
  long number = 0;
  for (const char c : std::string(text.substr(first, std::min(text.find(':', first + 1), text.size()) - first)) + ':') {
    const bool digit = c >= '0' && c <= '9';
    if (!digit) together *= std::max(number, 1L);
    number = digit ? 10 * number + (c - '0') : 0;
    if (number > most || together > most_together) return false;
  }
  return true;
}

bool no_file(std::string_view text) {
  return text.find('/') == std::string_view::npos && text.find(".nl") == std::string_view::npos &&
         text.find(".dat") == std::string_view::npos;
}

void read(char kind, const std::string& text) {
  const bool seldom = fuzz::one_in(16, text);
  switch (kind) {
    case 'f': {
      std::istringstream in(text);
      return apply(app::parse_options_file(in, "input.opt"), app::Unknown::Refuse, seldom);
    }
    case 'w':
      return apply(app::parse_words(text, "input"), app::Unknown::Report, seldom);
    case 'v':
      for (const app::contacts::Variant& variant : app::contacts::parse_variants(text))
        require(app::contacts::parse_variant(variant.label()).label() == variant.label(), "a label names its variant");
      return;
    case 's':
      if (seldom && small(text) && no_file(text)) app::load_problem(text);
      return;
    case 'c':
      if (seldom && small(text) && no_file(text)) app::contacts::generate(text);
      return;
    default:
      return;
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0 || std::string_view("fwvsc").find(static_cast<char>(data[0])) == std::string_view::npos) return -1;
  const std::string text(fuzz::view(data + 1, size - 1));
  fuzz::accepted<app::InputError, std::invalid_argument>([&] { read(static_cast<char>(data[0]), text); });
  return 0;
}
