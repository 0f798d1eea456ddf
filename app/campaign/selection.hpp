// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The LISTs of `perp compare`: which problems, which methods.
///
/// A LIST is comma-separated. An item that begins with - takes away what it names, wherever it stands; a LIST of
/// nothing but such items takes them from all. Nothing is taken twice. What names nothing is refused, with
/// suggestions.
///
///     problems   all   NAME   NAME:SIZE   class:CLASS   FILE.nl   FILE.dat
///     methods    all   presets   cfunctions   cfunction-grid   none   NAME   NAME:key=value:key=value
///
/// NAME, CLASS and FILE may have * ? and [...]. `cfunctions` is semismooth over every C-function,
/// `cfunctions:rho=0.01:rho=100` over the same, those with a parameter rho at these values; `cfunction-grid` over those
/// with a parameter, at several values of it.
#include <string>
#include <vector>

#include "app/campaign/campaign.hpp"
#include "app/options/options.hpp"

namespace perp::app::compare {

/// Name, file and class of each problem; the rest is found out by building it (app/worker/worker.hpp). Files are known
/// by their name without the folder: two of one name are refused. Throws InputError.
std::vector<AskedProblem> select_problems(const std::string& list);

/// Label, name, options and the options in force, for the judge's tolerance `tol`. Notes: options without effect.
/// Throws InputError.
std::vector<AskedMethod> select_methods(const std::string& list, double tol, std::vector<std::string>& notes);

/// NAME=COMMAND of an external program. Throws InputError: no NAME, one of a method, or a COMMAND whose first word is
/// no program.
AskedMethod parse_external(const std::string& text);

/// The method of an AskedMethod that is not external, its options applied.
Applied settings_of(const AskedMethod& method, double tol);

}  // namespace perp::app::compare
