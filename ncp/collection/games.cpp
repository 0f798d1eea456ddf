/// Nash-Cournot equilibria: n firms sell one good at the price that the total output Q fetches.
#include <cmath>
#include <utility>

#include "ncp/collection/build.hpp"
#include "ncp/collection/problems.hpp"

namespace perp::ncp::collection {

namespace {

/// Firm i has marginal cost c_i + (L q_i)^(1/beta_i); the market clears at p(Q) = (5000 / Q)^(1/gamma).
struct Oligopoly {
  Vec c, beta;
  double L = 10;
  double gamma = 1.2;

  bool defined(In q) const { return q.minCoeff() >= 0 && q.sum() > 0; }
  double price(double Q) const { return std::pow(5000 / Q, 1 / gamma); }

  /// F_i = c_i + (L q_i)^(1/beta_i) - p + q_i p / (gamma Q), as p' = -p / (gamma Q). Not defined for q_i < 0, Q = 0.
  bool marginal_loss(In q, Out F) const {
    if (!defined(q)) return false;
    const double Q = q.sum(), p = price(Q);
    F = c.array() + (L * q.array()).pow(1 / beta.array()) - p + q.array() * p / (gamma * Q);
    return F.allFinite();
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

std::unique_ptr<Mcp> make_oligopoly(std::string name, Oligopoly market) {
  const Index n = market.c.size();
  Functions made = functions_of({std::move(name), Box::nonnegative(n), indexed("q", n), indexed("marginal_loss", n)});
  made.F = [market](In q, Out F) { return market.marginal_loss(q, F); };
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
  p.solutions = {{"unique",
                  vec({7.4415467, 4.09781045, 2.59064375, .93538577, 17.94895234, 4.09781045, 1.30472576, 5.59008254,
                       3.22217945, 1.67709432}),
                  1e-7}};
  p.solutions_complete = true;
  return p;
}

}  // namespace perp::ncp::collection
