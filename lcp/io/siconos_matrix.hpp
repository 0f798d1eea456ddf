// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The matrices in Siconos' `.dat` files: MATRIX of lcp/io/siconos_file.hpp, storage 0 (dense), 1 (sparse by
/// blocks) and 2 (compressed). Private to the readers of the project.
#include <vector>

#include "lcp/io/numbers.hpp"

namespace perp::lcp {

/// One matrix of a file: its head, then, once its shape is known to fit, its entries. Throws FileError.
class SiconosMatrix {
 public:
  /// Reads storage and shape. `name` is for the errors.
  SiconosMatrix(Numbers& in, const char* name);

  Index rows() const { return rows_; }
  Index columns() const { return columns_; }
  /// To be called once. Zeros are not stored.
  SpMat entries();

 private:
  using Triplets = std::vector<Eigen::Triplet<double>>;

  void add(Index row, Index column, double value);
  void read_block(Index row, Index column, Index rows, Index columns);
  void read_dense();
  std::vector<Index> ends(const char* what, Index blocks, Index size);
  void read_blocks();
  void read_compressed();

  Numbers& in_;
  const char* name_;
  Index storage_ = 0;
  Index rows_ = 0;
  Index columns_ = 0;
  Triplets entries_{};
};

}  // namespace perp::lcp
