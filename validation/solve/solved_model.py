"""The model of a request to `solve`, which `Responses` solves under readings and on other meshes.

Input: a `Question`. Output: a `Model` of the robot in the requested poses, or of one of its bodies.
Rule: `mesh` 1 of a reading is the requested mesh of prisms and 0 a second one. `part_mesh` and
`ends` select mesh and coupling of CAD parts.
"""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeVar

import numpy as np

from lumped.arrays import Array
from lumped.dense.modes import FewerModesError
from lumped.equivalent_leg import sectioned_leg
from lumped.legs import GivenLeg, Leg
from lumped.mechanism.mechanism import Posture
from lumped.models.bodies import leg_of
from lumped.system.assembly import assembly
from lumped.system.sweep import swept
from validation.models.leg_models import (
    free_leg_frequencies,
    leg_compliance,
    leg_frequencies,
    sampled_solid_modes,
)
from validation.models.loads.displacements import displacements, displacements_of
from validation.models.options import ModelOptions
from validation.models.robot_models import (
    FINE_PARTS,
    PartMeshing,
    PostureModes,
    answers,
    mechanism_modes,
    reduced_parts_of,
    static_bodies,
)
from validation.references.mode_samples import samples_of
from validation.references.modes_on_path import vibration_of
from validation.references.reference_parts import interface_coupling
from validation.references.responses import Model
from validation.references.robot_on_path import Reading, RobotOnPath
from validation.responses.statics_and_modes import PathModes, Statics
from validation.solve.question import OF_ELEMENTS, Question

T = TypeVar("T")
# Fields of a reading that select meshes and couplings of solids.
_SOLID_FIELDS = ("mesh", "part_mesh", "ends")
# Frequency (Hz) for which CAD parts are reduced in statics, below all their modes.
_LOWEST = 1e-3
# Elements per leg for the effect of printed digits: for six modes it differs by a hundredth from
# that with 20.
_FEW_ELEMENTS = 6


@dataclass(frozen=True, eq=False)
class SolvedStatics(Statics):
    """Statics of a robot with the number of idle mobilities in each pose.

    None for a body alone.
    """

    idle: Sequence[int | None]


@dataclass(frozen=True, eq=False)
class SolvedModes(PathModes):
    """Modes of a robot with the solution of each pose, which has strain energies and damping."""

    postures: Sequence[PostureModes] = ()


def solved_model(question: Question, other_divisions: int | None = None) -> Model:
    """Model of a question. `other_divisions`: those of the second mesh of prisms."""
    fields = _SOLID_FIELDS if question.model == "solid" else ()
    return Model(
        question.model,
        statics=None if question.free else partial(_statics, question, other_divisions),
        modes=partial(_modes, question, other_divisions) if question.count else None,
        static_fields=fields,
        modal_fields=fields,
    )


def digits_model(question: Question, count: int) -> Model:
    """Model for the effect of printed digits on compliance and `count` frequencies.

    The model itself with few elements, beams instead of solids: the relative effect of a 6×6 is
    small and depends little on the model.
    """
    options = question.given
    if question.model == "solid":
        options = {name: options[name] for name in ("equivalent",) if name in options}
        question = replace(question, model="beam")
    if question.model in OF_ELEMENTS:
        options = {**options, "elements": min(question.options.elements, _FEW_ELEMENTS)}
    question = replace(question, given=options, modes=count or None, against=None)
    if question.alone is not None:
        return solved_model(replace(question, modes=count))

    def solve(robot: RobotOnPath) -> tuple[Array, Array]:
        solved = robot.context.get(answers, question.model, robot.postures, count, question.options)
        compliances = np.array([answer.compliance for answer in solved])
        return compliances, np.array([answer.frequencies for answer in solved])

    def statics(robot: RobotOnPath, _: Reading) -> Statics:
        return Statics(solve(robot)[0], np.zeros((len(robot.postures), 0, 6)))

    def modes(robot: RobotOnPath, _: Reading) -> PathModes:
        return _unsampled(solve(robot)[1])

    return Model(f"{question.model}, few elements", statics=statics, modes=modes)


def _unsampled(frequencies: Array) -> PathModes:
    """Modes without shapes, for models whose modes are not compared (P×m frequencies in Hz)."""
    samples = np.zeros((len(frequencies), 0, frequencies.shape[1]))
    return PathModes(frequencies, samples, np.zeros(0), np.ones_like(frequencies))


def _fewest(question: Question, solve: Callable[[int], T]) -> T | None:
    """Solution with the requested number of modes. Without a number, six or all if there are fewer.

    None if no mode is requested or none has mass.
    """
    if question.modes is not None:
        return solve(question.count) if question.count else None
    for count in range(question.count, 0, -1):
        with suppress(FewerModesError):
            return solve(count)
    return None


def _options(question: Question, other_divisions: int | None, reading: Reading) -> ModelOptions:
    """Model options on the mesh of prisms that a reading selects."""
    if reading.mesh or other_divisions is None:
        return question.options
    return replace(question.options, divisions=other_divisions)


def _part_mesh(robot: RobotOnPath, reading: Reading) -> PartMeshing:
    """Mesh level and coupling of CAD parts under a reading."""
    if not robot.mechanism.parts:
        return FINE_PARTS
    free = "free" in reading.ends.values()
    return PartMeshing(reading.part_mesh, interface_coupling("free" if free else "rigid"))


def _posture_modes(
    question: Question, robot: RobotOnPath, options: ModelOptions, part_mesh: PartMeshing
) -> list[PostureModes] | None:
    """Modes in each posture, computed once for statics and modes. None if nothing has mass."""
    return _fewest(
        question,
        lambda count: robot.context.get(
            mechanism_modes, question.model, robot.postures, count, options, part_mesh
        ),
    )


def _statics(
    question: Question, other_divisions: int | None, robot: RobotOnPath, reading: Reading
) -> SolvedStatics:
    options, model = _options(question, other_divisions, reading), question.model
    if question.alone is not None:
        leg, options = _leg(question.alone, robot, options)
        compliance = leg_compliance(model, leg, options)
        return SolvedStatics(compliance[None], np.zeros((1, 0, 6)), [None])
    part_mesh = _part_mesh(robot, reading)
    modes = _posture_modes(question, robot, options, part_mesh) or []
    if part_mesh != FINE_PARTS:
        return _part_statics(robot.postures, modes, options, part_mesh)
    solved = modes or answers(model, robot.postures, 0, options)
    return SolvedStatics(
        np.array([answer.compliance for answer in solved]),
        displacements(model, robot.postures, options),
        [answer.idle for answer in solved],
    )


def _part_statics(
    postures: tuple[Posture, ...],
    modes: Sequence[PostureModes],
    options: ModelOptions,
    part_mesh: PartMeshing,
) -> SolvedStatics:
    """Statics with CAD parts on another mesh or with another coupling."""
    mechanism = postures[0].mechanism
    if modes:
        bodies = dict(modes[0].system.models)
    else:
        parts = reduced_parts_of(mechanism, _LOWEST, options, part_mesh)
        bodies = static_bodies("solid", mechanism, options) | parts
    solved = swept(assembly(mechanism, bodies), postures, 0)
    return SolvedStatics(solved.compliances, displacements_of(bodies, postures), solved.idle)


def _modes(
    question: Question, other_divisions: int | None, robot: RobotOnPath, reading: Reading
) -> PathModes | None:
    options = _options(question, other_divisions, reading)
    if question.alone is not None:
        return _fewest(question, partial(_body_modes, question, question.alone, robot, options))
    modes = _posture_modes(question, robot, options, _part_mesh(robot, reading))
    if not modes:
        return None
    count = max(len(posture.modes.frequencies) for posture in modes)
    sampled = question.model == "solid" or question.against is not None
    vibration = (
        vibration_of(samples_of(robot.mechanism), modes, count)
        if sampled
        else _unsampled(np.array([padded(posture.modes.frequencies, count) for posture in modes]))
    )
    return SolvedModes(
        vibration.frequencies,
        vibration.samples,
        vibration.weights,
        vibration.energy_shares,
        postures=modes,
    )


def padded(values: Array, count: int) -> Array:
    """Numbers followed by NaN, `count` in all."""
    return np.pad(values, (0, count - len(values)), constant_values=np.nan)


def _body_modes(
    question: Question, name: str, robot: RobotOnPath, options: ModelOptions, count: int
) -> PathModes:
    leg, options = _leg(name, robot, options)
    if question.model == "solid":
        solid = sectioned_leg(leg, options.equivalent)
        return robot.context.get(sampled_solid_modes, solid, count, options, free=question.free)
    frequencies = free_leg_frequencies if question.free else leg_frequencies
    return _unsampled(frequencies(question.model, leg, count, options)[None])


def _leg(name: str, robot: RobotOnPath, options: ModelOptions) -> tuple[Leg, ModelOptions]:
    """Leg of a body, and model options with its own end condition, if the file specifies one."""
    leg = leg_of(robot.mechanism.bodies[name])
    if not isinstance(leg, GivenLeg) and leg.ends is not None:
        options = replace(options, ends=leg.ends)
    return leg, options
