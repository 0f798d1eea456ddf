// SPDX-License-Identifier: Apache-2.0
#include "app/findings/findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "app/findings/summary.hpp"

namespace perp::app::comparison {

namespace {

using Indices = std::vector<std::size_t>;

std::vector<std::string> labels(const CampaignData& data, const Indices& methods) {
  std::vector<std::string> names;
  for (const std::size_t m : methods) names.push_back(data.label(m));
  return names;
}

/// How many of these pairs each of these methods has solved; those with the most, and with the next most.
struct Top {
  Indices first{}, second{};
  std::size_t most = 0, next = 0;
};
Top top(const Indices& methods, const std::function<std::size_t(std::size_t)>& count) {
  Top result;
  for (const std::size_t m : methods) result.most = std::max(result.most, count(m));
  for (const std::size_t m : methods)
    if (count(m) < result.most) result.next = std::max(result.next, count(m));
  for (const std::size_t m : methods) {
    if (count(m) == result.most)
      result.first.push_back(m);
    else if (count(m) == result.next)
      result.second.push_back(m);
  }
  return result;
}

std::size_t solved_of(const CampaignData& data, const Indices& pairs, std::size_t method) {
  return static_cast<std::size_t>(
      std::ranges::count_if(pairs, [&](std::size_t p) { return solved(*data.at(method, p)); }));
}

/// "113 of 119 pairs (95.0 %)".
std::string of_pairs(std::size_t count, std::size_t pairs) {
  return fmt::format("{} of {} ({})", count, counted(pairs, "pair"), percent(count, pairs));
}

std::string scope(const CampaignData& data) {
  const compare::Campaign& campaign = data.campaign();
  std::string text = fmt::format("{} on {}: {} of a problem and a start, {}.", counted(data.methods().size(), "method"),
                                 counted(campaign.problems.size(), "problem"), counted(data.pairs().size(), "pair"),
                                 counted(campaign.cells(), "run"));
  if (data.cells().empty()) return text + " None of them is finished: nothing can be said yet.";
  if (data.cells().size() < campaign.cells())
    text += fmt::format(
        " {} of them are not finished: what follows is provisional, and counts the pairs only that all "
        "methods compared have finished.",
        campaign.cells() - data.cells().size());
  return text;
}

/// Who solves most, and who cannot be told from them.
std::string most_solved(const CampaignData& data, const Comparison& comparison) {
  const auto count = [&](std::size_t m) { return solved_of(data, comparison.pairs, m); };
  const Top best = top(comparison.methods, count);
  const std::size_t pairs = comparison.pairs.size();
  if (best.most == 0) return fmt::format("No method solves any of the {} with a solution.", counted(pairs, "pair"));
  if (comparison.methods.size() == 1)
    return fmt::format("{} solves {} of a problem with a solution and a start.", data.label(comparison.methods[0]),
                       of_pairs(best.most, pairs));
  if (best.second.empty())
    return fmt::format("All {} methods solve as many, {}.", comparison.methods.size(), of_pairs(best.most, pairs));
  std::string text = fmt::format("{} {} the most: {} with a solution; ", listed(labels(data, best.first)),
                                 verb(best.first.size(), "solve"), of_pairs(best.most, pairs));
  text += fmt::format("next {} {} with {}.", verb(best.second.size(), "come"), listed(labels(data, best.second)),
                      best.next);
  Indices close;
  for (const std::size_t m : comparison.methods)
    if (count(m) < best.most && !duel(data, comparison.pairs, best.first[0], m).clear()) close.push_back(m);
  if (!close.empty())
    text +=
        fmt::format(" Not clearly behind {}: {}.", best.first.size() > 1 ? "them" : "it", listed(labels(data, close)));
  const std::size_t least = count(*std::ranges::min_element(comparison.methods, {}, count));
  Indices last;
  std::ranges::copy_if(comparison.methods, std::back_inserter(last), [&](std::size_t m) { return count(m) == least; });
  if (least < best.next) text += fmt::format(" Fewest: {} with {}.", listed(labels(data, last)), least);
  return text;
}

/// " The external programs: a 3, b 2.", in the comparison's order.
std::string subject(const CampaignData& data, const Comparison& comparison, const char* whose) {
  std::vector<std::string> counts;
  for (const std::size_t m : comparison.methods)
    if (std::ranges::find(comparison.subject, m) != comparison.subject.end())
      counts.push_back(fmt::format("{} {}", data.label(m), solved_of(data, comparison.pairs, m)));
  return counts.empty() ? "" : fmt::format(" {}: {}.", whose, fmt::join(counts, ", "));
}

std::string cheapest(const CampaignData& data, const Comparison& comparison) {
  const Summary all = summary(data, comparison);
  if (comparison.methods.size() < 2 ||
      std::ranges::all_of(all.rows, [](const SummaryRow& row) { return row.solved == 0; }))
    return "";
  const auto leader = [&](std::size_t SummaryRow::*field) {
    return top(comparison.methods,
               [&](std::size_t m) { return (*std::ranges::find(all.rows, m, &SummaryRow::method)).*field; });
  };
  const Top quickest = leader(&SummaryRow::quickest);
  const Top within = leader(&SummaryRow::within_two);
  const Top fewest = leader(&SummaryRow::fewest_F);
  std::string text = fmt::format("Quickest most often {} {} (on {}; times below 1 ms are ties)",
                                 is(quickest.first.size()), listed(labels(data, quickest.first)), quickest.most);
  text += fmt::format(", within twice the least time most often {} (on {})", listed(labels(data, within.first)),
                      within.most);
  if (fewest.most > 0)
    text += fmt::format("; the fewest evaluations of F most often {} {} (on {})", verb(fewest.first.size(), "need"),
                        listed(labels(data, fewest.first)), fewest.most);
  return text + ".";
}

/// "games: path alone (23 of 24, next auto 22: no clear lead)".
std::string of_class(const CampaignData& data, const Comparison& comparison, const Indices& pairs,
                     const std::string& cls) {
  const Top best = top(comparison.methods, [&](std::size_t m) { return solved_of(data, pairs, m); });
  if (best.most == 0) return fmt::format("{}: none (0 of {})", cls, pairs.size());
  if (best.second.empty()) return fmt::format("{}: all alike ({} of {})", cls, best.most, pairs.size());
  std::string text = fmt::format("{}: {}{} ({} of {}", cls, listed(labels(data, best.first)),
                                 best.first.size() == 1 ? " alone" : "", best.most, pairs.size());
  if (best.first.size() == 1)
    text += fmt::format(", next {} {}{}", listed(labels(data, best.second)), best.next,
                        duel(data, pairs, best.first[0], best.second[0]).clear() ? "" : ": no clear lead");
  return text + ")";
}

std::string by_class(const CampaignData& data, const Comparison& comparison) {
  std::vector<std::string> judged, few;
  if (data.classes(true).size() < 2) return "";  // all is said
  for (const std::string& cls : data.classes(true)) {
    Indices pairs;
    std::ranges::copy_if(comparison.pairs, std::back_inserter(pairs),
                         [&](std::size_t p) { return data.problem(p).cls == cls; });
    if (pairs.size() < few_pairs)
      few.push_back(cls);
    else
      judged.push_back(of_class(data, comparison, pairs, cls));
  }
  std::string text;
  if (!judged.empty()) text = fmt::format("The most are solved in {}.", fmt::join(judged, "; "));
  if (!few.empty())
    text += fmt::format("{}Fewer than {} pairs, too few to tell: {}.", text.empty() ? "" : " ", few_pairs,
                        fmt::join(few, ", "));
  return text;
}

std::string cfunctions(const CampaignData& data, const Comparison& comparison) {
  const auto names = [&](const Indices& methods) {
    std::vector<std::string> result;
    for (const std::size_t m : methods) result.push_back(name_in(data, comparison, m));
    return listed(result);
  };
  const Top best = top(comparison.methods, [&](std::size_t m) { return solved_of(data, comparison.pairs, m); });
  if (best.most == 0) return "None solves anything.";
  std::string text;
  if (best.second.empty()) {
    text = fmt::format("All {} solve as many, {}", comparison.methods.size(),
                       of_pairs(best.most, comparison.pairs.size()));
  } else {
    text += fmt::format("{} {} the most, {}; next {} {} with {}{}", names(best.first), verb(best.first.size(), "solve"),
                        of_pairs(best.most, comparison.pairs.size()), verb(best.second.size(), "come"),
                        names(best.second), best.next,
                        duel(data, comparison.pairs, best.first[0], best.second[0]).clear() ? "" : " (no clear lead)");
  }
  const Summary all = summary(data, comparison);
  if (all.common < few_pairs || all.compared() < 2) return text + ".";
  const auto [least, most] = all.extremes(&SummaryRow::F_evals);
  text += fmt::format(". On the {} that {} solve ", counted(all.common, "pair"),
                      all.compared() == all.rows.size() ? "all" : fmt::format("the best {} all", all.compared()));
  if (most->F_evals < 1.05 * least->F_evals) return text + "their evaluations of F differ by less than 5 %.";
  return text + fmt::format("{} needs the fewest evaluations of F (geometric mean {:.3g}), {} the most ({:.3g}).",
                            name_in(data, comparison, least->method), least->F_evals,
                            name_in(data, comparison, most->method), most->F_evals);
}

/// Comparisons of those whom the lecture puts ahead with the others.
struct Ranking {
  std::size_t more = 0, same = 0, fewer = 0, clearly_more = 0, clearly_fewer = 0;
  std::string verdict() const {
    if (clearly_more == 0 && clearly_fewer == 0) return "no difference between them is clear on these data";
    if (fewer == 0 && same == 0) return "its ranking holds on these data";
    if (fewer == 0 && more > 0) return "its ranking holds on these data, with ties";
    if (more > fewer) return "its ranking holds by and large";
    return more == fewer ? "its ranking does not show in these data" : "these data turn its ranking round";
  }
};

/// With the presets that have the systems' names, or with the systems as published.
std::string lecture_ranking(const CampaignData& data, std::string_view suffix) {
  Indices ahead, behind, all;
  for (std::size_t k = 0; k < lecture.size(); ++k)
    if (const auto m = plain_method(data, fmt::format("{}{}", lecture[k], suffix)))
      (k < lecture_ahead ? ahead : behind).push_back(*m), all.push_back(*m);
  Indices pairs;
  for (std::size_t p = 0; p < data.pairs().size(); ++p)
    if (data.problem(p).solvable() && std::ranges::all_of(all, [&](std::size_t m) { return data.at(m, p) != nullptr; }))
      pairs.push_back(p);
  if (ahead.empty() || behind.empty() || pairs.empty()) return "";
  const auto count = [&](std::size_t m) { return solved_of(data, pairs, m); };
  Ranking ranking;
  for (const std::size_t a : ahead)
    for (const std::size_t b : behind) {
      const Duel both = duel(data, pairs, a, b);
      const bool clear = both.clear();
      ++(!both.beyond_rounding() ? ranking.same : count(a) > count(b) ? ranking.more : ranking.fewer);
      ranking.clearly_more += clear && count(a) > count(b) ? 1 : 0;
      ranking.clearly_fewer += clear && count(a) < count(b) ? 1 : 0;
    }
  std::ranges::stable_sort(all, std::ranges::greater{}, count);
  std::vector<std::string> order;
  for (const std::size_t m : all) order.push_back(fmt::format("{} {}", data.label(m), count(m)));
  std::string text = fmt::format("The 1997 comparison of the lecture puts {} ahead of {}: {}. Solved of {}: {}.",
                                 listed(labels(data, ahead)), listed(labels(data, behind)), ranking.verdict(),
                                 counted(pairs.size(), "pair"), fmt::join(order, ", "));
  const std::size_t duels = ahead.size() * behind.size();
  if (duels > 1)
    text += fmt::format(
        " Taken two by two, the former solve more pairs than the latter in {} of {} comparisons ({} "
        "clearly), as many (but for rounding) in {}, fewer in {} ({} clearly).",
        ranking.more, duels, ranking.clearly_more, ranking.same, ranking.fewer, ranking.clearly_fewer);
  if (suffix.empty())
    text +=
        " These are this program's presets, with what was added since: presolve, rescalings, restarts by other "
        "methods.";
  return text;
}

std::string without_solution(const CampaignData& data) {
  Indices pairs, methods(data.methods().size());
  for (std::size_t m = 0; m < methods.size(); ++m) methods[m] = m;
  std::size_t claims = 0;
  for (std::size_t p = 0; p < data.pairs().size(); ++p) {
    if (data.problem(p).solvable()) continue;
    if (std::ranges::all_of(methods, [&](std::size_t m) { return data.at(m, p) != nullptr; })) pairs.push_back(p);
    claims += static_cast<std::size_t>(std::ranges::count_if(methods, [&](std::size_t m) {
      return data.at(m, p) != nullptr && data.at(m, p)->outcome == Outcome::FalseConvergence;
    }));
  }
  if (pairs.empty()) return "";
  const Top best = top(methods, [&](std::size_t m) {
    return static_cast<std::size_t>(
        std::ranges::count_if(pairs, [&](std::size_t p) { return data.at(m, p)->outcome == Outcome::Infeasible; }));
  });
  const std::string text =
      best.most == 0 ? fmt::format("No method recognises any of the {}", counted(pairs.size(), "pair"))
                     : fmt::format("{} {} the most: {} of {}", listed(labels(data, best.first)),
                                   verb(best.first.size(), "recognise"), best.most, counted(pairs.size(), "pair"));
  return text + (claims == 0 ? "; none claims a solution."
                             : fmt::format("; {} a solution.", counted(claims, "cell claims", "cells claim")));
}

std::string false_claims(const CampaignData& data) {
  Indices count(data.methods().size());
  std::size_t all = 0;
  for (std::size_t m = 0; m < count.size(); ++m)
    for (std::size_t p = 0; p < data.pairs().size(); ++p)
      if (const Cell* cell = data.at(m, p); cell != nullptr && false_claim(*cell)) ++count[m], ++all;
  if (all == 0) return "No method claimed what is not so.";
  std::vector<std::string> names;
  for (std::size_t m = 0; m < count.size(); ++m)
    if (count[m] > 0) names.push_back(fmt::format("{} {}", data.label(m), count[m]));
  return fmt::format("{} what is not so: {}.", counted(all, "cell claims", "cells claim"), listed(names));
}

}  // namespace

std::vector<Finding> findings(const CampaignData& data, const std::vector<Comparison>& comparisons) {
  std::vector<Finding> all{{"What ran", scope(data)}};
  if (data.cells().empty()) return all;
  const auto add = [&](const std::string& topic, const std::string& text) {
    if (!text.empty()) all.push_back({topic, text});
  };
  for (const Comparison& comparison : comparisons) {
    if (comparison.pairs.empty()) continue;
    if (comparison.id == "general") {
      add("Most solved", most_solved(data, comparison));
      add("Least cost", cheapest(data, comparison));
      add("Class by class", by_class(data, comparison));
    } else if (comparison.id == "affine") {
      add("Affine problems",
          most_solved(data, comparison) + subject(data, comparison, "The methods for affine problems"));
    } else if (comparison.id == "external") {
      add("Where external programs ran",
          most_solved(data, comparison) + subject(data, comparison, "The external programs"));
    } else if (comparison.id.starts_with("cfunctions")) {
      add(comparison.title, cfunctions(data, comparison));
    }
  }
  add("The lecture's ranking", lecture_ranking(data, ""));
  add("The lecture's ranking, as published", lecture_ranking(data, as_published));
  add("Problems without a solution", without_solution(data));
  add("False claims", false_claims(data));
  return all;
}

}  // namespace perp::app::comparison
