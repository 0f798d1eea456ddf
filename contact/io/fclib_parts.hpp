// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What of FCLIB files (fclib.hpp) needs no HDF5: the storage of matrices, the sizes of points. Private to contact/.
#include <vector>

#include "contact/io/fclib.hpp"

namespace perp::contact {

struct FclibMatrix {
  long long m = 0;
  long long n = 0;
  long long nzmax = 0;
  long long nz = -1;
  std::vector<long long> p{};
  std::vector<long long> i{};
  lcp::Vec x{};
};

/// Throws std::invalid_argument, "p[3] is 7, below p[2] = 8", if it is not a rows x columns matrix or its arrays do not
/// fit together. Allocates nothing that `rows`, `columns` and the arrays do not account for.
lcp::SpMat to_sparse(const FclibMatrix& stored, lcp::Index rows, lcp::Index columns);

/// Compressed columns.
FclibMatrix to_fclib(const lcp::SpMat& A);

/// Throws std::invalid_argument if a part that is given has another size than the problem's or is not finite.
void check(const FclibPoint& point, const Problem& problem);

}  // namespace perp::contact
