// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Affine MCPs made to fool: every class of matrices, kind of bound, degeneracy and scale, most of them with a solution
/// or a certificate that is exact in the doubles given. The numbers are dyadic with few digits, so that q = w - M z has
/// no rounding, and rows and columns are scaled by powers of two afterwards. The same on every machine: the generator
/// of random numbers is its own (splitmix64; Steele, Lea & Flood, OOPSLA 2014).
#include <cstdint>
#include <optional>
#include <string>

#include "lcp/affine_mcp.hpp"

namespace perp::lcp::adversarial {

class Rng {
 public:
  explicit Rng(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next();
  int integer(int low, int high);  ///< both included
  bool chance(int percent) { return integer(1, 100) <= percent; }
  double digits(int bits);  ///< k 2^-(bits - 2), |k| < 2^bits: in (-4, 4)
  double full() { return digits(53); }

 private:
  std::uint64_t state_;
};

struct Problem {
  std::string what;  ///< class, boxes, scales
  AffineMcp mcp;
  Vec start;                       ///< in general not in the box
  std::optional<Vec> solution;     ///< exact: the natural residual is 0
  std::optional<Vec> certificate;  ///< exact: no solution exists
};

/// The problem of a seed: about two thirds with a planted solution, one in ten with a certificate that there is none,
/// the others unknown. n from 1 to 12.
Problem make(std::uint64_t seed);

}  // namespace perp::lcp::adversarial
