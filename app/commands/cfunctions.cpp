// SPDX-License-Identifier: Apache-2.0
#include "app/commands/commands.hpp"

#include <fmt/format.h>

#include <ostream>

#include "app/text/table.hpp"
#include "ncp/reformulation/cfunction.hpp"
#include "ncp/reformulation/smoothing_function.hpp"

namespace perp::app {

namespace {

void print(std::ostream& out, const ncp::CFunction& c) {
  out << fmt::format("\n  {}\n      {}\n", c.name, c.formula);
  if (const auto& p = c.parameter) {
    const std::string range =
        p->high < lcp::infinity ? fmt::format("in ({}, {})", p->low, p->high) : fmt::format("> {}", p->low);
    out << fmt::format("      {} {}, default {}\n", p->name, range, p->value);
  }
  const ncp::CProperties& known = c.properties;
  out << fmt::format("      level sets of Psi are bounded for: {}\n", known.level_sets)
      << fmt::format("      stationary points of Psi are solutions for: {}\n", known.stationary_points) << "      "
      << c.reference << '\n';
}

}  // namespace

int print_cfunctions(Streams streams) {
  std::ostream& out = streams.out;
  out << "C-functions: phi(a, b) = 0 exactly where a >= 0, b >= 0, ab = 0; all have the sign of min(a, b).\n"
         "--method semismooth --option cfunction=NAME --option cfunction_parameter=VALUE makes\n"
         "Psi = 1/2 sum_i phi(x_i - l_i, F_i)^2 (bounded boxes by composition) zero.\n";
  for (const ncp::CFunction& c : ncp::cfunctions()) print(out, c);
  out << '\n';
  Table table({"name", "strongly semismooth", "Psi continuously differentiable", "singular where x_i = F_i = 0"});
  const auto yes = [](bool b) { return std::string(b ? "yes" : "no"); };
  for (const ncp::CFunction& c : ncp::cfunctions())
    table.add(
        {c.name, yes(c.properties.strongly_semismooth), yes(c.smooth_merit), yes(c.properties.singular_at_degenerate)});
  table.print(out, 2);
  out << "\nSmoothings phi_mu(a, b), infinitely often differentiable for mu > 0, |phi_mu - phi| <= kappa mu.\n"
         "--method smooth --option smoothing_function=NAME\n";
  for (const ncp::SmoothingFunction& s : ncp::smoothing_functions())
    out << fmt::format("\n  {}\n      {}\n      tends to {}, kappa = {}\n      {}\n", s.name, s.formula, s.limit.name,
                       number(s.kappa, 4), s.reference);
  return exit_solved;
}

}  // namespace perp::app
