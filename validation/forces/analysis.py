"""Forces and stresses of a model under the loads of a robot file, with their half-widths.

Input: a `Question`, or postures of a mechanism with a model. Output: `Forces`, with reactions,
section forces along legs and stresses for each pose and load. Rule: the half-width of a force is
the change to a second mesh (more segments, other divisions of solids, or coarser CAD parts), scaled
by the order of convergence.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace
from math import inf

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.legs import ConstantLeg, is_bent
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.mechanism.mechanism import UNITS_OF_MOVES, Mechanism, Posture
from lumped.models.bodies import legs_of
from lumped.robot_file import RobotFile
from lumped.system.members import MemberForces
from lumped.system.reactions import Reaction
from validation.forces.record import Forces
from validation.forces.results import ForcesUnderLoad, PoseForces
from validation.forces.solids import solid_stresses
from validation.forces.stresses import member_stress, reason_without_stress
from validation.kinematics.poses import postures_on_path
from validation.models.loads.forces import LoadForces, load_forces
from validation.models.options import ModelName, ModelOptions
from validation.models.reduced_parts import found_in, unknowns_of, with_unknowns
from validation.models.robot_models import sectioned_legs
from validation.solve.model_answers import checked
from validation.solve.question import Question
from validation.solve.uncertainty import mesh_policy, second_divisions
from validation.uncertainty.mesh_half_widths import MeshPolicy, mesh_half_widths

# Order of convergence of the forces with the number of segments, whose mass is lumped: that of the
# layout with springs of half length at both ends, and that of the paper's layout.
_HALF, _LITERAL = 2.0, 1.0
# Ratio of element sizes if a mesh of a CAD part has half as many unknowns, and the lowest
# order of convergence of their stiffness, due to singular stresses at the edges of bores.
_PART_RATIO, _PART_ORDER = 2.0 ** (1.0 / 3.0), 1.0


def forces(
    question: Question,
    loads: Sequence[str] = (),
    *,
    on_path: bool = False,
    solids: bool = False,
) -> Forces:
    """Forces in the poses of a question or of the path, under `loads` (names; all if empty).

    With `solids`, stress fields of all bodies are included. Raises InputError for a wrong question,
    a robot without loads or an unknown load, and ComputationError if the tool is free to move.
    """
    if on_path and (question.x or question.poses):
        raise InputError("--path: takes all poses of [path]; leave out --pose or --path")
    question = replace(question, robot_file=_with_loads(question.robot_file, loads), modes=0)
    checked(question)
    mechanism, options = question.mechanism, asdict(question.options)
    if solids and question.model != "solid":
        raise InputError(
            f"--vtu: the {question.model} model has no stress fields; add --model solid"
        )
    postures = postures_on_path(mechanism, mechanism.poses) if on_path else question.postures()
    if solids and len(mechanism.loads) * len(postures) > 1:
        raise InputError("--vtu: writes one load in one pose; name them with --load and --pose")
    names = question.effective_options
    effective = {name: value for name, value in options.items() if name in names}
    return forces_in(question.model, postures, question.options, effective, solids=solids)


def forces_in(
    model: ModelName,
    postures: Sequence[Posture],
    options: ModelOptions,
    shown_options: Mapping[str, object] | None = None,
    *,
    part_meshes: bool = True,
    solids: bool = False,
) -> Forces:
    """Forces in postures of one mechanism under all of its loads.

    Half-widths include those of the meshes of CAD parts if `part_meshes`. With `solids`, stress
    fields of all bodies are included.
    """
    mechanism = postures[0].mechanism
    rows = load_forces(model, postures, options)
    half_widths = _mesh_half_widths(model, postures, options, rows, part_meshes=part_meshes)
    tool = mechanism.tool
    return Forces(
        mechanism.name,
        model,
        dict(shown_options or {}),
        tuple(f"{move} ({UNITS_OF_MOVES[move]})" for move in tool.moves),
        tuple(
            PoseForces(
                tuple(posture.pose.tolist()),
                shown_pose(mechanism, posture.pose) or "the only posture",
                {
                    load.name: None
                    if result is None
                    else replace(
                        _under_load(mechanism, result, width),
                        solids=solid_stresses(posture, load, result.ends, options)
                        if solids
                        else {},
                    )
                    for load, result, width in zip(mechanism.loads, row, widths, strict=True)
                },
            )
            for posture, row, widths in zip(postures, rows, half_widths, strict=True)
        ),
    )


def _with_loads(robot_file: RobotFile, names: Sequence[str]) -> RobotFile:
    """Robot with only the loads of these names; with all of its loads if no names are given."""
    mechanism = robot_file.mechanism
    known = [load.name for load in mechanism.loads]
    if not known:
        raise InputError(
            f"{mechanism.name}: the robot file has no [[loads]]; the command needs at least one"
        )
    if unknown := [name for name in names if name not in known]:
        raise InputError(f"--load {name}: must be one of {', '.join(known)}" for name in unknown)
    chosen = [load for load in mechanism.loads if not names or load.name in names]
    return replace(robot_file, mechanism=replace(mechanism, loads=tuple(chosen)))


def _under_load(mechanism: Mechanism, result: LoadForces, widths: Array) -> ForcesUnderLoad:
    """Forces under one load, with half-widths due to meshes added and stresses computed.

    `widths`: half-widths (N, N m), a row of six for each joint, then for each leg.
    """
    count = len(result.reactions)
    reactions = tuple(
        replace(reaction, half_width=reaction.half_width + width)
        for reaction, width in zip(result.reactions, widths[:count], strict=True)
    )
    members = tuple(
        replace(member, half_width=member.half_width + width)
        for member, width in zip(result.members, widths[count:], strict=True)
    )
    stresses = {}
    without = {
        name: "its centre line is bent; section forces are computed for straight legs only"
        for name, leg in legs_of(mechanism).items()
        if is_bent(leg)
    }
    for member in members:
        shape = mechanism.bodies[member.leg].shape
        reason = reason_without_stress(shape)
        stress = None
        if not reason and isinstance(shape, ConstantLeg):
            stress = member_stress(shape, member)
            reason = "" if stress else "its forces are statically indeterminate"
        if stress is None:
            without[member.leg] = reason
        else:
            stresses[member.leg] = stress
    return ForcesUnderLoad(reactions, members, stresses, without)


def _mesh_half_widths(
    model: ModelName,
    postures: Sequence[Posture],
    options: ModelOptions,
    rows: Sequence[Sequence[LoadForces | None]],
    *,
    part_meshes: bool,
) -> list[list[Array]]:
    """Half-widths of forces due to meshes, for each posture (outer list) and load (inner list).

    Each array (N, N m) has a row of six for each joint, then for each leg. Infinite if the file of
    a part is a mesh, which cannot be refined.
    """
    mechanism = postures[0].mechanism
    zeros = [[np.zeros((_count(result), 6)) for result in row] for row in rows]
    studies: list[tuple[Callable[[], Sequence[Sequence[LoadForces | None]]], MeshPolicy]] = []
    if model == "segments":
        finer = replace(options, elements=2 * options.elements)
        order = _HALF if options.layout == "half" else _LITERAL
        studies.append(
            (lambda: load_forces(model, postures, finer), MeshPolicy.of_order(0.5, order))
        )
    if model == "solid" and (legs := [leg for _, leg, _ in sectioned_legs(mechanism, options)]):
        divisions = second_divisions(options, legs)
        other = replace(options, divisions=divisions)
        studies.append(
            (lambda: load_forces(model, postures, other), mesh_policy(options, legs, divisions))
        )
    if part_meshes and mechanism.parts and model != "simplified":
        if any(found_in(body)[0].mesh is not None for body in mechanism.parts.values()):
            return [[np.full_like(zero, inf) for zero in row] for row in zeros]
        unknowns = {name: unknowns_of(body) // 2 for name, body in mechanism.parts.items()}
        coarser = with_unknowns(mechanism, unknowns)
        others = [replace(posture, mechanism=coarser) for posture in postures]
        studies.append(
            (
                lambda: load_forces(model, others, options),
                MeshPolicy.of_order(_PART_RATIO, _PART_ORDER),
            )
        )
    for solve, policy in studies:
        for row, other_row, totals in zip(rows, solve(), zeros, strict=True):
            for number, (result, compared) in enumerate(zip(row, other_row, strict=True)):
                if result is not None and compared is not None:
                    totals[number] += mesh_half_widths([_changes(result, compared)], policy)
    return zeros


def _count(result: LoadForces | None) -> int:
    return 0 if result is None else len(result.reactions) + len(result.members)


def _changes(result: LoadForces, other: LoadForces) -> Array:
    """Magnitudes (N, N m) of the changes of forces between two solutions, six in each row.

    First the wrench of each joint, then the largest change along each leg.
    """
    rows = [_change(*pair) for pair in zip(result.reactions, other.reactions, strict=True)]
    rows += [_change_along(*pair) for pair in zip(result.members, other.members, strict=True)]
    return np.nan_to_num(np.reshape(rows, (-1, 6)))


def _change(first: Reaction, second: Reaction) -> Array:
    return np.abs(first.wrench - second.wrench)


def _change_along(first: MemberForces, second: MemberForces) -> Array:
    columns = [
        np.interp(first.stations, second.stations, second.forces[:, component])
        for component in range(6)
    ]
    return np.asarray(np.abs(first.forces - np.column_stack(columns)).max(axis=0))
