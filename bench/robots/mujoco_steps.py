# SPDX-License-Identifier: Apache-2.0
"""Contact problems out of MuJoCo (PyPI: mujoco), and its answers with both of its cones.

MuJoCo minimizes a convex function (Todorov 2014): friction is associated, so a contact that slips also parts, and
constraints are soft, with the velocity that they aim at made from the depth of penetration. `pyramidal`, its default,
has four facets.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import mujoco
import numpy as np
from scenes import STEP, Scene
from step import Array, Point, Step

LAWS = {"pyramidal": mujoco.mjtCone.mjCONE_PYRAMIDAL, "elliptic": mujoco.mjtCone.mjCONE_ELLIPTIC}


def steps(scene: Scene) -> Iterator[Step]:
    """The steps to record. The simulation goes on with the default law."""
    model = mujoco.MjModel.from_xml_string(scene.mjcf)
    data = mujoco.MjData(model)
    for body, velocity in scene.velocities.items():
        first = model.body(body).dofadr[0]
        data.qvel[first : first + 3] = velocity
    due = scene.due()
    for k in itertools.count():
        for motor in scene.motors:
            joint = data.joint(motor.joint)
            data.actuator(motor.joint).ctrl = (
                motor.stiffness * (motor.target(data.time) - joint.qpos[0]) - motor.damping * joint.qvel[0]
            )
        mujoco.mj_forward(model, data)
        if k >= due[0] and data.ncon > 0:
            points = [_answer(model, data, law) for law in reversed(LAWS)]  # the default is the last to be set
            yield _step(scene, model, data, points[::-1])
            if not (due := due[1:]):
                return
        mujoco.mj_step(model, data)


def _answer(model: mujoco.MjModel, data: mujoco.MjData, law: str) -> Point:
    model.opt.cone = LAWS[law]
    mujoco.mj_forward(model, data)
    r, force = np.zeros((data.ncon, 3)), np.zeros(6)
    for a in range(data.ncon):
        mujoco.mj_contactForce(model, data, a, force)
        r[a] = STEP * force[:3]
    return Point(law, data.qvel + STEP * data.qacc, r.ravel())


def _step(scene: Scene, model: mujoco.MjModel, data: mujoco.MjData, points: list[Point]) -> Step:
    M = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, M)
    contacts = [data.contact[a] for a in range(data.ncon)]
    H = np.column_stack([_columns(model, data, contact) for contact in contacts])
    f = M @ data.qvel + STEP * data.qfrc_smooth
    mu = np.full(len(contacts), scene.mu)
    return Step(scene.name, f"MuJoCo {mujoco.__version__}", data.time, STEP, M, H, f, mu, points)


def _columns(model: mujoco.MjModel, data: mujoco.MjData, contact: mujoco.MjContact) -> Array:
    """The velocity of the second geom's body relative to the first one's, in the frame of the contact, by v."""
    first, second = np.zeros((3, model.nv)), np.zeros((3, model.nv))
    mujoco.mj_jac(model, data, first, None, contact.pos, model.geom_bodyid[contact.geom[0]])
    mujoco.mj_jac(model, data, second, None, contact.pos, model.geom_bodyid[contact.geom[1]])
    return (contact.frame.reshape(3, 3) @ (second - first)).T
