"""The model of a request to `solve`, which `Responses` solves under readings of the robot file.

Input: a `Question`. Output: a `Model` of the robot in the requested poses, or of one of its bodies.
Rule: the fields `part_mesh` and `ends` of a `Reading` (an interpretation of the file and a choice
of meshes) select mesh and coupling of CAD parts as solids. If modes are requested, statics use the
systems of the modes.
"""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache, partial

import numpy as np

from lumped.arrays import Array
from lumped.dense.modes import FewerModesError
from lumped.legs import GivenLeg, Leg
from lumped.mechanism.mechanism import Mechanism
from lumped.models.bodies import leg_of
from lumped.system.assembly import assembly
from lumped.system.sweep import swept
from validation.models.leg_models import leg_compliance, leg_modes
from validation.models.loads.statics import displacements, displacements_of
from validation.models.options import ModelOptions
from validation.models.robot_bodies import FINE_PARTS, PartMeshing, reduced_parts_of, static_bodies
from validation.models.robot_models import PostureModes, mechanism_modes
from validation.references.mode_samples import samples_of
from validation.references.model_ladder import model_statics
from validation.references.modes_on_path import vibration_of
from validation.references.reference_parts import interface_coupling
from validation.references.responses import Model
from validation.references.robot_on_path import Reading, RobotOnPath
from validation.responses.statics_and_modes import PathModes, Statics
from validation.solve.question import Question

# Number of solved modes of solids beyond those of the answer. The robot may have a mode of nearly
# the same frequency for each leg and direction.
_SPARE = 6
# Ratio of frequencies up to which spare modes are candidates for partners of the last mode of the
# answer. The mesh can change the order of modes that are so close.
_CLOSE = 1.01
# Cut-off frequency (Hz) for the reduction of CAD parts if no modes are requested. It lies below all
# their modes.
_LOWEST = 1e-3


@dataclass(frozen=True, eq=False)
class SolvedModes(PathModes):
    """Modes of an answer, and further modes whose frequency is close to that of its last mode.

    `count`: number of modes of the answer. The further modes are candidates when modes are paired
    with those on another mesh. Modes of equal frequency can be combined at will, so that a mode may
    have a partner only among combinations of the answer's modes and the further ones. `postures`:
    solution of a robot in each pose with the answer's modes, from which strain energies and damping
    follow. () for a body alone.
    """

    count: int = 0
    postures: Sequence[PostureModes] = ()


def solved_model(question: Question) -> Model:
    """Solvable model that answers a question.

    A free body has no statics. A static model, or a question for no modes, has no modes.
    """
    fields = ("part_mesh", "ends") if question.model == "solid" else ()
    modes = cache(partial(_modes, question))
    return Model(
        question.model,
        statics=None if question.free else partial(_statics, question, modes),
        modes=modes if question.count else None,
        static_fields=fields,
        modal_fields=fields,
    )


def _statics(
    question: Question,
    modes_of: Callable[[RobotOnPath, Reading], SolvedModes | None],
    robot: RobotOnPath,
    reading: Reading,
) -> Statics:
    """Compliance and displacements under the loads of the robot file.

    `modes_of`: function that returns the modes. If modes are requested, the compliance follows from
    the systems that were assembled for them.
    """
    mechanism, postures = robot.mechanism, robot.postures
    model, options = question.model, question.options
    if question.alone is not None:
        leg, options = leg_alone(question.alone, mechanism, options)
        return Statics(leg_compliance(model, leg, options)[None], np.zeros((1, 0, 6)), [None])
    solid_parts = model == "solid" and mechanism.parts
    modes = modes_of(robot, reading) if question.count else None
    if modes is not None:
        solutions = modes.postures
        bodies = solutions[0].system.models
        return Statics(
            np.array([solution.compliance for solution in solutions]),
            displacements_of(bodies, postures)
            if solid_parts
            else displacements(model, postures, options),
            [solution.idle for solution in solutions],
        )
    part_mesh = _part_mesh(robot, reading)
    if not solid_parts or part_mesh == FINE_PARTS:
        return model_statics(postures, model, options)
    bodies = static_bodies(model, mechanism, options)
    bodies |= reduced_parts_of(mechanism, _LOWEST, options, part_mesh)
    solved = swept(assembly(mechanism, bodies), postures, 0)
    return Statics(solved.compliances, displacements_of(bodies, postures), solved.idle)


def _modes(question: Question, robot: RobotOnPath, reading: Reading) -> SolvedModes | None:
    """Modes, as many as the question requests. None if nothing has mass.

    If the question has no number of modes: six modes, or all if there are fewer.
    """
    if question.modes is not None:
        return _first_modes(question, robot, reading, question.modes)
    for count in range(question.count, 0, -1):
        with suppress(FewerModesError):
            return _first_modes(question, robot, reading, count)
    return None


def _first_modes(
    question: Question, robot: RobotOnPath, reading: Reading, count: int
) -> SolvedModes:
    """First `count` modes, with shapes at the samples if they are paired with other modes.

    Modes of solids are paired with those on another mesh, others only if `against` is given.
    """
    model, options = question.model, question.options
    spare = _SPARE if model == "solid" else 0
    solutions: Sequence[PostureModes] = ()
    if question.alone is not None:
        leg, options = leg_alone(question.alone, robot.mechanism, options)
        solve = partial(leg_modes, model, leg, options=options, free=question.free)
        try:
            modes = solve(count + spare)
        except FewerModesError:
            modes = solve(count)
        modes = modes.first(_close(modes.frequencies[0], count))
    else:
        part_mesh = _part_mesh(robot, reading)
        solutions = mechanism_modes(model, robot.postures, count, options, part_mesh, spare)
        frequencies = [solution.modes.frequencies for solution in solutions]
        if model == "solid" or question.against:
            close = [_close(values, count) for values in frequencies]
            candidates = map(PostureModes.first, solutions, close)
            modes = vibration_of(samples_of(robot.mechanism), candidates, max(close))
            solutions = [solution.first(count) for solution in solutions]
        else:
            missing = [np.full(count - len(values), np.nan) for values in frequencies]
            modes = PathModes.unsampled(np.array([*map(np.append, frequencies, missing)]))
        count = min(count, max(map(len, frequencies)))
    return SolvedModes(**vars(modes), count=count, postures=solutions)


def _close(frequencies: Array, count: int) -> int:
    """Number of modes whose frequency (Hz) is at most slightly above that of mode `count`."""
    limit = _CLOSE * frequencies[:count].max(initial=0.0)
    return int(np.sum(frequencies <= limit))


def _part_mesh(robot: RobotOnPath, reading: Reading) -> PartMeshing:
    """Mesh level of CAD parts and coupling of their interfaces, from a `reading` of the file."""
    if not robot.mechanism.parts:
        return FINE_PARTS
    free = "free" in reading.ends.values()
    return PartMeshing(reading.part_mesh, interface_coupling("free" if free else "rigid"))


def leg_alone(name: str, mechanism: Mechanism, options: ModelOptions) -> tuple[Leg, ModelOptions]:
    """Leg `name`, and options with its end condition if the robot file specifies one."""
    leg = leg_of(mechanism.bodies[name])
    if not isinstance(leg, GivenLeg) and leg.ends is not None:
        options = replace(options, ends=leg.ends)
    return leg, options
