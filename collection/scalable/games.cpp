// SPDX-License-Identifier: Apache-2.0
/// Nash-Cournot equilibria: n firms sell one good at the price that the total output Q fetches.
#include <cmath>
#include <utility>

#include "collection/base/build.hpp"
#include "collection/base/random.hpp"
#include "collection/models/problems.hpp"
#include "collection/scalable/generators.hpp"

namespace perp::ncp::collection {

namespace {

/// Firm i has marginal cost c_i + (L q_i)^(1/beta_i); the market clears at p(Q) = (demand / Q)^(1/gamma).
struct Oligopoly {
  Vec c, beta;
  double L = 10;
  double gamma = 1.2;
  double demand = 5000;

  bool defined(In q) const { return q.minCoeff() >= 0 && q.sum() > 0; }
  template <class T>
  T price(const T& Q) const {
    using std::pow;
    return pow(demand / Q, 1 / gamma);
  }

  /// F_i = c_i + (L q_i)^(1/beta_i) - p + q_i p / (gamma Q), as p' = -p / (gamma Q). Not defined for q_i < 0, Q = 0.
  template <class Z, class Y>
  void marginal_loss(const Z& q, Y& F) const {
    using std::pow;
    using T = typename Z::Scalar;
    const T Q = q.sum(), p = price(Q), per_unit = p / (gamma * Q);
    for (Index i = 0; i < q.size(); ++i) F[i] = c[i] + pow(L * q[i], 1 / beta[i]) - p + q[i] * per_unit;
  }
  /// dF_i/dq_j = p / (gamma Q) (1 - (1 + 1/gamma) q_i / Q) + [i = j] ((L / beta_i) (L q_i)^(1/beta_i - 1) + p / (gamma
  /// Q)). Infinite at q_i = 0 where beta_i > 1.
  bool jacobian(In q, SpMat& J) const {
    if (!defined(q)) return false;
    const Index n = q.size();
    const double Q = q.sum(), slope = price(Q) / (gamma * Q);
    Eigen::Map<Eigen::MatrixXd> dense(J.valuePtr(), n, n);
    dense.colwise() = Vec(slope * (1 - (1 + 1 / gamma) / Q * q.array()));
    dense.diagonal().array() += slope + L / beta.array() * (L * q.array()).pow(1 / beta.array() - 1);
    return dense.allFinite();
  }
};

std::unique_ptr<Mcp> make_oligopoly(std::string name, const Oligopoly& market) {
  const Index n = market.c.size();
  Functions made = functions_of({std::move(name), Box::nonnegative(n), indexed("q", n), indexed("marginal_loss", n)});
  made.F = [market](In q, Out F) { return market.defined(q) && (market.marginal_loss(q, F), F.allFinite()); };
  made.expression = on_vectors(n, [market](const auto& q, auto& F) { market.marginal_loss(q, F); });
  made.J = [market](In q, SpMat& J) { return market.jacobian(q, J); };
  return make_mcp(std::move(made));
}

}  // namespace

/// Harker's ten firms (Murphy, Sherali & Soyster 1982 with five): see Oligopoly.
Problem nash10() {
  Problem p;
  p.mcp = make_oligopoly("nash10",
                         {vec({5, 3, 8, 5, 1, 3, 7, 4, 6, 3}), vec({1.2, 1, 0.9, 0.6, 1.5, 1, 0.7, 1.1, 0.95, 0.75})});
  p.starts = {Vec::Ones(10), Vec::Constant(10, 10), Vec::Constant(10, 100),
              vec({1, 1.2, 1.4, 1.6, 1.8, 2.1, 2.3, 2.5, 2.7, 2.9}), vec({7, 4, 3, 1, 18, 4, 1, 6, 3, 2})};
  p.solutions = {
      {"unique",
       vec({7.4415466970587358, 4.0978104473473209, 2.590643747438953, 0.9353857680722274, 17.94895234200661,
            4.0978104473473209, 1.3047257576800073, 5.5900825435576316, 3.2221794538246158, 1.6770943168393273}),
       1e-13}};
  p.solutions_complete = true;
  return p;
}

/// Planted: at the price 50 an active firm's convex cost rises at a rate m_i of 20 to 50 % of it, which gives q_i =
/// m_i^beta_i / L; c_i and the demand follow from F = 0. Firms that stay out have c_i > p, and beta_i <= 1, so that J
/// is defined at the solution.
Problem nash_own(Index firms, unsigned seed) {
  require_at_least("nash-own", "firms", firms, 10);
  Random random(seed);
  constexpr double price = 50;
  Oligopoly market{Vec(firms), Vec(firms)};
  Vec q = Vec::Zero(firms), rate(firms);
  const auto out = [](Index i) { return i % 8 == 7; };
  for (Index i = 0; i < firms; ++i) {
    market.beta[i] = random.uniform(0.8, out(i) ? 1 : 1.2);
    rate[i] = price * random.uniform(0.2, 0.5);
    if (!out(i)) q[i] = std::pow(rate[i], market.beta[i]) / market.L;
  }
  const double Q = q.sum();
  market.demand = Q * std::pow(price, market.gamma);
  for (Index i = 0; i < firms; ++i)
    market.c[i] = out(i) ? price * random.uniform(1.05, 1.5) : price * (1 - q[i] / (market.gamma * Q)) - rate[i];
  Problem p;
  p.mcp = make_oligopoly("nash-own", market);
  p.starts = {Vec::Ones(firms), Vec::Constant(firms, 10), Vec::Constant(firms, 100)};
  p.solutions = {{"planted", q, 1e-12}};
  p.solutions_complete = true;
  return p;
}

}  // namespace perp::ncp::collection
