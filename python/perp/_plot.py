# SPDX-License-Identifier: Apache-2.0
"""Pictures of results; needs matplotlib."""

from __future__ import annotations

from typing import Any

from perp._result import Result


def plot(result: Result, ax: Any = None) -> Any:
    """Draws the residual of each iteration of `result` into `ax`, or new axes, which it returns."""
    if not isinstance(result, Result):
        raise TypeError(f"result: is of type {type(result).__name__}, and must be a perp.Result")
    try:
        from matplotlib import pyplot
    except ImportError as missing:
        raise ImportError("perp.plot needs matplotlib: pip install matplotlib, or apt install python3-matplotlib") from missing
    if ax is None:
        ax = pyplot.subplots()[1]
    log = result.log
    residual = log["residual"]
    ax.semilogy(range(len(residual)), residual.clip(min=1e-300), marker=".")
    ax.set_xlabel("iteration")
    ax.set_ylabel("natural residual")
    ax.set_title(f"{result.status}, residual {result.residual:.2g}")
    return ax
