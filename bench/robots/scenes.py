# SPDX-License-Identifier: Apache-2.0
"""Ten scenes as MJCF, which MuJoCo and Drake both read: lengths in m, masses in kg, angles in rad, z up.

All geoms of a scene have one coefficient of friction, because the engines combine two coefficients differently. A box
touches by a sphere at each corner, and is itself a little smaller: Drake gives two boxes one point of contact, which
is no support.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import NamedTuple


class Motor(NamedTuple):
    """A motor at a joint, with the torque stiffness (target(t) - angle) - damping rate."""

    joint: str
    target: Callable[[float], float]
    stiffness: float
    damping: float


class Scene(NamedTuple):
    name: str
    what: str
    mjcf: str
    mu: float
    begin: float  # [s], of the steps that are recorded
    end: float
    velocities: dict[str, tuple[float, float, float]] = {}  # of free bodies at the start [m/s]
    motors: tuple[Motor, ...] = ()

    def due(self) -> list[int]:
        """The steps to record: if one has no contact, the next one that has."""
        return [round((self.begin + (self.end - self.begin) * k / (STEPS - 1)) / STEP) for k in range(STEPS)]


STEPS = 20  # that are recorded
STEP = 0.002  # [s]
GROUND = '<geom name="ground" type="plane" size="5 5 0.1"/>'


def _numbers(*values: float) -> str:
    return " ".join(f"{value:.6g}" for value in values)


def _mjcf(world: str, mu: float, motors: tuple[Motor, ...] = ()) -> str:
    actuators = "".join(f'<motor name="{m.joint}" joint="{m.joint}" gear="1"/>' for m in motors)
    return (
        f'<mujoco model="scene"><compiler angle="radian"/><option timestep="{STEP}"/>'
        f'<default><geom friction="{mu} 0 0" condim="3"/></default>'
        f"<worldbody>{world}</worldbody><actuator>{actuators}</actuator></mujoco>"
    )


def _body(
    name: str, at: tuple[float, ...], inside: str, free: bool = True, euler: tuple[float, ...] = (0, 0, 0)
) -> str:
    joint = "<freejoint/>" if free else ""
    return f'<body name="{name}" pos="{_numbers(*at)}" euler="{_numbers(*euler)}">{joint}{inside}</body>'


def _box(name: str, half: tuple[float, float, float], mass: float, radius: float = 0.004) -> str:
    """A box with its corner spheres."""
    smaller = _numbers(*(h - 0.001 for h in half))
    geoms = f'<geom name="{name}" type="box" size="{smaller}" mass="{mass}"/>'
    for k, signs in enumerate(itertools.product((-1, 1), repeat=3)):
        at = _numbers(*(s * (h - radius) for s, h in zip(signs, half)))
        geoms += f'<geom name="{name}.{k}" type="sphere" size="{radius}" pos="{at}" mass="0.0001"/>'
    return geoms


def _ball(name: str, radius: float, mass: float, at: tuple[float, ...] = (0, 0, 0)) -> str:
    return f'<geom name="{name}" type="sphere" size="{radius}" pos="{_numbers(*at)}" mass="{mass}"/>'


def _capsule(name: str, begin: tuple[float, ...], end: tuple[float, ...], radius: float, mass: float) -> str:
    return f'<geom name="{name}" type="capsule" fromto="{_numbers(*begin, *end)}" size="{radius}" mass="{mass}"/>'


def _hinge(name: str, axis: str) -> str:
    return f'<joint name="{name}" type="hinge" axis="{axis}"/>'


def _bin(half: float, height: float) -> str:
    """Four walls on the ground around the origin."""
    walls = ""
    for k, (x, y) in enumerate(((1, 0), (-1, 0), (0, 1), (0, -1))):
        size = _numbers(half + 0.1 if x == 0 else 0.05, half + 0.1 if y == 0 else 0.05, height)
        at = _numbers(x * (half + 0.05), y * (half + 0.05), height)
        walls += f'<geom name="bin.{k}" type="box" size="{size}" pos="{at}"/>'
    return walls


def _stack() -> Scene:
    world, z = GROUND, 0.0
    for k in range(6):
        half = 0.1 - 0.012 * k
        world += _body(
            f"box{k}", (0.003 * k, -0.002 * k, z + half), _box(f"box{k}", (half,) * 3, 8 * half), euler=(0, 0, 0.2 * k)
        )
        z += 2 * half - 0.001
    return Scene("stack", "six boxes on each other", _mjcf(world, 0.6), 0.6, 0.01, 0.4)


def _wall() -> Scene:
    world, half = GROUND, (0.1, 0.05, 0.05)
    for row in range(4):
        for k in range(4 - row % 2):
            at = (0.205 * k + 0.1025 * (row % 2), 0, half[2] + row * 0.1)
            world += _body(f"brick{row}{k}", at, _box(f"brick{row}{k}", half, 1))
    world += _body("ball", (0.31, -0.3, 0.25), _ball("ball", 0.08, 3))
    return Scene("wall", "14 bricks, hit by a ball", _mjcf(world, 0.5), 0.5, 0.04, 0.4, {"ball": (0, 4, 0)})


def _slope() -> Scene:
    angle = math.radians(20)
    world = f'<geom name="slope" type="plane" size="5 5 0.1" euler="0 {angle:.9g} 0"/>'
    velocities = {}
    for k in range(6):
        half = (0.08, 0.06, 0.04)
        at = (half[2] * math.sin(angle), 0.25 * k, half[2] * math.cos(angle))
        world += _body(f"block{k}", at, _box(f"block{k}", half, 1 + 0.5 * k), euler=(0, angle, 0))
        down, across = (0.5 - 0.4 * k), 0.3 * (k % 3)
        velocities[f"block{k}"] = (down * math.cos(angle), across, -down * math.sin(angle))
    return Scene(
        "slope", "six blocks thrown along a slope of 20 degrees", _mjcf(world, 0.4), 0.4, 0.01, 0.5, velocities
    )


def _hand() -> Scene:
    motors = [Motor("lift", lambda t: 0.1 * max(t - 0.3, 0), 4000, 120)]
    fingers = ""
    for k, (x, y) in enumerate(((-1, -0.02), (-1, 0.02), (1, 0))):
        axis = f"0 {x} 0"
        tip = _capsule(f"tip{k}", (0, 0, 0), (0, 0, -0.06), 0.01, 0.15)
        outer = _body(f"outer{k}", (0, 0, -0.06), _hinge(f"bend{k}", axis) + tip, free=False)
        bone = _capsule(f"bone{k}", (0, 0, 0), (0, 0, -0.045), 0.01, 0.15)
        fingers += _body(f"finger{k}", (x * 0.058, y, -0.02), _hinge(f"close{k}", axis) + bone + outer, free=False)
        grip = 1.0 if x < 0 else 2.0
        motors += [
            Motor(f"close{k}", lambda t: 0.15, 3 * grip, 0.03 * grip),
            Motor(f"bend{k}", lambda t: 0.1, grip, 0.006 * grip),
        ]
    palm = (
        '<joint name="lift" type="slide" axis="0 0 1"/><geom name="palm" type="box" size="0.07 0.04 0.015" mass="0.5"/>'
    )
    world = GROUND + _body("cube", (0, 0, 0.04), _box("cube", (0.04,) * 3, 0.3))
    world += _body("hand", (0, 0, 0.19), palm + fingers, free=False)
    return Scene(
        "hand",
        "three fingers close on a cube and lift it",
        _mjcf(world, 0.8, tuple(motors)),
        0.8,
        0.05,
        1.5,
        motors=tuple(motors),
    )


def _humanoid(name: str, what: str, stiffness: float, end: float) -> Scene:
    motors = []

    def joint(joint_name: str, axis: str, strength: float, target: float = 0.0) -> str:
        motors.append(Motor(joint_name, lambda t: target, stiffness * strength, 0.02 * max(stiffness, 50) * strength))
        return _hinge(joint_name, axis)

    parts = _capsule("torso", (0, 0, 0), (0, 0, 0.35), 0.1, 25) + _ball("head", 0.1, 5, (0, 0, 0.6))
    for side, y in (("left", 1), ("right", -1)):
        foot = joint(f"{side}_ankle", "0 1 0", 0.5, -0.1)
        corners = itertools.product((-0.06, 0.14), (-0.04, 0.04))
        foot += "".join(_ball(f"{side}_foot{k}", 0.02, 0.3, (*at, -0.05)) for k, at in enumerate(corners))
        shin = joint(f"{side}_knee", "0 1 0", 1.5, 0.2) + _capsule(
            f"{side}_shin", (0, 0, -0.06), (0, 0, -0.32), 0.05, 3.5
        )
        shin += _body(f"{side}_foot", (0, 0, -0.4), foot, free=False)
        hip = joint(f"{side}_hip_x", "1 0 0", 1.5) + joint(f"{side}_hip_y", "0 1 0", 1.5, -0.1)
        thigh = hip + _capsule(f"{side}_thigh", (0, 0, -0.08), (0, 0, -0.32), 0.06, 7)
        thigh += _body(f"{side}_shin", (0, 0, -0.4), shin, free=False)
        parts += _body(f"{side}_thigh", (0, y * 0.11, -0.1), thigh, free=False)
        lower = joint(f"{side}_elbow", "0 1 0", 0.2) + _capsule(
            f"{side}_forearm", (0, 0, -0.06), (0, 0, -0.24), 0.035, 1.2
        )
        arm = joint(f"{side}_shoulder_x", "1 0 0", 0.3) + joint(f"{side}_shoulder_y", "0 1 0", 0.3)
        arm += _capsule(f"{side}_arm", (0, 0, -0.04), (0, 0, -0.22), 0.04, 2)
        arm += _body(f"{side}_forearm", (0, 0, -0.28), lower, free=False)
        parts += _body(f"{side}_arm", (0, y * 0.2, 0.38), arm, free=False)
    world = GROUND + _body("humanoid", (0, 0, 0.972), parts)
    return Scene(name, what, _mjcf(world, 0.7, tuple(motors)), 0.7, 0.02, end, motors=tuple(motors))


def _grains() -> Scene:
    world = GROUND + _bin(0.11, 0.2)
    for k, (i, j, level) in enumerate(itertools.product(range(3), range(3), range(7))):
        radius = 0.026 + 0.002 * (5 * k % 4)
        at = (0.07 * (i - 1) + 0.004 * (k % 3 - 1), 0.07 * (j - 1) + 0.003 * (k % 5 - 2), 0.035 + 0.066 * level)
        world += _body(f"grain{k}", at, _ball(f"grain{k}", radius, 4000 * radius**3))
    return Scene("grains", "63 balls dropped into a bin", _mjcf(world, 0.5), 0.5, 0.1, 0.9)


def _rods() -> Scene:
    world = GROUND + _bin(0.16, 0.2)
    for k in range(24):
        along = (0.07, 0, 0) if k // 3 % 2 else (0, 0.07, 0)
        begin, offset = tuple(-x for x in along), 0.08 * (k % 3 - 1)
        at = (
            (0.01 * (k % 4 - 1.5), offset, 0.03 + 0.055 * (k // 3))
            if k // 3 % 2
            else (offset, 0.01 * (k % 4 - 1.5), 0.03 + 0.055 * (k // 3))
        )
        world += _body(f"rod{k}", at, _capsule(f"rod{k}", begin, along, 0.025, 0.4))
    return Scene("rods", "24 rods dropped into a bin", _mjcf(world, 0.4), 0.4, 0.06, 0.9)


def _quadruped() -> Scene:
    motors, legs = [], ""
    for x, y in itertools.product((1, -1), repeat=2):
        leg, phase = f"{'front' if x > 0 else 'hind'}_{'left' if y > 0 else 'right'}", 0.0 if x * y > 0 else math.pi
        swing = lambda t, phase=phase: min(5 * t, 1) * (0.6 + 0.25 * math.sin(12 * t + phase))  # noqa: E731
        bend = lambda t, phase=phase: -min(5 * t, 1) * (1.2 + 0.4 * max(math.cos(12 * t + phase), 0))  # noqa: E731
        motors += [Motor(f"{leg}_hip", swing, 60, 0.8), Motor(f"{leg}_knee", bend, 60, 0.8)]
        shin = _hinge(f"{leg}_knee", "0 1 0") + _capsule(f"{leg}_shin", (0, 0, -0.03), (0, 0, -0.17), 0.015, 0.3)
        shin += _ball(f"{leg}_foot", 0.022, 0.1, (0, 0, -0.2))
        thigh = _hinge(f"{leg}_hip", "0 1 0") + _capsule(f"{leg}_thigh", (0, 0, -0.04), (0, 0, -0.16), 0.02, 0.8)
        thigh += _body(f"{leg}_shin", (0, 0, -0.2), shin, free=False)
        legs += _body(f"{leg}_thigh", (x * 0.2, y * 0.12, 0), thigh, free=False)
    trunk = '<geom name="trunk" type="box" size="0.22 0.08 0.05" mass="8"/>'
    world = GROUND + _body("quadruped", (0, 0, 0.43), trunk + legs)
    return Scene(
        "quadruped",
        "a robot on four legs trots",
        _mjcf(world, 0.8, tuple(motors)),
        0.8,
        0.05,
        1.2,
        motors=tuple(motors),
    )


def _dominoes() -> Scene:
    world = GROUND
    for k in range(8):
        world += _body(f"domino{k}", (0.07 * k, 0, 0.08), _box(f"domino{k}", (0.012, 0.04, 0.08), 0.2))
    return Scene(
        "dominoes", "eight dominoes, the first one pushed", _mjcf(world, 0.4), 0.4, 0.02, 0.7, {"domino0": (0.9, 0, 0)}
    )


def scenes() -> list[Scene]:
    return [
        _stack(),
        _wall(),
        _slope(),
        _dominoes(),
        _hand(),
        _humanoid("standing", "a humanoid holds itself upright", 250, 0.6),
        _humanoid("falling", "a humanoid without strength falls", 0, 1.0),
        _quadruped(),
        _grains(),
        _rods(),
    ]
