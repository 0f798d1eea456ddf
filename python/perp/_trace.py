# SPDX-License-Identifier: Apache-2.0
"""The solution of a complementarity problem as a curve in a parameter: `trace`, and `python -m perp trace MODEL`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from perp._arrays import refuse
from perp._batch import natural
from perp._problem import Problem
from perp._result import Result, Shown
from perp._solve import solve
from perp._types import Array

#: Newton's steps onto the curve; more mean that the step along it was too long.
_NEWTON = 8


class TraceEvent(NamedTuple):
    """A point of the curve where something happens."""

    kind: str
    """"kink": a variable meets or leaves a bound; "fold": p turns round; "bifurcation": curves cross; "end"."""
    p: float
    x: Array
    variable: int
    """Of a kink: which variable; else -1."""
    bound: str
    """Of a kink: "lower" or "upper"; else ""."""
    point: int
    """Its place among the points of the curve."""


@dataclass(frozen=True, eq=False)
class Curve(Shown):
    """What `trace` found."""

    p: Array
    """Shape (points,): the parameter along the curve, where it turns round at folds."""
    x: Array
    """Shape (points, n): the solutions; kinks are points of their own."""
    residual: Array
    """Shape (points,): the natural residuals."""
    slope: Array
    """Shape (points, n): dx/dp on the piece that begins at the point; infinite at folds."""
    events: list[TraceEvent]
    success: bool
    """Whether the curve reached an end of the interval, every point of it within the tolerance."""
    message: str
    names: list[str] = field(default_factory=list)
    parameter: str = "p"

    @property
    def elasticity(self) -> Array:
        """Shape (points, n): (dx/dp) p / x, nan where x is 0."""
        with np.errstate(all="ignore"):
            return np.where(self.x != 0, self.slope * self.p[:, None] / self.x, np.nan)

    def kinds(self, kind: str) -> list[TraceEvent]:
        """The events of that kind."""
        return [event for event in self.events if event.kind == kind]

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        events = [{**event._asdict(), "x": event.x.tolist()} for event in self.events]
        return {
            "p": self.p.tolist(),
            "x": self.x.tolist(),
            "residual": self.residual.tolist(),
            "events": events,
            "success": self.success,
            "message": self.message,
            "names": self.names,
            "parameter": self.parameter,
        }

    def table(self) -> str:
        """The events, a line each."""
        lines = [f"{'event':12} {'p':>20}  what"]
        for event in self.events:
            name = "" if event.variable < 0 else f"{self._name(event.variable)} at its {event.bound} bound"
            lines.append(f"{event.kind:12} {event.p:20.12g}  {name}".rstrip())
        return "\n".join(lines)

    def _name(self, i: int) -> str:
        return self.names[i] if self.names else f"x[{i}]"

    def plot(self, variables: list[int] | None = None, ax: Any = None) -> Any:
        """Draws variables against p with matplotlib, all by default; kinks are dots, folds triangles, bifurcations
        crosses. Returns the axes."""
        if ax is None:
            import matplotlib.pyplot as plt

            ax = plt.subplots()[1]
        marks = {"kink": "o", "fold": "^", "bifurcation": "x"}
        for i in range(self.x.shape[1]) if variables is None else variables:
            (line,) = ax.plot(self.p, self.x[:, i], label=self._name(i))
            for event in self.events:
                if event.kind in marks and event.variable in (-1, i):
                    ax.plot(event.p, event.x[i], marks[event.kind], color=line.get_color())
        ax.set_xlabel(self.parameter)
        ax.legend()
        return ax


def trace(
    F: Callable[[Array, float], npt.ArrayLike] | Problem,
    x0: npt.ArrayLike | None,
    interval: tuple[float, float],
    lower: npt.ArrayLike = 0,
    upper: npt.ArrayLike = np.inf,
    jac: Callable[[Array, float], Any] | None = None,
    *,
    parameter: str | int | None = None,
    step: float | None = None,
    points: int = 2000,
    tol: float = 1e-8,
) -> Curve:
    """The solutions of MCP(lower, upper, F(., p)) as a curve in p, from p = interval[0] until p leaves the interval.

    F       (x, p) -> F(x, p), x of shape (n,); once continuously differentiable in both. Or a Problem, in which the
            variable `parameter`, by name or number, is p, and its condition is left out; then without lower, upper, jac.
    x0      shape (n,), from which the solution at interval[0] is sought.
    jac     (x, p) -> dF/dx, dense or scipy.sparse; None: differences.
    step    the longest step along the curve; None: a 50th of the interval.
    points  the most points.
    tol     of the natural residual of each point.

    The curve is G(y, p) = F(x, p) + y - x = 0, x = mid(lower, y, upper) (the normal map; Robinson, Math. Oper. Res. 17
    (1992) 691), which is smooth between kinks, where a y_i passes a bound. Steps go along the tangent, so that folds,
    where p turns round, are passed, and Newton's method comes back to the curve (Allgower & Georg, Introduction to
    Numerical Continuation Methods, SIAM 2003). Kinks are located by Newton's method on G = 0, y_i = bound; folds and
    bifurcations by bisection on dp/ds and on the sign of a determinant. Behind a kink the curve goes on where y_i goes on;
    at a bifurcation it goes straight on.
    """
    first, last = float(interval[0]), float(interval[1])
    if first == last or not np.isfinite([first, last]).all():
        refuse("interval", f"is ({first}, {last}), and must be two different numbers")
    names: list[str] = []
    if isinstance(F, Problem):
        F, x0, lower, upper, jac, names = _of_problem(F, x0, parameter)
    start = np.atleast_1d(np.asarray(x0, dtype=float))
    box = [np.broadcast_to(np.asarray(side, float), start.shape).copy() for side in (lower, upper)]
    tracer = _Tracer(F, box[0], box[1], jac, first, last, step or abs(last - first) / 50, points, tol, names)
    curve = tracer.run(start)
    return replace(curve, parameter=parameter) if isinstance(parameter, str) else curve


def _of_problem(problem: Problem, x0: Any, parameter: Any) -> tuple[Any, ...]:
    names = problem.variable_names
    if parameter is None or (isinstance(parameter, str) and parameter not in names):
        refuse("parameter", f"is {parameter!r}, and must be a variable of the problem: {', '.join(names[:20])}")
    k = names.index(parameter) if isinstance(parameter, str) else int(parameter)
    keep = np.delete(np.arange(problem.size), k)

    def whole(x: Array, p: float) -> Array:
        z = np.empty(problem.size)
        z[keep], z[k] = x, p
        return z

    lower, upper = problem.lower[keep], problem.upper[keep]
    begin = problem.x0[keep] if x0 is None else x0
    return (
        lambda x, p: problem.F(whole(x, p))[keep],
        begin,
        lower,
        upper,
        lambda x, p: problem.jac(whole(x, p))[keep][:, keep],
        [names[i] for i in keep],
    )


def _measured(inside: Array) -> Array:
    """1 for what the length of steps is measured in."""
    return np.append(inside.astype(float), 1.0)


class _Tracer:
    def __init__(self, F: Any, low: Array, high: Array, jac: Any, first: float, last: float, step: float, points: int, tol: float, names: list[str]) -> None:  # fmt: skip
        self.F = lambda x, p: np.asarray(F(x, p), dtype=float)
        self.low, self.high, self.jac = low, high, jac
        self.first, self.last, self.longest, self.points, self.tol, self.names = first, last, step, points, tol, names
        self.ps: list[float] = []
        self.xs: list[Array] = []
        self.slopes: list[Array] = []
        self.events: list[TraceEvent] = []

    # The piece of the curve on which the variables `inside` are inside; the others, at `at`, are at a bound.

    def point(self, y: Array, inside: Array, at: Array) -> Array:
        return np.where(inside, y, at)

    def G(self, z: Array, inside: Array, at: Array) -> Array:
        x = self.point(z[:-1], inside, at)
        return self.F(x, float(z[-1])) + z[:-1] - x

    def derivative(self, z: Array, inside: Array, at: Array) -> Array:
        """n x (n + 1)."""
        x, p = self.point(z[:-1], inside, at), float(z[-1])
        n = len(x)
        value = self.F(x, p)
        if self.jac is not None:
            J = self.jac(x, p)
            J = np.array(J.toarray() if hasattr(J, "toarray") else J, dtype=float)
        else:
            J = np.empty((n, n))
            for j in np.flatnonzero(inside):
                J[:, j] = self.slope_of(lambda t, j=j: self.F(np.where(np.arange(n) == j, t, x), p), x[j], value)
        D = np.zeros((n, n + 1))
        D[:, :-1][:, inside] = J[:, inside]
        D[~inside, np.flatnonzero(~inside)] = 1
        D[:, -1] = self.slope_of(lambda t: self.F(x, t), p, value)
        return D

    @staticmethod
    def slope_of(f: Any, t: float, value: Array) -> Array:
        """Central differences; one-sided ones where f is not defined on the other side."""
        h = 6e-6 * max(1.0, abs(t))
        with np.errstate(all="ignore"):
            up, down = f(t + h), f(t - h)
        both = (up - down) / ((t + h) - (t - h))
        return np.where(np.isfinite(both), both, np.where(np.isfinite(up), (up - value) / h, (value - down) / h))

    def tangent(self, z: Array, inside: Array, at: Array, along: Array) -> tuple[Array, float]:
        """The tangent with a positive product with `along`, and the sign of the determinant that turns at bifurcations. Its
        length is measured in x and p: y at a bound moves by F, in units of its own."""
        D = self.derivative(z, inside, at)
        t = np.linalg.svd(D)[2][-1]
        if (t * _measured(inside)) @ along < 0:
            t = -t
        length = float(np.linalg.norm(t * _measured(inside)))
        return t / (length or 1.0), float(np.linalg.slogdet(np.vstack([D, t]))[0])

    def correct(self, z: Array, inside: Array, at: Array, row: Array, value: float) -> Array | None:
        """Newton's method on G = 0, row z = value."""
        with np.errstate(all="ignore"):
            for _ in range(_NEWTON):
                G = self.G(z, inside, at)
                rest = np.append(G, row @ z - value)
                if not np.isfinite(rest).all():
                    return None
                try:
                    d = np.linalg.solve(np.vstack([self.derivative(z, inside, at), row]), -rest)
                except np.linalg.LinAlgError:
                    return None
                z = z + d
                if np.abs(d).max() <= 1e-13 * (1 + np.abs(z).max()):
                    break
            G = self.G(z, inside, at)
            good = np.isfinite(G).all() and np.abs(G).max() <= 0.1 * self.tol
        return z if good else None

    # The way along the curve.

    def run(self, x0: Array) -> Curve:
        p = self.first
        begin: Result = solve(
            lambda x: self.F(x, p), x0, self.low, self.high,
            jac=None if self.jac is None else lambda x: self.jac(x, p), convergence_tolerance=0.01 * self.tol,
        )  # fmt: skip
        if not begin.success:
            nothing = np.empty((0, len(x0)))
            return Curve(np.empty(0), nothing, np.empty(0), nothing, [], False, f"at p = {p}: {begin.message}", self.names)
        x = np.array(begin.x)
        y = x - self.F(x, p)
        inside = (y > self.low) & (y < self.high)
        at = np.where(y >= self.high, self.high, self.low)
        z = np.append(y, p)
        unit = np.append(np.zeros_like(y), 1.0)
        found = self.correct(z, inside, at, unit, p)
        z = z if found is None else found
        t, sign = self.tangent(z, inside, at, unit * np.sign(self.last - p))
        self.record(z, inside, at, t)
        return self.curve(self.follow(z, inside, at, t, sign))

    def follow(self, z: Array, inside: Array, at: Array, t: Array, sign: float) -> str:
        h = self.longest / 4
        low, high = min(self.first, self.last), max(self.first, self.last)
        unit = np.append(np.zeros(len(z) - 1), 1.0)
        while len(self.ps) < self.points:
            h = min(h, self.longest)
            ahead, seen = z + h * t, _measured(inside)
            new = self.correct(ahead, inside, at, t * seen, (t * seen) @ ahead)
            turned = None if new is None else self.tangent(new, inside, at, t * seen)
            # The step was too long: Newton fails, the curve bends by more than 30 degrees, or x is far from where the tangent led.
            if new is None or turned is None or (turned[0] * seen) @ t < 0.86 or np.linalg.norm((new - ahead) * seen) > 0.5 * h:
                h *= 0.5
                if h < 1e-10 * self.longest:
                    return "the curve could not be followed: it ends, or bends too sharply"
                continue
            kink = self.first_kink(z, new, inside, at, t)
            if kink == "shorter":
                h *= 0.5
                if h < 1e-12 * self.longest:
                    return "several variables meet their bounds at once, and no piece goes on"
                continue
            reached = kink[0] if kink else new
            t_reached, sign_reached = self.tangent(reached, inside, at, t * seen)
            self.between(z, reached, inside, at, t, t_reached, sign, sign_reached)
            if not low <= reached[-1] <= high:
                edge = low if reached[-1] < low else high
                share = (edge - z[-1]) / (reached[-1] - z[-1])
                end = self.correct(z + share * (reached - z), inside, at, unit, edge)
                if end is None:
                    return "the end of the interval was passed, and not met"
                self.record(end, inside, at, self.tangent(end, inside, at, t)[0])
                self.event("end", end, inside, at)
                return ""
            if kink:
                z, i, side = kink
                inside, at, t, sign = self.behind(z, i, inside, at, t_reached)
                self.record(z, inside, at, t)
                self.event("kink", z, inside, at, i, "lower" if side == self.low[i] else "upper")
                if t[-1] * t_reached[-1] < 0:
                    self.event("fold", z, inside, at)
                h = self.longest / 16
            else:
                z, t, sign = new, t_reached, sign_reached
                self.record(z, inside, at, t)
                h *= 1.5
        return f"after {self.points} points"

    def first_kink(self, z: Array, new: Array, inside: Array, at: Array, t: Array) -> Any:
        """The first point on the way from z to new where a y_i passes a bound, with i; None: there is none; "shorter": it
        cannot be told."""
        n, row_t = len(z) - 1, t * _measured(inside)
        y, there = z[:-1], new[:-1]
        crossed = []
        for i in range(n):
            for side in {self.low[i], self.high[i]}:
                if not np.isfinite(side):
                    continue
                outside = not inside[i]
                if outside and side != at[i]:
                    continue
                if (inside[i] and ((side == self.low[i] and there[i] < side) or (side == self.high[i] and there[i] > side))) or (
                    outside and ((side == self.low[i] and there[i] > side) or (side == self.high[i] and there[i] < side))
                ):
                    if outside and self.low[i] == self.high[i]:
                        continue  # fixed: both sides are outside
                    share = 0.0 if there[i] == y[i] else (side - y[i]) / (there[i] - y[i])
                    crossed.append((min(max(share, 0.0), 1.0), i, side))
        if not crossed:
            return None
        for share, i, side in sorted(crossed):
            row = np.zeros(n + 1)
            row[i] = 1
            met = self.correct(z + share * (new - z), inside, at, row, side)
            if met is None or not -1e-9 <= (met - z) @ row_t <= (new - z) @ row_t * (1 + 1e-9) + 1e-12:
                continue
            met[i] = side
            others = self.first_beyond(met, inside, at, i)
            if not others:
                return met, i, side
        return "shorter"

    def first_beyond(self, z: Array, inside: Array, at: Array, i: int) -> bool:
        """Whether another variable has passed a bound before."""
        y, slack = z[:-1], 1e-11 * (1 + np.abs(z[:-1]))
        past = np.where(
            inside,
            (y < self.low - slack) | (y > self.high + slack),
            (self.low < self.high) & np.where(at == self.low, y > self.low + slack, y < self.high - slack),
        )
        past[i] = False
        return bool(past.any())

    def behind(self, z: Array, i: int, inside: Array, at: Array, t: Array) -> tuple[Array, Array, Array, float]:
        """The piece behind the kink: y_i goes on as it went."""
        inside, at = inside.copy(), at.copy()
        if inside[i]:
            at[i] = z[i]
        inside[i] = not inside[i]
        went = t[i]
        new, sign = self.tangent(z, inside, at, t)
        if new[i] * went < 0:
            new = -new
            sign = -sign
        return inside, at, new, sign

    def between(self, z: Array, new: Array, inside: Array, at: Array, t: Array, t_new: Array, sign: float, sign_new: float) -> None:  # fmt: skip
        """Tells of a fold or a bifurcation on the way, each located by bisection along the chord."""
        if t[-1] * t_new[-1] < 0:
            self.locate("fold", z, new, inside, at, t, lambda tangent, s: tangent[-1] * t[-1] > 0)
        if sign * sign_new < 0:
            self.locate("bifurcation", z, new, inside, at, t, lambda tangent, s: s * sign > 0)

    def locate(self, kind: str, z: Array, new: Array, inside: Array, at: Array, t: Array, before: Any) -> None:
        t = t * _measured(inside)
        length = float(t @ (new - z))
        low, high, best = 0.0, length, new
        for _ in range(60):
            middle = 0.5 * (low + high)
            guess = z + (middle / length) * (new - z) if length else z
            met = self.correct(guess, inside, at, t, float(t @ z) + middle)
            if met is None:
                break
            best = met
            tangent, sign = self.tangent(met, inside, at, t)
            if before(tangent, sign):
                low = middle
            else:
                high = middle
            if high - low < 1e-14 * (1 + abs(length)):
                break
        self.record(best, inside, at, self.tangent(best, inside, at, t)[0])
        self.event(kind, best, inside, at)

    def record(self, z: Array, inside: Array, at: Array, t: Array) -> None:
        self.ps.append(float(z[-1]))
        self.xs.append(np.clip(self.point(z[:-1], inside, at), self.low, self.high))
        with np.errstate(all="ignore"):
            self.slopes.append(np.where(inside, t[:-1] / t[-1], 0.0))

    def event(self, kind: str, z: Array, inside: Array, at: Array, variable: int = -1, bound: str = "") -> None:
        self.events.append(TraceEvent(kind, float(z[-1]), self.xs[-1], variable, bound, len(self.ps) - 1))

    def curve(self, why: str) -> Curve:
        p, x = np.array(self.ps), np.array(self.xs)
        residual = np.array([natural(x[k], self.F(x[k], p[k]), self.low, self.high) for k in range(len(p))])
        good = not why and bool((residual <= self.tol).all())
        if not why:
            ends = self.events[-1].p
            why = f"{len(p)} points, to p = {ends:.6g}" if good else f"a point has a natural residual of {residual.max():.3g}"
        return Curve(p, x, residual, np.array(self.slopes), self.events, good, why, self.names)
