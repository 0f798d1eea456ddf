// SPDX-License-Identifier: Apache-2.0
#include "app/contact/run/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "app/text/table.hpp"
#include "contact/model/facts.hpp"

namespace perp::app::contacts {

namespace {

using contact::Problem;
using contact::State;
using lcp::Index;
using lcp::Vec;

constexpr std::size_t long_table = 60;
constexpr double symmetric = 1e-13;  // largest |S_ij - S_ji| of rounding
constexpr Index dense_limit = 400;   // rows whose eigenvalues cost some hundredths of a second

std::string size_text(double value) { return number(value, 4); }

double largest(const Vec& values) { return values.size() > 0 ? values.lpNorm<Eigen::Infinity>() : 0; }
/// What is rounding of the largest number of its kind is 0.
constexpr double rounding = 1e-13;
std::string shown(double value, double zero) { return size_text(std::abs(value) <= zero ? 0 : value); }

std::string range_text(const Vec& values) {
  if (values.size() == 0) return "none";
  const double low = values.minCoeff();
  const double high = values.maxCoeff();
  return low == high ? number(low, 4) : fmt::format("{} to {}", number(low, 4), number(high, 4));
}

/// "  what . . . . . . value  remark".
void line(std::ostream& out, const std::string& what, const std::string& value, std::string_view remark = "") {
  out << fmt::format("  {} ", dotted(what, 34))
      << (remark.empty() ? value + '\n' : fmt::format("{:<10} {}\n", value, remark));
}

std::string metric(double value) { return number(value, 3); }

/// The numbers of contact a: r_N, |r_T|, u_N, |u_T|, and |m_R|, |w_R| where it may roll.
struct Parts {
  double r_N, r_T, u_N, u_T, m_R, w_R;
};
Parts parts(const Problem& problem, const Run& run, Index a) {
  const int width = problem.disk_width();
  const Index N = problem.dimension * a;
  const auto& [r, u] = run.solution;
  const auto rolling = [&](const Vec& v) { return problem.rolls() ? v.segment(N + 1 + width, width).norm() : 0; };
  return {r[N], r.segment(N + 1, width).norm(), u[N], u.segment(N + 1, width).norm(), rolling(r), rolling(u)};
}

std::string counts_text(const Run& run) {
  std::string text;
  for (const auto& [what, n] : run.counts) {
    if (n == 0) continue;
    std::string noun = what;
    std::ranges::replace(noun, '_', ' ');
    if (noun.ends_with('s')) noun.pop_back();
    if (noun.starts_with("newton")) noun[0] = 'N';
    text += count(n, noun) + ", ";
  }
  return text + seconds_text(run.seconds);
}

/// Points as near as this are worth a looser tolerance; what is worse is no solution to anybody.
constexpr double nearly = 1e-6;
double larger_metric(const contact::Residual& r) { return std::max(r.siconos, r.rr9118); }

/// What to try, or nothing.
std::string advice(const Run& run) {
  if (run.verdict.existence == contact::Existence::None) return "";
  if (run.status == Status::TimeLimit)
    return fmt::format(" Try: a longer --time-limit than {:g} s.", run.limits.seconds);
  if (run.status == Status::Interrupted) return "";
  if (run.variant.exact() && !run.variant.automatic()) return " Try: --formulation glocker --method auto.";
  if (run.variant.exact() && run.status == Status::NoProgress)
    return larger_metric(run.residual) <= nearly ? " Try: a looser --tol; the table shows what is not decided yet."
                                                 : " The table shows what is not decided yet.";
  return "";
}

std::string unsolved_text(const Run& run) {
  const std::string what = fmt::format("Not solved ({})", to_string(run.status));
  return (run.message.empty() ? what : fmt::format("{}: {}", what, run.message)) + "." + advice(run);
}

/// In words what made the accepted point.
std::string solved_by_text(const Run& run) {
  static const std::map<std::string, std::string> words{
      {"zero", "no impulses at all"},
      {"sweeps", "sweeps of Gauss-Seidel"},
      {"homotopy", "the homotopy"},
      {"newton", "Newton steps on Alart & Curnier's equation"},
      {"damped-newton", "damped Newton steps on Alart & Curnier's equation"},
      {"groups", "groups of contacts that do not act on each other, each by itself"},
      {"proximal", "the proximal loop"}};
  const auto found = words.find(run.solved_by);
  return found == words.end() ? run.solved_by : found->second;
}

/// Words for a law that is not Coulomb's.
std::string own_text(const Problem& problem, const Run& run) {
  const std::string what = run.variant.law == Variant::Law::Frictionless ? "no friction"
                           : problem.dimension == 2                      ? "an interval, which in 2D is Coulomb's law"
                           : run.variant.law == Variant::Law::Inner
                               ? fmt::format("a polygon of {} vertices inside the disk", run.variant.facets)
                               : fmt::format("a polygon of {} edges around the disk", run.variant.facets);
  if (std::isnan(run.own)) return fmt::format("Nothing is known of its own problem, {}.", what);
  if (!run.solved)
    return fmt::format("Its own problem, {}, is not solved either: {} has the natural residual {}.", what,
                       count(run.unknowns, "unknown"), metric(run.own));
  return fmt::format(
      "Solves its own problem ({}; {}, natural residual {}). Coulomb's exact law is violated by {} of the size of "
      "impulses and velocities.",
      what, count(run.unknowns, "unknown"), metric(run.own), metric(run.residual.siconos));
}

std::string W_text(const contact::Delassus& W) {
  const auto rows = static_cast<double>(W.rows());
  if (!W.formed())
    return fmt::format("W = H' M^-1 H, not formed: {} rows, {} velocities of bodies", W.rows(),
                       W.parts()->inertia().velocities());
  const Index nonzeros = W.matrix().nonZeros();
  return fmt::format("W: {} rows, {} nonzeros ({} %)", W.rows(), nonzeros,
                     number(100 * static_cast<double>(nonzeros) / std::max(1.0, rows * rows), 3));
}

}  // namespace

void print_heading(std::ostream& out, const Loaded& loaded, const Variant& variant, double tol) {
  const Problem& problem = loaded.problem;
  out << fmt::format("{}: {} in {} dimensions, mu {}{}\n", loaded.label, count(problem.contacts(), "contact"),
                     problem.space(), range_text(problem.mu),
                     problem.rolls() ? fmt::format(", mu_r {} m (rolling friction)", range_text(problem.mu_r)) : "");
  const contact::Facts facts = contact::facts(problem, {.dense_limit = dense_limit});
  std::string text = W_text(problem.W);
  text += facts.asymmetry < symmetric ? ", symmetric" : fmt::format(", asymmetric by {}", number(facts.asymmetry, 2));
  if (facts.known && facts.rank < problem.q.size())
    text += fmt::format(", rank {}: contacts are redundant, impulses need not be unique", facts.rank);
  else if (facts.known)
    text += ", of full rank";
  if (facts.parts > 1) text += fmt::format("; {} groups of contacts that do not act on each other", facts.parts);
  out << text << '\n';
  if (problem.global && (problem.W.formed() || problem.global->b.size() > 0))
    out << fmt::format("condensed from {} velocities{}\n", problem.global->M.rows(),
                       problem.global->b.size() > 0
                           ? fmt::format(" and {}", count(problem.global->b.size(), "bilateral constraint"))
                           : "");
  out << fmt::format("{}: {}; tolerance {:g}\n", variant.label(), variant.words(), tol);
  if (!variant.options.empty()) out << fmt::format("options: {}\n", fmt::join(variant.options, ", "));
  if (variant.faceted() && problem.dimension == 2)
    out << "in 2D the friction polygon is the interval [-mu r_N, mu r_N], whatever K is\n";
}

namespace {
std::string made_by(const Run& run, const contact::Record& record) {
  if (record.by != contact::Origin::Ncp && record.by != contact::Origin::Iterate)
    return std::string(contact::to_string(record.by));
  return record.letter == ' ' ? run.variant.method : fmt::format("{} {}", run.variant.method, record.letter);
}
}  // namespace

void print_history(std::ostream& out, const Run& run) {
  if (run.history.empty()) return;
  Table table({">k", "made by", ">tau", ">step", ">alpha", ">siconos", ">rr9118"});
  for (const contact::Record& r : run.history)
    table.add({fmt::format("{}", r.k), made_by(run, r), number(r.tau, 3), number(r.step, 3), number(r.alpha, 3),
               metric(r.siconos), metric(r.rr9118)});
  out << (run.variant.as_ncp() ? "\nPoints judged, by the method's own letters; C: end of a stage\n"
                               : "\nPoints judged\n");
  table.print(out, 2);
}

void print_contacts(std::ostream& out, const Problem& problem, const Run& run, bool full) {
  std::vector<Column> columns{">contact", "state", ">r_N [N s]", ">|r_T|", ">mu r_N"};
  if (problem.rolls()) columns.insert(columns.end(), {">|m_R| [N m s]", ">mu_r r_N"});
  columns.insert(columns.end(), {">u_N [m/s]", ">|u_T|"});
  if (problem.rolls()) columns.emplace_back(">|w_R| [1/s]");
  columns.emplace_back(">margin");
  Table table(columns);
  const double impulses = rounding * largest(run.solution.r);
  const double velocities = rounding * std::max(largest(run.solution.u), largest(problem.q));
  for (Index a = 0; a < problem.contacts(); ++a) {
    const Parts p = parts(problem, run, a);
    const contact::ContactState& s = run.states[static_cast<std::size_t>(a)];
    std::vector<std::string> row{fmt::format("{}", a + 1), name(s.state), shown(p.r_N, impulses),
                                 shown(p.r_T, impulses), shown(problem.mu[a] * p.r_N, impulses)};
    if (problem.rolls()) row.insert(row.end(), {shown(p.m_R, impulses), shown(problem.mu_r[a] * p.r_N, impulses)});
    row.insert(row.end(), {shown(p.u_N, velocities), shown(p.u_T, velocities)});
    if (problem.rolls()) row.push_back(shown(p.w_R, velocities));
    row.push_back(fmt::format("{} {}", number(s.margin, 3),
                              s.state == State::Stick  ? "N s"
                              : s.state == State::Roll ? "1/s"
                                                       : "m/s"));
    table.add(row);
  }
  table.print(out, 2, full ? 0 : long_table, "--full shows them");
  out << "  margin: how far from another state: open u_N, stick mu r_N - |r_T|, slip |u_T|"
      << (problem.rolls() ? ", roll |w_R|\n" : "\n");
}

void print_verdict(std::ostream& out, const Problem& problem, const Run& run) {
  const contact::Residual& r = run.residual;
  if (run.variant.exact())
    print_wrapped(out,
                  run.solved
                      ? fmt::format("Solved by {}: Coulomb's law holds to {} (Siconos' metric) and {} (RR-9118's).",
                                    solved_by_text(run), metric(r.siconos), metric(r.rr9118))
                      : unsolved_text(run),
                  0);
  else
    print_wrapped(out, (run.solved ? "" : unsolved_text(run) + " ") + own_text(problem, run), 0);
  out << fmt::format("{}: {} open, {} stick, {} slip{}\n", count(problem.contacts(), "contact"),
                     run.in_state(State::Open), run.in_state(State::Stick), run.in_state(State::Slip),
                     problem.rolls() ? fmt::format(", {} roll", run.in_state(State::Roll)) : "");
  out << counts_text(run) << '\n';
}

void print_judge(std::ostream& out, const Problem& problem, const Run& run) {
  const contact::Residual& r = run.residual;
  out << (run.variant.exact() ? "Coulomb's law at these impulses (0: exact)\n"
                              : "Coulomb's exact law, beside it, at these impulses (0: exact)\n");
  line(out, "natural map |e|", metric(r.natural), "mixed units");
  line(out, "|e| / max(|q|, |r|, |u|)", metric(r.siconos), "Siconos 4.4");
  line(out, "|e| / |q|", metric(r.rr9118), "INRIA RR-9118");
  line(out, "the same free of units", metric(r.scaled));
  line(out, "outside of the cone", metric(r.cone), "N s, of |r_T| <= mu r_N and r_N >= 0");
  line(out, "normal complementarity", metric(r.normal), "N s, |min(r_N, rho u_N)|");
  line(out, "friction against slip", metric(r.slip), "J, |mu r_N |u_T| + r_T.u_T|");
  line(out, "cone, normal, slip",
       fmt::format("{}, {}, {}", metric(r.cone_share), metric(r.normal_share), metric(r.slip_share)),
       "at the worst contact, each relative to what is compared there");
  if (r.worst < 0 || r.scaled == 0) return;
  const Parts p = parts(problem, run, r.worst);
  line(
      out, "worst contact", fmt::format("{}", r.worst + 1),
      fmt::format("{}: r_N {}, |r_T| {}, u_N {}, |u_T| {}{}", name(run.states[static_cast<std::size_t>(r.worst)].state),
                  size_text(p.r_N), size_text(p.r_T), size_text(p.u_N), size_text(p.u_T),
                  problem.rolls() ? fmt::format(", |m_R| {}, |w_R| {}", size_text(p.m_R), size_text(p.w_R)) : ""));
}

void print_summaries(std::ostream& out, std::span<const Summary> all) {
  Table table({"problem", ">contacts", ">open", ">stick", ">slip", "status", "solved by", ">own law", ">siconos",
               ">rr9118", ">steps", ">time"});
  for (const auto& [label, run, refused] : all) {
    if (!refused.empty()) {
      table.add({label, "", "", "", "", "refused", "", "", "", "", "", ""});
      continue;
    }
    table.add({label, fmt::format("{}", run.states.size()), fmt::format("{}", run.in_state(State::Open)),
               fmt::format("{}", run.in_state(State::Stick)), fmt::format("{}", run.in_state(State::Slip)),
               std::string(to_string(run.status)), run.solved_by, std::isnan(run.own) ? "" : metric(run.own),
               metric(run.residual.siconos), metric(run.residual.rr9118), fmt::format("{}", run.steps()),
               seconds_text(run.seconds)});
  }
  table.print(out);
}

}  // namespace perp::app::contacts
