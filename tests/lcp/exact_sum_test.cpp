// SPDX-License-Identifier: Apache-2.0
#include "lcp/exact_sum.hpp"

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

namespace perp::lcp {
namespace {

/// The nearest double, ties to even, of a rational, by its definition: the two doubles beside it.
double nearest(const mpq_class& sum) {
  const double truncated = sum.get_d();  // GMP rounds towards zero
  const double away = std::nextafter(truncated, sgn(sum) < 0 ? -HUGE_VAL : HUGE_VAL);
  const mpq_class low = abs(sum - mpq_class(truncated));
  const mpq_class high = abs(mpq_class(away) - sum);
  if (low != high) return low < high ? truncated : away;
  int exponent = 0;
  const double mantissa = std::ldexp(std::frexp(truncated, &exponent), DBL_MANT_DIG);
  return std::fmod(mantissa, 2) == 0 ? truncated : away;
}

// By hand: what double arithmetic loses. Catches a sum in floating point, in any order.
TEST(ExactSum, KeepsWhatRoundingLoses) {
  ExactSum sum;
  EXPECT_EQ(sum.sign(), 0);
  EXPECT_EQ(sum.value(), 0);
  for (const double a : {1e300, 1.0, 1e-300, -1e300, -1.0}) sum.add(a);
  EXPECT_EQ(sum.value(), 1e-300);
  EXPECT_EQ(sum.sign(), 1);
  sum.add(-1e-300);
  EXPECT_EQ(sum.sign(), 0);
  ExactSum product;  // (1 + 2^-30)^2 - 1 - 2^-29 = 2^-60
  product.add_product(1 + 0x1p-30, 1 + 0x1p-30);
  product.add(-1);
  product.add(-0x1p-29);
  EXPECT_EQ(product.value(), 0x1p-60);
  EXPECT_TRUE(product.exact());
  ExactSum tie;  // 1 + 2^-53 is a tie, which goes to 1; anything more goes up
  tie.add(1);
  tie.add(0x1p-53);
  EXPECT_EQ(tie.value(), 1);
  tie.add(1e-300);
  EXPECT_EQ(tie.value(), 1 + 0x1p-52);
  tie.add(-2e-300);
  EXPECT_EQ(tie.value(), 1);
}

// Against GMP's rationals: sizes from 2^-450 to 2^450, with cancellation. Catches a lost part, a compression that is
// not exact, a wrong rounding of the expansion.
TEST(ExactSum, AgreesWithRationals) {
  std::mt19937_64 random(1);
  const auto draw = [&](int exponents) {
    const double digits = static_cast<double>(static_cast<std::int64_t>(random())) * 0x1p-63;
    return std::ldexp(digits, static_cast<int>(random() % static_cast<unsigned>(2 * exponents + 1)) - exponents);
  };
  for (int run = 0; run < 400; ++run) {
    ExactSum sum;
    mpq_class expected = 0;
    std::vector<double> added;
    const int exponents = run % 4 == 0 ? 450 : run % 4 == 1 ? 60 : 2;
    for (int k = 0; k < 1 + run % 150; ++k) {
      const double a = draw(exponents);
      const double b = draw(exponents);
      if (k % 3 == 0) {
        sum.add_product(a, b);
        expected += mpq_class(a) * mpq_class(b);
        continue;
      }
      const bool cancel = k % 3 == 2 && !added.empty();
      const double term = cancel ? -added[random() % added.size()] : a;
      sum.add(term);
      expected += mpq_class(term);
      added.push_back(term);
    }
    EXPECT_TRUE(sum.exact());
    EXPECT_EQ(sum.value(), nearest(expected)) << "run " << run;
    EXPECT_EQ(sum.sign(), sgn(expected)) << "run " << run;
  }
}

// 2^-1074 ... 2^971, every fourth power with an alternating sign: parts that nothing merges, more than there is room
// for.
TEST(ExactSum, HasRoomForEveryExponent) {
  for (const int stride : {2, 4, 54}) {
    ExactSum sum;
    mpq_class expected = 0;
    for (int exponent = 971; exponent >= -1074; exponent -= stride) {
      const double a = std::ldexp(exponent % 4 == 0 ? 1 : -1, exponent);
      sum.add(a);
      expected += mpq_class(a);
    }
    EXPECT_TRUE(sum.exact());
    EXPECT_EQ(sum.value(), nearest(expected)) << stride;
    sum.add(-sum.value());
    expected -= mpq_class(nearest(expected));
    EXPECT_EQ(sum.value(), nearest(expected)) << stride;
  }
}

// What leaves the range is said. Catches a sign taken for exact although its product vanished.
TEST(ExactSum, SaysWhereItIsNotExact) {
  ExactSum small;
  small.add_product(0x1p-600, 0x1p-600);
  EXPECT_FALSE(small.exact());
  ExactSum large;
  large.add_product(0x1p600, 0x1p600);
  EXPECT_FALSE(large.exact());
  ExactSum zero;
  zero.add_product(0, 0x1p-600);
  EXPECT_TRUE(zero.exact());
  ExactSum sum;
  sum.add(DBL_MAX);
  sum.add(DBL_MAX);
  EXPECT_FALSE(sum.exact());
}

// Products of one size, of many, and such that cancel to their last digits, once or twice, against GMP's rationals.
// Catches a value that is called settled and is not the nearest double, one that is off by more than its doubt, and a
// bound so wide that nothing is ever settled.
TEST(TripleSum, IsTheNearestDoubleWhereItIsSettled) {
  std::mt19937_64 random(3);
  const auto draw = [&](int exponents) {
    const double digits = static_cast<double>(static_cast<std::int64_t>(random())) * 0x1p-63;
    return std::ldexp(digits, static_cast<int>(random() % static_cast<unsigned>(2 * exponents + 1)) - exponents);
  };
  constexpr int runs = 3000;
  int settled = 0;
  for (int run = 0; run < runs; ++run) {
    const int exponents = run % 3 == 0 ? 200 : run % 3 == 1 ? 30 : 1;
    double first = draw(exponents);
    std::vector<std::pair<double, double>> products;
    mpq_class expected = 0, terms = 0;
    for (int k = 0; k < 1 + run % 12; ++k) {
      products.emplace_back(draw(exponents), draw(exponents));
      const mpq_class product = mpq_class(products.back().first) * mpq_class(products.back().second);
      expected += product;
      terms += abs(product);
    }
    if (run % 2 == 0) first = -nearest(expected);
    expected += mpq_class(first);
    if (run % 4 == 0) {
      products.emplace_back(-nearest(expected), 1);
      expected -= mpq_class(nearest(expected));
    }
    TripleSum sum(first);
    for (const auto& [a, b] : products) sum.add_product(a, b);
    const bool is_settled = sum.settle();
    const mpq_class off = abs(expected - mpq_class(sum.value()));
    if (std::isfinite(sum.doubt())) {
      EXPECT_LE(off, mpq_class(sum.doubt()) + mpq_class(0x1p-52 * std::abs(sum.value()))) << "run " << run;
      EXPECT_LE(sum.doubt(), 0x1p-100 * terms.get_d()) << "run " << run;
    }
    if (!is_settled) continue;
    if (run % 4 != 0) ++settled;
    EXPECT_EQ(sum.value(), nearest(expected)) << "run " << run;
  }
  EXPECT_GT(settled, 0.9 * 0.75 * runs);  // of those that cancel at most once
}

// Catches sums called settled whose products lost digits below the range, overflowed, or ended at a tie.
TEST(TripleSum, IsNotSettledWhereDigitsAreLost) {
  TripleSum small(1);
  small.add_product(0x1p-600, 0x1p-600);
  EXPECT_FALSE(small.settle());
  TripleSum large(1);
  large.add_product(0x1p600, 0x1p600);
  EXPECT_FALSE(large.settle());
  TripleSum zeros(-0.0);
  zeros.add_product(0, 0x1p-600);
  EXPECT_TRUE(zeros.settle());
  EXPECT_FALSE(std::signbit(zeros.value()));
  TripleSum tie(1);  // 1 + 2^-53 + 2^-200, which goes up
  tie.add_product(0x1p-50, 0x1p-3);
  tie.add_product(0x1p-100, 0x1p-100);
  EXPECT_TRUE(!tie.settle() || tie.value() == 1 + 0x1p-52);
}

// Many sums at once are those one by one, to the last bit and to the last word on whether they are settled; entries of
// 2^+-1000 lose digits in Dekker's halves, which must be said. Catches a vector that is added to the wrong sum, and
// products taken for exact because no fused multiply-add looked at them.
TEST(TripleSums, AreTripleSumsOrNotSettled) {
  std::mt19937_64 random(4);
  constexpr std::size_t width = 8;
  for (int run = 0; run < 2000; ++run) {
    const int exponents = run % 4 == 3 ? 1000 : 1 << (run % 8);
    const auto draw = [&] {
      if (random() % 8 == 0) return 0.0;
      const double digits = static_cast<double>(static_cast<std::int64_t>(random())) * 0x1p-63;
      return std::ldexp(digits, static_cast<int>(random() % static_cast<unsigned>(2 * exponents + 1)) - exponents);
    };
    const std::size_t count = 1 + static_cast<std::size_t>(run) % width;
    std::array<double, width> first{}, a{};
    std::generate_n(first.begin(), count, draw);
    TripleSums<width> sums(first.data(), count);
    std::vector<TripleSum> one_by_one(first.begin(), first.begin() + static_cast<std::ptrdiff_t>(count));
    std::vector<mpq_class> expected(first.begin(), first.begin() + static_cast<std::ptrdiff_t>(count));
    for (int k = 0; k < 1 + run % 5; ++k) {
      std::generate_n(a.begin(), count, draw);
      const double b = draw();
      if (b == 0) continue;
      sums.add_products(a.data(), b);
      for (std::size_t i = 0; i < count; ++i) {
        one_by_one[i].add_product(a[i], b);
        expected[i] += mpq_class(a[i]) * mpq_class(b);
      }
    }
    sums.settle();
    for (std::size_t i = 0; i < count; ++i) {
      const bool settled = one_by_one[i].settle();
      if (exponents <= 128) {
        EXPECT_EQ(sums.settled_at(i), settled) << "run " << run;
      }
      if (sums.settled_at(i)) {
        EXPECT_EQ(sums.value(i), nearest(expected[i])) << "run " << run;
      }
    }
  }
}

}  // namespace
}  // namespace perp::lcp
