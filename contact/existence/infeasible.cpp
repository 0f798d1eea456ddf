// SPDX-License-Identifier: Apache-2.0
/// The radius of a certificate, and what it proves. The search is in infeasible_search.cpp.
#include "contact/existence/infeasible.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "contact/model/expansion.hpp"

namespace perp::contact {
namespace {

using Block = std::array<Expansion, 3>;

constexpr double tiny = 1e-300;
constexpr double out_of_this_world = 1e12;

/// W'(y e_N), contact by contact, exactly. Rows of W are read from the columns of contacts.
std::vector<Block> product(const Problem& problem, In y) {
  const int d = problem.dimension;
  const SpMat& W = problem.W.matrix();
  std::vector<Block> g(at(problem.contacts()));
  for (Index j = 0; j < W.outerSize(); ++j)
    for (SpMat::InnerIterator it(W, j); it; ++it)
      if (it.row() % d == 0) g[at(j / d)][at(j % d)].add_product(it.value(), y[it.row() / d]);
  return g;
}

struct Part {
  bool inside = false;  ///< g_N + mu |g_T| <= 0, exactly
  double excess = 0;    ///< at least (g_N + mu |g_T|)+
  double norm = 0;      ///< at least |P_K(g)|
};

/// mu |T| <= -N of N < 0 by squares, all exact; false also where something was lost.
bool inside_exactly(const Block& g, double mu) {
  Expansion squares;
  squares.add_product(g[1], g[1]);
  squares.add_product(g[2], g[2]);
  Expansion weight;
  weight.add_product(mu, mu);
  Expansion difference;
  difference.add_product(weight, squares);
  difference.negate();
  difference.add_product(g[0], g[0]);
  return difference.lost() == 0 && weight.lost() == 0 && squares.lost() == 0 && difference.finite() &&
         difference.sign() >= 0;
}

Part part_of(const Block& exact, double mu) {
  const double size = std::max({std::abs(exact[0].value()), std::abs(exact[1].value()), std::abs(exact[2].value())});
  if (!std::isfinite(size)) return {.excess = lcp::infinity, .norm = lcp::infinity};
  const double lost = exact[0].lost() + exact[1].lost() + exact[2].lost();
  const bool straight = mu == 0 || (exact[1].sign() == 0 && exact[2].sign() == 0 && lost == 0);
  if (straight && exact[0].sign() <= 0 && exact[0].lost() == 0) return {.inside = true};
  // Near one, nothing of what follows over- or underflows where it matters.
  const int scale = size > 0 ? -std::ilogb(size) : 0;
  const Block g{exact[0].scaled(scale), exact[1].scaled(scale), exact[2].scaled(scale)};
  const double lost_here = g[0].lost() + g[1].lost() + g[2].lost();
  const double N = g[0].value();
  const double T = std::hypot(g[1].value(), g[2].value());
  const double friction = mu * T;
  if (!std::isfinite(friction) || !std::isfinite(lost_here)) return {.excess = lcp::infinity, .norm = lcp::infinity};
  const double room = last_roundings * (std::abs(N) + friction) + tiny + 3 * lost_here * (1 + mu);
  if (-N - friction >= room) return {.inside = true};
  if (N < 0 && std::abs(N + friction) <= room && inside_exactly(g, mu)) return {.inside = true};
  const double excess = std::max(N + friction, 0.0) + room;
  const double whole = (std::hypot(N, T) + 3 * lost_here) * (1 + last_roundings) + tiny;
  const double norm = T <= mu * N ? whole : std::min(whole, excess / std::hypot(1, mu) * (1 + last_roundings) + tiny);
  return {.excess = std::ldexp(excess, -scale), .norm = std::ldexp(norm, -scale)};
}

struct Certificate {
  double radius = 0;
  std::vector<double> excess;
};

Certificate examine(const Problem& problem, In y) {
  if (y.size() != problem.contacts())
    throw std::invalid_argument("contact: the certificate has " + std::to_string(y.size()) + " entries, the problem " +
                                std::to_string(problem.contacts()) + " contacts");
  Certificate out;
  if (!y.allFinite() || (y.array() < 0).any()) return out;
  Expansion approach;
  for (Index a = 0; a < y.size(); ++a) approach.add_product(-problem.q[problem.dimension * a], y[a]);
  const double least = approach.value() * (1 - last_roundings) - approach.lost();
  if (!(least > 0) || !approach.finite()) return out;
  bool inside = true;
  double largest = 0;
  std::vector<double> norms;
  const std::vector<Block> g = product(problem, y);
  for (Index a = 0; a < problem.contacts(); ++a) {
    const Part part = part_of(g[at(a)], problem.mu[a]);
    inside = inside && part.inside;
    norms.push_back(part.norm);
    out.excess.push_back(part.excess);
    largest = std::max(largest, part.norm);
  }
  out.radius = lcp::infinity;
  if (inside) return out;
  double sum = 0;
  for (const double norm : norms) sum += (norm / largest) * (norm / largest);
  const auto n = static_cast<double>(norms.size());
  out.radius = least / (largest * std::sqrt(sum) * (1 + last_roundings + n * eps)) * (1 - last_roundings);
  if (!std::isfinite(out.radius)) out.radius = std::isfinite(largest) ? std::numeric_limits<double>::max() : 0;
  return out;
}

/// Whether what sticks out of -K* is rounding, contact by contact.
bool to_rounding(const Problem& problem, In y, const std::vector<double>& excess) {
  const int d = problem.dimension;
  const SpMat& W = problem.W.matrix();
  Vec size = Vec::Zero(problem.contacts());  // sqrt of the contact's largest diagonal entry
  for (Index j = 0; j < W.outerSize(); ++j)
    for (SpMat::InnerIterator it(W, j); it; ++it)
      if (it.row() == it.col()) size[j / d] = std::max(size[j / d], std::sqrt(std::abs(it.value())));
  Vec terms = Vec::Zero(problem.contacts());
  Vec met = Vec::Zero(problem.contacts());
  for (Index j = 0; j < W.outerSize(); ++j)
    for (SpMat::InnerIterator it(W, j); it; ++it) {
      if (it.row() % d != 0 || y[it.row() / d] == 0) continue;
      const Index a = j / d;
      const Index i = it.row() / d;
      terms[a] += y[i] * std::max(std::abs(it.value()), size[i] * size[a]);
      ++met[a];
    }
  for (Index a = 0; a < problem.contacts(); ++a)
    if (!(excess[at(a)] <= 8 * (met[a] + 2) * eps * (1 + problem.mu[a]) * terms[a])) return false;
  return true;
}

}  // namespace

double infeasibility_radius(const Problem& problem, In y) { return examine(problem, y).radius; }

bool proves_infeasible(const Problem& problem, In y) {
  const Certificate found = examine(problem, y);
  if (!(found.radius < lcp::infinity)) return found.radius == lcp::infinity;
  const auto W = problem.W.matrix().coeffs();
  const double largest = W.size() > 0 ? W.abs().maxCoeff() : 0;
  const double q = problem.q.size() > 0 ? problem.q.lpNorm<Eigen::Infinity>() : 0;
  return found.radius >= out_of_this_world * std::max(1.0, q / largest) && to_rounding(problem, y, found.excess);
}

}  // namespace perp::contact
