// SPDX-License-Identifier: Apache-2.0
#include "contact/laws/affine_encoding.hpp"

#include <limits>
#include <sstream>
#include <string>

#include "contact/laws/encoding_builder.hpp"
#include "contact/model/checks.hpp"
#include "lcp/memory.hpp"
#include "lcp/solve/solve.hpp"
#include "lcp/words.hpp"

namespace perp::contact {

void check(const char* who, const Problem& problem, const Polygons& polygons) {
  check_no_rolling(who, problem);
  const auto n = static_cast<std::size_t>(problem.contacts());
  if (polygons.size() != 1 && polygons.size() != n) {
    refuse_input(who, ": ", polygons.size(), " polygons for ", n, " contacts; give one, or one for each");
  }
  for (std::size_t a = 0; a < polygons.size(); ++a)
    if (polygons[a].dimension() != problem.dimension - 1)
      refuse_input(who, ": polygon ", a + 1, " has the dimension ", polygons[a].dimension(),
                   ", the tangent plane of the problem ", problem.dimension - 1);
}

EncodingBuilder::EncodingBuilder(const Problem& problem, const EncodingOptions& options)
    : problem_(problem), scaled_(options.scaled) {
  contact::check(problem);
}

Index EncodingBuilder::next_contact(Index a) {
  contact_ = a;
  first_.push_back(static_cast<Index>(lower_.size()));
  const Index r_N = nonnegative();
  velocity_row(r_N, 0, 1);
  impulse_column(r_N, 0, 1);
  return r_N;
}

Index EncodingBuilder::unknown(double lower) {
  lower_.push_back(lower);
  return static_cast<Index>(lower_.size()) - 1;
}

void EncodingBuilder::add(Triplets& entries, Index row, Index column, double value) {
  if (value != 0) entries.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
}

SpMat EncodingBuilder::matrix(Index rows, const Triplets& entries) const {
  SpMat result(rows, static_cast<Index>(lower_.size()));
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

/// Of A' W B, cancelled ones too: what the polygons make of one entry of W goes with the square of their corners.
double EncodingBuilder::product_entries() const {
  const auto in_rows = [&](const Triplets& entries) {
    std::vector<double> count(static_cast<std::size_t>(problem_.q.size()), 0);
    for (const auto& entry : entries) ++count[static_cast<std::size_t>(entry.row())];
    return count;
  };
  const std::vector<double> A = in_rows(A_);
  const std::vector<double> B = in_rows(B_);
  double sum = 0;
  const SpMat& W = problem_.W.matrix();
  for (Index j = 0; j < W.cols(); ++j)
    for (SpMat::InnerIterator it(W, j); it; ++it)
      sum += A[static_cast<std::size_t>(it.row())] * B[static_cast<std::size_t>(j)];
  return sum;
}

void EncodingBuilder::check_size() const {
  const double entries = product_entries() + static_cast<double>(L_.size());
  std::ostringstream what;
  what.precision(3);
  what << "contact: the encoding's " << entries << " entries";
  if (entries > std::numeric_limits<int>::max())
    refuse_input(what.str(), " are more than 2^31; use fewer facets, or form mixed");
  constexpr double bytes = 3 * (sizeof(double) + sizeof(int));  // the product, its sum with L, and what sorts them
  lcp::require_memory(bytes * entries, what.str());
}

AffineEncoding::AffineEncoding(const Problem& problem, EncodingBuilder&& builder)
    : W_(problem.W.matrix()), q_(problem.q), units_(builder.scaled_ ? Units::of(problem.W, q_) : Units::none()) {
  builder.check_size();
  const auto size = static_cast<Index>(builder.lower_.size());
  const SpMat A = builder.matrix(q_.size(), builder.A_);
  B_ = builder.matrix(q_.size(), builder.B_);
  const SpMat velocities = W_ * B_ * (units_.impulse / units_.velocity);
  affine_.M = SpMat(A.transpose()) * velocities + builder.matrix(size, builder.L_);
  affine_.M.makeCompressed();
  affine_.q = A.transpose() * q_ / units_.velocity;
  affine_.box = {Eigen::Map<const Vec>(builder.lower_.data(), size), Vec::Constant(size, lcp::infinity)};
  first_ = std::move(builder.first_);
  first_.push_back(size);
}

Solution AffineEncoding::recover(In z) const {
  if (z.size() != affine_.size()) {
    refuse_input("contact: the point has ", z.size(), " entries, the encoding ", affine_.size());
  }
  Solution solution;
  solution.r = units_.impulse * (B_ * z);
  solution.u = W_ * solution.r + q_;
  return solution;
}

namespace {

/// Contacts up to which Lemke's method comes first: beyond, interior points take as long or less, and where contacts
/// are redundant by the hundred far less.
constexpr Index pivoting_to = 200;

lcp::Result by_lemke(const AffineEncoding& encoding, lcp::Lemke lemke, const lcp::Limits& limits) {
  Vec start = encoding.lemke_start();
  if (start.size() > 0)
    lemke.options.start = lcp::LemkeStart::Regular;
  else
    start = Vec::Zero(encoding.affine().size());
  return lcp::solve(encoding.affine(), start, lemke, limits);
}

}  // namespace

EncodingResult solve(const AffineEncoding& encoding, const lcp::Limits& limits) {
  const lcp::AffineMcp& problem = encoding.affine();
  std::string tried;
  EncodingResult best;
  /// Whether this was the last one.
  const auto keep = [&](const char* method, lcp::Result result) {
    result.message = tried + method + (result.message.empty() ? "" : ": " + result.message);
    tried = result.message + "; then ";
    result.iterations += best.iterations;
    result.factorizations += best.factorizations;
    const bool settled = result.accepted() || result.status == Status::Infeasible || limits.reached();
    if (best.z.size() == 0 || result.accepted() || result.residual < best.residual)
      best = {std::move(result), method};
    else {
      best.message = result.message;
      best.iterations = result.iterations;
      best.factorizations = result.factorizations;
    }
    return settled;
  };
  const auto interior = [&] {
    return keep("interior-point", lcp::solve(problem, Vec::Zero(problem.size()), lcp::InteriorPoint{}, limits));
  };
  const bool pivoting_first = encoding.contacts() <= pivoting_to;
  if (!pivoting_first && interior()) return best;
  if (keep("lemke", by_lemke(encoding, {}, limits))) return best;
  if (pivoting_first && interior()) return best;
  keep("auto", lcp::solve(problem, best.z, lcp::Auto{}, limits));
  return best;
}

lcp::Result solve(const AffineEncoding& encoding, const lcp::Method& method, const lcp::Limits& limits) {
  if (const auto* lemke = std::get_if<lcp::Lemke>(&method)) return by_lemke(encoding, *lemke, limits);
  return lcp::solve(encoding.affine(), Vec::Zero(encoding.affine().size()), method, limits);
}

}  // namespace perp::contact
