"""Walls of a rectangular tube that bend where a taper begins or ends.

At such a kink the direction of a wall jumps by the angle α. The wall's normal force n per width is
deflected there, and loads the wall by n α along the kink, across the wall. The wall of width w
bends as a plate, so that the tube yields to tension and bending. A load p = p₀ + p₁ 2y/w on the
kink of an infinite strip with simply supported edges does the work

    w⁴ (c₀ p₀² + c₁ p₁²)/D,   c₀ = 2/π⁵ Σ 1/n⁵ (n odd),   c₁ = 1/16π⁵ Σ 1/m⁵,   D = E t³/12(1 − ν²)

(S. P. Timoshenko, S. Woinowsky-Krieger, Theory of Plates and Shells, ch. 5). This is an upper
bound: neighbouring walls restrain the edges, and normal stresses avoid the middle of the wall. No
beam theory has this flexibility. It grows with α² and, relative to that of the tube, with (w/t)².
"""

from itertools import pairwise

import numpy as np
from scipy.special import zeta

from lumped.arrays import Array
from lumped.legs import LineLeg
from lumped.sections import HollowRectangle

# Factors c₀ of a uniform and c₁ of a linear load. Of all terms of Σ 1/n⁵, those with odd n are
# 31/32.
_UNIFORM = float(2.0 / np.pi**5 * (31.0 / 32.0) * zeta(5))
_LINEAR = float(zeta(5) / (16.0 * np.pi**5))
# Angle (rad) below which a wall has no kink: round-off of its slopes.
_STRAIGHT = 1e-9


def kink_compliances(leg: LineLeg) -> Array:
    """Upper bounds (6, SI) of what kinks of the walls add to the diagonal of the tip compliance.

    Zero in torsion, and if the leg is bent or is not a rectangular tube.
    """
    bounds = np.zeros(6)
    if not leg.line.is_straight:
        return bounds
    for before, after in pairwise(leg.spans):
        tubes = before.first, before.last, after.first, after.last
        if not all(isinstance(section, HollowRectangle) for section in tubes):
            return np.zeros(6)
        rates = [
            np.subtract(span.last.extent, span.first.extent) / (span.end - span.start)
            for span in (before, after)
        ]
        jumps = 0.5 * np.abs(rates[1] - rates[0])
        angles = np.where(jumps > _STRAIGHT, jumps, 0.0)
        # At a step of the thickness, the walls of one side alone could bear the load.
        sides = [_at_kink(leg, after.start, tube, angles) for tube in (before.last, after.first)]
        bounds += np.maximum(*sides)
    return bounds


def _at_kink(leg: LineLeg, position: float, tube: object, jumps: Array) -> Array:
    """Contributions (6, SI) of the kink at `position` (m), with the section `tube` there.

    `jumps` are the angles α (rad) of the walls across y, and of those across z.
    """
    if not isinstance(tube, HollowRectangle):
        raise TypeError(f"{tube}: is not a rectangular tube")
    t, lever = tube.thickness, leg.length - position
    b, h = tube.width - t, tube.height - t
    plate = leg.material.E * t**3 / (12.0 * (1.0 - leg.material.nu**2))
    # Moments My and Mz at the kink due to unit loads at the tip, along or about each axis.
    tension = np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]) / tube.area
    about_y = np.array([0.0, 0.0, lever, 0.0, 1.0, 0.0]) / tube.second_moment_y
    about_z = np.array([0.0, lever, 0.0, 0.0, 0.0, 1.0]) / tube.second_moment_z
    works = np.zeros(6)
    for width, distance, jump, constant, linear in (
        (h, b, jumps[0], about_z, about_y),
        (b, h, jumps[1], about_y, about_z),
    ):
        # Tension and bending act alone, so that their squares add up.
        uniform = tension**2 + (0.5 * distance * constant) ** 2
        squares = _UNIFORM * uniform + _LINEAR * (0.5 * width * linear) ** 2
        works += 2.0 * width**4 / plate * (t * jump) ** 2 * squares
    return works
