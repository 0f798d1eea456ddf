// SPDX-License-Identifier: Apache-2.0
#include "ncp/reformulation/cfunction.hpp"

namespace perp::ncp {
void reformulate(const CFunction& c, const Box& box, In x, In F, In h, In Jh, Reformulation& out) {
  const Index n = x.size();
  out.Phi.resize(n);
  out.Da.resize(n);
  out.Db.resize(n);
  for (Index i = 0; i < n; ++i) {
    const CValue v = lcp::box_row(c.at, box.lower[i], box.upper[i], x[i], F[i], h[i], Jh[i]);
    out.Phi[i] = v.phi;
    out.Da[i] = v.da;
    out.Db[i] = v.db;
  }
}

void reformulate(const CFunction& c, const Box& box, In x, In F, Out Phi) {
  const auto rows = [&](const auto& phi) {
    for (Index i = 0; i < x.size(); ++i) Phi[i] = lcp::box_value(phi, box.lower[i], box.upper[i], x[i], F[i]);
  };
  if (c.value == &lcp::fischer_burmeister_value)
    rows([](double a, double b) { return lcp::fischer_burmeister_value(a, b); });  // in line
  else if (c.value != nullptr)
    rows(c.value);
  else
    rows([&c](double a, double b) { return c.at(a, b, 1, 1).phi; });
}

}  // namespace perp::ncp
