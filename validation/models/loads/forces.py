"""Forces in the joints and legs of a mechanism under the loads of its robot file, by any model.

Input: postures of a mechanism with loads, and a model. Output: `LoadForces` for each posture and
load: the wrench that each joint transmits, and the forces and moments along each leg. Rule: forces
follow from equilibrium of each body, with the displacements of the model and the masses and faces
on which its loads act (`displacements.interface_loads_of`).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from lumped.arrays import Array
from lumped.errors import ComputationError
from lumped.legs import is_bent
from lumped.mechanism.load import Loading
from lumped.mechanism.mechanism import Posture
from lumped.models.bodies import legs_of
from lumped.system.assembly import Assembly, assembly
from lumped.system.loads import loading
from lumped.system.members import MemberForces, member_forces
from lumped.system.reactions import InternalForces, Reaction, internal_forces, reaction
from lumped.system.solution import Solved, solved
from validation.models.loads.displacements import interface_loads_of
from validation.models.options import DEFAULT_OPTIONS, ModelName, ModelOptions
from validation.models.robot_bodies import on_drives_alone, released, static_bodies


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
    """Wrenches of all joints, and forces along all straight legs, under one load in one posture.

    Joints and legs are in the order of the robot file. `ends`: wrenches and twists at the
    interfaces of each deformable body, by its name.
    """

    reactions: tuple[Reaction, ...]
    members: tuple[MemberForces, ...]
    ends: Mapping[str, BodyEnds]


def load_forces(
    model: ModelName, postures: Sequence[Posture], options: ModelOptions = DEFAULT_OPTIONS
) -> list[list[LoadForces | None]]:
    """Forces in joints and legs for each posture (outer list) under each load (inner list).

    None if the mechanism cannot move as a load requires. Raises the exceptions of `displacements`.
    """
    mechanism = postures[0].mechanism
    loaded_bodies = interface_loads_of(model, mechanism, options)
    prepared = _assembly(model, postures, options)
    rows: list[list[LoadForces | None]] = []
    for posture in postures:
        solution = solved(prepared.at(posture))
        row: list[LoadForces | None] = []
        for load in mechanism.loads:
            try:
                acting = loading(posture, load, loaded_bodies, options.theory)
            except ComputationError:
                row.append(None)
                continue
            row.append(_load_forces(solution, acting, internal_forces(solution, acting)))
        rows.append(row)
    return rows


def _assembly(model: ModelName, postures: Sequence[Posture], options: ModelOptions) -> Assembly:
    mechanism = postures[0].mechanism
    if model == "simplified":
        return assembly(on_drives_alone(mechanism), {})
    bodies = static_bodies(model, mechanism, options)
    return assembly(released(postures, options)[0].mechanism, bodies)


def _load_forces(solution: Solved, load: Loading, forces: InternalForces) -> LoadForces:
    posture = solution.system.posture
    return LoadForces(
        tuple(reaction(posture, joint, load) for joint in forces.joints),
        tuple(
            member_forces(posture, name, forces, load)
            for name, leg in legs_of(posture.mechanism).items()
            if not is_bent(leg)
        ),
        {
            name: BodyEnds(
                of_body.at_interfaces,
                solution.system.body_unknowns(name, forces.displacements)[: len(of_body.elastic)],
            )
            for name, of_body in forces.bodies.items()
        },
    )
