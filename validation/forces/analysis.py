"""Forces and stresses of a model under the loads of a robot file, with their half-widths.

Input: a `Question`, or a robot in its postures with a model. Output: `Forces`, with reactions,
section forces along legs and stresses for each pose and load. Rule: the half-width of a force is
the change to a second mesh (more segments, other divisions of solids, or coarser CAD parts), scaled
by the order of convergence.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from math import inf
from typing import TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.legs import ConstantLeg, LineLeg
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.mechanism.mechanism import UNITS_OF_MOVES, Mechanism, Posture
from lumped.robot_file import RobotFile
from lumped.system.members import MemberForces
from validation.context import Context
from validation.forces.record import Forces
from validation.forces.results import ForcesUnderLoad, PoseForces
from validation.forces.solids import require_fields, solid_stresses
from validation.forces.stresses import laminate_stress, member_stress, reason_without_stress
from validation.kinematics.poses import postures_on_path
from validation.models.loads.statics import LoadForces, load_forces
from validation.models.options import ModelName, ModelOptions
from validation.models.reduced_parts import found_in, unknowns_of, with_unknowns
from validation.models.robot_bodies import sectioned_legs
from validation.parts.meshes import FINEST, MIDDLE
from validation.references.model_ladder import with_elements
from validation.references.responses import Model, PathForces, Responses
from validation.references.robot_on_path import NOMINAL, Reading, RobotOnPath, robot_at
from validation.solve.model_answers import checked
from validation.solve.question import Question
from validation.solve.uncertainty import mesh_policy, second_divisions
from validation.uncertainty.half_widths import MeshPolicy, half_widths_on

# Levels of a mesh, rule for half-widths, and model and reading on each level.
MeshStudy: TypeAlias = tuple[
    Sequence[int], MeshPolicy | float, Callable[[int], tuple[Model, Reading]]
]
# Order of convergence of the forces with the number of segments, whose mass is lumped: that of the
# layout with springs of half length at both ends, and that of the paper's layout.
_HALF, _LITERAL = 2.0, 1.0
# Distance of two stations that count as one, over the length of the leg.
_SAME = 1e-9
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
    """Forces in the poses of a question, or of the path if `on_path`.

    `loads`: names of loads; () for all loads of the robot file. With `solids`, stress fields of all
    bodies are included. Raises InputError for an invalid question, a robot without loads or an
    unknown load, and ComputationError if the tool is free to move.
    """
    if on_path and (question.x or question.poses):
        raise InputError("--path: takes all poses of [path]; leave out --pose or --path")
    question = replace(question, robot_file=_with_loads(question.robot_file, loads), modes=0)
    checked(question)
    mechanism = question.mechanism
    if solids and question.model != "solid":
        raise InputError(
            f"--vtu: the {question.model} model has no stress fields; add --model solid"
        )
    postures = postures_on_path(mechanism, mechanism.poses) if on_path else question.postures()
    if solids and len(mechanism.loads) * len(postures) > 1:
        raise InputError("--vtu: writes one load in one pose; name them with --load and --pose")
    if solids:
        require_fields(mechanism, mechanism.loads[0])
    robot = robot_at(Context(question.robot_file, "quick"), postures)
    return forces_in(
        robot, question.model, question.options, question.effective_options, solids=solids
    )


def forces_in(
    robot: RobotOnPath,
    model: ModelName,
    options: ModelOptions,
    shown_options: Mapping[str, object] | None = None,
    *,
    part_meshes: bool = True,
    solids: bool = False,
) -> Forces:
    """Forces in the postures of a robot under all of its loads.

    `shown_options`: options of the model that the result displays, by name. Half-widths include
    those due to the meshes of CAD parts if `part_meshes`. With `solids`, stress fields of all
    bodies are included.
    """
    mechanism, tool = robot.mechanism, robot.mechanism.tool
    responses, solved_model = Responses(robot, strict=True), _force_model(model, options)
    rows = responses.required_forces(solved_model, NOMINAL)

    def half_widths_of(study: MeshStudy) -> Array:
        levels, policy, at = study
        return half_widths_on(
            levels,
            policy,
            lambda level: responses.required_forces(*at(level)),
            lambda first, second, _: _changes(rows, first, second),
        )

    studies = _mesh_studies(robot, solved_model, options, part_meshes=part_meshes)
    half_widths = sum(map(half_widths_of, studies), np.zeros(1))
    widths_of_all = np.broadcast_to(half_widths, (len(rows), len(mechanism.loads), _count(rows), 6))
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
            for posture, row, widths in zip(robot.postures, rows, widths_of_all, strict=True)
        ),
    )


def _with_loads(robot_file: RobotFile, names: Sequence[str]) -> RobotFile:
    """Robot with only the loads that are listed in `names`. All of its loads if `names` is empty.

    Raises InputError if the robot has no loads, or for an unknown name.
    """
    mechanism = robot_file.mechanism
    load_names = [load.name for load in mechanism.loads]
    if not load_names:
        raise InputError(
            f"{mechanism.name}: the robot file has no [[loads]]; the command needs at least one"
        )
    if unknown := [name for name in names if name not in load_names]:
        raise InputError(
            f"--load {name}: must be one of {', '.join(load_names)}" for name in unknown
        )
    loads = [load for load in mechanism.loads if not names or load.name in names]
    return replace(robot_file, mechanism=replace(mechanism, loads=tuple(loads)))


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
    stresses, laminates, without = {}, {}, {}
    for member in members:
        shape = mechanism.bodies[member.leg].shape
        if isinstance(shape, ConstantLeg) and (layers := laminate_stress(shape, member)):
            laminates[member.leg] = layers
            continue
        reason = reason_without_stress(shape)
        stress = None
        if not reason and isinstance(shape, ConstantLeg | LineLeg):
            stress = member_stress(shape, member)
            reason = "" if stress else "the section forces are statically indeterminate"
        if stress is None:
            without[member.leg] = reason
        else:
            stresses[member.leg] = stress
    return ForcesUnderLoad(reactions, members, stresses, without, laminates)


def _force_model(model: ModelName, options: ModelOptions) -> Model:
    """Model whose forces depend on two fields of a `Reading`: `elements` and `part_mesh`.

    `elements` is a factor on the element count, `part_mesh` the mesh level of CAD parts.
    """
    return Model(
        model,
        forces=partial(_solved_forces, model, options),
        static_fields=("elements", "part_mesh"),
    )


def _solved_forces(
    model: ModelName, options: ModelOptions, robot: RobotOnPath, reading: Reading
) -> PathForces:
    """Forces of a robot by a model, with the element count and part meshes that `reading` selects.

    Each coarser level of the meshes of CAD parts has half as many unknowns.
    """
    postures: Sequence[Posture] = robot.postures
    if reading.part_mesh != FINEST:
        divisor = 2 ** (FINEST - reading.part_mesh)
        parts = robot.mechanism.parts
        unknowns = {name: unknowns_of(body) // divisor for name, body in parts.items()}
        coarser = with_unknowns(robot.mechanism, unknowns)
        postures = [replace(posture, mechanism=coarser) for posture in postures]
    return load_forces(model, postures, with_elements(options, reading))


def _mesh_studies(
    robot: RobotOnPath, model: Model, options: ModelOptions, *, part_meshes: bool
) -> Iterator[MeshStudy]:
    """Studies of each kind of mesh that affects forces: segments, solid legs and CAD parts.

    CAD parts are omitted unless `part_meshes`.
    """
    mechanism = robot.mechanism
    if model.name == "segments":
        order = _HALF if options.layout == "half" else _LITERAL
        policy = MeshPolicy.of_order(0.5, order)
        yield (1, 2), policy, lambda factor: (model, replace(NOMINAL, elements=factor))
    legs = [leg for _, leg, _ in sectioned_legs(mechanism, options)]
    if model.name == "solid" and legs:
        second = second_divisions(options, legs)
        other = _force_model("solid", replace(options, divisions=second))
        models = {options.divisions: model, second: other}
        levels = sorted(models)
        yield levels, mesh_policy(options, legs, second), lambda n: (models[n], NOMINAL)
    if part_meshes and mechanism.parts and model.name != "simplified":
        of_meshes = [found_in(body)[0].mesh is not None for body in mechanism.parts.values()]
        yield (
            (MIDDLE, FINEST),
            inf if any(of_meshes) else MeshPolicy.of_order(_PART_RATIO, _PART_ORDER),
            lambda level: (model, NOMINAL.on_mesh("part_mesh", level)),
        )


def _count(rows: PathForces) -> int:
    """Number of joints and legs with forces. 0 if no load can be solved in any pose."""
    results = (result for row in rows for result in row if result is not None)
    return next((len(result.reactions) + len(result.members) for result in results), 0)


def _changes(rows: PathForces, first: PathForces, second: PathForces) -> Array:
    """Magnitudes (P×L×n×6, N and N m) of the changes of forces from solution `first` to `second`.

    The n rows are the joints, then the legs. The row of a joint contains the changes of its wrench,
    that of a leg the largest changes of its section forces. Zero if there is no solution, or none
    in `rows`. Shapes: P poses, L loads, n joints and legs.
    """
    count = _count(rows)
    changes = [
        np.zeros((count, 6)) if result is None or None in pair else _changes_under_load(*pair)
        for results, *pairs in zip(rows, first, second, strict=True)
        for result, *pair in zip(results, *pairs, strict=True)
    ]
    return np.reshape(changes, (len(rows), -1, count, 6))


def _changes_under_load(first: LoadForces, second: LoadForces) -> Array:
    changes = [
        np.abs(one.wrench - other.wrench)
        for one, other in zip(first.reactions, second.reactions, strict=True)
    ]
    changes += [
        _largest_changes(one, other)
        for one, other in zip(first.members, second.members, strict=True)
    ]
    return np.asarray(np.nan_to_num(np.reshape(changes, (-1, 6))))


def _largest_changes(first: MemberForces, second: MemberForces) -> Array:
    """Largest magnitudes (6, N and N m) of the changes of a leg's forces between two solutions.

    They are compared at the stations of both. Each solution has further ones, at its extremes.
    """
    slack = _SAME * float(first.stations[-1])
    distances = np.abs(first.stations[:, None] - second.stations)
    same = (distances <= slack) & (first.runs[:, None] == second.runs)
    rows, columns = np.nonzero(same)
    return np.asarray(np.abs(first.forces[rows] - second.forces[columns]).max(axis=0))
