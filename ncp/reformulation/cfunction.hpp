// SPDX-License-Identifier: Apache-2.0
#pragma once
/// C-functions (complementarity functions) and the reformulation of an MCP as a nonsmooth equation Phi(x) = 0.
///
/// All functions here carry the sign of the minimum:
///     phi(a, b) = 0  <=>  a >= 0, b >= 0, ab = 0;   phi > 0 for a, b > 0;   phi < 0 elsewhere.
/// (The lecture's (38b)-(38f) are the same functions times -1.) Then the row of a box [l, u] is, by Billups'
/// composition,
///     l = -inf, u = +inf :  F
///     l finite           :  phi(x - l, F)
///     u finite           : -phi(u - x, -F)
///     both finite        :  phi(x - l, -phi(u - x, -F))
///     l = u              :  x - l
/// and Phi(x) = 0 <=> x solves the MCP (Billups 1995, section 3.2; Ferris & Munson 1999). The sign law is all that the
/// composition needs: y = -phi(u - x, -F) has the sign of mid(x - u, F, +inf), so that phi(x - l, y) = 0 says x = l and
/// F >= 0, or x > l and y = 0.
///
/// Arithmetic: values and partials are within a few units in the last place wherever they are normal numbers. Nothing
/// infinite comes out: what lies beyond the double range is +-1.8e308, what lies below it is rounded to a multiple of
/// 4.9e-324 but not to zero, so that the sign law holds for all doubles. x - l may overflow: phi(+inf, b) is the limit,
/// or
/// +-1.8e308 where that is infinite; -inf counts as -1.8e308.
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lcp/fischer_burmeister.hpp"
#include "ncp/problem/fields.hpp"
#include "ncp/problem/mcp.hpp"

namespace perp::ncp {

using lcp::CValue;

/// A number within the formula. Its range is the open interval (low, high).
struct CParameter {
  std::string name;
  double value = 0;
  double low = 0;
  double high = infinity;
  std::vector<double> grid{};  ///< values that span its use, for comparisons
};

/// What is known of Phi and Psi = 1/2 ||Phi||^2 for the NCP(F). The references are CFunction::reference and, for all,
/// Facchinei & Pang 2003, chapter 9.
struct CProperties {
  /// Phi is strongly semismooth where F' is Lipschitz: Newton's method is then quadratic, not just superlinear.
  bool strongly_semismooth = true;
  /// All elements of the B-subdifferential may be singular at a solution with x_i = F_i = 0, however regular.
  bool singular_at_degenerate = false;
  std::string level_sets;         ///< of Psi are bounded for these F
  std::string stationary_points;  ///< of Psi are solutions for these F
};

struct CFunction {
  std::string name;
  std::string formula;
  /// Is 1/2 phi^2 continuously differentiable? If so 1/2 ||Phi||^2 serves as the merit function of a line search.
  bool smooth_merit = false;
  /// phi and its partials at (a, b). At a kink the partials are the limit of those at (a, b) + s (ha, hb), s -> 0+, or
  /// of such limits where that ray runs along the kink itself, which makes (da, db) an element of the
  /// B-subdifferential.
  std::function<CValue(double a, double b, double ha, double hb)> at;
  /// phi alone, the same double, where that is quicker.
  double (*value)(double a, double b) = nullptr;
  std::optional<CParameter> parameter{};
  CFunction (*with_parameter)(double) = nullptr;  ///< the function at another value; there if `parameter` is
  CProperties properties{};
  std::string reference{};
};

/// (38a)  min(a, b)  (Pang 1990).
CFunction natural_min();
/// (38b)  a - max(0, a - rho b) = min(a, rho b),  rho > 0: the projection with steps of length rho.
CFunction min_rho_b(double rho = 1);
/// (38c)  b - max(0, b - rho a) = min(rho a, b),  rho > 0.
CFunction min_rho_a(double rho = 1);
/// (38d)  a + b - sqrt(a^2 + b^2)  (Fischer 1992).
CFunction fischer_burmeister();
/// (38e)  lambda phi_FB + (1 - lambda) a+ b+,  0 < lambda < 1  (Chen, Chen & Kanzow 2000, where lambda = 0.95; Munson
/// 2000 takes 0.8). The product alone is zero wherever a <= 0 or b <= 0: for small lambda the signs are hardly
/// enforced.
CFunction penalised_fischer_burmeister(double lambda = 0.95);
/// (38f)  ab - 1/2 min(0, a + b)^2  (Evtushenko & Purtov 1984): continuously differentiable, zero gradient at (0, 0).
CFunction evtushenko_purtov();
/// a + b - sqrt((a - b)^2 + lambda ab),  0 < lambda < 4  (Kanzow & Kleinmichel 1998): phi_FB for lambda = 2, 2 min(a,
/// b) for lambda -> 0.
CFunction kanzow_kleinmichel(double lambda = 2);
/// Luo & Tseng (1997) build merit functions from psi_0(t), zero for t <= 0 only, and psi(-a, -b), zero for a, b >= 0
/// only; with psi_0 of each product apart (Kanzow, Yamashita & Fukushima 1997) psi_0(ab) + psi(-a, -b) is zero at
/// complementary pairs only. Here psi_0(t) = alpha/2 max(0, t)^2, psi(-a, -b) = 1/2 min(0, phi_FB(a, b))^2, alpha > 0,
/// and phi is the root of twice that sum with the sign of min(a, b):
///     sqrt(alpha) ab for a, b >= 0,   -sqrt(alpha (ab)^2 + phi_FB^2) for a, b <= 0,   phi_FB elsewhere.
CFunction luo_tseng(double alpha = 1);

/// All of the above with their default parameters, in this order. Names: "min", "min-rho-b", "min-rho-a",
/// "fischer-burmeister", "penalised-fischer-burmeister", "evtushenko-purtov", "kanzow-kleinmichel", "luo-tseng".
std::span<const CFunction> cfunctions();
/// The function of this name. Throws std::invalid_argument for an unknown name, for a parameter out of range, and for a
/// parameter where there is none; all functions above throw the second.
CFunction cfunction(std::string_view name, std::optional<double> parameter = std::nullopt);

/// Each function that has a parameter, at the values of its grid: rho and alpha in {0.01, 0.1, 1, 10, 100}, the
/// penalised function's lambda in {0.5, 0.8, 0.95, 0.99}, Kanzow & Kleinmichel's in {0.1, 0.5, 1, 2, 3}.
std::span<const CFunction> cfunction_grid();

void describe(CFunction& function, Fields& fields);

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
