// SPDX-License-Identifier: Apache-2.0
#include "contact/existence/existence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <utility>
#include <vector>

#include "contact/existence/expansion.hpp"
#include "contact/model/checks.hpp"
#include "contact/model/contact_system.hpp"
#include "contact/model/residual.hpp"
#include "contact/model/scaling.hpp"
#include "lcp/cholesky/cholesky.hpp"
#include "lcp/cholesky/symmetric.hpp"
#include "lcp/deadline.hpp"
#include "lcp/words.hpp"

namespace perp::contact {
namespace {

using Clock = std::chrono::steady_clock;

/// ADMM: its penalty in scaled units, iterations a margin, and how often the velocities are looked at.
constexpr double penalty = 0.3;
constexpr int iterations = 5000;
constexpr int look = 10;
constexpr std::array margins{1.0, 0.1, 0.01, 0.001};
/// Of the regularised equation W r' = ... that is tried before.
constexpr std::array regularizations{1e-8, 1e-4, 1e-2};

/// D^-1/2 W D^-1/2 + (shift / 2) I, D the diagonal of W, without the rows that are zero; nothing if a diagonal entry
/// forbids semidefiniteness.
std::optional<SpMat> unit_diagonal(const SpMat& W, double shift) {
  std::vector<int> place(at(W.rows()), -1);
  Vec root = Vec::Zero(W.rows());
  int size = 0;
  for (Index i = 0; i < W.rows(); ++i) {
    const double value = W.coeff(i, i);
    if (value < 0) return std::nullopt;
    root[i] = std::sqrt(value);
    if (value > 0) place[at(i)] = size++;
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (Index j = 0; j < W.outerSize(); ++j)
    for (SpMat::InnerIterator it(W, j); it; ++it) {
      if (it.value() == 0) continue;
      const int row = place[at(it.row())];
      const int column = place[at(j)];
      if (row < 0 || column < 0) return std::nullopt;
      entries.emplace_back(row, column, row == column ? 1 + shift / 2 : it.value() / root[it.row()] / root[it.col()]);
    }
  SpMat S(size, size);
  S.setFromTriplets(entries.begin(), entries.end());
  return S;
}

/// `shift` of existence.hpp, if W is symmetric and semidefinite up to it.
std::optional<double> semidefinite_up_to(const SpMat& W) {
  if (!lcp::symmetric(W, 0)) return std::nullopt;
  const auto m = static_cast<double>(W.rows());
  const double shift = 4 * (m + 8) * eps * m;
  const std::optional<SpMat> S = unit_diagonal(W, shift);
  if (!S) return std::nullopt;
  lcp::Cholesky factor;
  if (S->rows() > 0 && !factor.try_factor(*S)) return std::nullopt;
  return shift;
}

/// H' M^-1 H is semidefinite itself where M is positive definite, which it is if D^-1 M D^-1 stays so with less on its
/// diagonal. Constraints leave it so: of K^-1 = [M G; G' 0]^-1 it has the block of the velocities.
std::optional<double> semidefinite_up_to(const Delassus& W) {
  const DelassusParts* parts = W.whole_parts();
  if (parts == nullptr) return semidefinite_up_to(W.matrix());
  const Inertia& inertia = parts->inertia();
  if (!inertia.symmetric()) return std::nullopt;
  const SpMat M = inertia.M().topLeftCorner(inertia.velocities(), inertia.velocities());
  const auto m = static_cast<double>(M.rows());
  const std::optional<SpMat> S = unit_diagonal(M, -4 * (m + 8) * eps * m);
  lcp::Cholesky factor;
  if (!S || S->rows() != M.rows() || (S->rows() > 0 && !factor.try_factor(*S))) return std::nullopt;
  return 0;
}

/// u = q + A x, exactly.
std::vector<Expansion> exact_sums(const Vec& q, const SpMat& A, const Vec& x) {
  std::vector<Expansion> u(at(q.size()));
  for (Index i = 0; i < q.size(); ++i) u[at(i)].add(q[i]);
  for (Index j = 0; j < A.outerSize(); ++j)
    for (SpMat::InnerIterator it(A, j); it; ++it) u[at(it.row())].add_product(it.value(), x[j]);
  return u;
}

bool constrained(const Problem& problem) {
  return problem.W.whole_parts() != nullptr && problem.W.parts()->inertia().by_lu();
}

/// Of bodies v near M^-1 H r: any v does, since H' and W have one range. Those of constrained bodies have to satisfy
/// G' v = 0, which rounded ones do not.
Vec moved_bodies(const Problem& problem, const Vec& r) {
  const DelassusParts* parts = problem.W.whole_parts();
  return parts != nullptr && !constrained(problem) ? parts->inverse(Vec(parts->H() * r)) : Vec();
}

struct Moved {
  std::vector<Expansion> u;
  Vec unknown;  ///< what it may be wrong by, where W or q were condensed
};

/// W r + q exactly; of bodies H' v + q, of constrained ones with a bound.
Moved moved(const Problem& problem, const Vec& r, const Vec& v) {
  const auto& [q, W] = problem.rounding;
  Moved out{.u = {}, .unknown = q.size() > 0 ? q : Vec(Vec::Zero(r.size()))};
  if (W.size() > 0) out.unknown += W.dot(r.cwiseAbs()) * W;
  const DelassusParts* parts = problem.W.whole_parts();
  if (parts == nullptr) {
    out.u = exact_sums(problem.q, problem.W.matrix(), r);
  } else if (constrained(problem)) {
    const lcp::SchurImage image = parts->refined_product(r, 0, problem.q);
    out.unknown += image.doubt + last_roundings * image.value.cwiseAbs();
    out.u = exact_sums(image.value, SpMat(r.size(), 0), Vec());
  } else {
    out.u = exact_sums(problem.q, parts->H().transpose(), v);
  }
  return out;
}

/// Least u_N - mu |u_T| - mu_r |w_R| less what the shift changes, and what rounding may have changed in W and q,
/// rounded down; u exact before it is rounded.
double margin(const Problem& problem, const Vec& r, const Vec& v, double shift) {
  const Moved at_r = moved(problem, r, v);
  const int d = problem.dimension;
  double least = lcp::infinity;
  for (Index a = 0; a < problem.contacts(); ++a) {
    const Index N = d * a;
    double friction = 0;  // mu |u_T| + mu_r |w_R|
    double changed = shift * problem.W.near(N, N) * std::abs(r[N]);
    double lost = at_r.u[at(N)].lost() + at_r.unknown[N];
    double mu = 0;  // of all disks
    const auto take_disk = [&](Index first, Index end, double coefficient) {
      double length = 0;
      double moved = 0;
      for (Index i = first; i < end; ++i) {
        length = std::hypot(length, at_r.u[at(i)].value());
        moved = std::hypot(moved, shift * problem.W.near(i, i) * r[i]);
        lost += at_r.u[at(i)].lost() + at_r.unknown[i];
      }
      friction += coefficient * length;
      changed += coefficient * moved;
      mu += coefficient;
    };
    take_disk(N + 1, N + problem.space(), problem.mu[a]);
    if (problem.rolls()) take_disk(N + problem.space(), N + d, problem.mu_r[a]);
    const double normal = at_r.u[at(N)].value();
    const double room = last_roundings * (std::abs(normal) + friction + changed) + (1 + mu) * (lost + 1e-300);
    const double here = normal - friction - changed - room;
    if (!std::isfinite(here)) return -lcp::infinity;
    least = std::min(least, here);
  }
  return least;
}

template <int Size>
class WitnessSearch {
 public:
  WitnessSearch(const Problem& problem, Scaled coordinates, const SearchLimits& limits, lcp::Deadline deadline,
                double shift)
      : problem_(problem),
        limits_(limits),
        deadline_(deadline),
        shift_(shift),
        scaled_(std::move(coordinates)),
        system_(scaled_) {}

  std::optional<Witness> run() {
    if (problem_.contacts() == 0) return std::nullopt;
    if (shows(Vec::Zero(scaled_.size()))) return found_;
    for (const double regularization : regularizations)
      if (over() || by_equation(regularization)) return found_;
    if (!factor(penalty)) return std::nullopt;
    for (const double m : margins)
      if (over() || by_admm(m)) return found_;
    return found_;
  }

 private:
  bool over() const { return Clock::now() > deadline_ || (limits_.interrupt != nullptr && *limits_.interrupt); }

  bool shows(const Vec& r) {
    if (!r.allFinite()) return false;
    const Vec whole = scaled_.expand(r);
    Vec v = moved_bodies(problem_, whole);
    const double here = margin(problem_, whole, v, shift_);
    if (here > 0) found_ = Witness{.r = whole, .v = std::move(v), .margin = here, .shift = shift_};
    return here > 0;
  }

  /// W~ + diagonal I.
  bool factor(double diagonal) {
    const ContactMatrix<Size> I = ContactMatrix<Size>::Identity();
    const std::vector<ContactMatrix<Size>> A(scaled_.blocks.size(), diagonal * I);
    const std::vector<ContactMatrix<Size>> inverse(scaled_.blocks.size(), I / diagonal);
    return system_.factor(A, inverse);
  }

  /// Velocities as near to e_N as W lets them be, by a regularised solve: for regular W this is all.
  bool by_equation(double regularization) {
    if (!factor(regularization)) return false;
    Vec right = -scaled_.q;
    for (const Scaled::Block& block : scaled_.blocks) right[block.first] += 1;
    Vec r(right.size());
    system_.solve(right, r);
    return shows(r);
  }

  bool by_admm(double m) {
    Vec right = -scaled_.q;
    for (const Scaled::Block& block : scaled_.blocks) right[block.first] += m;
    Vec r(right.size());
    Vec z = Vec::Zero(right.size());
    Vec dual = z;
    for (int k = 1; k <= iterations && !over(); ++k) {
      system_.solve(right + penalty * (z - dual), r);
      z = project_onto_cones(scaled_, r + dual);
      dual += r - z;
      if (k % look == 0 && promising(r) && shows(r)) return true;
    }
    return false;
  }

  /// Whether it is worth an exact look.
  bool promising(const Vec& r) const {
    const Vec u = scaled_.W * r + scaled_.q;
    const Vec opened = corrected(scaled_, u) - u;
    return std::ranges::all_of(scaled_.blocks,
                               [&](const Scaled::Block& block) { return u[block.first] > opened[block.first]; });
  }

  const Problem& problem_;
  SearchLimits limits_;
  lcp::Deadline deadline_;
  double shift_;
  Scaled scaled_;
  ContactSystemOf<Size> system_;
  std::optional<Witness> found_;
};

}  // namespace

std::string_view to_string(Existence existence) {
  using enum Existence;
  static constexpr std::pair<Existence, std::string_view> words[] = {
      {Undecided, "undecided"}, {Exists, "exists"}, {None, "none"}};
  return word_of(existence, words);
}

SearchLimits search_after(std::chrono::duration<double> spent, std::chrono::duration<double> of,
                          const std::atomic<bool>* interrupt) {
  constexpr std::chrono::duration<double> least{0.1};
  return {.max_time = std::max(least, std::min(spent, of - spent)), .interrupt = interrupt};
}

std::optional<Witness> examine_witness(const Problem& problem, In r) {
  check(problem);
  if (r.size() != problem.q.size())
    refuse_input("contact: the witness has ", r.size(), " entries, the problem ", problem.q.size());
  const std::optional<double> shift = r.allFinite() ? semidefinite_up_to(problem.W) : std::nullopt;
  if (!shift) return std::nullopt;
  Vec v = moved_bodies(problem, r);
  const double here = margin(problem, r, v, *shift);
  if (!(here > 0)) return std::nullopt;
  return Witness{.r = r, .v = std::move(v), .margin = here, .shift = *shift};
}

std::optional<Witness> find_witness(const Problem& problem, const SearchLimits& limits) {
  check(problem);
  const lcp::Deadline deadline = lcp::deadline_after(limits.max_time);
  const std::optional<double> shift = semidefinite_up_to(problem.W);
  if (!shift) return std::nullopt;
  const Scaled coordinates = scaled(problem);
  return with_size(coordinates, [&]<int Size>() {
    return WitnessSearch<Size>(problem, coordinates, limits, deadline, *shift).run();
  });
}

Verdict verdict_of(const Problem& problem, Infeasible proof) {
  std::vector<Index> contacts;
  double approach = 0;
  const double largest = proof.y.maxCoeff();
  for (Index a = 0; a < proof.y.size(); ++a) {
    approach += proof.y[a] / largest * problem.q[problem.dimension * a];
    if (proof.y[a] > 0) contacts.push_back(a);
  }
  std::ostringstream text;
  text.precision(3);
  text << "no solution exists: ";
  if (proof.radius == lcp::infinity)
    text << "no impulses";
  else
    text << "no impulses below " << proof.radius << " N s";
  text << " keep " << contacts_text(contacts, 1)
       << (contacts.size() == 1 ? " from approaching, u_N <= " : " from approaching, y.u_N / max y <= ") << approach
       << " m/s for the certificate y";
  Verdict verdict{.existence = Existence::None};
  verdict.certificate = std::move(proof.y);
  verdict.radius = proof.radius;
  verdict.message = text.str();
  return verdict;
}

Verdict existence(const Problem& problem, const SearchLimits& limits) {
  if (std::optional<Infeasible> proof = find_infeasibility(problem, limits))
    return verdict_of(problem, std::move(*proof));
  return verdict_without_certificate(problem, limits);
}

Verdict verdict_without_certificate(const Problem& problem, const SearchLimits& limits) {
  Verdict verdict;
  if (std::optional<Witness> witness = find_witness(problem, limits)) {
    verdict.existence = Existence::Exists;
    verdict.witness = std::move(*witness);
    verdict.message = "a solution exists (Acary, Cadoux, Lemarechal & Malick 2011), but it was not found";
  } else {
    verdict.message = "whether there is a solution is undecided";
  }
  return verdict;
}

}  // namespace perp::contact
