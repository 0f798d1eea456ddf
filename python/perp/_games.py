# SPDX-License-Identifier: Apache-2.0
"""Finite games: all equilibria of two players, exactly, and equilibria of more by the path search."""

from __future__ import annotations

import itertools
import math
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
import numpy.typing as npt

from perp._arrays import refuse, refuse_type
from perp._library import FileError
from perp._result import Shown
from perp._types import Array, Path

Exact = tuple[Fraction, ...]


@dataclass(frozen=True)
class NashSubset(Shown):
    """A maximal Nash subset: every x in the convex hull of `first` with every y in that of `second` is an equilibrium."""

    first: tuple[Exact, ...]
    """Vertices, mixed strategies of the first player."""
    second: tuple[Exact, ...]
    """The same of the second player."""

    @property
    def single(self) -> bool:
        """Whether it is one point."""
        return len(self.first) == len(self.second) == 1


@dataclass(frozen=True)
class BimatrixEquilibria(Shown):
    """All equilibria of a bimatrix game: they are the union of `subsets`."""

    extreme: list[tuple[Exact, Exact]]
    """The extreme equilibria, pairs of vertices, as fractions."""
    subsets: list[NashSubset]
    """The maximal Nash subsets. They may overlap."""
    components: list[list[NashSubset]]
    """The same, those that are connected with each other together."""

    @property
    def arrays(self) -> list[tuple[Array, Array]]:
        """The extreme equilibria as arrays, of shape (m,) and (n,)."""
        return [(np.array(x, dtype=float), np.array(y, dtype=float)) for x, y in self.extreme]


def bimatrix(A: Any, B: Any) -> BimatrixEquilibria:
    """All equilibria of the game in which the players get A and B, shape (m, n) each, entries numbers or fractions.

    The vertices of both best response polytopes are enumerated by the double description method in integers, so nothing is
    rounded; an equilibrium is a pair of them that has all labels (von Stengel 2002, Avis, Rosenberg, Savani & von Stengel 2010).
    Entries that are floats count as the binary fractions that they are. The number of vertices grows exponentially: games of
    about 12 x 12 are the limit.
    """
    rows, columns = _exact(A, "A"), _exact(B, "B")
    m, n = len(rows), len(rows[0])
    if (len(columns), len(columns[0])) != (m, n):
        refuse("B", f"has shape ({len(columns)}, {len(columns[0])}), and must have that of A, ({m}, {n})")
    # Labels: bit i, strategy i of the first player, is unused or a best response; bit m + j the same of the second.
    xs = [(x, unused | best << m) for x, unused, best in _vertices([list(one) for one in zip(*columns)])]
    ys = [(y, unused << m | best) for y, unused, best in _vertices(rows)]
    every = (1 << (m + n)) - 1
    partners = [frozenset(k for k, (_, b) in enumerate(ys) if a | b == every) for _, a in xs]
    extreme = [(xs[i][0], ys[k][0]) for i, found in enumerate(partners) for k in sorted(found)]
    pairs = _bicliques(partners)
    subsets = [NashSubset(tuple(xs[i][0] for i in left), tuple(ys[k][0] for k in right)) for left, right in pairs]
    return BimatrixEquilibria(extreme, subsets, [[subsets[k] for k in group] for group in _connected(pairs)])


def _exact(matrix: Any, name: str) -> list[list[Fraction]]:
    entries = np.asarray(matrix, dtype=object)
    if entries.ndim != 2 or 0 in entries.shape:
        refuse(name, f"has shape {entries.shape}, and must have two dimensions and entries")
    try:
        return [[Fraction(one.item() if hasattr(one, "item") else one) for one in row] for row in entries]
    except (TypeError, ValueError, OverflowError) as error:
        refuse(name, f"has an entry that is no finite number: {error}")


def _vertices(matrix: list[list[Fraction]]) -> list[tuple[Exact, int, int]]:
    """The vertices but 0 of {x >= 0, C x <= 1}, C the matrix made positive, each scaled to the sum 1; bits of the x_j = 0 and of
    the rows of C x <= 1 that are equations."""
    least = min(map(min, matrix))
    scale = math.lcm(*(one.denominator for row in matrix for one in (*row, least)))
    C = [[int((one - least) * scale) + scale for one in row] for row in matrix]
    n = len(C[0])
    # Rays (x, t) of the cone x >= 0, C x <= t, and bits of what is an equation on them: n + 1 rays of the first n + 1 rows.
    unit = [tuple(int(i == j) for i in range(n)) for j in range(n)]
    full = (1 << n) - 1
    rays = [((0,) * n + (1,), full)]
    rays += [((*e, C[0][j]), (full & ~(1 << j)) | 1 << n) for j, e in enumerate(unit)]
    for k, row in enumerate(C[1:], start=n + 1):
        rays = _cut(rays, row, k, n + 1)
    found = []
    for (*x, _), bits in rays:
        total = sum(x)
        if total:
            found.append((tuple(Fraction(one, total) for one in x), bits & full, bits >> n))
    return found


def _cut(rays: list[tuple[tuple[int, ...], int]], row: list[int], k: int, dimension: int) -> list[tuple[tuple[int, ...], int]]:
    """The rays of the cone with row k, t - row x >= 0, besides (Motzkin, Raiffa, Thompson & Thrall 1953; Fukuda & Prodon
    1996)."""
    slack = [ray[-1] - sum(map(int.__mul__, row, ray)) for ray, _ in rays]
    kept = [(ray, bits | 1 << k if s == 0 else bits) for (ray, bits), s in zip(rays, slack) if s >= 0]
    inside = [(one, s) for one, s in zip(rays, slack) if s > 0]
    outside = [(one, s) for one, s in zip(rays, slack) if s < 0]
    every = [bits for _, bits in rays]
    for (a, of_a), s in inside:
        for (b, of_b), t in outside:
            both = of_a & of_b
            if bin(both).count("1") < dimension - 2:
                continue
            if sum(bits & both == both for bits in every) != 2:  # they share no edge
                continue
            new = [s * q - t * p for p, q in zip(a, b)]
            divisor = math.gcd(*new)
            kept.append((tuple(one // divisor for one in new), both | 1 << k))
    return kept


def _bicliques(partners: list[frozenset[int]]) -> list[tuple[list[int], list[int]]]:
    """The maximal pairs of sets, each of the first with each of the second: the intersections of sets of partners."""
    closed = {one for one in partners if one}
    new = set(closed)
    while new:
        new = {a & b for a in new for b in closed if a & b} - closed
        closed |= new
    pairs = [([i for i, found in enumerate(partners) if right <= found], sorted(right)) for right in closed]
    return sorted(pairs)


def _connected(pairs: list[tuple[list[int], list[int]]]) -> list[list[int]]:
    groups: list[tuple[set[int], set[int], list[int]]] = []
    for k, (left, right) in enumerate(pairs):
        merged = (set(left), set(right), [k])
        apart = []
        for group in groups:
            if group[0] & merged[0] and group[1] & merged[1] and _meet(pairs, group[2], merged[2]):
                merged = (group[0] | merged[0], group[1] | merged[1], group[2] + merged[2])
            else:
                apart.append(group)
        groups = [*apart, merged]
    return [sorted(group[2]) for group in groups]


def _meet(pairs: list[tuple[list[int], list[int]]], some: list[int], others: list[int]) -> bool:
    """Whether two of them have an extreme equilibrium in common."""
    return any(set(pairs[a][0]) & set(pairs[b][0]) and set(pairs[a][1]) & set(pairs[b][1]) for a in some for b in others)


# More players


@dataclass(frozen=True, eq=False)
class MixedEquilibrium(Shown):
    """An equilibrium of a finite game."""

    strategies: list[Array]
    """Of each player, shape (its strategies,)."""
    payoffs: Array
    """Shape (players,)."""
    regret: float
    """The most that a player gains by another pure strategy, computed from the payoffs alone: there is no better response."""


def finite_game(
    payoffs: Sequence[npt.ArrayLike], starts: int = 20, seed: int = 0, tolerance: float = 1e-9, **options: object
) -> list[MixedEquilibrium]:
    """Equilibria of a finite game of N players: all pure ones, and those to which the solver comes from random starts.

    payoffs N arrays of shape (m_1, ..., m_N): what each player gets for each combination of strategies.
    starts, seed
            how many mixed strategies to start from, and the seed of them.
    tolerance
            the largest regret, as a part of the range of the payoffs. Others are dropped.
    options of `perp.solve`.

    Nothing says that all mixed equilibria are found; for two players `perp.bimatrix` finds all.
    """
    from perp._problem import problem

    u = [np.asarray(one, dtype=float) for one in payoffs]
    if not u or any(one.shape != u[0].shape for one in u) or u[0].ndim != len(u) or 0 in u[0].shape:
        refuse("payoffs", "must have one array for each player, all of the shape (strategies of the first player, ...)")
    sizes = u[0].shape
    ranges = [max(float(np.ptp(one)), np.finfo(float).tiny) for one in u]
    scaled = [(one - one.min()) / width for one, width in zip(u, ranges)]
    split = np.cumsum(sizes)[:-1]
    total, players = sum(sizes), len(sizes)
    first = [0, *split]

    def F(z: Array) -> Array:
        x, v = np.split(z[:total], split), z[total:]
        gains = [v[i] - _against(scaled[i], x, (i,)) for i in range(players)]
        return np.concatenate([*gains, [1 - one.sum() for one in x]])

    def jac(z: Array) -> Array:
        x = np.split(z[:total], split)
        J = np.zeros((len(z), len(z)))
        for i, k in itertools.permutations(range(players), 2):
            block = _against(scaled[i], x, (i, k))
            J[first[i] : first[i] + sizes[i], first[k] : first[k] + sizes[k]] = -(block if i < k else block.T)
        for i in range(players):
            mine = slice(first[i], first[i] + sizes[i])
            J[mine, total + i], J[total + i, mine] = 1.0, -1.0
        return J

    lower = np.concatenate([np.zeros(total), np.full(players, -np.inf)])
    game = problem(F, np.zeros(total + players), lower, jac=jac, name="game")
    random = np.random.default_rng(seed)
    found: list[MixedEquilibrium] = []

    def add(x: list[Array]) -> None:
        x = [np.maximum(one, 0) / np.maximum(one, 0).sum() for one in x]
        answers = [_against(scaled[i], x, (i,)) for i in range(players)]
        regrets = [float(answer.max() - answer @ one) for answer, one in zip(answers, x)]
        known = any(max(np.abs(a - b).max() for a, b in zip(x, one.strategies)) < 1e-6 for one in found)
        if max(regrets) <= tolerance and not known:
            own = np.array([_against(u[i], x, (i,)) @ x[i] for i in range(players)])
            found.append(MixedEquilibrium(x, own, max(r * width for r, width in zip(regrets, ranges))))

    best = [one == one.max(axis=i, keepdims=True) for i, one in enumerate(u)]
    for profile in np.argwhere(np.logical_and.reduce(best)):
        add([np.eye(size)[k] for size, k in zip(sizes, profile)])
    for _ in range(starts):
        x = [random.dirichlet(np.ones(size)) for size in sizes]
        v = [float(_against(scaled[i], x, (i,)).max()) for i in range(players)]
        r = game.solve(np.concatenate([*x, v]), options={"convergence_tolerance": 1e-11, **options})
        if np.isfinite(r.x).all() and all(one.sum() > 0 for one in np.split(np.maximum(r.x[:total], 0), split)):
            add(np.split(np.array(r.x[:total]), split))
    return found


def _against(payoff: Array, x: list[Array], kept: tuple[int, ...]) -> Array:
    """The payoff expected of the mixed strategies x of all but the players kept, whose axes stay."""
    for k in reversed(range(len(x))):
        if k not in kept:
            payoff = np.tensordot(payoff, x[k], axes=(k, 0))
    return payoff


# Files


@dataclass(frozen=True, eq=False)
class FiniteGame(Shown):
    """A game of an .nfg file."""

    title: str
    players: list[str]
    payoffs: list[Any]
    """Of each player, an array of fractions, dtype object, of shape (m_1, ..., m_N)."""


def read_nfg(path: Path) -> FiniteGame:
    """A finite game of a file in Gambit's format for strategic games, .nfg, by payoffs or by outcomes. FileError says what is
    wrong with a file."""
    try:
        with open(path, encoding="utf-8") as file:
            return _Nfg(os.fsdecode(path), file.read()).game()
    except TypeError:
        refuse_type("path", f"is of type {type(path).__name__}, and must be str or os.PathLike")


class _Nfg:
    def __init__(self, name: str, text: str) -> None:
        self.name = name
        self.words = re.findall(r'"(?:[^"\\]|\\.)*"|[{}]|[^\s{}",]+', text)
        self.at = 0

    def fail(self, why: str) -> FileError:
        return FileError(f"{self.name}: {why}")

    def next(self, expected: str = "") -> str:
        if self.at >= len(self.words):
            raise self.fail(f"it ends where {expected or 'more'} is expected")
        word = self.words[self.at]
        self.at += 1
        if expected and word != expected:
            raise self.fail(f"{word} where {expected} is expected")
        return word

    def group(self) -> list[Any]:
        """What is between { and }, groups within as lists."""
        self.next("{")
        items: list[Any] = []
        while self.words[self.at : self.at + 1] != ["}"]:
            items.append(self.group() if self.words[self.at : self.at + 1] == ["{"] else self.next())
        self.next("}")
        return items

    def number(self, word: str) -> Fraction:
        try:
            return Fraction(word)
        except (ValueError, ZeroDivisionError):
            raise self.fail(f"{word} is no number") from None

    def game(self) -> FiniteGame:
        self.next("NFG")
        self.next("1")
        if self.next() not in ("R", "D"):
            raise self.fail("its third word is neither R nor D")
        title = self.next().strip('"')
        players = [str(name).strip('"') for name in self.group()]
        sizes = [len(one) if isinstance(one, list) else int(self.number(one)) for one in self.group()]
        if len(sizes) != len(players) or not players or min(sizes) < 1:
            raise self.fail(f"there are {len(players)} players, and strategies of {len(sizes)}")
        if self.words[self.at : self.at + 1] and self.words[self.at].startswith('"'):
            self.next()  # a comment
        count = math.prod(sizes)
        if self.words[self.at : self.at + 1] == ["{"]:
            outcomes = [[Fraction(0)] * len(players)]  # that of number 0
            outcomes += [[self.number(word) for word in one[1:]] for one in self.group()]
            numbers = [int(self.number(word)) for word in self.words[self.at :]]
            if any(not 0 <= k < len(outcomes) for k in numbers):
                raise self.fail("a combination has an outcome that does not exist")
            values = [value for k in numbers for value in outcomes[k]]
        else:
            values = [self.number(word) for word in self.words[self.at :]]
        if len(values) != count * len(players):
            raise self.fail(f"it has {len(values)} payoffs, and must have {count * len(players)}")
        table = np.array(values, dtype=object).reshape(count, len(players))
        return FiniteGame(title, players, [table[:, i].reshape(sizes, order="F") for i in range(len(players))])
