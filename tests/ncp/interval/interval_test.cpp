// SPDX-License-Identifier: Apache-2.0
#include "ncp/interval/interval.hpp"

#include <gmpxx.h>
#include <gtest/gtest.h>
#include <mpfr.h>

#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <string>

namespace perp::ncp {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

/// Ends of every size and sign, small integers (whose results are exact), and tiny and huge ones.
double random_end(std::mt19937_64& random) {
  std::uniform_int_distribution<int> kind(0, 9);
  std::uniform_real_distribution<double> value(-2, 2);
  std::uniform_int_distribution<int> exponent(-1070, 1020), small(-3, 3);
  switch (kind(random)) {
    case 0:
      return small(random);
    case 1:
      return std::ldexp(value(random), exponent(random));
    case 2:
      return std::ldexp(value(random), exponent(random) / 100);
    default:
      return value(random);
  }
}

Interval random_interval(std::mt19937_64& random) {
  const double a = random_end(random), b = random_end(random);
  return {std::min(a, b), std::max(a, b)};
}

/// One of the ends, or a number between them.
double member(std::mt19937_64& random, const Interval& a) {
  std::uniform_int_distribution<int> which(0, 3);
  std::uniform_real_distribution<double> part(0, 1);
  const int k = which(random);
  return k == 0   ? a.lower
         : k == 1 ? a.upper
                  : std::clamp(a.lower + part(random) * (a.upper - a.lower), a.lower, a.upper);
}

bool holds(const Interval& range, const mpq_class& value) {
  return (range.lower == -inf || mpq_class(range.lower) <= value) &&
         (range.upper == inf || value <= mpq_class(range.upper));
}

// Moore, Kearfott & Cloud (2009), section 2.2: containment, here in rational arithmetic. Catches an end that is rounded
// inward, and products of the wrong ends.
TEST(Interval, ContainsWhatItsMembersGive) {
  std::mt19937_64 random(1);
  for (int k = 0; k < 20000; ++k) {
    const Interval A = random_interval(random), B = random_interval(random);
    const double a = member(random, A), b = member(random, B);
    const mpq_class p(a), q(b);
    ASSERT_TRUE(holds(A + B, p + q)) << a << " + " << b;
    ASSERT_TRUE(holds(A - B, p - q)) << a << " - " << b;
    ASSERT_TRUE(holds(A * B, p * q)) << a << " * " << b;
    ASSERT_TRUE(holds(square(A), p * p)) << a;
    if (b != 0) {
      ASSERT_TRUE(holds(A / B, p / q)) << a << " / " << b;
    }
    ASSERT_TRUE(holds(power(A, 3), p * p * p)) << a;
    ASSERT_TRUE(holds(power(A, 4), p * p * p * p)) << a;
    if (a != 0) {
      ASSERT_TRUE(holds(power(A, -2), 1 / (p * p))) << a;
    }
    ASSERT_TRUE(holds(minimum(A, B), std::min(p, q)));
    ASSERT_TRUE(holds(maximum(A, B), std::max(p, q)));
    ASSERT_TRUE(holds(absolute(A), abs(p)));
    ASSERT_TRUE(holds(hull(A, B), p) && holds(hull(A, B), q));
  }
}

// Near the largest double, where the steps of Knuth's two-sum overflow although the sum does not, and its error is no
// number. Catches a sum that passes for exact there.
TEST(Interval, AddsNumbersNearTheLargest) {
  const double largest = std::numeric_limits<double>::max();
  for (const double a : {0x1.8p+971, 0x1.88f8f467b65b8p+1019, 0x1.76a6be5a6fc07p+1022, 0x1p970, 0x1.8p969, 1e292})
    for (const double b : {largest, std::nextafter(largest, 0), largest / 2}) {
      EXPECT_TRUE(holds(Interval(a) - Interval(b), mpq_class(a) - mpq_class(b))) << a << " - " << b;
      EXPECT_TRUE(holds(Interval(b) - Interval(a), mpq_class(b) - mpq_class(a))) << b << " - " << a;
    }
}

// No wider than one rounding a side. Catches ranges that are right and of no use: proofs of classes need 1 - 1 = 0.
TEST(Interval, IsTight) {
  EXPECT_EQ(Interval(0.5) + Interval(0.25), Interval(0.75));
  EXPECT_EQ(Interval(3) * Interval(-7), Interval(-21));
  EXPECT_EQ(Interval(1) - Interval(1), Interval(0));
  EXPECT_EQ(Interval(0) * Interval::all(), Interval(0));
  const Interval third = Interval(1) / Interval(3);
  EXPECT_EQ(std::nextafter(third.lower, 1), third.upper);
  const Interval sum = Interval(0.1) + Interval(0.2);
  EXPECT_EQ(std::nextafter(sum.lower, 1), sum.upper);
  EXPECT_EQ(power(Interval(-2, 3), 2), Interval(0, 9));
  EXPECT_EQ(Interval(-1, 2) * Interval(-3, 4), Interval(-6, 8));
}

// Ends that are no numbers: sums and products of infinite ends, overflow, quotients by 0. Catches a NaN, and an
// infinity where the largest double belongs.
TEST(Interval, TakesInfiniteEnds) {
  const double largest = std::numeric_limits<double>::max();
  EXPECT_EQ(Interval(1, inf) + Interval(-inf, 2), Interval::all());
  EXPECT_EQ(Interval(0, inf) - Interval(0, inf), Interval::all());
  EXPECT_EQ(Interval(1, inf) * Interval(-2, -1), Interval(-inf, -1));
  EXPECT_EQ(Interval(largest) + Interval(largest), Interval(largest, inf));
  EXPECT_EQ(Interval(largest) * Interval(-2), Interval(-inf, -largest));
  EXPECT_EQ(Interval(1) / Interval(-1, 1), Interval::all());
  EXPECT_EQ(Interval(1, 2) / Interval(0, 4), Interval(0.25, inf));
  EXPECT_TRUE((Interval(1) / Interval(0)).is_empty());
  EXPECT_EQ(exp(Interval(-inf, 0)), Interval(0, 1));
  EXPECT_EQ(exp(Interval::all()), Interval(0, inf));
  EXPECT_EQ(log(Interval(0, inf)), Interval::all());
}

// Outside of where a function is defined there is nothing to hold. Catches a NaN that becomes a range.
TEST(Interval, LeavesOutWhereAFunctionIsNotDefined) {
  EXPECT_EQ(sqrt(Interval(-4, 4)), Interval(0, 2));
  EXPECT_TRUE(sqrt(Interval(-4, -1)).is_empty());
  EXPECT_EQ(log(Interval(-1, 1)), Interval(-inf, 0));
  EXPECT_TRUE(log(Interval(-1, 0)).is_empty());
  EXPECT_TRUE(acosh(Interval(-1, 0.5)).is_empty());
  EXPECT_TRUE((Interval::empty() + Interval(1)).is_empty());
  EXPECT_TRUE((Interval::empty() * Interval(0)).is_empty());
  EXPECT_TRUE(power(Interval(-2, -1), 0.5).is_empty());
  EXPECT_EQ(power(Interval(-2, -1), Interval(0, 3)), Interval::all());
  EXPECT_EQ(power(Interval(0, 4), 0.5).lower, 0);
  EXPECT_TRUE(power(Interval(0, 4), 0.5).contains(2));
}

// 0^0 = 1, as C and AMPL evaluate it. Catches a proof that x^y = 1 has no solution at x = 0, of which y = 0 is one.
TEST(Interval, TakesZeroToTheZerothForOne) {
  EXPECT_EQ(power(Interval(0), Interval(0, 1)), Interval(0, 1));
  EXPECT_EQ(power(Interval(0), Interval(-2, 0)), Interval(1));
  EXPECT_TRUE(power(Interval(0, 0.5), Interval(0, 2)).contains(1));
  EXPECT_EQ(power(Interval(0), Interval(0.5, 1)), Interval(0));
}

// On the half line y = 0 >= x atan2 jumps from pi to -pi. MPFI has -pi to -pi/2 for y in [-1, 0] at x = -1. Catches a
// range without the value at the end y = 0, from which "no solution" was concluded where there is one.
TEST(Interval, HoldsBothSidesOfTheCutOfAtan2) {
  for (const double x : {-1.0, -0.0, 0.0})
    for (const Interval& y : {Interval(-1, 0), Interval(0, 1), Interval(0), Interval(-1, 1)})
      for (const double end : {-0.0, 0.0, y.lower, y.upper})
        EXPECT_TRUE(atan2(y, x).contains(std::atan2(end, x))) << end << ", " << x;
  EXPECT_LT(atan2(Interval(-1, 0), Interval(1, 2)).upper, 1e-300);
  std::mt19937_64 random(3);
  mpfr_t y, x;
  mpfr_inits2(200, y, x, nullptr);
  for (int k = 0; k < 20000; ++k) {
    const Interval Y = random_interval(random), X = random_interval(random);
    const double b = member(random, Y), a = member(random, X);
    mpfr_set_d(y, b, MPFR_RNDN), mpfr_set_d(x, a, MPFR_RNDN);
    mpfr_atan2(y, y, x, MPFR_RNDN);
    const Interval range = atan2(Y, X);
    ASSERT_TRUE(mpfr_cmp_d(y, range.lower) >= 0 && mpfr_cmp_d(y, range.upper) <= 0) << b << ", " << a;
  }
  mpfr_clears(y, x, nullptr);
}

struct Function {
  const char* name;
  Interval (*range)(const Interval&);
  int (*exact)(mpfr_t, const mpfr_t, mpfr_rnd_t);
  double from, to;
};

class Elementary : public testing::TestWithParam<Function> {};

// At 200 bits (MPFR). Catches two functions mixed up, and a monotone piece that ends in the wrong place.
TEST_P(Elementary, ContainsWhatItsMembersGive) {
  const Function& f = GetParam();
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> value(f.from, f.to);
  mpfr_t y;
  mpfr_init2(y, 200);
  for (int k = 0; k < 3000; ++k) {
    double from = value(random), to = value(random);
    if (from > to) std::swap(from, to);
    if (k % 3 == 0) to = std::min(f.to, from + 1e-8 * std::abs(from));
    const Interval A(from, to);
    const Interval range = f.range(A);
    for (const double a : {from, to, member(random, A)}) {
      mpfr_set_d(y, a, MPFR_RNDN);
      f.exact(y, y, MPFR_RNDN);
      ASSERT_TRUE(mpfr_cmp_d(y, range.lower) >= 0 && mpfr_cmp_d(y, range.upper) <= 0) << f.name << " at " << a;
    }
  }
  mpfr_clear(y);
}

INSTANTIATE_TEST_SUITE_P(
    All, Elementary,
    testing::Values(Function{"sqrt", sqrt, mpfr_sqrt, 0, 1e6}, Function{"exp", exp, mpfr_exp, -700, 700},
                    Function{"log", log, mpfr_log, 1e-9, 1e3}, Function{"log10", log10, mpfr_log10, 1e-9, 1e3},
                    Function{"sin", sin, mpfr_sin, -20, 20}, Function{"cos", cos, mpfr_cos, -20, 20},
                    Function{"tan", tan, mpfr_tan, -1.5, 1.5}, Function{"asin", asin, mpfr_asin, -1, 1},
                    Function{"acos", acos, mpfr_acos, -1, 1}, Function{"atan", atan, mpfr_atan, -50, 50},
                    Function{"sinh", sinh, mpfr_sinh, -30, 30}, Function{"cosh", cosh, mpfr_cosh, -30, 30},
                    Function{"tanh", tanh, mpfr_tanh, -5, 5}, Function{"asinh", asinh, mpfr_asinh, -50, 50},
                    Function{"acosh", acosh, mpfr_acosh, 1, 50}, Function{"atanh", atanh, mpfr_atanh, -0.999, 0.999}),
    [](const auto& function) { return std::string(function.param.name); });

}  // namespace
}  // namespace perp::ncp
