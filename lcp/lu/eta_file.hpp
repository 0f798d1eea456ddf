// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The product form of the inverse: E = I but for one column, of which BasisFactor keeps one a replacement. Private to
/// lcp/lu/.
#include <cstddef>
#include <vector>

#include "lcp/lu/sparse_vector.hpp"

namespace perp::lcp {

/// The etas E_1 ... E_k, in one file. Those with few zeros are kept with them, which needs no row numbers.
struct EtaFile {
  std::vector<Index> position;
  std::vector<double> pivot;
  std::vector<std::size_t> start{0};      // of the values
  std::vector<std::size_t> row_start{0};  // of the rows; none where the values are those of all rows
  std::vector<int> row;
  std::vector<double> value;

  std::size_t size() const { return position.size(); }
  std::size_t entries() const { return value.size(); }
  bool dense(std::size_t k) const { return row_start[k] == row_start[k + 1] && start[k] != start[k + 1]; }
  Eigen::Map<const Vec> values(std::size_t k) const {
    return {value.data() + start[k], static_cast<Index>(start[k + 1] - start[k])};
  }
  void clear() {
    for (auto* offsets : {&start, &row_start}) offsets->assign(1, 0);
    position.clear();
    pivot.clear();
    row.clear();
    value.clear();
  }
  void push(Index p, const SparseVector& d) {
    if (d.full() && 2 * (d.values().array() != 0).count() > d.size()) {
      value.insert(value.end(), d.values().data(), d.values().data() + d.size());
      value[start.back() + at(p)] = 0;
    } else {
      d.for_each([&](Index i, double v) {
        if (i == p) return;
        row.push_back(static_cast<int>(i));
        value.push_back(v);
      });
    }
    start.push_back(value.size());
    row_start.push_back(row.size());
    position.push_back(p);
    pivot.push_back(d[p]);
  }
  /// x <- E_k^-1 ... E_1^-1 x; returns the entries passed through.
  std::size_t apply(SparseVector& x) const {
    std::size_t work = size();
    double* to = x.data();
    for (std::size_t k = 0; k < size(); ++k) {
      const Index p = position[k];
      if (to[p] == 0) continue;
      work += start[k + 1] - start[k];
      const double xp = to[p] / pivot[k];
      const double* v = value.data() + start[k];
      const int* i = row.data() + row_start[k];
      const int* end = row.data() + row_start[k + 1];
      if (dense(k)) {
        x.set_full();
        subtract(xp, v, to, x.size());
      } else if (x.full()) {
        for (; i != end; ++i) to[*i] -= *v++ * xp;
      } else {
        for (; i != end; ++i) x.add(*i, -*v++ * xp);
      }
      to[p] = xp;  // listed: it was not zero
    }
    return work;
  }
  /// to -= factor v, eight at a time: most of the time of a long file goes here.
  static void subtract(double factor, const double* v, double* to, Index n) {
    constexpr Index together = 8;
    using Pack = Eigen::Matrix<double, together, 1>;
    Index i = 0;
    for (; i + together <= n; i += together) Eigen::Map<Pack>(to + i) -= factor * Eigen::Map<const Pack>(v + i);
    for (; i < n; ++i) to[i] -= factor * v[i];
  }
  /// y <- E_1^-T ... E_k^-T y
  void apply_transposed(SparseVector& y) const {
    for (std::size_t k = size(); k-- > 0;) {
      const Index p = position[k];
      double sum = y[p];
      if (dense(k)) {
        sum -= values(k).dot(y.values());
      } else {
        const double* v = value.data() + start[k];
        for (std::size_t e = row_start[k]; e < row_start[k + 1]; ++e) sum -= *v++ * y[row[e]];
      }
      if (sum != 0 || y[p] != 0) y.set(p, sum / pivot[k]);
    }
  }
};

}  // namespace perp::lcp
