// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Vectors and sparse matrices of Perp: Eigen's, in the layout UMFPACK and KLU read (column-major, int indices).
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstddef>
#include <limits>

namespace perp::lcp {

using Index = Eigen::Index;
using Vec = Eigen::VectorXd;
using SpMat = Eigen::SparseMatrix<double>;
using In = const Eigen::Ref<const Vec>&;  ///< read-only vector argument
using Out = Eigen::Ref<Vec>;              ///< written vector argument; the caller sizes it

inline constexpr double infinity = std::numeric_limits<double>::infinity();

constexpr std::size_t at(Index i) { return static_cast<std::size_t>(i); }  ///< i as an index of std::vector

}  // namespace perp::lcp
