"""Uncertainty of references due to meshes: a row for each kind of mesh.

The effect of the element length is computed with solid legs, that of section meshes with beams of
the sections' constants. CAD parts are solved on three meshes, in the first interpretation alone.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from lumped.acceptance.quantities import MOST_MODES, UNIT_LOADS
from lumped.arrays import Array
from validation.parts.meshes import LEVELS
from validation.references.model_ladder import HELD, OWN, SOLID
from validation.references.modes_on_path import solid_meshes
from validation.references.reference_legs import (
    SECTION_RATIO,
    shares_section,
    slowest,
    solid_leg,
)
from validation.references.reference_parts import UNKNOWN, part_policy
from validation.references.responses import Model, Responses
from validation.references.robot_on_path import MeshKind, Reading, RobotOnPath
from validation.responses.displacement import sizes
from validation.responses.mode_partners import amounts_by_shape, frequency_changes
from validation.responses.statics_and_modes import PathModes, Statics
from validation.uncertainty.combiners import relative_sizes
from validation.uncertainty.mesh_half_widths import MeshPolicy, half_widths_on

H = TypeVar("H")
_TWO_LEVELS = (0, 1)
# Solution of the legs' own 6×6 without any mesh.
ROUNDING = 1e-9
# Relative difference of the tool's motion by the weight of solid legs and of beams of equal mass:
# 0.3 % for legs five times as long as high with held ends (ν = 0.3), a tenth of it with free ends.
_MASS_OF_BEAMS = 5e-3


@dataclass(frozen=True)
class MeshRow:
    """Kind of mesh, the field of a reading that chooses it, and its levels from coarse to fine.

    Half-widths are those of the finest level, on which references are. For section meshes they are
    those of the coarse level, which is the mesh of the solids: the ratio of their policy is below
    one.

    `model` is solved on these meshes under a reading. `policy` returns the half-width of a robot
    itself if it is known beforehand: 0 if its reference has no such mesh, 1 if the mesh cannot be
    refined.
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
        """Half-widths by the `change` of a half of a response from mesh to mesh."""
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
    return slowest(ratio)


def _shared_section_policy(robot: RobotOnPath) -> MeshPolicy | float:
    """Policy for a section mesh that both solids of a leg share, compared with a finer one."""
    shared = any(shares_section(robot.context, leg) for leg in robot.legs.values())
    return slowest(SECTION_RATIO) if shared else 0.0


def _modal_leg_policy(robot: RobotOnPath) -> MeshPolicy | float:
    if not robot.prisms:
        return 0.0
    ratio = solid_meshes(robot.context.meshes).ratio(robot.prisms)
    return slowest(ratio)


def _modal_section_policy(robot: RobotOnPath) -> MeshPolicy | float:
    return slowest(SECTION_RATIO) if robot.prisms else 0.0


def _section_beams(reading: Reading) -> Model:
    """Beams for the study of section meshes: without warping if ends are free, otherwise with it.

    Beams free to warp depend less on Saint-Venant's constant than solids with free ends do.
    """
    return OWN if "free" in reading.ends.values() else HELD


_PARTS = MeshRow("part_mesh", LEVELS, lambda robot: part_policy(robot.mechanism))
_STATIC_LEGS = MeshRow("mesh", _TWO_LEVELS, _static_leg_policy)
_STATIC_SECTIONS = MeshRow("section_mesh", _TWO_LEVELS, _shared_section_policy, lambda _: OWN)
_MODAL_LEGS = MeshRow("mesh", _TWO_LEVELS, _modal_leg_policy)
_MODAL_SECTIONS = MeshRow("section_mesh", _TWO_LEVELS, _modal_section_policy, _section_beams)


def displacement_half_widths(responses: Responses, reading: Reading) -> Array:
    """Relative half-widths of displacements (P×(7+L)) due to all meshes."""
    robot = responses.robot
    solve = responses.required_statics

    def change(first: Statics, second: Statics, fine: Statics) -> Array:
        return sizes(first - second, fine)

    loads = robot.mechanism.loads
    half_widths = np.zeros((len(robot.postures), len(UNIT_LOADS) + len(loads)))
    half_widths += _STATIC_LEGS.half_widths(responses, reading, solve, change)
    if robot.prisms:
        half_widths[:, len(UNIT_LOADS) :] += _MASS_OF_BEAMS * np.array(
            [load.acts_on_mass for load in loads]
        )
    half_widths += _STATIC_SECTIONS.half_widths(responses, reading, solve, change)
    half_widths += _PARTS.half_widths(responses, robot.first_reading, solve, change)
    return half_widths


def frequency_half_widths(responses: Responses, reading: Reading) -> Array:
    """Relative half-widths of the judged frequencies (P×K) due to all meshes. One if unknown.

    Half-widths of modes that a coarser solid, or the beams, do not have are unknown. The order
    of convergence of parts is that of the first `MOST_MODES` frequencies, for any judged number.
    """
    robot, solve = responses.robot, responses.required_modes
    fine = solve(SOLID, reading)
    half_widths = np.zeros((len(robot.postures), MOST_MODES))
    half_widths += _MODAL_LEGS.half_widths(responses, reading, solve, _first_changes)
    half_widths += _PARTS.half_widths(responses, robot.first_reading, solve, _first_changes)
    half_widths = half_widths[:, : robot.judged]
    if robot.prisms:
        beams = solve(_section_beams(reading), reading)
        of_beams = _MODAL_SECTIONS.half_widths(responses, reading, solve, _all_changes)
        amounts = np.broadcast_to(
            of_beams[:, None, :], (*fine.frequencies.shape, of_beams.shape[1])
        )
        half_widths = half_widths + amounts_by_shape(fine, beams, amounts, robot.judged)
    return np.where(np.isnan(half_widths), UNKNOWN, half_widths)


def _first_changes(first: PathModes, second: PathModes, fine: PathModes) -> Array:
    return _frequency_changes(first, second, fine, MOST_MODES)


def _all_changes(first: PathModes, second: PathModes, fine: PathModes) -> Array:
    return _frequency_changes(first, second, fine, fine.frequencies.shape[1])


def _frequency_changes(coarse: PathModes, middle: PathModes, fine: PathModes, count: int) -> Array:
    """Differences (P×count) of the changes from two meshes to the finest one, by shape."""
    first, second = (
        np.zeros(1) if modes is fine else frequency_changes(fine, modes, count)
        for modes in (coarse, middle)
    )
    return np.asarray(np.abs(first - second))


def response_half_widths(
    responses: Responses, reading: Reading, numbers: Callable[[PathModes], Array]
) -> Array:
    """Relative half-widths of `numbers` of the responses due to meshes. One if unknown."""
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
