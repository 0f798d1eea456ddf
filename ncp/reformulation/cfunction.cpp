#include "ncp/reformulation/cfunction.hpp"

#include "ncp/problem/wide_arithmetic.hpp"

namespace perp::ncp {
namespace {

/// Phi_i with its partials in x_i and F_i.
CValue row(const CFunction& c, double l, double u, double x, double F, double hx, double hF) {
  if (l == u) return {saturated(x - l), 1, 0};
  const bool has_lower = l > -infinity;
  const bool has_upper = u < infinity;
  if (!has_lower && !has_upper) return {F, 0, 1};
  if (!has_upper) return c.at(x - l, F, hx, hF);
  const CValue upper = c.at(u - x, -F, -hx, -hF);
  // d(-phi(u - x, -F)) = da dx + db dF
  if (!has_lower) return {-upper.phi, upper.da, upper.db};
  const CValue both = c.at(x - l, -upper.phi, hx, upper.da * hx + upper.db * hF);
  return {both.phi, saturated(both.da + both.db * upper.da), saturated(both.db * upper.db)};
}

}  // namespace

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
