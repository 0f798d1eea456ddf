// SPDX-License-Identifier: Apache-2.0
#include "contact/model/velocities.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "contact/model/residual.hpp"
#include "lcp/judge/two_part_vector.hpp"

namespace perp::contact {
namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();
/// What u may be wrong by, of itself, before its row is added up without rounding.
constexpr double wanted = 1e-14;
/// Of Q_a: what u is compared with where it is less, of parts.
constexpr double least_share = 1e-6;
/// What u may be wrong by where W was condensed or bodies are constrained, of what it is compared with.
constexpr double most_doubt = 1e-9;
/// Roundings of a sum over the contacts of a body, or of an elimination, generously.
constexpr double roundings = 100;
/// The same of sums in twice the precision.
constexpr double roundings_of_two = 64;
/// Of what cancels: what an LU factorization leaves, at least, and where it is no longer of use.
constexpr double least_by_lu = 1e-10;
constexpr double most_by_lu = 1e-6;

/// Row i of u for those that are asked for.
void add_exactly(const Problem& problem, In r, const std::vector<char>& asked, Vec& u) {
  std::vector<Index> place(asked.size(), -1);
  std::vector<Index> rows;
  for (Index i = 0; i < u.size(); ++i)
    if (asked[at(i)] != 0) {
      place[at(i)] = static_cast<Index>(rows.size());
      rows.push_back(i);
    }
  std::vector<lcp::ExactSum> sums(rows.size());
  const SpMat& W = problem.W.matrix();
  for (Index j = 0; j < r.size(); ++j)
    for (SpMat::InnerIterator it(W, j); it; ++it)
      if (const Index k = place[at(it.row())]; k >= 0) sums[at(k)].add_product(it.value(), r[j]);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    sums[k].add(problem.q[rows[k]]);
    u[rows[k]] = sums[k].value();
  }
}

/// The image, NaN where impulses are so large that it says nothing of the velocities they are to balance; 0 where it is
/// rounding and nothing moves.
Velocities known(const Problem& problem, const lcp::SchurImage& image, double rcond, Vec terms,
                 const std::vector<double>& coupled) {
  const int d = problem.dimension;
  Velocities out{.u = image.value, .terms = std::move(terms)};
  for (Index a = 0; a < problem.contacts(); ++a) {
    const double Q = coupled[at(a)];
    const auto unit = levers(problem, lever(problem, a));
    const auto of = [&](const Vec& v) { return v.segment(d * a, d).cwiseProduct(unit).stableNorm(); };
    const double compared = std::max({of(image.value), of(problem.q), std::min(of(out.terms), Q)});
    for (Index i = d * a; i < d * a + d; ++i) {
      if (Q > 0 && unit[i - d * a] * image.doubt[i] > most_doubt * compared)
        out.u[i] = std::numeric_limits<double>::quiet_NaN();
      if (Q == 0 && std::abs(image.value[i]) <= rcond * image.doubt[i]) out.u[i] = 0;
    }
  }
  return out;
}

/// Of what W was condensed from, where it was.
Velocities by_entries(const Problem& problem, In r, const std::vector<double>& coupled) {
  const Index n = problem.q.size();
  if (const lcp::SchurProduct* product = problem.W.condensed(); product != nullptr)
    return known(problem, (*product)(r, problem.q), product->rcond(),
                 problem.W.matrix().cwiseAbs() * r.cwiseAbs() + problem.q.cwiseAbs(), coupled);
  Velocities out{.u = problem.q, .terms = problem.q.cwiseAbs()};
  Vec errors = Vec::Zero(n);
  std::vector<int> entries(at(n), 0);
  const SpMat& W = problem.W.matrix();
  for (Index j = 0; j < n; ++j) {
    if (r[j] == 0) continue;
    for (SpMat::InnerIterator it(W, j); it; ++it) {
      const Index i = it.row();
      const lcp::TwoParts product = lcp::two_product(it.value(), r[j]);
      const lcp::TwoParts sum = lcp::two_sum(out.u[i], product.value);
      out.u[i] = sum.value;
      errors[i] += sum.error + product.error;
      out.terms[i] += std::abs(product.value);
      ++entries[at(i)];
    }
  }
  std::vector<char> asked(at(n), 0);
  bool any = false;
  for (Index i = 0; i < n; ++i) {
    out.u[i] += errors[i];
    if (entries[at(i)] == 0) continue;
    const double rounding = eps * (entries[at(i)] + 2);
    if (std::isfinite(out.u[i]) && rounding * rounding * out.terms[i] > wanted * std::abs(out.u[i])) {
      asked[at(i)] = 1;
      any = true;
    }
  }
  if (any) add_exactly(problem, r, asked, out.u);
  return out;
}

/// A sum in twice the working precision.
class DoubledSum {
 public:
  void add(double a) {
    const lcp::TwoParts sum = lcp::two_sum(value_, a);
    value_ = sum.value;
    rest_ += sum.error;
  }
  void add_product(double a, double b) {
    const lcp::TwoParts product = lcp::two_product(a, b);
    add(product.value);
    rest_ += product.error;
  }
  double value() const { return value_ + rest_; }

 private:
  double value_ = 0;
  double rest_ = 0;
};

template <class Sum>
lcp::TwoPartVector rounded(std::vector<Sum>& sums) {
  const auto n = static_cast<Index>(sums.size());
  lcp::TwoPartVector out{Vec(n)};
  for (Index i = 0; i < n; ++i) {
    out.value[i] = sums[at(i)].value();
    sums[at(i)].add(-out.value[i]);
    out.rest[i] = sums[at(i)].value();
  }
  return out;
}

/// sums += sign A x
template <class Sum>
void add_product(const SpMat& A, In x, double sign, std::vector<Sum>& sums) {
  for (Index j = 0; j < x.size(); ++j) {
    if (x[j] == 0) continue;
    for (SpMat::InnerIterator it(A, j); it; ++it) sums[at(it.row())].add_product(it.value(), sign * x[j]);
  }
}

/// v = M^-1 p. A correction reduces the error by eps cond(M), generously.
template <class Sum>
lcp::TwoPartVector inverse(const DelassusParts& parts, const lcp::TwoPartVector& p) {
  lcp::TwoPartVector v{parts.inverse(p.value)};
  const double contraction = 10 * eps / parts.inertia().rcond();
  const int corrections = static_cast<int>(std::ceil(2 * std::log(eps) / std::log(std::min(contraction, 0.1)))) - 1;
  for (int k = 0; k < corrections; ++k) {
    std::vector<Sum> sums(at(p.value.size()));
    for (Index i = 0; i < p.value.size(); ++i) {
      sums[at(i)].add(p.value[i]);
      sums[at(i)].add(p.rest[i]);
    }
    add_product(parts.M(), v.value, -1, sums);
    add_product(parts.M(), v.rest, -1, sums);
    const Vec correction = parts.inverse(rounded(sums).value);
    for (Index i = 0; i < correction.size(); ++i) v.add(i, correction[i]);
  }
  return v;
}

/// H' M^-1 p + w + shift r
template <class Sum>
Vec velocities_of(const DelassusParts& parts, const lcp::TwoPartVector& p, In w, double shift, In r) {
  const lcp::TwoPartVector v = inverse<Sum>(parts, p);
  const SpMat& H = parts.H();
  Vec u(w.size());
  for (Index i = 0; i < u.size(); ++i) {
    Sum sum;
    for (SpMat::InnerIterator it(H, i); it; ++it) {
      sum.add_product(it.value(), v.value[it.row()]);
      sum.add_product(it.value(), v.rest[it.row()]);
    }
    if (shift != 0) sum.add_product(shift, r[i]);
    sum.add(w[i]);
    u[i] = sum.value();
  }
  return u;
}

template <class Sum>
Vec by_parts(const Problem& problem, In r) {
  const DelassusParts& parts = *problem.W.parts();
  std::vector<Sum> sums(at(parts.H().rows()));
  add_product(parts.H(), r, 1, sums);
  return velocities_of<Sum>(parts, rounded(sums), problem.q, problem.W.shift(), r);
}

Velocities by_parts(const Problem& problem, In r, const std::vector<double>& coupled) {
  const DelassusParts& parts = *problem.W.parts();
  const Vec size = r.cwiseAbs();
  Vec terms = parts.shares().transpose() * Vec(parts.shares() * size) + problem.W.shift() * size + problem.q.cwiseAbs();
  if (parts.inertia().by_lu()) {
    const lcp::SchurImage image = parts.refined_product(r, problem.W.shift(), problem.q);
    return known(problem, image, parts.inertia().rcond(), terms.cwiseMin(image.terms), coupled);
  }
  Velocities out{.u = by_parts<DoubledSum>(problem, r), .terms = std::move(terms)};
  const double rounding = roundings * eps * eps / parts.inertia().rcond();
  for (Index i = 0; i < r.size(); ++i) {
    const Index a = i / problem.dimension;
    const double unit = i % problem.dimension < problem.space() ? 1 : lever(problem, a);
    const double compared = std::max(unit * std::abs(out.u[i]), least_share * coupled[at(a)]);
    if (std::isfinite(out.u[i]) && unit * rounding * out.terms[i] > wanted * compared) {
      out.u = by_parts<lcp::ExactSum>(problem, r);
      break;
    }
  }
  return out;
}

}  // namespace

double lever(const Problem& problem, Index contact) {
  if (!problem.rolls()) return 1;
  const int d = problem.dimension;
  const int slides = problem.space();
  const auto mean = [&](int from, int to) {
    double sum = 0;
    for (Index i = d * contact + from; i < d * contact + to; ++i) sum += problem.W.near(i, i);
    return sum / (to - from);
  };
  const double square = mean(0, slides) / mean(slides, d);
  return square > 0 && std::isfinite(square) ? std::sqrt(square) : 1;
}

Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 5, 1> levers(const Problem& problem, double lever) {
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 5, 1> out = Vec::Ones(problem.dimension);
  out.tail(problem.dimension - problem.space()).setConstant(lever);
  return out;
}

std::vector<double> coupled_velocities(const Problem& problem) {
  const int d = problem.dimension;
  std::vector<double> out(at(problem.contacts()));
  for (const std::vector<Index>& group : problem.W.groups(d)) {
    double largest = 0;
    for (const Index a : group) {
      const auto q = problem.q.segment(d * a, d);
      largest = std::max(
          largest, problem.rolls() ? q.cwiseProduct(levers(problem, lever(problem, a))).stableNorm() : q.stableNorm());
    }
    for (const Index a : group) out[at(a)] = largest;
  }
  return out;
}

Velocities exact_velocities(const Problem& problem, In r, const std::vector<double>& coupled) {
  return problem.W.parts() != nullptr ? by_parts(problem, r, coupled) : by_entries(problem, r, coupled);
}

Vec exact_velocities(const DelassusParts& parts, In p, In w) {
  Vec u = velocities_of<lcp::ExactSum>(parts, lcp::TwoPartVector(p), w, 0, w);
  const Vec v = parts.inverse(p).cwiseAbs();
  const Vec added = parts.H().cwiseAbs().transpose() * v;
  for (Index i = 0; i < u.size(); ++i)
    if (std::abs(u[i]) <= roundings_of_two * eps * eps * added[i]) u[i] = 0;
  return u;
}

Vec velocities(const Problem& problem, In r) { return exact_velocities(problem, r, coupled_velocities(problem)).u; }

/// A solution y in the units of the factorization is right to eps / rcond of its largest entry. That of a column of B
/// is no larger than 1 / rcond times the column.
Rounding rounding_by_lu(const lcp::RefinedLu& K, const SpMat& B, In x, In w, In W_0) {
  const Index n = B.cols();
  const double share = std::max(least_by_lu, roundings * eps / K.rcond());
  if (!(share <= most_by_lu)) return {.q = Vec::Constant(n, lcp::infinity), .W = Vec::Constant(n, lcp::infinity)};
  const std::vector<int>& part_of = K.part_of();
  Vec largest = Vec::Zero(K.size());
  for (Index i = 0; i < K.size(); ++i)
    largest[part_of[at(i)]] = std::max(largest[part_of[at(i)]], std::abs(x[i] / K.scale()[i]));
  Rounding out{.q = w.cwiseAbs(), .W = W_0.cwiseAbs().cwiseSqrt()};
  for (Index j = 0; j < n; ++j)
    for (SpMat::InnerIterator it(B, j); it; ++it) {
      const double size = std::abs(K.scale()[it.row()] * it.value());
      out.q[j] += size * largest[part_of[at(it.row())]];
      out.W[j] += size;
    }
  out.q *= share;
  out.W *= std::sqrt(std::max(least_by_lu, roundings * eps / K.rcond() / K.rcond()));
  return out;
}

/// v is right to eps^2 entry by entry in the norm of M's diagonal, so that in that of M it may be worse by
/// sqrt(m / rcond); N_bi is H_i in that of M^-1.
Rounding rounding_by_parts(const DelassusParts& parts, In f, In q) {
  const Inertia& inertia = parts.inertia();
  const Vec v = parts.inverse(f);
  Vec squares = Vec::Zero(parts.shares().rows());
  for (Index i = 0; i < f.size(); ++i) squares[inertia.body_of()[at(i)]] += std::abs(f[i] * v[i]);
  const double worse = std::sqrt(static_cast<double>(f.size()) / inertia.rcond());
  const Vec sizes = parts.shares().transpose() * squares.cwiseSqrt();
  return {.q = 8 * eps * q.cwiseAbs() + roundings * eps * eps * worse * sizes, .W = {}};
}

}  // namespace perp::contact
