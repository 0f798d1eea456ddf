// SPDX-License-Identifier: Apache-2.0
#include "contact/solvers/kinks.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "contact/solvers/solve.hpp"
#include "lcp/classes/classify.hpp"
#include "lcp/dense_factors.hpp"
#include "lcp/solve/enumeration.hpp"
#include "lcp/solve/solve.hpp"
#include "lcp/words.hpp"

namespace perp::contact {
namespace {

using Dense = Eigen::MatrixXd;

/// Digits that the derivative is known to.
constexpr double kinks_tol = 1e-11;

/// Entries of a kink in y.
Index entries(const Kinks& kinks, const Kink& kink) {
  if (kink.law == Kink::Law::Pair) return 1;
  if (kink.law == Kink::Law::Disk) return kinks.width();
  return 1 + kinks.width() * std::ranges::count_if(kink.mu, [](double mu) { return mu > 0; });
}

bool affine(const Kinks& kinks) {
  return std::ranges::all_of(kinks.list, [&kinks](const Kink& kink) {
    return kink.law == Kink::Law::Pair || (kink.law == Kink::Law::Disk && kinks.width() == 1);
  });
}

/// y = scale y~ and S~ = scale S scale, whose diagonal is one in the mean of each kink, so that tolerances mean
/// something; of a diagonal that is not positive, scale 1.
Vec scale_of(const Kinks& kinks, const Dense& S) {
  Vec scale = Vec::Ones(S.rows());
  for (const Kink& kink : kinks.list) {
    const Index size = entries(kinks, kink);
    const double mean = S.diagonal().segment(kink.first, size).mean();
    if (mean > 0) scale.segment(kink.first, size).setConstant(1 / std::sqrt(mean));
  }
  return scale;
}

/// Tests that Coulomb's law has one solution for every h: positive definite, with the best c_a of one contact. Pairs
/// and disks have convex sets of their own, and no term.
bool one_solution_with_cones(const Kinks& kinks, const Dense& S) {
  Dense Q = (S + S.transpose()) / 2;
  const double size = Q.lpNorm<Eigen::Infinity>();
  const Eigen::LLT<Dense> factors(Q);
  if (factors.info() != Eigen::Success) return false;
  const Dense inverse = factors.solve(Dense::Identity(S.rows(), S.rows()));
  for (const Kink& kink : kinks.list) {
    if (kink.law != Kink::Law::Cone) continue;
    Index T = kink.first + 1;
    for (const double mu : kink.mu) {
      if (mu <= 0) continue;
      const auto S_T = S.middleRows(T, kinks.width());
      const Dense of_slip = S_T * inverse * S_T.transpose();
      const double most = Eigen::SelfAdjointEigenSolver<Dense>(of_slip).eigenvalues().maxCoeff();
      const double c = std::sqrt(inverse(kink.first, kink.first) / most);
      if (!(c > 0 && std::isfinite(c))) return false;
      Q -= mu / 2 * c * (S_T.transpose() * S_T);
      Q(kink.first, kink.first) -= mu / 2 / c;
      T += kinks.width();
    }
  }
  // S is known to some eps of its largest entry.
  Q.diagonal().array() -= 1e-12 * static_cast<double>(S.rows()) * size;
  return Eigen::LLT<Dense>(Q).info() == Eigen::Success;
}

lcp::AffineMcp as_mcp(const Kinks& kinks, const Dense& S, const Vec& h) {
  lcp::AffineMcp mcp = lcp::standard_lcp(S.sparseView(), h);
  for (const Kink& kink : kinks.list) {
    if (kink.law != Kink::Law::Disk) continue;
    mcp.box.lower[kink.first] = -kink.radius;
    mcp.box.upper[kink.first] = kink.radius;
  }
  return mcp;
}

/// The contact problem, and which of its rows are those of y.
struct AsContacts {
  Problem problem{};
  std::vector<Index> rows{};
};

AsContacts as_contacts(const Kinks& kinks, const Dense& S, const Vec& h) {
  const int d = kinks.dimension;
  const int width = kinks.width();
  const auto n = static_cast<Index>(kinks.list.size());
  AsContacts out;
  out.problem.dimension = d;
  out.problem.q = Vec::Zero(d * n);
  out.problem.mu = Vec::Zero(n);
  if (kinks.rolls) out.problem.mu_r = Vec::Zero(n);
  out.rows.resize(lcp::at(S.rows()));
  std::vector<char> taken(lcp::at(d * n), 0);
  const auto take = [&](Index entry, Index row, Index count) {
    for (Index k = 0; k < count; ++k) {
      out.rows[lcp::at(entry + k)] = row + k;
      taken[lcp::at(row + k)] = 1;
      out.problem.q[row + k] = h[entry + k];
    }
  };
  for (Index a = 0; a < n; ++a) {
    const Kink& kink = kinks.list[lcp::at(a)];
    const Index N = d * a;
    if (kink.law == Kink::Law::Disk) {
      // Without a coupling, r_N = -q_N.
      out.problem.q[N] = -kink.radius;
      out.problem.mu[a] = 1;
      take(kink.first, N + 1, width);
      continue;
    }
    take(kink.first, N, 1);
    if (kink.law == Kink::Law::Pair) continue;
    Index entry = kink.first + 1;
    for (int j = 0; j < 2; ++j) {
      if (kink.mu[lcp::at(j)] <= 0) continue;
      (j == 0 ? out.problem.mu : out.problem.mu_r)[a] = kink.mu[lcp::at(j)];
      take(entry, N + 1 + j * width, width);
      entry += width;
    }
  }
  std::vector<Eigen::Triplet<double>> W;
  const auto add = [&W](Index i, Index j, double value) {
    W.emplace_back(static_cast<int>(i), static_cast<int>(j), value);
  };
  for (Index j = 0; j < S.cols(); ++j)
    for (Index i = 0; i < S.rows(); ++i) add(out.rows[lcp::at(i)], out.rows[lcp::at(j)], S(i, j));
  for (Index i = 0; i < d * n; ++i)
    if (!taken[lcp::at(i)]) add(i, i, 1);
  SpMat matrix(d * n, d * n);
  matrix.setFromTriplets(W.begin(), W.end());
  out.problem.W = std::move(matrix);
  return out;
}

constexpr const char* vanishes =
    "no direction of the solution satisfies the conditions at the kinks: in this direction of p the solution may "
    "vanish "
    "or jump";

void solve_affine(const Kinks& kinks, const Dense& S, const Vec& h, KinksSolution& out) {
  const lcp::AffineMcp mcp = as_mcp(kinks, S, h);
  if (out.always) {
    const lcp::Result found = lcp::solve(mcp, Vec::Zero(h.size()));
    if (found.solved())
      out.y = found.z;
    else
      out.why = "the problem of their directions has one solution, but none was found: " + found.message;
    return;
  }
  const lcp::Solutions all = lcp::enumerate(mcp);
  if (!all.complete)
    out.why = "whether their directions are the only ones could not be decided: " + all.message;
  else if (all.found.empty())
    out.why = vanishes;
  else if (all.found.size() > 1 || all.found.front().dimension > 0)
    out.why = "the conditions at the kinks have " +
              (all.found.size() == 1 ? "a continuum of" : std::to_string(all.found.size())) +
              " solutions: several paths of solutions may leave r in this direction of p";
  else
    out.y = all.found.front().z;
}

void solve_cones(const Kinks& kinks, const Dense& S, const Vec& h, KinksSolution& out) {
  if (!out.always) {
    out.why =
        "their friction is too large beside what couples slip and normal impulses for a proof that their directions "
        "are the only ones";
    return;
  }
  const AsContacts contacts = as_contacts(kinks, S, h);
  const Result found = solve(contacts.problem, {.tol = kinks_tol});
  if (found.solved())
    out.y = found.solution.r(contacts.rows);
  else
    out.why = found.status == Status::Infeasible
                  ? vanishes
                  : "the problem of their directions has one solution, but none was found: " + found.message;
}

}  // namespace

KinksSolution solve(const Kinks& kinks, const Dense& S, In h) {
  const Vec scale = scale_of(kinks, S);
  // The problem is positively homogeneous in h and the radii.
  double unit = h.cwiseProduct(scale).lpNorm<Eigen::Infinity>();
  for (const Kink& kink : kinks.list) unit = std::max(unit, kink.radius / scale[kink.first]);
  const Dense scaled_S = scale.asDiagonal() * S * scale.asDiagonal();
  KinksSolution out;
  const bool is_affine = affine(kinks);
  out.always = is_affine ? lcp::classify(scaled_S.sparseView()).p.yes() : one_solution_with_cones(kinks, scaled_S);
  const double per_unit = unit > 0 ? 1 / unit : 1;
  Kinks in_units = kinks;
  for (Kink& kink : in_units.list) kink.radius *= per_unit / scale[kink.first];
  const Vec h_in_units = per_unit * h.cwiseProduct(scale);
  if (unit <= 0 && out.always)
    out.y = Vec::Zero(h.size());
  else if (is_affine)
    solve_affine(in_units, scaled_S, h_in_units, out);
  else
    solve_cones(in_units, scaled_S, h_in_units, out);
  if (out.y.size() > 0) out.y = out.y.cwiseProduct(scale) / per_unit;
  return out;
}

}  // namespace perp::contact
