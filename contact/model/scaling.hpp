// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Units and coordinates in which every cone of friction is that of mu = 1 and the entries are near one: with
///     s = tr(W) / (d n),   q_s = |q|_inf,   M = diag(1, mu, mu) contact by contact,
///     W~ = M W M / s,   q~ = M q / q_s,   r = (q_s / s) M r~,   u = q_s M^-1 u~,
/// |r_T| <= mu r_N reads |r~_T| <= r~_N, and u~ = W~ r~ + q~ obeys the same law with mu = 1. Frictionless contacts
/// (mu = 0) keep their normal rows alone. s and q_s are those of units.hpp.
#include <vector>

#include "contact/model/delassus.hpp"
#include "contact/model/problem.hpp"

namespace perp::contact {

struct Scaled {
  /// The entries of one contact in r~: first, first + 1, ...
  struct Block {
    Index first = 0;
    int size = 3;  ///< 1: frictionless; 2, 3: N, T1[, T2]
    /// The contact's part of r~ or u~, with zeros after it.
    Eigen::Vector3d of(In r) const {
      Eigen::Vector3d part = Eigen::Vector3d::Zero();
      part.head(size) = r.segment(first, size);
      return part;
    }
  };
  /// Square. By its parts, M and H scaled, where the problem's W is and they take less. Where a column has an entry in
  /// the rows of a contact it has them all; it has its own contact's.
  Delassus W;
  Vec q;
  std::vector<Block> blocks;  ///< one a contact
  Vec impulse;                ///< r_i = impulse_i r~_k at i = rows[k]; one a row of W~
  std::vector<Index> rows;    ///< of the problem, one a row of W~
  Index whole = 0;            ///< d n

  Index size() const { return q.size(); }
  Vec expand(In r) const;  ///< r~ to r [N s]; zeros in the tangential entries of frictionless contacts
  Vec reduce(In r) const;  ///< r to r~, the opposite
};
/// How a scaled problem has a W that is known by its parts: as takes less to solve it (forms.hpp), by its parts, or by
/// its entries.
enum class WForm { Cheaper, Parts, Entries };
/// `scale` = false: s = q_s = 1, so that only mu is taken out.
Scaled scaled(const Problem& problem, bool scale = true, WForm form = WForm::Cheaper);

/// Computes the natural map of the scaled problem, the largest |r~ - P_K(r~ - u~ - |u~_T| e_N)| of a contact, with u~ =
/// W~ r~ + q~.
double natural_map(const Scaled& problem, In r);
/// Computes the natural map of the proximal problem, where u~ = W~ r~ + q~ + alpha (r~ - centre).
double natural_map(const Scaled& problem, In r, In centre, double alpha);

}  // namespace perp::contact
