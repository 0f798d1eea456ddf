// SPDX-License-Identifier: Apache-2.0
#pragma once
/// An elastic square, n x n points with two displacements each, pressed down by 0.1 on a rigid plane under its rounded
/// bottom: plane strain, bilinear elements. As many users do, the rows of the given displacements on top are replaced
/// by those of the identity, and their columns are left as they are.
#include <petscdmda.h>
#include <petscsnes.h>

namespace perp::petsc_tests {

struct ElasticBody {
  DM dm = nullptr;
  Mat stiffness = nullptr;  ///< F = stiffness x - load
  Vec load = nullptr, lower = nullptr, upper = nullptr;
};

PetscErrorCode make_elastic_body(PetscInt n, ElasticBody* body);
/// From x = 0, with the options of the SNES.
PetscErrorCode make_snes(ElasticBody* body, SNES* snes);
PetscErrorCode destroy(ElasticBody* body);

}  // namespace perp::petsc_tests
