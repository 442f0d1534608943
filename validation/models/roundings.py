"""What half a unit of each printed digit of a robot's 6×6 changes in what a model computes."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from lumped.arrays import Array
from lumped.legs import GivenLeg
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.robot_file.reading import Printed

# Of the size that an entry of a 6×6 can have: compliances and frequencies are linear in it so far.
_STEP = 1e-6
# Half a unit, of the size that its entry can have, that is not looked at: nine digits and more.
_NEGLIGIBLE = 1e-9


class Rounding(NamedTuple):
    """The postures with one number of a 6×6 a little off, of which `factor` is half a unit."""

    postures: list[Posture]
    factor: float


def roundings_of(compliances: Iterable[Printed], postures: Sequence[Posture]) -> list[Rounding]:
    """One for every number of the `compliances` of a robot file that are the robot's.

    Bodies and joints for which the same 6×6 is printed have the same one. Numbers of nine digits
    and more are left out.
    """
    mechanism, found = postures[0].mechanism, []
    known = {printed.compliance.tobytes(): printed for printed in compliances}
    for printed in known.values():
        size = np.sqrt(np.diag(printed.compliance))
        counts = np.triu(printed.half) > _NEGLIGIBLE * np.outer(size, size)
        for i, j in zip(*np.nonzero(counts), strict=True):
            change = np.zeros((6, 6))
            change[i, j] = change[j, i] = step = _STEP * size[i] * size[j]
            changed = _with_change(mechanism, printed.compliance, change)
            if changed is not None:
                moved = [replace(at, mechanism=changed) for at in postures]
                found.append(Rounding(moved, printed.half[i, j] / step))
    return found


def _with_change(mechanism: Mechanism, given: Array, change: Array) -> Mechanism | None:
    """The mechanism with a `change` of the `given` 6×6; None where nothing has that one."""
    bodies = {
        name: replace(body, shape=replace(body.shape, compliance=given + change))
        for name, body in mechanism.bodies.items()
        if isinstance(body.shape, GivenLeg) and np.array_equal(body.shape.compliance, given)
    }
    elastic = [
        joint.compliance is not None and np.array_equal(joint.compliance, given)
        for joint in mechanism.joints
    ]
    if not bodies and not any(elastic):
        return None
    joints = [
        replace(joint, compliance=given + change) if gives else joint
        for joint, gives in zip(mechanism.joints, elastic, strict=True)
    ]
    return replace(mechanism, bodies={**mechanism.bodies, **bodies}, joints=joints)
