// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A made scene (contact/scenes/generators.hpp) on a table that shakes, step after step of h seconds. Displacements are
/// small: normals, tangents and lever arms are those of the scene, and each contact carries its gap g_k >= 0 [m] along,
///     M v = M v_k + h f(t) + H r,   u = H'v + g_k / h e_N,   g_{k+1} = max(0, g_k + h U_N),   U = H'v,
///     f(t) = m (g + A sin(2 pi F t) d)  on every body, in the table's frame,
/// so that contacts open, close, stick and slip, W stays the same and q does not.
#include <optional>

#include "contact/scenes/generators.hpp"

namespace perp::contact {

struct Shaking {
  double amplitude = 2;                ///< A [m/s^2]
  double frequency = 2;                ///< F [1/s]
  Vec3 direction = Vec3(0.8, 0.6, 0);  ///< d, of length 1
};

class ShakenScene {
 public:
  /// Throws std::invalid_argument if a number is not finite, the frequency negative or the direction not of length 1.
  explicit ShakenScene(const Scene& scene, const Shaking& shaking = {});

  /// The contact problem of the next step; contacts are those of the scene, in its order.
  Problem problem() const;
  /// Takes the step with these impulses.
  void advance(In r);
  double time() const { return h_ * static_cast<double>(steps_); }
  const Vec& velocities() const { return v_; }
  const Vec& gaps() const { return gaps_; }

 private:
  Vec impulse_of_forces() const;  // M v_k + h f

  Shaking shaking_;
  Problem first_{};  // W, mu and M, H
  double h_ = 0.01;
  Vec weight_{};  // h m g of the bodies
  Vec masses_{};  // m of translations, 0 of rotations
  SpMat M_inverse_{};
  Vec v_{};
  Vec gaps_{};
  long steps_ = 0;
};

}  // namespace perp::contact
