#pragma once
#include "lcp/sparse_lu.hpp"
#include "ncp/cfunction.hpp"
#include "ncp/options.hpp"

namespace perp::ncp {

/// x+ = x + t d,  H d = -Phi(x),  H in the B-subdifferential of Phi  (De Luca, Facchinei & Kanzow 1996, Math. Prog.
/// 75). Levenberg-Marquardt steps (H'H + nu I) d = -H'Phi where H is singular or d is no descent direction, gradient
/// steps where those fail too. Converges q-quadratically to R-regular solutions; every accumulation point is stationary
/// for the merit.
struct SemismoothNewton {
  Stop stop{};
  CFunction cfunction = fischer_burmeister();
  Armijo search{};
  double descent_rho = 1e-9;  ///< a Newton direction needs  grad psi . d <= -rho ||d||^p
  double descent_p = 2.1;
  Escape escape{.rounds = 0};
  lcp::LuBackend lu = lcp::LuBackend::Umfpack;
};

std::optional<std::string> invalid(const SemismoothNewton& method);

}  // namespace perp::ncp
