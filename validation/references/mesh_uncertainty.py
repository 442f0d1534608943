"""Discretisation uncertainty of a reference, summed over three kinds of mesh.

Input: solved displacements or modes of the reference under one reading of the robot file. Output:
relative half-widths for each pose and quantity. Rule: for each kind of mesh, the quantity is solved
on two or three meshes, and a `MeshPolicy` computes the half-width from the change between meshes.

The element length along the legs is studied with solid legs. The mesh of their cross-sections is
studied with beams whose section constants are computed on that mesh, and by the distortion of the
sections under their inertia (`fem.sections.inertial_distortion`), which beams do not contain. CAD
parts are solved on three meshes, under the first reading of the robot file only.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from lumped.acceptance.quantities import MOST_MODES, UNIT_LOADS
from lumped.arrays import Array
from lumped.legs import GivenLeg, is_bent
from lumped.mechanism.load import Load
from lumped.mechanism.mechanism import Mechanism
from lumped.models.bodies import legs_of
from validation.parts.meshes import LEVELS
from validation.references.model_ladder import COMPUTED_BEAMS, SOLID, WARPING_BEAMS
from validation.references.modes_on_path import solid_meshes
from validation.references.reference import SourceHalfWidths
from validation.references.reference_legs import (
    SECTION_RATIO,
    distortion_change,
    shares_section,
    slowest,
    solid_leg,
)
from validation.references.reference_parts import UNKNOWN, part_policy
from validation.references.responses import Model, Responses
from validation.references.robot_on_path import MeshKind, Reading, RobotOnPath
from validation.responses.displacement import sizes
from validation.responses.mode_partners import frequency_changes, shares_by_shape
from validation.responses.statics_and_modes import PathModes, Statics
from validation.solids.leg_meshes import COARSEST_WALLS
from validation.uncertainty.half_widths import MeshPolicy, half_widths_on, relative_sizes

H = TypeVar("H")
_TWO_LEVELS = (0, 1)
# Relative half-width of displacements if all legs are given by a 6×6: round-off alone, since no
# mesh is involved.
ROUNDING = 1e-9
# Relative difference between the tool's displacements under the weight of solid legs and under that
# of beams of equal mass: 0.3 % for legs five times as long as high with rigid end faces (ν = 0.3),
# a tenth of that with free ends.
_MASS_OF_BEAMS = 5e-3
# Relative difference between the tool's displacements under a load along a part of straight solid
# legs and under the same load on beams: 2.4 % for a torque on the root half of legs five times as
# long as high with rigid end faces, 0.9 % for forces. Bent legs carry such loads as solids.
LINE_ON_BEAMS = 3e-2


@dataclass(frozen=True)
class MeshRow:
    """A kind of mesh: the field of `Reading` that selects it, its levels and its mesh policy.

    `kind` is the name of that field. `levels` are values of the field from the coarsest to the
    finest mesh. Half-widths are those on the finest level, which the reference uses. Section meshes
    are the exception: the reference uses their coarse level; for this reason, the ratio of element
    sizes in their policy is below one.

    `policy` returns the rule that turns changes between meshes into half-widths. It returns a
    number instead if the half-width is known beforehand: 0 if the robot has no mesh of this kind, 1
    if its mesh cannot be refined. `model` returns the model to solve on these meshes under a
    reading.
    """

    kind: MeshKind
    levels: Sequence[int]
    policy: Callable[[RobotOnPath], MeshPolicy | float]
    model: Callable[[Reading], Model] = lambda _: SOLID

    def half_widths(
        self,
        responses: Responses,
        reading: Reading,
        solve: Callable[[Model, Reading], H],
        change: Callable[[H, H, H], Array],
    ) -> Array:
        """Half-widths of a quantity of the reference due to this kind of mesh.

        `solve` returns the statics or modes of a model under one reading of the robot file.
        `change` returns the relative change of the quantity between two of them; its third argument
        is the solution on the finest mesh.
        """
        return half_widths_on(
            self.levels,
            self.policy(responses.robot),
            lambda level: solve(self.model(reading), reading.on_mesh(self.kind, level)),
            change,
        )


def _static_leg_policy(robot: RobotOnPath) -> MeshPolicy | float:
    if not robot.prisms:
        return ROUNDING
    ratio = min(solid_leg(robot.context, leg).ratio for leg in robot.prisms)
    return slowest(ratio, robot.prisms)


def _shared_section_policy(robot: RobotOnPath) -> MeshPolicy | float:
    """Mesh policy for section meshes in statics.

    The coarse and the fine solid of a leg can have the same section mesh. Their difference then
    does not contain the error of that mesh, so that a policy for it is needed. The result is the
    half-width 0 if the two solids of every leg have different section meshes.
    """
    shared = any(shares_section(robot.context, leg) for leg in robot.legs.values())
    return slowest(SECTION_RATIO) if shared else 0.0


def _modal_leg_policy(robot: RobotOnPath) -> MeshPolicy | float:
    if not robot.prisms:
        return 0.0
    ratio = solid_meshes(robot.context.meshes).ratio(robot.prisms)
    return slowest(ratio, robot.prisms)


def _modal_section_policy(robot: RobotOnPath) -> MeshPolicy | float:
    return slowest(SECTION_RATIO) if robot.prisms else 0.0


def _section_beams(reading: Reading) -> Model:
    """Beam model for the study of section meshes: with restrained warping if all ends are rigid.

    If any end is free, the beams are free to warp. Such beams depend more on the section mesh than
    solids with free ends do, so the half-width is an overestimate.
    """
    return COMPUTED_BEAMS if "free" in reading.ends.values() else WARPING_BEAMS


_PARTS = MeshRow("part_mesh", LEVELS, lambda robot: part_policy(robot.mechanism))
_STATIC_LEGS = MeshRow("mesh", _TWO_LEVELS, _static_leg_policy)
_STATIC_SECTIONS = MeshRow(
    "section_mesh", _TWO_LEVELS, _shared_section_policy, lambda _: COMPUTED_BEAMS
)
_MODAL_LEGS = MeshRow("mesh", _TWO_LEVELS, _modal_leg_policy)
_MODAL_SECTIONS = MeshRow("section_mesh", _TWO_LEVELS, _modal_section_policy, _section_beams)


def displacement_half_widths(responses: Responses, reading: Reading) -> SourceHalfWidths:
    """Relative half-widths of displacements (P×(7+L)) due to all meshes.

    P poses. The first six columns are displacements under a unit force along and a unit moment
    about each base axis. The seventh is the largest displacement under a unit force in any
    direction. The last L are displacements under the loads of the robot file.
    """
    robot = responses.robot
    solve = responses.required_statics

    def change(first: Statics, second: Statics, fine: Statics) -> Array:
        return sizes(first - second, fine)

    loads = robot.mechanism.loads
    half_widths = np.zeros((len(robot.postures), len(UNIT_LOADS) + len(loads)))
    half_widths += _STATIC_LEGS.half_widths(responses, reading, solve, change)
    if robot.prisms:
        half_widths[:, len(UNIT_LOADS) :] += [
            _MASS_OF_BEAMS * load.acts_on_mass + _lines_on_beams(robot.mechanism, load)
            for load in loads
        ]
    half_widths += _STATIC_SECTIONS.half_widths(responses, reading, solve, change)
    half_widths += _PARTS.half_widths(responses, robot.first_reading, solve, change)
    return SourceHalfWidths(half_widths)


def _lines_on_beams(mechanism: Mechanism, load: Load) -> float:
    """Relative half-width of displacements because straight solid legs carry lines like beams."""
    legs = legs_of(mechanism)
    return LINE_ON_BEAMS * any(not is_bent(legs[line.leg]) for line in load.lines)


def frequency_half_widths(responses: Responses, reading: Reading) -> Array:
    """Relative half-widths (P×K) of the judged frequencies due to all meshes. 1 if unknown.

    The half-width is unknown for a mode without a partner on the coarser mesh, or without one among
    the modes of the beams by which section meshes are studied. For CAD parts, the order of
    convergence is always observed on the first `MOST_MODES` frequencies, so that half-widths do not
    depend on the number of judged modes. Array sizes: P poses, K judged frequencies.
    """
    robot, solve = responses.robot, responses.required_modes
    fine = solve(SOLID, reading)
    half_widths = np.zeros((len(robot.postures), MOST_MODES))
    half_widths += _MODAL_LEGS.half_widths(responses, reading, solve, _first_changes)
    half_widths += _PARTS.half_widths(responses, robot.first_reading, solve, _first_changes)
    half_widths = half_widths[:, : robot.judged_count]
    if robot.prisms:
        beams = solve(_section_beams(reading), reading)
        section_half_widths = _MODAL_SECTIONS.half_widths(responses, reading, solve, _all_changes)
        half_widths += shares_by_shape(fine, beams, section_half_widths, robot.judged_count)
        half_widths += distortion_half_widths(robot, fine)[:, : robot.judged_count]
    return np.where(np.isnan(half_widths), UNKNOWN, half_widths)


def distortion_half_widths(robot: RobotOnPath, modes: PathModes) -> Array:
    """Relative half-widths (P×m) of frequencies, since section meshes distort too little.

    Thin walls have the same section mesh in the coarse and in the fine solid, with one element
    across. It is too stiff against bending of the walls, by which inertia distorts the sections.
    The change to a finer section mesh follows from the motions of the sections in the `modes`.
    Array sizes: P poses, m modes.
    """
    mesh = solid_meshes(robot.context.meshes).fine._replace(least=COARSEST_WALLS)
    shares = np.zeros_like(modes.frequencies)
    for name, leg in robot.legs.items():
        if isinstance(leg, GivenLeg):
            continue
        change = robot.context.get(distortion_change, leg, mesh.section_divisions(leg))
        for pose, samples in enumerate(modes.samples):
            motions = robot.samples.section_motions(name, samples)
            shares[pose] += np.einsum("sim,ij,sjm->m", motions, change, motions)
    changes = 0.5 * np.square(2.0 * np.pi * modes.frequencies) * np.abs(shares)
    return slowest(SECTION_RATIO).half_widths(changes)


def _first_changes(first: PathModes, second: PathModes, fine: PathModes) -> Array:
    return frequency_changes(fine, first, MOST_MODES, second)


def _all_changes(first: PathModes, second: PathModes, fine: PathModes) -> Array:
    return frequency_changes(fine, first, fine.frequencies.shape[1], second)


def response_half_widths(
    responses: Responses, reading: Reading, numbers: Callable[[PathModes], Array]
) -> Array:
    """Relative half-widths of harmonic responses due to changes between meshes. 1 if unknown.

    Walls that section meshes bend too little are not included, see `distortion_half_widths`.
    `numbers` returns the compared values (P×q) of the harmonic responses that belong to modes, such
    as their peaks. Array sizes: P poses, q values.
    """
    robot, solve = responses.robot, responses.required_modes

    def change(first: PathModes, second: PathModes, fine: PathModes) -> Array:
        return relative_sizes(numbers(first) - numbers(second), numbers(fine))

    half_widths = np.zeros_like(numbers(solve(SOLID, reading)))
    # An undamped peak has no finite size.
    with np.errstate(invalid="ignore"):
        for row in (_MODAL_LEGS, _MODAL_SECTIONS):
            half_widths += row.half_widths(responses, reading, solve, change)
        half_widths += _PARTS.half_widths(responses, robot.first_reading, solve, change)
    return np.where(np.isnan(half_widths), UNKNOWN, half_widths)
