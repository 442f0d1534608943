"""What the printed digits of a robot's 6×6 leave open of its displacements and frequencies.

The 6×6 that the robot really has is known within its digits alone, while every model takes the
number that is printed: what a model is off by is uncertain by as much, even where the reference is
assembled from the same number.
"""

from collections.abc import Sequence

import numpy as np
from scipy.stats import qmc

from lumped.acceptance.requirement import STATIC_QUANTITIES
from lumped.arrays import Array
from lumped.legs import GivenLeg
from lumped.mechanism.body_model import BodyModel
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import legs_of, tip_compliances
from lumped.system.assembly import assembly
from validation.adequacy.mechanism.parts import assembled
from validation.adequacy.mechanism.samples import samples_of
from validation.adequacy.mechanism.vibration import vibration_of
from validation.adequacy.response import Vibration
from validation.agreement.displacement import sizes
from validation.models.loads.leg_masses import Masses, by_shapes, shapes_inside
from validation.models.mechanism import dynamic_bodies, highest_frequency, modes_along
from validation.models.options import ModelOptions
from validation.models.roundings import changes_by_digits, roundings_of, share_by_digits

# 512 points of Sobol: half-widths of one seed and another differ by 1 to 2 % of themselves.
_POWER = 9
# Of shares of frequencies that digits leave open a hundredth does not matter.
_FEW_ELEMENTS = ModelOptions(elements=8)


def left_by_digits(text: str, postures: Sequence[Posture]) -> Array:
    """Half-widths (95 %, p×7, relative, of the displacement that each static quantity is of).

    `text` of the robot file. Every number is off by up to half a unit of its last digit, each value
    as likely as the other and independent of all others; the tool's compliance is linear in so
    small a change. Zero where no 6×6 of the file is the robot's.
    """
    roundings = roundings_of(text, postures)
    if not roundings:
        return np.zeros((len(postures), len(STATIC_QUANTITIES)))

    def own_legs(at: Sequence[Posture]) -> Array:
        return assembled(at, tip_compliances(at[0].mechanism))

    own = own_legs(postures)
    changes = np.array(list(changes_by_digits(roundings, own, own_legs)))
    draws = 2.0 * qmc.Sobol(len(changes), seed=0).random_base2(_POWER) - 1.0
    off = np.tensordot(draws, changes, axes=1).reshape(-1, 6, 6)
    found = sizes(off, np.tile(own, (len(draws), 1, 1))).reshape(len(draws), len(postures), -1)
    # Where the robot is rigid no model's error is relative to anything.
    return np.quantile(np.where(np.isfinite(found), found, 0.0), 0.95, axis=0)


def modes_by_digits(
    text: str, postures: tuple[Posture, ...], count: int, masses: Masses
) -> tuple[Vibration, Array] | None:
    """Modes by beams, given legs by their own 6×6, and the share of each that digits leave open.

    At most, to first order (p×m), by the printed digits of the 6×6 in the `text` of the robot file;
    None where these leave nothing.
    """
    roundings = roundings_of(text, postures)
    if not roundings:
        return None
    mechanism = postures[0].mechanism
    highest = highest_frequency(postures, count)
    beams = dynamic_bodies("beam", mechanism, highest, _FEW_ELEMENTS)
    given = {k: leg for k, leg in legs_of(mechanism).items() if isinstance(leg, GivenLeg)}
    few = _FEW_ELEMENTS.elements
    shapes = {name: shapes_inside(leg, masses, highest, few) for name, leg in given.items()}

    def bodies(of: Mechanism) -> dict[str, BodyModel]:
        return beams | {
            name: by_shapes(shapes[name], leg, masses, few)
            for name, leg in legs_of(of).items()
            if isinstance(leg, GivenLeg)
        }

    along = list(modes_along(assembly(mechanism, bodies(mechanism)), postures, count))
    own = vibration_of(samples_of(mechanism), along, count)
    known = int(np.isfinite(own.frequencies).sum(axis=1).min())

    def frequencies(at: Sequence[Posture]) -> Array:
        """By Rayleigh's quotient of the shapes as they are: exact to first order."""
        of = at[0].mechanism
        prepared, found = assembly(of, bodies(of)), []
        for posture, one in zip(at, along, strict=True):
            system, shapes = prepared.at(posture), one.modes.shapes[:, :known]
            stiffness, mass = (
                np.sum(shapes * (matrix @ shapes), axis=0)
                for matrix in (system.stiffness, system.mass)
            )
            found.append(np.sqrt(stiffness / mass) / (2.0 * np.pi))
        return np.array(found)

    share = share_by_digits(roundings, postures, frequencies)
    return own, np.pad(share, ((0, 0), (0, count - known)))
