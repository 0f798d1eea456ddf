// SPDX-License-Identifier: Apache-2.0
#include "ncp/explain/explain.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "lcp/words.hpp"
#include "ncp/analysis/structure_report.hpp"
#include "ncp/explain/lint.hpp"
#include "ncp/problem/counted_mcp.hpp"
#include "ncp/problem/linear_part.hpp"
#include "ncp/problem/model_structure.hpp"
#include "ncp/problem/words.hpp"
#include "ncp/strategy/solve.hpp"

namespace perp::ncp {
namespace {

using Kind = Answer::Kind;
using Indices = std::vector<Index>;

constexpr std::pair<Kind, std::string_view> kinds[] = {{Kind::Conflict, "conflict"}, {Kind::Repair, "repair"},
                                                       {Kind::Residual, "residual"}, {Kind::Structure, "structure"},
                                                       {Kind::Mirror, "mirror"},     {Kind::Family, "family"},
                                                       {Kind::Start, "start"}};

/// The problem with other constants and bounds, which it outlives.
Functions changed(const Mcp& base, const std::vector<Change>& changes) {
  Functions f = functions_of(base);
  Vec added = Vec::Zero(base.size());
  for (const auto& [what, from, to] : changes)
    (what.of == Demand::Row ? added : what.of == Demand::Lower ? f.box.lower : f.box.upper)[what.index] = to;
  f.F = [&base, added](In x, Out F) {
    const bool defined = base.eval(x, F);
    F += added;
    return defined;
  };
  return f;
}

/// J at a point near x0 at which no entry is 0 by chance; nothing if it is not defined at those that are tried.
std::optional<SpMat> generic_jacobian(const Mcp& mcp, In x0) {
  CountedMcp counted(mcp);
  SpMat J = mcp.jacobian_pattern();
  const Box& box = mcp.box();
  for (const double step : {0.3, 0.03, 1e-3}) {
    Vec x = lcp::project(box, x0);
    for (Index j = 0; j < x.size(); ++j) {
      double d = step * (1 + std::abs(x[j])) * (1 + 0.5 * std::sin(1.7 * static_cast<double>(j + 1)));
      if (std::isfinite(box.lower[j]) && std::isfinite(box.upper[j]))
        d = std::min(d, 0.3 * (box.upper[j] - box.lower[j]));
      x[j] += x[j] + d <= box.upper[j] ? d : -d;
    }
    if (counted.jacobian(lcp::project(box, x), J)) return J;
  }
  return std::nullopt;
}

class Explainer {
 public:
  Explainer(const Mcp& mcp, In x0, const ExplainOptions& options, const std::atomic<bool>* interrupt)
      : mcp_(mcp), x0_(x0), method_(options.method), deadline_(lcp::deadline_after(Seconds(options.seconds))) {
    Stop& s = stop(method_);
    s.interrupt = interrupt;
    s.max_time = std::min(s.max_time, Seconds(options.seconds / 3));
  }

  Explanation explain() {
    out_.result = solve(mcp_, x0_, method_);
    std::vector<Answer> slips = lint();
    if (!out_.result.accepted()) find_cause();
    // A proof before slips, and of these first the ones in its rows; slips before what is only likely.
    const bool proven = !out_.answers.empty() && out_.answers.front().proven;
    if (proven) std::ranges::stable_partition(slips, [&](const Answer& a) { return touches(a, out_.answers.front()); });
    out_.answers.insert(out_.answers.begin() + (proven ? 1 : 0), slips.begin(), slips.end());
    return std::move(out_);
  }

 private:
  static bool touches(const Answer& a, const Answer& b) {
    return std::ranges::any_of(a.rows, [&](Index i) { return std::ranges::find(b.rows, i) != b.rows.end(); });
  }

  std::vector<Answer> lint() {
    std::vector<Answer> all;
    const std::optional<SpMat> J = generic_jacobian(mcp_, x0_);
    if (J && !add_mirror_faults(mcp_, *J, all)) add_family_faults(mcp_, *J, all);
    if (!out_.result.accepted()) {  // of a solution its notes say so
      Vec F(mcp_.size());
      const bool defined = mcp_.eval(lcp::project(mcp_.box(), x0_), F);
      for (Fault& fault : faults(structure_of(mcp_, defined ? &F : nullptr, J ? &*J : nullptr)))
        all.push_back({.kind = Kind::Structure,
                       .proven = fault.by_pattern,
                       .rows = std::move(fault.rows),
                       .variables = std::move(fault.variables),
                       .text = std::move(fault.text)});
    }
    add_start_faults(mcp_, x0_, all);
    return all;
  }

  /// The sure causes before the likely ones.
  void find_cause() {
    const Vec& x = out_.result.x;
    const bool proven = out_.result.status == Status::Infeasible;
    if (const auto affine = linear_part(mcp_, x); affine && (proven || mcp_.is_affine())) {
      const LinearDemands demands(affine->problem, affine->rows);
      const auto& certificate = out_.result.proof.sums ? nullptr : out_.result.proof.certificate;
      Demands first = certificate ? demands.of_rows(lcp::rows_of(*certificate)) : demands.all();
      out_.conflict = smallest_conflict(demands, std::move(first), part_of_time(0.5));
      if (!out_.conflict && certificate)
        out_.conflict = smallest_conflict(affine->problem, *certificate, stop(method_).tol, part_of_time(0.5));
      if (out_.conflict) tell_conflict(out_.conflict->proof.certificate != nullptr);
      if (mcp_.is_affine()) repair(demands);
    }
    if (proven && !out_.conflict && out_.result.proof.sums) find_cause_in_sums(out_.result.proof);
    if (proven && !out_.conflict) {
      out_.conflict = smallest_conflict(mcp_, stop(method_).tol, part_of_time(0.5));
      if (out_.conflict) tell_conflict(true);
    }
    if (!mcp_.is_affine()) tell_linearised();
    if (!out_.conflict) tell_residual();
  }

  /// Demands on terms that are not affine are left out: nobody can change the range of exp.
  void find_cause_in_sums(const Infeasibility& proof) {
    std::vector<char> rows(at(proof.sums->size()), 0);
    std::fill_n(rows.begin(), mcp_.size(), char{1});
    const LinearDemands demands(*proof.sums, rows);
    out_.conflict = smallest_conflict(demands, demands.of_rows(lcp::rows_of(*proof.certificate)), part_of_time(0.5));
    if (!out_.conflict) return;
    const bool ranges =
        std::erase_if(out_.conflict->demands, [this](const Demand& d) { return d.index >= mcp_.size(); }) > 0;
    Infeasibility& found = out_.conflict->proof;
    if (found.certificate && found.certificate->radius < infinity) found = {};  // a term may be beyond
    if (found.certificate) found.sums = proof.sums;
    tell_conflict(found.certificate != nullptr);
    if (ranges) out_.answers.back().text += ", with the ranges of terms that are not affine";
  }

  lcp::Deadline part_of_time(double share) const {
    const auto now = std::chrono::steady_clock::now();
    return now >= deadline_ ? now
                            : now + std::chrono::duration_cast<lcp::Deadline::duration>(share * (deadline_ - now));
  }

  std::string told(const Demand& d) const {
    const std::string name = name_of(mcp_, d);
    if (d.of == Demand::Row) return name;
    return name + (d.of == Demand::Lower ? " >= " + number(mcp_.box().lower[d.index] + 0.0)
                                         : " <= " + number(mcp_.box().upper[d.index] + 0.0));
  }

  Answer answer_of(Kind kind, bool proven, const Demands& demands) const {
    Answer answer{.kind = kind, .proven = proven};
    for (const Demand& d : demands) (d.of == Demand::Row ? answer.rows : answer.variables).push_back(d.index);
    return answer;
  }

  void tell_conflict(bool proven) {
    const Demands& all = out_.conflict->demands;
    Answer answer = answer_of(Kind::Conflict, proven, all);
    Demands bounds = all;
    std::erase_if(bounds, [](const Demand& d) { return d.of == Demand::Row; });
    const std::string rows = listed_equations(mcp_, answer.rows);
    const std::string limits = listed(bounds.size(), [&](std::size_t k) { return told(bounds[k]); });
    const bool one = answer.rows.size() == 1;
    answer.text = (one ? "row " : "rows ") + rows;
    answer.text += !one ? " contradict each other" : bounds.empty() ? " cannot hold" : " contradicts ";
    if (!one && !bounds.empty()) answer.text += ", with ";
    if (!bounds.empty()) answer.text += (bounds.size() == 1 ? "the bound " : "the bounds ") + limits;
    if (out_.conflict->smallest && all.size() > 1)
      answer.text += "; no contradiction was found without any one of these";
    out_.answers.push_back(std::move(answer));
  }

  /// Looks for a contradiction, and a repair, of the linearisation at the best point.
  void tell_linearised() {
    CountedMcp counted(mcp_);
    Point best;
    best.x = out_.result.x;
    best.J = mcp_.jacobian_pattern();
    if (!counted.eval(best.x, best.F) || !counted.jacobian(best.x, best.J)) return;
    const lcp::AffineMcp linear{best.J, best.F - best.J * best.x, mcp_.box()};
    if (linear.invalid()) return;
    const std::vector<char> every;
    const LinearDemands demands(linear, every);
    if (!out_.conflict) {
      out_.conflict = smallest_conflict(demands, demands.all(), part_of_time(0.5));
      if (!out_.conflict) return;
      out_.conflict->proof = {};
      tell_conflict(false);
      out_.answers.back().text = "near the best point found " + out_.answers.back().text;
    }
    repair(demands);
  }

  void repair(const LinearDemands& demands) {
    const Demands all = demands.all();
    const auto found = demands.repaired(all, part_of_time(0.5));
    if (!found || !(found->total > 0)) return;
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (found->missed[k] == 0) continue;
      const Index i = all[k].index;
      const double from = all[k].of == Demand::Row     ? 0
                          : all[k].of == Demand::Lower ? mcp_.box().lower[i]
                                                       : mcp_.box().upper[i];
      out_.repair.changes.push_back({all[k], from, from - (all[k].of == Demand::Row ? -1 : 1) * found->missed[k]});
    }
    out_.repair.least = mcp_.is_affine();
    Functions mended = changed(mcp_, out_.repair.changes);
    stop(method_).max_time = Seconds(part_of_time(0.8) - std::chrono::steady_clock::now());
    if (!mended.box.invalid() && stop(method_).max_time.count() > 0)
      out_.repair.verified = solve(*make_mcp(std::move(mended)), x0_, method_).accepted();
    tell_repair();
  }

  void tell_repair() {
    const std::vector<Change>& changes = out_.repair.changes;
    Demands what;
    for (const Change& c : changes) what.push_back(c.what);
    Answer answer = answer_of(Kind::Repair, out_.repair.verified, what);
    answer.text =
        (out_.repair.least ? "the least change that would mend this, up to rounding: "
                           : "a change that may mend it: ") +
        listed(changes.size(),
               [&](std::size_t k) {
                 const Change& c = changes[k];
                 if (c.what.of == Demand::Row)
                   return "add " + number(c.to) + " to the left-hand side of row " + mcp_.equation_name(c.what.index);
                 return std::string(c.what.of == Demand::Lower ? "lower" : "upper") + " bound of " +
                        mcp_.variable_name(c.what.index) + " " + number(c.to) + " in place of " + number(c.from);
               }) +
        (out_.repair.verified ? "; with it the model has a solution, which was found"
                              : "; no solution was found of the model with it, either");
    out_.answers.push_back(std::move(answer));
  }

  /// The rows that hold least.
  void tell_residual() {
    const Result& r = out_.result;
    if (r.F.size() != mcp_.size() || !r.F.allFinite()) {
      out_.answers.push_back({.kind = Kind::Residual, .text = r.message});
      return;
    }
    const Vec missed = row_residuals(mcp_.box(), r.x, r.F);
    constexpr double share = 0.1;  // of the largest
    Indices rows(at(mcp_.size()));
    std::iota(rows.begin(), rows.end(), Index{0});
    std::erase_if(rows, [&](Index i) { return !(missed[i] > share * r.residual.natural); });
    std::ranges::stable_sort(rows, std::greater{}, [&](Index i) { return missed[i]; });
    std::string text = "at the best point found " + listed(rows.size(), [&](std::size_t k) {
                         return "row " + mcp_.equation_name(rows[k]) + " is missed by " + number(missed[rows[k]]);
                       });
    out_.answers.push_back({.kind = Kind::Residual, .rows = rows, .variables = rows, .text = std::move(text)});
  }

  const Mcp& mcp_;
  const Vec x0_;
  Method method_;
  lcp::Deadline deadline_;
  Explanation out_;
};

}  // namespace

std::string_view to_string(Answer::Kind kind) { return word_of(kind, kinds); }

Explanation explain(const Mcp& mcp, In x0, const ExplainOptions& options, const std::atomic<bool>* interrupt) {
  check_input(mcp, x0);
  return Explainer(mcp, x0, options, interrupt).explain();
}

}  // namespace perp::ncp
