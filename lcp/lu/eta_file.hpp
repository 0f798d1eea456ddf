// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The product form of the inverse: E = I but for one column, of which BasisFactor keeps one a replacement. Private to
/// lcp/lu/.
#include <cstddef>
#include <vector>

#include "lcp/lu/sparse_vector.hpp"

namespace perp::lcp {

/// The etas E_1 ... E_k, in one file. Those with few zeros are kept with them, which needs no row numbers.
class EtaFile {
 public:
  std::size_t size() const { return etas_.size(); }
  std::size_t entries() const { return value_.size(); }
  void clear() {
    etas_.clear();
    row_.clear();
    value_.clear();
  }
  void push(Index p, const SparseVector& d) {
    if (etas_.empty()) begin(at(d.size()));
    Eta eta{.position = p, .pivot = d[p], .start = value_.size(), .row_start = row_.size()};
    if (d.full() && 2 * (d.values().array() != 0).count() > d.size()) {
      value_.insert(value_.end(), d.values().data(), d.values().data() + d.size());
      value_[eta.start + at(p)] = 0;
    } else {
      d.for_each([&](Index i, double v) {
        if (i == p) return;
        row_.push_back(static_cast<int>(i));
        value_.push_back(v);
      });
    }
    eta.end = value_.size();
    eta.dense = row_.size() == eta.row_start && eta.end != eta.start;
    etas_.push_back(eta);
  }
  /// x <- E_k^-1 ... E_1^-1 x; returns the entries passed through.
  std::size_t apply(SparseVector& x) const {
    std::size_t work = size();
    double* to = x.data();
    for (const Eta& eta : etas_) {
      const Index p = eta.position;
      if (to[p] == 0) continue;
      work += eta.end - eta.start;
      const double xp = to[p] / eta.pivot;
      const double* v = value_.data() + eta.start;
      const double* end = value_.data() + eta.end;
      const int* i = row_.data() + eta.row_start;
      if (eta.dense) {
        x.set_full();
        subtract(xp, v, to, x.size());
      } else if (x.full()) {
        for (; v != end; ++v) to[*i++] -= *v * xp;
      } else {
        for (; v != end; ++v) x.add(*i++, -*v * xp);
      }
      to[p] = xp;  // listed: it was not zero
    }
    return work;
  }
  /// y <- E_1^-T ... E_k^-T y
  void apply_transposed(SparseVector& y) const {
    for (auto eta = etas_.rbegin(); eta != etas_.rend(); ++eta) {
      const Index p = eta->position;
      double sum = y[p];
      const double* v = value_.data() + eta->start;
      if (eta->dense) {
        sum -= Eigen::Map<const Vec>(v, y.size()).dot(y.values());
      } else {
        const int* i = row_.data() + eta->row_start;
        for (const double* end = value_.data() + eta->end; v != end; ++v) sum -= *v * y[*i++];
      }
      if (sum != 0 || y[p] != 0) y.set(p, sum / eta->pivot);
    }
  }

 private:
  struct Eta {
    Index position;
    double pivot;
    std::size_t start;      // of the values
    std::size_t row_start;  // of their rows; none where the values are those of all rows
    std::size_t end = 0;
    bool dense = false;
  };

  /// Room for some, so that a short file is not moved again and again.
  void begin(std::size_t rows) {
    constexpr std::size_t some = 8;
    if (etas_.capacity() > 0 || rows > most_rows) return;
    etas_.reserve(2 * some);
    row_.reserve(some * rows / 2);
    value_.reserve(some * rows);
  }
  static constexpr std::size_t most_rows = 1000;

  /// to -= factor v, eight at a time: most of the time of a long file goes here.
  static void subtract(double factor, const double* v, double* to, Index n) {
    constexpr Index together = 8;
    using Pack = Eigen::Matrix<double, together, 1>;
    Index i = 0;
    for (; i + together <= n; i += together) Eigen::Map<Pack>(to + i) -= factor * Eigen::Map<const Pack>(v + i);
    for (; i < n; ++i) to[i] -= factor * v[i];
  }

  std::vector<Eta> etas_;
  std::vector<int> row_;
  std::vector<double> value_;
};

}  // namespace perp::lcp
