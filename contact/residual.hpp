#pragma once
/// The judge of contact problems. It knows r and the problem and no formulation:
///     u = W r + q,   uhat = u + mu |u_T| e_N,   e_rho(r) = r - P_K(r - rho uhat)   contact by contact,
/// zero exactly at solutions, for every rho > 0 (natural map; Acary & Brogliato 2008, 13.3; INRIA RR-9118, 3).
#include <string>
#include <vector>

#include "contact/problem.hpp"

namespace perp::contact {

enum class State { Open, Stick, Slip };

struct ContactState {
  State state = State::Open;
  /// How far the contact is from another state, in the units of what decides: r_N of an open contact's neighbour is
  /// u_N [m/s]; of a sticking one mu r_N - |r_T| [N s]; of a slipping one |u_T| [m/s].
  double margin = 0;
};

/// Norms are Euclidean over all contacts where nothing else is said, as in the published metrics.
struct Residual {
  double natural = 0;  ///< ||e_1|| [mixed units]
  double siconos = 0;  ///< ||e_1|| / max(||q||, ||r||, ||u||), the largest not below 1e-300: Siconos 4.4's metric
  double rr9118 = 0;   ///< ||e_1|| / ||q||: the metric of INRIA RR-9118
  double scaled = 0;   ///< ||e_rho|| / max(||r||, rho ||u||, rho ||q||) with rho = 1 / mean(diag W): free of units
  double cone = 0;     ///< max over contacts of (|r_T| - mu r_N)+ and (-r_N)+ [N s]
  double normal = 0;   ///< max of |min(r_N, rho u_N)| [N s]: normal complementarity
  double slip = 0;     ///< max of |u_T| mu r_N + r_T.u_T [J], 0 where friction opposes slip and is fully used
  Index worst = -1;    ///< contact with the largest part of e_rho; -1 if there is no contact
};

/// r has d n finite entries (else std::invalid_argument).
Residual residual(const Problem& problem, In r);

/// Open: |r| at most `tol` times the largest |r|; Slip: |r_T| >= (1 - tol) mu r_N and |u_T| above tol times the largest
/// |u| or |q| (where everything sticks u is nothing but the rounding of W r + q); else Stick.
std::vector<ContactState> states(const Problem& problem, In r, double tol = 1e-6);

/// P_K(y) for K = {|y_T| <= mu y_N}, y with 2 or 3 entries (N, T..), into `out`.
void project_onto_cone(In y, double mu, lcp::Out out);

/// "open", "stick", "slip".
const char* name(State state);

}  // namespace perp::contact
