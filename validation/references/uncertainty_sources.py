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
from validation.case import failure_reason
from validation.models.loads.leg_masses import (
    Inside,
    Masses,
    by_shapes,
    plausible_masses,
    shapes_inside,
)
from validation.models.loads.stability import stabilities
from validation.models.options import ModelOptions
from validation.models.robot_models import dynamic_bodies, highest_frequency, modes_along
from validation.models.roundings import roundings_of
from validation.references.mesh_uncertainty import (
    displacement_half_widths,
    frequency_half_widths,
    response_half_widths,
)
from validation.references.mode_samples import samples_of
from validation.references.model_ladder import SOLID
from validation.references.modes_on_path import vibration_of
from validation.references.reference import Budget, HalfWidths, Source
from validation.references.reference_parts import assembled
from validation.references.responses import Model, Responses
from validation.references.robot_on_path import Reading, RobotOnPath
from validation.responses.displacement import sizes
from validation.responses.mode_partners import amounts_by_shape
from validation.responses.statics_and_modes import PathModes, Statics
from validation.uncertainty.combiners import Combiner, combined

# Of shares of frequencies that digits leave open a hundredth does not matter.
_FEW_ELEMENTS = ModelOptions(elements=8)
# A displacement that a load's own softening changes by less is a linear one.
_LINEAR = 1e-3
# m/N: a logarithm has no zero.
_NO_SIZE = 1e-30
# Perturbed readings, each with a factor on the change from the reading that is perturbed.
Perturbed = Sequence[tuple[float, Reading]]


@dataclass(frozen=True)
class SourceRow:
    """Source of uncertainty of a reference, with half-widths by responses under a reading.

    `applies` to a robot, or leaves nothing open.
    """

    source: Source
    applies: Callable[[RobotOnPath], bool]
    half_widths: Callable[[Responses, Reading], HalfWidths]


@dataclass(frozen=True)
class Perturbations:
    """Half-widths of displacements by a model under perturbed readings.

    `readings` of a robot perturb a reading of it; `combiner` is the rule for their changes.
    """

    model: Model
    readings: Callable[[RobotOnPath, Reading], Perturbed]
    combiner: Combiner

    def __call__(self, responses: Responses, reading: Reading) -> HalfWidths:
        """Half-widths under a reading, relative to the model's own displacements."""
        own = responses.required_statics(self.model, reading)
        changes = [
            factor * _flat(responses.required_statics(self.model, one) - own)
            for factor, one in self.readings(responses.robot, reading)
        ]
        return HalfWidths(combined(np.array(changes), partial(_sizes, own), self.combiner))


def budget(rows: Sequence[SourceRow], responses: Responses, reading: Reading) -> Budget:
    """Half-widths of a reference under a reading by source."""
    robot = responses.robot
    return {row.source: row.half_widths(responses, reading) for row in rows if row.applies(robot)}


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
STATIC_DIGITS = Perturbations(Model("links", statics=_links), _rounded, Combiner.PROBABILITY)
# Displacements under a load on masses are linear in the places of mass: any between these.
_MASSES = Perturbations(SOLID, _plausible, Combiner.HULL)


def _linearity(responses: Responses, _: Reading) -> HalfWidths:
    """Change of the stiffness by the loads that act on it, if it is not negligible.

    All of it if the robot has buckled, and if the stability cannot be computed.
    """
    robot = responses.robot
    try:
        found = robot.context.get(stabilities, "links", robot.postures)
    except Exception as error:  # noqa: BLE001  loses no model: it leaves their errors open
        failure_reason("stability under loads", error)
        left = np.ones((len(robot.postures), len(robot.mechanism.loads)))
    else:
        farther = np.array(
            [[abs(one.extra_displacement) if one else 0.0 for one in row] for row in found]
        )
        left = np.nan_to_num(farther, nan=1.0)
    left[left < _LINEAR] = 0.0
    return HalfWidths(np.pad(left, ((0, 0), (len(UNIT_LOADS), 0))))


def modes_by_digits(
    printed: Sequence[Printed], postures: tuple[Posture, ...], count: int, masses: Masses
) -> tuple[PathModes, Array]:
    """Modes by beams, given legs by their own 6×6, and relative half-widths (p×m) due to digits.

    All changes by the digits of the `printed` 6×6 together, to first order.
    """
    roundings = roundings_of(printed, postures)
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


def _displacement_meshes(responses: Responses, reading: Reading) -> HalfWidths:
    return HalfWidths(displacement_half_widths(responses, reading))


def _modal_meshes(responses: Responses, reading: Reading) -> HalfWidths:
    """Half-widths of modes and of responses to harmonic forces due to meshes."""
    frequencies = frequency_half_widths(responses, reading)
    excitations = responses.robot.mechanism.excitations
    if not excitations:
        return HalfWidths(frequencies=frequencies)
    return HalfWidths(
        frequencies=frequencies,
        peaks=response_half_widths(responses, reading, _peaks),
        receptances=[
            response_half_widths(responses, reading, partial(_receptance_sizes, number))
            for number in range(len(excitations))
        ],
    )


def _modal_digits(responses: Responses, reading: Reading) -> HalfWidths:
    """Half-widths of modes and of responses to harmonic forces due to printed digits."""
    robot, fine = responses.robot, responses.required_modes(SOLID, reading)
    digits = _digits_of_frequencies(robot, fine, reading.masses)
    if not robot.mechanism.excitations:
        return HalfWidths(frequencies=digits)
    peaks, receptances = _digits_of_responses(robot, fine, digits)
    return HalfWidths(frequencies=digits, peaks=peaks, receptances=receptances)


def _peaks(modes: PathModes) -> Array:
    return modes.peaks


def _receptance_sizes(excitation: int, modes: PathModes) -> Array:
    return np.abs(modes.receptances[excitation])


def _digits_of_responses(
    robot: RobotOnPath, fine: PathModes, digits: Array
) -> tuple[Array, list[Array]]:
    """Half-widths of peaks (P×q) and receptances (P×n each) by `digits` of frequencies (P×K)."""
    of_peaks: list[Array] = []
    receptances = []
    for number, one in enumerate(robot.mechanism.excitations):
        peak = fine.peaks[:, [len(of_peaks) + 1]]
        nearest, left = _left_by_digits(
            fine, digits, one.frequencies, _receptance_sizes(number, fine), peak
        )
        of_peaks += [2.0 * nearest, nearest]
        if one.at is not None:
            of_peaks.append(np.array([np.interp(one.at, one.frequencies, row) for row in left]))
        receptances.append(left)
    return np.stack(of_peaks, axis=1), receptances


def _left_by_digits(
    fine: PathModes, digits: Array, frequencies: Array, sizes: Array, peak: Array
) -> tuple[Array, Array]:
    """What printed digits leave open of the frequency of a peak (p) and of sizes (p×n), relative.

    `sizes` at `frequencies` (n, Hz), `peak` (p×1, Hz). As if all stiffness were off together by
    what `digits` leave of the frequency nearest to each: h(ω) becomes h(ω(1 − s))/(1 + 2s).
    """
    modes = np.nan_to_num(fine.frequencies[:, : digits.shape[1]], nan=np.inf)
    asked = np.hstack([peak, np.broadcast_to(frequencies, sizes.shape)])
    nearest = np.argmin(np.abs(modes[:, None] - asked[:, :, None]), axis=2)
    shares = np.take_along_axis(digits, nearest, axis=1)
    slopes = np.gradient(np.log(np.maximum(sizes, _NO_SIZE)), np.log(frequencies), axis=1)
    return shares[:, 0], shares[:, 1:] * (2.0 + np.abs(slopes))


def _digits_of_frequencies(robot: RobotOnPath, fine: PathModes, masses: Masses) -> Array:
    """What printed digits leave open of the judged frequencies of `fine` (p×K, relative).

    As of the beams' modes of the same shape; of a mode that beams do not have the most of all
    judged.
    """
    beams, share = robot.context.get(
        modes_by_digits, robot.printed, robot.postures, robot.offered, masses
    )
    amounts = np.broadcast_to(share[:, None, :], (*fine.frequencies.shape, share.shape[1]))
    by_shape = amounts_by_shape(fine, beams, amounts, robot.judged)
    most = share[:, : robot.judged].max(axis=1, keepdims=True)
    return np.where(np.isnan(by_shape), most, by_shape)


def _is_rounded(robot: RobotOnPath) -> bool:
    """Whether printed digits of the file's 6×6 change the robot."""
    return bool(robot.roundings)


def _loads_given_masses(robot: RobotOnPath) -> bool:
    """Whether loads act on masses whose places within the legs are unknown."""
    return bool(robot.given) and any(load.acts_on_mass for load in robot.mechanism.loads)


# Linear sums over the rows are the half-width of the whole.
STATIC_ROWS = (
    SourceRow(Source.MESHES, lambda _: True, _displacement_meshes),
    SourceRow(Source.DIGITS, _is_rounded, STATIC_DIGITS),
    SourceRow(Source.LINEARITY, lambda robot: bool(robot.mechanism.loads), _linearity),
    SourceRow(Source.MASSES, _loads_given_masses, _MASSES),
)
MODAL_ROWS = (
    SourceRow(Source.MESHES, lambda _: True, _modal_meshes),
    SourceRow(Source.DIGITS, _is_rounded, _modal_digits),
)
