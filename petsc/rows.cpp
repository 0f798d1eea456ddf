// SPDX-License-Identifier: Apache-2.0
#include "petsc/rows.hpp"

#include <petsc/private/petscimpl.h>

#include <algorithm>
#include <cmath>

namespace perp::petsc {
namespace {

/// Values that look random, the same on any number of ranks: those of the rows' numbers, mixed.
PetscErrorCode made_up(Vec v, std::uint64_t seed) {
  PetscInt begin = 0;
  PetscInt end = 0;
  PetscCall(VecGetOwnershipRange(v, &begin, &end));
  Values values(v);
  for (PetscInt i = begin; i < end; ++i) {
    std::uint64_t h = (static_cast<std::uint64_t>(i) + seed) * 0x9E3779B97F4A7C15ULL;
    h = (h ^ (h >> 29)) * 0xBF58476D1CE4E5B9ULL;
    values[i - begin] = static_cast<double>(h >> 40) / static_cast<double>(1 << 24) - 0.5;
  }
  return ok;
}

}  // namespace

PetscErrorCode check_is_aij(Mat J) {
  PetscBool rows = PETSC_FALSE;
  PetscCall(PetscObjectBaseTypeCompareAny(reinterpret_cast<PetscObject>(J), &rows, MATSEQAIJ, MATMPIAIJ, ""));
  PetscCheck(
      rows, PetscObjectComm(reinterpret_cast<PetscObject>(J)), PETSC_ERR_SUP,
      "perp: the matrix is of type %s; type perp needs aij (-mat_type aij, or SNESSetJacobian with an aij matrix "
      "as the second)",
      reinterpret_cast<PetscObject>(J)->type_name);
  return ok;
}

PetscErrorCode lonely_rows(Mat A, const Box& box, Vec lonely) {
  PetscInt begin = 0;
  PetscInt end = 0;
  PetscCall(MatGetOwnershipRange(A, &begin, &end));
  const Reading l(box.lower);
  const Reading u(box.upper);
  Values marks(lonely);
  for (PetscInt i = begin; i < end; ++i) {
    PetscInt n = 0;
    const PetscInt* column = nullptr;
    const PetscScalar* value = nullptr;
    PetscCall(MatGetRow(A, i, &n, &column, &value));
    bool diagonal = false;
    bool other = false;
    for (PetscInt s = 0; s < n; ++s) (column[s] == i ? diagonal : other) |= value[s] != 0;
    PetscCall(MatRestoreRow(A, i, &n, &column, &value));
    const bool free = l[i - begin] <= -infinite && u[i - begin] >= infinite;
    marks[i - begin] = diagonal && !other && free ? 1 : 0;
  }
  return ok;
}

PetscErrorCode lonely_step(const BoxProblem& p, Vec lonely, Vec step) {
  const Reading marks(lonely);
  const Reading d(p.diagonal);
  const Reading g(p.g);
  Values s(step);
  for (PetscInt i = 0; i < g.size(); ++i) s[i] = marks[i] != 0 ? -g[i] / d[i] : 0;
  return ok;
}

PetscErrorCode sweep_step(const BoxProblem& p, Vec open, Vec step) {
  Mat own = nullptr;
  PetscInt rows = 0;
  const PetscInt* start = nullptr;
  const PetscInt* column = nullptr;
  const PetscScalar* value = nullptr;
  PetscBool done = PETSC_FALSE;
  PetscCall(MatGetDiagonalBlock(p.A, &own));
  PetscCall(MatGetRowIJ(own, 0, PETSC_FALSE, PETSC_FALSE, &rows, &start, &column, &done));
  PetscCall(MatSeqAIJGetArrayRead(own, &value));
  {
    const Reading d(p.diagonal);
    const Reading l(p.box.lower);
    const Reading u(p.box.upper);
    const Reading z(p.z);
    const Reading g(p.g);
    const Reading o(open);
    Values s(step);
    for (PetscInt i = 0; i < rows; ++i) s[i] = 0;
    const auto relax = [&](PetscInt i) {
      if (!(d[i] > 0) || o[i] == 0) return;
      PetscScalar residual = g[i];
      for (PetscInt k = start[i]; k < start[i + 1]; ++k) residual += value[k] * s[column[k]];
      s[i] = std::min(std::max(s[i] - residual / d[i], l[i] - z[i]), u[i] - z[i]);
    };
    for (PetscInt i = 0; i < rows; ++i) relax(i);
    for (PetscInt i = rows; i-- > 0;) relax(i);
  }
  PetscCall(MatSeqAIJRestoreArrayRead(own, &value));
  return MatRestoreRowIJ(own, 0, PETSC_FALSE, PETSC_FALSE, &rows, &start, &column, &done);
}

PetscErrorCode looks_symmetric(Mat A, Vec free, bool* symmetric) {
  OwnVec u;
  OwnVec v;
  OwnVec w;
  for (OwnVec* made : {&u, &v, &w}) PetscCall(VecDuplicate(free, made->out()));
  PetscCall(made_up(u, 17));
  PetscCall(made_up(v, 4711));
  PetscCall(VecPointwiseMult(u, u, free));
  PetscCall(VecPointwiseMult(v, v, free));
  PetscScalar uAv = 0;
  PetscScalar vAu = 0;
  PetscReal size[3];
  PetscCall(MatMult(A, v, w));
  PetscCall(VecPointwiseMult(w, w, free));
  PetscCall(VecDot(u, w, &uAv));
  PetscCall(VecNorm(w, NORM_2, &size[0]));
  PetscCall(MatMult(A, u, w));
  PetscCall(VecDot(v, w, &vAu));
  PetscCall(VecNorm(u, NORM_2, &size[1]));
  // The dot products of unrelated vectors are small beside |u| |A v|; 1e-10 of that is beyond rounding, and below what
  // a first derivative adds.
  *symmetric = std::abs(uAv - vAu) <= 1e-10 * size[0] * size[1];
  return ok;
}

PetscErrorCode cut_off(Mat A, Vec mask, Vec diagonal) {
  PetscCall(MatDiagonalScale(A, mask, mask));
  return set_cut_off_diagonal(A, mask, diagonal);
}

PetscErrorCode set_cut_off_diagonal(Mat A, Vec mask, Vec diagonal) {
  OwnVec rest;
  PetscCall(VecDuplicate(mask, rest.out()));
  {
    const Reading m(mask);
    const Reading d(diagonal);
    Values r(rest);
    for (PetscInt i = 0; i < m.size(); ++i) r[i] = m[i] != 0 ? 0 : d[i] > 0 ? d[i] : 1;
  }
  return MatDiagonalSet(A, rest, ADD_VALUES);
}

}  // namespace perp::petsc
