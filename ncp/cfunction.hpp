#pragma once
/// C-functions (complementarity functions) and the reformulation of an MCP as a nonsmooth equation Phi(x) = 0.
///
/// All functions here carry the sign of the minimum:  phi(a, b) = 0  <=>  a >= 0, b >= 0, ab = 0, and phi > 0 for a, b
/// > 0. (The lecture's (38d), sqrt(w^2 + z^2) - z - w, is -phi_FB.) Then the row of a box [l, u] is, by Billups'
/// composition,
///     l = -inf, u = +inf :  F
///     l finite           :  phi(x - l, F)
///     u finite           : -phi(u - x, -F)
///     both finite        :  phi(x - l, -phi(u - x, -F))
///     l = u              :  x - l
/// and Phi(x) = 0 <=> x solves the MCP (Billups 1995, section 3.2; Ferris & Munson 1999).
#include <functional>
#include <string>

#include "ncp/mcp.hpp"

namespace perp::ncp {

struct CValue {
  double phi = 0;
  double da = 0;  ///< d phi / da; at a kink an element of the B-subdifferential, see CFunction::at
  double db = 0;
};

struct CFunction {
  std::string name;
  std::string formula;
  /// Is 1/2 phi^2 continuously differentiable? If so 1/2 ||Phi||^2 serves as the merit function of a line search.
  bool smooth_merit = false;
  /// phi and its partials at (a, b). At a kink the partials are the limit of those at (a, b) + s (ha, hb), s -> 0+,
  /// which makes (da, db) an element of the B-subdifferential.
  std::function<CValue(double a, double b, double ha, double hb)> at;
};

/// phi(a, b) = a + b - sqrt(a^2 + b^2) (Fischer 1992), without cancellation over the whole double range.
CFunction fischer_burmeister();
/// phi(a, b) = min(a, b) (Pang 1990).
CFunction natural_min();

/// Phi at (x, F), with diagonals Da, Db of an element H = Da + Db J of the B-subdifferential of Phi.
struct Reformulation {
  Vec Phi, Da, Db;
};
/// At kinks the element is the one along the direction h, Jh (De Luca, Facchinei & Kanzow 1996, section 7, take h_i = 1
/// at degenerate indices). Pre: h and Jh have n rows.
void reformulate(const CFunction& c, const Box& box, In x, In F, In h, In Jh, Reformulation& out);
/// Phi alone.
void reformulate(const CFunction& c, const Box& box, In x, In F, Out Phi);

}  // namespace perp::ncp
