#include "contact/faceting.hpp"

#include <sstream>
#include <stdexcept>
#include <utility>

#include "contact/faceting_builder.hpp"

namespace perp::contact {

FacetingBuilder::FacetingBuilder(const char* who, const Problem& problem, const Polygons& polygons,
                                 const FacetedOptions& options)
    : problem_(problem), polygons_(polygons), scaled_(options.scaled) {
  check(problem);
  std::ostringstream why;
  const auto n = static_cast<std::size_t>(problem.contacts());
  if (polygons.size() != 1 && polygons.size() != n) {
    why << who << ": " << polygons.size() << " polygons for " << n << " contacts; give one, or one for each";
    throw std::invalid_argument(why.str());
  }
  for (std::size_t a = 0; a < polygons.size(); ++a)
    if (polygons[a].dimension() != problem.dimension - 1) {
      why << who << ": polygon " << a + 1 << " has the dimension " << polygons[a].dimension()
          << ", the tangent plane of the problem " << problem.dimension - 1;
      throw std::invalid_argument(why.str());
    }
}

void FacetingBuilder::next_contact(Index a) {
  contact_ = a;
  starts_.push_back(static_cast<Index>(lower_.size()));
}

Index FacetingBuilder::unknown(double lower) {
  lower_.push_back(lower);
  return static_cast<Index>(lower_.size()) - 1;
}

void FacetingBuilder::add(Triplets& entries, Index row, Index column, double value) {
  if (value != 0) entries.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
}

SpMat FacetingBuilder::matrix(Index rows, const Triplets& entries) const {
  SpMat result(rows, static_cast<Index>(lower_.size()));
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

Faceting::Faceting(const Problem& problem, FacetingBuilder&& builder)
    : W_(problem.W), q_(problem.q), units_(builder.scaled_ ? Units::of(W_, q_) : Units::none()) {
  const auto size = static_cast<Index>(builder.lower_.size());
  const SpMat A = builder.matrix(q_.size(), builder.A_);
  B_ = builder.matrix(q_.size(), builder.B_);
  affine_.M =
      SpMat(A.transpose()) * SpMat(W_ * B_ * (units_.impulse / units_.velocity)) + builder.matrix(size, builder.L_);
  affine_.M.makeCompressed();
  affine_.q = A.transpose() * q_ / units_.velocity;
  affine_.box = {Eigen::Map<const Vec>(builder.lower_.data(), size), Vec::Constant(size, lcp::infinity)};
  starts_ = std::move(builder.starts_);
  starts_.push_back(size);
}

Solution Faceting::recover(In z) const {
  if (z.size() != affine_.size()) {
    std::ostringstream why;
    why << "faceted contact: the point has " << z.size() << " entries, the problem " << affine_.size();
    throw std::invalid_argument(why.str());
  }
  Solution solution;
  solution.r = units_.impulse * (B_ * z);
  solution.u = W_ * solution.r + q_;
  return solution;
}

}  // namespace perp::contact
