// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the affine encodings of a contact problem share (frictionless.hpp, inner_faceting.hpp, outer_faceting.hpp):
/// each is, in the units of contact/model/units.hpp, an affine MCP in unknowns z that determine the impulses,
///     r = B z,   M = A'W B + L,   q_z = A'q,
/// where A' places the rows of u = W r + q among the equations and L has the law's own entries. A, B and L have blocks
/// of one contact on their diagonals and nothing else, so M is as sparse as W.
#include <utility>
#include <vector>

#include "contact/laws/polygon.hpp"
#include "contact/model/problem.hpp"
#include "contact/model/units.hpp"
#include "lcp/affine_mcp.hpp"
#include "lcp/judge/result.hpp"
#include "lcp/solve/solve.hpp"

namespace perp::contact {

/// How much of a faceted law is left in equations: the mixed form keeps r_T (and u_T) as free unknowns; the reduced one
/// is an LCP.
enum class Form { Mixed, Reduced };

struct EncodingOptions {
  Form form = Form::Reduced;
  bool scaled = true;  ///< in the units of contact/model/units.hpp; false: in those of the problem
};

class EncodingBuilder;

class AffineEncoding {
 public:
  const lcp::AffineMcp& affine() const { return affine_; }
  Index contacts() const { return static_cast<Index>(first_.size()) - 1; }
  /// The first unknown of contact a, its r_N; those of a are first(a) .. first(a + 1) - 1.
  Index first(Index a) const { return first_[static_cast<std::size_t>(a)]; }
  /// r = B z in the problem's units, u = W r + q. Throws std::invalid_argument if z has not affine().size() entries.
  Solution recover(In z) const;
  /// Where Lemke's method begins, in the normal map's coordinates (lcp/pivoting/lemke.hpp); empty: on its classical
  /// ray.
  const Vec& lemke_start() const { return lemke_start_; }

 protected:
  AffineEncoding(const Problem& problem, EncodingBuilder&& builder);
  void begin_lemke_at(Vec x) { lemke_start_ = std::move(x); }

 private:
  SpMat W_;
  Vec q_;
  Units units_;
  SpMat B_;
  lcp::AffineMcp affine_;
  std::vector<Index> first_;
  Vec lemke_start_;
};

/// What came out, and which method made its point: "lemke", "interior-point" or "auto".
struct EncodingResult : lcp::Result {
  const char* by = "";
};
/// Lemke's method from the encoding's start, with the textbook's covering vector, and interior points, which nothing is
/// promised of (M is copositive, not monotone) and which solve nearly everything; with more than 200 contacts in the
/// other order; lcp::Auto at last. Result::message says what was tried, the last one successful. Throws as lcp::solve.
EncodingResult solve(const AffineEncoding& encoding, const lcp::Limits& limits = {});
/// By one method alone. Lemke's method begins at the encoding's start, where it has one.
lcp::Result solve(const AffineEncoding& encoding, const lcp::Method& method, const lcp::Limits& limits);

}  // namespace perp::contact
