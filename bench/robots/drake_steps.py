# SPDX-License-Identifier: Apache-2.0
"""Contact problems out of Drake (PyPI: drake), and its answers with its four laws.

Contacts are points, and have a stiffness and a dissipation. `tamsi` has Coulomb's law with friction that begins with
slip, `sap` is convex with associated friction (Castro et al. 2022), and `lagged` (the default) and `similar` are convex
laws with less of the parting that association brings (Castro et al. 2023).
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from importlib.metadata import version

import numpy as np
from pydrake.all import (
    AddMultibodyPlantSceneGraph,
    ContactModel,
    Context,
    DiagramBuilder,
    DiscreteContactApproximation,
    JacobianWrtVariable,
    MultibodyPlant,
    Parser,
    PointPairContactInfo,
    SpatialVelocity,
)
from scenes import STEP, Scene
from step import Array, Point, Step, frame

LAWS = {
    "lagged": DiscreteContactApproximation.kLagged,
    "similar": DiscreteContactApproximation.kSimilar,
    "sap": DiscreteContactApproximation.kSap,
    "tamsi": DiscreteContactApproximation.kTamsi,
}


class _Simulation:
    """A scene with one law."""

    def __init__(self, scene: Scene, law: str) -> None:
        builder = DiagramBuilder()
        self.plant, _ = AddMultibodyPlantSceneGraph(builder, STEP)
        self.plant.set_discrete_contact_approximation(LAWS[law])
        self.plant.set_contact_model(ContactModel.kPoint)
        self.plant.SetUseSampledOutputPorts(False)  # outputs of the state as it is, not of the last step
        Parser(self.plant).AddModelsFromString(scene.mjcf, "xml")
        self.plant.Finalize()
        self.law = law
        self.diagram = builder.Build()
        self.root = self.diagram.CreateDefaultContext()
        self.context = self.plant.GetMyMutableContextFromRoot(self.root)

    def set_state(self, state: Array, torques: Array) -> None:
        self.plant.SetPositionsAndVelocities(self.context, state)
        self.plant.get_actuation_input_port().FixValue(self.context, torques)

    def contacts(self) -> list[PointPairContactInfo]:
        results = self.plant.get_contact_results_output_port().Eval(self.context)
        return [results.point_pair_contact_info(a) for a in range(results.num_point_pair_contacts())]

    def next_state(self) -> Array:
        state = self.diagram.EvalUniquePeriodicDiscreteUpdate(self.root).get_vector(0).CopyToVector()
        return state[: self.plant.num_multibody_states()]


def steps(scene: Scene) -> Iterator[Step]:
    """The steps to record. The simulation goes on with the default law."""
    simulations = [_Simulation(scene, law) for law in LAWS]
    plant, context = simulations[0].plant, simulations[0].context
    for body, velocity in scene.velocities.items():
        plant.SetFreeBodySpatialVelocity(context, plant.GetBodyByName(body), SpatialVelocity(np.zeros(3), velocity))
    state = plant.GetPositionsAndVelocities(context)
    due = scene.due()
    for k in itertools.count():
        plant.SetPositionsAndVelocities(context, state)
        torques = _torques(scene, plant, context, k * STEP)
        simulations[0].set_state(state, torques)
        if k >= due[0] and simulations[0].contacts():
            yield _step(scene, k * STEP, simulations, state, torques)
            if not (due := due[1:]):
                return
        state = simulations[0].next_state()


def _torques(scene: Scene, plant: MultibodyPlant, context: Context, time: float) -> Array:
    torques = np.zeros(plant.num_actuators())
    for motor in scene.motors:
        joint = plant.GetJointByName(motor.joint)
        angle, rate = joint.GetOnePosition(context), joint.GetOneVelocity(context)
        index = plant.GetJointActuatorByName(motor.joint).input_start()
        torques[index] = motor.stiffness * (motor.target(time) - angle) - motor.damping * rate
    return torques


def _step(scene: Scene, time: float, simulations: list[_Simulation], state: Array, torques: Array) -> Step:
    plant, context = simulations[0].plant, simulations[0].context
    contacts = simulations[0].contacts()
    frames = [frame(-contact.point_pair().nhat_BA_W) for contact in contacts]
    points = []
    for simulation in simulations:
        simulation.set_state(state, torques)
        try:
            forces = [contact.contact_force() for contact in simulation.contacts()]  # of the same contacts, in order
        except RuntimeError:  # its solver does not converge: this law has no answer
            continue
        r = np.concatenate([STEP * axes @ force for axes, force in zip(frames, forces, strict=True)])
        points.append(Point(simulation.law, simulation.next_state()[plant.num_positions() :], r))
    M = plant.CalcMassMatrix(context)
    tau = (
        plant.CalcGravityGeneralizedForces(context)
        - plant.CalcBiasTerm(context)
        + plant.MakeActuationMatrix() @ torques
    )
    H = np.column_stack([_columns(plant, context, contact, axes) for contact, axes in zip(contacts, frames)])
    f = M @ plant.GetVelocities(context) + STEP * tau
    mu = np.full(len(contacts), scene.mu)
    return Step(scene.name, f"Drake {version('drake')}", time, STEP, M, H, f, mu, points)


def _columns(plant: MultibodyPlant, context: Context, contact: PointPairContactInfo, axes: Array) -> Array:
    """The velocity of body B relative to body A at the point of contact, in the frame of the contact, by v."""
    world, point = plant.world_frame(), contact.contact_point()
    velocity = []
    for index in (contact.bodyA_index(), contact.bodyB_index()):
        own = plant.get_body(index).body_frame()
        at = plant.EvalBodyPoseInWorld(context, plant.get_body(index)).inverse() @ point
        velocity.append(plant.CalcJacobianTranslationalVelocity(context, JacobianWrtVariable.kV, own, at, world, world))
    return (axes @ (velocity[1] - velocity[0])).T
