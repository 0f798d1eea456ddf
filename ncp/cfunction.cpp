#include "ncp/cfunction.hpp"

#include <algorithm>
#include <cmath>

namespace perp::ncp {
namespace {

/// phi(a, b) / min(a, b), as a sum of positive terms of order one: no cancellation, overflow or underflow.
double fischer_burmeister_factor(double most, double least) {
  if (least > 0) {  // ab > 0: phi = 2 ab / (a + b + r)
    const double q = least / most;
    return 2 / (1 + q + std::hypot(1.0, q));
  }
  if (most <= 0) {
    const double q = most / least;
    return 1 + q + std::hypot(1.0, q);
  }
  // most - r = -least^2 / (most + r)
  if (most >= -least) {
    const double q = -least / most;
    return 1 + q / (1 + std::hypot(1.0, q));
  }
  const double q = most / -least;
  return 1 + 1 / (q + std::hypot(1.0, q));
}

CValue fischer_burmeister_at(double a, double b, double ha, double hb) {
  if (a == infinity) return {b, 0, 1};  // x - l overflows
  if (b == infinity) return {a, 1, 0};
  const double size = std::max(std::abs(a), std::abs(b));
  if (size == 0) {
    const double h = std::hypot(ha, hb);
    if (h == 0) return {0, 1 - std::sqrt(0.5), 1 - std::sqrt(0.5)};  // the limit along a = b > 0
    return {0, 1 - ha / h, 1 - hb / h};
  }
  const double least = std::min(a, b);
  const double phi = least == 0 ? 0 : least * fischer_burmeister_factor(std::max(a, b), least);
  // The partials 1 - c and 1 - s of c = a / r and s = b / r, with a, b brought where r neither over- nor underflows.
  const double r = std::hypot(a / size, b / size);
  const double c = a / size / r;
  const double s = b / size / r;
  const auto one_minus = [](double x, double y) { return x > 0 ? y * y / (1 + x) : 1 - x; };  // x^2 + y^2 = 1
  return {phi, one_minus(c, s), one_minus(s, c)};
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
