# SPDX-License-Identifier: Apache-2.0
"""Many problems of one kind at once."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from perp import _library
from perp._arrays import address, doubles, refuse
from perp._library import INTERFACE, call
from perp._problem import _count
from perp._result import Shown
from perp._solve import solve
from perp._types import Array, Bound

#: Newton steps on all problems together; what needs more is solved alone.
_STEPS = 50


@dataclass(frozen=True, eq=False)
class BatchResult(Shown):
    """What `batch` found, an entry or a row for each problem."""

    x: Array
    """Shape (count, n)."""
    success: npt.NDArray[np.bool_]
    """Whether the natural residual is at most the tolerance."""
    status: list[str]
    """As of `Result`."""
    residual: Array
    """The natural residuals; with rows, with the error of the projection."""
    multipliers: Array
    """Shape (count, m): of the rows of A."""


def batch(
    F: Callable[[Array, Any], npt.ArrayLike] | tuple[npt.ArrayLike, npt.ArrayLike],
    x0: npt.ArrayLike | None = None,
    lower: npt.ArrayLike = 0,
    upper: npt.ArrayLike = np.inf,
    jac: Callable[[Array, Any], npt.ArrayLike] | None = None,
    *,
    parameters: npt.ArrayLike | None = None,
    A: npt.ArrayLike | None = None,
    b: npt.ArrayLike | None = None,
    c: npt.ArrayLike | None = None,
    tol: float = 1e-9,
    threads: int = 0,
) -> BatchResult:
    """Solves many small dense problems of one size at once.

    With a pair F = (M, q), of affine problems: MCP(lower, upper, M x + q), or with rows A the variational inequalities
    of `perp.vi`. What is the same for all problems is given once; what is not has an axis more, the first:

    M       (n, n) or (count, n, n).
    q       (n,) or (count, n); lower, upper alike, or a number.
    A       (m, n) or (count, m, n); b, c  (m,) or (count, m), or a number. None: -inf and inf; with
            neither, b = 0.
    threads 0: one for each processor. The results do not depend on it, nor on the order of the problems, to the bit.

    With a function, of MCP(lower, upper, F(., p)) for each of the parameters, with x0, lower and upper as above:

    F       (x, p) -> F(x, p) for arrays of shapes (k, n) and (k, ...): some of the problems, a row each. The answer has
            shape (k, n), and row i depends on row i of x and p alone.
    parameters
            shape (count, ...).
    jac     the same of F', shape (k, n, n); None: differences.

    Newton's method runs on all together, and `perp.solve` on each problem that this does not solve.
    """
    if isinstance(F, tuple):
        if len(F) != 2:
            refuse("F", f"is a tuple of {len(F)}, and must be a function or a pair (M, q)")
        return _affine(*F, A, b, c, lower, upper, tol, threads)
    if parameters is None or x0 is None:
        refuse("parameters" if parameters is None else "x0", "is missing, and a function needs it")
    if A is not None:
        refuse("A", "goes with a pair (M, q); of functions there is perp.vi")
    return _nonlinear(F, x0, np.asarray(parameters), lower, upper, jac, tol)


class _Varying(ctypes.Structure):
    _fields_ = [("values", ctypes.c_void_p), ("step", ctypes.c_int64)]
    kept: Array


def varying_of(
    given: dict[str, Array], shapes: dict[str, tuple[int, ...]], count: int | None = None
) -> tuple[int | None, dict[str, Any]]:
    """(the number of problems, None where all have all in common; for C) of arrays that have one axis more where they are
    not the same for all problems."""
    varying = {}
    for name, array in given.items():
        one = shapes[name]
        several = array.ndim > len(one)
        if array.shape[-len(one) :] != one or array.ndim > len(one) + 1:
            refuse(name, f"has shape {array.shape}, and must have shape {one} or (count, {', '.join(map(str, one))})")
        if several:
            if count is not None and len(array) != count:
                refuse(name, f"has {len(array)} problems, and there are {count}")
            count = len(array)
        array = np.ascontiguousarray(array, dtype=float)
        numbers = _Varying(address(array), int(np.prod(one)) if several else 0)
        numbers.kept = array
        varying[name] = ctypes.byref(numbers)
    return count, varying


def names_of(status: npt.NDArray[np.int32]) -> list[str]:
    """The words of perp_status."""
    names = {code: _library.lib.perp_status_name(code).decode() for code in set(status.tolist())}
    return [names[code] for code in status.tolist()]


def _affine(M: Any, q: Any, A: Any, b: Any, c: Any, lower: Any, upper: Any, tol: float, threads: int) -> BatchResult:
    given = {"M": doubles(M, "M"), "q": doubles(q, "q")}
    n = given["q"].shape[-1] if given["q"].ndim else 0
    if A is not None:
        given["A"] = doubles(A, "A")
    m = given["A"].shape[-2] if A is not None and given["A"].ndim >= 2 else 0
    shapes: dict[str, tuple[int, ...]] = {"M": (n, n), "q": (n,), "A": (m, n), "b": (m,), "c": (m,), "lower": (n,), "upper": (n,)}
    if b is None:
        b = 0.0 if c is None else -np.inf
    sides = {"lower": lower, "upper": upper, **({"b": b, "c": np.inf if c is None else c} if m else {})}
    for name, side in sides.items():
        array = np.asarray(side, dtype=float)
        given[name] = np.broadcast_to(array, shapes[name]) if array.ndim == 0 else array
    counted, varying = varying_of(given, shapes)
    count = 1 if counted is None else counted
    x, multipliers = np.empty((count, n)), np.empty((count, m))
    status, residual = np.empty(count, np.int32), np.empty(count)
    call(
        _library.lib.perp_batch_vi,
        INTERFACE,
        count,
        n,
        m,
        *(varying.get(name) for name in ("M", "q", "A", "b", "c", "lower", "upper")),
        tol,
        _count(threads, "threads", 0),
        *(address(array) for array in (x, multipliers, status, residual)),
    )
    return BatchResult(x, status == 0, names_of(status), residual, multipliers)


def natural(x: Array, F: Array, low: Array, high: Array) -> Array:
    """||x - mid(low, x - F, high)||_inf of each row; infinite where F is no number."""
    rows = np.abs(x - np.minimum(np.maximum(x - F, low), high))
    return np.max(np.where(np.isfinite(F), rows, np.inf), axis=-1, initial=0)


def _nonlinear(F: Any, x0: Any, p: Any, lower: Bound, upper: Bound, jac: Any, tol: float) -> BatchResult:
    count = len(p)
    start = doubles(x0, "x0")
    n = start.shape[-1] if start.ndim else 1
    low, high = (np.broadcast_to(np.asarray(side, float), (count, n)) for side in (lower, upper))
    x = np.clip(np.broadcast_to(start, (count, n)), low, high)

    def value(x: Array, p: Any) -> Array:
        values = np.asarray(F(x, p), dtype=float)
        if values.shape != x.shape:
            refuse("F", f"gives shape {values.shape} for x of shape {x.shape}")
        return values

    def derivative(x: Array, p: Any, at: Array) -> Array:
        if jac is not None:
            return np.asarray(jac(x, p), dtype=float)
        J = np.empty((*x.shape, n))
        for j in range(n):
            h = np.sqrt(np.finfo(float).eps) * np.maximum(1, np.abs(x[:, j]))
            moved = x.copy()
            moved[:, j] += h
            J[:, :, j] = (value(moved, p) - at) / (moved[:, j] - x[:, j])[:, None]
        return J

    residual = np.full(count, np.inf)
    left = np.arange(count)
    with np.errstate(all="ignore"):
        for step in range(_STEPS):
            at = value(x[left], p[left])
            residual[left] = natural(x[left], at, low[left], high[left])
            going = residual[left] > tol
            left, at = left[going], at[going]
            if not len(left) or step == _STEPS - 1:
                break
            x[left] = _newton(value, x[left], at, derivative(x[left], p[left], at), p[left], low[left], high[left])
    status = ["Solved" if one <= tol else "" for one in residual.tolist()]
    for k in np.flatnonzero(~(residual <= tol)).tolist():

        def of_one(z: Array, k: int = k) -> Array:
            return value(z[None], p[k : k + 1])[0]

        def J_of_one(z: Array, k: int = k) -> Array:
            return np.asarray(jac(z[None], p[k : k + 1]), dtype=float)[0]

        begin = np.broadcast_to(start, (count, n))[k]
        r = solve(of_one, begin, low[k], high[k], jac=None if jac is None else J_of_one, convergence_tolerance=tol)
        x[k], residual[k], status[k] = r.x, r.residual, r.status
    return BatchResult(x, residual <= tol, status, residual, np.empty((count, 0)))


def _phi(a: Array, b: Array) -> tuple[Array, Array, Array]:
    """Fischer and Burmeister's a + b - sqrt(a^2 + b^2), 0 where a >= 0, b >= 0, a b = 0, and its derivatives; b where a
    is infinite."""
    free = np.isinf(a)
    a = np.where(free, 1.0, a)
    root = np.hypot(a, b)
    none = root == 0
    safe = np.where(none, 1, root)
    value, da, db = a + b - root, np.where(none, 1 - np.sqrt(0.5), 1 - a / safe), np.where(none, 1 - np.sqrt(0.5), 1 - b / safe)
    return np.where(free, b, value), np.where(free, 0, da), np.where(free, 1, db)


def _solved(system: Array, phi: Array) -> Array:
    try:
        return np.asarray(-np.linalg.solve(system, phi))
    except np.linalg.LinAlgError:
        return np.full_like(phi, np.nan)


def _newton(value: Any, x: Array, F: Array, J: Array, p: Any, low: Array, high: Array) -> Array:
    """A step of semismooth Newton on phi(x - low, -phi(high - x, -F)) = 0 (Billups 1995), with a search by halves."""

    def Phi(x: Array, F: Array) -> tuple[Array, Array, Array]:
        upper, du, dF = _phi(high - x, -F)
        inner, da, db = _phi(x - low, -upper)
        return inner, da + db * du, db * dF

    phi, of_x, of_F = Phi(x, F)
    system = of_F[:, :, None] * J
    n = x.shape[1]
    system[:, range(n), range(n)] += of_x
    try:
        d = -np.linalg.solve(system, phi[:, :, None])[:, :, 0]
    except np.linalg.LinAlgError:  # some are singular: the others are solved as they would be alone
        d = np.array([_solved(*one) for one in zip(system, phi)])
    bad = ~np.isfinite(d).all(axis=1)
    if bad.any():  # singular: the least step of least squares
        rows = np.where(np.isfinite(system[bad]), system[bad], 0)
        d[bad] = -(np.linalg.pinv(rows) @ np.where(np.isfinite(phi[bad]), phi[bad], 0)[:, :, None])[:, :, 0]
    merit = (phi**2).sum(axis=1)
    t = np.ones(len(x))
    best = x + d
    for _ in range(20):
        at = value(best, p)
        tried = (Phi(best, at)[0] ** 2).sum(axis=1)
        worse = ~(tried <= (1 - 1e-4 * t) * merit)
        if not worse.any():
            break
        t[worse] *= 0.5
        best[worse] = x[worse] + t[worse, None] * d[worse]
    return np.clip(best, low, high)
