# SPDX-License-Identifier: Apache-2.0
"""Problems: of functions, of matrices, of files, of the collection."""

from __future__ import annotations

import operator
import os
import sys
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from perp import _core
from perp._result import (
    AllSolutions,
    FoundSolution,
    Inspection,
    Interrupted,
    JacobianCheck,
    Result,
    Sensitivity,
    Verified,
    finished,
)
from perp._types import Array, Bound, Callback, Function, Jacobian, LogTo, Matrix, Options, Path


def asked(method: str | None, options: Options | None, more: Options) -> dict[str, object]:
    """All options in one; those that stand as keywords win."""
    if options is None and not more:
        return {} if method is None else {"method": method}
    if options is not None and not hasattr(options, "keys"):
        raise TypeError(f"options: is of type {type(options).__name__}, and must be a dict")
    together = {**(options or {}), **more}
    if method is not None:
        together["method"] = method
    return together


def _print_line(line: str) -> None:
    sys.stdout.write(line + "\n")


def listener(log: LogTo) -> Any:
    if log is None or log is False:
        return None
    if log is True:
        return _print_line
    if not callable(log):
        raise TypeError(f"log: is of type {type(log).__name__}, and must be True, False or a function of a line")
    return log


def listener_of_iterations(callback: Callback | None) -> Any:
    if callback is not None and not callable(callback):
        raise TypeError(f"callback: is of type {type(callback).__name__}, and must be a function")
    return callback


def text(given: str, name: str) -> str:
    if not isinstance(given, str):
        raise TypeError(f"{name}: is of type {type(given).__name__}, and must be text")
    try:
        given.encode()
    except UnicodeEncodeError as error:
        raise ValueError(f"{name}: {error}") from None
    return given


def path_text(path: Path) -> str:
    try:
        return os.fsdecode(path)
    except TypeError:
        raise TypeError(f"path: is of type {type(path).__name__}, and must be str or os.PathLike") from None


def _names(given: Sequence[str], name: str) -> list[str]:
    if isinstance(given, str) or not hasattr(given, "__iter__"):
        raise TypeError(f"{name}: is of type {type(given).__name__}, and must be a sequence of text")
    return [text(one, name) for one in given]


def _count(given: int, name: str) -> int:
    try:
        count = operator.index(given)
    except TypeError:
        raise TypeError(f"{name}: is of type {type(given).__name__}, and must be an integer") from None
    if not 1 <= count < 2**31:
        raise ValueError(f"{name}: is {count}, and must be at least 1 and below 2**31")
    return count


class Problem:
    """A complementarity problem of n variables. Made by `problem`, `affine_problem`, `read_nl` and `collection`.

    One thread at a time uses a problem.
    """

    def __init__(self, core: _core.Problem) -> None:
        self._core = core

    @property
    def name(self) -> str:
        return self._core.name

    @property
    def source(self) -> str:
        """The file, or where a problem of the collection is from."""
        return self._core.source

    @property
    def size(self) -> int:
        """n."""
        return self._core.size

    @property
    def nonzeros(self) -> int:
        """Entries of the pattern of J."""
        return self._core.nonzeros

    @property
    def affine(self) -> bool:
        """Whether F is known to be affine."""
        return self._core.affine

    @property
    def lower(self) -> Array:
        """Shape (n,)."""
        return self._core.lower

    @property
    def upper(self) -> Array:
        """Shape (n,)."""
        return self._core.upper

    @property
    def x0(self) -> Array:
        """Shape (n,): the usual start."""
        return self._core.starts[0]

    @property
    def starts(self) -> list[Array]:
        """All starts, each of shape (n,); problems of the collection may have several."""
        return self._core.starts

    @property
    def variable_names(self) -> list[str]:
        return self._core.variable_names

    @property
    def equation_names(self) -> list[str]:
        return self._core.equation_names

    def __repr__(self) -> str:
        return f"<perp.Problem {self.name}: {self.size} variables, {self.nonzeros} nonzeros>"

    def F(self, x: npt.ArrayLike) -> Array:
        """F(x), shape (n,), at x of shape (n,); nan where it is not defined."""
        return self._core.F(x)

    def jac(self, x: npt.ArrayLike) -> Matrix:
        """F'(x) as scipy.sparse.csc_matrix of shape (n, n), at x of shape (n,); nan where it is not defined."""
        return self._core.jac(x)

    def residual(self, x: npt.ArrayLike) -> float:
        """The natural residual of x, shape (n,); inf where F is not defined."""
        return self._core.residual(x)[0]

    def solve(
        self,
        x0: npt.ArrayLike | None = None,
        *,
        method: str | None = None,
        options: Options | None = None,
        basis: npt.ArrayLike | None = None,
        callback: Callback | None = None,
        log: LogTo = None,
        **more: object,
    ) -> Result:
        """Solves from x0, shape (n,), or the problem's own start. The rest is as in `perp.solve`."""
        together = asked(method, options, more)
        return finished(self._core.solve(x0, together, basis, listener_of_iterations(callback), listener(log)))

    def solve_all(
        self,
        x0: npt.ArrayLike | None = None,
        *,
        solutions: int = 10,
        method: str | None = None,
        options: Options | None = None,
        log: LogTo = None,
        **more: object,
    ) -> AllSolutions:
        """Several solutions, up to so many, by deflation from x0. The rest is as in `perp.solve_all`."""
        together = asked(method, options, more)
        found, first, attempts, duplicates, message, stats, interrupt = self._core.solve_all(
            x0, _count(solutions, "solutions"), together, listener(log)
        )
        each = [FoundSolution(Result(*result), how, singular) for result, how, singular in found]
        every = AllSolutions(each, Result(*first), attempts, duplicates, message, stats)
        if interrupt is not None:
            raise Interrupted(every) from interrupt
        return every

    def sensitivity(
        self,
        x: npt.ArrayLike,
        dF: Matrix,
        *,
        dlower: Matrix | None = None,
        dupper: Matrix | None = None,
        direction: npt.ArrayLike | None = None,
    ) -> Sensitivity:
        """How the solution x, shape (n,), moves with parameters p, as in `perp.sensitivity`."""
        return Sensitivity(*self._core.sensitivity(x, dF, dlower, dupper, direction))

    def check_jacobian(self, x: npt.ArrayLike | None = None) -> JacobianCheck:
        """Compares jac with differences of F at x, shape (n,), or at the start: at least 2 n evaluations of F."""
        return JacobianCheck(*self._core.check_jacobian(x))

    def verify(self, x: npt.ArrayLike) -> Verified:
        """Proves that exactly one solution is near x, shape (n,), if it can, as `perp.verify`."""
        return Verified(*self._core.verify(x))

    def inspect(self, x0: npt.ArrayLike | None = None) -> Inspection:
        """What is known of the problem before it is solved; x0, shape (n,), as in `solve`."""
        return Inspection(**self._core.inspect(x0))


def problem(
    F: Function,
    x0: npt.ArrayLike,
    lower: Bound = 0,
    upper: Bound = np.inf,
    jac: Jacobian | None = None,
    *,
    pattern: Matrix | None = None,
    name: str = "mcp",
    variable_names: Sequence[str] = (),
    equation_names: Sequence[str] = (),
) -> Problem:
    """The problem of F, for solving it more than once; arguments as of `perp.solve`.

    The names, n of each, are used in messages and the log.
    """
    names = (_names(variable_names, "variable_names"), _names(equation_names, "equation_names"))
    return Problem(_core.function_problem(F, x0, lower, upper, jac, pattern, text(name, "name"), *names))


def affine_problem(
    M: Matrix, q: npt.ArrayLike, lower: Bound = 0, upper: Bound = np.inf, x0: npt.ArrayLike | None = None
) -> Problem:
    """The problem of F(x) = M x + q, for solving it more than once; arguments as of `perp.mcp_affine`.

    M is not copied where it need not be, and must then not be changed while the problem lives.
    """
    return Problem(_core.affine_problem(M, q, lower, upper, x0))


def read_nl(path: Path) -> Problem:
    """The complementarity problem of an .nl file, with or without ".nl", with its names and start.

    Models with side inequalities have a variable more for each, after their own. FileError says what is wrong with a
    file and where.
    """
    file = path_text(path)
    if not any(os.path.exists(file + ending) for ending in ("", ".nl")):
        raise FileNotFoundError(f"path: there is no file {file}, nor {file}.nl")
    return Problem(_core.read_nl(file))


def collection(name: str) -> Problem:
    """A test problem by its name; `collection_entries` lists them."""
    return Problem(_core.collection(text(name, "name")))


class CollectionEntry(NamedTuple):
    """A line of the catalogue of test problems."""

    name: str
    problem_class: str
    size: int
    source: str
    hard: str
    """Why it is hard."""


def collection_entries() -> list[CollectionEntry]:
    """All test problems."""
    return [CollectionEntry(*entry) for entry in _core.collection_table()]


class Option(NamedTuple):
    """An option of `solve`."""

    key: str
    takes: str
    """"a number > 0", "yes or no", ...; Python's True and False are yes and no."""
    help: str


def options() -> list[Option]:
    """All options of all methods."""
    return [Option(*option) for option in _core.option_table()]


class Method(NamedTuple):
    """A value of `method`."""

    name: str
    what: str
    reference: str


def methods() -> list[Method]:
    """All methods by name."""
    return [Method(*entry) for entry in _core.method_table()]
