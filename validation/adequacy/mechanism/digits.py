"""What the printed digits of a robot's 6×6 leave open of its displacements and frequencies.

The 6×6 that the robot really has is known within its digits alone, while every model takes the
number that is printed: what a model is off by is uncertain by as much, even where the reference is
assembled from the same number.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import qmc

from lumped.acceptance.requirement import STATIC_QUANTITIES
from lumped.arrays import Array
from lumped.legs import GivenLeg
from lumped.mechanism.body import Given
from lumped.mechanism.body_model import BodyModel
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import legs_of, tip_compliances
from lumped.models.links import links
from lumped.robot_file.reading import printed_compliances
from lumped.system.assembly import assembly
from lumped.system.solution import compliance, solved
from lumped.system.sweep import swept
from validation.adequacy.mechanism.legs import MASSES, leg_with_masses
from validation.adequacy.mechanism.parts import condensed_parts
from validation.adequacy.mechanism.samples import samples_of
from validation.adequacy.mechanism.vibration import vibration
from validation.adequacy.response import Vibration
from validation.agreement.displacement import sizes
from validation.models.legs import filled
from validation.models.mechanism import dynamic_bodies, highest_frequency
from validation.models.options import ModelOptions

# 512 points of Sobol: half-widths of one seed and another differ by 1 to 2 % of themselves.
_POWER = 9
# Of the size that an entry of a 6×6 can have: compliances and frequencies are linear in it so far.
_STEP = 1e-6
# Half a unit, of the size that its entry can have, that is not looked at: seven digits and more.
_NEGLIGIBLE = 1e-7
# Of shares of frequencies that digits leave open a hundredth does not matter.
_FEW_ELEMENTS = ModelOptions(elements=8)


def left_by_digits(text: str, postures: Sequence[Posture]) -> Array:
    """Half-widths (95 %, p×7, relative, of the displacement that each static quantity is of).

    `text` of the robot file. Every number is off by up to half a unit of its last digit, each value
    as likely as the other and independent of all others; the tool's compliance is linear in so
    small a change. Zero where no 6×6 of the file is the robot's.
    """
    own = _compliances(postures)
    changes = np.array(list(_changes(text, postures, _compliances)))
    if not len(changes):
        return np.zeros((len(postures), len(STATIC_QUANTITIES)))
    draws = 2.0 * qmc.Sobol(len(changes), seed=0).random_base2(_POWER) - 1.0
    off = np.tensordot(draws, changes, axes=1).reshape(-1, 6, 6)
    found = sizes(off, np.tile(own, (len(draws), 1, 1))).reshape(len(draws), len(postures), -1)
    # Where the robot is rigid no model's error is relative to anything.
    return np.quantile(np.where(np.isfinite(found), found, 0.0), 0.95, axis=0)


def most_by_digits(
    text: str, postures: Sequence[Posture], values: Callable[[Sequence[Posture]], Array]
) -> Array:
    """The most that `values` of the postures can be off by, to first order: all roundings add up.

    `text` of the robot file. Zero where no 6×6 of the file is the robot's, or `values` are
    infinite.
    """
    sizes = [np.abs(change) for change in _changes(text, postures, values)]
    return np.sum(sizes, axis=0) if sizes else np.zeros_like(values(postures))


def modes_by_digits(
    text: str, postures: tuple[Posture, ...], count: int
) -> tuple[Vibration, Array]:
    """Modes by beams, given legs by their own 6×6, and the share of each that digits leave open.

    At most, to first order (p×m), by the printed digits of the 6×6 in the `text` of the robot file.
    """
    mechanism = postures[0].mechanism
    highest = highest_frequency(postures, count)
    beams = dynamic_bodies("beam", mechanism, highest, _FEW_ELEMENTS)
    made: dict[bytes, BodyModel] = {}

    def bodies(of: Mechanism) -> dict[str, BodyModel]:
        models = dict(beams)
        for name, leg in legs_of(of).items():
            if isinstance(leg, GivenLeg):
                key = name.encode() + leg.compliance.tobytes()
                if key not in made:
                    made[key] = filled(
                        leg_with_masses(leg, MASSES[0], highest, _FEW_ELEMENTS.elements)
                    )
                models[name] = made[key]
        return models

    own = vibration(samples_of(mechanism), postures, bodies(mechanism), count)
    known = own.frequencies.shape[1]

    def frequencies(at: Sequence[Posture]) -> Array:
        of = at[0].mechanism
        return swept(assembly(of, bodies(of)), at, known).frequencies

    return own, most_by_digits(text, postures, frequencies) / own.frequencies


def _changes(
    text: str, postures: Sequence[Posture], values: Callable[[Sequence[Posture]], Array]
) -> Iterator[Array]:
    """What half a unit of each number changes in what `values` gives of the postures (SI).

    Bodies and joints for which the same 6×6 is printed have the same one. Numbers of seven digits
    and more are left out.
    """
    mechanism, own = postures[0].mechanism, None
    known = {printed.compliance.tobytes(): printed for printed in printed_compliances(text)}
    for printed in known.values():
        size = np.sqrt(np.diag(printed.compliance))
        counts = np.triu(printed.half) > _NEGLIGIBLE * np.outer(size, size)
        for i, j in zip(*np.nonzero(counts), strict=True):
            change = np.zeros((6, 6))
            change[i, j] = change[j, i] = step = _STEP * size[i] * size[j]
            changed = _with_change(mechanism, printed.compliance, change)
            if changed is not None:
                own = values(postures) if own is None else own
                moved = values([replace(at, mechanism=changed) for at in postures])
                finite = np.isfinite(own)
                off = np.subtract(moved, own, out=np.zeros_like(own), where=finite)
                yield off * (printed.half[i, j] / step)


def _compliances(postures: Sequence[Posture]) -> Array:
    """The robot (p×6×6, SI) of its legs as springs, 6×6 as given."""
    mechanism = postures[0].mechanism
    models = {**links(mechanism, tip_compliances(mechanism)), **condensed_parts(mechanism)}
    prepared = assembly(mechanism, models)
    return np.array([compliance(solved(prepared.at(posture))) for posture in postures])


def _with_change(mechanism: Mechanism, given: Array, change: Array) -> Mechanism | None:
    """The mechanism with a `change` of the `given` 6×6; None where nothing has that one."""
    bodies = {
        name: replace(body, shape=replace(body.shape, compliance=given + change))
        for name, body in mechanism.bodies.items()
        if isinstance(body.shape, Given) and np.array_equal(body.shape.compliance, given)
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
