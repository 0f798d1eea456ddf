// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A made-up campaign in which everything happens, and the files of its report read back.
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "app/campaign/cell.hpp"
#include "app/compare/campaign_support.hpp"
#include "app/text/csv.hpp"

namespace perp::app::test {

using Records = std::vector<std::vector<std::string>>;

inline Records csv(const Folder& folder, const std::string& name) { return parse_csv(test::read(folder / name)); }

inline constexpr const char* nasty = "</script><script>alert(1)</script> & \"q\" 'x' <b>\n\x01 \xff \xc3\xa9";

/// Three methods, one of them for affine problems and one with another C-function, four problems, everything that can
/// happen.
inline MadeUp small_campaign() {
  MadeUp made_up;
  made_up.method("path")
      .method("smooth")
      .method("semismooth", "fischer-burmeister")
      .method("semismooth:cfunction=min", "min");
  made_up.method("lemke").method("<evil> & \"co\"");
  made_up.campaign.methods.back().command = nasty;
  made_up.problem("kojshin", "tiny", 4, 2).problem("ahn", "lcp", 128).problem("nash, \"10\"", "games", 10);
  made_up.problem("none", "lcp", 2, 1, "the first row is negative").problem("</script><i>x", "nl", 3);
  const std::array seconds{0.002, 0.004, 0.008, 0.016, 0.032, 0.064};
  std::size_t k = 0;
  for (const auto& method : made_up.campaign.methods)
    for (const auto& problem : made_up.campaign.problems)
      for (int start = 1; start <= problem.starts; ++start, ++k) {
        const bool affine = method.label == "lemke" && problem.cls != "lcp";
        const Outcome outcome = affine                   ? Outcome::NotApplicable
                                : problem.name == "none" ? Outcome::Infeasible
                                : k % 5 == 3             ? Outcome::Failed
                                : method.external()      ? Outcome::FalseConvergence
                                                         : Outcome::Solved;
        Cell& cell = made_up.run(method.label, problem.name, outcome, seconds[k * 7 % 6], static_cast<int>(3 + k % 4));
        cell.start = start;
        if (outcome == Outcome::Failed) cell.restarts = 1, cell.outcome_after_restarts = Outcome::Solved;
        if (outcome != Outcome::Solved) cell.message = nasty;
      }
  made_up.cells[3].natural = std::nan("");
  made_up.cells[3].curve = {std::numeric_limits<double>::infinity(), std::nan(""), 0};
  made_up.cells[3].iterations = -1;
  return made_up;
}

}  // namespace perp::app::test
