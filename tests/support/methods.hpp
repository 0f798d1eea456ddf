// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The methods, each with the name tests report.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "ncp/strategy/solve.hpp"
#include "support/problems.hpp"

namespace perp::support {

struct NamedMethod {
  std::string name;
  ncp::Method method;
};

using Variants = std::vector<NamedMethod>;

/// Variants with both C-functions and the linear algebra of each library.
inline Variants semismooth_variants() {
  return {{"Fischer-Burmeister", ncp::SemismoothNewton{}},
          {"min, escapes", ncp::escaping(ncp::SemismoothNewton{.cfunction = ncp::natural_min()})},
          {"Fischer-Burmeister, KLU", ncp::SemismoothNewton{.lu = lcp::LuBackend::Klu}},
          {"monotone search, escapes", ncp::escaping(ncp::SemismoothNewton{.search = {.memory = 1}})}};
}

inline Variants josephy_variants() {
  return {{"josephy, regular start", ncp::NewtonJosephy{}},
          {"josephy, ray start", ncp::NewtonJosephy{.lemke = {.start = lcp::LemkeStart::Ray}}},
          {"josephy, KLU", ncp::NewtonJosephy{.lemke = {.basis = {.lu = lcp::LuBackend::Klu}}}},
          {"josephy, monotone search, escapes", ncp::escaping(ncp::NewtonJosephy{.search = {.memory = 1}})}};
}

inline Variants path_variants() {
  return {{"path", ncp::path()},
          {"path, no crash", ncp::path({.crash = {.on = false}})},
          {"path, line", ncp::path({.search = ncp::Searchtype::Line})},
          {"path, arc", ncp::path({.search = ncp::Searchtype::Arc})},
          {"path, normal map", ncp::path({.merit = ncp::PathMerit::NormalMap})},
          {"path, monotone", ncp::path({.nms = {.on = false}})},
          {"path, rays", ncp::path({.start = ncp::PathStart::Always})}};
}

inline Variants smoothing_variants(bool finish = true) {
  Variants all;
  for (const ncp::SmoothingFunction& function : ncp::smoothing_functions())
    for (const auto schedule : {ncp::SmoothingSchedule::NewtonArmijo, ncp::SmoothingSchedule::PredictorCorrector})
      all.push_back({function.name + (schedule == ncp::SmoothingSchedule::NewtonArmijo ? "" : ", predictor-corrector") +
                         (finish ? "" : ", no finish"),
                     ncp::Smoothing{.function = function, .schedule = schedule, .finish = finish}});
  return all;
}

inline std::vector<NamedMethod> methods(const ncp::Stop& stop = {}, const ncp::Escape& escape = {}) {
  const auto escaping = [&](const ncp::Method& method) { return ncp::escaping(method, escape); };
  return {{"semismooth, Fischer-Burmeister", escaping(ncp::SemismoothNewton{.stop = stop})},
          {"semismooth, min", escaping(ncp::SemismoothNewton{.stop = stop, .cfunction = ncp::natural_min()})},
          {"josephy", escaping(ncp::NewtonJosephy{.stop = stop})},
          // With its list of restarts where the others may escape.
          {"path", ncp::path({.stop = stop}, escape.rounds)}};
}

/// Without proximal escapes: they end where they are stuck.
inline std::vector<NamedMethod> methods_without_escape(const ncp::Stop& stop = {}) {
  return methods(stop, {.rounds = 0});
}

/// Solved, and the judge that shares nothing with the library agrees.
inline ncp::Result expect_solved(const Mcp& mcp, const Vec& x0, const ncp::Method& method, const std::string& what = "",
                                 const ncp::Observer& observer = {}, const std::vector<lcp::Cell>& basis = {}) {
  ncp::Result result = ncp::solve(mcp, x0, method, observer, basis);
  EXPECT_TRUE(result.solved()) << what << ": " << result;
  EXPECT_LE(violation(mcp, result.x), ncp::stop(method).tol) << what;
  return result;
}

/// The same, at a solution that is known to `digits`.
inline ncp::Result expect_solution(const Mcp& mcp, const Vec& x0, const ncp::Method& method, const Vec& solution,
                                   double digits, const std::string& what = "") {
  ncp::Result result = expect_solved(mcp, x0, method, what);
  EXPECT_LE((result.x - solution).lpNorm<Eigen::Infinity>(), digits) << what << ": " << result.x.transpose();
  return result;
}

/// Kojima & Shindo's solutions, or Josephy's, to `digits`.
inline bool is_kojima_shindo_solution(const Vec& x, bool josephy, double digits) {
  const Vec common = vec({std::sqrt(6) / 2, 0, 0, 0.5});
  const auto near = [&](const Vec& solution) { return (x - solution).lpNorm<Eigen::Infinity>() <= digits; };
  return near(common) || (!josephy && near(vec({1, 0, 3, 0})));
}

/// The order of convergence at the end of a run, log r_{k+1} / log r_k of the last r_k above what rounding leaves; 0 if
/// that is not below `below`.
inline double last_order(const std::vector<ncp::Iteration>& records, double below = 1e-3) {
  double order = 0;
  for (std::size_t k = 1; k < records.size(); ++k) {
    const double before = records[k - 1].residual;
    const double after = std::max(records[k].residual, 1e-15);
    if (before < below && before > 1e-7) order = std::log(after) / std::log(before);
  }
  return order;
}

/// The largest resident size of this process so far in megabytes, 0 where the system does not tell or a sanitizer
/// spoils it.
inline double peak_megabytes() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return 0;
#else
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind("VmHWM:", 0) == 0) return std::stod(line.substr(6)) / 1024;
  return 0;
#endif
}

}  // namespace perp::support
