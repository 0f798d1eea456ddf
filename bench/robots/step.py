# SPDX-License-Identifier: Apache-2.0
"""A step of a simulation as a contact problem, its FCLIB file, and what Coulomb's law says of the engine's own answer.

With generalized velocities v before the step, forces tau without contacts, and the step h,

    M v+ = H r + f,   f = M v + h tau,   u = H' v+ + w,   w = 0

where column block a of H is (N, T1, T2) of contact a: u_a is the velocity of the second body relative to the first at
the point of contact, and r_a the impulse on the second body. N points from the first body to the second. The law is
that of velocities without rebound: bodies that touch do not approach, and have no force once they part.
"""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclasses.dataclass
class Point:
    """What a law answers."""

    law: str
    v: Array  # v+ (m)
    r: Array  # impulses (3 k) [N s]


@dataclasses.dataclass
class Step:
    scene: str
    engine: str
    time: float
    h: float
    M: Array  # (m, m)
    H: Array  # (m, 3 k)
    f: Array  # (m)
    mu: Array  # (k)
    points: list[Point]

    @property
    def name(self) -> str:
        return f"{self.scene}-{self.engine.split()[0].lower()}-{round(self.time / self.h):04d}"


def delassus(step: Step) -> tuple[Array, Array]:
    """W = H' M^-1 H and q = H' M^-1 f."""
    solved = np.linalg.solve(step.M, np.column_stack([step.H, step.f]))
    return step.H.T @ solved[:, :-1], step.H.T @ solved[:, -1]


def frame(normal: Array) -> Array:
    """Rows N, T1, T2: orthonormal, and right-handed."""
    first = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    first /= np.linalg.norm(first)
    return np.vstack([normal, first, np.cross(normal, first)])


@dataclasses.dataclass
class Errors:
    """Of one answer, contact by contact, with force f = r / h [N] and m = 1 / mean(diag W_aa) [kg]. Each is zero where
    the law holds, and all but the angle need no threshold to say who slips:

    friction [N]    |f_T - P(f_T - m u_T / h)|, P onto the disc of radius mu f_N+: the force that is missing, too much,
                    or astray. Where a contact that should stick creeps it is the force that would stop it.
    normal [m/s]    |min(u_N, h f_N / m)|: the speed of approach, or of parting under pressure; a pull counts as the
                    speed that it makes
    creep [m/s]     min(|u_T|, h (mu f_N - |f_T|)+ / m): the speed of a contact whose friction is not used up
    angle [degrees] between f_T and -u_T, where |u_T| > 1 mm/s, mu f_N > 1 mN and |f_T| > mu f_N / 2; else NaN
    force [N]       |f|, to compare with
    """

    friction: Array
    normal: Array
    creep: Array
    angle: Array
    force: Array


def errors(step: Step, W: Array, r: Array, v: Array) -> Errors:
    u, f = (step.H.T @ v).reshape(-1, 3), r.reshape(-1, 3) / step.h
    m = 1 / np.diag(W).reshape(-1, 3).mean(axis=1)
    f_T, u_T = f[:, 1:], u[:, 1:]
    bound = step.mu * np.maximum(f[:, 0], 0)
    friction, slip = np.linalg.norm(f_T, axis=1), np.linalg.norm(u_T, axis=1)
    trial = f_T - (m / step.h)[:, None] * u_T
    length = np.linalg.norm(trial, axis=1)
    projected = trial * np.minimum(1, bound / np.maximum(length, 1e-300))[:, None]
    across = f_T[:, 0] * u_T[:, 1] - f_T[:, 1] * u_T[:, 0]
    slips = (slip > 1e-3) & (friction > bound / 2) & (bound > 1e-3)
    return Errors(
        friction=np.linalg.norm(f_T - projected, axis=1),
        normal=np.abs(np.minimum(u[:, 0], step.h * f[:, 0] / m)),
        creep=np.minimum(slip, step.h * np.maximum(bound - friction, 0) / m),
        angle=np.where(slips, np.degrees(np.arctan2(np.abs(across), -np.sum(f_T * u_T, axis=1))), np.nan),
        force=np.linalg.norm(f, axis=1),
    )


def imbalance(step: Step, point: Point) -> float:
    """How far the engine's answer is from M v+ = H r + f, of the largest term: so far the record may be wrong."""
    momentum, impulses = step.M @ point.v, step.H @ point.r
    terms = max(np.abs(momentum).max(), np.abs(impulses).max(), np.abs(step.f).max())
    return float(np.abs(momentum - impulses - step.f).max() / terms)


# --- FCLIB -----------------------------------------------------------------------------------------------------------


def write(step: Step, path: Path) -> None:
    """The problem in FCLIB's global form, and the engine's answers as guesses."""
    import h5py  # from PyPI; only files need it

    def matrix(name: str, A: Array) -> None:
        column, row = np.nonzero(A.T)
        starts = np.searchsorted(column, np.arange(A.shape[1] + 1))
        integers = {
            "m": A.shape[0],
            "n": A.shape[1],
            "nzmax": len(row),
            "nz": -1,
            "p": starts,
            "i": row,
        }  # -1: by columns
        for key, value in integers.items():
            file[f"fclib_global/{name}/{key}"] = np.atleast_1d(value).astype(np.int32)
        file[f"fclib_global/{name}/x"] = A[row, column]

    record = {"step": step.h, "time": step.time, "scene": step.scene, "engine": step.engine}
    with h5py.File(path, "w", libver="earliest") as file:
        file["fclib_global/spacedim"] = np.array([3], dtype=np.int32)
        matrix("M", step.M)
        matrix("H", step.H)
        for key, value in {"f": step.f, "w": np.zeros(len(step.mu) * 3), "mu": step.mu}.items():
            file[f"fclib_global/vectors/{key}"] = value
        file["fclib_global/info/title"] = np.bytes_(step.name)
        file["fclib_global/info/description"] = np.bytes_(json.dumps(record))
        file["fclib_global/info/math_info"] = np.bytes_(json.dumps({"guesses": [p.law for p in step.points]}))
        file["guesses/number_of_guesses"] = np.array([len(step.points)], dtype=np.int32)
        for k, point in enumerate(step.points, start=1):
            for key, value in {"v": point.v, "u": step.H.T @ point.v, "r": point.r}.items():
                file[f"guesses/{k}/{key}"] = value


def read(path: Path) -> Step:
    """What `write` has written."""
    import h5py

    with h5py.File(path) as file:
        problem = file["fclib_global"]

        def matrix(name: str) -> Array:
            stored = {key: problem[name][key][()] for key in "mnpix"}
            A = np.zeros((stored["m"][0], stored["n"][0]))
            A[stored["i"], np.repeat(np.arange(A.shape[1]), np.diff(stored["p"]))] = stored["x"]
            return A

        record = json.loads(problem["info/description"][()])
        laws = json.loads(problem["info/math_info"][()])["guesses"]
        return Step(
            scene=record["scene"],
            engine=record["engine"],
            time=record["time"],
            h=record["step"],
            M=matrix("M"),
            H=matrix("H"),
            f=problem["vectors/f"][()],
            mu=problem["vectors/mu"][()],
            points=[
                Point(law, file[f"guesses/{k}/v"][()], file[f"guesses/{k}/r"][()]) for k, law in enumerate(laws, 1)
            ],
        )
