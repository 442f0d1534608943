"""Torsion of tapered I-sections: flanges that are not parallel bend in their planes.

In a uniform twist θ′ the flanges move by ±u along y, u = θ h/2, with the distance h of the flanges.
If h varies, u is no linear function of x, so that each flange bends in its plane, although the leg
may warp freely at its ends (S. Kitipornchai, N. S. Trahair, J. Struct. Div. ASCE 98 (1972) 713, for
rigid sections). This stiffens torsion. It distorts the section, too: a flange rotates about x by
another angle β than the line between both flanges, by θ, and bends the web.

A flange is a plane beam with inclination α = h′/2. The rotation of its cross-section is that about
z, ψ, plus the share α β of the rotation about x. Twice the strain energy per length is

    2 (EI (ψ′ + α β′)² + κGA (h θ′/2 + α θ − α β − ψ)²) + 2 GJ_f β′²
    + GJ_w (θ′² + (β′ − θ′)²/5) + 12 D (β − θ)²/h,   α′ = 0 between stations,

with EI = E t b³/12 and κ = 5/6 of a flange of width b and thickness t, its J_f = b t³/3, the
remainder J_w of the section's torsion constant J, and the plate stiffness D of the web, which bends
by a cubic function of z. θ, β and ψ are continuous at kinks. A rigid rotation θ = β has no energy.
A torque does the work T (J_w θ′ + 2 J_f β′)/J per length. In a prism its solution is θ′ = β′ =
T/GJ, that of Saint-Venant, at free ends.

At a step, θ is continuous. β and ψ are continuous if the flanges on both sides touch each other.
Otherwise a flange ends there at the web of the other section, which holds it no more than a free
end does.

The effect grows with (h′ b/t)². Solids of tapers with and without kinks have 92 to 113 % of it.
Part of the difference are terms in α², which are neglected: inclined flanges twist and shear by
cos α less.
"""

from collections.abc import Callable, Sequence
from math import ceil

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import solve_banded

from lumped.arrays import Array, IntArray
from lumped.legs import LineLeg, Material, Span
from lumped.sections import ISection, Section

# Gauss points per element of second order, and nodes of an element.
_POINTS, _NODES = 3, 3
# Smallest number of elements per span, and elements over the distance of the flanges. With twice as
# many, the work changes by less than 1e-3 of itself.
_FEWEST, _PER_HEIGHT = 4, 4
# Unknowns per node: θ, β and ψ, and the bandwidth on either side of the diagonal. After a step, up
# to two other unknowns lie between θ and those of the next node.
_FIELDS = 3
_BAND = _FIELDS * _NODES + 1
# Largest error of the work, relative, beyond the square of the slope that comparisons allow: it is
# below 3.5 % in 70 solids of random tapers with and without kinks (slopes 0.01 to 0.15, b/t 6 to
# 50, flanges 0.5 to 2.4 times as thick as the web).
FLANGE_ERROR = 0.05
# Shear coefficient κ of a rectangle without contraction.
_SHEAR = 5.0 / 6.0


def flange_work(leg: LineLeg, torques: Callable[[Array], Array]) -> float:
    """Work (J, ≤ 0) by which flanges of a taper reduce the work of torques on a leg with free ends.

    `torques` is a function that returns the torques (n, in N m) at n positions (m along the line).
    For a unit torque the work is the change of the tip's rotation (rad/(N m)). Zero for bent legs,
    and other sections than I-sections. In legs with steps it includes the flanges that steps bend.
    In a prism flanges stay straight under a uniform torque, and bend where a torque varies.
    """
    is_profile = all(isinstance(section, ISection) for _, section in leg.stations)
    if not (is_profile and leg.line.is_straight):
        return 0.0
    counts = [_element_count(span) for span in leg.spans]
    unknowns = _unknowns(leg.spans, counts)
    size = int(unknowns[-1].max()) + 1
    diagonals, loads, uniform = np.zeros((2 * _BAND + 1, size)), np.zeros(size), 0.0
    for span, count, numbers in zip(leg.spans, counts, unknowns, strict=True):
        blocks, forces, work = _span_matrices(leg.material, span, count, torques)
        rows, columns = numbers[:, :, None], numbers[:, None, :]
        np.add.at(diagonals, (_BAND + rows - columns, columns), blocks)
        np.add.at(loads, numbers, forces)
        uniform += work
    # θ at the root, the first unknown, is zero.
    beside = np.arange(_BAND + 1)
    diagonals[_BAND - beside, beside] = 0.0
    diagonals[_BAND, 0], loads[0] = 1.0, 0.0
    return float(loads @ solve_banded((_BAND, _BAND), diagonals, loads)) - uniform


def _unknowns(spans: Sequence[Span], counts: Sequence[int]) -> list[IntArray]:
    """Numbers of the unknowns (e×9) of the e elements of each span, in the order of the matrices.

    `counts` are the numbers of elements of the spans.
    """
    of_nodes, following = np.arange(_FIELDS)[None], _FIELDS
    numbers = []
    for before, span, count in zip((None, *spans), spans, counts, strict=False):
        first = of_nodes[-1]
        if before is not None and not _touch(before.last, span.first):
            first = np.array([first[0], following, following + 1])
            following += _FIELDS - 1
        more = following + np.arange(_FIELDS * (_NODES - 1) * count).reshape(-1, _FIELDS)
        of_nodes = np.vstack([first, more])
        following += more.size
        nodes = (_NODES - 1) * np.arange(count)[:, None] + np.arange(_NODES)
        numbers.append(of_nodes[nodes].swapaxes(1, 2).reshape(count, -1))
    return numbers


def _touch(before: Section, after: Section) -> bool:
    """True if the flanges of two I-sections have a part of their thickness in common."""
    (first, _, t, *_), (second, _, t_after, *_) = _sizes(before), _sizes(after)
    return abs(second - first) < t + t_after


def _element_count(span: Span) -> int:
    height = min(_sizes(span.first)[0], _sizes(span.last)[0])
    return max(_FEWEST, ceil(_PER_HEIGHT * (span.end - span.start) / height))


def _span_matrices(
    material: Material, span: Span, count: int, torques: Callable[[Array], Array]
) -> tuple[Array, Array, float]:
    """Stiffness matrices (e×9×9) and loads (e×9) of the e = `count` elements of a span.

    The unknowns are θ of all nodes, then β, then ψ. The third value is the work (J) of the torques
    on Saint-Venant's torsion. `torques` are those of `flange_work`.
    """
    points, weights = legendre.leggauss(_POINTS)
    length = span.end - span.start
    shares = (np.arange(count)[:, None] + 0.5 * (points + 1.0)) / count
    step = 0.5 * length / count * np.broadcast_to(weights, shares.shape)
    torque = torques((span.start + length * shares).ravel()).reshape(shares.shape)
    sections = [span.section(share) for share in shares.ravel().tolist()]
    sizes = np.array([_sizes(section) for section in sections]).reshape(*shares.shape, 5)
    h, b, t, web, J = np.moveaxis(sizes, -1, 0)
    slope = 0.5 * (_sizes(span.last)[0] - _sizes(span.first)[0]) / length
    E, G, nu = material.E, material.G, material.nu

    s = points[:, None]
    values = np.hstack([0.5 * s * (s - 1.0), 1.0 - s**2, 0.5 * s * (s + 1.0)])
    rates = np.hstack([s - 0.5, -2.0 * s, s + 0.5]) * (2.0 * count / length)
    of_node = np.eye(_FIELDS)[:, None, :, None]
    # Matrices (3×1×q×9) of the fields and of their derivatives on the unknowns of an element.
    theta, beta, psi = (of_node * values[:, None, :]).reshape(_FIELDS, 1, len(points), -1)
    theta_rate, beta_rate, psi_rate = (of_node * rates[:, None, :]).reshape(
        _FIELDS, 1, len(points), -1
    )
    flanges = 2.0 * b * t**3 / 3.0
    web_torsion = J - flanges
    plate = E * web**3 / (12.0 * (1.0 - nu**2))
    shear = 0.5 * h[..., None] * theta_rate + slope * (theta - beta) - psi
    strains_and_stiffnesses = (
        (psi_rate + slope * beta_rate, E * t * b**3 / 6.0),
        (shear, 2.0 * _SHEAR * G * t * b),
        (beta_rate, G * flanges),
        (theta_rate, G * web_torsion),
        (beta_rate - theta_rate, 0.2 * G * web_torsion),
        (beta - theta, 12.0 * plate / h),
    )
    blocks = 0.0
    for strain, stiffness in strains_and_stiffnesses:
        on_points = np.broadcast_to(strain, (*shares.shape, _FIELDS * _NODES))
        blocks = blocks + np.einsum("eqi,eq,eqj->eij", on_points, step * stiffness, on_points)
    twist = (web_torsion / J)[..., None] * theta_rate + (flanges / J)[..., None] * beta_rate
    forces = np.einsum("eqi,eq->ei", twist, step * torque)
    return np.asarray(blocks), forces, float((step * torque**2 / (G * J)).sum())


def _sizes(section: Section) -> tuple[float, float, float, float, float]:
    """Distance, width and thickness of the flanges, thickness of the web (m), and J (m⁴)."""
    if not isinstance(section, ISection):
        raise TypeError(f"{section}: is not an I-section")
    height = section.height - section.flange
    return height, section.width, section.flange, section.web, section.torsion_constant
