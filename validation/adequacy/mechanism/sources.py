"""Uncertainty of references by all sources but meshes: a row for each source.

The 6×6 that a robot really has is known within its printed digits alone, while every model takes
the number that is printed. The error of a model is uncertain by as much, even if the reference is
assembled from the same number.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from lumped.acceptance.quantities import UNIT_LOADS
from lumped.arrays import Array, SparseMatrix
from lumped.legs import GivenLeg
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import legs_of, tip_compliances
from lumped.robot_file.reading import Printed
from lumped.system.assembly import assembly
from validation.adequacy.mechanism.parts import assembled
from validation.adequacy.mechanism.path import Reading, RobotOnPath
from validation.adequacy.mechanism.samples import samples_of
from validation.adequacy.mechanism.solids import SOLID
from validation.adequacy.mechanism.vibration import vibration_of
from validation.adequacy.references import Source
from validation.adequacy.responses import Model, Responses
from validation.agreement.combiners import Combiner, combined
from validation.agreement.displacement import sizes
from validation.agreement.responses import PathModes, Statics
from validation.models.loads.leg_masses import (
    Inside,
    Masses,
    by_shapes,
    plausible_masses,
    shapes_inside,
)
from validation.models.mechanism import dynamic_bodies, highest_frequency, modes_along
from validation.models.options import ModelOptions
from validation.models.roundings import roundings_of

# Of shares of frequencies that digits leave open a hundredth does not matter.
_FEW_ELEMENTS = ModelOptions(elements=8)
# Perturbed readings, each with a factor on the change from the reading that is perturbed.
Perturbed = Sequence[tuple[float, Reading]]


@dataclass(frozen=True)
class SourceRow:
    """Source of uncertainty: a model under perturbed readings, and the rule for their changes.

    `readings` of a robot perturb a reading of it.
    """

    source: Source
    model: Model
    readings: Callable[[RobotOnPath, Reading], Perturbed]
    combiner: Combiner

    def half_widths(self, responses: Responses, reading: Reading) -> Array:
        """Relative half-widths of displacements (P×(7+L)). Zero if nothing is perturbed."""
        robot = responses.robot
        perturbed = self.readings(robot, reading)
        if not perturbed:
            return np.zeros((len(robot.postures), len(UNIT_LOADS) + len(robot.mechanism.loads)))
        own = responses.required_statics(self.model, reading)
        changes = [
            factor * _flat(responses.required_statics(self.model, one) - own)
            for factor, one in perturbed
        ]
        return combined(np.array(changes), partial(_sizes, own), self.combiner)


def _flat(statics: Statics) -> Array:
    """All numbers of statics (P×k)."""
    poses = len(statics.compliances)
    return np.hstack(
        [one.reshape(poses, -1) for one in (statics.compliances, statics.load_displacements)]
    )


def _sizes(own: Statics, changes: Array) -> Array:
    """Sizes (n×P×(7+L)) of changes (n×P×k) relative to a robot's own displacements.

    Zero if the robot is rigid: the error of a model is relative to nothing there.
    """
    count, poses, _ = changes.shape
    loads = own.load_displacements.shape[1]
    compliances, load_displacements = np.split(changes, [36], axis=2)
    # All changes in all poses, as poses of one record.
    changed = Statics(
        compliances.reshape(count * poses, 6, 6),
        load_displacements.reshape(count * poses, loads, 6),
    )
    repeated = Statics(
        np.tile(own.compliances, (count, 1, 1)), np.tile(own.load_displacements, (count, 1, 1))
    )
    found = sizes(changed, repeated).reshape(count, poses, -1)
    return np.where(np.isfinite(found), found, 0.0)


def _rounded(robot: RobotOnPath, reading: Reading) -> Perturbed:
    """Each printed digit of a 6×6 off by half a unit; none if no 6×6 of the file is the robot's."""
    return [
        (rounding.factor, replace(reading, rounding=number))
        for number, rounding in enumerate(robot.roundings)
    ]


def _plausible(robot: RobotOnPath, reading: Reading) -> Perturbed:
    """Every plausible mass distribution of the legs known by their 6×6."""
    return [
        (1.0, replace(reading, masses=masses)) for masses in plausible_masses(robot.given.values())
    ]


def _links(robot: RobotOnPath, _: Reading) -> Statics:
    """Statics with legs as given and parts condensed, once per run and process."""
    return robot.context.get(_linked, robot.postures)


def _linked(postures: tuple[Posture, ...]) -> Statics:
    return assembled(postures, tip_compliances(postures[0].mechanism))


# Each number is off by up to half a unit of its last digit, independently of all others.
DIGITS = SourceRow(Source.DIGITS, Model("links", statics=_links), _rounded, Combiner.PROBABILITY)
# Displacements under a load on masses are linear in the places of mass: any between these.
MASSES = SourceRow(Source.MASSES, SOLID, _plausible, Combiner.HULL)


def modes_by_digits(
    printed: Sequence[Printed], postures: tuple[Posture, ...], count: int, masses: Masses
) -> tuple[PathModes, Array] | None:
    """Modes by beams, given legs by their own 6×6, and relative half-widths (p×m) due to digits.

    All changes by the digits of the `printed` 6×6 together, to first order. None without any.
    """
    roundings = roundings_of(printed, postures)
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
    changes = []
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
                moved = system.body_unknowns(name, shapes)
                stiffer[at] += _energies(leg.stiffness - own[name].stiffness, moved)
                heavier[at] += _energies(leg.mass - own[name].mass, moved)
            for joint, other in zip(mechanism.joints, of.joints, strict=True):
                # What a spring stores where its ends are held falls by λᵀ dC λ.
                if joint.compliance is not None and other is not joint:
                    softer = np.asarray(other.compliance) - joint.compliance
                    stiffer[at] -= _energies(softer, system.wrenches(joint, shapes))
        # Rayleigh's quotient of the shapes as they are, exact to first order; half for its root.
        changes.append(rounding.factor * 0.5 * (stiffer / stiffness - heavier / mass))
    half_widths = combined(np.array(changes), np.abs, Combiner.LINEAR_SUM)
    return found, np.pad(half_widths, ((0, 0), (0, count - known)))


def _given_legs(mechanism: Mechanism) -> dict[str, GivenLeg]:
    return {k: leg for k, leg in legs_of(mechanism).items() if isinstance(leg, GivenLeg)}


def _energies(matrix: Array | SparseMatrix, shapes: Array) -> Array:
    """φᵀAφ of every shape (n×m)."""
    return np.asarray(np.sum(shapes * (matrix @ shapes), axis=0))
