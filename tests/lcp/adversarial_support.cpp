// SPDX-License-Identifier: Apache-2.0
#include "lcp/adversarial_support.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>
#include <vector>

#include "lcp/dense_factors.hpp"
#include "lcp/exact_sum.hpp"

namespace perp::lcp::adversarial {

std::uint64_t Rng::next() {
  state_ += 0x9e3779b97f4a7c15U;
  std::uint64_t x = state_;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31);
}

int Rng::integer(int low, int high) {
  const auto count = static_cast<std::uint64_t>(high - low + 1);
  return low + static_cast<int>((next() >> 11) % count);
}

double Rng::digits(int bits) {
  const auto k = static_cast<std::int64_t>(next() >> (64 - bits));
  const double value = std::ldexp(static_cast<double>(k), 2 - bits);
  return chance(50) ? value : -value;
}

namespace {

using Dense = Eigen::MatrixXd;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Entries of few digits, some of them 0.
Dense entries(Rng& r, Index rows, Index columns, int percent = 60, int bits = 4) {
  Dense A = Dense::Zero(rows, columns);
  for (Index j = 0; j < columns; ++j)
    for (Index i = 0; i < rows; ++i)
      if (r.chance(percent)) A(i, j) = r.digits(bits);
  return A;
}

Dense permuted(Rng& r, const Dense& A) {
  std::vector<Index> order(at(A.rows()));
  std::iota(order.begin(), order.end(), Index{0});
  for (std::size_t k = order.size(); k > 1; --k)
    std::swap(order[k - 1], order[at(r.integer(0, static_cast<int>(k) - 1))]);
  return A(order, order);
}

Dense dominant(Dense A, Rng& r) {
  for (Index i = 0; i < A.rows(); ++i) A(i, i) = A.row(i).cwiseAbs().sum() - std::abs(A(i, i)) + 0.25 * r.integer(1, 8);
  return A;
}

Dense strictly_upper(Rng& r, Index n) { return entries(r, n, n, 60).triangularView<Eigen::StrictlyUpper>(); }

Dense gram(Rng& r, Index n, Index rank) {
  const Dense A = entries(r, rank, n, 60, 3);
  return A.transpose() * A;
}

Dense blocks(const Dense& A, const Dense& B, const Dense& C, const Dense& D) {
  Dense M(A.rows() + C.rows(), A.cols() + B.cols());
  M.topLeftCorner(A.rows(), A.cols()) = A;
  M.topRightCorner(B.rows(), B.cols()) = B;
  M.bottomLeftCorner(C.rows(), C.cols()) = C;
  M.bottomRightCorner(D.rows(), D.cols()) = D;
  return M;
}

Dense saddle(Rng& r, Index n, bool quadratic) {
  const Index m = n / 2;
  const Dense A = entries(r, n - m, m);
  const Dense Q = quadratic ? gram(r, m, std::max<Index>(1, m - 1)) : Dense::Zero(m, m);
  return blocks(Q, -A.transpose(), A, Dense::Zero(n - m, n - m));
}

/// Two rows whose difference is tiny: singular but for 2^-50.
Dense nearly_dependent(Rng& r, Index n) {
  Dense M = r.chance(50) ? gram(r, n, n) : entries(r, n, n, 80);
  if (n < 2) return Dense::Constant(n, n, r.chance(50) ? 0x1p-50 : -0x1p-50);
  const Index i = r.integer(0, static_cast<int>(n) - 1);
  const Index k = (i + 1) % n;
  M.row(k) = (r.chance(70) ? 1 : -1) * M.row(i);
  const Index j = r.integer(0, static_cast<int>(n) - 1);
  if (M(k, j) == 0) M(k, j) = 1;
  M(k, j) += std::ldexp(r.chance(50) ? M(k, j) : -M(k, j), -r.integer(40, 50));
  return M;
}

Dense murty(Rng& r, Index n) {
  Dense M = Dense::Identity(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = i + 1; j < n; ++j) M(i, j) = 2;
  return r.chance(50) ? Dense(M.transpose()) : M;
}

Dense graded(Rng& r, Index n) {
  return entries(r, n, n, 70).unaryExpr([&](double a) { return std::ldexp(a, r.integer(-12, 12)); });
}

Dense symmetric(Rng& r, Index n) {
  const Dense A = entries(r, n, n, 60);
  return A + A.transpose();
}

struct MatrixClass {
  const char* name;
  Dense (*make)(Rng&, Index);
};

constexpr std::array matrix_classes{
    MatrixClass{"sparse", [](Rng& r, Index n) { return entries(r, n, n, 35); }},
    MatrixClass{"dense", [](Rng& r, Index n) { return entries(r, n, n, 100); }},
    MatrixClass{"PD", [](Rng& r, Index n) { return Dense(gram(r, n, n) + 0.25 * Dense::Identity(n, n)); }},
    MatrixClass{"PD, not symmetric",
                [](Rng& r, Index n) {
                  const Dense K = strictly_upper(r, n);
                  return Dense(gram(r, n, n) + 0.25 * Dense::Identity(n, n) + K - K.transpose());
                }},
    MatrixClass{"PSD singular", [](Rng& r, Index n) { return gram(r, n, std::max<Index>(1, n / 2)); }},
    MatrixClass{"symmetric indefinite", symmetric},
    MatrixClass{"negative definite",
                [](Rng& r, Index n) { return Dense(-gram(r, n, n) - 0.5 * Dense::Identity(n, n)); }},
    MatrixClass{"Z",
                [](Rng& r, Index n) {
                  Dense M = -entries(r, n, n, 60).cwiseAbs();
                  for (Index i = 0; i < n; ++i) M(i, i) = r.digits(5);
                  return M;
                }},
    MatrixClass{"M-matrix", [](Rng& r, Index n) { return dominant(-entries(r, n, n, 60).cwiseAbs(), r); }},
    MatrixClass{"H+", [](Rng& r, Index n) { return dominant(entries(r, n, n, 70), r); }},
    MatrixClass{"P, triangular",
                [](Rng& r, Index n) {
                  Dense M = strictly_upper(r, n);
                  for (Index i = 0; i < n; ++i) M(i, i) = 0.25 * r.integer(1, 12);
                  return permuted(r, M);
                }},
    MatrixClass{"Murty", murty},
    MatrixClass{"copositive",
                [](Rng& r, Index n) {
                  const Dense nonnegative = entries(r, n, n, 50).cwiseAbs();
                  return Dense(nonnegative + gram(r, n, std::max<Index>(1, n / 3)));
                }},
    MatrixClass{"nonnegative, R0",
                [](Rng& r, Index n) {
                  Dense M = entries(r, n, n, 50).cwiseAbs();
                  for (Index i = 0; i < n; ++i) M(i, i) = 0.25 * r.integer(1, 12);
                  return M;
                }},
    MatrixClass{"nonpositive", [](Rng& r, Index n) { return Dense(-entries(r, n, n, 60).cwiseAbs()); }},
    MatrixClass{"skew",
                [](Rng& r, Index n) {
                  const Dense K = strictly_upper(r, n);
                  return Dense(K - K.transpose());
                }},
    MatrixClass{"QP, KKT", [](Rng& r, Index n) { return saddle(r, n, true); }},
    MatrixClass{"LP, KKT", [](Rng& r, Index n) { return saddle(r, n, false); }},
    MatrixClass{"bimatrix",
                [](Rng& r, Index n) {
                  const Index m = n / 2;
                  const Dense A = entries(r, m, n - m, 90).cwiseAbs();
                  const Dense B = entries(r, n - m, m, 90).cwiseAbs();
                  return blocks(Dense::Zero(m, m), A, B, Dense::Zero(n - m, n - m));
                }},
    MatrixClass{"nilpotent", [](Rng& r, Index n) { return permuted(r, strictly_upper(r, n)); }},
    MatrixClass{"zero", [](Rng&, Index n) { return Dense(Dense::Zero(n, n)); }},
    MatrixClass{"diagonal", [](Rng& r, Index n) { return Dense(entries(r, n, 1, 80).col(0).asDiagonal()); }},
    MatrixClass{"block triangular",
                [](Rng& r, Index n) {
                  const Index m = n / 2;
                  const Dense A = entries(r, m, m, 90);
                  const Dense B = entries(r, m, n - m, 50);
                  return permuted(r, blocks(A, B, Dense::Zero(n - m, m), entries(r, n - m, n - m, 90)));
                }},
    MatrixClass{"nearly dependent rows", nearly_dependent},
    MatrixClass{"nearly dependent columns", [](Rng& r, Index n) { return Dense(nearly_dependent(r, n).transpose()); }},
    MatrixClass{"rank one",
                [](Rng& r, Index n) {
                  const Dense column = entries(r, n, 1, 80);
                  return Dense(column * entries(r, 1, n, 80));
                }},
    MatrixClass{"graded", graded},
};

enum class Side { Lower, Upper, Both, Free, Fixed, Narrow };

Side draw_side(Rng& r, int kind) {
  if (kind == 0) return Side::Lower;  // an LCP, perhaps with other bounds than 0
  if (kind == 1) return r.chance(50) ? Side::Both : Side::Narrow;
  if (kind == 2) return r.chance(70) ? Side::Lower : Side::Free;
  return static_cast<Side>(r.integer(0, 5));
}

/// Bounds of few digits, around 0 or not; z and w on them, both exact.
struct Plan {
  Box box;
  Vec z;
  Vec w;
};

Plan plan(Rng& r, Index n) {
  Plan p{{Vec::Constant(n, -infinity), Vec::Constant(n, infinity)}, Vec::Zero(n), Vec::Zero(n)};
  const int kind = r.integer(0, 4);
  const int degenerate = std::array{0, 0, 30, 80}[at(r.integer(0, 3))];
  const int inside = std::array{10, 50, 50, 90}[at(r.integer(0, 3))];
  const bool zero_bounds = r.chance(60);
  const bool huge = r.chance(15);  // forces and points of very different sizes
  const bool tiny = r.chance(15);
  for (Index i = 0; i < n; ++i) {
    const Side side = draw_side(r, kind);
    const double bound = zero_bounds || r.chance(30) ? 0 : r.digits(4);
    const double width = side == Side::Narrow ? std::ldexp(1, -r.integer(20, 34)) : 0.25 * r.integer(1, 16);
    const bool low = side != Side::Upper && side != Side::Free;
    const bool high = side != Side::Lower && side != Side::Free;
    if (low) p.box.lower[i] = bound;
    if (high) p.box.upper[i] = side == Side::Fixed ? bound : low ? bound + width : bound;
    double size = r.chance(degenerate) ? 0 : std::abs(r.digits(4)) + 0.25;
    if (huge && r.chance(40)) size = std::ldexp(size, r.integer(20, 36));
    if (tiny && r.chance(40)) size = std::ldexp(size, -r.integer(20, 36));
    if (side == Side::Fixed) {
      p.z[i] = bound;
      p.w[i] = r.chance(50) ? size : -size;
    } else if (side == Side::Free) {
      p.z[i] = r.digits(4);
    } else if (r.chance(inside)) {
      const double way = low && high ? width * 0.5 : 0.25 * r.integer(1, 16);
      p.z[i] = low ? p.box.lower[i] + way : p.box.upper[i] - way;
    } else {
      const bool at_lower = low && (!high || r.chance(50));
      p.z[i] = at_lower ? p.box.lower[i] : p.box.upper[i];
      p.w[i] = at_lower ? size : -size;
    }
  }
  return p;
}

/// w - M z if doubles hold it.
std::optional<Vec> exact_q(const Dense& M, const Vec& z, const Vec& w) {
  Vec q(z.size());
  for (Index i = 0; i < z.size(); ++i) {
    ExactSum sum;
    sum.add(w[i]);
    for (Index j = 0; j < z.size(); ++j) sum.add_product(-M(i, j), z[j]);
    q[i] = sum.value();
    sum.add(-q[i]);
    if (!sum.exact() || sum.sign() != 0) return std::nullopt;
  }
  return q;
}

/// y with the signs that the box asks for, rows of M changed so that M'y has the sign that bounds z_j'(M'y)_j by 0 or
/// a finite bound, and q with q'y below minus all these.
std::optional<Vec> make_unsolvable(Rng& r, Dense& M, Vec& q, const Box& box) {
  const Index n = q.size();
  Vec y = Vec::Zero(n);
  Index last = -1;
  for (Index i = 0; i < n; ++i) {
    const bool low = std::isfinite(box.lower[i]);
    const bool high = std::isfinite(box.upper[i]);
    if ((low && high) || !(last < 0 || r.chance(50))) continue;
    const double size = std::ldexp(1, r.integer(-2, 2));
    y[i] = low ? size : high || r.chance(50) ? -size : size;
    last = i;
  }
  if (last < 0) return std::nullopt;
  Vec g = M.transpose() * y;
  for (Index j = 0; j < n; ++j) {
    const bool low = std::isfinite(box.lower[j]);
    const bool high = std::isfinite(box.upper[j]);
    if (low && high) continue;
    const double slack = r.chance(40) ? 0.25 * r.integer(1, 8) : 0;
    const double wanted = low ? -slack : high ? slack : 0;
    if (low ? g[j] > 0 : high ? g[j] < 0 : g[j] != 0) M(last, j) += (wanted - g[j]) / y[last];
  }
  g = M.transpose() * y;
  double sup = q.dot(y);
  for (Index j = 0; j < n; ++j)
    if (g[j] != 0) sup += g[j] * (g[j] > 0 ? box.upper[j] : box.lower[j]);
  const double margin = std::ldexp(1, r.chance(60) ? 0 : -r.integer(1, 30));
  q[last] -= (sup + margin) / y[last];
  return y;
}

Vec powers(Rng& r, Index n, int exponent) {
  return Vec::NullaryExpr(n, [&] { return std::ldexp(1, r.integer(-exponent, exponent)); });
}

/// E M D, E q, D^-1 box, with powers of two: exact.
void scale(Problem& p, const Vec& rows, const Vec& columns) {
  p.mcp.M = rows.asDiagonal() * p.mcp.M * columns.asDiagonal();
  p.mcp.q = rows.cwiseProduct(p.mcp.q);
  p.mcp.box = {p.mcp.box.lower.cwiseQuotient(columns), p.mcp.box.upper.cwiseQuotient(columns)};
  p.start = p.start.cwiseQuotient(columns);
  if (p.solution) p.solution = p.solution->cwiseQuotient(columns);
  if (p.certificate) {
    p.certificate = p.certificate->cwiseQuotient(rows);
    *p.certificate /= p.certificate->lpNorm<Eigen::Infinity>();
  }
}

/// Which of E and D are drawn, each factor from 2^-size to 2^size.
std::string draw_scales(Rng& r, Problem& p) {
  const Index n = p.mcp.size();
  const Vec one = Vec::Ones(n);
  const int kind = r.integer(0, 11);
  const int size = kind < 6 ? r.integer(1, 60) : 340;
  const Vec first = powers(r, n, size);
  const Vec second = powers(r, n, kind == 7 ? r.integer(0, 340) : size);
  const std::string by = " by 2^" + std::to_string(size);
  switch (kind) {
    case 0:
    case 6:
      scale(p, first, second);
      return "rows and columns" + by;
    case 1:
      scale(p, first, one);
      return "rows" + by;
    case 2:
      scale(p, one, second);
      return "columns" + by;
    case 3:
      scale(p, first, first);
      return "symmetric" + by;
    case 4:
      scale(p, one * first[0], one);
      return "M and q" + by;
    case 5:
      scale(p, one, one * first[0]);
      return "z" + by;
    case 7:
      scale(p, one * first[0], second);
      return "M and q, columns" + by;
    default:
      return "not scaled";
  }
}

/// Small problems from reports, and their kin.
Problem by_hand(Rng& r) {
  const double big = r.chance(30) ? 1e9 : r.chance(50) ? 1e12 : std::ldexp(1, r.integer(10, 60));
  const double little = r.chance(30) ? 0.0009 : std::ldexp(std::abs(r.digits(4)) + 0.25, -r.integer(0, 30));
  Dense M = Dense::Identity(2, 2);
  Vec q(2);
  q << big, -little;
  Box box = Box::nonnegative(2);
  Vec z(2);
  z << 0, little;
  switch (r.integer(0, 4)) {
    case 0:
      break;
    case 1:  // a narrow box, F = -little in it
      box = {Vec::Zero(2), Vec::Constant(2, 1e-9)};
      z << 0, std::min(1e-9, little);
      break;
    case 2:  // exp(x) = 0 linearized: next to nothing, but not nothing
      M(1, 1) = std::ldexp(1, -r.integer(10, 60));
      z << 0, std::ldexp(little, -std::ilogb(M(1, 1)));
      break;
    case 3:
      box = Box::free(2);
      z << -big, little;
      break;
    case 4:
      M(0, 1) = -std::ldexp(1, r.integer(0, 20));
      q[0] = big;
      z[1] = little;
      if (big + M(0, 1) * little < 0) M(0, 1) = 0;
      break;
  }
  return {"by hand", {M.sparseView(), q, box}, Vec::Zero(2), z, std::nullopt};
}

Problem planted(Rng& r, const MatrixClass& matrices) {
  for (int attempt = 0;; ++attempt) {
    const Index n = r.chance(85) ? r.integer(1, 7) : r.integer(8, 12);
    const Dense M = matrices.make(r, n);
    const Plan p = plan(r, n);
    const auto q = exact_q(M, p.z, p.w);
    if (!q) continue;
    return {"planted", {M.sparseView(), *q, p.box}, Vec::Zero(n), p.z, std::nullopt};
  }
}

Problem unplanted(Rng& r, const MatrixClass& matrices) {
  const Index n = r.integer(1, 7);
  Dense M = matrices.make(r, n);
  const bool full = r.chance(40);
  if (full) M = M.unaryExpr([&](double a) { return a == 0 ? 0 : a * (1 + std::ldexp(std::abs(r.full()), -4)); });
  const Vec q = Vec::NullaryExpr(n, [&] { return full ? r.full() : r.chance(30) ? 0 : r.digits(4); });
  return {full ? "random, all digits" : "random", {M.sparseView(), q, plan(r, n).box}, Vec::Zero(n), {}, {}};
}

Problem unsolvable(Rng& r, const MatrixClass& matrices) {
  for (;;) {
    const Index n = r.chance(85) ? r.integer(1, 7) : r.integer(8, 12);
    Dense M = matrices.make(r, n);
    Vec q = Vec::NullaryExpr(n, [&] { return r.digits(4); });
    const Box box = plan(r, n).box;
    if (const auto y = make_unsolvable(r, M, q, box))
      return {"unsolvable", {M.sparseView(), q, box}, Vec::Zero(n), {}, y};
  }
}

}  // namespace

Problem make(std::uint64_t seed) {
  Rng r(seed * 0x9e3779b97f4a7c15U + 1);
  const MatrixClass& matrices =
      matrix_classes[static_cast<std::size_t>(r.integer(0, static_cast<int>(matrix_classes.size()) - 1))];
  const int kind = r.integer(1, 100);
  Problem p = kind <= 5    ? by_hand(r)
              : kind <= 65 ? planted(r, matrices)
              : kind <= 77 ? unsolvable(r, matrices)
                           : unplanted(r, matrices);
  if (r.chance(50)) p.start = Vec::NullaryExpr(p.mcp.size(), [&] { return r.digits(4); });
  const std::string scales = draw_scales(r, p);
  p.what = "seed " + std::to_string(seed) + ", " + p.what + (kind <= 5 ? "" : std::string(", ") + matrices.name) +
           ", n = " + std::to_string(p.mcp.size()) + ", " + scales;
  return p;
}

}  // namespace perp::lcp::adversarial
