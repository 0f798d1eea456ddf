# SPDX-License-Identifier: Apache-2.0
"""The functions that solve at once."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from perp import _core
from perp._problem import Problem, asked, listener, listener_of_iterations, problem
from perp._result import AllSolutions, Result, Sensitivity, Verified, finished
from perp._types import Bound, Callback, Function, Jacobian, LogTo, Matrix, Options


def solve(
    F: Function,
    x0: npt.ArrayLike,
    lower: Bound = 0,
    upper: Bound = np.inf,
    jac: Jacobian | None = None,
    *,
    pattern: Matrix | None = None,
    method: str | None = None,
    options: Options | None = None,
    basis: npt.ArrayLike | None = None,
    callback: Callback | None = None,
    log: LogTo = None,
    **more: object,
) -> Result:
    """Solves MCP(lower, upper, F) from x0.

    F       x -> F(x), both of shape (n,). nan or inf where F is not defined. An exception in F ends the solve and is
            raised as it is.
    x0      shape (n,), moved into the bounds first.
    lower, upper
            a number for all, or shape (n,); -inf and inf are no bounds.
    jac     x -> F'(x), shape (n, n), dense or scipy.sparse. A sparse one has the same pattern everywhere, that of x0,
            zeros stored included, unless `pattern` says more. None: differences, one evaluation of F for each group of
            columns of the pattern that share no row, n for a dense one.
    pattern scipy.sparse or dense, shape (n, n): its entries are those of F' that can be nonzero.
    method  a name out of `perp.methods()`; None: "auto".
    options, more
            options by their names (`perp.options()`): solve(..., convergence_tolerance=1e-10, time_limit=60).
    basis   Result.basis of a nearby problem, shape (n,), to begin with.
    callback
            called with the row of each iteration and the iterate of shape (n,), or None; what is true ends the solve.
    log     True prints the table of iterations; a function gets each line.

    Ctrl-C raises perp.Interrupted, a KeyboardInterrupt whose .result has the best point.
    """
    core = _core.function_problem(F, x0, lower, upper, jac, pattern, "mcp", [], [])
    heard = listener_of_iterations(callback)
    return finished(core.solve(None, asked(method, options, more), basis, heard, listener(log)))


def lcp(
    M: Matrix,
    q: npt.ArrayLike,
    x0: npt.ArrayLike | None = None,
    *,
    method: str | None = None,
    options: Options | None = None,
    basis: npt.ArrayLike | None = None,
    callback: Callback | None = None,
    log: LogTo = None,
    **more: object,
) -> Result:
    """Solves the linear complementarity problem: x >= 0, M x + q >= 0, x'(M x + q) = 0.

    M       shape (n, n), dense or scipy.sparse. CSC with int32 indices in ascending rows is used where it is, and must
            not be changed during the call; anything else is copied once. Entries that stand twice are added.
    q       shape (n,).
    x0      shape (n,); None: 0.

    The rest is as in `solve`.
    """
    return mcp_affine(
        M, q, 0.0, None, x0, method=method, options=options, basis=basis, callback=callback, log=log, **more
    )


def mcp_affine(
    M: Matrix,
    q: npt.ArrayLike,
    lower: Bound = 0,
    upper: Bound = np.inf,
    x0: npt.ArrayLike | None = None,
    *,
    method: str | None = None,
    options: Options | None = None,
    basis: npt.ArrayLike | None = None,
    callback: Callback | None = None,
    log: LogTo = None,
    **more: object,
) -> Result:
    """Solves MCP(lower, upper, M x + q); M and q as of `lcp`, bounds and the rest as of `solve`."""
    heard = listener_of_iterations(callback)
    together = asked(method, options, more)
    return finished(_core.solve_affine(M, q, lower, upper, x0, together, basis, heard, listener(log)))


def solve_all(
    F: Function | Problem,
    x0: npt.ArrayLike | None = None,
    lower: Bound = 0,
    upper: Bound = np.inf,
    jac: Jacobian | None = None,
    *,
    pattern: Matrix | None = None,
    solutions: int = 10,
    method: str | None = None,
    options: Options | None = None,
    log: LogTo = None,
    **more: object,
) -> AllSolutions:
    """Several solutions, up to so many: the first by the method from x0, the others by deflation.

    F is a function, with the arguments of `solve`, or a Problem, with its own bounds and derivatives. Nothing says
    that all solutions are found.
    """
    if isinstance(F, Problem):
        return F.solve_all(x0, solutions=solutions, method=method, options={**(options or {}), **more}, log=log)
    if x0 is None:
        raise TypeError("x0: is None, and must be an array of numbers")
    of_functions = problem(F, x0, lower, upper, jac, pattern=pattern)
    return of_functions.solve_all(solutions=solutions, method=method, options={**(options or {}), **more}, log=log)


def sensitivity(
    F: Function | Problem,
    x: npt.ArrayLike,
    dF: Matrix,
    lower: Bound = 0,
    upper: Bound = np.inf,
    jac: Jacobian | None = None,
    *,
    pattern: Matrix | None = None,
    dlower: Matrix | None = None,
    dupper: Matrix | None = None,
    direction: npt.ArrayLike | None = None,
) -> Sensitivity:
    """How a solution x of MCP(lower(p), upper(p), F(.; p)) moves with m parameters p.

    F       a function, with lower, upper, jac and pattern as of `solve`, or a Problem.
    x       shape (n,), a solution.
    dF      dF/dp at x, shape (n, m), or (n,) for m = 1; dense or scipy.sparse.
    dlower, dupper
            the same of the bounds; None: they do not depend on p.
    direction
            shape (m,): the derivative in one direction only, which exists at degenerate solutions, too.
    """
    of_functions = F if isinstance(F, Problem) else problem(F, x, lower, upper, jac, pattern=pattern)
    return of_functions.sensitivity(x, dF, dlower=dlower, dupper=dupper, direction=direction)


def verify(problem: Problem, x: npt.ArrayLike) -> Verified:
    """Proves that exactly one solution of the problem is near x, shape (n,), and how near, with every rounding accounted
    for (Krawczyk's operator). For affine problems and models of .nl files; of Python's functions nothing is known
    between the points where they are evaluated."""
    if not isinstance(problem, Problem):
        raise TypeError(f"problem: is of type {type(problem).__name__}, and must be a perp.Problem")
    return problem.verify(x)
