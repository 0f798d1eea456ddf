// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The numbers of a report as CSV (RFC 4180, header, one record a line) and JSON.
#include <string>
#include <utility>
#include <vector>

#include "app/comparison_report/page.hpp"

namespace perp::app::comparison {

/// File names and contents:
///   methods.csv       method,name,options,external,C-function and yes/no a comparison: does it take part?
///   pairs.csv         problem,start,class,n,nonzeros,solvable and yes/no a comparison: does it count?
///   profiles.csv      comparison,kind,cost,method,x,count,of: from x on `count` of `of` pairs; a method that solves
///                     nothing has x = inf, count = 0
///   summary.csv       of each comparison, a line a method
///   robustness.csv    method,class,pairs,failures,after_restarts; class "total" has the sums
///   unsolvable.csv    method,infeasible,honest,wrong,broken,not_applicable,unfinished
///   false_claims.csv  the cells, as cells.csv has them
///   curves.csv        method,problem,start,point,natural
///   findings.txt      a sentence a line
///   report.json       profiles, summaries, robustness, unsolvable, findings
std::vector<std::pair<std::string, std::string>> data_files(const ReportParts& parts);

}  // namespace perp::app::comparison
