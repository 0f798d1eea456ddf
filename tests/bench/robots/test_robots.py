# SPDX-License-Identifier: Apache-2.0
"""Steps of simulators as contact problems: bench/robots."""

from __future__ import annotations

import dataclasses
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

ROBOTS = Path(__file__).parents[3] / "bench" / "robots"
sys.path.insert(0, str(ROBOTS))

import step as steps  # noqa: E402
from scenes import Scene, scenes  # noqa: E402

G, H_STEP = 9.81, 0.002
MASS, HALF, MU = 2.0, (0.1, 0.2, 0.05), 0.5  # a box, and its half edges
# The textbook's moments of inertia of a cuboid, m (b^2 + c^2) / 3 by half edges.
INERTIA = (
    np.array(
        [
            MASS * (HALF[1] ** 2 + HALF[2] ** 2),
            MASS * (HALF[0] ** 2 + HALF[2] ** 2),
            MASS * (HALF[0] ** 2 + HALF[1] ** 2),
        ]
    )
    / 3
)
CORNERS = np.array([[x * HALF[0], y * HALF[1], -HALF[2]] for x in (-1, 1) for y in (-1, 1)])


def box_on_plane(velocity: tuple[float, float, float]) -> steps.Step:
    """A box that slides on the plane z = 0, touching by its lower corners: v is (velocity, spin), and with the arm c
    the velocity of a corner is velocity + spin x c. The frame is (z, x, y)."""
    columns = []
    for x, y, z in CORNERS:
        columns += [[0, 0, 1, y, -x, 0], [1, 0, 0, 0, z, -y], [0, 1, 0, -z, 0, x]]
    M = np.diag([MASS] * 3 + list(INERTIA))
    f = M @ np.array([*velocity, 0, 0, 0]) + H_STEP * np.array([0, 0, -MASS * G, 0, 0, 0])
    return steps.Step("box", "hand", 0.0, H_STEP, M, np.array(columns, float).T, f, np.full(4, MU), [])


def test_delassus_of_a_box_on_a_plane() -> None:
    """By hand: n' (1/m + arm' I^-1 arm) n at a corner, and the velocity of a body in free fall. Fails if H is taken for
    its transpose, if the mass matrix is not inverted, or if gravity lacks the step."""
    W, q = steps.delassus(box_on_plane((1, 0.5, 0)))
    x, y, z = CORNERS[0]
    I_x, I_y, I_z = INERTIA
    by_hand = [
        [1 / MASS + y * y / I_x + x * x / I_y, -x * z / I_y, -y * z / I_x],
        [-x * z / I_y, 1 / MASS + z * z / I_y + y * y / I_z, -x * y / I_z],
        [-y * z / I_x, -x * y / I_z, 1 / MASS + z * z / I_x + x * x / I_z],
    ]
    np.testing.assert_allclose(W[:3, :3], by_hand, rtol=1e-13)
    opposite = CORNERS[3]  # the normal impulse here lifts this corner less than its own
    assert W[9, 0] == pytest.approx(1 / MASS + y * opposite[1] / I_x + x * opposite[0] / I_y, rel=1e-12)
    np.testing.assert_allclose(q.reshape(4, 3), np.tile([-G * H_STEP, 1, 0.5], (4, 1)), rtol=1e-13)


def test_errors_of_known_answers() -> None:
    """A box at rest with a quarter of its weight at each corner has no error; what is changed then is the error, in its
    unit. Fails if a unit lacks the step or the mass, or if an error is told of the wrong part."""
    rest = box_on_plane((0, 0, 0))
    W, _ = steps.delassus(rest)
    quarter, still = MASS * G / 4, np.zeros(6)
    r = np.tile([quarter * H_STEP, 0, 0], 4)
    e = steps.errors(rest, W, r, still)
    assert max(map(np.max, (e.friction, e.normal, e.creep))) < 1e-15 and np.isnan(e.angle).all()
    np.testing.assert_allclose(e.force, quarter)

    parting = np.array([0, 0, 1e-4, 0, 0, 0])  # [m/s], upwards under pressure
    np.testing.assert_allclose(steps.errors(rest, W, r, parting).normal, 1e-4, rtol=1e-12)
    falling = steps.errors(rest, W, 0 * r, -parting)
    np.testing.assert_allclose(falling.normal, 1e-4, rtol=1e-12)

    creeping = np.array([1e-5, 0, 0, 0, 0, 0])  # with no friction at all: what is missing is what would stop it
    e = steps.errors(rest, W, r, creeping)
    m = 3 / np.trace(W[:3, :3])
    np.testing.assert_allclose(e.creep, 1e-5, rtol=1e-12)
    np.testing.assert_allclose(e.friction, m * 1e-5 / H_STEP, rtol=1e-12)

    sliding = np.array([1.0, 0, 0, 0, 0, 0])
    opposed = np.tile([quarter, -MU * quarter, 0], 4) * H_STEP
    e = steps.errors(rest, W, opposed, sliding)
    assert max(map(np.max, (e.friction, e.creep, e.angle))) < 1e-6
    askew = np.tile([quarter, -MU * quarter * np.cos(0.1), MU * quarter * np.sin(0.1)], 4) * H_STEP
    np.testing.assert_allclose(steps.errors(rest, W, askew, sliding).angle, np.degrees(0.1), rtol=1e-9)
    weak = np.tile([quarter, -0.4 * quarter, 0], 4) * H_STEP  # of 0.5 that Coulomb's law asks for
    np.testing.assert_allclose(steps.errors(rest, W, weak, sliding).friction, 0.1 * quarter, rtol=1e-9)


@pytest.mark.parametrize("normal", [(0, 0, 1), (0, 0, -1), (1, 0, 0), (0.6, -0.48, 0.64)])
def test_frames_are_orthonormal_and_right_handed(normal: tuple[float, float, float]) -> None:
    """Fails if a tangent is not of length one, or if axes are mirrored."""
    axes = steps.frame(np.array(normal, float))
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(axes) == pytest.approx(1)
    np.testing.assert_array_equal(axes[0], normal)


def test_scenes_are_ten_with_twenty_steps() -> None:
    assert len({scene.name for scene in scenes()}) == 10
    for scene in scenes():
        assert len(set(scene.due())) == 20 and scene.due()[0] >= 0


def test_perp_reads_the_file_and_stops_the_box(tmp_path: Path) -> None:
    """A box that slides at 1 m/s loses mu g h by Coulomb's law. Fails if the file is not what Perp reads, or if its
    columns and frames are others than those of the step."""
    pytest.importorskip("h5py", reason="h5py (PyPI) writes the files")
    sliding = box_on_plane((1, 0, 0))
    sliding.points = [steps.Point("none", np.zeros(6), np.zeros(12))]
    file = tmp_path / "box.hdf5"
    steps.write(sliding, file)
    again = steps.read(file)
    for field in dataclasses.fields(steps.Step):
        if field.name != "points":
            np.testing.assert_array_equal(getattr(again, field.name), getattr(sliding, field.name))
    command = [os.environ["PERP_PROGRAM"], "contact", str(file), "--json", "-", "--log-level", "quiet"]
    result = json.loads(subprocess.run(command, capture_output=True, text=True).stdout)
    assert result["status"] == "Solved"
    u = np.array([contact["u"] for contact in result["contacts"]])
    np.testing.assert_allclose(u, np.tile([0, 1 - MU * G * H_STEP, 0], (4, 1)), atol=1e-7)


def box_scene() -> Scene:
    """The same box without corner spheres, 0.1 mm in the plane."""
    size = " ".join(map(str, HALF))
    mjcf = (
        f'<mujoco model="box"><option timestep="{H_STEP}"/><default><geom friction="{MU} 0 0"/></default><worldbody>'
        '<geom name="ground" type="plane" size="5 5 0.1"/>'
        f'<body name="box" pos="0 0 {HALF[2] - 1e-4}"><freejoint/>'
        f'<geom name="box" type="box" size="{size}" mass="{MASS}"/></body></worldbody></mujoco>'
    )
    return Scene("box", "a box slides", mjcf, MU, 0.0, 0.1, {"box": (1.0, 0.0, 0.0)})


@pytest.mark.parametrize("engine", ["mujoco", "drake"])
def test_engines_step_is_the_one_by_hand(engine: str) -> None:
    """The first step of a sliding box: q is free fall at 1 m/s, W that of the points of contact by hand, and the
    engine's own answer balances momentum. Fails if a Jacobian, a frame, a force or a sign is taken wrongly out of the
    engine."""
    pytest.importorskip({"mujoco": "mujoco", "drake": "pydrake"}[engine], reason=f"{engine} (PyPI) simulates")
    module = __import__(f"{engine}_steps")
    first = next(module.steps(box_scene()))
    W, q = steps.delassus(first)
    k = len(first.mu)
    assert k == {"mujoco": 4, "drake": 1}[engine]  # Drake gives a box one point
    np.testing.assert_allclose(q.reshape(k, 3)[:, 0], -G * H_STEP, rtol=1e-9)  # [m/s]; the free box turns nowhere
    np.testing.assert_allclose(np.linalg.norm(q.reshape(k, 3)[:, 1:], axis=1), 1, rtol=1e-9)
    arms = CORNERS if engine == "mujoco" else np.array([[0, 0, -HALF[2]]])
    by_hand = np.sort([1 / MASS + y * y / INERTIA[0] + x * x / INERTIA[1] for x, y, _ in arms])
    np.testing.assert_allclose(np.sort(np.diag(W)[::3]), by_hand, rtol=1e-3)
    for point in first.points:
        assert steps.imbalance(first, point) < 1e-5, point.law
        assert point.r.reshape(k, 3)[:, 0].min() > 0, point.law  # it pushes
        slip = (first.H.T @ point.v).reshape(k, 3)[:, 1:]
        assert np.sum(point.r.reshape(k, 3)[:, 1:] * slip) < 0, point.law  # friction brakes
