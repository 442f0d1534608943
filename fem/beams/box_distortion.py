"""Distortion of tapered rectangular tubes in torsion: the angles between their walls change.

In torsion the walls carry the shear flow q = T/2bh, with the distances b and h of opposite walls.
In a tapered tube these distances vary along the leg, and the shear force q b of a wall varies, too.
The flow along the two inclined edges of the wall balances this variation only if b and h decrease
in the same ratio. Otherwise the walls push against each other: top and bottom with q b Δ per
length, the two sides in the opposite sense, Δ = b′/b − h′/h. The work of this load on the change γ
of the angle between walls is m γ per length, with m = T Δ/2. The walls resist γ by bending out of
their planes, as a frame, and by strains in their planes, along the leg (V. Z. Vlasov, Thin-Walled
Elastic Beams, ch. IV, for prisms).

Walls are plane between stations. At x, top and bottom move by V = −(θ/2 + γ/4) h along y, the sides
by W = (θ/2 − γ/4) b along z, and the corner with y, z > 0 by u along the leg. To first order in the
slopes of the walls, the shear strains g of top and g* of the side, and the strain ε of the corner's
edge, are

    g = V′ + (2u + h′W)/b,   g* = W′ + (2u + b′V)/h,   ε = u′ + (h′W′ + b′V′)/2,

all zero for a rotation θ. The rotation, γ and u are continuous at kinks of the walls, but V′, W′
and γ′ are not. Twice the strain energy per length is

    2Gt (b g² + h g*²) + ⅔ E t (b + h) ε² + k γ² + p γ′²

with the frame stiffness k (`fem.sections.wall_frame`) and the stiffness p of bent walls in torsion,

    p = D ((1 − ν)(b + h) + 2ν (b² + h²)/(b + h) + ⅘ (b³ + h³)/(b + h)²),   D = E t³/12(1 − ν²).

Bredt's torsion, θ′ = T (b + h)/2Gtb²h², has γ = 0 and strains the edges of a taper by

    ε = T ((h′ − b′)/2 + b h′/h − h b′/b + (b − h) t′/2t)/4Gtbh.

Both loads, m on γ and this ε, disappear in prisms and in tubes that shrink in all dimensions alike.
Without diaphragms the ends are free. Due to a unit torque, the rotation of the tip grows by an
amount proportional to Δ² and to t⁻³, whereas the twist of the tube is proportional to t⁻¹. No beam
theory has this flexibility. It is therefore one of the causes to which the report attributes a
difference between beam and solid.
"""

from collections.abc import Callable
from math import ceil

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import solve_banded

from fem.sections.wall_frame import formula_frame_stiffness
from lumped.arrays import Array
from lumped.legs import ConstantLeg, LineLeg, Span
from lumped.sections import HollowRectangle

# Degree of the elements, smallest number of elements per span and Gauss points per element. With
# elements as long as the smaller distance of the walls, the work is in error by 1e-6.
_DEGREE, _FEWEST, _POINTS = 4, 2, 7
# Fractions of a span at which the frame stiffness is computed. Its ratio to that by formula, 1.00
# to 1.25, is interpolated.
_FRAMES = np.array([0.0, 0.5, 1.0])
# Index of θ at the root among the unknowns (γ, θ, u) of each node. It is zero.
_HELD = 1


def distortion_work(
    leg: LineLeg,
    torques: Callable[[Array], Array],
    frame_stiffness: Callable[[ConstantLeg], float] = formula_frame_stiffness,
) -> float:
    """Work (J) of torques on the distortion of a leg with ends free to distort.

    `torques` is a function that returns the torques (n, in N m) at n positions (m along the line).
    For a unit torque the work is the additional rotation of the tip (rad/(N m)). Zero if the leg is
    bent or is not a rectangular tube. `frame_stiffness` is a function that returns the frame
    stiffness k (N) of a prism; its section is that of the leg at one position.
    """
    shapes = [section for _, section in leg.stations]
    if not (leg.line.is_straight and all(isinstance(shape, HollowRectangle) for shape in shapes)):
        return 0.0
    counts = [_element_count(span) for span in leg.spans]
    size, band = 3 * (_DEGREE * sum(counts) + 1), 3 * _DEGREE + 2
    diagonals, loads, restrained = np.zeros((2 * band + 1, size)), np.zeros(size), 0.0
    first = 0
    for span, count in zip(leg.spans, counts, strict=True):
        blocks, forces, energy = _span_matrices(leg, span, count, torques, frame_stiffness)
        starts = _DEGREE * np.arange(first, first + count)
        nodes = starts[:, None] + np.arange(_DEGREE + 1)
        unknowns = (3 * nodes[:, None, :] + np.arange(3)[:, None]).reshape(count, -1)
        rows, columns = unknowns[:, :, None], unknowns[:, None, :]
        np.add.at(diagonals, (band + rows - columns, columns), blocks)
        np.add.at(loads, unknowns, forces)
        restrained += energy
        first += count
    beside = np.arange(_HELD + band + 1)
    diagonals[band + _HELD - beside, beside] = 0.0
    diagonals[band, _HELD], loads[_HELD] = 1.0, 0.0
    return float(loads @ solve_banded((band, band), diagonals, loads) - restrained)


def _element_count(span: Span) -> int:
    width = min(min(_middle_lines(section)[:2]) for section in (span.first, span.last))
    return max(_FEWEST, ceil((span.end - span.start) / width))


def _span_matrices(
    leg: LineLeg,
    span: Span,
    count: int,
    torques: Callable[[Array], Array],
    frame_stiffness: Callable[[ConstantLeg], float],
) -> tuple[Array, Array, float]:
    """Stiffness matrices (e×3n×3n) and loads (e×3n) of the e = `count` elements of a span.

    The unknowns of the n nodes of an element are γ of all nodes, then θ, then u. The third value is
    twice the energy (J) of edges that are kept at the strains ε of Bredt's torsion. `torques` and
    `frame_stiffness` are those of `distortion_work`.
    """
    points, weights = legendre.leggauss(_POINTS)
    length = span.end - span.start
    shares = (np.arange(count)[:, None] + 0.5 * (points + 1.0)) / count
    scaled = np.broadcast_to(0.5 * length / count * weights, shares.shape)
    torque = torques((span.start + length * shares).ravel()).reshape(shares.shape)
    ends = np.array([_middle_lines(section) for section in (span.first, span.last)])
    b, h, t = np.moveaxis((1.0 - shares)[..., None] * ends[0] + shares[..., None] * ends[1], 2, 0)
    b_rate, h_rate, t_rate = (ends[1] - ends[0]) / length
    E, G, nu = leg.material.E, leg.material.G, leg.material.nu

    values, rates = _basis(points, length / count)
    shape = (*shares.shape, _DEGREE + 1)
    none = np.zeros(shape)
    values, rates = np.broadcast_to(values, shape), np.broadcast_to(rates, shape)

    def motion(width: Array, rate: float, of_rotation: float) -> tuple[Array, Array]:
        """Displacement (`of_rotation` θ − γ/4) `width` of a wall, and its derivative along the leg.

        Both are matrices (e×q×3n) on the unknowns. `width` (e×q, in m) has the derivative `rate`.
        """
        size = width[..., None]
        slopes = size * rates + rate * values
        return (
            np.concatenate([-0.25 * size * values, of_rotation * size * values, none], axis=-1),
            np.concatenate([-0.25 * slopes, of_rotation * slopes, none], axis=-1),
        )

    V, V_rate = motion(h, float(h_rate), -0.5)
    W, W_rate = motion(b, float(b_rate), 0.5)
    u, u_rate = (np.concatenate([none, none, field], axis=-1) for field in (values, rates))
    gamma, gamma_rate = (np.concatenate([field, none, none], axis=-1) for field in (values, rates))
    edge = u_rate + 0.5 * (h_rate * W_rate + b_rate * V_rate)
    along = 2.0 / 3.0 * E * t * (b + h)
    plate = E * t**3 / (12.0 * (1.0 - nu**2))
    twist = (1.0 - nu) * (b + h) + 2.0 * nu * (b**2 + h**2) / (b + h)
    twist += 0.8 * (b**3 + h**3) / (b + h) ** 2
    frame = _frame_stiffnesses(leg, span, frame_stiffness, shares)
    strains_and_stiffnesses = (
        (V_rate + (2.0 * u + h_rate * W) / b[..., None], 2.0 * G * t * b),
        (W_rate + (2.0 * u + b_rate * V) / h[..., None], 2.0 * G * t * h),
        (edge, along),
        (gamma, frame),
        (gamma_rate, plate * twist),
    )
    blocks = sum(
        np.einsum("eqi,eq,eqj->eij", strain, scaled * per_length, strain)
        for strain, per_length in strains_and_stiffnesses
    )
    edge_strain = 0.5 * (h_rate - b_rate) + b * h_rate / h - h * b_rate / b
    edge_strain += 0.5 * (b - h) * t_rate / t
    edge_strain *= torque / (4.0 * G * t * b * h)
    load = 0.5 * torque * (b_rate / b - h_rate / h)
    forces = np.einsum("eqi,eq->ei", gamma, scaled * load)
    forces -= np.einsum("eqi,eq->ei", edge, scaled * along * edge_strain)
    return np.asarray(blocks), forces, float((scaled * along * edge_strain**2).sum())


def _basis(points: Array, length: float) -> tuple[Array, Array]:
    """Values (q×n) and derivatives (1/m) of an element's n shape functions at q points on [−1, 1].

    `length` (m) is that of the element.
    """
    nodes = np.linspace(-1.0, 1.0, _DEGREE + 1)
    from_nodes = np.linalg.inv(legendre.legvander(nodes, _DEGREE))
    slopes = [legendre.legval(points, legendre.legder(row)) for row in np.eye(_DEGREE + 1)]
    values = legendre.legvander(points, _DEGREE) @ from_nodes
    return values, np.column_stack(slopes) @ from_nodes * (2.0 / length)


def _frame_stiffnesses(
    leg: LineLeg, span: Span, frame_stiffness: Callable[[ConstantLeg], float], shares: Array
) -> Array:
    """Frame stiffness k (N, …) at fractions `shares` (…) of the length of a span.

    `frame_stiffness` is that of `distortion_work`.
    """

    def prism(share: float) -> ConstantLeg:
        return ConstantLeg(span.end - span.start, span.section(share), leg.material)

    ratios = []
    for share in _FRAMES.tolist():
        section = prism(share)
        ratios.append(frame_stiffness(section) / formula_frame_stiffness(section))
    fitted = np.polynomial.Polynomial.fit(_FRAMES, ratios, len(_FRAMES) - 1)
    formula = [formula_frame_stiffness(prism(share)) for share in shares.ravel().tolist()]
    return np.asarray(fitted(shares) * np.reshape(formula, shares.shape))


def _middle_lines(section: object) -> tuple[float, float, float]:
    """Distances b, h of opposite walls of a rectangular tube, and the walls' thickness (m)."""
    if not isinstance(section, HollowRectangle):
        raise TypeError(f"{section}: is not a rectangular tube")
    t = section.thickness
    return section.width - t, section.height - t, t
