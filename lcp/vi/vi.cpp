// SPDX-License-Identifier: Apache-2.0
#include "lcp/vi/vi.hpp"

#include <cmath>
#include <limits>

#include "lcp/judge/judge.hpp"
#include "lcp/solve/solve.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {
namespace {

constexpr double unit = std::numeric_limits<double>::epsilon();
/// Rows and variables up to which faces are pivoted on: a dense matrix of 72 MB.
constexpr Index most_dense = 3000;

class Solver {
 public:
  Solver(const AffineVi& vi, const Limits& limits) : vi_(vi), limits_(limits), projector_(vi.C) {}

  ViResult judged(In x, const Face& face) {
    return judge_affine_vi(projector_, x, judge(AffineMcp{vi_.M, vi_.q, Box::free(vi_.size())}, x), face, limits_);
  }

  ViResult faces() {
    const Eigen::MatrixXd M(vi_.M);
    Face face;
    FacePivoting pivoting;
    pivoting.prepare(&M, projector_.dense());
    const auto end = pivoting.run(vi_.q, vi_.C.rows, vi_.C.box, face, limits_);
    ViResult result;
    if (end == FacePivoting::End::Found) {
      result = judged(pivoting.x(), face);
    } else if (end == FacePivoting::End::Empty) {
      const AffineMcp mcp = lifted(vi_);
      result.certificate = proof_of_empty(mcp, vi_.C, pivoting.certificate());
      if (result.certificate.size() > 0) {
        result.status = Status::Infeasible;
        result.empty = true;
        result.message = "the polyhedron is empty: rows of it contradict each other, by the certificate";
      }
    }
    result.iterations = pivoting.pivots();
    return result;
  }

  ViResult by_multipliers() {
    const AffineMcp mcp = lifted(vi_);
    const Result found = lcp::solve(mcp, project(mcp.box, Vec::Zero(mcp.size())), Auto{}, limits_);
    ViResult result = judged(found.z.head(vi_.size()), face_of(vi_.C, found.z));
    result.iterations = found.iterations;
    if (!result.accepted() && found.status == Status::Infeasible) {
      result.status = Status::Infeasible;
      result.certificate = found.certificate;
      result.message = found.message;
      const Vec y = found.certificate.size() > 0 ? Vec(found.certificate.segment(vi_.size(), vi_.C.A.rows())) : Vec{};
      result.empty = y.size() > 0 && proof_of_empty(mcp, vi_.C, y).size() > 0;
    } else if (!result.accepted() && !found.accepted()) {
      result.status = found.status;
      result.message = found.message;
    }
    return result;
  }

 private:
  const AffineVi& vi_;
  const Limits& limits_;
  Projector projector_;
};

}  // namespace

ViResult solve_vi(const AffineVi& vi, const ViOptions& options, const Limits& limits) {
  if (const auto why = AffineMcp{vi.M, vi.q, Box::free(vi.size())}.invalid()) refuse_input(*why);
  if (vi.C.size() != vi.size()) refuse_input("l: has ", vi.C.size(), " entries, and q has ", vi.size());
  if (!(limits.tol > 0) || limits.tol == infinity) refuse_input("tol: is ", limits.tol, ", not a positive number");
  Solver solver(vi, limits);
  using By = ViOptions::Method;
  ViResult result;
  const bool small = vi.size() + vi.C.A.rows() <= most_dense;
  if (options.method == By::Faces || (options.method == By::Auto && small)) {
    result = solver.faces();
    if (options.method == By::Faces || result.accepted() || result.status == Status::Infeasible) return result;
  }
  const ViResult faces = result;
  result = solver.by_multipliers();
  if (!result.accepted() && result.status != Status::Infeasible && faces.residual < result.residual) return faces;
  return result;
}

ViResult judge_affine_vi(Projector& projector, In x, const Judgement& of_F, Face face, const Limits& limits) {
  if (of_F.F.size() == x.size() && of_F.F.allFinite())
    return judge_vi(projector, x, of_F.F, unit * of_F.F.norm(), of_F.terms.size, std::move(face), limits);
  ViResult refused;
  refused.x = x;
  refused.message = "F overflows at the point reached";
  return refused;
}

ViResult judge_vi(Projector& projector, In x, In F, double F_error, In terms, Face face, const Limits& limits) {
  ViResult result;
  const Index n = x.size();
  result.x = x;
  result.F = F;
  TwoPartVector t{Vec(x)};
  for (Index i = 0; i < n; ++i) t.add(i, -F[i]);
  const Projection& projection = projector.project(t, std::move(face), 1e-3 * limits.tol, limits);
  result.face = projection.face;
  if (projection.p.size() != n || projection.empty) {
    if (const auto why = limits.reached()) result.status = *why;
    result.message = projection.empty ? "no point of the polyhedron was found, and no proof that it is empty"
                                      : "the projection on the polyhedron was not found";
    return result;
  }
  result.multipliers = projection.multipliers;
  result.reduced = projection.reduced;
  result.projection_error = projection.error + F_error;
  const Vec off = (x - projection.p).cwiseAbs();
  const double largest = n > 0 ? off.maxCoeff(&result.worst) : 0;
  result.residual = largest * (1 + 4 * unit) + result.projection_error;
  if (result.residual <= limits.tol) {
    result.status = Status::Solved;
    result.message = text_of("natural residual ", result.residual);
    return result;
  }
  // The error has no bound that is small enough: p stands for the projection as far as it meets what defines one.
  Vec sizes = terms + x.cwiseAbs();
  sizes += projector.polyhedron().A.cwiseAbs().transpose() * projection.multipliers.cwiseAbs();
  sizes *= 8.0 * static_cast<double>(n + 2) * unit;  // the rounding of F and of the rows
  const bool finite = std::isfinite(off.sum()) && std::isfinite(sizes.sum());
  const bool to_tolerance = finite && largest + projection.misses <= limits.tol;
  const bool to_rounding =
      finite && (off.array() <= sizes.array()).all() && projection.misses <= sizes.lpNorm<Eigen::Infinity>();
  if (to_tolerance || to_rounding) {
    result.status = Status::SolvedToRounding;
    if (!to_tolerance)
      result.message = text_of("natural residual ", result.residual, ", within the rounding of its terms");
    else if (projection.error == infinity && !limits.reached())
      result.message = text_of("natural residual ", largest,
                               " by a projection whose error has no bound: the polyhedron is flat, or nearly; "
                               "equations are written by equal sides");
    else
      result.message = text_of("natural residual ", largest, " by a projection whose error is at most ",
                               result.projection_error, " with that of F");
    return result;
  }
  if (const auto why = limits.reached()) result.status = *why;
  result.message = text_of("natural residual ", result.residual);
  return result;
}

}  // namespace perp::lcp
