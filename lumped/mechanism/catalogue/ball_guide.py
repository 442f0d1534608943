"""Carriage of a profile rail guide on four rows of balls that are preloaded against each other.

The rows lie at the corners of a rectangle across the rail, each ball between two straight grooves
whose line of contact is at an angle to the plane of the rail. Contact stiffness is that of
`lumped.mechanism.catalogue.ball_contact`. The upper rows press against the lower ones with the
preload F = 2 n Q sin α of n loaded balls in a row, with the contact angle α under preload.
"""

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.catalogue.ball_contact import hertz_constant
from lumped.screws import shift

Lines: TypeAlias = Literal["O", "X"]


@dataclass(frozen=True)
class BallGuide:
    """A carriage with `balls` loaded balls in each of its four rows. Lengths are in m.

    Rows are `width` apart along y and `height` along z, their balls `spacing` apart. `angle` (rad)
    is the angle between the lines of contact and the plane of the rail, `groove` the radius of the
    grooves relative to the ball's diameter. Lines of contact meet outside the rows (arrangement O)
    or between them (X).
    """

    balls: int
    ball_diameter: float
    spacing: float
    width: float
    height: float
    angle: float
    groove: float
    lines: Lines

    def stiffness(self, preload: float) -> Array:
        """6×6 stiffness (SI) about the middle of the carriage under a `preload` (N).

        The axes are x along the rail and z normal to it. The stiffness along x is zero.
        """
        D = self.ball_diameter
        constant = hertz_constant((2.0 / D, 2.0 / D, 0.0, -1.0 / (self.groove * D))) / 2.0**1.5
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


def guide_compliance(stiffness: Array) -> Array:
    """6×6 compliance of a guide, x along the rail; 0 for the free motion along the rail."""
    compliance = np.zeros((6, 6))
    compliance[1:, 1:] = np.linalg.inv(stiffness[1:, 1:])
    return compliance
