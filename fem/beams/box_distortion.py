"""Distortion of tapered rectangular tubes in torsion: the angles between their walls change.

In torsion the walls carry the shear flow q = T/2bh, with the distances b and h of opposite walls.
In a tapered tube these distances vary along the leg, and the shear force q b of a wall varies, too.
The flow along the two inclined edges of the wall balances this variation only if b and h decrease
in the same ratio. Otherwise the walls push against each other: top and bottom with q b Δ per
length, the two sides in the opposite sense, Δ = b′/b − h′/h. The work of this load on the change γ
of the angle between walls is m γ per length, with m = T Δ/2. The walls resist γ by bending out of
their planes, as a frame, and in their planes, along the leg. Their strain energy V is

    2V = ∫ 24 D/(b* + h*) γ² + E t (b + h) b² h²/96 γ″² dx,   D = E t³/12(1 − ν²),

with the wall thickness t, and with the clear widths b* and h* between the corners, which are rigid
(V. Z. Vlasov, Thin-Walled Elastic Beams, ch. IV, for prisms). Without diaphragms the ends are free.
Due to a unit torque, the rotation of the tip grows by ∫ m γ dx. This is proportional to Δ² and to
t⁻³, whereas the twist of the tube is proportional to t⁻¹. No beam theory has this flexibility. It
is therefore one of the causes to which the report attributes a difference between beam and solid.
"""

from collections.abc import Callable

import numpy as np
from numpy.polynomial import legendre

from lumped.arrays import Array
from lumped.legs import LineLeg, Span
from lumped.sections import HollowRectangle

# Highest degree of the polynomials for γ(x), and Gauss points per span. Four degrees already differ
# by less than 1e-4 of the effect, for tapers down to one half.
_DEGREE, _POINTS = 8, 16


def distortion_work(leg: LineLeg, torques: Callable[[Array], Array]) -> float:
    """Work ∫ m γ dx (J) of torques on the distortion of a leg with ends free to distort.

    `torques` is a function that returns the torques (n, in N m) at n positions (m along the line).
    For a unit torque the work is the additional rotation of the tip (rad/(N m)). Zero if the leg is
    bent or is not a rectangular tube.
    """
    shapes = [section for _, section in leg.stations]
    if not (leg.line.is_straight and all(isinstance(shape, HollowRectangle) for shape in shapes)):
        return 0.0
    count = _DEGREE + 1
    stiffness, loads = np.zeros((count, count)), np.zeros(count)
    for span in leg.spans:
        positions, weights, per_length = _walls(leg, span)
        frame, along, coupling = per_length
        values = legendre.legvander(2.0 * positions / leg.length - 1.0, _DEGREE)
        curvatures = _curvatures(positions, leg.length)
        stiffness += values.T @ ((weights * frame)[:, None] * values)
        stiffness += curvatures.T @ ((weights * along)[:, None] * curvatures)
        loads += values.T @ (weights * coupling * torques(positions))
    return float(loads @ np.linalg.solve(stiffness, loads))


def _walls(leg: LineLeg, span: Span) -> tuple[Array, Array, tuple[Array, Array, Array]]:
    """Gauss points (n, m along the line) of a span, their weights (n, m), and factors at them.

    The three factors are the stiffness of the frame on γ² (n, in N), the stiffness along the leg on
    γ″² (n, in N m⁴), and the load m per unit torque (n, in 1/m).
    """
    points, weights = legendre.leggauss(_POINTS)
    length = span.end - span.start
    shares = 0.5 * (points + 1.0)
    ends = np.array([_middle_lines(span.first), _middle_lines(span.last)])
    b, h, t = ((1.0 - shares)[:, None] * ends[0] + shares[:, None] * ends[1]).T
    b_rate, h_rate, _ = (ends[1] - ends[0]) / length
    E, nu = leg.material.E, leg.material.nu
    plate = E * t**3 / (12.0 * (1.0 - nu**2))
    frame = 24.0 * plate / (b + h - 2.0 * t)
    along = E * t * (b + h) * (b * h) ** 2 / 96.0
    coupling = 0.5 * (b_rate / b - h_rate / h)
    return span.start + length * shares, 0.5 * length * weights, (frame, along, coupling)


def _middle_lines(section: object) -> tuple[float, float, float]:
    """Distances b, h of opposite walls of a rectangular tube, and the walls' thickness (m)."""
    if not isinstance(section, HollowRectangle):
        raise TypeError(f"{section}: is not a rectangular tube")
    t = section.thickness
    return section.width - t, section.height - t, t


def _curvatures(positions: Array, length: float) -> Array:
    """Second derivatives (n×k, 1/m²) of k Legendre polynomials at n `positions` (m).

    The polynomials are those on the interval from 0 to `length` (m).
    """
    coordinates = 2.0 * positions / length - 1.0
    second = [legendre.legder(row, 2) for row in np.eye(_DEGREE + 1)]
    values = [legendre.legval(coordinates, row) for row in second]
    return np.asarray(np.column_stack(values) * (2.0 / length) ** 2)
