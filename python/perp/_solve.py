# SPDX-License-Identifier: Apache-2.0
"""The functions that solve at once."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from perp import _library
from perp._arrays import split_bounds
from perp._problem import Problem, affine_handle, asked, function_problem, listeners_of, read_nl
from perp._result import AllSolutions, Explanation, Result, Sensitivity, Verified
from perp._session import Solver
from perp._types import Bound, Bounds, Callback, Function, Jacobian, LogTo, Matrix, Options, Path


def solve(
    F: Function,
    x0: npt.ArrayLike,
    lower: Bound = 0,
    upper: Bound = np.inf,
    jac: Jacobian | bool | str | None = None,
    *,
    bounds: Bounds | None = None,
    args: Any = (),
    pattern: Matrix | None = None,
    affine: bool = False,
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
    bounds  in place of lower and upper, as in scipy.optimize: pairs (low, high) with None for none, or a Bounds.
    jac     x -> F'(x), shape (n, n), dense or scipy.sparse. A sparse one has the same pattern everywhere, that of x0,
            zeros stored included, unless `pattern` says more. None: differences, one evaluation of F for each group of
            columns of the pattern that share no row, n for a dense one. True: F returns the pair of F and F', as in
            scipy.optimize. "jax", "casadi": exact and sparse, where F is written for arrays of these packages.
    args    more arguments of F and jac: F(x, *args).
    pattern scipy.sparse or dense, shape (n, n): its entries are those of F' that can be nonzero.
    affine  True: F(x) = F(0) + J x with one matrix J. It is solved as M x + q is, with proofs, and F is asked rarely.
    method  a name out of `perp.methods()`; None: "auto".
    options, more
            options by their names (`perp.options()`): solve(..., convergence_tolerance=1e-10, time_limit=60).
    basis   Result.basis of a nearby problem, shape (n,), to begin with.
    callback
            called with the row of each iteration and the iterate of shape (n,), or None; what is true ends the solve.
    log     True prints the table of iterations; a function gets each line.

    Ctrl-C raises perp.Interrupted, a KeyboardInterrupt whose .result has the best point.
    """
    asked_ = asked(method, options, more)
    listeners = listeners_of(callback, log)
    return function_problem(F, x0, lower, upper, jac, pattern, bounds, args, affine)._solve(None, asked_, basis, listeners)


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
    asked_ = asked(method, options, more)
    return Problem(affine_handle(M, q, None, None))._solve(x0, asked_, basis, listeners_of(callback, log))


def mcp_affine(
    M: Matrix,
    q: npt.ArrayLike,
    lower: Bound = 0,
    upper: Bound = np.inf,
    x0: npt.ArrayLike | None = None,
    *,
    bounds: Bounds | None = None,
    method: str | None = None,
    options: Options | None = None,
    basis: npt.ArrayLike | None = None,
    callback: Callback | None = None,
    log: LogTo = None,
    **more: object,
) -> Result:
    """Solves MCP(lower, upper, M x + q); M and q as of `lcp`, bounds and the rest as of `solve`."""
    asked_ = asked(method, options, more)
    made = Problem(affine_handle(M, q, *split_bounds(bounds, lower, upper)))
    return made._solve(x0, asked_, basis, listeners_of(callback, log))


def solve_all(
    F: Function | Problem,
    x0: npt.ArrayLike | None = None,
    lower: Bound = 0,
    upper: Bound = np.inf,
    jac: Jacobian | bool | str | None = None,
    *,
    bounds: Bounds | None = None,
    args: Any = (),
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
    if not isinstance(F, Problem):
        F, x0 = function_problem(F, x0, lower, upper, jac, pattern, bounds, args), None
    return F.solve_all(x0, solutions=solutions, method=method, options={**(options or {}), **more}, log=log)


def sensitivity(
    F: Function | Problem,
    x: npt.ArrayLike,
    dF: Matrix,
    lower: Bound = 0,
    upper: Bound = np.inf,
    jac: Jacobian | bool | str | None = None,
    *,
    bounds: Bounds | None = None,
    args: Any = (),
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
    if not isinstance(F, Problem):
        F = function_problem(F, x, lower, upper, jac, pattern, bounds, args)
    return F.sensitivity(x, dF, dlower=dlower, dupper=dupper, direction=direction)


def explain(problem: Problem | Path, x0: npt.ArrayLike | None = None, *, seconds: float = 30) -> Explanation:
    """Why a model has no solution, which row is the cause, and what would mend it; or what in it looks like a slip although
    it has one. Of a problem or of an .nl file; x0, shape (n,), as in `solve`; seconds: for all of it."""
    model = problem if isinstance(problem, Problem) else read_nl(problem)
    return model.explain(x0, seconds=seconds)


def verify(problem: Problem, x: npt.ArrayLike) -> Verified:
    """Proves that exactly one solution of the problem is near x, shape (n,), and how near, with every rounding accounted
    for (Krawczyk's operator). For affine problems and models of .nl files; of Python's functions nothing is known
    between the points where they are evaluated."""
    if not isinstance(problem, Problem):
        raise TypeError(f"problem: is of type {type(problem).__name__}, and must be a perp.Problem")
    return problem.verify(x)


class KeptSolver:
    """A solver that is kept between solves of neighbouring problems: parametric runs, games, receding horizons.

    It begins with the active set and the factors of the last solution, as long as problems have the same pattern of J.
    """

    def __init__(self, method: str | None = None, *, options: Options | None = None, **more: object) -> None:
        self._options = asked(method, options, more)
        self._solver = Solver(self._options)

    def solve(self, problem: Problem, x0: npt.ArrayLike | None = None) -> Result:
        """Solves the problem. x0, shape (n,), is for the first solve, and where the last solution does not help; without
        it the problem's own start. `kept_by` of the result says what it took."""
        if not isinstance(problem, Problem):
            raise TypeError(f"problem: is of type {type(problem).__name__}, and must be a perp.Problem")
        return problem._solved(_library.lib.perp_solve_kept, x0, solver=self._solver)

    def forget(self) -> None:
        """Forgets the last solution."""
        self._solver = Solver(self._options)
