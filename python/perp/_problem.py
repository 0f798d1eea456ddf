# SPDX-License-Identifier: Apache-2.0
"""Problems: of functions, of matrices, of files, of the collection."""

from __future__ import annotations

import ctypes
import operator
import os
import threading
import warnings
from collections.abc import Sequence
from typing import Any, NamedTuple, SupportsIndex

import numpy as np
import numpy.typing as npt

from perp import _arrays, _derivatives, _library, _session
from perp._arrays import address, bound, copies_of, finite, kind, matrix, split_bounds, vector
from perp._functions import NO_J, Functions, jacobian_argument, live, on_F, on_J, with_args
from perp._library import INTERFACE, Handle, call, check, made
from perp._result import (
    AllSolutions,
    Fields,
    Explanation,
    Inspection,
    Interrupted,
    JacobianCheck,
    Names,
    Result,
    Sensitivity,
    SolutionWarning,
    Verified,
)
from perp._session import Listeners, Solver
from perp._types import Array, Bound, Bounds, Callback, Function, Jacobian, LogTo, Matrix, Options, Path


def asked(method: str | None, options: Options | None, more: Options) -> list[tuple[str, str]]:
    """All options in one, as texts; those that stand as keywords win."""
    if options is None and not more:
        return [] if method is None else [("method", _option_text("method", method))]
    if options is not None and not hasattr(options, "keys"):
        raise TypeError(f"options: is of type {kind(options)}, and must be a dict")
    together = {**(options or {}), **more}
    if method is not None:
        together["method"] = method
    for key in together:
        if not isinstance(key, str):
            raise TypeError(f"options: a key is of type {kind(key)}, no text")
    return [(text(key, "options"), _option_text(key, value)) for key, value in together.items()]


def _option_text(key: str, value: object) -> str:
    if isinstance(value, str):
        return text(value, f"options: {key}")
    if isinstance(value, (bool, np.bool_)):
        return "yes" if value else "no"
    if isinstance(value, SupportsIndex):
        try:
            return str(operator.index(value))
        except TypeError:
            pass  # an array of numpy's, which is one if it is of one integer
    try:
        if hasattr(value, "__float__"):
            return repr(float(value))
    except TypeError:
        pass
    raise TypeError(f"options: {key} is of type {kind(value)}, and must be text, a number, or True or False")


def listeners_of(callback: Callback | None, log: LogTo) -> Listeners | None:
    if callback is not None and not callable(callback):
        raise TypeError(f"callback: is of type {kind(callback)}, and must be a function")
    lines: Any = log
    if log is None or log is False:
        lines = None
    elif log is True:
        lines = _session.print_line
    elif not callable(log):
        raise TypeError(f"log: is of type {kind(log)}, and must be True, False or a function of a line")
    return None if callback is None and lines is None else Listeners(callback, lines)


def solver_of(options: list[tuple[str, str]]) -> Solver | None:
    """None: one of the solvers without options."""
    return Solver(options) if options else None


def text(given: str, name: str) -> str:
    if not isinstance(given, str):
        raise TypeError(f"{name}: is of type {kind(given)}, and must be text")
    try:
        given.encode()
    except UnicodeEncodeError as error:
        raise ValueError(f"{name}: {error}") from None
    if "\0" in given:
        raise ValueError(f"{name}: has a NUL in it")
    return given


def path_text(path: Path, name: str = "path") -> str:
    try:
        return os.fsdecode(path)
    except TypeError:
        raise TypeError(f"{name}: is of type {kind(path)}, and must be str or os.PathLike") from None


def _names(given: Sequence[str], n: int, name: str) -> Any:
    if isinstance(given, str) or not hasattr(given, "__iter__"):
        raise TypeError(f"{name}: is of type {kind(given)}, and must be a sequence of text")
    texts = [text(one, name).encode() for one in given]
    if not texts:
        return None
    if len(texts) != n:
        raise ValueError(f"{name}: has {len(texts)} names, and must have {n}")
    return (ctypes.c_char_p * n)(*texts)


def _count(given: int, name: str, least: int = 1) -> int:
    try:
        count = operator.index(given)
    except TypeError:
        raise TypeError(f"{name}: is of type {kind(given)}, and must be an integer") from None
    if not least <= count < 2**31:
        raise ValueError(f"{name}: is {count}, and must be at least {least} and below 2**31")
    return count


def basis_of(given: npt.ArrayLike | None, n: int) -> npt.NDArray[np.int8] | None:
    if given is None:
        return None
    cells = np.asarray(given)
    if cells.dtype.kind not in "iu":
        raise TypeError("basis: must be an array of integers, as Result.basis is")
    if cells.shape != (n,):
        raise ValueError(f"basis: has shape {cells.shape}, and must have shape ({n},)")
    wrong = np.flatnonzero((cells < 0) | (cells > 3))
    if wrong.size:
        k = int(wrong[0])
        raise ValueError(
            f"basis: entry [{k}] is {cells[k]}, and must be 0 (below), 1 (inside), 2 (above) or 3 (fixed)"
        )
    return np.ascontiguousarray(cells, np.int8)


def _derivative(given: Any, n: int, m: int, name: str) -> tuple[_library.Matrix, Any]:
    """n x m: a matrix, or a vector of n numbers for m = 1."""
    if not _arrays.is_sparse(given):
        given = _arrays.doubles(given, name)
        if given.ndim == 1:
            given = given.reshape(-1, 1)
    return matrix(given, name, n, m)


def _place(array: Array | None) -> int | None:
    """Its address, for as long as somebody holds it; None: there is none."""
    return None if array is None else address(array)


def warn_of(result: Result) -> None:
    """A solution by the tolerance that is none by the size of its terms is no news to be looked for."""
    if result.success and result.relative > 1e-3:
        row = result._names.equation(result.relative_row) if result._names is not None else result.relative_row
        said = "; ".join(result.notes) or f"row {row} is balanced to {result.relative:.0%} of its terms only"
        warnings.warn(f"solved to the tolerance, but: {said}", SolutionWarning, stacklevel=4)


class Problem:
    """A complementarity problem of n variables. Made by `problem`, `affine_problem`, `read_nl`, `read_matrix` and
    `collection`.

    One thread at a time uses a problem.
    """

    def __init__(self, handle: Handle, *, functions: Functions | None = None, starts: list[Array] | None = None) -> None:
        self._handle = handle
        self._functions = functions
        self._starts = starts
        self._n: int = _library.lib.perp_problem_size(handle.pointer)
        self._named = Names(handle, self._n)
        self._lock = threading.Lock()

    # What a problem says of itself.

    @property
    def name(self) -> str:
        """In messages and the log."""
        return str(_library.lib.perp_problem_name(self._handle.pointer).decode(errors="replace"))

    @property
    def source(self) -> str:
        """The file, or where a problem of the collection is from."""
        return str(_library.lib.perp_problem_source(self._handle.pointer).decode(errors="replace"))

    @property
    def size(self) -> int:
        """n."""
        return self._n

    @property
    def nonzeros(self) -> int:
        """Entries of the pattern of J."""
        return int(_library.lib.perp_problem_nonzeros(self._handle.pointer))

    @property
    def affine(self) -> bool:
        """Whether F is known to be affine."""
        return bool(_library.lib.perp_problem_is_affine(self._handle.pointer))

    def _bounds(self) -> tuple[Array, Array]:
        lower, upper = np.empty(self._n), np.empty(self._n)
        call(_library.lib.perp_problem_bounds, self._handle.pointer, address(lower), address(upper))
        return lower, upper

    @property
    def lower(self) -> Array:
        """Shape (n,)."""
        return self._bounds()[0]

    @property
    def upper(self) -> Array:
        """Shape (n,)."""
        return self._bounds()[1]

    @property
    def starts(self) -> list[Array]:
        """All starts, each of shape (n,); problems of the collection may have several."""
        if self._starts is None:
            lib, pointer = _library.lib, self._handle.pointer
            self._starts = [np.empty(self._n) for _ in range(lib.perp_problem_starts(pointer))]
            for k, start in enumerate(self._starts):
                call(lib.perp_problem_start, pointer, k, address(start))
        return [start.copy() for start in self._starts]

    @property
    def x0(self) -> Array:
        """Shape (n,): the usual start."""
        return self.starts[0]

    @property
    def variable_names(self) -> list[str]:
        """n names; "x[0]", ... where none were given."""
        return self._named.all(0)

    @property
    def equation_names(self) -> list[str]:
        """n names; "F[0]", ... where none were given."""
        return self._named.all(1)

    def __repr__(self) -> str:
        return f"<perp.Problem {self.name}: {self.size} variables, {self.nonzeros} nonzeros>"

    def _repr_html_(self) -> str:
        from perp._result import _table

        return _table([("problem", self.name), ("variables", str(self.size)), ("nonzeros", str(self.nonzeros))])

    # The library at work on it.

    def _begin(self) -> None:
        if not self._lock.acquire(False):
            raise RuntimeError(
                "this problem is in use: one thread at a time uses a problem, and a problem's functions do not use the "
                "problem"
            )
        if self._functions is not None:
            self._functions.failure = None
            live[self._functions.number] = self._functions

    def _end(self) -> None:
        if self._functions is not None:
            del live[self._functions.number]
            self._functions.failure = None
        self._lock.release()

    def _work(self, function: Any, *arguments: Any, **how: Any) -> tuple[Handle, BaseException | None]:
        self._begin()
        try:
            return _session.work(function, self._handle.pointer, *arguments, functions=self._functions, **how)
        finally:
            self._end()

    def _fields(self, function: Any, *arguments: Any) -> Fields:
        """Of what is not worth keeping when it is interrupted."""
        handle, interrupt = self._work(function, *arguments)
        if interrupt is not None:
            raise interrupt
        return Fields(handle)

    def _look(self, function: Any, *arguments: Any) -> None:
        self._begin()
        try:
            error = _library.Error()
            code = function(self._handle.pointer, *arguments, ctypes.byref(error))
            if self._functions is not None and self._functions.failure is not None:
                raise self._functions.failure
            check(code, error)
        finally:
            self._end()

    def _start(self, x0: npt.ArrayLike | None, name: str = "x0") -> Array | None:
        """None: the problem's own start."""
        if x0 is None:
            return self._starts[0] if self._starts else None
        return vector(x0, self._n, name)

    def _result(self, fields: Fields) -> Result:
        result = Result(fields)
        result._names = self._named
        return result

    def F(self, x: npt.ArrayLike) -> Array:
        """F(x), shape (n,), at x of shape (n,); nan where it is not defined."""
        at, value = vector(x, self._n, "x"), np.empty(self._n)
        self._look(_library.lib.perp_problem_evaluate, address(at), address(value), None)
        return value

    def jac(self, x: npt.ArrayLike) -> Matrix:
        """F'(x) as scipy.sparse.csc_matrix of shape (n, n), at x of shape (n,); nan where it is not defined."""
        from scipy import sparse

        at, value = vector(x, self._n, "x"), np.empty(self.nonzeros)
        self._look(_library.lib.perp_problem_evaluate, address(at), None, address(value) if len(value) else None)
        return sparse.csc_matrix((value, *self._pattern()), shape=(self._n, self._n))

    def _pattern(self) -> tuple[Any, Any]:
        """indices and indptr: copies."""
        pattern = _library.Matrix()
        call(_library.lib.perp_problem_pattern, self._handle.pointer, ctypes.byref(pattern))
        return copies_of(pattern)[:2]

    def residual(self, x: npt.ArrayLike) -> float:
        """The natural residual of x, shape (n,); inf where F is not defined."""
        at, natural = vector(x, self._n, "x"), ctypes.c_double()
        self._look(_library.lib.perp_problem_residual, address(finite(at, "x")), ctypes.byref(natural), None)
        return natural.value

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
        return self._solve(x0, asked(method, options, more), basis, listeners_of(callback, log))

    def _solve(self, x0: Any, options: list[tuple[str, str]], basis: Any, listeners: Listeners | None) -> Result:
        solver = solver_of(options)
        return self._solved(_library.lib.perp_solve, x0, solver=solver, listeners=listeners, basis=basis_of(basis, self._n))

    def _solved(self, function: Any, x0: Any, **how: Any) -> Result:
        start = self._start(x0)
        handle, interrupt = self._work(function, _place(start), **how)
        result = self._result(Fields(handle))
        if interrupt is not None:
            raise Interrupted(result) from interrupt
        warn_of(result)
        return result

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
        start = self._start(x0)
        handle, interrupt = self._work(
            _library.lib.perp_solve_all,
            _place(start),
            _count(solutions, "solutions"),
            solver=solver_of(asked(method, options, more)),
            listeners=listeners_of(None, log),
        )
        every = AllSolutions(Fields(handle), self._result)
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
        n, at = self._n, vector(x, self._n, "x")
        of_F = _derivative(dF, n, -1, "dF")
        m = of_F[0].columns
        bounds = (None if d is None else _derivative(d, n, m, name) for d, name in ((dlower, "dlower"), (dupper, "dupper")))
        matrices = [of_F, *bounds]
        dp = None if direction is None else vector(direction, m, "direction")
        places = (None if one is None else ctypes.byref(one[0]) for one in matrices)
        return Sensitivity(self._fields(_library.lib.perp_sensitivity, address(at), *places, _place(dp)))

    def check_jacobian(self, x: npt.ArrayLike | None = None) -> JacobianCheck:
        """Compares jac with differences of F at x, shape (n,), or at the start: at least 2 n evaluations of F."""
        start = self._start(x, "x")
        return JacobianCheck(self._fields(_library.lib.perp_check_jacobian, _place(start)))

    def verify(self, x: npt.ArrayLike) -> Verified:
        """Proves that exactly one solution is near x, shape (n,), if it can, as `perp.verify`."""
        at = vector(x, self._n, "x")
        return Verified(self._fields(_library.lib.perp_verify, address(at)))

    def explain(self, x0: npt.ArrayLike | None = None, *, seconds: float = 30) -> Explanation:
        """Why the problem has no solution, which row is the cause, and what would mend it; or what in it looks like a
        slip although it has one. x0, shape (n,), as in `solve`; seconds: for all of it."""
        start = self._start(x0)
        return Explanation(self._fields(_library.lib.perp_explain, _place(start), float(seconds)))

    def inspect(self, x0: npt.ArrayLike | None = None) -> Inspection:
        """What is known of the problem before it is solved; x0, shape (n,), as in `solve`."""
        start = self._start(x0)
        return Inspection(self._fields(_library.lib.perp_inspect, _place(start)))


def function_problem(
    F: Any, x0: Any, lower: Any, upper: Any, jac: Any, pattern: Any, bounds: Any = None, args: Any = (), affine: bool = False
) -> Problem:
    if affine and not (jac is None or callable(jac) or isinstance(jac, (bool, str))):
        M = jac if hasattr(jac, "tocsc") else np.asarray(jac, dtype=float)
        jac = lambda *_: M  # noqa: E731
    F, jac = jacobian_argument(with_args(F, args), with_args(jac, args))
    start = finite(vector(x0, -1, "x0"), "x0")
    n = len(start)
    lower, upper = split_bounds(bounds, lower, upper)
    low, high = bound(lower, n, 0.0, "lower"), bound(upper, n, np.inf, "upper")
    start = start.copy() if start is x0 else start
    inside = np.clip(start, 0.0 if low is None else low, np.inf if high is None else high)
    if isinstance(jac, str):
        F, jac, pattern = _derivatives.by_name(jac, F, inside, pattern)
    functions = Functions(F, jac, pattern, inside)
    places = functions.pattern()
    handle = made(
        _library.lib.perp_problem_create,
        _library.lib.Problem,
        INTERFACE,
        n,
        _place(low),
        _place(high),
        ctypes.byref(places),
        on_F,
        NO_J if jac is None else on_J,
        functions.number,
    )
    made_ = Problem(handle, functions=functions, starts=[start])
    if affine:
        if jac is None:
            _arrays.refuse("affine", "goes with jac, the matrix")
        constant = np.ones(max(1, made_.nonzeros), dtype=np.int8)  # without entries F is constant: no null pointer
        error = _library.Error()
        check(_library.lib.perp_problem_set_linear(handle.pointer, address(constant), ctypes.byref(error)), error)
    return made_


def problem(
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
    name: str = "mcp",
    variable_names: Sequence[str] = (),
    equation_names: Sequence[str] = (),
) -> Problem:
    """The problem of F, for solving it more than once; arguments as of `perp.solve`.

    The names, n of each, are used in messages and the log.
    """
    name = text(name, "name")
    made_ = function_problem(F, x0, lower, upper, jac, pattern, bounds, args, affine)
    variables = _names(variable_names, made_.size, "variable_names")
    equations = _names(equation_names, made_.size, "equation_names")
    call(_library.lib.perp_problem_set_name, made_._handle.pointer, name.encode())
    call(_library.lib.perp_problem_set_names, made_._handle.pointer, variables, equations)
    return made_


def affine_handle(M: Any, q: Any, lower: Any, upper: Any) -> Handle:
    shift = vector(q, -1, "q")
    n = len(shift)
    low, high = bound(lower, n, 0.0, "lower"), bound(upper, n, np.inf, "upper")
    entries, kept = matrix(M, "M", n, n, lent=True)
    return made(
        _library.lib.perp_problem_affine,
        _library.lib.Problem,
        INTERFACE,
        ctypes.byref(entries),
        address(shift),
        _place(low),
        _place(high),
        kept=kept if entries.lent else None,
    )


def affine_problem(
    M: Matrix,
    q: npt.ArrayLike,
    lower: Bound = 0,
    upper: Bound = np.inf,
    x0: npt.ArrayLike | None = None,
    *,
    bounds: Bounds | None = None,
) -> Problem:
    """The problem of F(x) = M x + q, for solving it more than once; arguments as of `perp.mcp_affine`.

    M is not copied where it need not be, and must then not be changed while the problem lives.
    """
    made_ = Problem(affine_handle(M, q, *split_bounds(bounds, lower, upper)))
    if x0 is not None:
        made_._starts = [finite(vector(x0, made_.size, "x0"), "x0").copy()]
    return made_


def read_nl(path: Path) -> Problem:
    """The complementarity problem of an .nl file, with or without ".nl", with its names and start.

    Models with side inequalities have a variable more for each, after their own. FileError says what is wrong with a
    file and where.
    """
    file = path_text(path)
    if not any(os.path.exists(file + ending) for ending in ("", ".nl")):
        raise FileNotFoundError(f"path: there is no file {file}, nor {file}.nl")
    lib = _library.lib
    return Problem(made(lib.perp_problem_read_nl, lib.Problem, INTERFACE, os.fsencode(file)))


def read_matrix(M: Path, q: Path, lower: Path | None = None, upper: Path | None = None) -> Problem:
    """The affine problem of Matrix Market files of M, q and the bounds; without these x >= 0."""
    given = {"M": M, "q": q, "lower": lower, "upper": upper}
    files = [None if path is None else os.fsencode(path_text(path, name)) for name, path in given.items()]
    for name, file in zip(given, files):
        if file is not None and not os.path.exists(file):
            raise FileNotFoundError(f"{name}: there is no file {os.fsdecode(file)}")
    lib = _library.lib
    return Problem(made(lib.perp_problem_read_matrix, lib.Problem, INTERFACE, *files))


def collection(name: str) -> Problem:
    """A test problem by its name, "josephy", or of a family in any size, "obstacle:50x50"; `collection_entries` lists
    them."""
    lib = _library.lib
    return Problem(made(lib.perp_problem_collection, lib.Problem, INTERFACE, text(name, "name").encode()))


def listed(what: str) -> list[dict[str, Any]]:
    """The items of perp_list."""
    lib = _library.lib
    answer = Fields(made(lib.perp_list, lib.Result, INTERFACE, what.encode()))
    return [item.numbers() for item in answer.read("items")]


class CollectionEntry(NamedTuple):
    """A line of the catalogue of test problems."""

    name: str
    problem_class: str
    size: int
    source: str
    hard: str
    """Why it is hard."""
    sizes: str = ""
    """How other sizes are asked for, "obstacle:ROWSxCOLUMNS"; empty: there are none."""


def collection_entries() -> list[CollectionEntry]:
    """All test problems."""
    return [CollectionEntry(**entry) for entry in listed("collection")]


class Option(NamedTuple):
    """An option of `solve`."""

    key: str
    takes: str
    """"a number > 0", "yes or no", ...; Python's True and False are yes and no."""
    help: str


def options() -> list[Option]:
    """All options of all methods."""
    return [Option(**option) for option in listed("options")]


class Method(NamedTuple):
    """A value of `method`."""

    name: str
    what: str
    reference: str


def methods() -> list[Method]:
    """All methods by name."""
    return [Method(**entry) for entry in listed("methods")]
