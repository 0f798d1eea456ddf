// SPDX-License-Identifier: Apache-2.0
#pragma once
/// `perp contact FILE... --facets K,K,...`: what friction by polygons of K facets costs, measured by Coulomb's exact
/// law and its solution, and the power of K by which the errors fall.
#include <array>
#include <atomic>
#include <string>
#include <vector>

#include "app/contact/run/run.hpp"
#include "app/program/program.hpp"

namespace perp::app::contacts {

/// Errors of a polygon's solution (r, u), free of units. The first two are of the angle between friction and the
/// nearest corner, up to pi / K; the others of the gap between polygon and disk, 1 - cos(pi / K).
enum class FacetError {
  Natural,   ///< Residual::scaled
  Velocity,  ///< ||u - u_exact|| / ||q||
  Cone,      ///< Residual::cone / max r_N; rounding alone of polygons in the disk
  Slip       ///< Residual::slip / (max r_N |q|_inf): dissipation that is missing
};
inline constexpr std::array<FacetError, 4> facet_errors{FacetError::Natural, FacetError::Velocity, FacetError::Cone,
                                                        FacetError::Slip};
const char* name(FacetError error);  ///< JSON's key: "natural", ...

/// One polygon's solution on one problem.
struct FacetRun {
  std::size_t problem = 0;
  bool outer = false;
  int facets = 0;
  double rotation = 0;  ///< of the polygon [rad]
  Status status = Status::NoProgress;
  bool solved = false;
  double own = 0;  ///< natural residual of the affine problem
  lcp::Index unknowns = 0;
  double seconds = 0;
  std::array<double, 4> errors{};  ///< in the order of facet_errors; NaN: not known
};

struct FacetProblem {
  std::string label{};
  int dimension = 3;
  lcp::Index contacts = 0;
  lcp::Index slipping = 0;  ///< contacts, by the exact law
  bool solved = false;      ///< by the exact law; else it has no velocity error
  double siconos = 0;       ///< the exact solution's metric
  /// Does it count in the medians? Where nothing slips, and in 2D, polygons have no error.
  bool counts() const { return solved && slipping > 0 && dimension == 3; }
};

/// What the runs of one K and one side of the disk have in common.
struct FacetLine {
  bool outer = false;
  int facets = 0;
  int runs = 0, solved = 0;
  double own = 0;                   ///< the largest of the solved
  double slowest = 0;               ///< s
  std::array<double, 4> medians{};  ///< over the solved runs of problems that count; NaN if there are none
};

struct FacetStudy {
  contact::Form form = contact::Form::Reduced;
  double tol = 0;
  std::vector<int> facets{};  ///< ascending
  std::vector<FacetProblem> problems{};
  std::vector<FacetRun> runs{};

  std::vector<FacetLine> lines() const;  ///< inner, then outer, K ascending
  int counting() const;                  ///< problems
  bool complete() const;                 ///< everything solved
};

/// Errors below are rounding.
inline constexpr double facet_rounding = 1e-12;

/// p of the least-squares fit median = c K^p over the lines of one side whose median is above facet_rounding; NaN of
/// fewer than two.
double fitted_power(const std::vector<FacetLine>& lines, bool outer, FacetError error);

struct FacetsRequest {
  std::vector<std::string> problems{};
  std::string facets{};          ///< comma-separated K
  std::string form = "reduced";  ///< or "mixed"
  double tol = 1e-9;             ///< on the natural residual of the affine problems
  double time_limit = 30;        ///< s, of a run
  std::string svg{};             ///< where the errors are drawn; "" for nowhere
  std::string json{};            ///< "" for none, "-" for standard output (and the text to `err`)
};

/// Every polygon in three positions, which mean nothing: corners that happen to lie where friction points are luck.
/// exit_solved: all of them, and the exact law on all problems; exit_unsolved; exit_input. Errors are printed, not
/// thrown. `interrupt` may be null.
ExitCode facets(const FacetsRequest& request, Streams streams, const std::atomic<bool>* interrupt = nullptr);

/// The errors of polygons over K, doubly logarithmic: a panel for each error, all of one scale, with guides that fall
/// like 1/K and 1/K^2. Polygons in the disk and about it differ in colour (Okabe & Ito's, which colour-blind people can
/// tell apart), in dashes and in the mark; the fitted power stands at each line's end.
std::string facets_svg(const FacetStudy& study);

}  // namespace perp::app::contacts
