// SPDX-License-Identifier: Apache-2.0
/// How an Inspection is told to a person.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <ostream>

#include "app/commands/inspect.hpp"
#include "app/report/report.hpp"
#include "app/text/table.hpp"
#include "ncp/analysis/structure_report.hpp"

namespace perp::app {

namespace {

using ncp::Index;

constexpr double scaling_of_interest = 1e3;  // rows and columns are shown
constexpr double singular = 1e-15;           // reciprocal condition
constexpr std::size_t label_width = 13;
constexpr std::size_t line_width = 110;

using ncp::listed;
std::string variables(const ncp::Mcp& mcp, const Indices& indices) { return ncp::listed_variables(mcp, indices); }
std::string plural(std::size_t n, std::string_view noun) { return count(static_cast<long long>(n), noun); }
std::string size_text(double value) { return number(value, 3); }
std::string range_text(std::string_view what, double smallest, double largest) {
  if (smallest == largest) return fmt::format("{} = {}", what, size_text(largest));
  return fmt::format("{} from {} to {}", what, size_text(smallest), size_text(largest));
}

/// The rows and columns that do not match: sentences, one a part.
std::vector<std::string> blame(const ncp::Mcp& mcp, const StructureFindings& found) {
  return ncp::describe_parts(mcp, found.over, found.under);
}

/// The printout: labelled parts, long lines broken between words.
class Printout {
 public:
  explicit Printout(std::ostream& out) : out_(out) {}
  void part(std::string_view label) { label_ = label; }
  void line(const std::string& text) { broken(text, ""); }
  void concern(const std::string& text) { broken(text, "! "); }
  std::ostream& raw() { return out_; }

  void item(const std::string& text) { broken(text, "- ", 0); }

 private:
  void broken(const std::string& text, const char* mark, std::size_t indent = label_width) {
    print_wrapped(out_, text, fmt::format("{:<{}}{}", std::exchange(label_, ""), indent, mark), line_width);
  }

  std::ostream& out_;
  std::string label_;
};

void print_variables(Printout& print, const Inspection& inspection) {
  const VariableKinds& kinds = inspection.kinds;
  std::vector<std::string> parts;
  const auto add = [&](Index n, const char* what) {
    if (n > 0) parts.push_back(fmt::format("{} {}", n, what));
  };
  add(kinds.free, kinds.free == 1 ? "free (its row is an equation)" : "free (their rows are equations)");
  add(kinds.lower, "with a lower bound");
  add(kinds.upper, "with an upper bound");
  add(kinds.boxed, "with both");
  if (!kinds.fixed.empty())
    parts.push_back(fmt::format("{} fixed ({})", kinds.fixed.size(), variables(inspection.mcp(), kinds.fixed)));
  print.part("variables");
  print.line(parts.empty() ? "none" : fmt::format("{}", fmt::join(parts, ", ")));
}

void print_structure(Printout& print, const Inspection& inspection) {
  const StructureFindings& found = inspection.structure;
  print.part("structure");
  print.line(fmt::format("structural rank {} of {}{}", found.rank, found.size,
                         inspection.kinds.fixed.empty() ? "" : ", fixed variables and their rows left out"));
  if (found.full() || found.singular()) return;
  print.line(
      fmt::format("With variables at their bounds it is {}: no concern. With all of them between their bounds the "
                  "Jacobian is singular:",
                  found.rank_with_bounds));
  for (const std::string& text : blame(inspection.mcp(), found)) print.line(text);
}

void print_start(Printout& print, const Inspection& inspection) {
  const StartFindings& start = inspection.start;
  const ncp::Mcp& mcp = inspection.mcp();
  print.part("start");
  if (!start.outside.empty())
    print.line(fmt::format("{} outside {} bounds: moved to the nearest point inside",
                           variables(mcp, start.outside) + (start.outside.size() == 1 ? " is" : " are"),
                           start.outside.size() == 1 ? "its" : "their"));
  if (start.F_defined && mcp.size() > 0)
    print.line(fmt::format("natural residual {}{}", number(start.residual.natural, 3),
                           start.residual.natural > 0 ? " at " + mcp.equation_name(start.residual.worst) : ""));
  if (start.largest_F >= 0)
    print.line(fmt::format(
        "{} (largest: {} = {}){}", range_text("|F_i|", start.smallest_F, std::abs(start.F[start.largest_F])),
        mcp.equation_name(start.largest_F), number(start.F[start.largest_F], 3),
        start.zeros_in_F > 0 ? fmt::format("; {} of {} zero", start.zeros_in_F, inspection.structure.size) : ""));
  if (!start.degenerate.empty())
    print.line(fmt::format("at a bound with F_i = 0 (degenerate): {}", variables(mcp, start.degenerate)));
  const StructureFindings& structure = inspection.structure;
  if (start.J_defined && start.rank < structure.rank)
    print.line(fmt::format("structural rank {} of {} here, where {} of the Jacobian's {} entries are 0", start.rank,
                           structure.size, inspection.scaling.zeros,
                           inspection.scaling.zeros + inspection.scaling.entries));
}

void print_scaling(Printout& print, const Inspection& inspection) {
  const ScalingFindings& found = inspection.scaling;
  const ncp::Mcp& mcp = inspection.mcp();
  print.part("scaling");
  if (found.entries == 0) return print.line("the Jacobian has no entry at the start");
  const auto place = [&](std::pair<Index, Index> ij) {
    return fmt::format("{} by {}", mcp.equation_name(ij.first), mcp.variable_name(ij.second));
  };
  print.line(found.smallest == found.largest
                 ? fmt::format("|J_ij| = {} where it is not 0", size_text(found.largest))
                 : fmt::format("|J_ij| from {} ({}) to {} ({})", size_text(found.smallest), place(found.smallest_at),
                               size_text(found.largest), place(found.largest_at)));
  if (found.spread() < scaling_of_interest) return;
  const auto extremes = [](const std::vector<Extreme>& all, auto&& name) {
    return listed(all.size(),
                  [&](std::size_t k) { return fmt::format("{} {}", name(all[k].index), size_text(all[k].value)); });
  };
  const auto row = [&](Index i) { return mcp.equation_name(i); };
  const auto column = [&](Index j) { return mcp.variable_name(j); };
  print.line(fmt::format("largest entries of rows: {}; at the other end {}", extremes(found.large_rows, row),
                         extremes(found.small_rows, row)));
  print.line(fmt::format("largest entries of columns: {}; at the other end {}", extremes(found.large_columns, column),
                         extremes(found.small_columns, column)));
}

void print_derivatives(Printout& print, const Inspection& inspection) {
  print.part("derivatives");
  if (!inspection.derivatives) return;
  const ncp::JacobianCheck& check = *inspection.derivatives;
  if (!ncp::describe(inspection.mcp(), check).empty()) return;  // a concern
  const Index n = inspection.mcp().size();
  print.line(fmt::format("the Jacobian agrees with differences of F at the start to {}{}",
                         check.worst == 0 ? "rounding" : number(check.worst, 2) + ", relative",
                         check.columns < n ? fmt::format(" ({} of {} columns compared)", check.columns, n) : ""));
}

std::string condition_text(double rcond) {
  if (rcond == 0) return "infinite (singular)";
  return fmt::format("about {:.1e}{}", 1 / rcond, rcond < singular ? " (singular to rounding)" : "");
}

void print_condition(Printout& print, const Inspection& inspection) {
  const ConditionFindings& found = inspection.condition;
  if (!found.why_not.empty() && !inspection.start.F_defined) return;  // said above
  print.part("condition");
  if (!found.why_not.empty()) return print.line(found.why_not);
  if (!found.all) return print.line("nothing to estimate");
  print.line(fmt::format("of the Jacobian at the start, in the 1-norm: {}", condition_text(*found.all)));
  if (found.active_size == inspection.structure.size) return;
  print.line(
      found.active
          ? fmt::format("of its {} with the natural residual |F_i| there, and their columns: {}",
                        plural(static_cast<std::size_t>(found.active_size), "row"), condition_text(*found.active))
          : "(the natural residual is the distance to a bound in every row: Newton's first matrix is the identity)");
}

/// Where and what the witness is, in names.
std::string witness(const ncp::Mcp& mcp, const lcp::Diagnosis& classes, std::string_view name,
                    const lcp::Property& property) {
  const Indices& at = property.indices;
  const auto row_name = [&](Index i) {
    return mcp.equation_name(classes.order ? classes.order->row_of[static_cast<std::size_t>(i)] : i);
  };
  if (name == "P" || name == "P0" || (at.size() > 2 && property.vector.size() == 0)) {
    if (!at.empty()) return fmt::format(": rows and columns of {}", variables(mcp, at));
  } else if (at.size() == 2) {
    return fmt::format(": {}, {}", row_name(at[0]), mcp.variable_name(at[1]));
  } else if (at.size() == 1) {
    return fmt::format(": {}", row_name(at[0]));
  }
  const ncp::Vec& v = property.vector;
  Indices order(static_cast<std::size_t>(v.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::erase_if(order, [&](Index i) { return v[i] == 0; });
  if (order.empty()) return "";
  std::stable_sort(order.begin(), order.end(), [&](Index i, Index j) { return std::abs(v[i]) > std::abs(v[j]); });
  return "; v: " + listed(order.size(), [&](std::size_t k) {
           return fmt::format("{} {}", mcp.variable_name(order[k]), size_text(v[order[k]]));
         });
}

void print_classes(Printout& print, const Inspection& inspection) {
  if (!inspection.mcp().is_affine()) return;
  print.part("affine");
  const std::optional<lcp::Diagnosis>& classes = inspection.classes;
  if (!classes) return print.line("F(x) = M x + q");
  print.line(fmt::format("F(x) = M x + q, {}", classes->size == 0 ? "nothing but fixed variables"
                                               : classes->cone
                                                   ? "every variable with one bound: an LCP up to shifts and signs"
                                               : classes->bounded ? "every variable with two bounds"
                                                                  : "a mixed LCP"));
  if (classes->order)
    print.line("(its equations taken in the order of the variables with which M is symmetric but for signs)");
  std::ostream& out = print.raw();
  out << '\n';
  Table table({"M is", "", "why"});
  for (const auto& [name, property] : classes->all())
    table.add({std::string(name), std::string(lcp::to_string(property->answer)),
               property->reason + (property->no() ? witness(inspection.mcp(), *classes, name, *property) : "")});
  table.print(out);
  const std::vector<lcp::Guarantee> guarantees = classes->guarantees();
  if (guarantees.empty()) return;
  out << "\nWhat follows:\n";
  for (const lcp::Guarantee& guarantee : guarantees)
    print.item(fmt::format("{} ({})", guarantee.statement, guarantee.source));
}

void print_function_classes(Printout& print, const Inspection& inspection) {
  if (!inspection.function_classes) return;
  print.part("F on the box");
  std::ostream& out = print.raw();
  Table table({"F is", "", "why"});
  for (const auto& [name, property] : inspection.function_classes->all())
    table.add({std::string(name), std::string(lcp::to_string(property->answer)), property->reason});
  table.print(out);
}

}  // namespace

void print_inspection(std::ostream& out, const Inspection& inspection) {
  const LoadedProblem& problem = *inspection.loaded;
  print_size(out, problem);
  if (problem.starts > 1) out << fmt::format(", start {} of {}", problem.start, problem.starts);
  out << "\n\n";

  Printout print(out);
  const std::vector<Concern> all = all_concerns(inspection);
  const auto print_concerns = [&](Concern::Part part) {  // the part's label stands before the first of them
    for (const Concern& concern : all)
      if (concern.part == part) print.concern(concern.text);
  };
  print_variables(print, inspection);
  print_structure(print, inspection);
  print_concerns(Concern::Structure);
  print_start(print, inspection);
  print_concerns(Concern::Start);
  print_scaling(print, inspection);
  print_concerns(Concern::Scaling);
  print_derivatives(print, inspection);
  print_concerns(Concern::Derivatives);
  print_condition(print, inspection);
  print_concerns(Concern::Condition);
  print_classes(print, inspection);
  print_function_classes(print, inspection);
  out << '\n';
  if (!inspection.interrupted.empty()) out << fmt::format("Interrupted: {} left out.\n", inspection.interrupted);
  if (all.empty())
    out << "Nothing stands out.\n";
  else
    out << fmt::format("{} marked with ! above.\n",
                       all.size() == 1 ? "1 point that deserves a second look is"
                                       : fmt::format("{} points that deserve a second look are", all.size()));
}

}  // namespace perp::app
