"""Responses of the paper's robot over its stroke, and of robots with longer legs.

Input: the mechanism and positions x of point B. Output: compliances, deflections in µm under 1000
N, frequencies, and energy shares of modes. Bodies and joints have the paper's names here: leg 1 and
leg 2, foot 1 and foot 2.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain

import numpy as np

from lumped.arrays import Array
from lumped.dense.modes import Modes
from lumped.legs import Leg
from lumped.mechanism.biglide import Stroke
from lumped.mechanism.kinematics.postures import posture
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.memo import memo
from lumped.models.bodies import legs_of
from lumped.robot_file import RobotFile, as_printed
from lumped.system.assembly import System
from lumped.system.joint_motion import Portion
from lumped.system.solution import strain_shares
from validation.context import BUILT_IN
from validation.models.options import DEFAULT_OPTIONS, ModelName, ModelOptions
from validation.models.robot_models import answers, mechanism_modes
from validation.report.figures.mode_names import kinetic_shares

LOAD = 1000.0  # N, force of the paper's load cases (§2.1, §2.2)
# Relative leg lengths α of the robots in Figs 6, 12 and 13.
ALPHAS = tuple(np.linspace(1.0, 2.0, 11).tolist())
# Positions of point B in Figs 6, 12 and 13, as fractions of the stroke.
FIGURE_POINTS = {"centre": 0.5, "left": 0.0, "right": 1.0}
FEET = (Portion("foot 1"), Portion("foot 2"))
_MICRO = 1e6
_PAPER_NAMES = {"leg1": "leg 1", "leg2": "leg 2", "foot1": "foot 1", "foot2": "foot 2"}


@dataclass(frozen=True)
class RobotOnStroke:
    """A robot, and n positions `x` (m) of its point B on the stroke."""

    mechanism: Mechanism
    x: Array

    @cached_property
    def postures(self) -> list[Posture]:
        """Posture of the robot for each x."""
        return [posture(self.mechanism, np.array([position])) for position in self.x]


@dataclass(frozen=True)
class Deflections:
    """Deflections (µm) under 1000 N in m postures, of one robot or of several.

    `planar_x`, `planar_y`: norm of the displacement in the plane under a force along x or y.
    `along_z`: displacement along z under a force along z. NaN for the simplified model, which has
    no motion along z.
    """

    planar_x: Array
    planar_y: Array
    along_z: Array

    @property
    def largest_planar(self) -> float:
        """Largest planar deflection (µm) over both planar loads."""
        return float(max(self.planar_x.max(), self.planar_y.max()))


@dataclass(frozen=True)
class ModeShares:
    """Lowest k modes in a posture: `frequencies` (Hz) and shares of energy, k values each.

    `kinetic`: share of kinetic energy along "x", "y" and "z", rotation of sections included.
    `strain`: share of strain energy of each part, by the paper's names.
    """

    frequencies: Array
    kinetic: Mapping[str, Array]
    strain: Mapping[Portion, Array]

    @property
    def strain_in_feet(self) -> Array:
        """Share of each mode's strain energy in both feet together (k)."""
        foot_shares = [self.strain[foot] for foot in FEET if foot in self.strain]
        share: Array = np.array(foot_shares).sum(axis=0)
        return share


def is_paper_robot(robot_file: RobotFile) -> bool:
    """True for the built-in robot with the paper's data."""
    return robot_file.built_in and robot_file.source == BUILT_IN


def family_member(robot_file: RobotFile, alpha: float) -> RobotFile:
    """Robot with legs α times as long, and the same stroke and sections (eqs 10, 11)."""
    return robot_file.with_values({"geometry.alpha": alpha})


def foot_compliances(robot_file: RobotFile) -> tuple[Array, Array]:
    """Compliance of the foot (6×6, SI) as printed in the paper, and as corrected."""
    printed, used = (
        np.array(tables["foot"]["compliance"], dtype=float)
        for tables in (as_printed(robot_file), robot_file.tables)
    )
    return printed, used


def legs(mechanism: Mechanism) -> tuple[Leg, Leg]:
    """Leg 1 and leg 2 of the paper's robot."""
    legs_by_name = legs_of(mechanism)
    return legs_by_name["leg1"], legs_by_name["leg2"]


def stroke_of(mechanism: Mechanism) -> Stroke:
    """Stroke from the distance of the slides and the lengths of the legs (m)."""
    lengths = (leg.length for leg in legs(mechanism))
    return Stroke(float(mechanism.reference["slide2"].position[0]), *lengths)


@memo(8)
def over_stroke(mechanism: Mechanism, count: int) -> tuple[RobotOnStroke]:
    """Robot at `count` evenly spaced positions of point B, both ends of the stroke included.

    The result is a tuple of this one robot, for functions that take several robots.
    """
    return (RobotOnStroke(mechanism, np.linspace(*stroke_of(mechanism).ends, count)),)


def family(
    robot_file: RobotFile, fraction: float, alphas: Sequence[float] = ALPHAS
) -> tuple[RobotOnStroke, ...]:
    """Robots with leg lengths `alphas`, each with point B at a fraction of its stroke.

    Fraction 0 is the left end, 1 the right end.
    """
    members = [family_member(robot_file, alpha).mechanism for alpha in alphas]
    ends = [stroke_of(mechanism).ends for mechanism in members]
    x = [np.array([first + fraction * (last - first)]) for first, last in ends]
    return tuple(map(RobotOnStroke, members, x))


def compliances(
    model: ModelName, robots: Sequence[RobotOnStroke], options: ModelOptions = DEFAULT_OPTIONS
) -> Array:
    """Compliances at point B (m×6×6, SI, base axes) of all robots in all their postures.

    Shapes: m postures of all robots together.
    """
    solutions = (answers(model, robot.postures, 0, options) for robot in robots)
    return np.concatenate([solution.compliances for solution in solutions])


def deflections(
    model: ModelName, robots: Sequence[RobotOnStroke], options: ModelOptions = DEFAULT_OPTIONS
) -> Deflections:
    """Deflections (µm, 1000 N) of all robots in all their postures."""
    return _deflections(model, compliances(model, robots, options))


def deflections_and_frequencies(
    model: ModelName, robots: Sequence[RobotOnStroke], options: ModelOptions = DEFAULT_OPTIONS
) -> tuple[Deflections, Array]:
    """Deflections (µm, 1000 N) and first frequencies (m values, Hz) by one solution of each robot.

    Shapes: m postures of all robots together.
    """
    solutions = [answers(model, robot.postures, 1, options) for robot in robots]
    compliance = np.concatenate([solution.compliances for solution in solutions])
    lowest = np.concatenate([solution.frequencies[:, 0] for solution in solutions])
    return _deflections(model, compliance), lowest


def _deflections(model: ModelName, compliance: Array) -> Deflections:
    scale = LOAD * _MICRO
    planar = np.linalg.norm(compliance[:, :2, :2], axis=1) * scale
    along_z = compliance[:, 2, 2] * (np.nan if model == "simplified" else scale)
    return Deflections(planar[:, 0], planar[:, 1], along_z)


def frequencies(
    model: ModelName,
    robots: Sequence[RobotOnStroke],
    count: int,
    options: ModelOptions = DEFAULT_OPTIONS,
) -> Array:
    """Lowest natural frequencies (m×count, Hz). Infinite if the model has fewer modes.

    Shapes: m postures of all robots together.
    """
    values = np.concatenate(
        [answers(model, robot.postures, count, options).frequencies for robot in robots]
    )
    missing = count - values.shape[1]
    return np.pad(values, ((0, 0), (0, missing)), constant_values=np.inf)


def mode_shares(
    model: ModelName,
    robots: Sequence[RobotOnStroke],
    count: int,
    options: ModelOptions = DEFAULT_OPTIONS,
) -> list[ModeShares]:
    """Lowest `count` modes of all robots in all their postures, with shares of energy."""
    solutions = (mechanism_modes(model, robot.postures, count, options) for robot in robots)
    return [_energy_shares(solution.system, solution.modes) for solution in chain(*solutions)]


def _energy_shares(system: System, modes: Modes) -> ModeShares:
    strain = strain_shares(system, modes.shapes)
    return ModeShares(
        frequencies=modes.frequencies,
        kinetic=dict(zip("xyz", kinetic_shares(system, modes.shapes), strict=True)),
        strain={_with_paper_name(part): share for part, share in strain.items()},
    )


def _with_paper_name(part: Portion) -> Portion:
    name = _PAPER_NAMES.get(part.of, part.of)
    return Portion(name) if part.kind == "compliance" else replace(part, of=name)
