"""What designers read off a stiffness model: deflections under 1000 N and first frequencies."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lumped.arrays import Array
from lumped.biglide import Biglide, in_words, with_equivalent_legs
from lumped.dense.modes import Modes
from lumped.mechanism.body_model import LegMatrices
from lumped.system import solution
from lumped.system.assembly import System
from lumped.system.joint_motion import Portion
from validation.models.biglide import (
    robot_compliance,
    robot_frequencies,
    robot_legs,
    robot_system,
)
from validation.models.options import DEFAULT_OPTIONS, ModelName, ModelOptions

# Modes just above those asked for, with which they may have changed places.
_ABOVE = 2
LOAD = 1000.0  # N, the paper's loads (§2.1, §2.2)
MICRO = 1e6
# Digits of differences that are more than rounding.
_DIGITS = 8


@dataclass(frozen=True)
class Deflections:
    """Deflections (µm) under 1000 N along a curve of m robots or postures.

    `planar_x`, `planar_y`: norm of the displacement in the plane under a force along x or y;
    `along_z`: displacement along z under a force along z (NaN for the simplified model).
    """

    planar_x: Array
    planar_y: Array
    along_z: Array

    @property
    def largest_planar(self) -> float:
        """Largest planar deflection (µm) under either planar load."""
        return float(max(self.planar_x.max(), self.planar_y.max()))


def farthest(found: Array, reference: Array, known: NDArray[np.bool_] | None = None) -> int:
    """Number of the posture (of p) that is farthest off, relatively, among those `known`.

    Of those off by rounding alone that of the largest number: rounding differs from machine to
    machine. What is not there where it should be is farthest of all.
    """
    looked = np.ones(len(reference), dtype=bool) if known is None else known
    with np.errstate(divide="ignore", invalid="ignore"):
        off = np.round(np.abs(found / reference - 1.0), _DIGITS)
    off = np.where(looked, np.where(np.isnan(off), np.inf, off), -1.0)
    return int(np.lexsort((np.where(looked, reference, -np.inf), off))[-1])


def farthest_entry(found: Array, reference: Array) -> tuple[float, float]:
    """The entries of two compliances (…×n×n) that differ most, in units of √(c_ii c_jj).

    The unit is the power of two next to that of the reference, so that both numbers stay what they
    are. Of entries that differ by rounding alone the largest: rounding differs from machine to
    machine.
    """
    return farthest_beyond(found, reference, np.zeros_like(reference))[:2]


def farthest_beyond(found: Array, reference: Array, left_open: Array) -> tuple[float, float, float]:
    """The same with what is left open of the difference: that which differs most beyond it."""
    sizes = np.sqrt(np.abs(np.diagonal(reference, axis1=-2, axis2=-1)))
    scale = sizes[..., :, None] * sizes[..., None, :]
    scale = np.exp2(np.round(np.log2(np.where(scale > 0.0, scale, 1.0))))
    ours, theirs, open_of_both = ((one / scale).ravel() for one in (found, reference, left_open))
    beyond = np.round(np.abs(ours - theirs) - open_of_both, _DIGITS)
    at = np.lexsort((np.abs(theirs), beyond))[-1]
    return float(ours[at]), float(theirs[at]), float(open_of_both[at])


def deflections_of(compliances: Array) -> Deflections:
    """Deflections from compliances (m×6×6 or m×2×2, SI, robot axes)."""
    scale = LOAD * MICRO
    planar = np.linalg.norm(compliances[:, :2, :2], axis=1) * scale
    m, n = compliances.shape[:2]
    along_z = compliances[:, 2, 2] * scale if n == 6 else np.full(m, np.nan)
    return Deflections(planar[:, 0], planar[:, 1], along_z)


def stroke_compliances(
    model: ModelName, robot: Biglide, count: int, options: ModelOptions = DEFAULT_OPTIONS
) -> Array:
    """Compliances at `count` postures evenly over the stroke, both ends included."""
    return np.array([robot_compliance(model, robot, x, options) for x in robot.stations(count)])


def stroke_deflections(
    model: ModelName, robot: Biglide, count: int, options: ModelOptions = DEFAULT_OPTIONS
) -> Deflections:
    """Deflections at `count` postures evenly over the stroke."""
    return deflections_of(stroke_compliances(model, robot, count, options))


def stroke_frequencies(
    model: ModelName,
    robot: Biglide,
    count: int,
    modes_count: int,
    options: ModelOptions = DEFAULT_OPTIONS,
) -> Array:
    """First frequencies (count × modes, Hz) at `count` postures evenly over the stroke."""
    return np.array(
        [robot_frequencies(model, robot, x, modes_count, options) for x in robot.stations(count)]
    )


def rounded_frequencies(
    model: ModelName,
    robot: Biglide,
    x: float,
    count: int,
    options: ModelOptions = DEFAULT_OPTIONS,
) -> tuple[Array, Array]:
    """First frequencies (Hz) by `segments` or `beam`, and what rounding leaves open of them."""
    system = robot_system(model, robot, x, options)
    found = solution.modes(solution.solved(system), count + _ABOVE)
    left_open = solution.rounding_of_frequencies(system, found)
    return found.frequencies[:count], left_open[:count]


@dataclass(frozen=True)
class RobotModes:
    """Modes of the robot in one posture with the energy of every part.

    `strain` maps a part (foot 1, bending z of leg 1, …) to its share of each mode's strain energy;
    `kinetic` maps "x", "y", "z" to the share of kinetic energy in that direction, rotations left
    out (m values each).
    """

    system: System
    legs: tuple[LegMatrices, LegMatrices]
    modes: Modes
    strain: Mapping[Portion, Array]
    kinetic: Mapping[str, Array]


def robot_modes(
    model: ModelName,
    robot: Biglide,
    x: float,
    count: int,
    options: ModelOptions = DEFAULT_OPTIONS,
) -> RobotModes:
    """The lowest `count` modes of the robot by `segments` or `beam`, with shares of energy."""
    system = robot_system(model, robot, x, options)
    legs = robot_legs(model, robot, options)
    found = solution.modes(solution.solved(system), count)
    return RobotModes(
        system=system,
        legs=legs,
        modes=found,
        strain=strain_shares(system, found.shapes),
        kinetic=kinetic_shares(system, found.shapes, robot, legs),
    )


def strain_shares(system: System, shapes: Array) -> dict[Portion, Array]:
    """Share of strain energy of feet, tool, and each leg's kinds in each shape (n×m)."""
    found = solution.strain_shares(system, shapes)
    return {in_words(part): share for part, share in found.items()}


def kinetic_shares(
    system: System, shapes: Array, robot: Biglide, legs: tuple[LegMatrices, LegMatrices]
) -> dict[str, Array]:
    """Share of kinetic energy along x, y and z (robot axes) in each shape (n×m).

    Translations of the platform's mass and of both centrelines, weighted with the legs' mass.
    """
    energy = robot.platform_mass * np.square((system.tool @ shapes)[:3])
    equivalent = with_equivalent_legs(robot)
    masses = (equivalent.leg1.mass, equivalent.leg2.mass)
    for name, leg, mass in zip(("leg1", "leg2"), legs, masses, strict=True):
        points, weights = np.polynomial.legendre.leggauss(_CENTRELINE_POINTS)
        stations = 0.5 * leg.length * (1.0 + points)
        twists = leg.centreline(stations) @ system.own(name, shapes)
        rotation = system.posture.frames[name].rotation
        velocities = np.einsum("ij,sjm->sim", rotation, twists.reshape(len(stations), 6, -1)[:, :3])
        energy = energy + mass * np.einsum("s,sim->im", 0.5 * weights, np.square(velocities))
    shares = energy / energy.sum(axis=0)
    return dict(zip("xyz", shares, strict=True))


# The centreline's modes up to the tenth half wave are integrated to better than 1e-3.
_CENTRELINE_POINTS = 24
