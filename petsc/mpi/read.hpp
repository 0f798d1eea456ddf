// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Matrices and vectors from files onto the ranks of PETSC_COMM_WORLD. Each rank gets its own rows only:
///  * PETSc's binary format, as MatView and VecView write it (matrices of any size that the ranks together hold);
///  * Matrix Market, by the ending .mtx: coordinate, real, integer or pattern, general, symmetric or skew-symmetric,
///    and array for vectors. Every rank reads through the file, twice, and keeps what is its own.
/// What is wrong with a file is told on every rank, in `wrong`; PETSc's own errors come back as codes.
#include <string>

#include "petsc/handle.hpp"

namespace perp::petsc {

/// A square matrix of type aij, whose pattern has the whole diagonal.
PetscErrorCode read_matrix(const std::string& path, OwnMat& M, std::string& wrong);

/// The text of the first rank that has one becomes everybody's.
PetscErrorCode share(std::string& text);

/// A vector laid out like the rows of M. `bounds`: values of size 1e20 or more, and inf, are PETSC_INFINITY; else they
/// are refused.
PetscErrorCode read_vector(const std::string& path, Mat M, bool bounds, OwnVec& v, std::string& wrong);

}  // namespace perp::petsc
