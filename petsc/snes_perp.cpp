// SPDX-License-Identifier: Apache-2.0
#include "petsc/snes_perp.hpp"

#include <petsc/private/snesimpl.h>

#include <memory>

#include "petsc/solver.hpp"
#include "petsc/users_functions.hpp"

namespace perp::petsc {
namespace {

/// snes->data.
struct Data {
  PetscBool multigrid = PETSC_TRUE;
  std::unique_ptr<Solver> solver;  ///< from setup to reset
};
Data& data_of(SNES snes) { return *static_cast<Data*>(snes->data); }

PetscErrorCode bounds_of_dm(SNES snes, Vec lower, Vec upper) { return DMComputeVariableBounds(snes->dm, lower, upper); }

/// snes->xl and xu, from whoever knows them.
PetscErrorCode take_bounds(SNES snes) {
  if (snes->usersetbounds) return ok;
  if (snes->ops->computevariablebounds == nullptr && snes->dm != nullptr) {
    PetscBool has = PETSC_FALSE;
    PetscCall(DMHasVariableBounds(snes->dm, &has));
    if (has) snes->ops->computevariablebounds = bounds_of_dm;
  }
  const bool computed = snes->ops->computevariablebounds != nullptr;
  if (!computed && snes->xl != nullptr && snes->xu != nullptr) return ok;
  if (snes->xl == nullptr) PetscCall(VecDuplicate(snes->vec_sol, &snes->xl));
  if (snes->xu == nullptr) PetscCall(VecDuplicate(snes->vec_sol, &snes->xu));
  PetscCall(VecSet(snes->xl, PETSC_NINFINITY));
  PetscCall(VecSet(snes->xu, PETSC_INFINITY));
  if (computed) PetscCall((*snes->ops->computevariablebounds)(snes, snes->xl, snes->xu));
  return ok;
}

/// On this rank.
PetscErrorCode check_sizes(SNES snes) {
  PetscInt sizes[3];
  PetscCall(VecGetLocalSize(snes->vec_sol, &sizes[0]));
  PetscCall(VecGetLocalSize(snes->xl, &sizes[1]));
  PetscCall(VecGetLocalSize(snes->xu, &sizes[2]));
  PetscCheck(sizes[0] == sizes[1] && sizes[0] == sizes[2], PETSC_COMM_SELF, PETSC_ERR_ARG_SIZ,
             "perp: this rank has %" PetscInt_FMT " variables, %" PetscInt_FMT " lower and %" PetscInt_FMT
             " upper bounds",
             sizes[0], sizes[1], sizes[2]);
  return ok;
}

PetscErrorCode set_up(SNES snes) {
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(snes));
  PetscCall(SNESSetUpMatrices(snes));
  PetscCall(on_every_rank(comm, take_bounds(snes), "the function of the bounds"));
  PetscCall(on_every_rank(comm, check_sizes(snes), "the check of the bounds' sizes"));
  Data& data = data_of(snes);
  data.solver = std::make_unique<Solver>(data.multigrid == PETSC_TRUE);
  return data.solver->set_up(snes);
}

PetscErrorCode solve(SNES snes) { return data_of(snes).solver->solve(snes); }

PetscErrorCode reset(SNES snes) {
  if (data_of(snes).solver != nullptr) PetscCall(data_of(snes).solver->release());
  data_of(snes).solver.reset();
  PetscCall(VecDestroy(&snes->xl));
  PetscCall(VecDestroy(&snes->xu));
  snes->usersetbounds = PETSC_FALSE;
  return ok;
}

PetscErrorCode destroy(SNES snes) {
  PetscCall(reset(snes));
  delete static_cast<Data*>(snes->data);
  snes->data = nullptr;
  return ok;
}

PetscErrorCode set_from_options(SNES snes, PetscOptionItems* PetscOptionsObject) {
  PetscBool& multigrid = data_of(snes).multigrid;
  PetscOptionsHeadBegin(PetscOptionsObject, "SNES perp options");
  PetscCall(PetscOptionsBool("-snes_perp_multigrid", "Truncated multigrid where the DM can be coarsened", "", multigrid,
                             &multigrid, nullptr));
  PetscOptionsHeadEnd();
  return ok;
}

PetscErrorCode view(SNES snes, PetscViewer viewer) {
  const Data& data = data_of(snes);
  PetscBool text = PETSC_FALSE;
  PetscCall(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(viewer), PETSCVIEWERASCII, &text));
  if (!text || data.solver == nullptr) return ok;
  const Counts& c = data.solver->counts();
  if (data.solver->uses_multigrid())
    PetscCall(PetscViewerASCIIPrintf(viewer, "  truncated multigrid on %d levels\n",
                                     static_cast<int>(data.solver->levels())));
  return PetscViewerASCIIPrintf(viewer,
                                "  active-set steps=%" PetscInt_FMT ", semismooth steps=%" PetscInt_FMT
                                ", Jacobians=%" PetscInt_FMT ", faces factored=%" PetscInt_FMT
                                ", V-cycles=%" PetscInt_FMT "\n  natural residual: max %g in row %" PetscInt_FMT "\n",
                                c.steps, c.semismooth, c.jacobians, c.faces, c.cycles, static_cast<double>(c.worst),
                                c.row);
}

PetscErrorCode create(SNES snes) {
  snes->data = new Data;
  snes->usesksp = PETSC_TRUE;
  snes->usesnpc = PETSC_FALSE;
  snes->alwayscomputesfinalresidual = PETSC_TRUE;
  snes->ops->setup = set_up;
  snes->ops->solve = solve;
  snes->ops->reset = reset;
  snes->ops->destroy = destroy;
  snes->ops->setfromoptions = set_from_options;
  snes->ops->view = view;
  return ok;
}

}  // namespace

PetscErrorCode register_snes_perp() { return SNESRegister(snes_type, create); }

PetscErrorCode counts_of(SNES snes, Counts* counts) {
  PetscBool is_perp = PETSC_FALSE;
  PetscCall(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(snes), snes_type, &is_perp));
  PetscCheck(is_perp, PetscObjectComm(reinterpret_cast<PetscObject>(snes)), PETSC_ERR_ARG_WRONG,
             "perp: the SNES is not of type %s", snes_type);
  const Data& data = data_of(snes);
  *counts = data.solver == nullptr ? Counts{} : data.solver->counts();
  return ok;
}

}  // namespace perp::petsc

/// What PETSc looks for in libperp_petsc.so (-dll_append, or PETSC_OPTIONS with it).
extern "C" __attribute__((visibility("default"))) PetscErrorCode PetscDLLibraryRegister_perp_petsc();
PetscErrorCode PetscDLLibraryRegister_perp_petsc() { return perp::petsc::register_snes_perp(); }
