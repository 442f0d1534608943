"""Carriage of a profile rail guide on four rows of balls that are preloaded against each other.

The rows lie at the corners of a rectangle in a plane normal to the rail. Each ball lies between two
straight grooves. Its line of contact is at the contact angle α to the plane of the rail. The
contact stiffness follows from `lumped.mechanism.catalogue.ball_contact`. The two upper rows press
against the two lower ones with the preload F = 2 n Q sin α, with n loaded balls in each row and the
force Q on each ball.

Catalogues give only the stiffness k of a carriage normal to the rail. At α = 45° the lateral
stiffness is equal to it. The stiffnesses of rotations follow from the positions of the balls. They
are k L²/12 in pitch and in yaw for rows of the length L, and k (M/C)² in roll. C is the static load
rating for a normal force and M that for a moment about the rail: under each of them the most loaded
ball carries the same load. In pitch, the corresponding ratio is M/C = L/7, because the load of a
ball grows with the power 3/2 of its displacement.
"""

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.catalogue.ball_contact import hertz_constant, static_load
from lumped.screws import shift

Lines: TypeAlias = Literal["O", "X"]
PreloadClass: TypeAlias = Literal["Z0", "ZA", "ZB"]
# Carriages by their size: normal stiffness (N/m) by class of preload, M/C in roll (m), and length
# of the rows (m). Stiffness: HIWIN, Linear Guideway, Technical Information G99TE24-2410, table
# 2-1-13, read in a transcription; the preload is 0 to 0.02 (Z0), 0.05 to 0.07 (ZA) and 0.10 to
# 0.12 (ZB) of the dynamic load rating. M/C: static ratings of HIWIN GmbH, Compact, section 1.1.12;
# for HG15C half the width of its rail. The length is that of the steel body, for HG30C seven times
# M/C in pitch.
CARRIAGES: dict[str, tuple[dict[PreloadClass, float], float, float]] = {
    "HG15C": ({"Z0": 196e6, "ZA": 365e6, "ZB": 483e6}, 7.5e-3, 39.4e-3),
    "HG20C": ({"Z0": 232e6, "ZA": 460e6, "ZB": 678e6}, 380.0 / 37_840.0, 50.5e-3),
    "HG25C": ({"Z0": 292e6, "ZA": 539e6, "ZB": 705e6}, 640.0 / 56_190.0, 58.0e-3),
    "HG30C": ({"Z0": 354e6, "ZA": 618e6, "ZB": 823e6}, 1060.0 / 83_060.0, 7 * 850.0 / 83_060.0),
}
# Preload of the highest classes of ball guides, as a fraction of the dynamic load rating, which is
# smaller than the static one: HIWIN 0.12 (HG, ZB), Schaeffler 0.13 (KUSE, V2), Rexroth 0.13 (C3).
_HIGHEST_CLASS = 0.13


@dataclass(frozen=True)
class BallGuide:
    """A carriage with `balls` loaded balls in each of its four rows. Lengths are in m.

    Rows are `width` apart along y and `height` apart along z. Neighbouring balls of a row are
    `spacing` apart. `angle` (rad) is the angle between the lines of contact and the plane of the
    rail under preload. `groove` is the radius of the grooves, divided by the diameter of a ball.
    `lines` is "O" if the lines of contact on one side of the rail meet outside of the rows, and "X"
    if they meet between the rows.
    """

    balls: int
    ball_diameter: float
    spacing: float
    width: float
    height: float
    angle: float
    groove: float
    lines: Lines

    @property
    def static_rating(self) -> float:
        """Static load rating C₀ (N) for a force normal to the rail, which loads two rows."""
        return 2.0 * self.balls * static_load(self._contact) * float(np.sin(self.angle))

    @property
    def largest_preload(self) -> float:
        """Preload (N) above that of all classes of catalogues, 13 % of the static load rating."""
        return _HIGHEST_CLASS * self.static_rating

    @property
    def _contact(self) -> tuple[float, float, float, float]:
        """Principal curvatures (1/m) of a ball and a groove."""
        D = self.ball_diameter
        return 2.0 / D, 2.0 / D, 0.0, -1.0 / (self.groove * D)

    def stiffness(self, preload: float) -> Array:
        """6×6 stiffness (SI), referred to the middle of the carriage, under a `preload` (N).

        x is along the rail, and z is normal to its plane. The stiffness along x is zero.
        """
        D = self.ball_diameter
        constant = hertz_constant(self._contact) / 2.0**1.5
        load = preload / (2.0 * self.balls * np.sin(self.angle))
        approach = (load / constant) ** (2.0 / 3.0)
        length = (2.0 * self.groove - 1.0) * D + approach
        total = np.zeros((6, 6))
        side = -1.0 if self.lines == "O" else 1.0
        stations = self.spacing * (np.arange(self.balls) - 0.5 * (self.balls - 1))
        for right in (-1.0, 1.0):
            for up in (-1.0, 1.0):
                along = np.array([0.0, right * np.cos(self.angle), side * up * np.sin(self.angle)])
                across = np.array([0.0, -along[2], along[1]])
                block = 1.5 * load / approach * np.outer(along, along)
                block += load / length * np.outer(across, across)
                for x in stations.tolist():
                    position = np.array([x, 0.5 * right * self.width, 0.5 * up * self.height])
                    arm = shift(position)[:3]
                    total += arm.T @ block @ arm
        return total


def carriage_stiffness(size: str, preload: PreloadClass) -> Array:
    """6×6 stiffness (SI) of the carriage with the designation `size`, a key of `CARRIAGES`.

    It is referred to the middle of the carriage. x is along the rail, and z is normal to its plane.
    `preload` is the class of the preload.
    """
    stiffnesses, lever, length = CARRIAGES[size]
    k = stiffnesses[preload]
    tilting = k * length**2 / 12.0
    return np.diag([0.0, k, k, k * lever**2, tilting, tilting])


def guide_compliance(stiffness: Array) -> Array:
    """6×6 compliance (SI, x along the rail) of a guide, from its 6×6 `stiffness`.

    Row and column of the free motion along the rail are zero.
    """
    compliance = np.zeros((6, 6))
    compliance[1:, 1:] = np.linalg.inv(stiffness[1:, 1:])
    return compliance
