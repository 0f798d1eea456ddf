// SPDX-License-Identifier: Apache-2.0
#include "contact/solvers/sensitivity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "contact/model/checks.hpp"
#include "contact/solvers/kinks.hpp"
#include "contact/solvers/places.hpp"
#include "lcp/solve/refined_lu.hpp"
#include "lcp/words.hpp"
#include "ncp/problem/words.hpp"

namespace perp::contact {
namespace {

using Dense = Eigen::MatrixXd;
using Triplets = std::vector<Eigen::Triplet<double>>;

void check_options(const SensitivityOptions& o) {
  const auto positive = [](const char* name, double value) {
    if (!(value > 0) || std::isinf(value)) refuse_input(name, " is ", value, "; it must be positive and finite");
  };
  positive("residual_tol", o.residual_tol);
  positive("degenerate_tol", o.degenerate_tol);
  if (!(o.singular_rcond >= 0 && o.singular_rcond < 1))
    refuse_input("singular_rcond is ", o.singular_rcond, "; it must be in [0, 1)");
  if (o.max_degenerate < 0) refuse_input("max_degenerate is ", o.max_degenerate, "; it must be at least 0");
}

/// Returns m, which all parts must have.
Index check_parameters(const Problem& problem, const ParameterDerivatives& p) {
  std::optional<Index> m;
  const auto count = [&m](const char* name, Index parameters) {
    if (m && *m != parameters) refuse_input(name, " is of ", parameters, " parameters, and what comes before of ", *m);
    m = parameters;
  };
  const auto finite = [](const char* name, const SpMat& D) {
    for (Index j = 0; j < D.cols(); ++j)
      for (SpMat::InnerIterator it(D, j); it; ++it)
        if (!std::isfinite(it.value())) refuse_input(name, "(", it.row(), ", ", j, ") is ", it.value());
  };
  const auto take = [&](const char* name, const SpMat& D, Index rows) {
    if (D.rows() == 0 && D.cols() == 0) return;
    if (D.rows() != rows) refuse_input(name, " has ", D.rows(), " rows, not ", rows);
    count(name, D.cols());
    finite(name, D);
  };
  take("dq", p.dq, problem.q.size());
  take("dmu", p.dmu, problem.contacts());
  take("dmu_r", p.dmu_r, problem.mu_r.size());
  if (!p.dW.empty()) count("dW", static_cast<Index>(p.dW.size()));
  for (const SpMat& D : p.dW) {
    if (D.rows() != problem.q.size() || D.cols() != problem.q.size())
      refuse_input("dW is ", D.rows(), " x ", D.cols(), ", not ", problem.q.size(), " x ", problem.q.size());
    finite("dW", D);
  }
  if (!m) refuse_input("there are no parameters: dq, dmu and dW are empty");
  return *m;
}

/// r, u and what moves them: dr and du of one direction.
struct Motion {
  Vec dr, du;
};

class Analysis {
 public:
  Analysis(const Problem& problem, In r, const ParameterDerivatives& parameters, const SensitivityOptions& options)
      : problem_(problem), parameters_(parameters), options_(options), r_(r) {
    check(problem);
    check_options(options);
    m_ = check_parameters(problem, parameters);
  }

  Index parameters() const { return m_; }
  /// Places, the system and its factors; dmu of what is asked, one column a direction. False: refused.
  bool prepare(const Dense& directions);
  bool refuse(SensitivityStatus status, std::string message) {
    out_.status = status;
    out_.message = std::move(message);
    return false;
  }
  bool kinked() const { return !out_.degenerate.empty(); }
  std::string at_kinks() const {
    return contacts_text(out_.degenerate, 0) + (out_.degenerate.size() == 1 ? " is" : " are") +
           " at a kink (r_N = u_N = 0, or at the edge of the cone with "
           "u_T = 0, within " +
           ncp::number(options_.degenerate_tol) + ")";
  }
  void differentiate();
  void differentiate(const Vec& dp);
  Sensitivity take() { return std::move(out_); }

 private:
  void find_kinks(const Dense& directions);
  bool factor();
  SpMat closed(double on_diagonal) const;
  std::string singular() const;
  Vec velocities_of(const Vec& dp) const;
  /// Returns zeros for what is 0 x 0.
  Vec friction(int disk, const Vec& dp) const;
  Motion respond(const Vec& g, Vec right, const Vec& moved) const;
  Motion with_kinks_held(const Vec& dp) const;
  bool solve_kinks(const Vec& dp, Motion& motion);
  template <class Visit>
  void for_each_disk(const Visit& visit) const;

  const Problem& problem_;
  const ParameterDerivatives& parameters_;
  const SensitivityOptions& options_;
  Index m_ = 0;
  Vec r_, u_;
  std::vector<Place> places_;
  std::vector<Index> rows_;    // of closed contacts, one a row of the system
  std::vector<Index> row_of_;  // the opposite; -1
  SpMat K_;                    // of all columns
  SpMat B_;                    // K = A + B W
  Vec row_scale_;
  std::optional<lcp::RefinedLu> lu_;
  Kinks kinks_;
  std::vector<std::pair<Index, int>> kink_of_;  // contact and disk of each of the list
  Sensitivity out_;
};

/// visit(contact, number of the disk, disk).
template <class Visit>
void Analysis::for_each_disk(const Visit& visit) const {
  for (Index a = 0; a < problem_.contacts(); ++a)
    for (int j = 0; const Disk& disk : places_[lcp::at(a)].disks) visit(a, j++, disk);
}

Vec Analysis::velocities_of(const Vec& dp) const {
  Vec g = parameters_.dq.size() > 0 ? Vec(parameters_.dq * dp) : Vec(Vec::Zero(r_.size()));
  for (std::size_t j = 0; j < parameters_.dW.size(); ++j)
    if (dp[static_cast<Index>(j)] != 0) g += dp[static_cast<Index>(j)] * (parameters_.dW[j] * r_);
  return g;
}

Vec Analysis::friction(int disk, const Vec& dp) const {
  const SpMat& D = disk == 0 ? parameters_.dmu : parameters_.dmu_r;
  return D.size() > 0 ? Vec(D * dp) : Vec(Vec::Zero(problem_.contacts()));
}

bool Analysis::prepare(const Dense& directions) {
  out_.residual = residual(problem_, r_);
  if (!(out_.residual.largest() <= options_.residual_tol))
    return refuse(SensitivityStatus::NotASolution,
                  "r is no solution: its residual is " + ncp::number(out_.residual.largest()) + ", worst at contact " +
                      std::to_string(out_.residual.worst) + "; the tolerance is " + ncp::number(options_.residual_tol));
  u_ = velocities(problem_, r_);
  const Vec diagonal = problem_.W.diagonal();
  for (Index a = 0; a < problem_.contacts(); ++a)
    places_.push_back(place(problem_, r_, u_, a, diagonal, options_.degenerate_tol));
  find_kinks(directions);
  return factor();
}

/// The kinks, the contacts that have them, and the regions of all.
void Analysis::find_kinks(const Dense& directions) {
  kinks_ = {.dimension = problem_.dimension, .rolls = problem_.rolls()};
  std::array<Dense, 2> dmu;
  for (int j = 0; j < (problem_.rolls() ? 2 : 1); ++j) {
    const SpMat& D = j == 0 ? parameters_.dmu : parameters_.dmu_r;
    dmu[lcp::at(j)] = D.size() > 0 ? Dense(D * directions) : Dense::Zero(problem_.contacts(), directions.cols());
  }
  Index size = 0;
  const auto add = [&](Index a, int disk, Kink kink, Index entries) {
    kink.first = size;
    size += entries;
    kinks_.list.push_back(kink);
    kink_of_.emplace_back(a, disk);
  };
  for (Index a = 0; a < problem_.contacts(); ++a) {
    const Place& at = places_[lcp::at(a)];
    const std::size_t before = kinks_.list.size();
    Region region = at.normal == Place::Normal::Open ? Region::Open : Region::Stick;
    if (at.normal == Place::Normal::Touching) {
      region = Region::Touching;
      Kink kink;
      Index entries = 1;
      for (std::size_t j = 0; j < at.disks.size(); ++j)
        if (at.disks[j].rests && at.disks[j].mu > 0) {
          kink.law = Kink::Law::Cone;
          kink.mu[j] = at.disks[j].mu;
          entries += kinks_.width();
        }
      add(a, -1, kink, entries);
    } else if (at.normal == Place::Normal::Closed) {
      for (int j = 0; const Disk& disk : at.disks) {
        if (disk.move == Move::Edge)
          add(a, j, {.law = Kink::Law::Pair}, 1);
        else if (disk.mu == 0 && disk.rests && (dmu[lcp::at(j)].row(a).array() != 0).any())
          add(a, j, {.law = Kink::Law::Disk}, kinks_.width());
        if (disk.move == Move::Slip && region == Region::Stick) region = j == 0 ? Region::Slip : Region::Roll;
        ++j;
      }
      if (kinks_.list.size() > before) region = Region::Edge;
    }
    if (kinks_.list.size() > before) out_.degenerate.push_back(a);
    out_.regions.push_back(region);
  }
}

/// K = A + B W in the rows of closed contacts, with its columns there factored: A dr + B du = right.
bool Analysis::factor() {
  const Index all = r_.size();
  const int d = problem_.dimension;
  const int width = kinks_.width();
  row_of_.assign(lcp::at(all), -1);
  for (Index a = 0; a < problem_.contacts(); ++a)
    if (places_[lcp::at(a)].normal == Place::Normal::Closed)
      for (int k = 0; k < d; ++k) {
        row_of_[lcp::at(d * a + k)] = static_cast<Index>(rows_.size());
        rows_.push_back(d * a + k);
      }
  const auto size = static_cast<Index>(rows_.size());
  if (size == 0) return true;
  Triplets A;
  Triplets B;
  const auto add = [this](Triplets& to, Index i, Index j, double value) {
    to.emplace_back(static_cast<int>(row_of_[lcp::at(i)]), static_cast<int>(j), value);
  };
  for_each_disk([&](Index a, int number, const Disk& disk) {
    if (places_[lcp::at(a)].normal != Place::Normal::Closed) return;
    if (number == 0) add(B, d * a, d * a, 1);
    const double per_speed = disk.move == Move::Slip ? disk.mu * disk.r_N / disk.speed : 0;
    for (int k = 0; k < width; ++k) {
      const Index i = disk.first + k;
      const bool free_of_friction = disk.mu == 0;
      if (disk.move != Move::Slip && !free_of_friction) {
        add(B, i, i, 1);
        continue;
      }
      add(A, i, i, 1);
      if (free_of_friction) continue;
      add(A, i, d * a, disk.mu * disk.along[k]);
      for (int l = 0; width > 1 && l < width; ++l)
        add(B, i, disk.first + l, per_speed * ((k == l ? 1 : 0) - disk.along[k] * disk.along[l]));
    }
  });
  SpMat A_(size, all);
  A_.setFromTriplets(A.begin(), A.end());
  B_.resize(size, all);
  B_.setFromTriplets(B.begin(), B.end());
  K_ = A_ + SpMat(B_ * problem_.W.matrix());
  // Rows are of impulses and of velocities; their largest entries are made 1.
  row_scale_ = Vec::Zero(size);
  for (Index j = 0; j < all; ++j)
    for (SpMat::InnerIterator it(K_, j); it; ++it)
      row_scale_[it.row()] = std::max(row_scale_[it.row()], std::abs(it.value()));
  row_scale_ = (row_scale_.array() > 0).select(row_scale_.cwiseInverse(), 1.0);
  lu_.emplace(closed(0));
  out_.rcond = lu_->status() == lcp::LuStatus::Ok ? lu_->rcond() : 0;
  if (out_.rcond > options_.singular_rcond) return true;
  return refuse(SensitivityStatus::Singular, singular());
}

/// K's columns of closed contacts, equilibrated, plus this on the diagonal.
SpMat Analysis::closed(double on_diagonal) const {
  const auto size = static_cast<int>(rows_.size());
  Triplets entries;
  for (const Index j : rows_)
    for (SpMat::InnerIterator it(K_, j); it; ++it)
      entries.emplace_back(static_cast<int>(it.row()), static_cast<int>(row_of_[lcp::at(j)]),
                           row_scale_[it.row()] * it.value());
  for (int i = 0; on_diagonal != 0 && i < size; ++i) entries.emplace_back(i, i, on_diagonal);
  SpMat block(size, size);
  block.setFromTriplets(entries.begin(), entries.end());
  return block;
}

/// Why: with the vector z that K nearly maps to zero, by inverse iteration with K moved by 1e-9 of its largest entries.
std::string Analysis::singular() const {
  const auto size = static_cast<Index>(rows_.size());
  const std::string rcond = "reciprocal condition " + ncp::number(out_.rcond);
  const lcp::RefinedLu lu(closed(1e-9));
  Vec z = Vec::Ones(size);
  for (Index i = 1; i < size; i += 2) z[i] = 0.5;
  for (int k = 0; k < 3 && lu.status() == lcp::LuStatus::Ok; ++k) z = lu.solve(z).normalized();
  if (lu.status() != lcp::LuStatus::Ok || !z.allFinite())
    return "the equations of the contacts that are not open are singular: " + rcond;
  Vec whole = Vec::Zero(r_.size());
  whole(rows_) = z;
  std::vector<Index> who;
  const int d = problem_.dimension;
  for (Index a = 0; a < problem_.contacts(); ++a)
    if (whole.segment(d * a, d).lpNorm<Eigen::Infinity>() > 1e-3 * z.lpNorm<Eigen::Infinity>()) who.push_back(a);
  const double velocity = (problem_.W * whole).lpNorm<Eigen::Infinity>();
  const double largest = problem_.W.diagonal().lpNorm<Eigen::Infinity>();
  if (velocity <= 1e-7 * largest)
    return "the impulses are not unique: those of " + contacts_text(who, 0) +
           " can change together without a change of any velocity, because W is singular there (redundant contacts); " +
           rcond;
  return "the equations of the contacts that are not open are singular at " + contacts_text(who, 0) +
         ", where W is not: friction couples their impulses and slip so that no change, or many, would follow; " +
         rcond;
}

/// dr = moved on contacts that are not closed, the solution elsewhere; du = W dr + g.
Motion Analysis::respond(const Vec& g, Vec right, const Vec& moved) const {
  Motion out{.dr = moved, .du = {}};
  if (!rows_.empty()) {
    right -= B_ * g + K_ * moved;
    out.dr(rows_) = lu_->solve(row_scale_.cwiseProduct(right));
  }
  out.du = problem_.W * out.dr + g;
  return out;
}

/// With y = 0.
Motion Analysis::with_kinks_held(const Vec& dp) const {
  Vec right = Vec::Zero(static_cast<Index>(rows_.size()));
  const std::array<Vec, 2> dmu{friction(0, dp), friction(1, dp)};
  const int width = kinks_.width();
  for_each_disk([&](Index a, int j, const Disk& disk) {
    if (places_[lcp::at(a)].normal != Place::Normal::Closed || disk.move != Move::Slip) return;
    for (int k = 0; k < width; ++k)
      right[row_of_[lcp::at(disk.first + k)]] = -dmu[lcp::at(j)][a] * disk.r_N * disk.along[k];
  });
  return respond(velocities_of(dp), std::move(right), Vec::Zero(r_.size()));
}

/// Adds the solution of the conditions at the kinks. False: refused.
bool Analysis::solve_kinks(const Vec& dp, Motion& motion) {
  const int d = problem_.dimension;
  const int width = kinks_.width();
  const std::array<Vec, 2> dmu{friction(0, dp), friction(1, dp)};
  struct Entry {
    Vec right;  ///< of the system, for y_i = 1
    Vec moved;
    Index contact = 0;
    const Disk* edge = nullptr;  ///< w = dmu r_N + mu dr_N - n'dr_T; else w is an entry of du:
    Index velocity = 0;
    double slack = 0;  ///< dmu r_N
  };
  std::vector<Entry> list;
  for (std::size_t k = 0; k < kinks_.list.size(); ++k) {
    const auto [a, j] = kink_of_[k];
    const Place& at = places_[lcp::at(a)];
    Kink& kink = kinks_.list[k];
    const auto add = [&, contact = a](Index velocity) -> Entry& {
      list.push_back({.right = Vec::Zero(static_cast<Index>(rows_.size())), .moved = Vec::Zero(r_.size())});
      list.back().contact = contact;
      list.back().velocity = velocity;
      return list.back();
    };
    if (j < 0) {
      Entry& normal = add(d * a);
      normal.moved[d * a] = 1;
      for (const Disk& disk : at.disks)
        if (!disk.rests)
          for (int i = 0; i < width; ++i) normal.moved[disk.first + i] = -disk.mu * disk.along[i];
      for (const Disk& disk : at.disks)
        for (int i = 0; disk.rests && disk.mu > 0 && i < width; ++i) add(disk.first + i).moved[disk.first + i] = 1;
      continue;
    }
    const Disk& disk = at.disks[lcp::at(j)];
    if (kink.law == Kink::Law::Pair) {
      Entry& edge = add(-1);
      edge.edge = &disk;
      edge.slack = dmu[lcp::at(j)][a] * disk.r_N;
      for (int i = 0; i < width; ++i) edge.right[row_of_[lcp::at(disk.first + i)]] = -disk.along[i];
    } else {
      kink.radius = dmu[lcp::at(j)][a] * disk.r_N;
      for (int i = 0; i < width; ++i) add(disk.first + i).right[row_of_[lcp::at(disk.first + i)]] = 1;
    }
  }
  const auto w_of = [&](const Entry& entry, const Motion& of) {
    if (entry.edge == nullptr) return of.du[entry.velocity];
    double w = entry.edge->mu * of.dr[d * entry.contact];
    for (int i = 0; i < width; ++i) w -= entry.edge->along[i] * of.dr[entry.edge->first + i];
    return w;
  };
  const auto size = static_cast<Index>(list.size());
  if (size > options_.max_degenerate)
    return refuse(SensitivityStatus::TooLarge, at_kinks() + "; of their " + std::to_string(size) + " entries at most " +
                                                   std::to_string(options_.max_degenerate) +
                                                   " are treated (max_degenerate)");
  const Vec none = Vec::Zero(r_.size());
  std::vector<Motion> responses;
  Dense S(size, size);
  Vec h(size);
  for (Index j = 0; j < size; ++j) {
    responses.push_back(respond(none, list[lcp::at(j)].right, list[lcp::at(j)].moved));
    for (Index i = 0; i < size; ++i) S(i, j) = w_of(list[lcp::at(i)], responses.back());
    h[j] = w_of(list[lcp::at(j)], motion) + list[lcp::at(j)].slack;
  }
  const KinksSolution found = solve(kinks_, S, h);
  out_.strongly_regular = found.always;
  if (found.y.size() == 0) return refuse(SensitivityStatus::Degenerate, at_kinks() + "; " + found.why);
  for (Index j = 0; j < size; ++j) {
    motion.dr += found.y[j] * responses[lcp::at(j)].dr;
    motion.du += found.y[j] * responses[lcp::at(j)].du;
  }
  return true;
}

void Analysis::differentiate() {
  out_.dr.resize(r_.size(), m_);
  out_.du.resize(r_.size(), m_);
  for (Index j = 0; j < m_; ++j) {
    const Motion motion = with_kinks_held(Vec::Unit(m_, j));
    out_.dr.col(j) = motion.dr;
    out_.du.col(j) = motion.du;
  }
  out_.status = SensitivityStatus::Differentiable;
  out_.strongly_regular = true;
  out_.message = "no contact is at a kink: reciprocal condition " + ncp::number(out_.rcond);
}

void Analysis::differentiate(const Vec& dp) {
  for (int j = 0; j < (problem_.rolls() ? 2 : 1); ++j) {
    const Vec dmu = friction(j, dp);
    const Vec& mu = j == 0 ? problem_.mu : problem_.mu_r;
    for (Index a = 0; a < dmu.size(); ++a)
      if (mu[a] == 0 && dmu[a] < 0)
        refuse_input(j == 0 ? "dmu" : "dmu_r", " is ", dmu[a], " in this direction at contact ", a,
                     ", where the coefficient is 0");
  }
  Motion motion = with_kinks_held(dp);
  if (kinked() && !solve_kinks(dp, motion)) return;
  out_.dr = motion.dr;
  out_.du = motion.du;
  if (kinked()) {
    out_.status = SensitivityStatus::Directional;
    out_.message = at_kinks() + (out_.strongly_regular ? "; strongly regular: the one-sided derivative exists"
                                                       : "; the conditions there have one solution");
    return;
  }
  out_.status = SensitivityStatus::Differentiable;
  out_.strongly_regular = true;
  out_.message = "no contact is at a kink";
}

}  // namespace

std::string_view to_string(Region region) {
  constexpr std::array<std::string_view, 6> names{"open", "stick", "slip", "roll", "touching", "edge"};
  return names[static_cast<std::size_t>(region)];
}

ParameterDerivatives by_q_and_mu(const Problem& problem) {
  const Index all = problem.q.size();
  const Index n = problem.contacts();
  ParameterDerivatives out{.dq = SpMat(all, all + n), .dmu = SpMat(n, all + n)};
  for (Index i = 0; i < all; ++i) out.dq.insert(i, i) = 1;
  for (Index a = 0; a < n; ++a) out.dmu.insert(a, all + a) = 1;
  out.dq.makeCompressed();
  out.dmu.makeCompressed();
  return out;
}

Sensitivity sensitivity(const Problem& problem, In r, const ParameterDerivatives& parameters,
                        const SensitivityOptions& options) {
  Analysis analysis(problem, r, parameters, options);
  const Index m = analysis.parameters();
  if (!analysis.prepare(Dense::Identity(m, m))) return analysis.take();
  if (analysis.kinked())
    analysis.refuse(SensitivityStatus::Degenerate,
                    analysis.at_kinks() + "; r has at most one-sided derivatives: ask for a direction of p");
  else
    analysis.differentiate();
  return analysis.take();
}

Sensitivity sensitivity(const Problem& problem, In r, const ParameterDerivatives& parameters, In dp,
                        const SensitivityOptions& options) {
  Analysis analysis(problem, r, parameters, options);
  if (dp.size() != analysis.parameters() || !dp.allFinite())
    refuse_input("the direction has ", dp.size(), " entries, all of which must be finite, for ", analysis.parameters(),
                 " parameters");
  if (analysis.prepare(dp)) analysis.differentiate(dp);
  return analysis.take();
}

}  // namespace perp::contact
