"""Displacements of the tool, and forces in joints and legs, under the loads of the robot file.

Input: postures of a mechanism with loads, and any model. Output: twists of the loaded point (p
postures × l loads × 6, m and rad, base axes); for each posture and load the wrench that each joint
transmits, and the forces and moments along each leg. Rule: weight and inertia act on the masses of
the model. If the model has no mass, weight and inertia act on the following masses: those of beams
for legs with a section, those of the robot file for legs specified by their 6×6 compliance, and
those of the part for CAD parts. If a body is rigid in the model, the loads on its mass act as a
statically equivalent wrench. Forces follow from equilibrium of each body.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fem.beams.stepped import SteppedLeg
from fem.reduction.superelement import held_leg, static_superelement
from lumped.arrays import Array, dense
from lumped.errors import ComputationError
from lumped.legs import GivenLeg, Leg, SectionedLeg
from lumped.mechanism.body_model import BodyModel, LegMatrices
from lumped.mechanism.kinematics.accelerations import accelerations
from lumped.mechanism.load import InterfaceLoads, Load, Loading
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.model_choices import Theory
from lumped.models import serial_chains
from lumped.models.bodies import legs_of
from lumped.system.assembly import Assembly, assembly
from lumped.system.loads import loading, tool_displacements
from lumped.system.members import MemberForces, member_forces
from lumped.system.reactions import Reaction, internal_forces, reaction
from lumped.system.solution import Solved, solved
from validation.models.leg_models import condensed_leg, leg_matrices
from validation.models.loads.leg_masses import MASSES, Masses, ends_mass
from validation.models.loads.pressures import unit_pressures
from validation.models.loads.solid_lines import solid_line_wrenches
from validation.models.options import DEFAULT_OPTIONS, STATIC, ModelName, ModelOptions
from validation.models.reduced_parts import condensed
from validation.models.robot_bodies import (
    bodies_of,
    springs_of,
    static_assembly,
    static_bodies,
)


@dataclass(frozen=True, eq=False)
class BodyEnds:
    """Forces and displacements at the k interfaces of a deformable body, in body axes.

    `wrenches` (6k, N and N m) are those that joints, and loads at points, exert on the body.
    `twists` (6k, in m and rad) are displacements and rotations.
    """

    wrenches: Array
    twists: Array


@dataclass(frozen=True, eq=False)
class LoadForces:
    """Wrenches of all joints, and forces along all legs, under one load in one posture.

    Joints and legs are in the order of the robot file. `ends`: wrenches and twists at the
    interfaces of each deformable body, by its name.
    """

    reactions: tuple[Reaction, ...]
    members: tuple[MemberForces, ...]
    ends: Mapping[str, BodyEnds]


def displacements(
    model: ModelName, postures: Sequence[Posture], options: ModelOptions = DEFAULT_OPTIONS
) -> Array:
    """Displacements (p×l×6, m and rad, base axes) of the loaded point under each load.

    NaN if the mechanism cannot move as a load requires. Raises the exceptions of `answers`
    (`validation.models.robot_models`). Shapes: p postures, l loads.
    """
    mechanism = postures[0].mechanism
    if not mechanism.loads:
        return np.zeros((len(postures), 0, 6))
    bodies = interface_loads_of(model, mechanism, options)
    if model == "vjm":
        springs = springs_of(mechanism, options)
        return displacements_by(by_chains(springs), postures, bodies, options.theory)
    prepared = static_assembly(model, postures, options)
    return displacements_by(_assembled(prepared), postures, bodies, options.theory)


def displacements_of(bodies: Mapping[str, BodyModel], postures: Sequence[Posture]) -> Array:
    """Displacements of the tool (p postures × l loads × 6, m and rad) with given body models.

    `bodies`: model of each body by name. Loads act on the masses and faces of these models.
    """
    mechanism = postures[0].mechanism
    masses = {name: interface_mass(body) for name, body in bodies.items()}
    interface_loads = InterfaceLoads(masses, unit_pressures(mechanism, bodies))
    return displacements_by(_assembled(assembly(mechanism, bodies)), postures, interface_loads)


def _assembled(prepared: Assembly) -> Callable[[Posture, list[Loading]], Array]:
    return lambda posture, loads: tool_displacements(solved(prepared.at(posture)), loads)


def by_chains(springs: Mapping[str, Array]) -> Callable[[Posture, list[Loading]], Array]:
    """Function of a posture and its l loadings that returns displacements of the tool (l×6).

    They are computed by the virtual joint method along serial chains. `springs`: tip compliance
    (6×6, SI, body axes) of each leg, by body name.
    """
    return lambda posture, loads: serial_chains.tool_displacements(posture, springs, loads)


def displacements_by(
    solve: Callable[[Posture, list[Loading]], Array],
    postures: Sequence[Posture],
    bodies: InterfaceLoads,
    theory: Theory = "timoshenko",
) -> Array:
    """Displacements (p×l×6, m and rad) of the tool under all loads in each posture, by `solve`.

    `solve` returns the displacements of the tool under several loads in a posture. `bodies`: masses
    on which the loads act, and wrenches of their pressures. `theory`: beam theory that reduces
    loads along legs to loads at their ends. NaN if the mechanism cannot move as a load requires.
    Shapes: p postures, l loads.
    """
    mechanism = postures[0].mechanism
    displacements = np.full((len(postures), len(mechanism.loads), 6), np.nan)
    for posture, by_load in zip(postures, displacements, strict=True):
        acting = loadings(posture, bodies, theory)
        if possible := [load for load in acting if load is not None]:
            by_load[[load is not None for load in acting]] = solve(posture, possible)
    return displacements


def loadings(
    posture: Posture, bodies: InterfaceLoads, theory: Theory = "timoshenko"
) -> list[Loading | None]:
    """Wrenches of each load of the robot file in a posture.

    None if the mechanism cannot move as the load requires. Arguments as for `displacements_by`.
    """
    acting: list[Loading | None] = []
    for load in posture.mechanism.loads:
        try:
            acting.append(loading(posture, load, bodies, theory))
        except ComputationError:
            acting.append(None)
    return acting


def load_forces(
    model: ModelName, postures: Sequence[Posture], options: ModelOptions = DEFAULT_OPTIONS
) -> list[list[LoadForces | None]]:
    """Forces in joints and legs for each posture (outer list) under each load (inner list).

    None if the mechanism cannot move as a load requires. Raises the exceptions of `displacements`.
    """
    bodies = interface_loads_of(model, postures[0].mechanism, options)
    prepared = static_assembly(model, postures, options)
    rows: list[list[LoadForces | None]] = []
    for posture in postures:
        solution = solved(prepared.at(posture))
        acting = loadings(posture, bodies, options.theory)
        rows.append([None if load is None else _load_forces(solution, load) for load in acting])
    return rows


def _load_forces(solution: Solved, load: Loading) -> LoadForces:
    posture, forces = solution.system.posture, internal_forces(solution, load)
    return LoadForces(
        tuple(reaction(posture, joint, load) for joint in forces.joints),
        tuple(
            member_forces(posture, name, leg, forces, load)
            for name, leg in legs_of(posture.mechanism).items()
        ),
        {
            name: BodyEnds(
                of_body.at_interfaces,
                solution.system.body_unknowns(name, forces.displacements)[: len(of_body.elastic)],
            )
            for name, of_body in forces.bodies.items()
        },
    )


def impossible_poses(postures: Sequence[Posture], load: Load) -> int:
    """Number of postures in which the tool cannot move as a load requires."""

    def is_possible(posture: Posture) -> bool:
        try:
            accelerations(posture, load.speed, load.acceleration)
        except ComputationError:
            return False
        return True

    return sum(not is_possible(posture) for posture in postures) if load.moves_tool else 0


def interface_loads(
    mechanism: Mechanism,
    masses: Masses = MASSES[0],
    parts: Mapping[str, BodyModel] | None = None,
) -> InterfaceLoads:
    """Masses on which loads act, and wrenches of pressures, for models without mass.

    Legs have the masses of beams, CAD parts those of their models `parts`. If `parts` is None, the
    parts are condensed here. `masses` is the mass distribution in legs specified by their 6×6
    compliance. The result has no masses if no load acts on mass.
    """
    pressures = unit_pressures(mechanism, parts)
    if not any(load.acts_on_mass for load in mechanism.loads):
        return InterfaceLoads({}, pressures)
    if parts is None:
        parts = {name: condensed(body) for name, body in mechanism.parts.items()}
    legs = {name: _leg_mass(leg, masses) for name, leg in legs_of(mechanism).items()}
    of_parts = {name: interface_mass(model) for name, model in parts.items()}
    return InterfaceLoads(legs | of_parts, pressures)


def interface_mass(model: BodyModel) -> Array:
    """Mass matrix (6m×6m) of a model condensed to the twists of its m interfaces.

    Reductions by Craig and Bampton and by Guyan have the same condensed mass matrix.
    """
    ends = slice(6 * len(model.interfaces))
    return dense(model.mass)[ends, ends]


def _leg_mass(leg: Leg, masses: Masses) -> Array:
    if not isinstance(leg, GivenLeg):
        return dense(condensed_leg("beam", leg, DEFAULT_OPTIONS).mass)
    return ends_mass(leg, masses)


def interface_loads_of(
    model: ModelName, mechanism: Mechanism, options: ModelOptions
) -> InterfaceLoads:
    """Masses on which loads act, wrenches of pressures, and of loads along bent solid legs.

    Masses are those of the model, or of `interface_loads` if the model has none.
    """
    if model == "simplified" or model in STATIC:
        return interface_loads(mechanism)
    pressures = unit_pressures(mechanism)
    lines = solid_line_wrenches(mechanism, lambda *_: options) if model == "solid" else {}
    if not any(load.acts_on_mass for load in mechanism.loads):
        return InterfaceLoads({}, pressures, lines)
    bodies = static_bodies(model, mechanism, options)
    if model == "segments":
        bodies |= bodies_of(mechanism, replace(options, release="condensed"), _segments)
    masses = {name: interface_mass(body) for name, body in bodies.items()}
    return InterfaceLoads(masses, pressures, lines)


def _segments(leg: SectionedLeg | SteppedLeg, options: ModelOptions) -> LegMatrices:
    """Model of a leg by segments with mass, condensed to its ends.

    It is used for loads on masses, because the model for statics consists of springs in series only
    and has no mass.
    """
    segments = leg_matrices("segments", leg, replace(options, release="condensed"))
    return static_superelement(held_leg(segments)).matrices
