// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Performance and data profiles of methods s on problems p, from costs t_{p,s} > 0 (infinite: not solved).
///
/// Performance profile (Dolan & More, Math. Prog. 91 (2002) 201, eq. 2.1):
///   rho_s(tau) = |{p : r_{p,s} <= tau}| / |P|,   r_{p,s} = t_{p,s} / min_s t_{p,s}
/// Data profile (More & Wild, SIAM J. Optim. 20 (2009) 172, eq. 2.8):
///   d_s(alpha) = |{p : t_{p,s} / u_p <= alpha}| / |P|,   u_p = n_p + 1 for evaluations of F, 1 for other costs
///
/// Ties count for every method that attains the minimum. A problem that nobody solved has r = inf for all and stays in
/// P: no curve reaches 1 then.
#include <cstddef>
#include <span>
#include <vector>

namespace perp::app::comparison {

/// t[s][p], a row a method, all of the same length.
using Costs = std::vector<std::vector<double>>;

/// Where a share grows: from x on, `count` problems.
struct Step {
  double x = 0;
  std::size_t count = 0;
};

/// A nondecreasing step function, continuous from the right, with values in [0, 1].
struct Profile {
  std::vector<Step> steps;   ///< x and count strictly increasing, x finite
  std::size_t problems = 0;  ///< |P|

  std::size_t count(double x) const;              ///< problems with a ratio (or budget) of at most x
  double share(double x) const;                   ///< count(x) / |P|, 0 where P is empty
  std::size_t solved() const;                     ///< count(inf)
  std::size_t first() const { return count(1); }  ///< of a performance profile: at the minimum, ties included
};

/// One a method. Throws std::invalid_argument for rows of different lengths and for costs that are not in (0, inf].
std::vector<Profile> performance_profiles(const Costs& t);
/// The same; `unit` has one entry > 0 a problem.
std::vector<Profile> data_profiles(const Costs& t, std::span<const double> unit);

}  // namespace perp::app::comparison
