// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Numbers of 6,000 bits: the exponents of doubles span some 2,100, their squares twice as many.
#include <mpfr.h>

namespace perp::contact::test {

inline constexpr mpfr_prec_t bits = 6000;

/// A number of MPFR.
class Real {
 public:
  Real(double x = 0) {  // NOLINT: a number
    mpfr_init2(x_, bits);
    mpfr_set_d(x_, x, MPFR_RNDN);
  }
  Real(const Real& other) : Real() { mpfr_set(x_, other.x_, MPFR_RNDN); }
  Real& operator=(const Real& other) {
    mpfr_set(x_, other.x_, MPFR_RNDN);
    return *this;
  }
  ~Real() { mpfr_clear(x_); }
  double value() const { return mpfr_get_d(x_, MPFR_RNDN); }
  friend Real operator+(const Real& a, const Real& b) { return made(mpfr_add, a, b); }
  friend Real operator-(const Real& a, const Real& b) { return made(mpfr_sub, a, b); }
  friend Real operator*(const Real& a, const Real& b) { return made(mpfr_mul, a, b); }
  friend Real operator/(const Real& a, const Real& b) { return made(mpfr_div, a, b); }
  friend bool operator<=(const Real& a, const Real& b) { return mpfr_lessequal_p(a.x_, b.x_) != 0; }
  friend Real norm(const Real& a, const Real& b) { return made(mpfr_hypot, a, b); }

 private:
  template <class Operation>
  static Real made(Operation operation, const Real& a, const Real& b) {
    Real c;
    operation(c.x_, a.x_, b.x_, MPFR_RNDN);
    return c;
  }
  mpfr_t x_;
};

}  // namespace perp::contact::test
