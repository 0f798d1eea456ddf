// SPDX-License-Identifier: Apache-2.0
#include "petsc/galerkin.hpp"

#include <petsc/private/petscimpl.h>

#include <algorithm>
#include <cstring>
#include <iterator>
#include <limits>
#include <utility>

namespace perp::petsc {
namespace {

/// The place in a list that is increasing and has the value.
PetscInt place_of(PetscInt value, const std::vector<PetscInt>& list) {
  return static_cast<PetscInt>(std::lower_bound(list.begin(), list.end(), value) - list.begin());
}

void sort_once(std::vector<PetscInt>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

std::size_t at(PetscInt i) { return static_cast<std::size_t>(i); }

}  // namespace

/// What a product is made of, opened.
struct Galerkin::Factors {
  Blocks T, P, R, far_T, far_P;

  PetscErrorCode open(const Galerkin& g, Mat matrix) {
    PetscCall(T.open(matrix, Blocks::For::Reading));
    PetscCall(P.open(g.P_, Blocks::For::Reading));
    PetscCall(R.open(g.restriction_, Blocks::For::Reading));
    if (g.rows_of_T_.get() == nullptr) return ok;
    PetscCall(far_T.open(g.rows_of_T_.get(), Blocks::For::Reading));
    return far_P.open(g.rows_of_P_.get(), Blocks::For::Reading);
  }
};

PetscErrorCode Galerkin::Copies::fetch(Mat A, const std::vector<PetscInt>& of) {
  PetscInt n = 0;
  PetscCall(MatGetSize(A, nullptr, &n));
  PetscCall(
      ISCreateGeneral(PETSC_COMM_SELF, static_cast<PetscInt>(of.size()), of.data(), PETSC_COPY_VALUES, rows.out()));
  PetscCall(ISCreateStride(PETSC_COMM_SELF, n, 0, 1, columns.out()));
  return MatCreateSubMatrices(A, 1, rows.reuse(), columns.reuse(), MAT_INITIAL_MATRIX, matrix.out());
}

PetscErrorCode Galerkin::Copies::fetch_again(Mat A) {
  return MatCreateSubMatrices(A, 1, rows.reuse(), columns.reuse(), MAT_REUSE_MATRIX, matrix.reuse());
}

PetscErrorCode Galerkin::set_up(Mat T, Mat P, Vec like, OwnMat& coarse) {
  OwnVec fine;
  P_ = P;
  PetscCall(MatTranspose(P, MAT_INITIAL_MATRIX, restriction_.out()));
  PetscCall(MatGetLocalSize(P, &fine_, &coarse_));
  PetscCall(MatCreateVecs(T, fine.out(), nullptr));
  PetscCall(find_halo(T, P, fine));
  PetscCall(find_pattern(T, like, coarse));
  return forget();
}

/// The fine rows of other ranks that this rank's coarse rows need: those under its coarse functions, and the columns of
/// these and of its own rows.
PetscErrorCode Galerkin::find_halo(Mat T, Mat P, Vec fine) {
  PetscInt begin = 0;
  int ranks = 0;
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(T));
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  PetscCall(VecGetOwnershipRange(fine, &begin, nullptr));
  const auto mine = [&](PetscInt i) { return i >= begin && i < begin + fine_; };
  Blocks of_T;
  Blocks of_R;
  PetscCall(of_T.open(T, Blocks::For::Reading));
  PetscCall(of_R.open(restriction_, Blocks::For::Reading));
  const std::vector<PetscInt> far_rows(of_R.ghosts, of_R.ghosts + of_R.ghost_count);
  halo_.assign(of_T.ghosts, of_T.ghosts + of_T.ghost_count);
  halo_.insert(halo_.end(), far_rows.begin(), far_rows.end());
  if (ranks > 1) {
    PetscCall(rows_of_T_.fetch(T, far_rows));
    Blocks copies;
    PetscCall(copies.open(rows_of_T_.get(), Blocks::For::Reading));
    const PetscInt* column = copies.own.column;
    std::copy_if(column, column + copies.own.count(), std::back_inserter(halo_), [&](PetscInt j) { return !mine(j); });
    sort_once(halo_);
    rows_of_T_.column.resize(at(copies.own.count()));
    for (std::size_t k = 0; k < rows_of_T_.column.size(); ++k)
      rows_of_T_.column[k] = mine(column[k]) ? column[k] - begin : fine_ + place_of(column[k], halo_);
    known_.assign(rows_of_T_.column.size(), 0);
    PetscCall(rows_of_P_.fetch(P, halo_));
  }
  far_changed_.assign(far_rows.size(), 1);
  for (PetscInt i : far_rows) far_row_.push_back(fine_ + place_of(i, halo_));
  for (PetscInt k = 0; k < of_T.ghost_count; ++k) far_column_.push_back(fine_ + place_of(of_T.ghosts[k], halo_));
  mask_.assign(at(fine_) + halo_.size(), 1);
  moved_.assign(mask_.size(), 0);
  return ranks == 1 ? ok : exchange_with(fine);
}

PetscErrorCode Galerkin::exchange_with(Vec fine) {
  Handle<IS, ISDestroy> from;
  PetscCall(VecCreateSeq(PETSC_COMM_SELF, static_cast<PetscInt>(halo_.size()), halo_mask_.out()));
  PetscCall(ISCreateGeneral(PETSC_COMM_SELF, static_cast<PetscInt>(halo_.size()), halo_.data(), PETSC_COPY_VALUES,
                            from.out()));
  return VecScatterCreate(fine, from, halo_mask_, nullptr, exchange_.out());
}

/// The terms that sum to the coarse row c: use(coarse number, term); zeros: also those of entries of T that are 0.
template <class Use>
void Galerkin::each_term(const Factors& f, PetscInt c, bool zeros, Use use) const {
  const auto times_P = [&](PetscScalar a, PetscInt j) {
    if (a == 0 && !zeros) return;
    if (j >= fine_) {
      const Entries& rows = f.far_P.own;
      for (PetscInt k = rows.start[j - fine_]; k < rows.start[j - fine_ + 1]; ++k)
        use(rows_of_P_.column[at(k)], a * rows.value[k]);
      return;
    }
    for (PetscInt k = f.P.own.start[j]; k < f.P.own.start[j + 1]; ++k) use(f.P.own.column[k], a * f.P.own.value[k]);
    for (PetscInt k = f.P.far.begin(j); k < f.P.far.end(j); ++k)
      use(far_interpolated_[at(f.P.far.column[k])], a * f.P.far.value[k]);
  };
  for (PetscInt s = f.R.own.start[c]; s < f.R.own.start[c + 1]; ++s) {
    const PetscInt i = f.R.own.column[s];
    const PetscScalar p = f.R.own.value[s];
    if (mask_[at(i)] == 0) continue;
    for (PetscInt k = f.T.own.start[i]; k < f.T.own.start[i + 1]; ++k) times_P(p * f.T.own.value[k], f.T.own.column[k]);
    for (PetscInt k = f.T.far.begin(i); k < f.T.far.end(i); ++k)
      times_P(p * f.T.far.value[k], far_column_[at(f.T.far.column[k])]);
  }
  for (PetscInt s = f.R.far.begin(c); s < f.R.far.end(c); ++s) {
    const PetscInt i = f.R.far.column[s];
    const Entries& rows = f.far_T.own;
    if (mask_[at(far_row_[at(i)])] == 0) continue;
    for (PetscInt k = rows.start[i]; k < rows.start[i + 1]; ++k)
      times_P(f.R.far.value[s] * rows.value[k], rows_of_T_.column[at(k)]);
  }
}

/// The coarse matrix, and the numbers of the coarse columns of other ranks.
PetscErrorCode Galerkin::find_pattern(Mat T, Vec like, OwnMat& coarse) {
  PetscInt begin = 0;
  PetscInt width = 1;
  Factors f;
  PetscCall(f.open(*this, T));
  PetscCall(VecGetOwnershipRange(like, &begin, nullptr));
  PetscCall(VecGetBlockSize(like, &width));
  const auto mine = [&](PetscInt j) { return j >= begin && j < begin + coarse_; };
  far_coarse_.assign(f.P.ghosts, f.P.ghosts + f.P.ghost_count);
  const PetscInt* column = f.far_P.own.column;
  std::copy_if(column, column + f.far_P.own.count(), std::back_inserter(far_coarse_),
               [&](PetscInt j) { return !mine(j); });
  sort_once(far_coarse_);
  const auto number = [&](PetscInt j) { return mine(j) ? j - begin : coarse_ + place_of(j, far_coarse_); };
  for (PetscInt k = 0; k < f.P.ghost_count; ++k) far_interpolated_.push_back(number(f.P.ghosts[k]));
  for (PetscInt k = 0; k < f.far_P.own.count(); ++k) rows_of_P_.column.push_back(number(column[k]));

  std::vector<PetscInt> last(at(coarse_) + far_coarse_.size(), -1);  // the row that last had the column
  std::vector<PetscInt> start{0};
  std::vector<PetscInt> columns;
  for (PetscInt c = 0; c < coarse_; ++c) {
    each_term(f, c, true, [&](PetscInt d, PetscScalar) {
      if (last[at(d)] == c) return;
      last[at(d)] = c;
      columns.push_back(d < coarse_ ? begin + d : far_coarse_[at(d - coarse_)]);
    });
    std::sort(columns.begin() + start.back(), columns.end());
    start.push_back(static_cast<PetscInt>(columns.size()));
  }
  PetscCall(MatCreate(PetscObjectComm(reinterpret_cast<PetscObject>(T)), coarse.out()));
  PetscCall(MatSetSizes(coarse, coarse_, coarse_, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetBlockSize(coarse, width));
  PetscCall(MatSetType(coarse, MATAIJ));
  PetscCall(MatSeqAIJSetPreallocationCSR(coarse, start.data(), columns.data(), nullptr));
  PetscCall(MatMPIAIJSetPreallocationCSR(coarse, start.data(), columns.data(), nullptr));
  Blocks made;
  PetscCall(made.open(coarse, Blocks::For::Reading));
  for (PetscInt k = 0; k < made.ghost_count; ++k) far_of_coarse_.push_back(number(made.ghosts[k]));
  sum_.assign(last.size(), 0);
  return ok;
}

PetscErrorCode Galerkin::forget() {
  all_ = true;
  return untruncate();
}

PetscErrorCode Galerkin::untruncate() {
  std::fill(mask_.begin(), mask_.end(), 1);
  std::fill(far_changed_.begin(), far_changed_.end(), 1);
  std::fill(known_.begin(), known_.end(), std::numeric_limits<double>::quiet_NaN());
  return ok;
}

PetscErrorCode Galerkin::take_mask(Vec mask) {
  if (exchange_ != nullptr) PetscCall(VecScatterBegin(exchange_, mask, halo_mask_, INSERT_VALUES, SCATTER_FORWARD));
  anything_moved_ = false;
  const auto take = [&](const Reading& m, std::size_t first) {
    for (PetscInt i = 0; i < m.size(); ++i) {
      const char inside = m[i] != 0 ? 1 : 0;
      moved_[first + at(i)] = inside != mask_[first + at(i)] ? 1 : 0;
      anything_moved_ = anything_moved_ || inside != mask_[first + at(i)];
      mask_[first + at(i)] = inside;
    }
  };
  take(Reading(mask), 0);
  if (exchange_ == nullptr) return ok;
  PetscCall(VecScatterEnd(exchange_, mask, halo_mask_, INSERT_VALUES, SCATTER_FORWARD));
  take(Reading(halo_mask_), at(fine_));
  return ok;
}

/// Whether the mask has changed at the row i or one of its columns.
bool Galerkin::moved_near(const Blocks& T, PetscInt i) const {
  bool moved = moved_[at(i)] != 0;
  for (PetscInt k = T.own.start[i]; k < T.own.start[i + 1]; ++k) moved = moved || moved_[at(T.own.column[k])] != 0;
  for (PetscInt k = T.far.begin(i); k < T.far.end(i); ++k)
    moved = moved || moved_[at(far_column_[at(T.far.column[k])])] != 0;
  return moved;
}

PetscErrorCode Galerkin::truncate(Mat A, Vec mask, Vec diagonal, Mat T, std::vector<char>& changed) {
  changed.resize(at(fine_));
  if (A != nullptr) std::fill(changed.begin(), changed.end(), 0);
  PetscCall(take_mask(mask));
  Blocks from;
  Blocks to;
  const Reading d(diagonal);
  if (A != nullptr) PetscCall(from.open(A, Blocks::For::Reading));
  PetscCall(to.open(T, Blocks::For::Writing));
  for (PetscInt i = 0; i < fine_; ++i) {
    if (changed[at(i)] == 0 && !(anything_moved_ && moved_near(to, i))) continue;
    changed[at(i)] = 1;
    const bool inside = mask_[at(i)] != 0;
    for (PetscInt k = to.own.start[i]; k < to.own.start[i + 1]; ++k) {
      const PetscInt j = to.own.column[k];
      if (!inside || mask_[at(j)] == 0)
        to.own.value[k] = !inside && j == i ? (d[i] > 0 ? d[i] : 1) : 0;
      else if (A != nullptr)
        to.own.value[k] = from.own.value[k];
    }
    for (PetscInt k = to.far.begin(i); k < to.far.end(i); ++k) {
      if (!inside || mask_[at(far_column_[at(to.far.column[k])])] == 0)
        to.far.value[k] = 0;
      else if (A != nullptr)
        to.far.value[k] = from.far.value[k];
    }
  }
  return ok;
}

/// The rows of T that other ranks own, and which of them are others than in the product before.
PetscErrorCode Galerkin::take_far_rows(Mat T) {
  if (rows_of_T_.get() == nullptr) return ok;
  PetscCall(rows_of_T_.fetch_again(T));
  Blocks copies;
  PetscCall(copies.open(rows_of_T_.get(), Blocks::For::Reading));
  const Entries& rows = copies.own;
  for (PetscInt i = 0; i < rows.rows; ++i) {
    const PetscInt begin = rows.start[i];
    const std::size_t bytes = at(rows.start[i + 1] - begin) * sizeof(PetscScalar);
    far_changed_[at(i)] = std::memcmp(rows.value + begin, known_.data() + begin, bytes) != 0 ? 1 : 0;
    std::memcpy(known_.data() + begin, rows.value + begin, bytes);
  }
  return ok;
}

/// Whether a row of T under the coarse function c has changed.
bool Galerkin::concerns(const Blocks& R, PetscInt c, const std::vector<char>& changed) const {
  bool any = false;
  for (PetscInt s = R.own.start[c]; s < R.own.start[c + 1]; ++s) any = any || changed[at(R.own.column[s])] != 0;
  for (PetscInt s = R.far.begin(c); s < R.far.end(c); ++s) any = any || far_changed_[at(R.far.column[s])] != 0;
  return any;
}

PetscErrorCode Galerkin::multiply(Mat T, const std::vector<char>& changed, Mat coarse,
                                  std::vector<char>& coarse_changed) {
  PetscCall(take_far_rows(T));
  Factors f;
  Blocks S;
  PetscCall(f.open(*this, T));
  PetscCall(S.open(coarse, Blocks::For::Writing));
  coarse_changed.assign(at(coarse_), 0);
  const auto give = [&](PetscInt d) { return std::exchange(sum_[at(d)], 0); };
  for (PetscInt c = 0; c < coarse_; ++c) {
    if (!all_ && !concerns(f.R, c, changed)) continue;
    coarse_changed[at(c)] = 1;
    each_term(f, c, false, [&](PetscInt d, PetscScalar term) { sum_[at(d)] += term; });
    for (PetscInt k = S.own.start[c]; k < S.own.start[c + 1]; ++k) S.own.value[k] = give(S.own.column[k]);
    for (PetscInt k = S.far.begin(c); k < S.far.end(c); ++k) S.far.value[k] = give(far_of_coarse_[at(S.far.column[k])]);
  }
  all_ = false;
  return ok;
}

}  // namespace perp::petsc
