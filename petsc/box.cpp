// SPDX-License-Identifier: Apache-2.0
#include "petsc/box.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace perp::petsc {

PetscErrorCode check_box(const Box& box) {
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(box.lower));
  PetscInt begin = 0;
  PetscCall(VecGetOwnershipRange(box.lower, &begin, nullptr));
  PetscInt first = std::numeric_limits<PetscInt>::max();
  PetscReal bounds[2] = {-std::numeric_limits<PetscReal>::max(), -std::numeric_limits<PetscReal>::max()};
  {
    const Reading l(box.lower);
    const Reading u(box.upper);
    for (PetscInt i = l.size(); i-- > 0;)
      if (!(l[i] <= u[i]) || l[i] >= infinite || u[i] <= -infinite) first = begin + i;
    if (first >= begin && first < begin + l.size()) {
      bounds[0] = l[first - begin];
      bounds[1] = u[first - begin];
    }
  }
  const PetscInt mine = first;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPIU_INT, MPI_MIN, comm));
  if (first == std::numeric_limits<PetscInt>::max()) return ok;
  // The rank that owns the row tells the others; NaN does not survive MPI_MAX, so that it is said in words.
  PetscInt nan = mine == first && (std::isnan(bounds[0]) || std::isnan(bounds[1])) ? 1 : 0;
  if (mine != first || nan != 0) bounds[0] = bounds[1] = -std::numeric_limits<PetscReal>::max();
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &nan, 1, MPIU_INT, MPI_MAX, comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, bounds, 2, MPIU_REAL, MPIU_MAX, comm));
  PetscCheck(nan == 0, comm, PETSC_ERR_ARG_OUTOFRANGE, "perp: a bound of variable %" PetscInt_FMT " is not a number",
             first);
  PetscCheck(bounds[0] > bounds[1], comm, PETSC_ERR_ARG_OUTOFRANGE,
             "perp: the bounds of variable %" PetscInt_FMT " admit no number: the lower is %g, the upper %g", first,
             static_cast<double>(bounds[0]), static_cast<double>(bounds[1]));
  SETERRQ(comm, PETSC_ERR_ARG_OUTOFRANGE,
          "perp: the bounds of variable %" PetscInt_FMT " cross: the lower is %g, the upper %g", first,
          static_cast<double>(bounds[0]), static_cast<double>(bounds[1]));
}

PetscErrorCode project(const Box& box, Vec x) {
  const Reading l(box.lower);
  const Reading u(box.upper);
  Values values(x);
  for (PetscInt i = 0; i < l.size(); ++i) values[i] = std::min(std::max(values[i], l[i]), u[i]);
  return ok;
}

PetscErrorCode natural_residual(const Box& box, Vec x, Vec F, Residual* residual) {
  struct {
    double value;
    int rank;
  } worst{0, 0};
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(x));
  PetscInt row = -1;
  PetscInt begin = 0;
  PetscReal sum = 0;
  PetscCall(VecGetOwnershipRange(x, &begin, nullptr));
  PetscCallMPI(MPI_Comm_rank(comm, &worst.rank));
  {
    const Reading l(box.lower);
    const Reading u(box.upper);
    const Reading at(x);
    const Reading value(F);
    for (PetscInt i = 0; i < at.size(); ++i) {
      const PetscReal r = std::abs(row_residual(l[i], u[i], at[i], value[i]));
      sum += std::isfinite(at[i]) && std::isfinite(value[i]) ? r * r : std::numeric_limits<PetscReal>::quiet_NaN();
      if (r > worst.value) {
        worst.value = r;
        row = begin + i;
      }
    }
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPIU_REAL, MPIU_SUM, comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE_INT, MPI_MAXLOC, comm));
  PetscCallMPI(MPI_Bcast(&row, 1, MPIU_INT, worst.rank, comm));
  *residual = {.norm = std::sqrt(sum), .worst = worst.value, .row = row};
  return ok;
}

}  // namespace perp::petsc
