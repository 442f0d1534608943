"""The paper's robot over its stroke, its family with longer legs, and what models say of both.

The mechanism's bodies and joints have the paper's words here: leg 1 and leg 2, foot 1 and foot 2.
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
from validation.models.mechanism import answers, mechanism_modes
from validation.models.options import DEFAULT_OPTIONS, ModelName, ModelOptions
from validation.report.figures.mode_names import kinetic_shares

LOAD = 1000.0  # N, the paper's loads (§2.1, §2.2)
# Lengths of the legs over those given, as in the figures of the family.
ALPHAS = tuple(np.linspace(1.0, 2.0, 11).tolist())
# Where Figs 6, 12 and 13 are drawn, as a fraction of the stroke.
FIGURE_POINTS = {"centre": 0.5, "left": 0.0, "right": 1.0}
FEET = (Portion("foot 1"), Portion("foot 2"))
_MICRO = 1e6
_WORDS = {"leg1": "leg 1", "leg2": "leg 2", "foot1": "foot 1", "foot2": "foot 2"}


@dataclass(frozen=True)
class Places:
    """One robot with B at each `x` (m)."""

    mechanism: Mechanism
    x: Array

    @cached_property
    def postures(self) -> list[Posture]:
        """The robot's posture for each x."""
        return [posture(self.mechanism, np.array([station])) for station in self.x]


@dataclass(frozen=True)
class Deflections:
    """Deflections (µm) under 1000 N along a curve of m robots or postures.

    `planar_x`, `planar_y`: norm of the displacement in the plane under a force along x or y;
    `along_z`: displacement along z under a force along z, NaN by the simplified model, which
    knows no motion along z.
    """

    planar_x: Array
    planar_y: Array
    along_z: Array

    @property
    def largest_planar(self) -> float:
        """Largest planar deflection (µm) under either planar load."""
        return float(max(self.planar_x.max(), self.planar_y.max()))


@dataclass(frozen=True)
class ModeShares:
    """The lowest m modes in one posture: `frequencies` (Hz) and shares of energy (m values each).

    `kinetic` along "x", "y" and "z", turning sections included; `strain` by part, in the paper's
    words.
    """

    frequencies: Array
    kinetic: Mapping[str, Array]
    strain: Mapping[Portion, Array]

    @property
    def in_the_feet(self) -> Array:
        """Share of each mode's strain energy in both feet."""
        of_feet = [self.strain[foot] for foot in FEET if foot in self.strain]
        share: Array = np.array(of_feet).sum(axis=0)
        return share


def is_the_papers(robot_file: RobotFile) -> bool:
    """Whether it is the robot that comes with the program as the paper's."""
    return robot_file.built_in and robot_file.source == BUILT_IN


def member(robot_file: RobotFile, alpha: float) -> RobotFile:
    """The robot whose legs are α times as long, stroke and sections unchanged (eqs 10, 11)."""
    return robot_file.with_values({"geometry.alpha": alpha})


def foot_compliances(robot_file: RobotFile) -> tuple[Array, Array]:
    """The foot's compliance (6×6, SI) as printed, and as used."""
    printed, used = (
        np.array(tables["foot"]["compliance"], dtype=float)
        for tables in (as_printed(robot_file), robot_file.tables)
    )
    return printed, used


def legs(mechanism: Mechanism) -> tuple[Leg, Leg]:
    """Leg 1 and leg 2."""
    found = legs_of(mechanism)
    return found["leg1"], found["leg2"]


def stroke_of(mechanism: Mechanism) -> Stroke:
    """Distance of the slides and lengths of the legs."""
    lengths = (leg.length for leg in legs(mechanism))
    return Stroke(float(mechanism.reference["slide2"].position[0]), *lengths)


@memo(8)
def over_stroke(mechanism: Mechanism, count: int) -> tuple[Places]:
    """`count` positions of B evenly over the stroke, both ends included."""
    return (Places(mechanism, np.linspace(*stroke_of(mechanism).ends, count)),)


def family(
    robot_file: RobotFile, fraction: float, alphas: Sequence[float] = ALPHAS
) -> tuple[Places, ...]:
    """The members of the family with B at a fraction of the stroke (0 left, 1 right)."""
    members = [member(robot_file, alpha).mechanism for alpha in alphas]
    ends = [stroke_of(one).ends for one in members]
    x = [np.array([first + fraction * (last - first)]) for first, last in ends]
    return tuple(map(Places, members, x))


def compliances(
    model: ModelName, places: Sequence[Places], options: ModelOptions = DEFAULT_OPTIONS
) -> Array:
    """Compliances (m×6×6, SI, base axes) in all places."""
    found = (answers(model, at.postures, 0, options) for at in places)
    return np.array([answer.compliance for answer in chain(*found)])


def deflections(
    model: ModelName, places: Sequence[Places], options: ModelOptions = DEFAULT_OPTIONS
) -> Deflections:
    """Deflections in all places."""
    scale = LOAD * _MICRO
    found = compliances(model, places, options)
    planar = np.linalg.norm(found[:, :2, :2], axis=1) * scale
    along_z = found[:, 2, 2] * (np.nan if model == "simplified" else scale)
    return Deflections(planar[:, 0], planar[:, 1], along_z)


def frequencies(
    model: ModelName,
    places: Sequence[Places],
    count: int,
    options: ModelOptions = DEFAULT_OPTIONS,
) -> Array:
    """First frequencies (m×count, Hz) in all places, infinite where nothing gives way."""
    found = chain(*(answers(model, at.postures, count, options) for at in places))
    rows = [answer.frequencies for answer in found]
    return np.array([np.pad(row, (0, count - len(row)), constant_values=np.inf) for row in rows])


def modes(
    model: ModelName,
    places: Sequence[Places],
    count: int,
    options: ModelOptions = DEFAULT_OPTIONS,
) -> list[ModeShares]:
    """The lowest `count` modes in all places, shares of energy beside them."""
    found = (mechanism_modes(model, at.postures, count, options) for at in places)
    return [_told(one.system, one.modes) for one in chain(*found)]


def _told(system: System, found: Modes) -> ModeShares:
    strain = strain_shares(system, found.shapes)
    return ModeShares(
        frequencies=found.frequencies,
        kinetic=dict(zip("xyz", kinetic_shares(system, found.shapes), strict=True)),
        strain={_in_words(part): share for part, share in strain.items()},
    )


def _in_words(part: Portion) -> Portion:
    of = _WORDS.get(part.of, part.of)
    return Portion(of) if part.kind == "compliance" else replace(part, of=of)
