// SPDX-License-Identifier: Apache-2.0
#include "collection/random/random_ncps.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "collection/base/build.hpp"
#include "collection/base/random.hpp"

namespace perp::ncp::collection {
namespace {

using Entries = std::vector<Eigen::Triplet<double>>;

enum class Curve { Linear, Cube, LinearCube, Arctan, Exp };

/// g(x) = curve(scale x)
struct Term {
  Curve curve = Curve::Linear;
  double scale = 1;

  template <class T>
  T value(const T& x) const {
    using std::atan, std::exp;
    const T y = scale * x;
    switch (curve) {
      case Curve::Linear:
        return y;
      case Curve::Cube:
        return y * y * y;
      case Curve::LinearCube:
        return y + y * y * y;
      case Curve::Arctan:
        return atan(y);
      case Curve::Exp:
        return exp(y);
    }
    return 0;
  }
  double slope(double x) const {
    const double y = scale * x;
    switch (curve) {
      case Curve::Linear:
        return scale;
      case Curve::Cube:
        return scale * 3 * y * y;
      case Curve::LinearCube:
        return scale * (1 + 3 * y * y);
      case Curve::Arctan:
        return scale / (1 + y * y);
      case Curve::Exp:
        return scale * std::exp(y);
    }
    return 0;
  }
};

/// F(x) = M x + A g(x) + q. M and A are kept as two lists of values on the union of their patterns.
class SeparableMcp final : public Mcp {
 public:
  SeparableMcp(std::string name, Box box, const SpMat& M, const SpMat& A, std::vector<Term> g)
      : name_(std::move(name)), box_(std::move(box)), g_(std::move(g)), q_(Vec::Zero(M.rows())) {
    const auto ones = [](SpMat P) {
      P.coeffs().setOnes();
      return P;
    };
    pattern_ = ones(M) + ones(A);
    pattern_.makeCompressed();
    m_ = spread(M);
    a_ = spread(A);
  }

  /// Makes F the wanted one at x.
  void plant(In x, In wanted) {
    q_.setZero();
    Vec F(x.size());
    eval(x, F);
    q_ = wanted - F;
  }

  const Box& box() const override { return box_; }
  const SpMat& jacobian_pattern() const override { return pattern_; }
  std::string name() const override { return name_; }

  bool eval(In x, Out F) const override {
    add_up(x, F);
    return all_finite(F);
  }
  std::optional<Expressions> expressions() const override {
    return written_down(on_vectors(size(), [&](const auto& x, auto& F) { add_up(x, F); }), static_cast<int>(size()));
  }
  bool jacobian(In x, SpMat& J) const override {
    for (Index j = 0; j < x.size(); ++j) {
      const double slope = term(j).slope(x[j]);
      for (Index at = first(j); at < first(j + 1); ++at) J.valuePtr()[at] = m_[at] + (a_[at] != 0 ? a_[at] * slope : 0);
    }
    return all_finite(Eigen::Map<const Vec>(J.valuePtr(), J.nonZeros()));
  }
  std::vector<bool> linear_entries() const override {
    std::vector<bool> linear;
    linear.reserve(static_cast<std::size_t>(a_.size()));
    for (const double a : a_) linear.push_back(a == 0);
    return linear;
  }

 private:
  template <class Z, class Y>
  void add_up(const Z& x, Y& F) const {
    using T = typename Z::Scalar;
    for (Index i = 0; i < q_.size(); ++i) F[i] = q_[i];
    for (Index j = 0; j < x.size(); ++j) {
      const T g = term(j).value(T(x[j]));
      for (Index at = first(j); at < first(j + 1); ++at)
        F[pattern_.innerIndexPtr()[at]] += m_[at] * x[j] + (a_[at] != 0 ? a_[at] * g : T(0));
    }
  }
  const Term& term(Index j) const { return g_[static_cast<std::size_t>(j)]; }
  Index first(Index j) const { return pattern_.outerIndexPtr()[j]; }
  Vec spread(const SpMat& part) const {
    Vec values = Vec::Zero(pattern_.nonZeros());
    for (Index j = 0; j < part.cols(); ++j) {
      Index at = first(j);
      for (SpMat::InnerIterator entry(part, j); entry; ++entry) {
        while (pattern_.innerIndexPtr()[at] != entry.row()) ++at;
        values[at] = entry.value();
      }
    }
    return values;
  }

  std::string name_;
  Box box_;
  std::vector<Term> g_;
  Vec q_, m_, a_;
  SpMat pattern_;
};

SpMat matrix(Index n, const Entries& entries, Index columns = -1) {
  SpMat made(n, columns < 0 ? n : columns);
  made.setFromTriplets(entries.begin(), entries.end());
  return made;
}

SpMat diagonal(const Vec& d) {
  Entries entries;
  for (Index i = 0; i < d.size(); ++i) entries.emplace_back(i, i, d[i]);
  return matrix(d.size(), entries);
}

SpMat skew(Index n, Random& random) {
  Entries entries;
  for (Index k = 0; k < n; ++k) {
    const Index i = random.below(n), j = random.below(n);
    const double value = random.uniform(-1, 1);
    if (i == j) continue;
    entries.emplace_back(i, j, value);
    entries.emplace_back(j, i, -value);
  }
  return matrix(n, entries);
}

/// B B' + W
SpMat semidefinite(Index n, Random& random) {
  Entries entries;
  for (Index i = 0; i < n; ++i)
    for (int k = 0; k < 2; ++k) {
      const Index column = random.below(n / 2);
      entries.emplace_back(i, column, random.uniform(-1, 1));
    }
  const SpMat B = matrix(n, entries, n / 2);
  const SpMat Bt = B.transpose();
  return SpMat(B * Bt) + skew(n, random);
}

Vec uniform(Index n, double low, double high, Random& random) {
  Vec v(n);
  for (double& value : v) value = random.uniform(low, high);
  return v;
}

/// A curve an index, in turn.
std::vector<Term> in_turn(Index n, const std::vector<Term>& terms) {
  std::vector<Term> g(static_cast<std::size_t>(n));
  for (std::size_t i = 0; i < g.size(); ++i) g[i] = terms[i % terms.size()];
  return g;
}

const std::vector<Term> mixed{{Curve::Arctan, 1}, {Curve::LinearCube, 1}, {Curve::Exp, 0.25}};

/// x and F of a solution with x >= 0; x_i = F_i = 0 with that probability.
std::pair<Vec, Vec> complementary_pair(Index n, double degenerate, Random& random) {
  Vec x = Vec::Zero(n), F = Vec::Zero(n);
  for (Index i = 0; i < n; ++i) {
    const double size = random.uniform(0.5, 2);
    const bool inside = random.uniform(0, 1) < 0.5;
    if (random.uniform(0, 1) < degenerate) continue;
    (inside ? x : F)[i] = size;
  }
  return {x, F};
}

Problem planted(std::unique_ptr<SeparableMcp> mcp, Vec x, const Vec& F, bool unique) {
  const Index n = x.size();
  mcp->plant(x, F);
  Problem p;
  p.mcp = std::move(mcp);
  Vec alternating = Vec::Zero(n);
  for (Index i = 1; i < n; i += 2) alternating[i] = 2;
  p.starts = {Vec::Zero(n), Vec::Ones(n), Vec::Constant(n, 10), alternating};
  p.solutions = {{"planted", std::move(x), 1e-11}};
  p.solutions_complete = unique;
  return p;
}

Problem monotone(const char* name, Index n, unsigned seed, double degenerate) {
  require_at_least(name, "n", n, 2);
  Random random(seed);
  const SpMat M = semidefinite(n, random);
  const SpMat A = diagonal(uniform(n, 0.5, 2, random));
  const auto [x, F] = complementary_pair(n, degenerate, random);
  return planted(std::make_unique<SeparableMcp>(name, Box::nonnegative(n), M, A, in_turn(n, mixed)), x, F, true);
}

}  // namespace

Problem random_monotone_ncp_own(Index n, unsigned seed) { return monotone("random-monotone-ncp-own", n, seed, 0); }

Problem random_degenerate_ncp_own(Index n, unsigned seed) {
  return monotone("random-degenerate-ncp-own", n, seed, 0.5);
}

Problem random_p0_ncp_own(Index n, unsigned seed) {
  constexpr const char* name = "random-p0-ncp-own";
  require_at_least(name, "n", n, 4);
  Random random(seed);
  Entries entries;
  for (Index i = 2; i < n; ++i)
    for (int k = 0; k < 3; ++k) {
      const Index j = random.below(n);
      const double value = random.uniform(-1, 1);
      if (i != j) entries.emplace_back(i, j, value);
    }
  Vec sums = Vec::Zero(n);
  for (const auto& e : entries) sums[e.row()] += std::abs(e.value());
  for (Index i = 2; i < n; ++i)
    entries.emplace_back(i, i, sums[i] + (i % 2 == 0 || sums[i] == 0 ? random.uniform(0.1, 1) : 0.0));
  for (Index j = 0; j < 2; ++j) {
    entries.emplace_back(0, j, 9.0);
    entries.emplace_back(1, j, 1.0);
  }
  const SpMat H = matrix(n, entries);
  std::vector<Term> g = in_turn(n, {{Curve::LinearCube, 1}, {Curve::Cube, 1}, {Curve::Arctan, 1}});
  g[1] = g[0];
  auto [x, F] = complementary_pair(n, 0, random);
  x.head(2) << 1, 0;
  F.head(2) << 0, 1;
  return planted(std::make_unique<SeparableMcp>(name, Box::nonnegative(n), SpMat(n, n), H, std::move(g)), x, F, false);
}

Problem random_ill_conditioned_ncp_own(Index n, unsigned seed) {
  constexpr const char* name = "random-ill-conditioned-ncp-own";
  require_at_least(name, "n", n, 2);
  Random random(seed);
  const SpMat M = semidefinite(n, random);
  const Vec d = uniform(n, 0.5, 2, random);
  Vec S = uniform(n, -2, 2, random);
  S.head(2) << -2, 2;
  for (double& s : S) s = std::pow(10, s);
  std::vector<Term> g = in_turn(n, {{Curve::Arctan, 1}, {Curve::LinearCube, 1}});
  for (std::size_t i = 0; i < g.size(); ++i) g[i].scale = S[static_cast<Index>(i)];
  const auto [y, F] = complementary_pair(n, 0, random);
  return planted(std::make_unique<SeparableMcp>(name, Box::nonnegative(n), S.asDiagonal() * M * S.asDiagonal(),
                                                diagonal(S.cwiseProduct(d)), std::move(g)),
                 y.cwiseQuotient(S), F, true);
}

Problem random_boxed_ncp_own(Index n, unsigned seed) {
  constexpr const char* name = "random-boxed-ncp-own";
  require_at_least(name, "n", n, 2);
  Random random(seed);
  const SpMat M = semidefinite(n, random);
  const SpMat A = diagonal(uniform(n, 0.5, 2, random));
  Box box{Vec(n), Vec(n)};
  Vec x(n), F = Vec::Zero(n);
  for (Index i = 0; i < n; ++i) {
    const double bounds[5][2] = {{0, infinity}, {-1, 1}, {-infinity, infinity}, {-infinity, 1}, {0.5, 0.5}};
    const auto& [low, high] = bounds[i % 5];
    box.lower[i] = low;
    box.upper[i] = high;
    const double place = random.uniform(-1, 1), size = random.uniform(0.5, 2);
    const bool at_lower = place < -0.3 && low > -infinity, at_upper = place > 0.3 && high < infinity;
    x[i] = at_lower ? low : at_upper ? high : std::clamp(low < 0 ? place : std::abs(place), low, high);
    if (at_lower || at_upper) F[i] = at_lower ? size : -size;
  }
  return planted(std::make_unique<SeparableMcp>(name, std::move(box), M, A, in_turn(n, mixed)), x, F, true);
}

Problem random_exponential_ncp_own(Index n, unsigned seed) {
  constexpr const char* name = "random-exponential-ncp-own";
  require_at_least(name, "n", n, 2);
  Random random(seed);
  const SpMat M = skew(n, random) + diagonal(Vec::Constant(n, 0.1));
  const SpMat A = diagonal(uniform(n, 0.5, 2, random));
  const auto [x, F] = complementary_pair(n, 0, random);
  return planted(std::make_unique<SeparableMcp>(name, Box::nonnegative(n), M, A, in_turn(n, {{Curve::Exp, 5}})), x, F,
                 true);
}

}  // namespace perp::ncp::collection
