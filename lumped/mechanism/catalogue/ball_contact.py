"""Hertzian contact of a ball between two grooves, and preloaded ball bearings.

A ball of diameter D is pressed between the grooves of two rings. Under the load Q = c δ^(3/2) the
bodies in contact approach each other by δ, with

    δ = δ* (3Q (1 − ν²) / (E_Y Σρ))^(2/3) Σρ/2,    δ* = (2K/π) (π/(2κ²E))^(1/3)

for each contact (Hertz; Harris, Rolling Bearing Analysis, chapter 6). E_Y is Young's modulus, ν is
Poisson's ratio, Σρ is the sum of the principal curvatures, and κ is the ratio of the axes of the
contact ellipse. κ follows from the curvature difference F(ρ) = ((κ² + 1)E − 2K)/((κ² − 1)E). Here
K and E are the complete elliptic integrals of the parameter 1 − 1/κ².

The radii of the inner and the outer groove are f_i D and f_o D. The centres of these radii are A =
(f_i + f_o − 1)D apart without load, and ℓ = A + δ under load, with the approach δ of both contacts
together. Under load the line of contact rotates from the angle α₀ to α, with cos α = cos α₀/(1 +
δ/A), and Z balls carry the preload F = Z Q sin α (ISO/TS 16281). The stiffness of a ball between
the rings is the derivative of its force: dQ/dδ along the line of contact, and Q/ℓ normal to this
line in the plane through the axis of the bearing.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
import scipy

from lumped.arrays import Array
from lumped.screws import shift

Arrangement: TypeAlias = Literal["O", "X", "tandem"]
# Axial direction in which the inner ring presses against the balls, in the first and in the second
# half of the rows along the shaft. Lines of contact of O meet the shaft beyond the rows.
_SIGNS: dict[Arrangement, tuple[float, float]] = {
    "O": (1.0, -1.0),
    "X": (-1.0, 1.0),
    "tandem": (1.0, 1.0),
}
# Bearings whose inner dimensions are published: number of balls, diameters of balls and of their
# pitch circle (m), contact angle (°), radii of inner and outer groove relative to the diameter of
# the balls. 6203, 6205: Case Western Reserve University, Bearing Data Center, with the largest
# grooves of ISO/TS 16281; 6209, 7218: Harris, Rolling Bearing Analysis, bearings 209 and 218 of
# its examples.
SIZES: dict[str, tuple[int, float, float, float, float, float]] = {
    "6203": (8, 6.746e-3, 28.5e-3, 0.0, 0.52, 0.53),
    "6205": (9, 7.94e-3, 39.04e-3, 0.0, 0.52, 0.53),
    "6209": (9, 12.7e-3, 65.0e-3, 0.0, 0.52, 0.52),
    "7218": (16, 22.23e-3, 125.3e-3, 40.0, 0.5232, 0.5232),
}
# Young's modulus (Pa) and Poisson's ratio of bearing steel (Harris).
_E, _NU = 2.075e11, 0.3
# Contact pressure (Pa) of the static load rating of ball bearings and guides (ISO 76): a permanent
# deformation of 1e-4 of the diameter of the ball.
_STATIC_PRESSURE = 4.2e9
# Largest ratio of the axes of a contact ellipse that is searched: grooves touch at infinity.
_LONGEST = 1e6
# Largest contact angle (rad), that of a thrust bearing.
_STEEPEST = 0.5 * np.pi - 1e-6


@dataclass(frozen=True)
class BallBearing:
    """One row of a ball bearing with the number of `balls`.

    `ball_diameter` and the diameter `pitch_diameter` of the circle of their centres are in m.
    `angle` (rad) is the contact angle without load. `inner` and `outer` are the radii of the inner
    and the outer groove, divided by the diameter of a ball.
    """

    balls: int
    ball_diameter: float
    pitch_diameter: float
    angle: float
    inner: float
    outer: float

    @property
    def distance(self) -> float:
        """Distance A (m) between the centres of the two grooves without load."""
        return (self.inner + self.outer - 1.0) * self.ball_diameter

    @property
    def contact_constant(self) -> float:
        """Constant c (N/m^1.5) of Q = c δ^(3/2), with the contacts to both rings in series."""
        compliances = [hertz_constant(contact) ** (-2.0 / 3.0) for contact in self._contacts]
        return float(np.sum(compliances) ** -1.5)

    @property
    def static_load(self) -> float:
        """Load (N) of one ball at the static load rating, in the more loaded contact."""
        return min(static_load(curvatures) for curvatures in self._contacts)

    @property
    def largest_preload(self) -> float:
        """Axial preload (N) of a row that loads its balls as the static load rating does."""
        approach = (self.static_load / self.contact_constant) ** (2.0 / 3.0)
        cosine = self.distance * np.cos(self.angle) / (self.distance + approach)
        return float(self.balls * self.static_load * np.sqrt(1.0 - cosine**2))

    @property
    def _contacts(self) -> list[tuple[float, float, float, float]]:
        """Principal curvatures (1/m) of the contacts with the inner and the outer ring."""
        D = self.ball_diameter
        gamma = D * float(np.cos(self.angle)) / self.pitch_diameter
        along = 2.0 / D * gamma / (1.0 - gamma), -2.0 / D * gamma / (1.0 + gamma)
        return [
            (2.0 / D, 2.0 / D, along[0], -1.0 / (self.inner * D)),
            (2.0 / D, 2.0 / D, along[1], -1.0 / (self.outer * D)),
        ]

    def under_preload(self, preload: float) -> tuple[float, float]:
        """Contact angle (rad) and approach δ (m) of the grooves under an axial `preload` (N)."""

        def approach(angle: float) -> float:
            return float(self.distance * (np.cos(self.angle) / np.cos(angle) - 1.0))

        def excess(angle: float) -> float:
            load = self.contact_constant * max(approach(angle), 0.0) ** 1.5
            return float(self.balls * load * np.sin(angle) - preload)

        angle = float(scipy.optimize.brentq(excess, self.angle, _STEEPEST, xtol=1e-15, rtol=1e-14))
        return angle, approach(angle)

    def stiffness(self, preload: float, sign: float, position: float) -> Array:
        """6×6 stiffness (SI, axes with x along the shaft) of a row under an axial `preload` (N).

        It is referred to the origin of the axes. The row is at x = `position` (m). `sign` is 1 if
        the inner ring presses against the balls in the direction of x, and −1 in the opposite
        direction.
        """
        angle, approach = self.under_preload(preload)
        length = self.distance + approach
        load = self.contact_constant * approach**1.5
        radius = 0.5 * self.pitch_diameter + (self.inner - 0.5) * self.ball_diameter * np.cos(
            self.angle
        )
        offset = position + sign * (self.inner - 0.5) * self.ball_diameter * np.sin(self.angle)
        total = np.zeros((6, 6))
        for turned in 2.0 * np.pi * np.arange(self.balls) / self.balls:
            radial = np.array([0.0, np.cos(turned), np.sin(turned)])
            axial = np.array([sign, 0.0, 0.0])
            along = np.cos(angle) * radial + np.sin(angle) * axial
            across = np.cos(angle) * axial - np.sin(angle) * radial
            block = 1.5 * load / approach * np.outer(along, along)
            block += load / length * np.outer(across, across)
            arm = shift(radius * radial + np.array([offset, 0.0, 0.0]))[:3]
            total += arm.T @ block @ arm
        return total


def bearing_of_size(size: str) -> BallBearing:
    """One row of the bearing with the designation `size`, a key of `SIZES`."""
    balls, ball, pitch, angle, inner, outer = SIZES[size]
    return BallBearing(balls, ball, pitch, float(np.radians(angle)), inner, outer)


def hertz_constant(curvatures: Sequence[float]) -> float:
    """Constant c (N/m^1.5) of Q = c δ^(3/2) for two steel bodies in contact.

    `curvatures` (4 values, in 1/m) are the principal curvatures of the first body in two planes,
    then those of the second body in the same planes. A concave surface has a negative curvature.
    """
    total = float(sum(curvatures))
    ratio = ellipse_ratio(curvature_difference(curvatures))
    parameter = 1.0 - ratio**-2
    approach = 2.0 * scipy.special.ellipk(parameter) / np.pi
    approach *= (np.pi / (2.0 * ratio**2 * scipy.special.ellipe(parameter))) ** (1.0 / 3.0)
    compliance = approach * (3.0 * (1.0 - _NU**2) / (_E * total)) ** (2.0 / 3.0) * total / 2.0
    return float(compliance**-1.5)


def static_load(curvatures: Sequence[float]) -> float:
    """Load (N) under which two steel bodies have the contact pressure of the static load rating.

    `curvatures` are those of `hertz_constant`. The largest pressure is 3Q/2πab. The semi-axes a and
    b of the contact ellipse have the product (2E/π)^(2/3) κ^(1/3) (3Q(1 − ν²)/(E_Y Σρ))^(2/3).
    """
    ratio = ellipse_ratio(curvature_difference(curvatures))
    integral = float(scipy.special.ellipe(1.0 - ratio**-2))
    product = (2.0 * integral / np.pi) ** (2.0 / 3.0) * ratio ** (1.0 / 3.0)
    product *= (3.0 * (1.0 - _NU**2) / (_E * float(sum(curvatures)))) ** (2.0 / 3.0)
    return float((2.0 * np.pi / 3.0 * _STATIC_PRESSURE * product) ** 3)


def curvature_difference(curvatures: Sequence[float]) -> float:
    """Hertz's F(ρ): relative difference of the curvatures in the two principal planes.

    `curvatures` (4 values, in 1/m) have the same order as in `hertz_constant`.
    """
    first, second, third, fourth = curvatures
    return abs((first - second) + (third - fourth)) / sum(curvatures)


def ellipse_ratio(difference: float) -> float:
    """Ratio κ ≥ 1 of the axes of a contact ellipse, from Hertz's F(ρ) = `difference`."""
    if difference < 1e-9:
        return 1.0

    def excess(ratio: float) -> float:
        first, second = scipy.special.ellipk(1.0 - ratio**-2), scipy.special.ellipe(1.0 - ratio**-2)
        value = ((ratio**2 + 1.0) * second - 2.0 * first) / ((ratio**2 - 1.0) * second)
        return float(value - difference)

    return float(scipy.optimize.brentq(excess, 1.0 + 1e-7, _LONGEST, xtol=1e-12, rtol=1e-14))


def bearing_stiffness(
    bearing: BallBearing, preload: float, rows: int, arrangement: Arrangement, distance: float
) -> Array:
    """6×6 stiffness (SI, x along the shaft) of one or several rows, referred to their middle.

    Each of the `rows` has the axial `preload` (N). Neighbouring rows are `distance` (m) apart.
    `arrangement` is "O" if the lines of contact of the two halves meet the shaft outside of the
    rows, "X" if they meet it between the rows, and "tandem" if all rows press in one direction. The
    rotation about the shaft is free.
    """
    signs = [_SIGNS[arrangement][int(2 * row >= rows)] for row in range(rows)]
    positions = distance * (np.arange(rows) - 0.5 * (rows - 1))
    total = np.zeros((6, 6))
    for sign, position in zip(signs, positions.tolist(), strict=True):
        total += bearing.stiffness(preload, sign, position)
    total[3, :] = total[:, 3] = 0.0
    return np.asarray(total)


def bearing_compliance(stiffness: Array) -> Array:
    """6×6 compliance (SI, x along the shaft) of a bearing, from its 6×6 `stiffness`.

    Row and column of the free rotation about the shaft are zero.
    """
    elastic = [0, 1, 2, 4, 5]
    compliance = np.zeros((6, 6))
    compliance[np.ix_(elastic, elastic)] = np.linalg.inv(stiffness[np.ix_(elastic, elastic)])
    return compliance
