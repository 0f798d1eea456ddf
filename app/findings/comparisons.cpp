// SPDX-License-Identifier: Apache-2.0
#include "app/findings/comparisons.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace perp::app::comparison {

namespace {

using Indices = std::vector<std::size_t>;

double units(const CampaignData& data, std::size_t pair, Measure measure) {
  return measure == Measure::FEvals ? static_cast<double>(data.problem(pair).n) + 1 : 1;
}

MeasureProfiles profiles(const CampaignData& data, const Comparison& comparison, Measure measure) {
  MeasureProfiles result{.measure = measure};
  Costs t;
  for (const std::size_t m : comparison.methods) {
    std::vector<double> row;
    for (const std::size_t p : comparison.pairs)
      if (const auto known = cost(*data.at(m, p), measure)) row.push_back(*known);
    const bool complete = row.size() == comparison.pairs.size();
    (complete ? result.methods : result.left_out).push_back(m);
    if (complete) t.push_back(std::move(row));
  }
  std::vector<double> unit;
  for (const std::size_t p : comparison.pairs) unit.push_back(units(data, p, measure));
  result.performance = performance_profiles(t);
  result.data = data_profiles(t, unit);
  return result;
}

/// Keeps the pairs that all have finished, orders the methods, draws the profiles.
void finish(const CampaignData& data, Comparison& comparison) {
  std::erase_if(comparison.methods, [&](std::size_t m) {
    return std::ranges::all_of(comparison.pairs, [&](std::size_t p) { return data.at(m, p) == nullptr; });
  });
  comparison.unfinished = std::erase_if(comparison.pairs, [&](std::size_t p) {
    return comparison.methods.empty() ||
           std::ranges::any_of(comparison.methods, [&](std::size_t m) { return data.at(m, p) == nullptr; });
  });
  struct Rank {
    std::size_t failures;
    double log_time;
  };
  std::vector<Rank> rank(data.methods().size());
  for (const std::size_t m : comparison.methods) {
    Rank& r = rank[m] = {0, 0};
    for (const std::size_t p : comparison.pairs)
      if (solved(*data.at(m, p)))
        r.log_time += std::log(std::max(data.at(m, p)->seconds, floor_of(Measure::Seconds)));
      else
        ++r.failures;
  }
  std::ranges::sort(comparison.methods, {},
                    [&](std::size_t m) { return std::tuple(rank[m].failures, rank[m].log_time, data.label(m)); });
  for (std::size_t k = 0; k < measures.size(); ++k) comparison.profiles[k] = profiles(data, comparison, measures[k]);
}

/// Does it apply to affine problems only, as far as it has got?
bool for_affine_problems(const CampaignData& data, std::size_t m) {
  bool refused = false;
  for (std::size_t p = 0; p < data.pairs().size(); ++p) {
    const Cell* cell = data.at(m, p);
    if (cell == nullptr || data.problem(p).affine) continue;
    if (applies(*cell)) return false;
    refused = true;
  }
  return refused;
}

/// Is there a finished pair with a solution that it does not apply to?
bool refuses_some(const CampaignData& data, std::size_t m) {
  for (std::size_t p = 0; p < data.pairs().size(); ++p)
    if (const Cell* cell = data.at(m, p); data.problem(p).solvable() && cell != nullptr && !applies(*cell)) return true;
  return false;
}

/// Solvable pairs to which one of the methods applies.
Indices pairs_of(const CampaignData& data, const Indices& methods) {
  Indices pairs;
  for (std::size_t p = 0; p < data.pairs().size(); ++p)
    if (data.problem(p).solvable() && std::ranges::any_of(methods, [&](std::size_t m) {
          return data.at(m, p) == nullptr || applies(*data.at(m, p));
        }))
      pairs.push_back(p);
  return pairs;
}

Indices joined(Indices a, const Indices& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// A word for file names: letters, digits and dashes.
std::string word(std::string_view text) {
  std::string result;
  for (const char c : text)
    if ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'))
      result += c;
    else if (!result.ends_with('-'))
      result += '-';
  return result;
}

/// Methods with an option for the C-function and, as one of them, the same without if it was run and its own is not
/// among theirs.
void add_cfunctions(const CampaignData& data, const Indices& variants, std::vector<Comparison>& all) {
  std::vector<std::string> bases;
  const auto base = [&](std::size_t m) { return without_cfunction(data.methods()[m]); };
  for (const std::size_t m : variants)
    if (std::ranges::find(bases, base(m)) == bases.end()) bases.push_back(base(m));
  for (const std::string& name : bases) {
    Comparison comparison{.id = "cfunctions-" + word(name), .title = fmt::format("C-functions in {}", name)};
    while (std::ranges::find(all, comparison.id, &Comparison::id) != all.end()) comparison.id += "-2";
    for (const std::size_t m : variants)
      if (base(m) == name) comparison.methods.push_back(m);
    for (std::size_t m = 0; m < data.methods().size(); ++m) {
      const auto same = [&](std::size_t variant) {
        return given_cfunction(data.methods()[variant]) == cfunction_in_force(data.methods()[m]);
      };
      if (base(m) == name && given_cfunction(data.methods()[m]).empty() &&
          std::ranges::none_of(comparison.methods, same))
        comparison.methods.push_back(m);
    }
    if (comparison.methods.size() < 2) continue;
    comparison.pairs = pairs_of(data, comparison.methods);
    comparison.note = "The same method; nothing differs but its C-function.";
    all.push_back(std::move(comparison));
  }
}

}  // namespace

std::string_view column(Measure measure) {
  return measure == Measure::Seconds ? "seconds" : measure == Measure::FEvals ? "F_evals" : "factorizations";
}

std::string_view words(Measure measure) {
  return measure == Measure::Seconds ? "time" : measure == Measure::FEvals ? "evaluations of F" : "factorizations";
}

double floor_of(Measure measure) { return measure == Measure::Seconds ? 1e-3 : 1; }

std::optional<double> cost(const Cell& cell, Measure measure) {
  if (!solved(cell)) return std::numeric_limits<double>::infinity();
  const double value = measure == Measure::Seconds  ? cell.seconds
                       : measure == Measure::FEvals ? cell.F_evals
                                                    : cell.factorizations;
  if (!(value >= 0) || std::isinf(value)) return {};
  return std::max(value, floor_of(measure));
}

std::string name_in(const CampaignData& data, const Comparison& comparison, std::size_t method) {
  if (!comparison.id.starts_with("cfunctions")) return data.label(method);
  const std::string given = given_cfunction(data.methods()[method]);
  return given.empty() ? cfunction_in_force(data.methods()[method]) + " (default)" : given;
}

std::vector<bool> in_colour(const CampaignData& data, const Comparison& comparison) {
  constexpr std::size_t most = 8, most_of_subject = 5;
  std::vector<bool> chosen(data.methods().size(), false);
  std::size_t count = 0;
  for (const std::size_t m : comparison.methods)
    if (count < most_of_subject && std::ranges::find(comparison.subject, m) != comparison.subject.end())
      chosen[m] = true, ++count;
  for (const std::size_t m : comparison.methods)
    if (count < most && !chosen[m]) chosen[m] = true, ++count;
  return chosen;
}

std::optional<std::size_t> plain_method(const CampaignData& data, std::string_view name) {
  for (std::size_t m = 0; m < data.methods().size(); ++m) {
    const compare::AskedMethod& method = data.methods()[m];
    if (method.name == name && method.options.empty() && !method.external()) return m;
  }
  return {};
}

std::vector<Comparison> comparisons(const CampaignData& data) {
  Indices general, affine, external, variants;
  for (std::size_t m = 0; m < data.methods().size(); ++m) {
    const compare::AskedMethod& method = data.methods()[m];
    Indices& kind = !given_cfunction(method).empty()                     ? variants
                    : method.external() && refuses_some(data, m)         ? external
                    : !method.external() && for_affine_problems(data, m) ? affine
                                                                         : general;
    kind.push_back(m);
  }
  const auto systems = [&](std::string_view suffix) {
    Indices eight;
    for (const std::string_view name : lecture)
      if (const auto m = plain_method(data, fmt::format("{}{}", name, suffix))) eight.push_back(*m);
    return eight;
  };

  std::vector<Comparison> all;
  if (general.empty() && affine.empty() && external.empty()) general = variants;
  if (!general.empty())
    all.push_back({.id = "general",
                   .title = "Methods for all problems",
                   .note = "On every pair of a problem with a solution and a start; what a method does not apply to it "
                           "has not solved.",
                   .methods = general,
                   .pairs = pairs_of(data, general)});
  if (!affine.empty())
    all.push_back({.id = "affine",
                   .title = "Methods for affine problems, beside those for all problems",
                   .note = fmt::format("On the pairs to which at least one of the {} that are for affine problems only "
                                       "applies; what a method does not apply to it has not solved.",
                                       affine.size()),
                   .subject = affine,
                   .methods = joined(affine, general),
                   .pairs = pairs_of(data, affine)});
  if (!external.empty())
    all.push_back({.id = "external",
                   .title = "External programs, beside the methods for all problems",
                   .note = "On the pairs that an external program was given.",
                   .subject = external,
                   .methods = joined(external, general),
                   .pairs = pairs_of(data, external)});
  constexpr std::string_view source = "Billups, Dirkse & Ferris, Comput. Optim. Appl. 7 (1997) 3";
  if (const Indices eight = systems(""); eight.size() >= 2 && eight.size() < general.size())
    all.push_back({.id = "lecture",
                   .title = "The systems of the 1997 comparison",
                   .note = fmt::format("{}; here Perp's presets of these names, with what was added since.", source),
                   .methods = eight,
                   .pairs = pairs_of(data, eight)});
  if (const Indices eight = systems(as_published); eight.size() >= 2 && eight.size() < general.size())
    all.push_back({.id = "published",
                   .title = "The systems of the 1997 comparison, as published",
                   .note = fmt::format("{}; without what was added since.", source),
                   .methods = eight,
                   .pairs = pairs_of(data, eight)});
  add_cfunctions(data, variants, all);
  for (Comparison& comparison : all) finish(data, comparison);
  return all;
}

}  // namespace perp::app::comparison
