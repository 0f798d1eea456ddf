# SPDX-License-Identifier: Apache-2.0
"""Names for what arguments are."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from typing import Any, Protocol, Union

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
#: An array of shape (n,), or a number that stands for all n.
Bound = Union[float, npt.ArrayLike, None]
#: A dense array or a scipy.sparse matrix, whose classes have no types that could stand here.
Matrix = Any
Function = Callable[[Array], npt.ArrayLike]
Jacobian = Callable[[Array], Matrix]
#: True prints; a function gets each line.
LogTo = Union[bool, Callable[[str], object], None]
#: Pairs (low, high) with None for none, or a scipy.optimize.Bounds.
Bounds = Any
Options = Mapping[str, object]
Path = Union[str, "os.PathLike[str]"]


class Callback(Protocol):
    """Called after each iteration with its row of the log and the iterate.

    x has shape (n,), or is None where the iterate belongs to a presolved or scaled problem. What is true ends the
    solve, and so does StopIteration.
    """

    def __call__(self, row: Any, x: Array | None, /) -> object: ...
