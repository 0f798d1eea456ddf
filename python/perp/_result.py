# SPDX-License-Identifier: Apache-2.0
"""What a solve answers."""

from __future__ import annotations

import html
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from perp._types import Array


def _table(rows: list[tuple[str, str]]) -> str:
    cells = "".join(
        f"<tr><th style='text-align:left'>{html.escape(a)}</th><td style='text-align:left'>{html.escape(b)}</td></tr>"
        for a, b in rows
    )
    return f"<table>{cells}</table>"


class Log:
    """The iterations of a solve, a row each: iteration over its rows, columns by name.

    log["residual"] is an array of shape (rows,), log[-1] the last row, log.array all as a structured array, of which
    pandas.DataFrame makes a frame.
    """

    def __init__(self, array: npt.NDArray[np.void]) -> None:
        self.array = array

    @property
    def columns(self) -> tuple[str, ...]:
        """k, residual (natural), worst (row where it is largest), merit, step, prox, mu, pivots, backtracks, F_evals,
        J_evals (both so far), crash, kind (of the step), linear (how its linear problem was solved)."""
        return self.array.dtype.names or ()

    def __len__(self) -> int:
        return len(self.array)

    def __getitem__(self, key: str | int | slice) -> Any:
        return self.array[key]

    def __iter__(self) -> Iterator[Any]:
        return iter(self.array)

    def _cells(self) -> list[list[str]]:
        return [[f"{v:.3g}" if isinstance(v, float) else str(v) for v in row.item()] for row in self.array]

    def __str__(self) -> str:
        lines = [list(self.columns), *self._cells()]
        widths = [max(len(line[c]) for line in lines) for c in range(len(self.columns))]
        return "\n".join("  ".join(cell.rjust(w) for cell, w in zip(line, widths)).rstrip() for line in lines)

    def __repr__(self) -> str:
        return f"<perp.Log: {len(self)} rows of {', '.join(self.columns)}>"

    def _repr_html_(self) -> str:
        head = "".join(f"<th>{html.escape(c)}</th>" for c in self.columns)
        body = "".join(
            "<tr>" + "".join(f"<td>{html.escape(c)}</td>" for c in line) + "</tr>" for line in self._cells()
        )
        return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


@dataclass(repr=False, eq=False)
class Result:
    """How a solve ended, and the best point it met."""

    x: Array
    """Shape (n,): the best point met, within the bounds."""
    F: Array
    """Shape (n,): F(x)."""
    status: str
    """"Solved", "SolvedToRounding", "Infeasible", "NoProgress", "TimeLimit", ... (docs/python.md)."""
    success: bool
    """Whether the natural residual is at most the tolerance. False for SolvedToRounding."""
    message: str
    """What happened, with names and values."""
    advice: str
    """What to try; empty if solved."""
    residual: float
    """The natural residual ||x - mid(lower, x - F, upper)||_inf, zero exactly at solutions."""
    worst: int
    """The row where it is largest; -1: none."""
    relative: float
    """The largest residual of a row beside the terms it is the rest of; nan where jac is not defined."""
    relative_row: int
    """That row; -1: none."""
    notes: list[str]
    """What a solution leaves to be said."""
    basis: npt.NDArray[np.int8] | None
    """Shape (n,): 0 at the lower bound, 1 between, 2 at the upper bound, 3 fixed; for `basis` of a nearby problem."""
    stats: dict[str, float]
    """iterations, F_evals, J_evals, J_F_evals (for differences), pivots, time_s, ...; F_calls counts them all."""
    _rows: npt.NDArray[np.void] | None
    verified: Verified | None = None
    """With the option verify: the proof that a solution is near, or why there is none."""

    @property
    def log(self) -> Log:
        """The iterations, a row each. Empty for single solutions of `solve_all`."""
        return Log(np.empty(0, dtype=[("k", "i4"), ("residual", "f8")]) if self._rows is None else self._rows)

    def _facts(self) -> list[tuple[str, str]]:
        facts = [
            ("status", self.status),
            ("success", str(self.success)),
            ("message", self.message),
            ("residual", f"{self.residual:.3g}"),
            ("iterations", str(self.stats["iterations"])),
            ("evaluations", f"{self.stats['F_evals']} of F, {self.stats['J_evals']} of J"),
            ("time", f"{self.stats['time_s']:.3g} s"),
            ("x", np.array2string(self.x, threshold=20)),
            ("F", np.array2string(self.F, threshold=20)),
        ]
        if self.advice:
            facts.insert(3, ("advice", self.advice))
        return facts

    def __repr__(self) -> str:
        return "\n".join(f"{name:>12}: {text}" for name, text in self._facts())

    def _repr_html_(self) -> str:
        return _table(self._facts())


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a solve. `result` is what it had, with its best point."""

    def __init__(self, result: Any) -> None:
        super().__init__("interrupted; the best point is in .result")
        self.result = result


def finished(answer: tuple[tuple[Any, ...], BaseException | None]) -> Result:
    """The result of what _core returns; raises Interrupted with it if Ctrl-C came."""
    parts, verified = answer[0][:-1], answer[0][-1]
    result = Result(*parts)
    if verified is not None:
        result.verified = Verified(*verified)
    if answer[1] is not None:
        raise Interrupted(result) from answer[1]
    return result


@dataclass(eq=False)
class FoundSolution:
    """One of several solutions."""

    result: Result
    how: str
    """The method, or the kind of deflation, that found it."""
    singular: str
    """Why J is singular there, so that it may be one of a continuum; empty: it is regular."""

    @property
    def x(self) -> Array:
        """Shape (n,)."""
        return self.result.x


@dataclass(repr=False, eq=False)
class AllSolutions:
    """What `solve_all` found: iterates over the solutions. An empty-handed end is no proof that there are no others."""

    found: list[FoundSolution]
    first: Result
    """Of the method from x0, solved or not."""
    attempts: int
    duplicates: int
    message: str
    stats: dict[str, float]

    def __repr__(self) -> str:
        lines = [f"{len(self.found)} solutions, {self.attempts} attempts: {self.message}"]
        return "\n".join(lines + [f"  x = {np.array2string(one.x, threshold=10)}  by {one.how}" for one in self.found])

    def __len__(self) -> int:
        return len(self.found)

    def __getitem__(self, k: int) -> FoundSolution:
        return self.found[k]

    def __iter__(self) -> Iterator[FoundSolution]:
        return iter(self.found)


@dataclass(eq=False)
class Sensitivity:
    """How a solution moves with m parameters."""

    status: str
    """"Differentiable", "Directional"; refused: "Degenerate", "Singular", "NotASolution", "NotDefined", "TooLarge"."""
    known: bool
    """Whether dx and dF are derivatives."""
    message: str
    dx: Array
    """Shape (n, m): dx_i/dp_j; (n, 1) in a direction; (0, 0) if refused."""
    dF: Array
    """Of the same shape: the total derivative of F_i."""
    states: list[str]
    """Of every variable: where it is."""
    degenerate: npt.NDArray[np.int64]
    """Indices at a bound where F is zero, too."""
    rcond: float
    strongly_regular: bool
    residual: float


@dataclass(eq=False)
class Verified:
    """A proof that a solution is near."""

    unique: bool
    """Whether exactly one solution y is within the bounds and |y_i - x_i| <= radius_i."""
    x: Array
    """Shape (n,): the point given, after Newton steps."""
    radius: Array
    """Shape (n,); empty if there is no proof."""
    active: int
    """Variables at a bound."""
    why_not: str
    """Why there is no proof; empty if there is one."""


@dataclass
class JacobianCheck:
    """jac compared with differences of F."""

    worst: float
    """The largest |J_ij - D_ij| / max(1, |J_ij|, |D_ij|)."""
    row: int
    column: int
    given: float
    difference: float
    outside_pattern: bool
    """Whether F depends there on a variable that the pattern denies."""
    message: str
    """One sentence; empty if jac agrees to 1e-4."""

    @property
    def ok(self) -> bool:
        return not self.message


@dataclass
class Inspection:
    """What is known of a problem before it is solved."""

    name: str
    size: int
    nonzeros: int
    affine: bool
    bounds: dict[str, int]
    """How many variables are free, lower (bounded below only), upper, boxed, fixed."""
    structural_rank: int
    """Of the pattern of J; below `size` J is singular everywhere."""
    residual: float
    """Of the start."""
    worst: str
    """The equation where it is largest."""
    singular: str
    """Why the block of J that Newton's method needs is singular at the start; empty: nothing was found."""
    classes: dict[str, bool | None]
    """Of the matrix of an affine problem: "P", "positive semidefinite", ...; None: not decided."""
    guarantees: list[str]
    """What follows from them."""

    def _facts(self) -> list[tuple[str, str]]:
        facts = [
            ("problem", self.name),
            ("size", f"{self.size} variables, {self.nonzeros} nonzeros" + (", affine" if self.affine else "")),
            ("bounds", ", ".join(f"{count} {kind}" for kind, count in self.bounds.items() if count)),
            ("structural rank", str(self.structural_rank)),
            ("start", f"residual {self.residual:.3g}" + (f", worst in {self.worst}" if self.worst else "")),
        ]
        if self.singular:
            facts.append(("singular", self.singular))
        if self.classes:
            facts.append(("matrix", ", ".join(name for name, yes in self.classes.items() if yes) or "none known"))
        return facts + [("guarantee", text) for text in self.guarantees]

    def __str__(self) -> str:
        return "\n".join(f"{name:>15}: {text}" for name, text in self._facts())

    def _repr_html_(self) -> str:
        return _table(self._facts())
