// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The predictor and corrector of contact's interior-point methods (Mehrotra, SIAM J. Optim. 2 (1992) 575), of products
/// with the mean tau. The predictor leads towards products 0; as far as it comes within the bounds they would have the
/// mean tau_aff. The corrector leads towards sigma tau, sigma = (tau_aff / tau)^3, with the predictor's second-order
/// terms.
#include <algorithm>

namespace perp::contact {

inline constexpr double most_centring = 0.8;  ///< sigma at most, and of a step that only centres
/// sigma at least after a step below short_predictor. The second-order terms are left out where the predictor comes no
/// further than that: they are larger than what they correct.
inline constexpr double safe_centring = 0.5;
inline constexpr double short_predictor = 0.1;

template <class Direction>
struct Corrected {
  Direction direction;
  double sigma = 0;
};

/// `system` has direction(target, affine) with the second-order terms of `affine` if it is not null, reach(d), the step
/// to the boundary, at most one, and mean_after(d, step). least: of sigma. last: the step before.
template <class System>
auto predictor_corrector(System& system, double tau, double least, double last) {
  auto affine = system.direction(0, nullptr);
  const double alpha = system.reach(affine);
  const double ratio = std::max(0.0, system.mean_after(affine, alpha)) / std::max(tau, 1e-300);
  if (last < short_predictor) least = std::max(least, safe_centring);
  const double sigma = std::clamp(ratio * ratio * ratio, std::min(least, most_centring), most_centring);
  return Corrected{system.direction(sigma * tau, alpha > short_predictor ? &affine : nullptr), sigma};
}

}  // namespace perp::contact
