#include "ncp/cfunction.hpp"

#include <algorithm>
#include <cmath>

namespace perp::ncp {
namespace {

CValue fischer_burmeister_at(double a, double b, double ha, double hb) {
  const double r = std::hypot(a, b);
  if (r == 0) {
    const double h = std::hypot(ha, hb);
    if (h == 0) return {0, 1 - std::sqrt(0.5), 1 - std::sqrt(0.5)};  // the limit along a = b > 0
    return {0, 1 - ha / h, 1 - hb / h};
  }
  if (std::isinf(r) && std::isfinite(a) && std::isfinite(b)) {  // phi is positively homogeneous
    const CValue v = fischer_burmeister_at(0.25 * a, 0.25 * b, ha, hb);
    return {4 * v.phi, v.da, v.db};
  }
  // a + b - r and 1 - a / r cancel; these forms have no difference of like numbers in them.
  const double most = std::max(a, b);
  const double least = std::min(a, b);
  double phi = (most - r) + least;  // both <= 0
  if (least > 0) {
    const double q = least / most;
    phi = 2 * least / (1 + q + std::hypot(1.0, q));
  } else if (most > 0) {
    phi = least - least * (least / (most + r));
  }
  const auto one_minus = [](double c, double s) { return c > 0 ? s * s / (1 + c) : 1 - c; };  // 1 - c, c^2 + s^2 = 1
  return {phi, one_minus(a / r, b / r), one_minus(b / r, a / r)};
}

CValue min_at(double a, double b, double ha, double hb) {
  if (a < b || (a == b && ha <= hb)) return {a, 1, 0};
  return {b, 0, 1};
}

/// Phi_i with its partials in x_i and F_i.
CValue row(const CFunction& c, double l, double u, double x, double F, double hx, double hF) {
  if (l == u) return {x - l, 1, 0};
  const bool has_lower = l > -infinity;
  const bool has_upper = u < infinity;
  if (!has_lower && !has_upper) return {F, 0, 1};
  if (!has_upper) return c.at(x - l, F, hx, hF);
  const CValue upper = c.at(u - x, -F, -hx, -hF);
  // d(-phi(u - x, -F)) = da dx + db dF
  if (!has_lower) return {-upper.phi, upper.da, upper.db};
  const CValue both = c.at(x - l, -upper.phi, hx, upper.da * hx + upper.db * hF);
  return {both.phi, both.da + both.db * upper.da, both.db * upper.db};
}

}  // namespace

CFunction fischer_burmeister() {
  return {.name = "fischer-burmeister",
          .formula = "a + b - sqrt(a^2 + b^2)",
          .smooth_merit = true,
          .at = fischer_burmeister_at};
}

CFunction natural_min() { return {.name = "min", .formula = "min(a, b)", .smooth_merit = false, .at = min_at}; }

void reformulate(const CFunction& c, const Box& box, In x, In F, In h, In Jh, Reformulation& out) {
  const Index n = x.size();
  out.Phi.resize(n);
  out.Da.resize(n);
  out.Db.resize(n);
  for (Index i = 0; i < n; ++i) {
    const CValue v = row(c, box.lower[i], box.upper[i], x[i], F[i], h[i], Jh[i]);
    out.Phi[i] = v.phi;
    out.Da[i] = v.da;
    out.Db[i] = v.db;
  }
}

void reformulate(const CFunction& c, const Box& box, In x, In F, Out Phi) {
  for (Index i = 0; i < x.size(); ++i) Phi[i] = row(c, box.lower[i], box.upper[i], x[i], F[i], 1, 1).phi;
}

}  // namespace perp::ncp
