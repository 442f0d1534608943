"""The model of a request to `solve`, which `Responses` solves under readings of the robot file.

Input: a `Question`. Output: a `Model` of the robot in the requested poses, or of one of its bodies.
Rule: the fields `part_mesh` and `ends` of a reading select mesh and coupling of CAD parts as
solids.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from lumped.dense.modes import FewerModesError
from lumped.legs import GivenLeg, Leg
from lumped.models.bodies import leg_of
from lumped.system.assembly import assembly
from lumped.system.solution import compliance
from lumped.system.sweep import swept
from validation.models.leg_models import leg_compliance, leg_modes
from validation.models.loads.displacements import displacements_of
from validation.models.options import ModelOptions
from validation.models.robot_models import (
    FINE_PARTS,
    PartMeshing,
    PostureModes,
    answers,
    highest_frequency,
    mechanism_modes,
    reduced_parts_of,
    static_bodies,
)
from validation.references.mode_samples import samples_of
from validation.references.model_ladder import model_statics
from validation.references.modes_on_path import vibration_of
from validation.references.reference_parts import interface_coupling
from validation.references.responses import Model
from validation.references.robot_on_path import Reading, RobotOnPath
from validation.responses.statics_and_modes import PathModes, Statics
from validation.solve.question import OF_ELEMENTS, Question

# Cut-off frequency (Hz) for the reduction of CAD parts if no modes are requested. It lies below all
# their modes.
_LOWEST = 1e-3
# Elements per leg for the effect of printed digits. For six modes, this effect differs by one per
# cent from that with 20 elements.
_FEW_ELEMENTS = 6


@dataclass(frozen=True, eq=False)
class SolvedModes(PathModes):
    """Modes of a robot with the solution of each pose, which has strain energies and damping."""

    postures: Sequence[PostureModes] = ()


def solved_model(question: Question) -> Model:
    """Model of a question. A free body has no statics, and a static model no modes."""
    fields = ("part_mesh", "ends") if question.model == "solid" else ()
    return Model(
        question.model,
        statics=None if question.free else partial(_statics, question),
        modes=partial(_modes, question) if question.count else None,
        static_fields=fields,
        modal_fields=fields,
    )


def digits_model(question: Question, count: int) -> Model:
    """Model for the effect of printed digits on compliance and `count` frequencies.

    It is the model of the question with few elements and with beams instead of solids, because the
    relative effect of digits is small and depends little on the model.
    """
    options = question.given
    if question.model == "solid":
        options = {name: options[name] for name in ("equivalent",) if name in options}
        question = replace(question, model="beam")
    if question.model in OF_ELEMENTS:
        options = {**options, "elements": min(question.options.elements, _FEW_ELEMENTS)}
    question = replace(question, given=options, modes=count)
    if question.alone is not None:
        return solved_model(question)

    def frequencies(robot: RobotOnPath, _: Reading) -> PathModes:
        solved = answers(question.model, robot.postures, count, question.options)
        return PathModes.unsampled(np.array([answer.frequencies for answer in solved]))

    return replace(solved_model(question), modes=frequencies if count else None)


def _statics(question: Question, robot: RobotOnPath, reading: Reading) -> Statics:
    options, mechanism = question.options, robot.mechanism
    if question.alone is not None:
        leg, options = _leg(question.alone, robot, options)
        compliance = leg_compliance(question.model, leg, options)
        return Statics(compliance[None], np.zeros((1, 0, 6)), [None])
    part_mesh = _part_mesh(robot, reading)
    if question.model != "solid" or not mechanism.parts or not (question.count or part_mesh):
        return model_statics(robot.postures, question.model, options)
    bodies = static_bodies("solid", mechanism, options)
    highest = _LOWEST
    if question.count:
        highest = highest_frequency(robot.postures, question.count, options)
    bodies |= reduced_parts_of(mechanism, highest, options, part_mesh or FINE_PARTS)
    solved = swept(assembly(mechanism, bodies), robot.postures, 0)
    return Statics(solved.compliances, displacements_of(bodies, robot.postures), solved.idle)


def _part_mesh(robot: RobotOnPath, reading: Reading) -> PartMeshing | None:
    """Mesh level and coupling of CAD parts in `reading`. None if both are the default."""
    free = "free" in reading.ends.values()
    part_mesh = PartMeshing(reading.part_mesh, interface_coupling("free" if free else "rigid"))
    return part_mesh if robot.mechanism.parts and part_mesh != FINE_PARTS else None


def _modes(question: Question, robot: RobotOnPath, reading: Reading) -> PathModes | None:
    """Modes, as many as requested. If no number is requested, six, or all if there are fewer.

    The result is None if nothing has mass.
    """
    solve = partial(_first_modes, question, robot, reading)
    if question.modes is not None:
        return solve(question.modes)
    for count in range(question.count, 0, -1):
        with suppress(FewerModesError):
            return solve(count)
    return None


def _first_modes(question: Question, robot: RobotOnPath, reading: Reading, count: int) -> PathModes:
    """First `count` modes. They are sampled if they are compared with modes of other models."""
    model, options = question.model, question.options
    if question.alone is not None:
        leg, options = _leg(question.alone, robot, options)
        return leg_modes(model, leg, count, options, free=question.free)
    part_mesh = _part_mesh(robot, reading) or FINE_PARTS
    postures = mechanism_modes(model, robot.postures, count, options, part_mesh)
    for posture in postures:
        # Raises ComputationError if round-off dominates: statics are solved apart, without the
        # unknowns inside legs, and can be sound where these modes are not.
        compliance(posture.solution)
    if model == "solid" or question.against:
        sampled = vibration_of(samples_of(robot.mechanism), postures, count)
    else:
        frequencies = [posture.modes.frequencies for posture in postures]
        missing = [np.full(count - len(values), np.nan) for values in frequencies]
        sampled = PathModes.unsampled(np.array([*map(np.append, frequencies, missing)]))
    return SolvedModes(
        sampled.frequencies,
        sampled.samples,
        sampled.weights,
        sampled.energy_shares,
        postures=postures,
    )


def _leg(name: str, robot: RobotOnPath, options: ModelOptions) -> tuple[Leg, ModelOptions]:
    """Leg `name`, and options with its end condition if the robot file specifies one."""
    leg = leg_of(robot.mechanism.bodies[name])
    if not isinstance(leg, GivenLeg) and leg.ends is not None:
        options = replace(options, ends=leg.ends)
    return leg, options
