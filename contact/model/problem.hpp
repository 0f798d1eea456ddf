// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Unilateral contact with Coulomb friction, discrete in time, at n contacts:
///     u = W r + q,   K*_mu > u + mu |u_T| e_N  _|_  r in K_mu,   K_mu = {r : |r_T| <= mu r_N}
/// contact by contact (De Saxce & Feng 1998; Acary & Brogliato 2008, eq. 13.58). Block a of r, u, q is
/// (N, T1[, T2]) of contact a: with d = `dimension`, entries d a .. d a + d - 1. With rolling friction it is
/// (N, T1[, T2], R1[, R2]), with a second disk:
///     K_mu = {r : |r_T| <= mu r_N, |m_R| <= mu_r r_N},   K*_mu > u + (mu |u_T| + mu_r |w_R|) e_N  _|_  r in K_mu.
///     r   impulses [N s], r_N >= 0 pushes the bodies apart
///     u   relative velocities after the impact [m/s]; q is the free velocity with Newton's impact law folded in
///         (e U_N,k added to the normal part)
///     W   Delassus operator H' M^-1 H [1/kg]: positive semidefinite, of low rank where contacts are redundant; in
///         recorded data unsymmetric by up to some per cent
///     mu  coefficients of friction [-], >= 0; 0 is a frictionless contact
///     m_R, w_R   rolling parts of r and u: angular impulses [N m s] and velocities [rad/s] about tangential axes, or
///         in 2D the one across the plane
///     mu_r  coefficients of rolling friction [m], >= 0
#include <memory>
#include <string>
#include <vector>

#include "contact/model/delassus.hpp"

namespace perp::contact {

/// The problem before its condensation: velocities v of the bodies [m/s], m of them, and multipliers of b.size()
/// bilateral constraints,
///     M v = H r + G lambda + f,   u = H' v + w,   0 = G' v + b.
struct Global {
  SpMat M{};  ///< m x m, inertia [kg], positive definite
  SpMat H{};  ///< m x d n
  SpMat G{};  ///< m x number of bilateral constraints; may have no columns
  Vec f{};    ///< m [N s]
  Vec w{};    ///< d n [m/s]
  Vec b{};    ///< [m/s]
};

/// What rounding may have changed in W and q: nothing where they are given, and these vectors are empty. Proofs of
/// existence and of none take it into account.
struct Rounding {
  Vec q{};  ///< d n: q_i by so much at most
  Vec W{};  ///< d n: W_ij by W_i W_j at most
};

struct Problem {
  int dimension = 3;  ///< d, entries of a contact: 2 or 3; with rolling friction 3 in 2D, 5 in 3D
  Delassus W{};       ///< d n x d n: by compressed entries, or by the bodies' M and H, and then formed for nobody yet
  Vec q{};            ///< d n
  Vec mu{};           ///< n
  Vec mu_r{};         ///< n where there is rolling friction; else empty
  std::string name{};
  std::shared_ptr<const Global> global{};  ///< where W and q are condensed from it
  Rounding rounding{};                     ///< of whoever condensed it; to be emptied with a new q

  Index contacts() const { return mu.size(); }
  bool rolls() const { return dimension == 5 || mu_r.size() > 0; }
  /// Entries of a contact's disk, or of each of its two.
  int disk_width() const { return rolls() ? (dimension - 1) / 2 : dimension - 1; }
  int space() const { return disk_width() + 1; }  ///< 2 or 3: where the bodies move
};

/// Impulses and velocities of the contacts, as a reader or a solver returns them, before they are judged.
struct Solution {
  Vec r{};  ///< d n
  Vec u{};  ///< d n
};

/// Throws std::invalid_argument naming the contact and the value if the dimension is none of these, sizes differ, W is
/// not square, an entry is not finite or a coefficient negative. Of W by its parts these are looked at.
void check(const Problem& problem);

/// Some contacts of a problem that no others act on.
struct ContactGroup {
  std::vector<Index> contacts{};  ///< of the problem, ascending
  Problem problem{};              ///< of these alone, with a W as the whole one's is given; without `global`
};
/// The problem as those of its groups of contacts that do not act on each other (Delassus::groups), in that order;
/// their solutions are the parts of one of the whole. Nothing where there is one group, or W was condensed to entries:
/// the more exact product that they have is of the whole.
std::vector<ContactGroup> separated(const Problem& problem);

/// [M G; G' 0]
SpMat saddle_point(const SpMat& M, const SpMat& G);

/// W = H' M^-1 H, q = H' M^-1 f + w; with bilateral constraints G' v + b = 0 these are eliminated first, all in one:
///     W = [H; 0]' K^-1 [H; 0],   q = [H; 0]' K^-1 [f; -b] + w,   K = [M G; G' 0].
/// Where M is positive definite and symmetric to 1e-11, W is the operator of these parts (delassus.hpp): without G and
/// with M symmetric bit by bit, by factors of M and of the bodies that contacts touch; else by one LU factorization of
/// K. Of any other M it has entries, by those factors, column by column with sparse right-hand sides; symmetric if M
/// is. |W_ij| <= 1e-15 sqrt(W_ii W_jj) is rounding and left out. Throws std::invalid_argument if sizes differ, an entry
/// is not finite, M is singular or G has dependent columns (K singular up to rounding), std::bad_alloc if the factors
/// do not fit.
Problem condense(Global global, Vec mu, int dimension = 3, std::string name = {}, Vec mu_r = {});

}  // namespace perp::contact
