#pragma once
/// Private to the faceted encodings: collects A, B, L and the box of faceting.hpp contact by contact.
#include <vector>

#include "contact/faceting.hpp"

namespace perp::contact {

class FacetingBuilder {
 public:
  /// Checks the problem, and the polygons: one or as many as contacts, of the plane's dimension (else
  /// std::invalid_argument beginning with `who`).
  FacetingBuilder(const char* who, const Problem& problem, const Polygons& polygons, const FacetedOptions& options);

  bool scaled() const { return scaled_; }
  Index tangents() const { return problem_.dimension - 1; }
  const Polygon& polygon(Index a) const { return polygons_[polygons_.size() == 1 ? 0 : static_cast<std::size_t>(a)]; }

  /// Begins a contact; its r and u are addressed by c = 0 (N), 1, 2 (T) below.
  void next_contact(Index a);
  Index nonnegative() { return unknown(0); }
  Index free() { return unknown(-lcp::infinity); }
  void velocity_row(Index row, Index c, double value) { add(A_, problem_.dimension * contact_ + c, row, value); }
  void impulse_column(Index column, Index c, double value) {
    add(B_, problem_.dimension * contact_ + c, column, value);
  }
  void local(Index row, Index column, double value) { add(L_, row, column, value); }

 private:
  friend class Faceting;
  using Triplets = std::vector<Eigen::Triplet<double, int>>;
  static void add(Triplets& entries, Index row, Index column, double value);
  Index unknown(double lower);
  SpMat matrix(Index rows, const Triplets& entries) const;

  const Problem& problem_;
  const Polygons& polygons_;
  bool scaled_;
  Index contact_ = 0;
  std::vector<double> lower_;
  std::vector<Index> starts_;
  Triplets A_;
  Triplets B_;
  Triplets L_;
};

}  // namespace perp::contact
