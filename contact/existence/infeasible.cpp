// SPDX-License-Identifier: Apache-2.0
/// The radius of a certificate, and what it proves. The search is in infeasible_search.cpp.
#include "contact/existence/infeasible.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "contact/existence/expansion.hpp"

namespace perp::contact {
namespace {

using Block = std::array<Expansion, 5>;  // of a contact, zero after its d entries

constexpr double tiny = 1e-300;
constexpr double out_of_this_world = 1e12;
/// Of a norm by the factors of M, in eps times its condition, generously.
constexpr double norm_roundings = 100;

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
  bool inside = false;  ///< g_N + sum mu_j |g_j| <= 0, exactly
  double excess = 0;    ///< at least (g_N + sum mu_j |g_j|)+
  double norm = 0;      ///< at least |P_K(g)|
};

/// A disk of a contact: its coefficient, and where its entries are; 0 of the second stands for none.
struct Disk {
  double mu = 0;
  std::array<std::size_t, 2> at{};
};

std::vector<Disk> disks_of(const Problem& problem, Index a) {
  const auto width = static_cast<std::size_t>(problem.disk_width());
  const auto disk = [width](double mu, std::size_t first) {
    return Disk{.mu = mu, .at = {first, width == 2 ? first + 1 : 0}};
  };
  std::vector<Disk> out{disk(problem.mu[a], 1)};
  if (problem.rolls()) out.push_back(disk(problem.mu_r[a], 1 + width));
  std::erase_if(out, [](const Disk& d) { return d.mu == 0; });
  return out;
}

/// mu |T| <= -N of N < 0 by squares, all exact; false also where something was lost.
bool inside_exactly(const Block& g, const Disk& disk) {
  const double mu = disk.mu;
  Expansion squares;
  for (const std::size_t i : disk.at)
    if (i > 0) squares.add_product(g[i], g[i]);
  Expansion weight;
  weight.add_product(mu, mu);
  Expansion difference;
  difference.add_product(weight, squares);
  difference.negate();
  difference.add_product(g[0], g[0]);
  return difference.lost() == 0 && weight.lost() == 0 && squares.lost() == 0 && difference.finite() &&
         difference.sign() >= 0;
}

Part part_of(const Block& exact, const std::vector<Disk>& disks) {
  double size = 0;
  double lost = 0;
  for (const Expansion& entry : exact) {
    size = std::isfinite(entry.value()) ? std::max(size, std::abs(entry.value())) : lcp::infinity;
    lost += entry.lost();
    if (!std::isfinite(size)) return {.excess = lcp::infinity, .norm = lcp::infinity};
  }
  const auto nothing = [&exact](const Disk& disk) {
    return exact[disk.at[0]].sign() == 0 && (disk.at[1] == 0 || exact[disk.at[1]].sign() == 0);
  };
  const bool straight = disks.empty() || (std::ranges::all_of(disks, nothing) && lost == 0);
  if (straight && exact[0].sign() <= 0 && exact[0].lost() == 0) return {.inside = true};
  // Near one, nothing of what follows over- or underflows where it matters.
  const int scale = size > 0 ? -std::ilogb(size) : 0;
  Block g;
  double lost_here = 0;
  double whole = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    g[i] = exact[i].scaled(scale);
    lost_here += g[i].lost();
    whole = std::hypot(whole, g[i].value());
  }
  const double N = g[0].value();
  double friction = 0;
  double mu = 0;  // of all disks
  for (const Disk& disk : disks) {
    friction += disk.mu * std::hypot(g[disk.at[0]].value(), disk.at[1] > 0 ? g[disk.at[1]].value() : 0);
    mu += disk.mu;
  }
  if (!std::isfinite(friction) || !std::isfinite(lost_here)) return {.excess = lcp::infinity, .norm = lcp::infinity};
  const double room = last_roundings * (std::abs(N) + friction) + tiny + 3 * lost_here * (1 + mu);
  if (-N - friction >= room) return {.inside = true};
  if (disks.size() == 1 && N < 0 && std::abs(N + friction) <= room && inside_exactly(g, disks[0]))
    return {.inside = true};
  const double excess = std::max(N + friction, 0.0) + room;
  whole = (whole + 3 * lost_here) * (1 + last_roundings) + tiny;
  // |P_K(g)| = g.x for a unit vector x of K, and g.x <= x_N excess; on the boundary of one disk x_N = 1 / |(1, mu)|.
  double norm = std::min(whole, excess);
  if (disks.size() == 1)
    norm = friction <= mu * mu * N ? whole : std::min(whole, excess / std::hypot(1, mu) * (1 + last_roundings) + tiny);
  return {.excess = std::ldexp(excess, -scale), .norm = std::ldexp(norm, -scale)};
}

struct Certificate {
  double radius = 0;
  bool to_rounding = false;  ///< what keeps a finite radius finite is rounding
};

/// -q_N.y, rounded down; 0 where it proves nothing. A condensed q is known to its roundings only.
double approach_of(const Problem& problem, In y) {
  if (y.size() != problem.contacts())
    throw std::invalid_argument("contact: the certificate has " + std::to_string(y.size()) + " entries, the problem " +
                                std::to_string(problem.contacts()) + " contacts");
  if (!y.allFinite() || (y.array() < 0).any()) return 0;
  Expansion approach;
  for (Index a = 0; a < y.size(); ++a) approach.add_product(-problem.q[problem.dimension * a], y[a]);
  double least = approach.value() * (1 - last_roundings) - approach.lost();
  if (const Vec& unknown = problem.rounding.q; unknown.size() > 0)
    for (Index a = 0; a < y.size(); ++a)
      if (y[a] > 0) least -= unknown[problem.dimension * a] * y[a] * (1 + last_roundings);
  return least > 0 && approach.finite() ? least : 0;
}

/// -q_N.y over the norm of these, rounded down.
double radius_of(double least, const std::vector<double>& norms) {
  double largest = tiny;
  for (const double norm : norms) {
    if (!std::isfinite(norm)) return 0;
    largest = std::max(largest, norm);
  }
  double sum = 0;
  for (const double norm : norms) sum += (norm / largest) * (norm / largest);
  const auto n = static_cast<double>(norms.size());
  const double radius = least / (largest * std::sqrt(sum) * (1 + last_roundings + n * eps)) * (1 - last_roundings);
  return std::min(radius, std::numeric_limits<double>::max());
}

/// The coefficients of all its disks.
double friction_of(const Problem& problem, Index a) { return problem.mu[a] + (problem.rolls() ? problem.mu_r[a] : 0); }

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
    if (!(excess[at(a)] <= 8 * (met[a] + 2) * eps * (1 + friction_of(problem, a)) * terms[a])) return false;
  return true;
}

/// y e_N.
Vec normals_of(const Problem& problem, In y) {
  Vec normals = Vec::Zero(problem.q.size());
  for (Index a = 0; a < y.size(); ++a) normals[problem.dimension * a] = y[a];
  return normals;
}

/// Of a condensed W, which is symmetric: how far W'(y e_N) of its entries is from that of what it was condensed from.
/// Its entries may be rounding alone.
Vec lost_by_condensing(const Problem& problem, const lcp::SchurProduct& W, In y, const std::vector<Block>& g) {
  const int d = problem.dimension;
  const auto [exact, doubt, terms] = W(normals_of(problem, y), Vec::Zero(problem.q.size()));
  Vec lost = Vec::Zero(y.size());
  for (Index a = 0; a < y.size(); ++a)
    for (int k = 0; k < d; ++k)
      lost[a] = std::hypot(lost[a], std::abs(exact[d * a + k] - g[at(a)][at(k)].value()) + doubt[d * a + k]);
  return lost * (1 + last_roundings);
}

Certificate examine_entries(const Problem& problem, In y, double least) {
  const lcp::SchurProduct* condensed = problem.W.condensed();
  if (condensed != nullptr && !condensed->symmetric()) return {};
  bool inside = true;
  std::vector<double> norms;
  std::vector<double> excess;
  const std::vector<Block> g = product(problem, y);
  const Vec lost = condensed != nullptr ? lost_by_condensing(problem, *condensed, y, g) : Vec::Zero(y.size());
  for (Index a = 0; a < problem.contacts(); ++a) {
    Part part = part_of(g[at(a)], disks_of(problem, a));
    if (lost[a] != 0) {  // P_K does not stretch
      part.inside = false;
      part.excess += (1 + friction_of(problem, a)) * lost[a];
      part.norm += lost[a];
    }
    inside = inside && part.inside;
    norms.push_back(part.norm);
    excess.push_back(part.excess);
  }
  if (inside) return {.radius = lcp::infinity};
  return {.radius = radius_of(least, norms), .to_rounding = to_rounding(problem, y, excess)};
}

/// p = H (y e_N), what the weights y do to the bodies' momentum.
struct Momentum {
  Vec value;             ///< to 2 eps of itself
  bool zero = true;      ///< exactly
  bool complete = true;  ///< nothing was lost, and no entry overflowed
  bool exact = true;     ///< `value` is not rounded
  std::vector<int> met;  ///< of each body, its contacts with y > 0
  Vec terms;             ///< of each body, sum_a y_a N_ba: the size of what cancels in p, in the norm of M^-1
};

Momentum momentum(const Problem& problem, const DelassusParts& parts, In y) {
  const SpMat& H = parts.H();
  std::vector<Expansion> sums(at(H.rows()));
  const int bodies = parts.inertia().bodies();
  Momentum p{.value = Vec(H.rows()), .met = std::vector<int>(at(bodies), 0), .terms = Vec::Zero(bodies)};
  for (Index a = 0; a < y.size(); ++a) {
    if (y[a] == 0) continue;
    const Index j = problem.dimension * a;
    for (SpMat::InnerIterator it(H, j); it; ++it) sums[at(it.row())].add_product(it.value(), y[a]);
    for (SpMat::InnerIterator it(parts.shares(), j); it; ++it) {
      p.terms[it.row()] += y[a] * it.value();
      ++p.met[at(it.row())];
    }
  }
  for (Index i = 0; i < p.value.size(); ++i) {
    const Expansion& sum = sums[at(i)];
    p.value[i] = sum.value();
    p.zero = p.zero && sum.sign() == 0;
    Expansion rest = sum;
    rest.add(-p.value[i]);
    p.exact = p.exact && rest.sign() == 0;
    p.complete = p.complete && sum.lost() == 0 && std::isfinite(p.value[i]);
  }
  return p;
}

/// W = H' M^-1 H of bodies. Friction plays no part: -g in K* is W (y e_N) = 0, which is H (y e_N) = p = 0. Else, with
/// |p|_b in the norm of body b's M^-1, |g_i| <= sum_b N_bi |p|_b.
Certificate examine_bodies(const Problem& problem, const DelassusParts& parts, In y, double least) {
  const Momentum p = momentum(problem, parts, y);
  if (!p.complete) return {};
  if (p.zero) return {.radius = lcp::infinity};
  const double inexact = norm_roundings * eps / parts.inertia().rcond();
  if (!(inexact < 0.5)) return {};
  const int scale = -std::ilogb(p.value.lpNorm<Eigen::Infinity>());
  const Vec scaled = p.value.unaryExpr([scale](double x) { return std::ldexp(x, scale); });
  const Vec v = parts.inverse(scaled);
  Vec of_bodies = Vec::Zero(p.terms.size());
  for (Index i = 0; i < v.size(); ++i) of_bodies[parts.inertia().body_of()[at(i)]] += scaled[i] * v[i];
  Certificate out{.to_rounding = true};
  for (Index b = 0; b < of_bodies.size(); ++b) {
    if (p.met[at(b)] == 0) continue;
    of_bodies[b] = std::ldexp(std::sqrt(std::max(of_bodies[b], 0.0)) * (1 + inexact), -scale) + tiny;
    if (!(of_bodies[b] <= 8 * (p.met[at(b)] + 2) * eps * p.terms[b])) out.to_rounding = false;
  }
  std::vector<double> norms;
  for (Index i = 0; i < parts.shares().cols(); ++i)
    norms.push_back(parts.shares().col(i).dot(of_bodies) * (1 + inexact));
  out.radius = radius_of(least, norms);
  return out;
}

/// Whether p is G lambda for these doubles lambda, exactly: what constraints hold moves nothing.
bool held_exactly(const Inertia& inertia, const Vec& p, const Vec& lambda) {
  const Index m = inertia.velocities();
  std::vector<Expansion> left(at(m));
  for (Index i = 0; i < m; ++i) left[at(i)].add(p[i]);
  for (Index k = 0; k < lambda.size(); ++k)
    for (SpMat::InnerIterator it(inertia.M(), m + k); it; ++it) left[at(it.row())].add_product(-it.value(), lambda[k]);
  return std::ranges::all_of(left,
                             [](const Expansion& sum) { return sum.sign() == 0 && sum.lost() == 0 && sum.finite(); });
}

/// |H|' sum_a y_a |K^-1 H_a|, the sizes of what cancels in W (y e_N); nothing of too many contacts.
Vec sizes_of(const DelassusParts& parts, int d, In y) {
  constexpr Index most = 1000;
  if ((y.array() > 0).count() > most) return Vec::Zero(parts.H().cols());
  Vec moved = Vec::Zero(parts.H().rows());
  for (Index a = 0; a < y.size(); ++a)
    if (y[a] > 0) moved += y[a] * parts.inverse(Vec(parts.H().col(d * a))).cwiseAbs();
  return parts.H().cwiseAbs().transpose() * moved;
}

/// The same of bodies that constraints hold: H (y e_N) need not be 0 then, but W (y e_N), which is known with a bound.
/// For an inertia that is not symmetric this is none of W'(y e_N).
Certificate examine_constrained(const Problem& problem, const DelassusParts& parts, In y, double least) {
  const Inertia& inertia = parts.inertia();
  if (!inertia.symmetric()) return {};
  const Momentum p = momentum(problem, parts, y);
  if (!p.complete) return {};
  if (p.zero) return {.radius = lcp::infinity};
  const std::optional<lcp::TwoPartVector> v = inertia.lu().refined(lcp::TwoPartVector(p.value));
  if (!v) return {};
  const Vec lambda = v->value.tail(p.value.size() - inertia.velocities());
  if (p.exact && held_exactly(inertia, p.value, lambda)) return {.radius = lcp::infinity};
  const int d = problem.dimension;
  const lcp::SchurImage g = parts.refined_product(normals_of(problem, y), 0, Vec::Zero(problem.q.size()));
  const Vec sizes = sizes_of(parts, d, y);
  const double roundings = 8 * (static_cast<double>((y.array() > 0).count()) + 2) * eps;
  Certificate out{.to_rounding = true};
  std::vector<double> norms;
  for (Index a = 0; a < y.size(); ++a) {
    const Vec upper = g.value.segment(d * a, d).cwiseAbs() + g.doubt.segment(d * a, d);
    norms.push_back(upper.stableNorm() * (1 + last_roundings) + tiny);
    if (!(upper.maxCoeff() <= roundings * sizes.segment(d * a, d).maxCoeff())) out.to_rounding = false;
  }
  out.radius = radius_of(least, norms);
  return out;
}

Certificate examine(const Problem& problem, In y) {
  const double least = approach_of(problem, y);
  if (!(least > 0)) return {};
  const DelassusParts* parts = problem.W.whole_parts();
  if (parts == nullptr) return examine_entries(problem, y, least);
  return parts->inertia().by_lu() ? examine_constrained(problem, *parts, y, least)
                                  : examine_bodies(problem, *parts, y, least);
}

/// |W|_max: of a semidefinite W the largest is on the diagonal.
double largest_entry(const Delassus& W) {
  if (W.rows() == 0) return 0;
  if (W.whole_parts() != nullptr) return W.diagonal().maxCoeff();
  const auto entries = W.matrix().coeffs();
  return entries.size() > 0 ? entries.abs().maxCoeff() : 0;
}

}  // namespace

double infeasibility_radius(const Problem& problem, In y) { return examine(problem, y).radius; }

bool proves_infeasible(const Problem& problem, In y) {
  const Certificate found = examine(problem, y);
  if (!(found.radius < lcp::infinity)) return found.radius == lcp::infinity;
  const double q = problem.q.size() > 0 ? problem.q.lpNorm<Eigen::Infinity>() : 0;
  return found.to_rounding && found.radius >= out_of_this_world * std::max(1.0, q / largest_entry(problem.W));
}

}  // namespace perp::contact
