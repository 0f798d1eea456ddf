#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Two problems of finite elements by dolfinx 0.5, as a user of SNESVI writes them:

    finite_elements.py obstacle|signorini OUT [N [PETSC OPTIONS]]

obstacle: a membrane over an obstacle. signorini: an elastic body, pressed down, over a rigid plane that it touches in
part. Writes the solution to OUT, ordered by the coordinates of the nodes; rank 0 prints the reason, the steps and the
natural residual, which numpy computes from F alone.
"""

import sys

try:
    import dolfinx.fem.petsc
    import ufl
    from dolfinx import fem, mesh
    from mpi4py import MPI
    from petsc4py import PETSc
except ImportError as missing:
    print(f"skipped: {missing} (Debian: python3-dolfinx)")
    sys.exit(77)

import numpy as np


class Problem:
    """F(u) = 0 inside the bounds, in the way of dolfinx's demonstrations of SNES."""

    def __init__(self, form, u, conditions):
        self.u, self.conditions = u, conditions
        self.form = fem.form(form)
        self.jacobian = fem.form(ufl.derivative(form, u))
        self.vector = fem.petsc.create_vector(self.form)
        self.matrix = fem.petsc.create_matrix(self.jacobian)

    def F(self, snes, x, F):
        x.ghostUpdate(PETSc.InsertMode.INSERT, PETSc.ScatterMode.FORWARD)
        x.copy(self.u.vector)
        self.u.x.scatter_forward()
        with F.localForm() as local:
            local.set(0)
        fem.petsc.assemble_vector(F, self.form)
        fem.petsc.apply_lifting(F, [self.jacobian], [self.conditions], [x], -1.0)
        F.ghostUpdate(PETSc.InsertMode.ADD, PETSc.ScatterMode.REVERSE)
        fem.petsc.set_bc(F, self.conditions, x, -1.0)

    def J(self, snes, x, J, P):
        J.zeroEntries()
        fem.petsc.assemble_matrix(J, self.jacobian, self.conditions)
        J.assemble()


def membrane(n):
    square = mesh.create_unit_square(MPI.COMM_WORLD, n, n)
    V = fem.FunctionSpace(square, ("Lagrange", 1))
    u, v = fem.Function(V), ufl.TestFunction(V)
    edge = fem.locate_dofs_geometrical(V, lambda x: np.any(np.isclose(x[:2], 0) | np.isclose(x[:2], 1), axis=0))
    conditions = [fem.dirichletbc(PETSc.ScalarType(0), edge, V)]
    lower, upper = fem.Function(V), fem.Function(V)
    lower.interpolate(lambda x: 0.25 - 8 * ((x[0] - 0.4) ** 2 + (x[1] - 0.45) ** 2))
    lower.x.array[edge] = PETSc.NINFINITY
    upper.x.array[:] = PETSc.INFINITY
    form = ufl.inner(ufl.grad(u), ufl.grad(v)) * ufl.dx + 4 * v * ufl.dx
    return Problem(form, u, conditions), lower, upper


def body(n):
    square = mesh.create_unit_square(MPI.COMM_WORLD, n, n)
    V = fem.VectorFunctionSpace(square, ("Lagrange", 1))
    u, v = fem.Function(V), ufl.TestFunction(V)
    top = fem.locate_dofs_geometrical(V, lambda x: np.isclose(x[1], 1))
    pressed = fem.Constant(square, PETSc.ScalarType((0, -0.1)))
    conditions = [fem.dirichletbc(pressed, top, V)]
    strain = lambda w: ufl.sym(ufl.grad(w))
    lame, shear = 1.0, 0.5
    stress = lame * ufl.tr(strain(u)) * ufl.Identity(2) + 2 * shear * strain(u)
    lower, upper = fem.Function(V), fem.Function(V)
    lower.x.array[:] = PETSc.NINFINITY
    upper.x.array[:] = PETSc.INFINITY
    bottom = fem.locate_dofs_geometrical(V, lambda x: np.isclose(x[1], 0))
    gap = 0.02 + 0.2 * (V.tabulate_dof_coordinates()[bottom, 0] - 0.4) ** 2  # the bottom is rounded, the plane is not
    lower.x.array[2 * bottom + 1] = -gap
    return Problem(ufl.inner(stress, strain(v)) * ufl.dx, u, conditions), lower, upper


def write(path, V, u):
    """Ordered by coordinates; gathering is for the test alone."""
    size = V.dofmap.index_map.size_local
    width = V.dofmap.index_map_bs
    nodes = np.round(V.tabulate_dof_coordinates()[:size, :2], 9)
    gathered = MPI.COMM_WORLD.gather((nodes, u.array_r.reshape(size, width)))
    if MPI.COMM_WORLD.rank == 0:
        nodes = np.concatenate([part[0] for part in gathered])
        values = np.concatenate([part[1] for part in gathered])[np.lexsort(nodes.T)].ravel()
        with open(path, "wb") as file:
            file.write(np.array([1211214, values.size], ">i4").tobytes() + values.astype(">f8").tobytes())


def main():
    name, out = sys.argv[1:3]
    n = int(sys.argv[3]) if len(sys.argv) > 3 else 32
    problem, lower, upper = {"obstacle": membrane, "signorini": body}[name](n)
    u = problem.u.vector.copy()
    snes = PETSc.SNES().create()
    snes.setFunction(problem.F, problem.vector)
    snes.setJacobian(problem.J, problem.matrix)
    snes.setVariableBounds(lower.vector, upper.vector)
    snes.setTolerances(atol=1e-12, rtol=0)
    snes.setFromOptions()
    start = MPI.Wtime()
    snes.solve(None, u)
    seconds = MPI.Wtime() - start

    F = problem.vector.copy()
    problem.F(snes, u, F)
    x, l, r = u.array_r, lower.vector.array_r, upper.vector.array_r
    residual = np.abs(x - np.minimum(np.maximum(l, x - F.array_r), r))
    worst = MPI.COMM_WORLD.allreduce(float(residual.max(initial=0)), MPI.MAX)
    active = MPI.COMM_WORLD.allreduce(int(np.sum(x == l)))
    PETSc.Sys.Print(
        f"{name} {u.getSize()}: {snes.getType()}: reason {snes.getConvergedReason()}, {snes.getIterationNumber()} steps, "
        f"{snes.getLinearSolveIterations()} KSP iterations, {seconds:.2f} s, {active} at a bound, residual {worst:.1e}"
    )
    write(out, problem.u.function_space, u)
    return 0 if snes.getConvergedReason() > 0 and worst <= 1e-10 and active > 3 else 1


if __name__ == "__main__":
    sys.exit(main())
