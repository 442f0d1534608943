"""A robot with its uncertain inputs off: what models then answer, and what they are held against.

Models are solved anew. The reference is carried along: what solids are above beams of the sections'
own constants, held alike, they stay above them for inputs a few per cent off. Of statics that is a
congruence C = T C_beams Tᵀ with T from both Cholesky factors, of every frequency a factor; where
the reference has no solids it is the same computation and nothing is carried.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import product

import numpy as np
import scipy

from lumped.mechanism.mechanism import Mechanism
from validation.adequacy.mechanism.legs import held_spring
from validation.adequacy.mechanism.parts import assembled
from validation.adequacy.mechanism.path import Holds, RobotOnPath, RobotReading, robot_at
from validation.adequacy.mechanism.vibration import (
    modes_of_own_beams,
    modes_of_solids,
)
from validation.adequacy.models import JudgedModel, modes_by, statics_by
from validation.adequacy.partners import partners
from validation.adequacy.response import (
    InputOff,
    InputsOff,
    Response,
    Subject,
    modes_of,
)
from validation.agreement.responses import PathModes, Statics
from validation.context import Preset
from validation.kinematics.poses import postures_of
from validation.models.loads.leg_masses import plausible_insides
from validation.models.parts import unknowns_of, with_unknowns

# Robots with all inputs off at once, by which one at a time are checked.
_CHECKS: Mapping[Preset, int] = {"quick": 4, "standard": 8, "fine": 32}


def inputs_off(
    robot: RobotOnPath, subject: Subject, models: Mapping[str, JudgedModel]
) -> InputsOff | None:
    """The robot with its uncertain inputs off; None where the file names none.

    Raises InputError where there is no such robot.
    """
    robot_file = robot.context.robot_file
    inputs = robot_file.uncertain_inputs
    if not inputs or not subject.statics.alternatives:
        return None
    own = _beams(robot)
    unknowns = {name: unknowns_of(body) for name, body in robot.mechanism.parts.items()}

    def at(mechanism: Mechanism) -> Subject:
        mechanism = with_unknowns(mechanism, unknowns)
        postures = postures_of(mechanism, [posture.pose for posture in robot.postures])
        off = robot_at(robot.context, postures)
        return _carried(subject, off, models, own, _beams(off))

    alone = [
        InputOff(one.key, one.relative, at(one.below), at(one.above))
        for one in robot_file.with_inputs_off()
    ]
    count = _CHECKS[robot.context.preset]
    draws = scipy.special.ndtri(scipy.stats.qmc.Sobol(len(inputs), seed=1).random(count))
    relative = np.array(list(inputs.values()))
    together = [
        at(robot_file.with_factors(dict(zip(inputs, row, strict=True)))) for row in draws * relative
    ]
    return InputsOff(alone, draws, together)


@dataclass(frozen=True, eq=False)
class _Beams:
    """What stands for the references: one for every alternative, in their order."""

    statics: Sequence[Statics]
    modes: Sequence[PathModes | None]


def _beams(robot: RobotOnPath) -> _Beams:
    holds = tuple(robot.holding.alternatives.values())
    insides = plausible_insides(robot.given.values())
    return _Beams(
        [_statics(robot, ends) for ends in holds],
        [
            Response(
                modes=modes_of(
                    partial(modes_of_solids, robot, RobotReading(ends, inside))
                    if not robot.prisms and not robot.mechanism.parts
                    else partial(modes_of_own_beams, robot, ends)
                )
            ).solved_modes
            for ends, inside in product(holds, insides)
        ],
    )


def _statics(robot: RobotOnPath, ends: Holds) -> Statics:
    springs = {
        name: held_spring(robot.context, leg, ends[name]) for name, leg in robot.legs.items()
    }
    return assembled(robot.postures, springs)


def _carried(
    subject: Subject,
    robot: RobotOnPath,
    models: Mapping[str, JudgedModel],
    own: _Beams,
    off: _Beams,
) -> Subject:
    statics = [
        replace(one, response=Response(_congruent(statics, *beams)))
        for one, *beams in zip(subject.statics.alternatives, own.statics, off.statics, strict=True)
        if (statics := one.response.solved_statics) is not None
    ]
    dynamics = [
        replace(one, response=Response(modes=_scaled(one.response.solved_modes, *beams)))
        for one, *beams in zip(subject.dynamics.alternatives, own.modes, off.modes, strict=False)
    ]
    candidates = [
        replace(one, response=Response(statics_by(robot, of), modes_by(robot, of)))
        for one in subject.candidates
        for of in [models[one.model]]
    ]
    return replace(
        subject,
        candidates=candidates,
        statics=replace(subject.statics, alternatives=statics),
        dynamics=replace(subject.dynamics, alternatives=dynamics),
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


def _scaled(
    reference: PathModes | None, own: PathModes | None, off: PathModes | None
) -> PathModes | None:
    """Modes of the reference, each as much higher as the beams' mode of its shape has become.

    The peaks of responses likewise.
    """
    if reference is None or own is None or off is None:
        return None
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
