"""A robot with its uncertain inputs off: what models then answer, and what they are held against.

Models are solved anew. The reference is carried along: what solids are above beams of the sections'
own constants, held alike, they stay above them for inputs a few per cent off. Of statics that is a
congruence C = T C_beams Tᵀ with T from both Cholesky factors, of every frequency a factor; where
the reference has no solids it is the same computation and nothing is carried.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial

import numpy as np
import scipy

from lumped.mechanism.mechanism import Mechanism
from validation.adequacy.mechanism.path import Reading, RobotOnPath, robot_at
from validation.adequacy.mechanism.solids import HELD, SOLID
from validation.adequacy.partners import partners
from validation.adequacy.references import PerturbedInputs, Subject
from validation.adequacy.responses import Model, Responses
from validation.agreement.responses import PathModes, Statics
from validation.context import Preset
from validation.kinematics.poses import postures_of
from validation.models.parts import unknowns_of, with_unknowns

# Robots with all inputs off at once, by which one at a time are checked.
_CHECKS: Mapping[Preset, int] = {"quick": 4, "standard": 8, "fine": 32}


def perturbed_inputs(subject: Subject) -> PerturbedInputs | None:
    """The robot with its uncertain inputs perturbed. None if the file names none.

    Raises InputError if there is no such robot.
    """
    robot = subject.responses.robot
    robot_file = robot.context.robot_file
    inputs = robot_file.uncertain_inputs
    if not inputs or subject.statics.model is None:
        return None
    unknowns = {name: unknowns_of(body) for name, body in robot.mechanism.parts.items()}

    def at(mechanism: Mechanism) -> Subject:
        mechanism = with_unknowns(mechanism, unknowns)
        postures = postures_of(mechanism, [posture.pose for posture in robot.postures])
        return _carried(subject, Responses(robot_at(robot.context, postures)))

    alone = robot_file.with_inputs_off()
    count = _CHECKS[robot.context.preset]
    draws = scipy.special.ndtri(scipy.stats.qmc.Sobol(len(inputs), seed=1).random(count))
    relative = np.array(list(inputs.values()))
    together = [
        at(robot_file.with_factors(dict(zip(inputs, row, strict=True)))) for row in draws * relative
    ]
    return PerturbedInputs(
        {one.key: one.relative for one in alone},
        [at(one.below) for one in alone],
        [at(one.above) for one in alone],
        draws,
        together,
    )


def _carried(subject: Subject, perturbed: Responses) -> Subject:
    """The subject with perturbed inputs: models are solved anew, references are carried along."""
    robot = perturbed.robot
    stand_in = HELD if robot.prisms or robot.mechanism.parts else SOLID
    carry = subject.responses, perturbed, stand_in
    carried = replace(
        SOLID,
        name="reference carried along",
        statics=partial(_carried_statics, *carry),
        modes=partial(_carried_modes, *carry),
    )
    statics, dynamics = (
        replace(reference, model=reference.model and carried)
        for reference in (subject.statics, subject.dynamics)
    )
    return replace(
        subject, responses=perturbed, statics=statics, dynamics=dynamics, parts=(), inputs=None
    )


def _carried_statics(
    nominal: Responses, perturbed: Responses, stand_in: Model, _: RobotOnPath, reading: Reading
) -> Statics:
    return _congruent(
        nominal.required_statics(SOLID, reading),
        nominal.required_statics(stand_in, reading),
        perturbed.required_statics(stand_in, reading),
    )


def _carried_modes(
    nominal: Responses, perturbed: Responses, stand_in: Model, _: RobotOnPath, reading: Reading
) -> PathModes:
    return _scaled(
        nominal.required_modes(SOLID, reading),
        nominal.required_modes(stand_in, reading),
        perturbed.required_modes(stand_in, reading),
    )


def _congruent(reference: Statics, own: Statics, off: Statics) -> Statics:
    """The reference with the changes of the beams from `own` to `off`.

    Displacements under loads change by T times the change of the beams'.
    """
    change = off - own
    try:
        lower = np.linalg.cholesky(reference.compliances)
        lower = lower @ np.linalg.inv(np.linalg.cholesky(own.compliances))
    except np.linalg.LinAlgError:
        # Directions in which the robot is rigid: both are the same there.
        return Statics(
            reference.compliances + change.compliances,
            reference.load_displacements + change.load_displacements,
        )
    upper = np.swapaxes(lower, 1, 2)
    return Statics(
        lower @ off.compliances @ upper,
        reference.load_displacements + change.load_displacements @ upper,
    )


def _scaled(reference: PathModes, own: PathModes, off: PathModes) -> PathModes:
    """Modes of the reference, each as much higher as the beams' mode of its shape has become.

    The peaks of responses likewise.
    """
    count = min(one.frequencies.shape[1] for one in (reference, own, off))
    number = partners(reference, own, count).number
    number = np.where(number >= 0, number, np.arange(count))
    ratio = np.take_along_axis(off.frequencies[:, :count] / own.frequencies[:, :count], number, 1)
    with np.errstate(invalid="ignore"):
        peaks = reference.peaks * (off.peaks / own.peaks)
    return replace(
        reference,
        frequencies=reference.frequencies[:, :count] * ratio,
        samples=reference.samples[:, :, :count],
        seen=reference.seen[:, :count],
        peaks=peaks,
    )
