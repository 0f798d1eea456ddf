# SPDX-License-Identifier: Apache-2.0
"""Small dense affine problems that come often."""

from __future__ import annotations

import ctypes
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from perp import _library
from perp._arrays import address, bound, doubles, refuse, vector
from perp._library import INTERFACE, call, made
from perp._types import Bound


class DenseResult(NamedTuple):
    """The best point x, how the solve ended ("Solved", ...), and the natural residual of x."""

    x: npt.NDArray[np.float64]
    status: str
    residual: float

    @property
    def success(self) -> bool:
        return self.status == "Solved"


class DenseSolver:
    """Solves MCP(lower, upper, M x + q) for small dense M a thousand times a second: it keeps its memory and the cell of
    its last solution, in which it begins where the next problem has as many variables.

        solver = perp.DenseSolver()
        x = solver.solve(M, q, lower=0, upper=1).x

    It is made for P-matrices, such as positive definite ones; others are solved as by `mcp_affine`.
    """

    def __init__(self, tol: float = 1e-9) -> None:
        self.tol = tol
        self._handle = made(_library.lib.perp_dense_create, _library.lib.Dense, INTERFACE)

    def solve(
        self, M: npt.ArrayLike, q: npt.ArrayLike, lower: Bound = 0.0, upper: Bound = np.inf
    ) -> DenseResult:
        shift = vector(q, -1, "q")
        n = len(shift)
        entries = np.ascontiguousarray(doubles(M, "M"))
        if entries.shape != (n, n):
            refuse("M", f"has shape {entries.shape}, and must have shape ({n}, {n})")
        bounds = [bound(lower, n, 0.0, "lower"), bound(upper, n, np.inf, "upper")]
        x, status, residual = np.empty(n), ctypes.c_int32(), ctypes.c_double()
        call(
            _library.lib.perp_dense_solve,
            self._handle,
            n,
            address(entries),
            address(shift),
            *(None if b is None else address(b) for b in bounds),
            self.tol,
            address(x),
            ctypes.byref(status),
            ctypes.byref(residual),
        )
        return DenseResult(x, _library.lib.perp_status_name(status.value).decode(), residual.value)

    def forget(self) -> None:
        """The next solve begins at the bounds."""
        _library.lib.perp_dense_forget(self._handle)
