// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The judge of contact problems. It uses r and the problem only, and does not depend on the formulation:
///     u = W r + q,   uhat = u + mu |u_T| e_N,   e_rho(r) = r - P_K(r - rho uhat)   contact by contact,
/// zero exactly at solutions, for every rho > 0 (natural map; Acary & Brogliato 2008, 13.3; INRIA RR-9118, 3). With
/// rolling friction uhat = u + (mu |u_T| + mu_r |w_R|) e_N, K has both disks, and beside the published metrics rolling
/// counts as what it is at a lever of l_a = sqrt(w_T / w_R) [m], the means of W's diagonal over the contact's entries
/// (N, T) and (R): m_R / l_a, l_a w_R and mu_r / l_a, in N s, m/s and without a unit.
#include <optional>
#include <vector>

#include "contact/model/problem.hpp"

namespace perp::contact {

struct Velocities;

/// Roll: does not slip, and its rolling friction is fully used.
enum class State { Open, Stick, Slip, Roll };

struct ContactState {
  State state = State::Open;
  /// The distance to another state: u_N [m/s] of an open contact, mu r_N - |r_T| [N s] of a sticking one, |u_T| [m/s]
  /// of a slipping one, |w_R| [rad/s] of a rolling one.
  double margin = 0;
};

/// Norms are Euclidean over all contacts where nothing else is said, as in the published metrics. The parts of the law
/// stand twice: in units, and relative to what is compared at each contact. With w_a the mean of W's diagonal there,
///     V_a = max(|q_a|, |(W r)_a|, min(t_a, Q_a)),   t_a = |(|q| + |W| |r|)_a|,
///     R_a = max(|r_a|, V_a / w_a),                  Q_a the largest |q_b| of contacts b that W couples with a:
/// the velocities that cancel in u_a, and the impulses that act or would stop V_a. Of W by its parts N'N stands for |W|
/// (DelassusParts::shares), and the contacts of a body are coupled; of bodies that constraints hold, which are one
/// thing then, the lesser of that and |H|' |v|, v = K^-1 H r. Neither V_a nor R_a can be made large by an
/// r in the kernel of W, nor depends on units.
struct Residual {
  double natural = 0;       ///< ||e_1|| [mixed units]
  double siconos = 0;       ///< ||e_1|| / max(||q||, ||r||, ||u||), the largest not below 1e-300: Siconos 4.4's metric
  double rr9118 = 0;        ///< ||e_1|| / ||q||: the metric of INRIA RR-9118
  double scaled = 0;        ///< ||e_rho|| / max(||r||, rho ||u||, rho ||q||) with rho = 1 / mean(diag W): free of units
  double cone = 0;          ///< max over contacts and disks of (|r_T| - mu r_N)+ and (-r_N)+ [N s]
  double normal = 0;        ///< max of |min(r_N, rho u_N)| [N s]: normal complementarity
  double slip = 0;          ///< max of |u_T| mu r_N + r_T.u_T [J], 0 where friction opposes slip and is fully used
  double cone_share = 0;    ///< max over contacts of dist(r, K) / R_a
  double normal_share = 0;  ///< max of |min(r_N / R_a, u_N / V_a)|
  /// max of |r_T / R_a - P(r_T / R_a - u_T / V_a)|, P onto the disc of radius mu r_N / R_a: no slip inside the cone,
  /// and friction that opposes slip.
  double slip_share = 0;
  Index worst = -1;  ///< contact with the largest part of e_rho; -1 if there is no contact
  /// Returns the largest of the values that accepted() compares with the tolerance.
  double largest() const;
};

/// Returns whether r solves the problem to `tol`: both published metrics and the shares of cone, normal and slip at
/// each contact are at most tol. No other function calls a point a solution of Coulomb's law.
bool accepted(const Residual& residual, double tol);

/// Computes u = W r + q. Each entry has a relative error of a few eps, even if a huge W r cancels.
Vec velocities(const Problem& problem, In r);

/// Judges many points of one problem, which outlives it.
class Judge {
 public:
  explicit Judge(const Problem& problem);
  /// r has d n finite entries (else std::invalid_argument). O(entries of W, or of M or K, its factors and H).
  Residual operator()(In r) const;
  /// Writes u = W r + q besides, as velocities() has it.
  Residual operator()(In r, Vec& u) const;
  /// Returns natural, siconos and rr9118 alone, with u added up in working precision, where that is enough to refuse r:
  /// the larger metric is above 1,000 tol and ten times what rounding may do to it. Takes a third of the time.
  std::optional<Residual> far(In r, double tol) const;

 private:
  template <int Size>
  Residual judged(In r, const Velocities& at_r) const;
  template <int Size>
  double natural(In r, In u) const;

  const Problem& problem_;
  double rho_ = 1;
  double largest_diagonal_ = 0;   // of W
  std::vector<double> coupled_;   // Q_a
  std::vector<double> lever_;     // l_a
  std::vector<double> diagonal_;  // w_a
};
/// One point.
Residual residual(const Problem& problem, In r);

/// Returns the state of each contact. It is Open if |r| is at most `tol` times the largest |r|. It is Slip if |r_T| >=
/// (1 - tol) mu r_N and |u_T| exceeds tol times the largest |u| or |q|; |q| counts because u is mere rounding where all
/// contacts stick. It is Roll by the same of m_R and w_R. It is Stick otherwise.
std::vector<ContactState> states(const Problem& problem, In r, double tol = 1e-6);
/// The same with u = W r + q, as velocities() has it, in at.u.
std::vector<ContactState> states(const Problem& problem, const Solution& at, double tol = 1e-6);

/// "open", "stick", "slip".
const char* name(State state);

}  // namespace perp::contact
