// SPDX-License-Identifier: Apache-2.0
#include "contact/io/fclib_parts.hpp"

#include <cmath>

#include "lcp/words.hpp"

namespace perp::contact {
namespace {

using lcp::Index;
using lcp::SpMat;

void check_length(const char* name, std::size_t length, long long needed, const char* why) {
  if (static_cast<long long>(length) < needed) refuse_input(name, " has ", length, " entries, not ", needed, ": ", why);
}

void check_index(const char* name, long long k, long long value, long long below) {
  if (value < 0 || value >= below) refuse_input(name, "[", k, "] is ", value, ", not within 0 and ", below - 1);
}

class Entries {
 public:
  explicit Entries(const FclibMatrix& stored) : stored_(stored) {}

  SpMat matrix() {
    if (stored_.nz < -2) refuse_input("nz is ", stored_.nz, ", neither -1, -2 nor a number of triplets");
    if (stored_.nz >= 0)
      triplets();
    else
      compressed();
    SpMat A(stored_.m, stored_.n);
    A.setFromTriplets(entries_.begin(), entries_.end());
    return A;
  }

 private:
  void check_entries(long long count) {
    check_length("i", stored_.i.size(), count, "one an entry");
    check_length("x", static_cast<std::size_t>(stored_.x.size()), count, "one an entry");
    if (stored_.nzmax < count) refuse_input("nzmax is ", stored_.nzmax, ", below the number of entries, ", count);
    entries_.reserve(static_cast<std::size_t>(count));
  }

  void add(long long k, long long row, long long column) {
    const double x = stored_.x[static_cast<Index>(k)];
    if (!std::isfinite(x)) refuse_input("x[", k, "] is ", x);
    entries_.emplace_back(static_cast<int>(row), static_cast<int>(column), x);
  }

  void triplets() {
    check_length("p", stored_.p.size(), stored_.nz, "one a triplet");
    check_entries(stored_.nz);
    for (long long k = 0; k < stored_.nz; ++k) {
      const auto at = static_cast<std::size_t>(k);
      check_index("i", k, stored_.i[at], stored_.m);
      check_index("p", k, stored_.p[at], stored_.n);
      add(k, stored_.i[at], stored_.p[at]);
    }
  }

  void compressed() {
    const bool columns = stored_.nz == -1;
    const long long count = columns ? stored_.n : stored_.m;
    const std::vector<long long>& p = stored_.p;
    check_length("p", p.size(), count + 1, columns ? "one a column and one more" : "one a row and one more");
    if (p[0] != 0) refuse_input("p[0] is ", p[0], ", not 0");
    for (std::size_t j = 1; j <= static_cast<std::size_t>(count); ++j)
      if (p[j] < p[j - 1]) refuse_input("p[", j, "] is ", p[j], ", below p[", j - 1, "] = ", p[j - 1]);
    check_entries(p[static_cast<std::size_t>(count)]);
    for (long long j = 0; j < count; ++j)
      for (long long k = p[static_cast<std::size_t>(j)]; k < p[static_cast<std::size_t>(j) + 1]; ++k) {
        const long long other = stored_.i[static_cast<std::size_t>(k)];
        check_index("i", k, other, columns ? stored_.m : stored_.n);
        add(k, columns ? other : j, columns ? j : other);
      }
  }

  const FclibMatrix& stored_;
  std::vector<Eigen::Triplet<double>> entries_;
};

}  // namespace

SpMat to_sparse(const FclibMatrix& stored, Index rows, Index columns) {
  if (stored.m != rows || stored.n != columns)
    refuse_input("m x n is ", stored.m, " x ", stored.n, ", but the vectors make it ", rows, " x ", columns);
  return Entries(stored).matrix();
}

FclibMatrix to_fclib(const SpMat& A) {
  FclibMatrix out{.m = A.rows(), .n = A.cols(), .nzmax = A.nonZeros()};
  out.p.push_back(0);
  out.x.resize(A.nonZeros());
  for (Index j = 0; j < A.cols(); ++j) {
    for (SpMat::InnerIterator it(A, j); it; ++it) {
      out.x[static_cast<Index>(out.i.size())] = it.value();
      out.i.push_back(it.row());
    }
    out.p.push_back(static_cast<long long>(out.i.size()));
  }
  return out;
}

void check(const FclibPoint& point, const Problem& problem) {
  const auto part = [](const char* name, const Vec& v, Index size) {
    if (v.size() > 0 && size >= 0 && v.size() != size)
      refuse_input("FCLIB file: ", name, " of a solution or guess has ", v.size(), " entries, not ", size);
    for (Index k = 0; k < v.size(); ++k)
      if (!std::isfinite(v[k])) refuse_input("FCLIB file: ", name, "[", k, "] of a solution or guess is ", v[k]);
  };
  const Global* g = problem.global.get();
  part("v", point.v, g != nullptr ? g->f.size() : -1);
  part("u", point.u, problem.q.size());
  part("r", point.r, problem.q.size());
  part("l", point.l, g != nullptr ? g->b.size() : -1);
}

}  // namespace perp::contact
