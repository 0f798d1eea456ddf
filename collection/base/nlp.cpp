// SPDX-License-Identifier: Apache-2.0
#include "collection/base/nlp.hpp"

namespace perp::ncp::collection {

Shape kkt_shape(const Nlp& nlp) {
  const Vec zero = Vec::Zero(nlp.inequalities);
  const Vec above = Vec::Constant(nlp.inequalities, infinity);
  const Vec free = Vec::Constant(nlp.equalities, infinity);
  return {.name = nlp.name,
          .box = Box{joined({nlp.X.lower, zero, Vec(-free)}), joined({nlp.X.upper, above, free})},
          .variables =
              joined({indexed("x", nlp.X.size()), indexed("lambda", nlp.inequalities), indexed("mu", nlp.equalities)})};
}

std::unique_ptr<Mcp> as_affine(const Mcp& mcp, Shape shape) {
  const Vec zero = Vec::Zero(mcp.size());
  Vec q(mcp.size());
  SpMat M = mcp.jacobian_pattern();
  mcp.eval(zero, q);
  mcp.jacobian(zero, M);
  M.prune([](Index, Index, double entry) { return entry != 0; });
  return make_affine(std::move(shape), M, q);
}

std::vector<Vec> kkt_starts(const Nlp& nlp, std::initializer_list<Vec> points) {
  const Index m = nlp.inequalities + nlp.equalities;
  std::vector<Vec> starts;
  for (const Vec& x : points)
    for (const double multiplier : {0.0, 1.0})
      if (multiplier == 0 || m > 0) starts.push_back(joined({x, Vec(Vec::Constant(m, multiplier))}));
  return starts;
}

}  // namespace perp::ncp::collection
