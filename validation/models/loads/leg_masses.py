"""Plausible distributions of mass and stiffness along a leg specified by its 6×6 compliance.

Input: the 6×6 compliance of a leg, its mass and, if known, centre of mass and inertia. Output:
matrices of the leg with each plausible distribution. Rule: between its ends the leg has exactly
this compliance. Along its length it is a uniform beam with this compliance, once as soft and once
as stiff as such beams can be (`fem.beams.interior`). All distributions have the leg's mass, and its
centre of mass if it is known. Only the lumped mass can have the inertia of the robot file, since
mass along a line cannot. A verdict that is the same for all distributions holds for any leg; if
verdicts differ, more data are needed.
"""

from collections.abc import Collection, Mapping
from dataclasses import replace
from itertools import product
from typing import Literal, NamedTuple, TypeAlias, get_args

import numpy as np
from scipy.sparse import csr_array, diags_array

from fem.beams.interior import Interior, interior_beam, interior_properties
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import ENDS, ends_stiffness, held_leg
from lumped.arrays import Array, SparseMatrix
from lumped.legs import GivenLeg
from lumped.mechanism.body_model import LegMatrices

Masses: TypeAlias = Literal[
    "mass along the legs",
    "mass near the roots",
    "mass near the tips",
    "mass half at the ends",
    "mass in lumps",
]
MASSES: tuple[Masses, ...] = get_args(Masses)
_ELEMENTS = 20
# Centre of mass, as a fraction of the length, of a wedge whose mass per length decreases to zero.
# Used if the file has no centre of mass.
_CENTRES: Mapping[Masses, float] = {"mass near the roots": 1 / 3, "mass near the tips": 2 / 3}
# Extreme stiffness distributions inside a leg: any other lies between these two, and so do the
# frequencies of a robot with it.
_EXTREMES: tuple[Interior, ...] = ("soft", "stiff")
# Gauss points in each element: exact for the product of two cubics.
_POINTS = 4


class Inside(NamedTuple):
    """Distribution of mass, and of stiffness, inside the legs specified by their 6×6 compliance."""

    masses: Masses
    interior: Interior = "uniform"

    def __str__(self) -> str:
        return self.masses + ("" if self.interior == "uniform" else f", {self.interior} inside")


def plausible_insides(legs: Collection[GivenLeg]) -> tuple[Inside | None, ...]:
    """All plausible distributions of mass and stiffness inside the legs.

    First the uniform distribution, then each mass distribution with the softest and with the
    stiffest interior. (None,) if no leg is specified by its 6×6 compliance.
    """
    if not legs:
        return (None,)
    return Inside(MASSES[0]), *(
        Inside(masses, interior) for masses, interior in product(plausible_masses(legs), _EXTREMES)
    )


def plausible_masses(legs: Collection[GivenLeg]) -> tuple[Masses, ...]:
    """Names of plausible mass distributions.

    Wedges, in which the mass per length rises towards one end, are included only if the centre of
    mass of a leg is unknown.
    """
    if all(leg.mass_centre is not None for leg in legs):
        return tuple(masses for masses in MASSES if masses not in _CENTRES)
    return MASSES


def leg_with_inside(leg: GivenLeg, inside: Inside, highest: float) -> LegMatrices:
    """Stiffness and mass matrices of a leg from its compliance, with an assumed inside.

    `inside` is the distribution of mass and stiffness. The matrices are accurate up to `highest`
    (Hz). A lumped mass lies at the leg's `mass_centre`, or in the middle if that is unknown; it is
    a point mass if `inertia` is unknown. If `mass_centre` is known, wedges give the same matrices
    as mass along the leg.
    """
    return by_shapes(shapes_inside(leg, inside, highest, _ELEMENTS), leg, inside, _ELEMENTS)


def ends_mass(leg: GivenLeg, masses: Masses) -> Array:
    """Mass matrix (12×12, SI, leg axes) of a leg, condensed to the twists of its ends."""
    beam = interior_beam(leg, "uniform", _ELEMENTS)
    modes = held_leg(beam).constraint_modes
    return np.asarray(modes.T @ (_mass(beam, leg, masses, _ELEMENTS) @ modes))


def shapes_inside(leg: GivenLeg, inside: Inside, highest: float, elements: int) -> Array:
    """Shapes (n×r) of a leg's motion: static ones due to motions of the ends, then modes.

    The modes are those with both ends clamped, for frequencies up to `highest` (Hz). The beam has n
    unknowns and `elements` elements.
    """
    beam = interior_beam(leg, inside.interior, elements)
    held_beam = held_leg(beam)
    if inside.masses == "mass in lumps":
        return held_beam.constraint_modes
    mass = _mass(beam, leg, inside.masses, elements)
    return craig_bampton(replace(held_beam, mass=mass), highest).recovery


def by_shapes(shapes: Array, leg: GivenLeg, inside: Inside, elements: int) -> LegMatrices:
    """Stiffness and mass matrix of a leg, reduced to `shapes` (n×r).

    The shapes are those of this leg, or of one with a slightly different compliance; in the second
    case the matrices are accurate to first order. The beam has n unknowns and `elements` elements.
    """
    beam = interior_beam(leg, inside.interior, elements)
    stiffness = shapes.T @ (beam.stiffness @ shapes)
    stiffness_at_tip = np.linalg.inv(leg.compliance).astype(float)
    stiffness[:ENDS, :ENDS] = ends_stiffness(stiffness_at_tip, leg.length)

    def centreline(stations: Array) -> SparseMatrix:
        return csr_array(beam.centreline(stations) @ shapes)

    return LegMatrices(
        model=f"6×6, {inside.masses}",
        length=leg.length,
        stiffness=0.5 * (stiffness + stiffness.T),
        mass=shapes.T @ (_mass(beam, leg, inside.masses, elements) @ shapes),
        centreline=centreline,
    )


def _mass(beam: LegMatrices, leg: GivenLeg, masses: Masses, elements: int) -> SparseMatrix:
    """Mass matrix (n×n) of a leg: mass of sections along the leg, or one lumped mass.

    `beam` has n unknowns and `elements` elements.
    """
    if masses == "mass in lumps":
        stations = np.array([0.5 * leg.length if leg.mass_centre is None else leg.mass_centre])
        weights = np.diag([leg.mass] * 3 + [0.0] * 3)
        if leg.inertia is not None:
            weights[3:, 3:] = leg.inertia
    else:
        stations, shares = _line(leg, masses, elements)
        properties = interior_properties(leg, "uniform")
        rotary = np.array([properties.rho_J, properties.rho_Iy, properties.rho_Iz])
        of_section = np.concatenate([np.ones(3), rotary / properties.mu])
        weights = diags_array((leg.mass * shares[:, None] * of_section).ravel())
    twists = csr_array(beam.centreline(stations))
    return csr_array(twists.T @ weights @ twists)


def _line(leg: GivenLeg, masses: Masses, elements: int) -> tuple[Array, Array]:
    """Stations (n, m from the root) and the share (n) of the leg's mass at each.

    The leg has `elements` beam elements. `masses` must not be the lumped mass.
    """
    centre = _CENTRES.get(masses, 0.5)
    if leg.mass_centre is not None:
        centre = leg.mass_centre / leg.length
    points, weights = np.polynomial.legendre.leggauss(_POINTS)
    starts = np.arange(elements)[:, None]
    positions = ((starts + 0.5 * (1.0 + points)) / elements).ravel()
    # Mass per length is a power k of the distance from the lighter end: its centre of mass lies at
    # the fraction (k + 1)/(k + 2) of the length from there.
    farther = max(centre, 1.0 - centre)
    power = (2.0 * farther - 1.0) / (1.0 - farther)
    shares = np.tile(weights, elements) * (positions if centre >= 0.5 else 1.0 - positions) ** power
    shares *= 1.0 / shares.sum()
    # Gauss points integrate a fractional power with a relative error of 1e-5. A linear factor
    # corrects the centre of mass.
    mean = shares @ positions
    shares *= 1.0 + (centre - mean) * (positions - mean) / (shares @ (positions - mean) ** 2)
    if masses == "mass half at the ends":
        positions = np.concatenate([positions, [0.0, 1.0]])
        shares = 0.5 * np.concatenate([shares, [1.0 - centre, centre]])
    return leg.length * positions, shares
