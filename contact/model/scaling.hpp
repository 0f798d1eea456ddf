// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Units and coordinates in which every cone of friction is that of mu = 1 and the entries are near one: with
///     s = tr(W) / (d n),   q_s = |q|_inf,   M = diag(1, mu, mu) contact by contact,
///     W~ = M W M / s,   q~ = M q / q_s,   r = (q_s / s) M r~,   u = q_s M^-1 u~,
/// |r_T| <= mu r_N reads |r~_T| <= r~_N, and u~ = W~ r~ + q~ obeys the same law with mu = 1. Frictionless contacts
/// (mu = 0) keep their normal rows alone. s and q_s are those of units.hpp. With rolling friction M = diag(1, mu, mu,
/// mu_r, mu_r), so that both cones are that of mu = 1 and the units of rolling are gone; a disk whose coefficient is 0
/// has no rows. W~ has entries then: no system by bodies knows two disks.
#include <vector>

#include "contact/model/delassus.hpp"
#include "contact/model/disks.hpp"
#include "contact/model/problem.hpp"

namespace perp::contact {

struct Scaled {
  /// The entries of one contact in r~: first, first + 1, ...
  struct Block {
    Index first = 0;
    int size = 3;   ///< 1: frictionless; 2, 3: N and one disk; 3, 5: N and two
    int width = 2;  ///< entries of each disk (disks.hpp); 1 of two in 2D
    int disk_count() const { return size == 1 ? 0 : size - 1 > width ? 2 : 1; }
    /// Entries of disk j, and the first of them.
    int entries() const { return disk_count() == 2 ? width : size - 1; }
    int first_of(int j) const { return 1 + j * width; }
    /// The contact's part of r~ or u~, with zeros after it.
    template <int Size = 3>
    ContactVector<Size> of(In r) const {
      ContactVector<Size> part = ContactVector<Size>::Zero();
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
  bool rolls = false;         ///< some contact has two disks, and vectors of contacts have size 5

  Index size() const { return q.size(); }
  Vec expand(In r) const;  ///< r~ to r [N s]; zeros in the tangential entries of frictionless contacts
  Vec reduce(In r) const;  ///< r to r~, the opposite
};
/// How a scaled problem has a W that is known by its parts: as takes less to solve it (forms.hpp), by its parts, or by
/// its entries.
enum class WForm { Cheaper, Parts, Entries };
/// `scale` = false: s = q_s = 1, so that only mu is taken out.
Scaled scaled(const Problem& problem, bool scale = true, WForm form = WForm::Cheaper);

/// use.operator()<Size>() with the size of the problem's contacts' vectors.
template <class Use>
auto with_size(const Scaled& problem, const Use& use) {
  return problem.rolls ? use.template operator()<5>() : use.template operator()<3>();
}

/// u~ + (|u~_T| + |w~_R|) e_N of every contact.
Vec corrected(const Scaled& problem, Vec u);
/// The projection on the cones.
Vec project_onto_cones(const Scaled& problem, Vec y);

/// Computes the natural map of the scaled problem, the largest |r~ - P_K(r~ - u~ - |u~_T| e_N)| of a contact, with u~ =
/// W~ r~ + q~.
double natural_map(const Scaled& problem, In r);
/// Computes the natural map of the proximal problem, where u~ = W~ r~ + q~ + alpha (r~ - centre).
double natural_map(const Scaled& problem, In r, In centre, double alpha);

}  // namespace perp::contact
