// SPDX-License-Identifier: Apache-2.0
#include "ncp/analysis/sensitivity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "lcp/classes/classify.hpp"
#include "lcp/linalg/blocks.hpp"
#include "lcp/solve/enumeration.hpp"
#include "lcp/solve/solve.hpp"
#include "ncp/analysis/structure_report.hpp"
#include "ncp/problem/counted_mcp.hpp"
#include "ncp/problem/words.hpp"

namespace perp::ncp {
namespace {

using Dense = Eigen::MatrixXd;
using Indices = std::vector<Index>;

[[noreturn]] void refuse_point(const Mcp& mcp, const std::string& what) {
  throw std::invalid_argument(mcp.name() + ": sensitivity: " + what);
}

void check_options(const Mcp& mcp, const SensitivityOptions& o) {
  const auto positive = [&](const char* name, double value) {
    if (!(value > 0) || std::isinf(value))
      refuse_point(mcp, std::string(name) + " is " + number(value) + "; it must be positive and finite");
  };
  positive("residual_tol", o.residual_tol);
  positive("degenerate_tol", o.degenerate_tol);
  if (!(o.singular_rcond >= 0 && o.singular_rcond < 1))
    refuse_point(mcp, "singular_rcond is " + number(o.singular_rcond) + "; it must be in [0, 1)");
  if (o.max_degenerate < 0)
    refuse_point(mcp, "max_degenerate is " + std::to_string(o.max_degenerate) + "; it must be at least 0");
}

void check_derivatives(const Mcp& mcp, const ParameterDerivatives& p) {
  const Index n = mcp.size();
  const auto check = [&](const char* name, const SpMat& D) {
    if (D.rows() != n || D.cols() != p.dF.cols())
      refuse_point(mcp, std::string(name) + " is " + std::to_string(D.rows()) + " x " + std::to_string(D.cols()) +
                            ", for " + std::to_string(n) + " variables and " + std::to_string(p.dF.cols()) +
                            " parameters");
    for (Index j = 0; j < D.cols(); ++j)
      for (SpMat::InnerIterator it(D, j); it; ++it)
        if (!std::isfinite(it.value()))
          refuse_point(mcp, std::string(name) + " is " + number(it.value()) + " for variable " +
                                mcp.variable_name(it.row()) + " and parameter " + std::to_string(j + 1));
  };
  const auto check_bounds = [&](const char* name, const SpMat& D, const Vec& bound) {
    if (D.size() == 0) return;
    check(name, D);
    for (Index j = 0; j < D.cols(); ++j)
      for (SpMat::InnerIterator it(D, j); it; ++it)
        if (std::isinf(bound[it.row()]) && it.value() != 0)
          refuse_point(mcp, std::string(name) + " is " + number(it.value()) + " for the infinite bound of variable " +
                                mcp.variable_name(it.row()));
  };
  check("dF", p.dF);
  check_bounds("dl", p.dl, mcp.box().lower);
  check_bounds("du", p.du, mcp.box().upper);
  for (Index i = 0; i < n; ++i)
    if (mcp.box().lower[i] == mcp.box().upper[i] && p.dl.size() + p.du.size() > 0)
      for (Index j = 0; j < p.dF.cols(); ++j)
        if ((p.dl.size() > 0 ? p.dl.coeff(i, j) : 0) != (p.du.size() > 0 ? p.du.coeff(i, j) : 0))
          refuse_point(mcp, "dl and du differ for the fixed variable " + mcp.variable_name(i));
}

Activity activity(const Box& box, Index i, double x, double F, double row_size, double tol) {
  const double l = box.lower[i], u = box.upper[i];
  if (l == u) return Activity::Fixed;
  const double to_lower = std::isfinite(l) ? x - l : infinity;
  const double to_upper = std::isfinite(u) ? u - x : infinity;
  const bool lower = to_lower <= to_upper;
  const double gap = lower ? to_lower : to_upper;
  if (std::isinf(gap)) return Activity::Inside;
  const double bound = lower ? l : u;
  const bool F_vanishes = std::abs(F) <= tol * std::max(1.0, row_size);
  if (gap <= tol * (1 + std::abs(bound)) && F_vanishes)
    return lower ? Activity::DegenerateLower : Activity::DegenerateUpper;
  if (F_vanishes || gap > std::abs(F)) return Activity::Inside;
  return lower ? Activity::AtLower : Activity::AtUpper;
}

/// J_AA with its rows and columns divided by their largest entries, factored.
class ActiveSystem {
 public:
  ActiveSystem(const SpMat& J, const Indices& A, lcp::LuBackend backend) : A_(A), lu_(backend) {
    const auto size = static_cast<Index>(A.size());
    rows_ = Vec::Zero(size);
    columns_ = Vec::Ones(size);
    SpMat block = lcp::principal_block(J, A);
    for (Index j = 0; j < size; ++j)
      for (SpMat::InnerIterator it(block, j); it; ++it)
        rows_[it.row()] = std::max(rows_[it.row()], std::abs(it.value()));
    rows_ = (rows_.array() > 0).select(rows_.cwiseInverse(), 1.0);
    block = rows_.asDiagonal() * block;
    for (Index j = 0; j < size; ++j) {
      double largest = 0;
      for (SpMat::InnerIterator it(block, j); it; ++it) largest = std::max(largest, std::abs(it.value()));
      if (largest > 0) columns_[j] = 1 / largest;
    }
    block = block * columns_.asDiagonal();
    if (size > 0) status_ = lu_.factor(block);
    if (size > 0 && status_ == lcp::LuStatus::Ok) rcond_ = lu_.rcond();
    if (status_ != lcp::LuStatus::Ok) rcond_ = 0;
  }

  lcp::LuStatus status() const { return status_; }
  double rcond() const { return rcond_; }
  /// d with J_AA d_A = -r_A and d = 0 elsewhere.
  Vec solve(const Vec& r) const {
    Vec d = Vec::Zero(r.size());
    if (A_.empty()) return d;
    const Vec rhs = -rows_.cwiseProduct(r(A_));
    Vec y(rhs.size());
    lu_.solve_refined(rhs, y);
    d(A_) = columns_.cwiseProduct(y);
    return d;
  }

 private:
  const Indices& A_;
  Vec rows_, columns_;
  lcp::SparseLu lu_;
  lcp::LuStatus status_ = lcp::LuStatus::Ok;
  double rcond_ = 1;
};

/// d and F'(d) = J d + dF of one direction.
struct Motion {
  Vec dx, dF;
};

class Analysis {
 public:
  Analysis(const Mcp& mcp, In x, const ParameterDerivatives& parameters, const SensitivityOptions& options)
      : mcp_(mcp), parameters_(parameters), options_(options), x_(x) {
    check_options(mcp, options);
    check_derivatives(mcp, parameters);
    if (x.size() != mcp.size())
      refuse_point(mcp,
                   "x has " + std::to_string(x.size()) + " entries for " + std::to_string(mcp.size()) + " variables");
  }

  /// States, J_AA and its factors. False: refused.
  bool prepare() {
    CountedMcp guarded(mcp_);
    if (!x_.allFinite() || !guarded.eval(x_, F_)) return refuse(SensitivityStatus::NotDefined, "F is not defined at x");
    out_.residual = residual(mcp_.box(), x_, F_);
    if (!(out_.residual.natural <= options_.residual_tol))
      return refuse(SensitivityStatus::NotASolution, "x is no solution: its natural residual is " +
                                                         number(out_.residual.natural) + ", worst in equation " +
                                                         mcp_.equation_name(out_.residual.worst) + " of variable " +
                                                         mcp_.variable_name(out_.residual.worst) +
                                                         "; the tolerance is " + number(options_.residual_tol));
    J_ = mcp_.jacobian_pattern();
    if (!guarded.jacobian(x_, J_)) return refuse(SensitivityStatus::NotDefined, "the Jacobian is not defined at x");
    sort_indices();
    system_.emplace(J_, inside_, options_.lu);
    out_.rcond = system_->rcond();
    if (!(out_.rcond > options_.singular_rcond)) return refuse(SensitivityStatus::Singular, singular());
    return true;
  }

  Index degenerate() const { return static_cast<Index>(out_.degenerate.size()); }
  bool refuse(SensitivityStatus status, std::string message) {
    out_.status = status;
    out_.message = std::move(message);
    return false;
  }
  std::string at_bounds() const {
    return std::to_string(out_.degenerate.size()) + (out_.degenerate.size() == 1 ? " variable is" : " variables are") +
           " degenerate (at a bound with F = 0, within " + number(options_.degenerate_tol) +
           "): " + listed_variables(mcp_, out_.degenerate);
  }

  /// With the degenerate variables kept on their (moving) bounds.
  Motion on_bounds(const Vec& dp) const {
    Vec d = bound_motion(dp);
    const Vec force = parameters_.dF * dp;
    d += system_->solve(force + J_ * d);
    Vec dF = force + J_ * d;
    dF(inside_).setZero();
    return {std::move(d), std::move(dF)};
  }

  void differentiate();
  void differentiate(const Vec& dp);
  Sensitivity take() { return std::move(out_); }

 private:
  void sort_indices();
  std::string singular() const;
  Vec bound_motion(const Vec& dp) const;
  bool critical_cone(Motion& motion);
  /// `move` of degenerate variables, and of those inside so that F_A stays.
  Vec response(const Vec& move) const { return move + system_->solve(J_ * move); }
  double sign(Index i) const { return out_.states[at(i)] == Activity::DegenerateUpper ? -1 : 1; }

  const Mcp& mcp_;
  const ParameterDerivatives& parameters_;
  const SensitivityOptions& options_;
  Vec x_, F_;
  SpMat J_;
  Indices inside_;
  std::optional<ActiveSystem> system_;
  Sensitivity out_;
};

void Analysis::sort_indices() {
  Vec row_size = Vec::Zero(J_.rows());
  for (Index j = 0; j < J_.cols(); ++j)
    for (SpMat::InnerIterator it(J_, j); it; ++it)
      row_size[it.row()] = std::max(row_size[it.row()], std::abs(it.value()));
  for (Index i = 0; i < x_.size(); ++i) {
    const Activity state = activity(mcp_.box(), i, x_[i], F_[i], row_size[i], options_.degenerate_tol);
    out_.states.push_back(state);
    if (state == Activity::Inside) inside_.push_back(i);
    if (state == Activity::DegenerateLower || state == Activity::DegenerateUpper) out_.degenerate.push_back(i);
  }
}

/// Why, at the point with the active bounds exact, so that the block explained is J_AA.
std::string Analysis::singular() const {
  Vec x = x_, F = F_;
  for (Index i = 0; i < x.size(); ++i) switch (out_.states[at(i)]) {
      case Activity::Inside:
        F[i] = 0;
        break;
      case Activity::DegenerateLower:
        F[i] = 0;
        [[fallthrough]];
      case Activity::AtLower:
        x[i] = mcp_.box().lower[i];
        break;
      case Activity::DegenerateUpper:
        F[i] = 0;
        [[fallthrough]];
      case Activity::AtUpper:
        x[i] = mcp_.box().upper[i];
        break;
      case Activity::Fixed:
        break;
    }
  std::string why = explain_singularity(mcp_, J_, x, F);
  if (why.empty())
    why = "the Jacobian of the " + std::to_string(inside_.size()) + " variables off their bounds is singular (" +
          listed_variables(mcp_, inside_) + ")";
  why += ": reciprocal condition " + number(out_.rcond);
  return degenerate() > 0 ? why + "; " + at_bounds() : why;
}

Vec Analysis::bound_motion(const Vec& dp) const {
  const auto motion = [&](const SpMat& D) { return D.size() > 0 ? Vec(D * dp) : Vec(Vec::Zero(x_.size())); };
  const Vec dl = motion(parameters_.dl), du = motion(parameters_.du);
  Vec d = Vec::Zero(x_.size());
  for (Index i = 0; i < d.size(); ++i) switch (out_.states[at(i)]) {
      case Activity::Inside:
        break;
      case Activity::AtUpper:
      case Activity::DegenerateUpper:
        d[i] = du[i];
        break;
      case Activity::Fixed:
      case Activity::AtLower:
      case Activity::DegenerateLower:
        d[i] = dl[i];
        break;
    }
  return d;
}

/// Moves `motion`, which keeps the degenerate variables on their bounds, by the solution y of the LCP(q, S), q =
/// (reflected) dF_B of `motion`. False: refused.
bool Analysis::critical_cone(Motion& motion) {
  const Indices& B = out_.degenerate;
  const auto size = static_cast<Index>(B.size());
  Dense S(size, size);
  for (Index k = 0; k < size; ++k) {
    const Vec column = J_ * response(Vec::Unit(x_.size(), B[at(k)]));
    for (Index r = 0; r < size; ++r) S(r, k) = sign(B[at(r)]) * sign(B[at(k)]) * column[B[at(r)]];
  }
  Vec q(size);
  for (Index r = 0; r < size; ++r) q[r] = sign(B[at(r)]) * motion.dF[B[at(r)]];
  // The cone's problem is positively homogeneous in q: in units of it the tolerances mean something.
  const double units = size > 0 ? q.lpNorm<Eigen::Infinity>() : 0;
  const lcp::AffineMcp cone = lcp::standard_lcp(S.sparseView(), units > 0 ? Vec(q / units) : q);
  out_.strongly_regular = lcp::classify(cone.M).p.yes();
  Vec y = Vec::Zero(size);
  if (out_.strongly_regular) {
    if (units > 0) {
      const lcp::Result solution = lcp::solve(cone, y);
      if (!solution.solved())
        return refuse(SensitivityStatus::Degenerate, at_bounds() +
                                                         "; the problem of their directions has one solution, "
                                                         "but none was found: " +
                                                         solution.message);
      y = solution.z;
    }
  } else {
    const lcp::Solutions all = lcp::enumerate(cone);
    if (!all.complete || all.found.size() != 1 || all.found.front().dimension > 0) {
      std::string why = "whether their directions are the only ones could not be decided: " + all.message;
      if (all.complete)
        why = all.found.empty() ? "no direction of the solution satisfies the conditions on the critical cone: in this "
                                  "direction of p the solution may vanish or jump"
                                : "the conditions on the critical cone have " +
                                      (all.found.size() == 1 ? "a continuum of" : std::to_string(all.found.size())) +
                                      " solutions: several paths of solutions may leave x in this direction of p";
      return refuse(SensitivityStatus::Degenerate, at_bounds() + "; " + why);
    }
    y = all.found.front().z;
  }
  Vec move = Vec::Zero(x_.size());
  for (Index k = 0; k < size; ++k) move[B[at(k)]] = units * y[k] * sign(B[at(k)]);
  move = response(move);
  motion.dx += move;
  motion.dF += J_ * move;
  motion.dF(inside_).setZero();
  for (Index k = 0; k < size; ++k)
    if (y[k] > 0) motion.dF[B[at(k)]] = 0;
  return true;
}

void Analysis::differentiate() {
  const Index m = parameters_.dF.cols();
  out_.dx.resize(x_.size(), m);
  out_.dF.resize(x_.size(), m);
  for (Index j = 0; j < m; ++j) {
    const Motion motion = on_bounds(Vec::Unit(m, j));
    out_.dx.col(j) = motion.dx;
    out_.dF.col(j) = motion.dF;
  }
  out_.status = SensitivityStatus::Differentiable;
  out_.strongly_regular = true;
  out_.message = "strictly complementary and regular: " + std::to_string(inside_.size()) + " of " +
                 std::to_string(x_.size()) + " variables off their bounds, reciprocal condition " + number(out_.rcond);
}

void Analysis::differentiate(const Vec& dp) {
  Motion motion = on_bounds(dp);
  if (degenerate() > 0 && !critical_cone(motion)) return;
  out_.dx = motion.dx;
  out_.dF = motion.dF;
  if (degenerate() == 0) {
    out_.status = SensitivityStatus::Differentiable;
    out_.strongly_regular = true;
    out_.message = "strictly complementary and regular";
    return;
  }
  out_.status = SensitivityStatus::Directional;
  out_.message = at_bounds() + (out_.strongly_regular ? "; strongly regular: the one-sided derivative exists"
                                                      : "; the conditions on the critical cone have one solution");
}

}  // namespace

std::string_view to_string(SensitivityStatus status) {
  constexpr std::array<std::string_view, 7> names{"Differentiable", "Directional", "Degenerate", "Singular",
                                                  "NotASolution",   "NotDefined",  "TooLarge"};
  return names[static_cast<std::size_t>(status)];
}

std::string_view to_string(Activity activity) {
  constexpr std::array<std::string_view, 6> names{"inside", "at lower",           "at upper",
                                                  "fixed",  "degenerate (lower)", "degenerate (upper)"};
  return names[static_cast<std::size_t>(activity)];
}

Sensitivity sensitivity(const Mcp& mcp, In x, const ParameterDerivatives& parameters,
                        const SensitivityOptions& options) {
  Analysis analysis(mcp, x, parameters, options);
  if (analysis.prepare()) {
    if (analysis.degenerate() > 0)
      analysis.refuse(SensitivityStatus::Degenerate,
                      analysis.at_bounds() + "; x has at most one-sided derivatives: ask for a direction of p");
    else
      analysis.differentiate();
  }
  return analysis.take();
}

Sensitivity sensitivity(const Mcp& mcp, In x, const ParameterDerivatives& parameters, In dp,
                        const SensitivityOptions& options) {
  Analysis analysis(mcp, x, parameters, options);
  if (dp.size() != parameters.dF.cols() || !dp.allFinite())
    refuse_point(mcp, "the direction has " + std::to_string(dp.size()) + " entries, all of which must be finite, for " +
                          std::to_string(parameters.dF.cols()) + " parameters");
  if (analysis.prepare()) {
    if (analysis.degenerate() > options.max_degenerate)
      analysis.refuse(SensitivityStatus::TooLarge, analysis.at_bounds() + "; at most " +
                                                       std::to_string(options.max_degenerate) +
                                                       " are treated (max_degenerate)");
    else
      analysis.differentiate(dp);
  }
  return analysis.take();
}

}  // namespace perp::ncp
