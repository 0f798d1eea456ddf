// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The report as one HTML page that needs nothing else: no network, no library. Private to comparison_report/.
#include <string>
#include <vector>

#include "app/findings/comparisons.hpp"
#include "app/findings/findings.hpp"

namespace perp::app::comparison {

/// All that is computed before anything is written.
struct ReportParts {
  const CampaignData& data;
  std::vector<Comparison> comparisons{};
  std::vector<Finding> findings{};
};

std::string page(const ReportParts& parts);

// Its sections, as HTML.
std::string false_claims_section(const CampaignData& data);
std::string robustness_section(const CampaignData& data);
std::string unsolvable_section(const CampaignData& data);
/// `styles`: of the curves, one a method.
std::string comparison_section(const CampaignData& data, const Comparison& comparison,
                               const std::vector<std::size_t>& styles);
/// Of a comparison of C-functions with their parameters: the share of pairs solved over the values, as SVG; "" where no
/// function has two.
std::string parameter_chart(const CampaignData& data, const Comparison& comparison);
std::string method_section(const CampaignData& data);  ///< how, when, where it ran

/// The cells for the page's script: {"tol", "methods": [label...], "styles", "problems": [[name, class, n]...],
/// "outcomes": [...], "shown", "cells": [[method, problem, start, outcome, after restarts, status, natural, iterations,
/// F_evals, J_evals, factorizations, krylov_iterations, restarts, seconds, peak_mb, message, curve]...]}, methods,
/// problems and outcomes by index, what is not known null, the curve as round(100 log10(natural residual)).
std::string cells_data(const CampaignData& data, const std::vector<std::size_t>& styles);

/// Static text of the page: comparison_report/assets.
std::string_view page_style();
std::string_view chart_style();  ///< the part of it for charts that stand alone
std::string_view page_script();
std::string_view page_script_curves();

}  // namespace perp::app::comparison
