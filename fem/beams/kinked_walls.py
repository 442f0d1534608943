"""Walls of a tapered box or I-section that bend where a taper begins or ends.

At such a kink the direction of a wall jumps by the angle α. The wall's normal force n per width is
deflected there, and loads the wall by n α along the kink, across the wall. The wall bends as a
plate, so that the leg yields to tension and bending. This adds works, of which upper bounds are
known. D = E t³/12(1 − ν²) is the plate's stiffness.

Box: a wall of width w is an infinite strip whose edges do not deflect. If they were simply
supported, a load p = p₀ + p₁ 2y/w on the kink would do the work

    w⁴ (c₀ p₀² + c₁ p₁²)/D,   c₀ = 2/π⁵ Σ 1/n⁵ (n odd),   c₁ = 1/16π⁵ Σ 1/m⁵

(S. P. Timoshenko, S. Woinowsky-Krieger, Theory of Plates and Shells, ch. 5). Neighbouring walls
turn together at their common edge. With the wave number k along the box and u = kw/2, a load p cos
kx turns a simply supported edge by θ p/D, and a moment m cos kx on both edges turns it by φ m/D:

    θ = −(tanh u − u/cosh² u)/2k³,          φ = (tanh u + u/cosh² u)/2k    for p₀, equal moments,
    θ = 1/uk³ − (coth u + u/sinh² u)/2k³,   φ = (coth u − u/sinh² u)/2k    for p₁, opposite ones.

Continuity at the edges of a pair of walls with p, θ, φ and its neighbours with p′, θ′, φ′ reduces
the work by

    4/πD ∫ (θp + θ′p′)²/(φ + φ′) dk,   k from 0 to ∞.

If all walls of a square box are pressed inwards, their edges are clamped: this leaves 29 %. Solids
with walls of 1/25 of their width and slopes of 5 to 20° have 50 to 90 % of the bound in tension,
since normal stresses avoid the middle of the wall.

I-section: half a flange is an infinite strip of width c, clamped to the web at s = 0 if the load is
equal on both halves. Under bending about z the load is of opposite sense on them. Then the flange
rolls about the web's edge, against the web's resistance r = D_w/h per length and half flange, with
the plate stiffness D_w and the height h of the web. Without its resistance to twist, and since
2ν ∂²w/∂x² ∂²w/∂s² is at least −ν times the sum of both squares, the strip has at least the energy
of independent beams on elastic foundations along x,

    ½ (1 − ν) D ∫∫ (∂²w/∂x²)² + (∂²w/∂s²)² ds dx + ½ r ∫ (∂w/∂s)² dx   (last term at s = 0).

With the modes φ of a cantilever across the flange, of stiffness κ for ∫ φ² ds = 1, a load p does
the work Σ (∫ p φ ds)²/(2√2 B^¼ κ^¾), B = (1 − ν) D (M. Hetényi, Beams on Elastic Foundation).

No beam theory has this flexibility. It grows with α² and, relative to that of the leg, with
(w/t)². The bounds for tension and for both directions of bending are added.
"""

from collections.abc import Callable
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import eigh
from scipy.special import zeta

from lumped.arrays import Array
from lumped.legs import LineLeg, Material
from lumped.sections import HollowRectangle, ISection, Section

# Factors c₀ of a uniform and c₁ of a linear load. Of all terms of Σ 1/n⁵, those with odd n are
# 31/32.
_UNIFORM = float(2.0 / np.pi**5 * (31.0 / 32.0) * zeta(5))
_LINEAR = float(zeta(5) / (16.0 * np.pi**5))
# Angle (rad) below which a wall has no kink: round-off of its slopes.
_STRAIGHT = 1e-9
# Degree of the polynomials for deflections across half a flange. The works are exact to 1e-6.
_DEGREE = 8
# Number of wave numbers of integrals along the leg.
_WAVES = 24
# Half the width times the wave number below which slopes at edges are computed by series.
_SERIES = 0.1
# The same, beyond which terms that decay exponentially are zero.
_FAR = 50.0

# Width (m) of a pair of opposite walls, and m loads on them (N/m²).
_Walls: TypeAlias = tuple[float, Array]


def kink_compliances(leg: LineLeg) -> Array:
    """Upper bounds (6, SI) of what kinks of the walls add to the diagonal of the tip compliance.

    Zero in torsion, and if `kink_works` is zero.
    """

    def resultants(position: float) -> Array:
        lever = leg.length - position
        tension = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]
        about_y, about_z = [0.0, 0.0, lever, 0.0, 1.0, 0.0], [0.0, lever, 0.0, 0.0, 0.0, 1.0]
        return np.array([tension, about_y, about_z])

    return kink_works(leg, resultants)


def kink_works(leg: LineLeg, resultants: Callable[[float], Array]) -> Array:
    """Upper bounds (m, in J) of the work that m loads do by bending walls at kinks.

    `resultants` is a function that returns the tension N and the bending moments My and Mz (3×m, N
    and N m) at a position (m along the line). Zero if the leg is bent, or if its sections are not
    all boxes or all I-sections.
    """
    shapes = {type(section) for _, section in leg.stations}
    works = np.zeros(resultants(0.0).shape[1])
    if not leg.line.is_straight or shapes not in ({HollowRectangle}, {ISection}):
        return works
    for before, after in pairwise(leg.spans):
        rates = [
            np.subtract(span.last.extent, span.first.extent) / (span.end - span.start)
            for span in (before, after)
        ]
        jumps = 0.5 * (rates[1] - rates[0])
        angles = np.where(np.abs(jumps) > _STRAIGHT, jumps, 0.0)
        at_kink = resultants(after.start)
        # At a step of the thickness, the walls of one side alone could bear the load.
        sides = [
            _works(section, leg.material, angles, at_kink) for section in (before.last, after.first)
        ]
        works += np.maximum(*sides)
    return works


def _works(section: Section, material: Material, angles: Array, resultants: Array) -> Array:
    """Works (m, in J) at a kink of a section.

    `angles` α (2, rad, with sign) are those of the walls across y, and of those across z.
    `resultants` (3×m) are N, My and Mz there.
    """
    match section:
        case HollowRectangle():
            return _box_works(section, material, angles, resultants)
        case ISection():
            return _flange_works(section, material, float(angles[1]), resultants)
    raise TypeError(f"{section.shape}: is neither a rectangular tube nor an I-section")


def _stresses(section: HollowRectangle | ISection, resultants: Array) -> tuple[Array, Array, Array]:
    """Stress σ (m, in Pa) by tension, and its gradients (m, in Pa/m) along z and y by bending."""
    tension, about_y, about_z = resultants
    moments = section.second_moment_y, section.second_moment_z
    return tension / section.area, about_y / moments[0], about_z / moments[1]


def _box_works(tube: HollowRectangle, material: Material, angles: Array, loads: Array) -> Array:
    t = tube.thickness
    b, h = tube.width - t, tube.height - t
    uniform, along_z, along_y = _stresses(tube, loads)
    sides, flanges = t * angles[:, None] * np.ones_like(uniform)
    tension = _frame_work((b, flanges * uniform), (h, sides * uniform), linear=False)
    edge_z, edge_y = 0.5 * h * along_z, 0.5 * b * along_y
    about_y = _frame_work((b, flanges * edge_z), (h, sides * edge_z), linear=True)
    about_z = _frame_work((h, sides * edge_y), (b, flanges * edge_y), linear=True)
    return (tension + about_y + about_z) / _plate(material, t)


def _frame_work(first: _Walls, second: _Walls, *, linear: bool) -> Array:
    """Work (m) of m loads on the kink of a box with plate stiffness D = 1.

    `first` and `second` are pairs of opposite walls: width (m), and load (m, N/m²) at their edges.
    It is uniform on the first pair, and on the second pair as well or, if `linear`, opposite at
    their two edges.
    """
    (first_width, first_load), (second_width, second_load) = first, second
    points, weights = legendre.leggauss(_WAVES)
    # Wave numbers k from 0 to infinity, with the derivative of k.
    scale = 4.0 / (first_width + second_width)
    k, k_weights = scale * (1.0 + points) / (1.0 - points), scale * 2.0 / (1.0 - points) ** 2
    first_slope, first_softness = _edge(k, first_width, linear=False)
    second_slope, second_softness = _edge(k, second_width, linear=linear)
    slopes = np.outer(first_slope, first_load) + np.outer(second_slope, second_load)
    moments = slopes**2 / (first_softness + second_softness)[:, None]
    restrained = 4.0 / np.pi * (weights * k_weights) @ moments
    constants = _UNIFORM, _LINEAR if linear else _UNIFORM
    supported = (
        2.0 * constant * width**4 * load**2
        for constant, (width, load) in zip(constants, (first, second), strict=True)
    )
    return sum(supported) - restrained


def _edge(k: Array, width: float, *, linear: bool) -> tuple[Array, Array]:
    """Slopes at the simply supported edges of a strip per load q cos kx, and per edge moment.

    The load is uniform across the strip or, if `linear`, proportional to the distance from its
    middle, like the moments. The plate stiffness is 1.
    """
    u = 0.5 * k * width
    if not linear:
        tanh, decaying = np.tanh(u), u / np.cosh(np.minimum(u, _FAR)) ** 2
        return 0.5 * (tanh - decaying) / k**3, 0.5 * (tanh + decaying) / k
    is_small = u < _SERIES
    v = np.where(is_small, 1.0, u)
    coth, decaying = 1.0 / np.tanh(v), v / np.sinh(np.minimum(v, _FAR)) ** 2
    slope = np.where(is_small, u**3 / 45.0 - 4.0 * u**5 / 945.0, 0.5 * (coth + decaying) - 1.0 / v)
    softness = np.where(is_small, u / 3.0 - 2.0 * u**3 / 45.0, 0.5 * (coth - decaying))
    return slope / k**3, softness / k


def _flange_works(section: ISection, material: Material, angle: float, loads: Array) -> Array:
    t, half = section.flange, 0.5 * section.width
    height = section.height - t
    uniform, along_z, along_y = _stresses(section, loads)
    plate = (1.0 - material.nu) * _plate(material, t)
    web = _plate(material, section.web) / height
    clamped = _strip_work(plate, half, 0, np.inf)
    rolling = _strip_work(plate, half, 1, web)
    squares = clamped * (uniform**2 + (0.5 * height * along_z) ** 2) + rolling * along_y**2
    return np.asarray(4.0 * (t * angle) ** 2 * squares)


def _strip_work(plate: float, width: float, power: int, spring: float) -> float:
    """Work of the load s^`power` on a line across an infinite strip, 0 ≤ s ≤ `width` (m).

    `plate` (N m) is B. At s = 0 the strip does not deflect, and a `spring` (N per rad and length)
    resists its rotation there. It is infinite if the strip is clamped.
    """
    first = 2 if np.isinf(spring) else 1
    powers = np.arange(first, _DEGREE + 1)
    rows, columns = powers[:, None], powers
    mass = width / (rows + columns + 1.0)
    curvatures = np.zeros(mass.shape)
    bent = np.ix_(powers > 1, powers > 1)
    product = rows * (rows - 1) * columns * (columns - 1)
    curvatures[bent] = product[bent] / (rows + columns - 3.0)[bent]
    stiffness = plate / width**3 * curvatures
    if first == 1:
        stiffness[0, 0] += spring / width**2
    values, shapes = eigh(stiffness, mass)
    forces = shapes.T @ (width ** (power + 1) / (powers + power + 1.0))
    return float(np.sum(forces**2 / (2.0**1.5 * plate**0.25 * values**0.75)))


def _plate(material: Material, thickness: float) -> float:
    return material.E * thickness**3 / (12.0 * (1.0 - material.nu**2))
