#include "app/methods.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <ostream>

#include "app/options.hpp"
#include "app/table.hpp"

namespace perp::app {

std::span<const MethodEntry> methods() {
  static const std::array table{
      MethodEntry{"semismooth",
                  "Newton on the Fischer-Burmeister equation, safeguarded by Levenberg-Marquardt and gradient steps",
                  "De Luca, Facchinei & Kanzow, Math. Programming 75 (1996) 407",
                  [] { return ncp::Method(ncp::SemismoothNewton{}); }},
      MethodEntry{"semismooth-min", "the same on the min function: fewer, cheaper steps near a solution, less global",
                  "Pang, Math. Oper. Research 15 (1990) 311",
                  [] { return ncp::Method(ncp::SemismoothNewton{.cfunction = ncp::natural_min()}); }},
      MethodEntry{"josephy", "Newton on the linearised problem, solved by Lemke-type pivoting; damped",
                  "Josephy, MRC report 1965 (1979); Mathiesen, Math. Programming Study 23 (1985) 144",
                  [] { return ncp::Method(ncp::NewtonJosephy{}); }},
  };
  return table;
}

const MethodEntry* find_method(std::string_view name) {
  const auto entry = std::ranges::find(methods(), name, &MethodEntry::name);
  return entry == methods().end() ? nullptr : &*entry;
}

std::vector<std::string_view> method_names() {
  std::vector<std::string_view> names;
  for (const MethodEntry& entry : methods()) names.push_back(entry.name);
  return names;
}

int print_methods(Streams streams) {
  std::ostream& out = streams.out;
  out << "Methods: --method NAME\n";
  for (const MethodEntry& entry : methods())
    out << fmt::format("\n  {}{}\n      {}\n      {}\n", entry.name, entry.name == default_method ? "  (default)" : "",
                       entry.what, entry.reference);

  out << "\nOptions: --option key=value, a line of an options file, or an AMPL option. A key may be shortened as long "
         "as\n"
         "it is unique. Defaults a method, '-' where the option has no effect on it:\n\n";
  std::vector<Column> columns{{"key", Align::Left}, {"values", Align::Left}};
  for (const MethodEntry& entry : methods()) columns.push_back({std::string(entry.name), Align::Right});
  Table defaults(columns);
  for (const Option& option : options()) {
    std::vector<std::string> row{std::string(option.key), values_text(option)};
    for (const MethodEntry& entry : methods()) {
      Settings settings{.method_name = std::string(entry.name), .method = entry.make()};
      row.push_back(value_text(option.field(settings)));
    }
    defaults.add(std::move(row));
  }
  defaults.print(out, 2);

  out << "\nWhat they mean:\n\n";
  for (const Option& option : options()) {
    out << "  " << option.key;
    if (!option.aliases.empty()) out << fmt::format(" ({})", fmt::join(option.aliases, ", "));
    out << "\n      " << option.help << '\n';
  }

  out << "\nOptions of PATH that are accepted, so that its option files can be read, but have no effect in this "
         "version:\n";
  print_wrapped(out, ignored_options(), 2, 100);
  return exit_solved;
}

}  // namespace perp::app
