// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Coulomb's law as a variational inequality over the cones, in the coordinates of contact/model/scaling.hpp (lecture,
/// (64)-(68)): r in K with
///     F(r).(s - r) >= 0 for all s in K,   F(r) = W r + q + |u_T| e_N   (of two disks W r + q + (|u_T| + |w_R|) e_N),
/// and what the methods of projection share. F is Lipschitz and not monotone.
#include <utility>

#include "contact/model/scaling.hpp"
#include "lcp/fields.hpp"

namespace perp::contact {

/// The length rho of a projection step r - rho F(r). Khobotov (1987) for the extragradient method; Han & Lo (2002) for
/// the fixed point. The numbers are Siconos'.
struct StepRule {
  bool adaptive = true;     ///< else rho stays
  double rho = 1;           ///< the first one, in scaled units, where the mean of W's diagonal is 1
  double shrink = 2.0 / 3;  ///< rho is multiplied by this and min(1, 1 / l) while l > longest,
  double grow = 1.5;        ///< and afterwards by this where l < shortest,
  double longest = 0.9;     ///< l = rho |F(r) - F(s)| / |r - s|, s the projected step
  double shortest = 0.3;
};
void describe(StepRule& rule, Fields& fields);

class ContactVi {
 public:
  explicit ContactVi(const Scaled& problem) : problem_(problem) {}

  Vec F(In r) const { return corrected(problem_.W * r + problem_.q); }
  Vec corrected(Vec u) const { return contact::corrected(problem_, std::move(u)); }  ///< uhat
  Vec project(Vec y) const { return project_onto_cones(problem_, std::move(y)); }

  /// A projected step from r, and F there; rho is shortened before it and lengthened after it, as the rule says.
  struct Prediction {
    Vec r;
    Vec F;
    double rho = 0;  ///< of this step
  };
  Prediction predict(const StepRule& rule, In r, In F_r, double& rho) const;

 private:
  const Scaled& problem_;
};

/// r, or zero where there is no start.
Vec start_or_zero(const Scaled& problem, const Vec& start);

}  // namespace perp::contact
