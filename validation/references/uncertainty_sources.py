"""Table of the sources of uncertainty of a reference, with the half-widths due to each.

Input: the solved models of a robot under one reading. Output: a `Budget`, half-widths by source.
Rule: a row of `STATIC_ROWS` or `MODAL_ROWS` is evaluated if it applies to the robot, and the total
is the sum over the rows. Meshes are treated in `mesh_uncertainty`.

Printed digits are a source although model and reference use the same printed 6×6 compliance: the
true compliance is known only to within its rounding, so the error of a model against the real robot
is uncertain by the effect of this rounding.
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
from validation.models.robot_bodies import dynamic_bodies
from validation.models.robot_models import highest_frequency, modes_along
from validation.models.roundings import roundings_of
from validation.references.mesh_uncertainty import (
    displacement_half_widths,
    distortion_half_widths,
    frequency_half_widths,
    response_half_widths,
)
from validation.references.mode_samples import samples_of
from validation.references.model_ladder import SOLID
from validation.references.modes_on_path import vibration_of
from validation.references.reference import Budget, Source, SourceHalfWidths
from validation.references.reference_parts import assembled
from validation.references.responses import Model, Responses
from validation.references.robot_on_path import Reading, RobotOnPath
from validation.responses.displacement import sizes
from validation.responses.mode_partners import shares_by_shape
from validation.responses.statics_and_modes import PathModes, Statics
from validation.uncertainty.half_widths import Combiner, half_widths_by

# Element count for sensitivities to printed digits: an error of 1 % of a half-width is negligible.
_FEW_ELEMENTS = ModelOptions(elements=8)
# Smallest relative change of a displacement, due to the load's effect on the stiffness, that counts
# as a nonlinearity.
_LINEAR = 1e-3
# Lower bound of a receptance's magnitude (m/N), so that its logarithm is finite.
_NO_SIZE = 1e-30
# Perturbed readings, each with a factor that multiplies the change that it causes.
Perturbed = Sequence[tuple[float, Reading]]


@dataclass(frozen=True)
class SourceRow:
    """One source of uncertainty of a reference, and the function that computes its half-widths.

    `applies` is true for robots that have this source.
    """

    source: Source
    applies: Callable[[RobotOnPath], bool]
    half_widths: Callable[[Responses, Reading], SourceHalfWidths]


@dataclass(frozen=True)
class Perturbations:
    """Half-widths from solutions of a model under perturbed readings.

    `readings` returns the perturbed forms of a reading of the robot file, each with a factor on the
    change of displacements that it causes. `combiner`: rule that combines these changes to one
    half-width.
    """

    model: Model
    readings: Callable[[RobotOnPath, Reading], Perturbed]
    combiner: Combiner

    def __call__(self, responses: Responses, reading: Reading) -> SourceHalfWidths:
        """Half-widths of displacements, relative to the model's unperturbed displacements."""
        solve = partial(responses.required_statics, self.model)
        half_widths = half_widths_by(
            reading,
            self.readings(responses.robot, reading),
            lambda perturbed: _stacked(solve(perturbed)),
            partial(_sizes, solve(reading)),
            self.combiner,
        )
        return SourceHalfWidths(half_widths)


def budget(rows: Sequence[SourceRow], responses: Responses, reading: Reading) -> Budget:
    """Half-widths of a reference under `reading`, one meaning of the robot file, by source."""
    robot = responses.robot
    return {row.source: row.half_widths(responses, reading) for row in rows if row.applies(robot)}


def _stacked(statics: Statics) -> Array:
    """All compliances, then the displacements under L loads, in one array (P×(6+L)×6)."""
    return np.concatenate([statics.compliances, statics.load_displacements], axis=1)


def _sizes(unperturbed: Statics, changes: Array) -> Array:
    """Magnitudes (n×P×(7+L)) of n changes relative to the unperturbed displacements.

    `changes` (n×P×(6+L)×6) are changes of the arrays of `_stacked` in P poses. The result is for 7
    unit loads and L loads of the robot file. It is zero if the robot is rigid under the load, since
    no relative change exists then.
    """
    count, poses = changes.shape[:2]
    # All n changes in all P poses are treated as n·P poses of one record.
    changed, repeated = (
        Statics(rows[:, :6], rows[:, 6:])
        for rows in (np.concatenate(changes), np.tile(_stacked(unperturbed), (count, 1, 1)))
    )
    relative_sizes = sizes(changed, repeated).reshape(count, poses, -1)
    return np.where(np.isfinite(relative_sizes), relative_sizes, 0.0)


def rounded_readings(robot: RobotOnPath, reading: Reading) -> Perturbed:
    """Pairs of a factor and a reading in which one number of a printed compliance is changed.

    The factor converts the change of a result to the effect of half a unit of the number's last
    digit. Empty if the robot file contains no 6×6 compliance.
    """
    return [
        (rounding.factor, replace(reading, rounding=number))
        for number, rounding in enumerate(robot.roundings)
    ]


def _plausible_mass_readings(robot: RobotOnPath, reading: Reading) -> Perturbed:
    """Pairs of the factor 1 and a reading, one for each plausible mass distribution of the legs.

    The legs are those specified by their 6×6 compliance.
    """
    return [
        (1.0, replace(reading, masses=masses)) for masses in plausible_masses(robot.given.values())
    ]


def _linked(postures: tuple[Posture, ...]) -> Statics:
    """Statics with legs represented by their 6×6 compliance, and condensed CAD parts."""
    return assembled(postures, tip_compliances(postures[0].mechanism))


def _linked_statics(robot: RobotOnPath, _: Reading) -> Statics:
    """Statics of `_linked`, computed once per run and process."""
    return robot.context.get(_linked, robot.postures)


# Each printed number is off by up to half a unit of its last digit, independently of the others.
STATIC_DIGITS = Perturbations(
    # A named function, so that subjects with this model can be sent to other processes.
    Model("links", statics=_linked_statics),
    rounded_readings,
    Combiner.PROBABILITY,
)
# Displacements under a load on masses are linear in the positions of mass, so the convex hull of
# the plausible distributions contains all others.
_MASSES = Perturbations(SOLID, _plausible_mass_readings, Combiner.HULL)


def _linearity(responses: Responses, _: Reading) -> SourceHalfWidths:
    """Half-widths (P×(7+L)) due to the change of stiffness under load; zero if it is negligible.

    They are 1 (100 % of the displacement) if the robot has buckled or its stability cannot be
    computed.
    """
    robot = responses.robot
    try:
        stability = robot.context.get(stabilities, "links", robot.postures)
    except Exception as error:  # noqa: BLE001  loses no model: it leaves their errors open
        failure_reason("stability under loads", error)
        half_widths = np.ones((len(robot.postures), len(robot.mechanism.loads)))
    else:
        extra = [[load.extra_displacement if load else 0.0 for load in row] for row in stability]
        half_widths = np.nan_to_num(np.abs(extra), nan=1.0)
    half_widths[half_widths < _LINEAR] = 0.0
    return SourceHalfWidths(np.pad(half_widths, ((0, 0), (len(UNIT_LOADS), 0))))


def modes_by_digits(
    printed: Sequence[Printed], postures: tuple[Posture, ...], count: int, masses: Masses
) -> tuple[PathModes, Array]:
    """Modes of the robot with legs as beams, and their frequency changes by printed digits (R×P×m).

    Legs specified by a 6×6 compliance keep it, with the mass distribution `masses`. Each change of
    frequency is relative, of first order, and due to one of the R changes of the `printed`
    compliances by `roundings_of`. There are P poses and m = `count` modes.
    """
    roundings = roundings_of(printed, postures)
    mechanism = postures[0].mechanism
    highest, few = highest_frequency(postures, count), _FEW_ELEMENTS.elements
    given_legs, inside = _given_legs(mechanism), Inside(masses)
    shapes_of = {name: shapes_inside(leg, inside, highest, few) for name, leg in given_legs.items()}
    leg_models = {
        name: by_shapes(shapes_of[name], leg, inside, few) for name, leg in given_legs.items()
    }
    beams = dynamic_bodies("beam", mechanism, highest, _FEW_ELEMENTS)
    posture_modes = list(modes_along(assembly(mechanism, {**beams, **leg_models}), postures, count))
    vibration = vibration_of(samples_of(mechanism), posture_modes, count)
    solved = int(np.isfinite(vibration.frequencies).sum(axis=1).min())
    modes = [(posture.system, posture.modes.shapes[:, :solved]) for posture in posture_modes]
    stiffness = np.array([_energies(system.stiffness, shapes) for system, shapes in modes])
    mass = np.array([_energies(system.mass, shapes) for system, shapes in modes])
    changes = []
    for rounding in roundings:
        rounded = rounding.postures[0].mechanism
        changed = {
            name: by_shapes(shapes_of[name], leg, inside, few)
            for name, leg in _given_legs(rounded).items()
            if leg is not given_legs[name]
        }
        stiffness_changes, mass_changes = np.zeros_like(stiffness), np.zeros_like(mass)
        for pose, (system, shapes) in enumerate(modes):
            for name, leg in changed.items():
                leg_shapes = system.body_unknowns(name, shapes)
                stiffness_changes[pose] += _energies(
                    leg.stiffness - leg_models[name].stiffness, leg_shapes
                )
                mass_changes[pose] += _energies(leg.mass - leg_models[name].mass, leg_shapes)
            for joint, rounded_joint in zip(mechanism.joints, rounded.joints, strict=True):
                # With prescribed motions u, uᵀ K u of a spring with load λ = K u falls by λᵀ dC λ.
                if joint.compliance is not None and rounded_joint is not joint:
                    compliance_change = np.asarray(rounded_joint.compliance) - joint.compliance
                    stiffness_changes[pose] -= _energies(
                        compliance_change, system.wrenches(joint, shapes)
                    )
        # Rayleigh's quotient with unperturbed shapes is exact to first order; ½ from ω = √(ω²).
        changes.append(0.5 * (stiffness_changes / stiffness - mass_changes / mass))
    return vibration, np.pad(np.array(changes), ((0, 0), (0, 0), (0, count - solved)))


def _given_legs(mechanism: Mechanism) -> dict[str, GivenLeg]:
    return {k: leg for k, leg in legs_of(mechanism).items() if isinstance(leg, GivenLeg)}


def _energies(matrix: Array | SparseMatrix, shapes: Array) -> Array:
    """Quadratic form φᵀAφ (m), with A = `matrix`, of each of m shapes φ (columns of `shapes`)."""
    return np.asarray(np.sum(shapes * (matrix @ shapes), axis=0))


def _modal_meshes(responses: Responses, reading: Reading) -> SourceHalfWidths:
    """Half-widths of frequencies and harmonic responses due to meshes."""
    robot = responses.robot
    frequencies = frequency_half_widths(responses, reading)
    excitations = robot.mechanism.excitations
    if not excitations:
        return SourceHalfWidths(frequencies=frequencies)
    fine = responses.required_modes(SOLID, reading)
    peaks, receptances = _by_frequencies(robot, fine, partial(_distortion_half_widths, robot, fine))
    return SourceHalfWidths(
        frequencies=frequencies,
        peaks=peaks + response_half_widths(responses, reading, lambda modes: modes.peaks),
        receptances=[
            by_walls + response_half_widths(responses, reading, partial(_receptance_sizes, number))
            for number, by_walls in enumerate(receptances)
        ],
    )


def _distortion_half_widths(robot: RobotOnPath, fine: PathModes, frequencies: Array) -> Array:
    """Relative half-widths (P×n) of natural frequencies near `frequencies` (P×n, Hz).

    Section meshes bend too little under the inertia of walls. The share of this in the strain
    energy is proportional to ω², so that it follows from that in the nearest mode of `fine`.
    """
    if not robot.prisms:
        return np.zeros_like(frequencies)
    per_square = distortion_half_widths(robot, fine) / np.square(fine.frequencies)
    return _nearest_half_widths(fine, per_square, frequencies) * np.square(frequencies)


def _modal_digits(responses: Responses, reading: Reading) -> SourceHalfWidths:
    """Half-widths of frequencies and harmonic responses due to printed digits."""
    robot, fine = responses.robot, responses.required_modes(SOLID, reading)
    digits = _frequency_digit_half_widths(robot, fine, reading)
    if not robot.mechanism.excitations:
        return SourceHalfWidths(frequencies=digits)
    peaks, receptances = _by_frequencies(robot, fine, partial(_nearest_half_widths, fine, digits))
    return SourceHalfWidths(frequencies=digits, peaks=peaks, receptances=receptances)


def _by_frequencies(
    robot: RobotOnPath, fine: PathModes, half_widths: Callable[[Array], Array]
) -> tuple[Array, list[Array]]:
    """Half-widths of peaks (P×q) and receptances (P×n each) due to those of natural frequencies.

    `half_widths` is a function of excitation frequencies (P×n, Hz) that returns the relative
    half-widths s (P×n) of the natural frequencies near them. All natural frequencies are assumed to
    change by s, and all stiffnesses by 2s. The receptance h(ω) then becomes h(ω(1 − s))/(1 + 2s). A
    peak moves by s, and its height changes by 2s.
    """
    peaks: list[Array] = []
    receptances = []
    for number, excitation in enumerate(robot.mechanism.excitations):
        frequencies, sizes = excitation.frequencies, _receptance_sizes(number, fine)
        peak = half_widths(fine.peaks[:, [len(peaks) + 1]])[:, 0]
        slopes = np.gradient(np.log(np.maximum(sizes, _NO_SIZE)), np.log(frequencies), axis=1)
        nearest = half_widths(np.broadcast_to(frequencies, sizes.shape))
        changes = nearest * (2.0 + np.abs(slopes))
        peaks += [2.0 * peak, peak]
        if excitation.at is not None:
            peaks.append(np.array([np.interp(excitation.at, frequencies, row) for row in changes]))
        receptances.append(changes)
    return np.stack(peaks, axis=1), receptances


def _nearest_half_widths(fine: PathModes, of_modes: Array, frequencies: Array) -> Array:
    """Relative half-widths (P×n) of the natural frequencies nearest to `frequencies` (P×n, Hz).

    `of_modes` (P×K): relative half-widths of the natural frequencies of the modes `fine`. Array
    sizes: P poses, K frequencies.
    """
    natural = np.nan_to_num(fine.frequencies[:, : of_modes.shape[1]], nan=np.inf)
    nearest = np.argmin(np.abs(natural[:, None] - frequencies[:, :, None]), axis=2)
    return np.take_along_axis(of_modes, nearest, axis=1)


def _receptance_sizes(excitation: int, modes: PathModes) -> Array:
    return np.abs(modes.receptances[excitation])


def _frequency_digit_half_widths(robot: RobotOnPath, fine: PathModes, reading: Reading) -> Array:
    """Relative half-widths (P×K) of the judged frequencies of `fine` due to printed digits.

    Each mode of `fine`, the solid model, has the half-width of the beam mode of the same shape. A
    mode without such a partner has the largest half-width of all judged modes. Array sizes: P
    poses, K judged frequencies.
    """
    beams, changes = robot.context.get(
        modes_by_digits, robot.printed, robot.postures, robot.computed_count, reading.masses
    )
    share = half_widths_by(
        reading,
        rounded_readings(robot, reading),
        lambda rounded: np.zeros(1) if rounded.rounding is None else changes[rounded.rounding],
        np.abs,
        Combiner.LINEAR_SUM,
    )
    by_shape = shares_by_shape(fine, beams, share, robot.judged_count)
    largest = share[:, : robot.judged_count].max(axis=1, keepdims=True)
    return np.where(np.isnan(by_shape), largest, by_shape)


def _is_rounded(robot: RobotOnPath) -> bool:
    """True if the robot file contains a 6×6 compliance whose printed digits matter."""
    return bool(robot.roundings)


def _loads_given_masses(robot: RobotOnPath) -> bool:
    """True if loads act on the masses of legs whose mass distribution is unknown."""
    return bool(robot.given) and any(load.acts_on_mass for load in robot.mechanism.loads)


# The total half-width is the linear sum over the rows.
STATIC_ROWS = (
    SourceRow(Source.MESHES, lambda _: True, displacement_half_widths),
    SourceRow(Source.DIGITS, _is_rounded, STATIC_DIGITS),
    SourceRow(Source.LINEARITY, lambda robot: bool(robot.mechanism.loads), _linearity),
    SourceRow(Source.MASSES, _loads_given_masses, _MASSES),
)
MODAL_ROWS = (
    SourceRow(Source.MESHES, lambda _: True, _modal_meshes),
    SourceRow(Source.DIGITS, _is_rounded, _modal_digits),
)
