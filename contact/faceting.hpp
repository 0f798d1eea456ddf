#pragma once
/// What the four faceted encodings share: each is, in the units of units.hpp, the affine MCP in unknowns z, some of
/// them impulses,
///     r = B z,   M = A'W B + L,   q_z = A'q,
/// with A' placing the rows of u = W r + q among the equations, and L the law's own entries. A, B and L have blocks of
/// one contact on their diagonals and nothing else, so M is as sparse as W.
#include <string>

#include "contact/polygon.hpp"
#include "contact/problem.hpp"
#include "contact/units.hpp"
#include "lcp/affine_mcp.hpp"

namespace perp::contact {

/// How much of the law is left in equations: the mixed form keeps r_T (and u_T) as free unknowns; the reduced one is an
/// LCP.
enum class Form { Mixed, Reduced };

struct FacetedOptions {
  Form form = Form::Reduced;
  bool scaled = true;  ///< in the units of units.hpp; false: in those of the problem
};

class FacetingBuilder;

/// The base of OuterFaceting and InnerFaceting.
class Faceting {
 public:
  const lcp::AffineMcp& affine() const { return affine_; }
  const Units& units() const { return units_; }
  /// r = B z in the problem's units, u = W r + q. Throws std::invalid_argument if z has not affine().size() entries.
  Solution recover(In z) const;
  /// First unknown of contact a; those of a are start(a) .. start(a + 1) - 1.
  Index start(Index a) const { return starts_[static_cast<std::size_t>(a)]; }

 protected:
  Faceting(const Problem& problem, FacetingBuilder&& builder);

 private:
  SpMat W_;
  Vec q_;
  Units units_;
  SpMat B_;
  lcp::AffineMcp affine_;
  std::vector<Index> starts_;
};

}  // namespace perp::contact
