#pragma once
/// Sums without rounding (Shewchuk, Discrete Comput. Geom. 18 (1997) 305; Ogita, Rump & Oishi, SIAM J. Sci. Comput. 26
/// (2005) 1955). Exact while nothing overflows and no product is below 2^-969. Private to contact/.
#include <array>
#include <cmath>

namespace perp::contact {

/// value + error, exactly the sum or product it stands for.
struct Pair {
  double value = 0;
  double error = 0;
};

inline Pair two_sum(double a, double b) {
  const double sum = a + b;
  const double part = sum - a;
  return {sum, (a - (sum - part)) + (b - part)};
}

inline Pair two_product(double a, double b) {
  const double product = a * b;
  return {product, std::fma(a, b, -product)};
}

/// A sum of doubles as components that do not overlap, the least first. There are never more than 40: a double has 53
/// bits of some 2,100.
class Expansion {
 public:
  void add(double x) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const Pair s = two_sum(x, components_[i]);
      x = s.value;
      if (s.error != 0) components_[kept++] = s.error;
    }
    if (x != 0 && kept < components_.size()) components_[kept++] = x;
    size_ = kept;
  }
  void add(const Pair& x) {
    add(x.error);
    add(x.value);
  }
  void add_product(double a, double b) { add(two_product(a, b)); }
  /// To a few eps of itself.
  double value() const {
    double sum = 0;
    for (std::size_t i = 0; i < size_; ++i) sum += components_[i];
    return sum;
  }

 private:
  std::array<double, 48> components_{};
  std::size_t size_ = 0;
};

}  // namespace perp::contact
