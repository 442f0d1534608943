"""What the printed digits of a robot's 6×6 leave open of its displacements and frequencies.

The 6×6 that the robot really has is known within its digits alone, while every model takes the
number that is printed: what a model is off by is uncertain by as much, even where the reference is
assembled from the same number.
"""

from collections.abc import Sequence

import numpy as np
import scipy

from lumped.acceptance.quantities import UNIT_LOADS
from lumped.arrays import Array, SparseMatrix
from lumped.legs import GivenLeg
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import legs_of, tip_compliances
from lumped.system.assembly import assembly
from validation.adequacy.mechanism.parts import assembled
from validation.adequacy.mechanism.samples import samples_of
from validation.adequacy.mechanism.vibration import vibration_of
from validation.agreement.displacement import sizes
from validation.agreement.responses import PathModes, Statics
from validation.models.loads.leg_masses import Inside, Masses, by_shapes, shapes_inside
from validation.models.mechanism import dynamic_bodies, highest_frequency, modes_along
from validation.models.options import ModelOptions
from validation.models.roundings import roundings_of

# 512 points of Sobol: half-widths of one seed and another differ by 1 to 2 % of themselves.
_POWER = 9
# Of shares of frequencies that digits leave open a hundredth does not matter.
_FEW_ELEMENTS = ModelOptions(elements=8)


def left_by_digits(text: str, postures: Sequence[Posture]) -> Array:
    """Half-widths (95 %, p×(7+l), relative, of the displacement that each static quantity is of).

    `text` of the robot file. Every number is off by up to half a unit of its last digit, each value
    as likely as the other and independent of all others; the tool's compliance is linear in so
    small a change. Zero where no 6×6 of the file is the robot's.
    """
    roundings = roundings_of(text, postures)
    if not roundings:
        loads = len(postures[0].mechanism.loads)
        return np.zeros((len(postures), len(UNIT_LOADS) + loads))

    own = assembled(postures, tip_compliances(postures[0].mechanism))
    changes = [
        one.factor * (assembled(one.postures, tip_compliances(one.postures[0].mechanism)) - own)
        for one in roundings
    ]
    draws = 2.0 * scipy.stats.qmc.Sobol(len(changes), seed=0).random_base2(_POWER) - 1.0
    # All draws in all poses, as poses of one record.
    compliances, load_displacements = (
        np.tensordot(draws, parts, axes=1).reshape(len(draws) * len(postures), *parts.shape[2:])
        for parts in (
            np.array([one.compliances for one in changes]),
            np.array([one.load_displacements for one in changes]),
        )
    )
    repeated = Statics(
        np.tile(own.compliances, (len(draws), 1, 1)),
        np.tile(own.load_displacements, (len(draws), 1, 1)),
    )
    off = Statics(compliances, load_displacements)
    found = sizes(off, repeated).reshape(len(draws), len(postures), -1)
    # Where the robot is rigid no model's error is relative to anything.
    return np.quantile(np.where(np.isfinite(found), found, 0.0), 0.95, axis=0)


def modes_by_digits(
    text: str, postures: tuple[Posture, ...], count: int, masses: Masses
) -> tuple[PathModes, Array] | None:
    """Modes by beams, given legs by their own 6×6, and the share of each that digits leave open.

    At most, to first order (p×m), by the printed digits of the 6×6 in the `text` of the robot file;
    None where these leave nothing.
    """
    roundings = roundings_of(text, postures)
    if not roundings:
        return None
    mechanism = postures[0].mechanism
    highest, few = highest_frequency(postures, count), _FEW_ELEMENTS.elements
    given, inside = _given_legs(mechanism), Inside(masses)
    shapes_of = {name: shapes_inside(leg, inside, highest, few) for name, leg in given.items()}
    own = {name: by_shapes(shapes_of[name], leg, inside, few) for name, leg in given.items()}
    beams = dynamic_bodies("beam", mechanism, highest, _FEW_ELEMENTS)
    along = list(modes_along(assembly(mechanism, {**beams, **own}), postures, count))
    found = vibration_of(samples_of(mechanism), along, count)
    known = int(np.isfinite(found.frequencies).sum(axis=1).min())
    modes = [(one.system, one.modes.shapes[:, :known]) for one in along]
    stiffness = np.array([_energies(system.stiffness, shapes) for system, shapes in modes])
    mass = np.array([_energies(system.mass, shapes) for system, shapes in modes])
    most = np.zeros_like(stiffness)
    for rounding in roundings:
        of = rounding.postures[0].mechanism
        changed = {
            name: by_shapes(shapes_of[name], leg, inside, few)
            for name, leg in _given_legs(of).items()
            if leg is not given[name]
        }
        stiffer, heavier = np.zeros_like(stiffness), np.zeros_like(mass)
        for at, (system, shapes) in enumerate(modes):
            for name, leg in changed.items():
                moved = system.own(name, shapes)
                stiffer[at] += _energies(leg.stiffness - own[name].stiffness, moved)
                heavier[at] += _energies(leg.mass - own[name].mass, moved)
            for joint, other in zip(mechanism.joints, of.joints, strict=True):
                # What a spring stores where its ends are held falls by λᵀ dC λ.
                if joint.compliance is not None and other is not joint:
                    softer = np.asarray(other.compliance) - joint.compliance
                    stiffer[at] -= _energies(softer, system.wrenches(joint, shapes))
        # Rayleigh's quotient of the shapes as they are, exact to first order; half for its root.
        most += rounding.factor * 0.5 * np.abs(stiffer / stiffness - heavier / mass)
    return found, np.pad(most, ((0, 0), (0, count - known)))


def _given_legs(mechanism: Mechanism) -> dict[str, GivenLeg]:
    return {k: leg for k, leg in legs_of(mechanism).items() if isinstance(leg, GivenLeg)}


def _energies(matrix: Array | SparseMatrix, shapes: Array) -> Array:
    """φᵀAφ of every shape (n×m)."""
    return np.asarray(np.sum(shapes * (matrix @ shapes), axis=0))
