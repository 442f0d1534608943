"""Robots with a small change of one printed number of a 6×6 compliance, for effects of rounding.

Input: the printed 6×6 compliances of a robot file and the postures of the robot. Output: for each
number of a compliance, the postures with a small change of it, and the factor that converts this
change to half a unit of the number's last digit. Numbers with nine digits or more are omitted.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from lumped.arrays import Array
from lumped.legs import GivenLeg
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.robot_file.reading import Printed

# Change of an entry of a 6×6, relative to its largest possible size. Compliances and frequencies
# are linear in it.
_STEP = 1e-6
# Half a unit of the last digit, relative to the same size, below which a number is omitted, as it
# has nine digits or more.
_NEGLIGIBLE = 1e-9


class Rounding(NamedTuple):
    """Postures of a robot in which one number of a 6×6 compliance is slightly changed.

    Half a unit of the number's last digit is `factor` times the change.
    """

    postures: list[Posture]
    factor: float


def roundings_of(compliances: Iterable[Printed], postures: Sequence[Posture]) -> list[Rounding]:
    """Postures with one number slightly changed, for each number of the compliances in use.

    `compliances` are the printed 6×6 compliances of the robot file. Bodies and joints with equal
    compliances are changed together.
    """
    mechanism, roundings = postures[0].mechanism, []
    distinct = {printed.compliance.tobytes(): printed for printed in compliances}
    for printed in distinct.values():
        size = np.sqrt(np.diag(printed.compliance))
        significant = np.triu(printed.half) > _NEGLIGIBLE * np.outer(size, size)
        for i, j in zip(*np.nonzero(significant), strict=True):
            change = np.zeros((6, 6))
            change[i, j] = change[j, i] = step = _STEP * size[i] * size[j]
            perturbed_mechanism = _with_change(mechanism, printed.compliance, change)
            if perturbed_mechanism is not None:
                perturbed = [
                    replace(posture, mechanism=perturbed_mechanism) for posture in postures
                ]
                roundings.append(Rounding(perturbed, printed.half[i, j] / step))
    return roundings


def _with_change(mechanism: Mechanism, compliance: Array, change: Array) -> Mechanism | None:
    """Mechanism with a `change` of the 6×6 `compliance`. None if no body or joint has it."""
    bodies = {
        name: replace(body, shape=replace(body.shape, compliance=compliance + change))
        for name, body in mechanism.bodies.items()
        if isinstance(body.shape, GivenLeg) and np.array_equal(body.shape.compliance, compliance)
    }
    has_compliance = [
        joint.compliance is not None and np.array_equal(joint.compliance, compliance)
        for joint in mechanism.joints
    ]
    if not bodies and not any(has_compliance):
        return None
    joints = [
        replace(joint, compliance=compliance + change) if matches else joint
        for joint, matches in zip(mechanism.joints, has_compliance, strict=True)
    ]
    return replace(mechanism, bodies={**mechanism.bodies, **bodies}, joints=joints)
