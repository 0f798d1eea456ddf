// SPDX-License-Identifier: Apache-2.0
#include "app/findings/summary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace perp::app::comparison {

namespace {

/// exp of the mean of log(max(v, floor)); NaN where a value is not known or there is none.
class GeometricMean {
 public:
  void add(double value, double floor) {
    sum_ += value < 0 ? std::numeric_limits<double>::quiet_NaN() : std::log(std::max(value, floor));
    ++count_;
  }
  double value() const {
    return count_ == 0 ? std::numeric_limits<double>::quiet_NaN() : std::exp(sum_ / static_cast<double>(count_));
  }

 private:
  double sum_ = 0;
  std::size_t count_ = 0;
};

/// Pairs with the least cost and with at most twice that, by method; 0 where the costs are not known.
struct Leads {
  std::size_t first = 0, within_two = 0;
};
Leads leads(const MeasureProfiles& profiles, std::size_t method) {
  const auto found = std::ranges::find(profiles.methods, method);
  if (found == profiles.methods.end()) return {};
  const Profile& rho = profiles.performance[static_cast<std::size_t>(found - profiles.methods.begin())];
  return {rho.count(1), rho.count(2)};
}

}  // namespace

std::size_t Summary::compared() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(rows, [](const SummaryRow& row) { return !std::isnan(row.F_evals); }));
}

std::pair<const SummaryRow*, const SummaryRow*> Summary::extremes(double SummaryRow::*mean) const {
  std::pair<const SummaryRow*, const SummaryRow*> result{nullptr, nullptr};
  for (const SummaryRow& row : rows) {
    if (std::isnan(row.*mean)) continue;
    if (result.first == nullptr || row.*mean < result.first->*mean) result.first = &row;
    if (result.second == nullptr || row.*mean > result.second->*mean) result.second = &row;
  }
  return result;
}

namespace {

SummaryRow counts(const CampaignData& data, const Comparison& comparison, std::size_t m) {
  SummaryRow row{.method = m};
  for (const std::size_t p : comparison.pairs) {
    const Cell& cell = *data.at(m, p);
    row.solved += solved(cell) ? 1 : 0;
    row.after += solved(cell) || cell.outcome_after_restarts == Outcome::Solved ? 1 : 0;
  }
  const Leads time = leads(comparison.profiles[0], m);
  row.quickest = time.first;
  row.within_two = time.within_two;
  row.fewest_F = leads(comparison.profiles[1], m).first;
  return row;
}

void set_means(const CampaignData& data, const std::vector<std::size_t>& pairs, SummaryRow& row) {
  GeometricMean iterations, F_evals, factorizations, seconds;
  for (const std::size_t p : pairs) {
    const Cell& cell = *data.at(row.method, p);
    iterations.add(cell.iterations, 1);
    F_evals.add(cell.F_evals, floor_of(Measure::FEvals));
    factorizations.add(cell.factorizations, floor_of(Measure::Factorizations));
    seconds.add(cell.seconds, floor_of(Measure::Seconds));
  }
  row.iterations = iterations.value();
  row.F_evals = F_evals.value();
  row.factorizations = factorizations.value();
  row.seconds = seconds.value();
}

}  // namespace

Summary summary(const CampaignData& data, const Comparison& comparison) {
  Summary result{.rows = {}, .pairs = comparison.pairs.size()};
  std::size_t most = 0;
  for (const std::size_t m : comparison.methods) {
    result.rows.push_back(counts(data, comparison, m));
    most = std::max(most, result.rows.back().solved);
  }
  const auto takes_part = [&](const SummaryRow& row) { return most > 0 && 4 * row.solved >= 3 * most; };
  std::vector<std::size_t> common;
  for (const std::size_t p : comparison.pairs)
    if (std::ranges::all_of(result.rows,
                            [&](const SummaryRow& row) { return !takes_part(row) || solved(*data.at(row.method, p)); }))
      common.push_back(p);
  if (most > 0) result.common = common.size();
  for (SummaryRow& row : result.rows) set_means(data, takes_part(row) ? common : std::vector<std::size_t>{}, row);
  return result;
}

double Duel::p_value() const {
  const auto n = static_cast<double>(only_a + only_b);
  const std::size_t fewer = std::min(only_a, only_b);
  double tail = 0;
  double log_term = -n * std::log(2.0);  // of C(n, k) 2^-n; lgamma() has a global in C
  for (std::size_t k = 0; k <= fewer; ++k) {
    tail += std::exp(log_term);
    log_term += std::log((n - static_cast<double>(k)) / static_cast<double>(k + 1));
  }
  return std::min(1.0, 2 * tail);
}

bool Duel::beyond_rounding() const {
  const std::size_t lead = std::max(only_a, only_b) - std::min(only_a, only_b);
  return static_cast<double>(lead) > rounding_share * static_cast<double>(pairs);
}

Duel duel(const CampaignData& data, const std::vector<std::size_t>& pairs, std::size_t a, std::size_t b) {
  Duel result{.pairs = pairs.size()};
  for (const std::size_t p : pairs) {
    const bool a_solves = data.at(a, p) != nullptr && solved(*data.at(a, p));
    const bool b_solves = data.at(b, p) != nullptr && solved(*data.at(b, p));
    result.only_a += a_solves && !b_solves ? 1 : 0;
    result.only_b += b_solves && !a_solves ? 1 : 0;
  }
  return result;
}

}  // namespace perp::app::comparison
