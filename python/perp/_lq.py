# SPDX-License-Identifier: Apache-2.0
"""Games of players with quadratic costs and linear constraints that all share, as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from perp._arrays import doubles, refuse
from perp._result import Shown
from perp._types import Array, Bound, Options
from perp._vi import ViResult, vi

_EPS = float(np.finfo(float).eps)


@dataclass(frozen=True, eq=False)
class LqEquilibrium(Shown):
    """What `lq_game` found."""

    x: Array
    """Shape (n,): the variables of all players."""
    multipliers: Array
    """Shape (rows of A,): y >= 0 of A x <= b, the same for all players."""
    equality_multipliers: Array
    """Shape (rows of Aeq,): of Aeq x = beq."""
    convex: list[bool]
    """Of each player, whether its own block of Q is positive semidefinite: then nobody gains alone at a solution."""
    result: ViResult
    """Of the affine variational inequality."""

    @property
    def success(self) -> bool:
        """Whether it is solved and every player's problem is convex: then x is an equilibrium."""
        return self.result.success and all(self.convex)


def lq_game(
    sizes: Sequence[int],
    Q: Sequence[npt.ArrayLike],
    c: Sequence[npt.ArrayLike],
    A: npt.ArrayLike | None = None,
    b: npt.ArrayLike | None = None,
    Aeq: npt.ArrayLike | None = None,
    beq: npt.ArrayLike | None = None,
    lower: Bound = -np.inf,
    upper: Bound = np.inf,
    *,
    method: str | None = None,
    options: Options | None = None,
    **more: object,
) -> LqEquilibrium:
    """A variational equilibrium of the game in which player i chooses its part x_i of x:

        min x' Q_i x / 2 + c_i' x    subject to    A x <= b,  Aeq x = beq,  lower <= x <= upper.

    sizes   variables of each player, whose sum is n; x is x_1, then x_2, ...
    Q, c    of each player: shape (n, n) and (n,). Only the rows of its own variables count; Q_i may be unsymmetric.
    A, b, Aeq, beq
            shape (m, n) and (m,), with one multiplier for all players.
    lower, upper
            as of `perp.solve`.
    method, options, more
            as of `perp.vi` with affine F.
    """
    sizes = [int(size) for size in sizes]
    n, players = sum(sizes), len(sizes)
    if not players or min(sizes) < 1 or len(Q) != players or len(c) != players:
        refuse("sizes", f"has {players} players, and must have as many as Q, {len(Q)}, and c, {len(c)}, with a variable each")
    G, g, begin = np.empty((n, n)), np.empty(n), 0
    blocks: dict[int, list[tuple[int, Array]]] = {}  # of players with so many variables, who they are and their own blocks
    for i, size in enumerate(sizes):
        own = slice(begin, begin + size)
        Qi, ci = _shaped(Q[i], (n, n), f"Q[{i}]"), _shaped(c[i], (n,), f"c[{i}]")
        np.add(Qi[own], Qi[:, own].T, out=G[own])
        g[own] = ci[own]
        blocks.setdefault(size, []).append((i, G[own, own]))
        begin += size
    G *= 0.5
    convex = [False] * players
    for size, of in blocks.items():
        together = np.array([block for _, block in of])
        rounding = 4 * size * _EPS * np.abs(together).sum(axis=1).max(axis=1)
        for (i, _), sure in zip(of, (np.linalg.eigvalsh(together)[:, 0] >= -rounding).tolist()):
            convex[i] = sure
    shared, right = _rows(A, b, n, "A", "b")
    equal, equal_right = _rows(Aeq, beq, n, "Aeq", "beq")
    rows = np.vstack([shared, equal])
    low = np.concatenate([np.full(len(right), -np.inf), equal_right])
    r = vi((G, g), None, rows, low, np.concatenate([right, equal_right]), lower, upper, method=method, options={**(options or {}), **more})
    found = len(r.x) == n
    x = np.array(r.x) if found else np.full(n, np.nan)
    y = -r.multipliers if found else np.full(len(rows), np.nan)
    return LqEquilibrium(x, y[: len(right)], y[len(right) :], convex, r)


def _shaped(given: Any, shape: tuple[int, ...], name: str) -> Array:
    numbers = doubles(given, name)
    if numbers.shape != shape:
        refuse(name, f"has shape {numbers.shape}, and must have shape {shape}")
    return numbers


def _rows(A: Any, b: Any, n: int, name: str, right: str) -> tuple[Array, Array]:
    if A is None and b is None:
        return np.empty((0, n)), np.empty(0)
    if A is None or b is None:
        refuse(name, f"goes with {right}: give both")
    rows = doubles(A, name)
    if rows.ndim != 2 or rows.shape[1] != n:
        refuse(name, f"has shape {rows.shape}, and must have shape (m, {n})")
    return rows, _shaped(b, (len(rows),), right)
