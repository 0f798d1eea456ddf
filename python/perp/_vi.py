# SPDX-License-Identifier: Apache-2.0
"""Variational inequalities over polyhedra."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
import numpy.typing as npt

from perp import _library
from perp._arrays import address, bound, doubles, is_sparse, matrix, refuse, shape_of, split_bounds
from perp._problem import Problem, affine_problem, asked, function_problem, listeners_of, solver_of
from perp._result import Field, Fields, Interrupted, Record, numbers_of
from perp._types import Array, Bound, Bounds, Function, Jacobian, Matrix, Options


class ViResult(Record):
    """What `vi` found."""

    x: Field[Array] = Field("Shape (n,): the best point met.")
    F: Field[Array] = Field("Shape (n,): F(x).")
    status: Field[str] = Field('"Solved", "SolvedToRounding", "Infeasible", ... (docs/python.md).')
    success: Field[bool] = Field("Whether the natural residual is at most the tolerance.", bool)
    message: Field[str] = Field("What happened.")
    residual: Field[float] = Field(
        "A bound of the natural residual ||x - P(x - F(x))||_inf, P the projection on C: the error of P is in it, and of affine F "
        "that of F."
    )
    projection_error: Field[float] = Field("How much of it is the bound of these errors.")
    worst: Field[int] = Field("The variable where it is largest; -1: none.")
    multipliers: Field[Array] = Field(
        "Shape (m,), of the rows: F = A'multipliers + reduced, at least 0 at b, at most 0 at c, 0 between."
    )
    reduced: Field[Array] = Field("Shape (n,), of the bounds: the same.")
    rows: Field[npt.NDArray[np.int8]] = Field("Shape (m,): 0 active at b, 1 between, 2 active at c, 3 equation.")
    bounds: Field[npt.NDArray[np.int8]] = Field("Shape (n,): 0 active at lower, 1 between, 2 active at upper, 3 fixed.")
    empty: Field[bool] = Field("Whether C is proven to be empty.", bool)
    certificate: Field[Array] = Field(
        "Of Infeasible: multipliers of the lifted problem's rows (x, then the rows) that prove it; empty: none."
    )
    iterations: Field[int] = Field("Pivots on faces, or the method's.")
    stats: Field[dict[str, Any]] = Field("Of the complementarity problem with multipliers, where it was solved.", numbers_of)


def vi(
    F: Function | Problem | tuple[Matrix, npt.ArrayLike],
    x0: npt.ArrayLike | None = None,
    A: Matrix | None = None,
    b: Bound = None,
    c: Bound = None,
    lower: Bound = -np.inf,
    upper: Bound = np.inf,
    jac: Jacobian | bool | str | None = None,
    *,
    bounds: Bounds | None = None,
    args: Any = (),
    pattern: Matrix | None = None,
    method: str | None = None,
    options: Options | None = None,
    **more: object,
) -> ViResult:
    """Solves the variational inequality over C = {b <= A x <= c, lower <= x <= upper}:

        find x in C with F(x)'(y - x) >= 0 for all y in C.

    F       a pair (M, q) for F(x) = M x + q; or x -> F(x), with jac, args and pattern as of `perp.solve`; or a Problem,
            with its own bounds.
    x0      shape (n,); needed for a function. None: the start of a Problem. Affine F needs none.
    A       shape (m, n), dense or scipy.sparse; None: no rows.
    b, c    a number for all, or shape (m,); -inf and inf are no sides, equal ones an equation. None: -inf and inf; with
            neither, b = 0.
    lower, upper, bounds
            as of `perp.solve`, but that there are none by default.
    method, options, more
            as of `perp.solve`; for affine F only the tolerance and the limit of time count.
    """
    if isinstance(F, Problem):
        problem = F
    elif isinstance(F, tuple):
        if len(F) != 2:
            refuse("F", f"is a tuple of {len(F)}, and must be a function, a Problem or a pair (M, q)")
        problem = affine_problem(*F, *split_bounds(bounds, lower, upper))
    else:
        problem = function_problem(F, x0, lower, upper, jac, pattern, bounds, args)
    n = problem.size
    if A is None:
        A, b, c = np.empty((0, n)), 0.0, None
    elif not is_sparse(A):
        A = doubles(A, "A")
    rows, kept = matrix(A, "A", shape_of(A, "A")[0], n)
    m = rows.rows
    low = bound(-np.inf if b is None and c is not None else b, m, 0.0, "b")
    high = bound(c, m, np.inf, "c")
    start = problem._start(x0)
    handle, interrupt = problem._work(
        _library.lib.perp_vi,
        ctypes.byref(rows),
        *(None if side is None or not m else address(side) for side in (low, high)),
        None if start is None else address(start),
        solver=solver_of(asked(method, options, more)),
        listeners=listeners_of(None, None),
    )
    del kept
    result = ViResult(Fields(handle))
    if interrupt is not None:
        raise Interrupted(result) from interrupt
    return result
