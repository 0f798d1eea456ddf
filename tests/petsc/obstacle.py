#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A membrane over an obstacle by petsc4py, as a user of SNESVI writes it: obstacle.py OUT [PETSC OPTIONS].

Writes u to OUT in the natural order of the grid; rank 0 prints the reason, the steps and the natural residual, which
numpy computes from F alone.
"""

import sys

try:
    import petsc4py

    out = sys.argv.pop(1)
    petsc4py.init(sys.argv)
    import numpy as np
    from mpi4py import MPI
    from petsc4py import PETSc
except ImportError as missing:
    print(f"skipped: {missing} (Debian: python3-petsc4py)")
    sys.exit(77)

N = 65
h = 1 / (N - 1)


def boundary(i, j):
    return i == 0 or j == 0 or i == N - 1 or j == N - 1


def points(da):
    (xs, xe), (ys, ye) = da.getRanges()
    return ((i, j) for j in range(ys, ye) for i in range(xs, xe))


def function(snes, u, F):
    da = snes.getDM()
    local = da.getLocalVec()
    da.globalToLocal(u, local)
    v, f = da.getVecArray(local), da.getVecArray(F)
    for i, j in points(da):
        if boundary(i, j):
            f[i, j] = v[i, j]
        else:
            f[i, j] = 4 * v[i, j] - v[i - 1, j] - v[i + 1, j] - v[i, j - 1] - v[i, j + 1] + 4 * h * h
    da.restoreLocalVec(local)


def jacobian(snes, u, J, P):
    da = snes.getDM()
    row, column = PETSc.Mat.Stencil(), PETSc.Mat.Stencil()
    for i, j in points(da):
        row.index = column.index = (i, j)
        P.setValueStencil(row, column, 1.0 if boundary(i, j) else 4.0)
        if not boundary(i, j):
            for neighbour in ((i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1)):
                column.index = neighbour
                P.setValueStencil(row, column, -1.0)
    P.assemble()
    return True


da = PETSc.DMDA().create([N, N], dof=1, stencil_width=1, stencil_type=PETSc.DMDA.StencilType.STAR)
u = da.createGlobalVec()
lower, upper = u.duplicate(), u.duplicate()
psi = da.getVecArray(lower)
for i, j in points(da):
    psi[i, j] = -1e20 if boundary(i, j) else 0.25 - 8 * ((i * h - 0.4) ** 2 + (j * h - 0.45) ** 2)
upper.set(PETSc.INFINITY)

snes = PETSc.SNES().create()
snes.setDM(da)
snes.setFunction(function, u.duplicate())
snes.setJacobian(jacobian, da.createMat())
snes.setVariableBounds(lower, upper)
snes.setTolerances(atol=1e-12, rtol=0)
snes.setFromOptions()
snes.solve(None, u)

F = u.duplicate()
function(snes, u, F)
x, l, F_ = u.array_r, lower.array_r, F.array_r
worst = MPI.COMM_WORLD.allreduce(float(np.abs(x - np.maximum(l, x - F_)).max(initial=0)), MPI.MAX)
PETSc.Sys.Print(f"{snes.getType()}: reason {snes.getConvergedReason()}, {snes.getIterationNumber()} steps, residual {worst}")
viewer = PETSc.Viewer().createBinary(out, "w")
u.view(viewer)
viewer.destroy()
sys.exit(0 if snes.getConvergedReason() > 0 and worst <= 1e-10 else 1)
