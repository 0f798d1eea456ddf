// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Eigen 3.4, kept whole where memory ends. Its dense storage and its sparse matrices free what they hold before they
/// ask for another size and keep the pointer; where nothing is given the destructor frees it again. The constructors of
/// sparse matrices from others lose what they have when a later request fails. These specializations are the same
/// functions without that: after std::bad_alloc a dense object is empty, and a sparse matrix as it was.
///
/// Included before everything else in each file of perp (CMakeLists.txt), never by a public header: a consumer's own
/// code may have used Eigen's versions before. Of those and these, both inline, a linker keeps either; they do the same
/// as long as there is memory.
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cstdlib>
#include <cstring>

#if EIGEN_WORLD_VERSION == 3 && EIGEN_MAJOR_VERSION == 4

namespace perp::lcp {

/// Not inlined: GCC 12 would warn of entries beyond vectors of fixed sizes, in branches that are not taken.
template <class Storage>
[[gnu::noinline]] void resize_whole(Storage& storage, Eigen::Index size, Eigen::Index rows, Eigen::Index cols) {
  {
    Storage none;
    storage.swap(none);
  }
  Storage sized(size, rows, cols);
  storage.swap(sized);
}

}  // namespace perp::lcp

namespace Eigen {

#define PERP_RESIZE_WHOLE(T, ROWS, COLS, OPTIONS, SAME_SIZE)                                              \
  template <>                                                                                             \
  inline void DenseStorage<T, Dynamic, ROWS, COLS, OPTIONS>::resize(Index size, Index rows, Index cols) { \
    if (size != this->rows() * this->cols()) return perp::lcp::resize_whole(*this, size, rows, cols);     \
    SAME_SIZE;                                                                                            \
  }
PERP_RESIZE_WHOLE(double, Dynamic, Dynamic, ColMajor, (m_rows = rows, m_cols = cols))
PERP_RESIZE_WHOLE(double, Dynamic, Dynamic, RowMajor, (m_rows = rows, m_cols = cols))
PERP_RESIZE_WHOLE(double, Dynamic, 1, ColMajor, m_rows = rows)
PERP_RESIZE_WHOLE(double, 1, Dynamic, RowMajor, m_cols = cols)
PERP_RESIZE_WHOLE(int, Dynamic, 1, ColMajor, m_rows = rows)
PERP_RESIZE_WHOLE(Index, Dynamic, 1, ColMajor, m_rows = rows)
PERP_RESIZE_WHOLE(bool, Dynamic, 1, ColMajor, m_rows = rows)
#undef PERP_RESIZE_WHOLE

// The constructors delegate: such an object is destroyed whatever comes after. A copy has its entries before it counts
// them.
#define PERP_SPARSE_WHOLE(ORDER)                                                                                    \
  template <>                                                                                                       \
  inline void SparseMatrix<double, ORDER, int>::resize(Index rows, Index cols) {                                    \
    const Index outer = ORDER == RowMajor ? rows : cols;                                                            \
    if (m_outerSize != outer || m_outerSize == 0) {                                                                 \
      auto* const made = static_cast<int*>(std::malloc(static_cast<std::size_t>(outer + 1) * sizeof(int)));         \
      if (made == nullptr) internal::throw_std_bad_alloc();                                                         \
      std::free(m_outerIndex);                                                                                      \
      m_outerIndex = made;                                                                                          \
      m_outerSize = outer;                                                                                          \
    }                                                                                                               \
    m_innerSize = ORDER == RowMajor ? cols : rows;                                                                  \
    m_data.clear();                                                                                                 \
    std::free(m_innerNonZeros);                                                                                     \
    m_innerNonZeros = nullptr;                                                                                      \
    std::memset(m_outerIndex, 0, static_cast<std::size_t>(m_outerSize + 1) * sizeof(int));                          \
  }                                                                                                                 \
  template <>                                                                                                       \
  inline SparseMatrix<double, ORDER, int>& SparseMatrix<double, ORDER, int>::operator=(const SparseMatrix& other) { \
    if (other.isRValue()) {                                                                                         \
      swap(other.const_cast_derived());                                                                             \
    } else if (this != &other) {                                                                                    \
      initAssignment(other);                                                                                        \
      if (!other.isCompressed()) {                                                                                  \
        Base::operator=(other);                                                                                     \
      } else {                                                                                                      \
        m_data = other.m_data;                                                                                      \
        std::copy_n(other.m_outerIndex, m_outerSize + 1, m_outerIndex);                                             \
      }                                                                                                             \
    }                                                                                                               \
    return *this;                                                                                                   \
  }                                                                                                                 \
  template <>                                                                                                       \
  inline SparseMatrix<double, ORDER, int>::SparseMatrix(const SparseMatrix& other) : SparseMatrix() {               \
    *this = other;                                                                                                  \
  }                                                                                                                 \
  template <>                                                                                                       \
  template <class Expression>                                                                                       \
  SparseMatrix<double, ORDER, int>::SparseMatrix(const SparseMatrixBase<Expression>& other) : SparseMatrix() {      \
    if constexpr ((int(Flags) & RowMajorBit) != (int(internal::evaluator<Expression>::Flags) & RowMajorBit))        \
      *this = other.derived();                                                                                      \
    else                                                                                                            \
      internal::call_assignment_no_alias(*this, other.derived());                                                   \
  }
PERP_SPARSE_WHOLE(ColMajor)
PERP_SPARSE_WHOLE(RowMajor)
#undef PERP_SPARSE_WHOLE

}  // namespace Eigen

#endif
