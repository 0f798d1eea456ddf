# SPDX-License-Identifier: Apache-2.0
"""Arguments that are numbers: vectors, bounds and matrices, checked, and used where they are if they can be."""

from __future__ import annotations

import ctypes
import math
import sys
from collections.abc import Iterable
from typing import Any, NoReturn

import numpy as np
import numpy.typing as npt

from perp import _library
from perp._library import Matrix
from perp._types import Array

FLOAT64 = np.dtype(np.float64)
_INT32, _INT64 = np.dtype(np.int32), np.dtype(np.int64)
#: Indices of the library have 32 bits.
MOST = 2**31 - 2


def kind(given: object) -> str:
    return type(given).__name__


def refuse(name: str, why: str) -> NoReturn:
    raise ValueError(f"{name}: {why}")


def refuse_type(name: str, why: str) -> NoReturn:
    raise TypeError(f"{name}: {why}")


def doubles(given: Any, name: str) -> Array:
    """An array of float64, by rows without gaps."""
    if type(given) is np.ndarray and given.dtype == FLOAT64 and given.flags.c_contiguous:
        return given
    if given is None:
        refuse_type(name, "is None, and must be an array of numbers")
    if isinstance(given, np.ma.MaskedArray) and getattr(np.ma, "is_masked")(given):
        refuse(name, "has masked entries, which are no numbers")
    try:
        array = np.asarray(given)
    except Exception as error:
        refuse_type(name, f"is of type {kind(given)}, which makes no array of numbers: {error}")
    if array.dtype.kind not in "fiub":
        refuse_type(name, f"has dtype {array.dtype}, and must have real numbers")
    return np.ascontiguousarray(array, FLOAT64) if array.ndim else array.astype(FLOAT64)


def _said_address(array: npt.NDArray[Any]) -> int:
    return array.__array_interface__["data"][0]  # type: ignore[no-any-return]


def _read_address(array: npt.NDArray[Any]) -> int:
    return _pointer_at(id(array) + _DATA).value or 0


#: Place of the data pointer in an array: first after what all objects begin with, by numpy's ABI.
_DATA, _pointer_at = object.__basicsize__, ctypes.c_void_p.from_address
_probe = np.arange(3.0)
#: Where the numbers are. To ask numpy takes some microseconds, and a solve asks ten times.
address = _said_address
if sys.implementation.name == "cpython" and _read_address(_probe) == _said_address(_probe):
    address = _read_address


def vector(given: Any, n: int, name: str) -> Array:
    """Of n entries, or of any number where n is -1. The library looks whether they are finite."""
    numbers = doubles(given, name)
    if numbers.ndim != 1 or (n >= 0 and len(numbers) != n):
        refuse(name, f"has shape {numbers.shape}, and must have shape {'(n,)' if n < 0 else f'({n},)'}")
    if not len(numbers):
        refuse(name, "is empty: a problem has at least one variable")
    if len(numbers) > MOST:
        refuse(name, "has more than 2^31 - 2 entries")
    return numbers


def finite(numbers: Array, name: str) -> Array:
    """For what the library does not see."""
    if not np.isfinite(numbers).all():
        k = int(np.flatnonzero(~np.isfinite(numbers))[0])
        refuse(name, f"entry [{k}] is {numbers[k]}, no finite number")
    return numbers


def bound(given: Any, n: int, usual: float, name: str) -> Array | None:
    """n bounds; None: the library's own usual ones, which are `usual`."""
    if given is None or (type(given) in (int, float) and given == usual):
        return None
    if type(given) is float:
        return np.full(n, given)
    numbers = doubles(given, name)
    if numbers.ndim == 0:
        return np.full(n, float(numbers))
    if numbers.shape != (n,):
        refuse(name, f"has shape {numbers.shape}, and must be a number or have shape ({n},)")
    return numbers


def split_bounds(given: Any, lower: Any, upper: Any) -> tuple[Any, Any]:
    """`bounds` as scipy.optimize has them, pairs (low, high) with None for none, or a Bounds; or lower and upper."""
    if given is None:
        return lower, upper
    if not (_is_usual(lower, 0) and _is_usual(upper, math.inf)):
        refuse_type("bounds", "is given, and so are lower or upper: give one of them")
    if hasattr(given, "lb") and hasattr(given, "ub"):
        return given.lb, given.ub
    if not isinstance(given, Iterable) or isinstance(given, str):
        refuse_type("bounds", f"is of type {kind(given)}, and must be pairs (low, high), or a scipy.optimize.Bounds")
    lows, highs = [], []
    for k, pair in enumerate(given):
        try:
            low, high = pair
            lows.append(-math.inf if low is None else float(low))
            highs.append(math.inf if high is None else float(high))
        except (TypeError, ValueError):
            refuse_type("bounds", f"entry [{k}] is {pair!r}, and must be a pair (low, high) of numbers or None")
    return np.array(lows), np.array(highs)


def _is_usual(given: Any, usual: float) -> bool:
    return given is None or (isinstance(given, (int, float)) and given == usual)


def is_sparse(given: Any) -> bool:
    return not isinstance(given, np.ndarray) and hasattr(given, "tocsc") and hasattr(given, "format")


def shape_of(given: Any, name: str) -> tuple[int, int]:
    try:
        rows, columns = given.shape
        return int(rows), int(columns)
    except (TypeError, ValueError):
        refuse(name, f"has shape {given.shape}, and must have two dimensions")


def indices(matrix: Any, part: str, name: str) -> npt.NDArray[Any]:
    """indptr, indices, ...: integers of 32 or 64 bits."""
    array = getattr(matrix, part)
    if type(array) is np.ndarray and array.dtype is _INT32 and array.ndim == 1 and array.flags.c_contiguous:
        return array
    array = np.ascontiguousarray(array)
    if array.ndim != 1 or array.dtype.kind not in "iu":
        refuse(name, f"{part} is no array of integers")
    return array if array.dtype in (_INT32, _INT64) else array.astype(np.int64)


def _check_coordinates(coo: Any, part: str, below: int, name: str) -> None:
    index = indices(coo, part, name)
    if index.size != np.size(coo.data):
        refuse(name, f"{part} has {index.size} entries, another number than data")
    if index.size and not (0 <= index.min() and index.max() < below):
        wrong = index.min() if index.min() < 0 else index.max()
        refuse(name, f"{part} has the index {wrong}, and must be within 0 and {below - 1}")


def compressed(matrix: Any, name: str) -> Any:
    """A matrix of scipy.sparse in CSC or CSR. Checks indices of other formats, which scipy would follow wherever they
    point; those of these two are for the library to check."""
    form = matrix.format
    if form == "csc" or form == "csr":
        return matrix
    form = str(form)
    if form == "bsr":
        matrix.check_format(True)
        return matrix.tocsc()
    coo = matrix if form == "coo" else matrix.tocoo()
    rows, columns = shape_of(coo, name)
    _check_coordinates(coo, "row", rows, name)
    _check_coordinates(coo, "col", columns, name)
    return coo.tocsc()


def sparse_parts(matrix: Any, name: str) -> tuple[bool, npt.NDArray[Any], npt.NDArray[Any], Array]:
    """Whether by rows; indptr and indices of one width; data: as long as indptr says, which is all that is checked."""
    matrix = compressed(matrix, name)
    by_rows = matrix.format == "csr"
    start, index = indices(matrix, "indptr", name), indices(matrix, "indices", name)
    value = doubles(matrix.data, name)
    if value.ndim != 1:
        refuse(name, f"data has shape {value.shape}, and must have one dimension")
    outer = matrix.shape[0 if by_rows else 1]
    if start.size != outer + 1:
        refuse(name, f"indptr has {start.size} entries, and must have {outer + 1}")
    if not 0 <= start[-1] <= min(index.size, value.size):
        refuse(name, f"indptr ends at {start[-1]}, and there are {min(index.size, value.size)} entries")
    if start.dtype != index.dtype:
        start, index = start.astype(np.int64), index.astype(np.int64)
    return by_rows, start, index, value


def _sparse(given: Any, name: str, rows: int, columns: int, lent: bool) -> tuple[Matrix, Any]:
    shape = shape_of(given, name)
    if shape[0] != rows or columns not in (-1, shape[1]):
        refuse(name, f"has shape {shape}, and must have shape ({rows}, {'m' if columns < 0 else columns})")
    by_rows, start, index, value = sparse_parts(given, name)
    form = (2 if by_rows else 0) + (start.dtype == _INT64)
    return Matrix(form, lent, *shape, address(start), address(index), address(value)), (start, index, value)


def _refused(error: Exception, name: str) -> NoReturn:
    """What scipy raised, of its own."""
    if str(error).startswith(f"{name}: "):
        raise error
    if isinstance(error, (AttributeError, TypeError)):
        raise TypeError(f"{name}: {error}") from error
    raise ValueError(f"{name}: {error}") from error


def matrix(given: Any, name: str, rows: int, columns: int, *, lent: bool = False) -> tuple[Matrix, Any]:
    """A dense array or a matrix of scipy.sparse, and the arrays that have to stay until the library has seen it, or as
    long as what is made of it where it is lent. columns -1: any number."""
    if is_sparse(given):
        try:
            return _sparse(given, name, rows, columns, lent)
        except (AttributeError, TypeError, ValueError, LookupError, OverflowError) as error:
            _refused(error, name)
    numbers = doubles(given, name)
    if numbers.ndim != 2 or len(numbers) != rows or columns not in (-1, numbers.shape[1]):
        refuse(name, f"has shape {numbers.shape}, and must have shape ({rows}, {'m' if columns < 0 else columns})")
    return Matrix(_library.DENSE_ROWS, 0, *numbers.shape, None, None, address(numbers)), numbers


def pattern_of(given: Any, n: int, name: str, stored: bool) -> Any:
    """The places of a matrix as a csc_matrix with int32 indices, sorted, each once: all of a dense one, the stored entries
    of a sparse one; of a mask (`stored` false) the entries of a dense one that are not zero. None: all."""
    from scipy import sparse

    if not is_sparse(given):
        numbers = doubles(given, name)
        if numbers.shape != (n, n):
            refuse(name, f"{'returned' if stored else 'has'} shape {numbers.shape}, and must "
                   f"{'return' if stored else 'have'} shape ({n}, {n})")
        return None if stored else sparse.csc_matrix(numbers != 0, dtype=float)
    try:
        if shape_of(given, name) != (n, n):
            refuse(name, f"has shape {shape_of(given, name)}, and must have shape ({n}, {n})")
        by_rows, start, index, value = sparse_parts(given, name)
        check_structure(start, index, n, name)
        # Ones in place of the values: their sums do not vanish, and may be anything where J is not defined.
        ones = np.ones(int(start[-1]))
        kinds = sparse.csr_matrix if by_rows else sparse.csc_matrix
        places = kinds((ones, index[: ones.size].copy(), start.copy()), shape=(n, n)).tocsc()
        places.has_sorted_indices = places.has_canonical_format = False  # flags that somebody may have set wrongly
        places.sum_duplicates()
        places.indices, places.indptr = places.indices.astype(np.int32), places.indptr.astype(np.int32)
        return places
    except (AttributeError, TypeError, ValueError, LookupError, OverflowError) as error:
        _refused(error, name)


def check_structure(start: npt.NDArray[Any], index: npt.NDArray[Any], n: int, name: str) -> None:
    """Before numpy follows indices wherever they point."""
    if start[0] != 0 or (start[1:] < start[:-1]).any():
        refuse(name, "its indptr does not begin at 0 and ascend")
    used = index[: int(start[-1])]
    if used.size and not (0 <= used.min() and used.max() < n):
        wrong = used.min() if used.min() < 0 else used.max()
        refuse(name, f"its indices have {wrong}, and must be within 0 and {n - 1}")


def copies_of(matrix: Matrix) -> tuple[Any, Any, Any]:
    """Copies of indices, indptr and data (empty for a pattern) of a matrix of the library's, by columns."""

    def copy(pointer: int | None, ctype: Any, count: int) -> npt.NDArray[Any]:
        if not pointer or not count:
            return np.empty(0, ctype)
        return np.frombuffer((ctype * count).from_address(pointer), np.dtype(ctype)).copy()

    start = copy(matrix.start, ctypes.c_int32, matrix.columns + 1)
    count = int(start[-1])
    return copy(matrix.index, ctypes.c_int32, count), start, copy(matrix.value, ctypes.c_double, count)
