// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Private to the affine encodings: collects A, B, L and the box of affine_encoding.hpp contact by contact.
#include <vector>

#include "contact/laws/affine_encoding.hpp"

namespace perp::contact {

class EncodingBuilder {
 public:
  /// Throws std::invalid_argument if the problem is malformed (check()).
  EncodingBuilder(const Problem& problem, const EncodingOptions& options);

  /// Begins a contact; its r and u are addressed by c = 0 (N), 1, 2 (T) below. Its first unknown is r_N >= 0, with the
  /// row of u_N; returns it.
  Index next_contact(Index a);
  Index nonnegative() { return unknown(0); }
  Index free() { return unknown(-lcp::infinity); }
  void velocity_row(Index row, Index c, double value) { add(A_, problem_.dimension * contact_ + c, row, value); }
  void impulse_column(Index column, Index c, double value) {
    add(B_, problem_.dimension * contact_ + c, column, value);
  }
  void local(Index row, Index column, double value) { add(L_, row, column, value); }

 private:
  friend class AffineEncoding;
  using Triplets = std::vector<Eigen::Triplet<double, int>>;
  static void add(Triplets& entries, Index row, Index column, double value);
  Index unknown(double lower);
  SpMat matrix(Index rows, const Triplets& entries) const;
  double product_entries() const;
  /// Throws lcp::NotEnoughMemory, or std::invalid_argument where indices do not count as far.
  void check_size() const;

  const Problem& problem_;
  bool scaled_;
  Index contact_ = 0;
  std::vector<double> lower_;
  std::vector<Index> first_;
  Triplets A_;
  Triplets B_;
  Triplets L_;
};

/// Throws std::invalid_argument, beginning with `who`, unless there is one polygon or one for each contact, all of the
/// tangent plane's dimension.
void check(const char* who, const Problem& problem, const Polygons& polygons);
inline const Polygon& of_contact(const Polygons& polygons, Index a) {
  return polygons[polygons.size() == 1 ? 0 : static_cast<std::size_t>(a)];
}

}  // namespace perp::contact
