// SPDX-License-Identifier: Apache-2.0
/// Systems of equations F(x) = 0, x free, of More, Garbow & Hillstrom 1981, ACM Trans. Math. Software 7, 17-41,
/// numbered as there, each from the standard start x0, from 10 x0 and from 100 x0; and complementarity problems of our
/// own made of them.
#include <cmath>
#include <numbers>

#include "collection/base/build.hpp"
#include "collection/models/problems.hpp"

namespace perp::ncp::collection {

namespace {

SpMat banded_pattern(Index n, Index below, Index above) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Index j = 0; j < n; ++j)
    for (Index i = std::max<Index>(0, j - above); i <= std::min(n - 1, j + below); ++i) entries.emplace_back(i, j, 1.0);
  SpMat made(n, n);
  made.setFromTriplets(entries.begin(), entries.end());
  return made;
}

/// F = f from x0, 10 x0, 100 x0.
template <class Fn>
Problem system(std::string name, const Vec& x0, Fn f, SpMat pattern = {}) {
  const Index n = x0.size();
  Problem p;
  p.mcp = make_problem({std::move(name), free_box(n), indexed("x", n), {}, std::move(pattern)}, f);
  p.starts = {x0, 10 * x0, 100 * x0};
  return p;
}

template <class T>
T square(const T& u) {
  return u * u;
}

/// arctan(x2 / x1) / (2 pi), and 1/2 more where x1 < 0: the book's branch, in (-1/4, 3/4]. By the angle from the second
/// axis, so that x1 = 0 < x2 is no pole, and the cut is at x1 = 0 > x2.
template <class T>
T turn(const T& x1, const T& x2) {
  using std::atan2;
  return 0.25 - atan2(x1, x2) / (2 * std::numbers::pi);
}

/// (t_i) = i h, h = 1 / (n + 1), and the start x_i = t_i (t_i - 1) of the two-point problems 28 and 29.
double node(Index i, Index n) { return static_cast<double>(i) / static_cast<double>(n + 1); }
Vec parabola(Index n) {
  Vec x0(n);
  for (Index i = 1; i <= n; ++i) x0[i - 1] = node(i, n) * (node(i, n) - 1);
  return x0;
}

/// 2 x_i - x_{i-1} - x_{i+1} + h^2 (x_i + t_i + 1)^3 / 2, x_0 = x_{n+1} = 0.
constexpr auto boundary_value = [](const auto& x, const auto& F) {
  const Index n = x.size();
  const double h = node(1, n);
  for (Index i = 0; i < n; ++i) {
    const auto s = x[i] + node(i + 1, n) + 1;
    F[i] = 2 * x[i] + 0.5 * h * h * s * s * s;
    if (i > 0) F[i] -= x[i - 1];
    if (i + 1 < n) F[i] -= x[i + 1];
  }
};

/// (3 - 2 x_i) x_i - x_{i-1} - 2 x_{i+1} + 1
constexpr auto broyden = [](const auto& x, const auto& F) {
  const Index n = x.size();
  for (Index i = 0; i < n; ++i) {
    F[i] = (3 - 2 * x[i]) * x[i] + 1;
    if (i > 0) F[i] -= x[i - 1];
    if (i + 1 < n) F[i] -= 2 * x[i + 1];
  }
};

/// n - sum_j cos x_j + i (1 - cos x_i) - sin x_i
constexpr auto trigonometric_sums = [](const auto& x, const auto& F) {
  using std::cos, std::sin;
  const Index n = x.size();
  auto sum = cos(x[0]);
  for (Index i = 1; i < n; ++i) sum += cos(x[i]);
  for (Index i = 0; i < n; ++i)
    F[i] = static_cast<double>(n) - sum + static_cast<double>(i + 1) * (1 - cos(x[i])) - sin(x[i]);
};

/// 0 <= x _|_ f(x) - f(x*) + s >= 0 with x* = (1, 0, 1, 0, ...), and s = 1 in every other of the rows where x* = 0: in
/// the rest of them x_i = F_i = 0.
template <class Fn>
Problem planted_ncp(std::string name, Index n, Fn f, SpMat pattern = {}) {
  Vec x(n), shift(n);
  for (Index i = 0; i < n; ++i) x[i] = i % 2 == 0 ? 1 : 0;
  f(Row<const double>(x.data(), n), Row<double>(shift.data(), n));
  for (Index i = 1; i < n; i += 4) shift[i] -= 1;
  Problem p;
  p.mcp = make_problem({std::move(name), Box::nonnegative(n), indexed("x", n), {}, std::move(pattern)},
                       [f, shift](const auto& at, const auto& F) {
                         f(at, F);
                         for (Index i = 0; i < at.size(); ++i) F[i] -= shift[i];
                       });
  p.starts = {Vec::Zero(n), Vec::Ones(n), Vec::Constant(n, 10)};
  p.solutions = {{"planted", x, 0}};
  return p;
}

}  // namespace

/// 1: 10 (x2 - x1^2), 1 - x1
Problem rosenbrock() {
  Problem p = system("rosenbrock", vec({-1.2, 1}), [](const auto& x, const auto& F) {
    F[0] = 10 * (x[1] - x[0] * x[0]);
    F[1] = 1 - x[0];
  });
  p.solutions = {{"unique", vec({1, 1}), 0}};
  p.solutions_complete = true;
  return p;
}

/// 13: x1 + 10 x2, sqrt 5 (x3 - x4), (x2 - 2 x3)^2, sqrt 10 (x1 - x4)^2: two singular values of J vanish at 0.
Problem powell_singular() {
  Problem p = system("powell-singular", vec({3, -1, 0, 1}), [](const auto& x, const auto& F) {
    F[0] = x[0] + 10 * x[1];
    F[1] = std::sqrt(5.0) * (x[2] - x[3]);
    F[2] = square(x[1] - 2 * x[2]);
    F[3] = std::sqrt(10.0) * square(x[0] - x[3]);
  });
  p.solutions = {{"unique", Vec::Zero(4), 0}};
  p.solutions_complete = true;
  return p;
}

/// 3: 10^4 x1 x2 - 1, exp(-x1) + exp(-x2) - 1.0001: two solutions, mirror images of each other. (x1 x2 > 0; both
/// negative makes F2 > 0.9; from 0.01 on F2 along x1 = 1e-4 / x2 falls through 0 once and rises to -1e-4 only.)
Problem powell_badly_scaled() {
  Problem p = system("powell-badly-scaled", vec({0, 1}), [](const auto& x, const auto& F) {
    using std::exp;
    F[0] = 1e4 * x[0] * x[1] - 1;
    F[1] = exp(-x[0]) + exp(-x[1]) - 1.0001;
  });
  p.solutions = {{"x1 small", vec({1.0981593296998153e-05, 9.106146739866542}), 1e-13},
                 {"x2 small", vec({9.106146739866542, 1.0981593296998153e-05}), 1e-13}};
  p.solutions_complete = true;
  return p;
}

/// 7: 10 (x3 - 10 theta(x1, x2)), 10 (|(x1, x2)| - 1), x3, theta the angle in turns.
Problem helical_valley() {
  Problem p = system("helical-valley", vec({-1, 0, 0}), [](const auto& x, const auto& F) {
    using std::sqrt;
    F[0] = 10 * (x[2] - 10 * turn(x[0], x[1]));
    F[1] = 10 * (sqrt(x[0] * x[0] + x[1] * x[1]) - 1);
    F[2] = x[2];
  });
  p.solutions = {{"unique", vec({1, 0, 0}), 0}};
  p.solutions_complete = true;
  return p;
}

/// 14, the gradient of Wood's function, halved: HS38 without its bounds.
Problem wood() {
  Problem p = system("wood", vec({-3, -1, -3, -1}), [](const auto& x, const auto& F) {
    const auto t1 = x[1] - x[0] * x[0], t2 = x[3] - x[2] * x[2];
    F[0] = -200 * x[0] * t1 - (1 - x[0]);
    F[1] = 100 * t1 + 10.1 * (x[1] - 1) + 9.9 * (x[3] - 1);
    F[2] = -180 * x[2] * t2 - (1 - x[2]);
    F[3] = 90 * t2 + 10.1 * (x[3] - 1) + 9.9 * (x[1] - 1);
  });
  p.solutions = {{"minimum", Vec::Ones(4), 0}};
  return p;
}

/// 35, n = 7: (1/n) sum_j T_i(x_j) - integral of T_i over [0, 1], T_i Chebyshev's polynomials shifted to [0, 1]: the
/// nodes of a quadrature with equal weights, in any order.
Problem chebyquad() {
  constexpr Index n = 7;
  Vec x0(n);
  for (Index i = 1; i <= n; ++i) x0[i - 1] = node(i, n);
  Problem p = system("chebyquad", x0, [](const auto& x, const auto& F) {
    for (Index i = 1; i <= n; ++i) F[i - 1] = i % 2 == 0 ? 1 / (static_cast<double>(i * i) - 1) : 0.0;
    for (Index j = 0; j < n; ++j) {
      const auto y = 2 * x[j] - 1;
      auto before = 0 * y + 1, now = y;
      for (Index i = 0; i < n; ++i) {
        F[i] += now / static_cast<double>(n);
        const auto next = 2 * y * now - before;
        before = now;
        now = next;
      }
    }
  });
  p.solutions = {{"the nodes",
                  vec({0.058069149620975494, 0.3380440947400462, 0.2351716123574216, 0.5, 0.7648283876425784,
                       0.6619559052599538, 0.9419308503790246}),
                  1e-14}};
  return p;
}

/// 27, n = 10: x_i + sum_j x_j - (n + 1), i < n; prod_j x_j - 1. With x_1 = .. = x_{n-1} = a, x_n = n + 1 - n a, real
/// roots of a^(n-1) (n + 1 - n a) = 1.
Problem brown_almost_linear() {
  constexpr Index n = 10;
  Problem p = system("brown-almost-linear", Vec::Constant(n, 0.5), [](const auto& x, const auto& F) {
    auto sum = x[0], product = x[0];
    for (Index j = 1; j < n; ++j) {
      sum += x[j];
      product *= x[j];
    }
    for (Index i = 0; i + 1 < n; ++i) F[i] = x[i] + sum - (n + 1);
    F[n - 1] = product - 1;
  });
  Vec other = Vec::Constant(n, 0.97943030334986245);
  other[n - 1] = n + 1 - n * other[0];
  p.solutions = {{"all 1", Vec::Ones(n), 0}, {"a < 1", other, 1e-13}};
  return p;
}

/// 28, n = 10: see boundary_value. J is an M-matrix everywhere: one solution.
Problem discrete_boundary_value() {
  Problem p = system("discrete-boundary-value", parabola(10), boundary_value, banded_pattern(10, 1, 1));
  p.solutions = {{"unique",
                  vec({-0.043164982518764876, -0.08157715653538689, -0.11448571438052929, -0.14097357686259668,
                       -0.15990869618198314, -0.16987720231277492, -0.16908998378120838, -0.15524953522183185,
                       -0.12535589167893502, -0.0754165336858921}),
                  1e-14}};
  p.solutions_complete = true;
  return p;
}

/// 29, n = 10: x_i + (h / 2) ((1 - t_i) sum_{j <= i} t_j (x_j + t_j + 1)^3 + t_i sum_{j > i} (1 - t_j)(x_j + t_j +
/// 1)^3).
Problem discrete_integral_equation() {
  constexpr Index n = 10;
  Problem p = system("discrete-integral-equation", parabola(n), [](const auto& x, const auto& F) {
    const double h = node(1, n);
    for (Index i = 0; i < n; ++i) {
      const double ti = node(i + 1, n);
      F[i] = x[i];
      for (Index j = 0; j < n; ++j) {
        const double tj = node(j + 1, n);
        const auto s = x[j] + tj + 1;
        F[i] += 0.5 * h * (j <= i ? (1 - ti) * tj : ti * (1 - tj)) * s * s * s;
      }
    }
  });
  p.solutions = {{"that of the boundary value problem",
                  vec({-0.043164982518764876, -0.08157715653538689, -0.11448571438052926, -0.14097357686259668,
                       -0.1599086961819831, -0.16987720231277492, -0.16908998378120838, -0.15524953522183182,
                       -0.125355891678935, -0.0754165336858921}),
                  1e-14}};
  return p;
}

/// 26, n = 10: see trigonometric_sums. Several solutions, 0 among them.
Problem trigonometric() {
  constexpr Index n = 10;
  Problem p = system("trigonometric", Vec::Constant(n, 1.0 / n), trigonometric_sums);
  p.solutions = {{"zero", Vec::Zero(n), 0}};
  return p;
}

/// 25 as a square system, n = 10: x_i - 1 + i (s + 2 s^3), s = sum_j j (x_j - 1): the gradient of a convex function,
/// halved.
Problem variably_dimensioned() {
  constexpr Index n = 10;
  Vec x0(n);
  for (Index i = 1; i <= n; ++i) x0[i - 1] = 1 - static_cast<double>(i) / n;
  Problem p = system("variably-dimensioned", x0, [](const auto& x, const auto& F) {
    auto s = x[0] - 1;
    for (Index j = 1; j < n; ++j) s += static_cast<double>(j + 1) * (x[j] - 1);
    const auto slope = s * (1 + 2 * s * s);
    for (Index i = 0; i < n; ++i) F[i] = x[i] - 1 + static_cast<double>(i + 1) * slope;
  });
  p.solutions = {{"unique", Vec::Ones(n), 0}};
  p.solutions_complete = true;
  return p;
}

/// 30, n = 10: see broyden.
Problem broyden_tridiagonal() {
  Problem p = system("broyden-tridiagonal", Vec::Constant(10, -1), broyden, banded_pattern(10, 1, 1));
  p.solutions = {
      {"near x0",
       vec({-0.5707221320112248, -0.6818069499842752, -0.7022100760176601, -0.7055106298950804, -0.7049061557287437,
            -0.7014966070298512, -0.6918893223547983, -0.6657965144058537, -0.5960351090263657, -0.4164122575286933}),
       1e-14}};
  return p;
}

/// 31, n = 10: x_i (2 + 5 x_i^2) + 1 - sum_{j in J_i} x_j (1 + x_j), J_i = {j != i: i - 5 <= j <= i + 1}.
Problem broyden_banded() {
  constexpr Index n = 10;
  Problem p = system(
      "broyden-banded", Vec::Constant(n, -1),
      [](const auto& x, const auto& F) {
        for (Index i = 0; i < n; ++i) {
          F[i] = x[i] * (2 + 5 * x[i] * x[i]) + 1;
          for (Index j = std::max<Index>(0, i - 5); j <= std::min(n - 1, i + 1); ++j)
            if (j != i) F[i] -= x[j] * (1 + x[j]);
        }
      },
      banded_pattern(n, 5, 1));
  p.solutions = {
      {"near x0",
       vec({-0.4283028635872503, -0.47659642435629024, -0.5196524636468618, -0.5580993248321809, -0.5925061568294574,
            -0.624503682199468, -0.6232394714405911, -0.6213938417965735, -0.6204535966590874, -0.586469270720435}),
       1e-14}};
  return p;
}

/// Chandrasekhar's H-equation for isotropic scattering by the midpoint rule, t_i = (i - 1/2) / n, n = 50, with albedo
/// c:
///     x_i - 1 / (1 - (c / 2n) sum_j t_i x_j / (t_i + t_j)) = 0.
/// J is singular at the solution for c = 1. (Chandrasekhar 1960; Kelley 1995, section 5.6.)
Problem chandrasekhar(std::string name, double c) {
  constexpr Index n = 50;
  Problem p = system(std::move(name), Vec::Ones(n), [c](const auto& x, const auto& F) {
    for (Index i = 0; i < n; ++i) {
      auto sum = 0 * x[0];
      for (Index j = 0; j < n; ++j) sum += (static_cast<double>(i) + 0.5) / static_cast<double>(i + j + 1) * x[j];
      F[i] = x[i] - 1 / (1 - 0.5 * c / n * sum);
    }
  });
  p.starts = {Vec::Ones(n), Vec::Zero(n), Vec::Constant(n, 10)};
  return p;
}

Problem broyden_ncp_own() { return planted_ncp("broyden-ncp-own", 40, broyden, banded_pattern(40, 1, 1)); }
Problem trigonometric_ncp_own() { return planted_ncp("trigonometric-ncp-own", 20, trigonometric_sums); }

/// The boundary value problem 28 above an obstacle: x_i >= -0.1 sin(pi t_i)^2 - 0.02 for n = 50. J is a symmetric
/// M-matrix everywhere: one solution.
Problem boundary_value_obstacle_own() {
  constexpr Index n = 50;
  Box box{Vec(n), Vec::Constant(n, infinity)};
  for (Index i = 0; i < n; ++i) {
    const double bump = std::sin(std::numbers::pi * node(i + 1, n));
    box.lower[i] = -0.1 * bump * bump - 0.02;
  }
  Problem p;
  p.mcp =
      make_problem({"boundary-value-obstacle-own", box, indexed("x", n), {}, banded_pattern(n, 1, 1)}, boundary_value);
  p.starts = {Vec::Zero(n), parabola(n), Vec::Constant(n, 10), 100 * parabola(n)};
  return p;
}

}  // namespace perp::ncp::collection
