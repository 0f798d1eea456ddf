// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Which methods are compared with which, on which pairs, by which costs.
///
///   general        the methods that are not for affine problems only, on all pairs that have a solution
///   affine         beside them those for affine problems only, on the pairs to which one of these applies
///   external       external programs that do not apply everywhere beside the general methods, on their pairs
///   lecture        the eight systems of the 1997 comparison, as far as the campaign has them
///   published      the same as published
///   cfunctions-K   methods that differ in nothing but their option cfunction
///
/// Methods with an option cfunction are in the last kind only (unless the campaign has no others). Each comparison
/// counts the pairs only that all of its methods have finished, and leaves out methods that have finished none. What a
/// method does not apply to it has not solved.
#include <array>
#include <optional>

#include "app/findings/campaign_data.hpp"
#include "app/findings/profiles.hpp"

namespace perp::app::comparison {

enum class Measure { Seconds, FEvals, Factorizations };
inline constexpr std::array measures{Measure::Seconds, Measure::FEvals, Measure::Factorizations};
std::string_view column(Measure measure);  ///< of cells.csv
std::string_view words(Measure measure);   ///< "time", "evaluations of F", "factorizations"
/// Costs below it count as it: times below it are noise, and a cost of 0 has no ratios.
double floor_of(Measure measure);
/// Infinite where not solved; empty where solved at a cost that is not known.
std::optional<double> cost(const Cell& cell, Measure measure);

struct MeasureProfiles {
  Measure measure = Measure::Seconds;
  std::vector<std::size_t> methods{};   ///< in the comparison's order
  std::vector<std::size_t> left_out{};  ///< costs that are not known
  std::vector<Profile> performance{};   ///< one a method
  std::vector<Profile> data{};          ///< evaluations of F in units of n + 1, others as they are
};

struct Comparison {
  std::string id{};     ///< for file names and columns
  std::string title{};  ///< for people
  std::string note{};
  std::vector<std::size_t> subject{};  ///< those for some problems only that it is about, if it is about them
  std::vector<std::size_t> methods{};  ///< most solved first, then least sum of log(time) over what they solve
  std::vector<std::size_t> pairs{};
  std::size_t unfinished = 0;  ///< pairs left out
  std::array<MeasureProfiles, measures.size()> profiles{};
};

/// Those with two methods at least; `general` also with one. In the order above.
std::vector<Comparison> comparisons(const CampaignData& data);

/// The 1997 comparison's systems; the first three are those the lecture puts ahead.
inline constexpr std::array<std::string_view, 8> lecture{"proxi", "path",   "smooth",   "miles",
                                                         "nesqp", "qpcomp", "semicomp", "semismooth"};
inline constexpr std::size_t lecture_ahead = 3;
/// What ends the names of the presets that are as published.
inline constexpr std::string_view as_published = "-1997";
/// What a method is called in a comparison: its label; among C-functions theirs.
std::string name_in(const CampaignData& data, const Comparison& comparison, std::size_t method);
/// The eight to be shown in colour, by method: those that solve most; of the subject, if there is one, five.
std::vector<bool> in_colour(const CampaignData& data, const Comparison& comparison);

/// Index of the method of that name without options; nothing if the campaign has none.
std::optional<std::size_t> plain_method(const CampaignData& data, std::string_view name);

}  // namespace perp::app::comparison
