# SPDX-License-Identifier: Apache-2.0
"""A problem's functions of Python, as the library calls them.

The library calls one function of C for all problems, with a number: which object of `live` it means. An object is in there
only while somebody uses it."""

from __future__ import annotations

import ctypes
import itertools
import warnings
from typing import Any

import numpy as np
import numpy.typing as npt

from perp import _arrays, _library
from perp._arrays import FLOAT64, doubles, kind, refuse, refuse_type
from perp._types import Array

live: dict[int, Any] = {}
numbers = itertools.count(1)


class Float32Warning(UserWarning):
    """A function returns float32, of seven digits: tolerances and differences need more."""


def view(pointer: int, count: int, kept: Any = None) -> Array:
    """float64 of C, where they are; `kept` lives as long as the array."""
    if not count:
        return np.empty(0)
    return array_at(pointer, count, FLOAT64, kept)


def array_at(pointer: int, count: int, dtype: np.dtype[Any], kept: Any) -> npt.NDArray[Any]:
    """Memory of C as an array; `kept` lives as long as it does."""
    buffer: Any = (ctypes.c_char * (count * dtype.itemsize)).from_address(pointer)
    if kept is not None:
        buffer._kept = kept
    return np.frombuffer(buffer, dtype)


def _require_callable(function: Any, name: str, or_what: str = "") -> None:
    if not callable(function):
        refuse_type(name, f"is of type {kind(function)}, and must be a function of x{or_what}")


def jacobian_argument(F: Any, jac: Any) -> tuple[Any, Any]:
    """What scipy calls jac: a function, True (F returns F and jac), or what stands for differences; "jax" and "casadi"."""
    if jac is True:
        both = _Both(F)
        return both.F, both.jac
    if jac is None or jac is False or (isinstance(jac, str) and jac == "2-point"):
        return F, None
    if isinstance(jac, str) and jac not in ("jax", "casadi"):
        refuse("jac", f"'{jac}' is not offered: None takes differences with two points; 'jax', 'casadi' or a function are exact")
    return F, jac


class _Both:
    """A function that returns F and jac at once."""

    def __init__(self, function: Any) -> None:
        _require_callable(function, "F")
        self._function = function
        self._at: Any = None  # x and jac there

    def F(self, x: Array) -> Any:
        at = x.copy()  # x is the function's, and may be changed
        both = self._function(x)
        if not isinstance(both, (tuple, list)) or len(both) != 2:
            refuse_type("F", f"returned {kind(both)}, and with jac=True must return a pair: F and jac")
        self._at = (at, both[1])
        return both[0]

    def jac(self, x: Array) -> Any:
        if self._at is None or not np.array_equal(self._at[0], x):
            self.F(x)
        return self._at[1]


def with_args(function: Any, args: Any) -> Any:
    """x -> function(x, *args), as scipy has it."""
    if not callable(function):
        return function
    more = args if isinstance(args, tuple) else (args,)
    return (lambda x: function(x, *more)) if more else function


class _Reader:
    """Puts J's values into the places of the pattern. As long as the arrays of indices stay the same, which is compared,
    a sparse J costs a copy of its values."""

    def __init__(self, pattern: Any, n: int) -> None:
        self.pattern = pattern  # a csc_matrix; None: all, by rows
        self.n = n
        self.count = n * n if pattern is None else pattern.nnz
        self._by_rows = False
        self._start: Any = None
        self._index: Any = None
        self._start_bytes = self._index_bytes = b""
        self._place: Any = None  # of each entry; None: entry k is k-th
        self._entries = 0
        self._keys: Any = None

    def read(self, J: Any, value: Array) -> None:
        if type(J) is np.ndarray or not _arrays.is_sparse(J):
            self._read_dense(J, value)
            return
        try:
            self._read_sparse(J, value)
        except (AttributeError, TypeError, ValueError, LookupError, OverflowError) as error:
            _arrays._refused(error, "jac")

    def _places(self) -> tuple[Any, Any]:
        """Row and column of each entry of the pattern."""
        return self.pattern.indices, np.repeat(np.arange(self.n), np.diff(self.pattern.indptr))

    def _read_dense(self, J: Any, value: Array) -> None:
        numbers = doubles(J, "jac") if not (type(J) is np.ndarray and J.dtype == FLOAT64) else J
        if numbers.shape != (self.n, self.n):
            refuse("jac", f"returned shape {numbers.shape}, and must return shape ({self.n}, {self.n})")
        if self.pattern is None:
            value.reshape(self.n, self.n)[:] = numbers
            return
        rows, columns = self._places()
        value[:] = numbers[rows, columns]
        if np.count_nonzero(numbers) > np.count_nonzero(value):
            outside = numbers.copy()
            outside[rows, columns] = 0
            self._refuse_outside(*np.argwhere(outside)[0])

    def _refuse_outside(self, i: int, j: int) -> None:
        refuse("jac", f"returned an entry [{i}, {j}] that is not in the pattern, which is that of jac at the start unless "
               "`pattern` gives it: give a `pattern` with all entries that can be nonzero")

    def _same(self, array: Any, known: Any, known_bytes: bytes) -> bool:
        if known is None or array.dtype != known.dtype or array.shape != known.shape:
            return False
        return array.tobytes() == known_bytes if array.size < 5000 else np.array_equal(array, known)

    def _read_sparse(self, J: Any, value: Array) -> None:
        if J.shape != (self.n, self.n):
            refuse("jac", f"returned shape {J.shape}, and must return shape ({self.n}, {self.n})")
        if J.format not in ("csc", "csr"):
            J = _arrays.compressed(J, "jac")
        start, index, data = J.indptr, J.indices, J.data
        by_rows = J.format == "csr"
        if not (
            by_rows == self._by_rows
            and type(start) is type(index) is np.ndarray
            and self._same(start, self._start, self._start_bytes)
            and self._same(index, self._index, self._index_bytes)
        ):
            self._learn(J, by_rows)
        if type(data) is not np.ndarray or data.dtype != FLOAT64 or data.ndim != 1:
            data = doubles(data, "jac")
            if data.ndim != 1:
                refuse("jac", f"its result's data has shape {data.shape}")
        if len(data) != self._entries:
            if len(data) < self._entries:
                refuse("jac", f"returned {len(data)} values for {self._entries} entries")
            data = data[: self._entries]
        if self._place is None:
            value[:] = data
        else:
            value[:] = np.bincount(self._place, data, self.count)

    def _learn(self, J: Any, by_rows: bool) -> None:
        """Works out the place of each entry of a CSC or CSR matrix."""
        self._start = None
        _, start, index, _ = _arrays.sparse_parts(J, "jac")
        _arrays.check_structure(start, index, self.n, "jac")
        entries = int(start[-1])
        outer = np.repeat(np.arange(self.n, dtype=np.int64), np.diff(start))
        inner = index[:entries].astype(np.int64)
        rows, columns = (outer, inner) if by_rows else (inner, outer)
        if self.pattern is None:
            place = rows * self.n + columns
        else:
            if self._keys is None:
                own_rows, own_columns = self._places()
                self._keys = own_columns.astype(np.int64) * self.n + own_rows
            keys = columns * self.n + rows
            place = np.searchsorted(self._keys, keys)
            wrong = place >= self.count
            wrong[~wrong] = self._keys[place[~wrong]] != keys[~wrong]
            if wrong.any():
                k = int(np.flatnonzero(wrong)[0])
                self._refuse_outside(int(rows[k]), int(columns[k]))
        in_order = entries == self.count and bool((place == np.arange(entries)).all())
        self._place = None if in_order else place
        self._entries = entries
        self._by_rows = by_rows
        self._start, self._index = np.array(J.indptr), np.array(J.indices)
        self._start_bytes, self._index_bytes = self._start.tobytes(), self._index.tobytes()


class Functions:
    """F and jac of a problem. The first exception of a function ends the solve: from then on no function is called."""

    def __init__(self, F: Any, jac: Any, pattern: Any, start: Array) -> None:
        _require_callable(F, "F")
        if jac is not None:
            _require_callable(jac, "jac", ", or None")
        n = len(start)
        self.F, self.jac = F, jac
        self.shape = (n,)
        self.number = next(numbers)
        self.failure: BaseException | None = None
        self._told = False
        self._first: Any = None  # x and jac there, which told the pattern, so that it is not called there twice
        self._x_at = self._F_at = self._J_at = 0
        self._x = self._F = self._J = np.empty(0)
        if pattern is not None:
            places = _arrays.pattern_of(pattern, n, "pattern", False)
        elif jac is not None:
            J = jac(start.copy())
            places = _arrays.pattern_of(J, n, "jac", True)
            self._first = (start, J)
        else:
            places = None
        self.reader = _Reader(places, n)

    def pattern(self) -> _library.Matrix:
        n = self.shape[0]
        places = self.reader.pattern
        if places is None:
            return _library.Matrix(_library.DENSE_ROWS, 0, n, n, None, None, None)
        address = _arrays.address
        return _library.Matrix(
            _library.COLUMNS_INT32, 0, n, n, address(places.indptr), address(places.indices), None
        )

    def look(self, x: int, F: int) -> None:
        self._x_at, self._F_at = x, F
        self._x, self._F = view(x, self.shape[0]), view(F, self.shape[0])

    def call_F(self, x: int, F: int) -> None:
        if x != self._x_at or F != self._F_at:
            self.look(x, F)
        value = self.F(self._x.copy())
        if type(value) is np.ndarray and value.dtype is FLOAT64 and value.shape == self.shape:
            self._F[:] = value
        else:
            self._F[:] = self._doubles(value)

    def _doubles(self, value: Any) -> Array:
        if not self._told and getattr(value, "dtype", None) == np.float32:
            self._told = True
            warnings.warn(
                "F returns float32, which has seven digits: residuals below 1e-6 or so and derivatives by differences are "
                "rounding. Let it compute in float64 (JAX: jax.config.update('jax_enable_x64', True))",
                Float32Warning,
                stacklevel=4,
            )
        numbers = doubles(value, "F")
        if numbers.shape != self.shape and not (numbers.ndim == 0 and self.shape == (1,)):
            refuse("F", f"returned shape {numbers.shape}, and must return shape {self.shape}")
        return numbers

    def call_jac(self, x: int, value: int, count: int) -> None:
        if value != self._J_at:
            self._J_at, self._J = value, view(value, count)
        at = view(x, self.shape[0]) if x != self._x_at else self._x
        if self._first is not None:
            first, self._first = self._first, None
            if np.array_equal(first[0], at):
                self.reader.read(first[1], self._J)
                return
        self.reader.read(self.jac(at.copy()), self._J)


def _on_F(n: int, x: int, F: int, number: int) -> int:
    functions = live[number]
    try:
        functions.call_F(x, F)
        return 0
    except BaseException as error:
        functions.failure = error
        return 2


def _on_J(n: int, count: int, x: int, value: int, number: int) -> int:
    functions = live[number]
    try:
        functions.call_jac(x, value, count)
        return 0
    except BaseException as error:
        functions.failure = error
        return 2


on_F, on_J = _library.F_callback(_on_F), _library.J_callback(_on_J)
NO_J = _library.J_callback(0)
