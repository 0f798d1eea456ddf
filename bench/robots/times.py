#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Milliseconds that the engines and Perp take for the contacts of a step, beside the errors of their laws.

    times.py [SCENE ...]

MuJoCo: `mj_fwdConstraint`, the solver alone, with its elliptic cone, cold (warm starts off) and from the forces that
the same step has just got, which is the best that a warm start can be. Drake, whose solver cannot be called by itself:
the whole step with the law `lagged`, geometry and dynamics included. Perp: `perp.contact`, W and q as given, cold and
from the impulses that it has just got. Least of five of the processor's times of this thread. Needs mujoco and drake
from PyPI, and perp. A table as Markdown, by the number of contacts.
"""

from __future__ import annotations

import sys
import time
from collections import defaultdict
from collections.abc import Callable

import drake_steps
import mujoco
import mujoco_steps
import numpy as np
import perp
from scenes import scenes
from step import Array, Step, delassus, errors

SIZES = ((1, 15, "up to 15"), (16, 59, "16 to 59"), (60, 10**9, "60 and more"))


def least(work: Callable[[], object], before: Callable[[], object] = lambda: None) -> float:
    """Milliseconds."""
    spent = []
    for _ in range(5):
        before()
        begin = time.thread_time_ns()
        work()
        spent.append(time.thread_time_ns() - begin)
    return min(spent) / 1e6


class Table:
    """Times, and the largest errors at any contact of a step, of (who, size)."""

    def __init__(self) -> None:
        self.rows: dict[tuple[str, str], list[tuple[float, float, float]]] = defaultdict(list)

    def add(self, who: str, step: Step, milliseconds: float, W: Array, r: Array, v: Array) -> None:
        size = next(name for low, high, name in SIZES if low <= len(step.mu) <= high)
        wrong = errors(step, W, r, v)
        self.rows[who, size].append((milliseconds, wrong.friction.max() / wrong.force.max(), wrong.normal.max()))

    def add_perp(self, step: Step, W: Array, q: Array) -> None:
        problem = perp.contact.problem(W, q, step.mu)
        cold = problem.solve()
        if not cold.success:
            print(f"{step.name}: {cold.message}", file=sys.stderr)
        v = np.linalg.solve(step.M, step.H @ cold.r + step.f)
        self.add("Perp, cold", step, least(problem.solve), W, cold.r, v)
        self.add("Perp, from its solution", step, least(lambda: problem.solve(r0=cold.r)), W, cold.r, v)

    def __str__(self) -> str:
        lines = [
            "| | contacts | steps | median ms | largest ms | friction, of the largest force | normal [m/s] |",
            "|---|---|---|---|---|---|---|",
        ]
        for (who, size), rows in sorted(self.rows.items()):
            ms, friction, normal = np.array(rows).T
            lines.append(
                f"| {who} | {size} | {len(rows)} | {np.median(ms):.3f} | {ms.max():.3f} "
                f"| {np.median(friction):.1e} | {np.median(normal):.1e} |"
            )
        return "\n".join(lines)


def time_mujoco(model: mujoco.MjModel, data: mujoco.MjData) -> dict[str, float]:
    """Returns the step that `data` is in, with the cone of `model`."""

    def prepare() -> None:
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        mujoco.mj_fwdActuation(model, data)
        mujoco.mj_fwdAcceleration(model, data)

    def solve() -> None:
        mujoco.mj_fwdConstraint(model, data)

    off = int(mujoco.mjtDisableBit.mjDSBL_WARMSTART)
    model.opt.disableflags |= off
    cold = least(solve, prepare)
    model.opt.disableflags &= ~off
    data.qacc_warmstart[:] = data.qacc
    return {"cold": cold, "from its solution": least(solve, prepare)}


def main(words: list[str]) -> None:
    table = Table()
    engine_time: dict[str, float] = {}
    answer_of_mujoco = mujoco_steps._answer

    def answer(model: mujoco.MjModel, data: mujoco.MjData, law: str):  # as mujoco_steps asks each law
        point = answer_of_mujoco(model, data, law)
        if law == "elliptic":
            kept = data.qacc_warmstart.copy()
            engine_time.update(time_mujoco(model, data))
            data.qacc_warmstart[:] = kept
        return point

    mujoco_steps._answer = answer
    next_state_of_drake = drake_steps._Simulation.next_state

    def next_state(simulation):
        state = next_state_of_drake(simulation)
        if simulation.law == "lagged":
            context = simulation.context
            now = simulation.plant.GetPositionsAndVelocities(context)
            engine_time["step"] = least(
                lambda: next_state_of_drake(simulation),
                lambda: simulation.plant.SetPositionsAndVelocities(context, now),  # nothing is cached any more
            )
        return state

    drake_steps._Simulation.next_state = next_state
    for scene in scenes():
        if words and scene.name not in words:
            continue
        for step in mujoco_steps.steps(scene):
            W, q = delassus(step)
            point = next(p for p in step.points if p.law == "elliptic")
            for how, milliseconds in engine_time.items():
                table.add(f"MuJoCo, elliptic, {how}", step, milliseconds, W, point.r, point.v)
            table.add_perp(step, W, q)
        engine_time.clear()
        for step in drake_steps.steps(scene):
            W, q = delassus(step)
            for point in (p for p in step.points if p.law == "lagged"):
                table.add("Drake, lagged, whole step", step, engine_time["step"], W, point.r, point.v)
            table.add_perp(step, W, q)
        engine_time.clear()
    print(table)


if __name__ == "__main__":
    main(sys.argv[1:])
