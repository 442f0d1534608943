"""Error limits of correct textbook formulas for section constants.

Input: a leg of constant section, and its section constants by finite elements. Output: the softest
and the stiffest beam that correct formulas allow. Rule: areas and second moments of area are exact
for all sections, and so are the torsion constants and Cowper's shear coefficients of rectangle,
circle and tube (`lumped.sections`). For outlines, constants are computed on the rim by boundary
elements, and shear coefficients by strain energy. Formulas for thin walls, of thickness t, use the
middle lines of the walls. Their errors are of first order in thickness over width:

box     Torsion constant J: Bredt's formula treats the corners, t×t, as walls. They are stiffer, at
        most rigid, which shortens the line about the hole from 2 (b + h) to 2 (b + h) − 4t.
        Shear coefficient κ: Cowper's formula ends the webs at the middle lines of the flanges. In
        fact they extend to the outer faces, t/2 farther at both ends: the error is at most t over
        the height of the web.
I       Torsion constant: J = Σ b t³/3 omits 2αD⁴ where web and flanges join, with the thicknesses w
        of the web and f of the flanges, α = −0.042 + 0.2204 w/f − 0.0725 (w/f)² and D = f + w²/4f.
        It includes 0.42 f⁴ for four free ends, which do not contribute, and the length f of the web
        inside the joints (A. A. El Darwish, B. G. Johnston, J. Struct. Div. ASCE 91 (1965) 203).
        Shear coefficient along the web: the web ends at the middle lines of the flanges, as for the
        box. If the web is thicker than the flanges, the joints are as deep as the web is thick.
        Shear coefficient along the flanges, which count as rectangles of width b: the web stiffens
        their middle over its thickness w, at most like a rigid body. A share of 1.5² w/1.2b of the
        strain energy of shear is there. The ν in Cowper's κ belongs to a mean displacement: κ is up
        to 12 (1 + ν)/(12 + 11ν) times the coefficient by strain energy.

composite
        Parts of different Poisson's ratios restrain each other's contraction, which the formulas
        leave out. They are lower bounds of EA and EI. With a contraction of one ratio ν̄ over the
        section, the strain energy gives the upper bounds Σ (E A + 4 k A (ν − ν̄)²), with the plane
        strain bulk modulus k = E/2(1 + ν)(1 − 2ν) and ν̄ = Σ k A ν/Σ k A, and with second moments
        of area for A. Shear is computed with one mean ν for all parts, so that their moduli G = E/2
        (1 + ν) are in error by (1 + ν) over 1 plus the mean, and κ is that of one ν between the
        smallest and the largest: the flexibility in shear is within both (minimum of complementary
        energy).

laminate
        Layers are sections of their own with common strains, in a wall of thickness t. If they
        have different stiffnesses, tension and bending leave stresses σ along the circumference,
        whose resultant is zero. In a tube of middle radius r they work on the differences of the
        circumferential strain, up to (1 + c) t/2r of the axial strain, with the wall's ratio of
        contraction c: a relative error of s (1 + c) t/2r with s = Σ |σ| t/Et. Radial stresses,
        and the couplings that layers of inclined fibres keep at different radii, are of second
        order in t/r. The wall is softer in shear across than along it, by the ratio g of the
        largest to the smallest shear modulus: relative errors are at most (t/r)² for EA and EI,
        (1 + g)/4 times that for GJ and g times that for shear.
        At the corners of a box, a share c = 2t/(b + h) of the area, layers end on others: they
        are free from common strains, or have a stress s along the axis. EA and EI are in error by
        c (d + s), with the share d by which layers on their own are less stiff than together, and
        by c². J and κ are in error as those of a box, to either side and times g.
        An unbalanced layup couples tension and shear of the wall. Strains differ from those of free
        coupling by t/r at other radii, and entirely at corners. The energy that comes with the
        coupling changes in second order if layers are alike, otherwise in first. Its shares are,
        with a = A⁻¹ of the wall, w = a16²/(a11 a66 − a16²) + 1 − 1/a66 A66; p = Σ |τ γ| t of the
        layers in tension; p' = Σ (|σx εx| + |σs εs|) t and d' = Σ |τ − γ Q̄66/(a66 A66)| |γ| t in
        shear. A tube has p t/r + w (t/r)² more error in EA and EI, and (p' + d') t/r + w (t/r)²
        in GJ and shear. In a box EA and EI lose the share l = c (d + s + s' + w + p + p') + c², an
        error of l/(1 − l), with s' = Σ |τ| t/Et and, for EI, the share c = 2t/(b + h/3) of the
        corners in the second moment. J and κ have c (w + p') and (w + p') t over the web's height
        more. These are sizes of the terms that theory omits, checked by finite elements.
        The factors hold for layups of carbon fibres up to E1/E2 = 53, and of glass.

Cowper's coefficient follows from a mean displacement. The beam with computed section constants has
the coefficient by strain energy (`fem.sections.section_constants`). Both are known from finite
elements. Their difference is one of definition, not an inaccuracy.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import sqrt
from typing import NamedTuple, TypeAlias

import numpy as np

from fem.sections.section_constants import SectionConstants, beam_properties
from lumped.legs import BeamProperties, ConstantLeg
from lumped.memo import memo
from lumped.sections import (
    Composite,
    HollowRectangle,
    ISection,
    Laminate,
    LaminateTube,
    OutlinedSection,
)
from meshes.section.section_mesh import SectionMesh
from validation.solids.leg_meshes import face_mesh
from validation.solids.solid_legs import mesh_constants, mesh_properties

# Softest and stiffest beam.
Band: TypeAlias = tuple[BeamProperties, BeamProperties]


class Limits(NamedTuple):
    """Smallest and largest ratio of a textbook section constant to the exact one."""

    low: float
    high: float


_EXACT = Limits(1.0, 1.0)
# Largest relative error that is accepted as that of a formula.
_LARGEST_ERROR = 0.5


@memo(16)
def leg_formula_band(leg: ConstantLeg, divisions: int) -> Band:
    """Softest and stiffest beam that correct formulas allow, from exact constants on a mesh.

    The mesh has `divisions` and is that of the end faces of the solid.
    """
    return mesh_formula_band(leg, face_mesh(leg, divisions))


def mesh_formula_band(leg: ConstantLeg, mesh: SectionMesh) -> Band:
    """Softest and stiffest beam that correct formulas allow, from exact constants on `mesh`."""
    if isinstance(leg.section, Composite):
        return composite_band(leg.section, mesh_properties(leg, mesh))
    if isinstance(leg.section, Laminate):
        return laminate_band(leg.section, mesh_properties(leg, mesh))
    return formula_band(leg, mesh_constants(leg, mesh))


def composite_band(section: Composite, exact: BeamProperties) -> Band:
    """Softest and stiffest beam by formulas for sections of several materials.

    `exact` has section constants by finite elements.
    """
    parts = section.parts
    ratios = [part.nu for part in parts]
    if min(ratios) == max(ratios):
        return exact, exact
    *_, mean_ratio, _ = section.mean_material
    of_shear = [(1.0 + mean_ratio) / (1.0 + ratio) for ratio in ratios]
    kappas = np.array([section.shear_coefficients(ratio) for ratio in (mean_ratio, *ratios)])
    spread = kappas / kappas[0]
    shares = {
        "EA": [part.section.area for part in parts],
        "EIy": [moments[1, 1] for moments in section.part_moments],
        "EIz": [moments[0, 0] for moments in section.part_moments],
    }
    softer = {
        name: getattr(exact, name) / _held_share(section, share) for name, share in shares.items()
    }
    return (
        replace(
            exact,
            **softer,
            GAy=exact.GAy / max(of_shear) / spread[:, 0].max(),
            GAz=exact.GAz / max(of_shear) / spread[:, 1].max(),
        ),
        replace(
            exact,
            GAy=exact.GAy / min(of_shear) / spread[:, 0].min(),
            GAz=exact.GAz / min(of_shear) / spread[:, 1].min(),
        ),
    )


def _held_share(section: Composite, shares: Sequence[float]) -> float:
    """Largest ratio of a stiffness with restrained contraction to the sum of E × share.

    `shares` are areas or second moments of area of the parts.
    """
    E, nu = (np.array([getattr(part, name) for part in section.parts]) for name in ("E", "nu"))
    areas = np.array(shares)
    bulk = areas * E / (2.0 * (1.0 + nu) * (1.0 - 2.0 * nu))
    mean = (bulk @ nu) / bulk.sum()
    return float(1.0 + 4.0 * (bulk @ (nu - mean) ** 2) / (areas @ E))


def laminate_band(section: Laminate, exact: BeamProperties) -> Band:
    """Softest and stiffest beam by classical laminate theory for thin walls of layers.

    `exact` has section constants by finite elements.
    """
    errors = laminate_errors(section)

    def bound(sign: float) -> BeamProperties:
        factors = {name: 1.0 + sign * error for name, error in errors.items()}
        changed = {name: getattr(exact, name) * factor for name, factor in factors.items()}
        # Each coupling keeps its share of the geometric mean of both flexibilities.
        couplings = {
            name: getattr(exact, name) / sqrt(factors[first] * factors[second])
            for name, first, second in (
                ("twist_x", "EA", "GJ"),
                ("turn_y", "GAy", "EIy"),
                ("turn_z", "GAz", "EIz"),
            )
        }
        return replace(exact, **changed, **couplings)

    return bound(-1.0), bound(1.0)


def laminate_errors(section: Laminate) -> dict[str, float]:
    """Largest relative errors, by name, of the section constants of a wall of layers."""
    thickness, thicknesses = section.thickness, section.thicknesses
    tension = float(section.tensions @ thicknesses)
    hoop = float(np.abs(section.hoop_stresses) @ thicknesses) / tension
    ratio = section.shear_ratio
    b, h = (size - thickness for size in section.extent)
    coupled = _coupled_shares(section)
    if isinstance(section, LaminateTube):
        slope = 2.0 * thickness / b
        contraction = abs(section.mean_material[2])
        stretch = hoop * (1.0 + contraction) * 0.5 * slope + slope**2
        stretch += coupled.tension * slope + coupled.wall * slope**2
        stretches = (stretch,) * 3
        added = coupled.shear * slope + coupled.wall * slope**2
        twist = 0.25 * (1.0 + ratio) * slope**2 + added
        shears = (ratio * slope**2 + added,) * 2
    else:
        corners = 2.0 * thickness / (b + h)
        alone = 1.0 - float(section.lone_tensions @ thicknesses) / tension
        if section.is_balanced:
            stretches = (corners * (alone + hoop) + corners**2,) * 3
        else:
            shares = corners, 2.0 * thickness / (b + h / 3.0), 2.0 * thickness / (h + b / 3.0)
            freed = alone + hoop + coupled.stress + coupled.tension
            freed += coupled.wall + coupled.energy
            lost = [min(share * freed + share**2, _LARGEST_ERROR) for share in shares]
            stretches = (
                lost[0] / (1.0 - lost[0]),
                lost[1] / (1.0 - lost[1]),
                lost[2] / (1.0 - lost[2]),
            )
        factor = coupled.wall + coupled.energy
        twist = (ratio + factor) * corners
        shears = (ratio + factor) * thickness / b, (ratio + factor) * thickness / h
    errors = dict(zip(("EA", "EIy", "EIz"), stretches, strict=True))
    errors |= {"GJ": twist, "GAy": shears[0], "GAz": shears[1]}
    return {name: min(error, _LARGEST_ERROR) for name, error in errors.items()}


class _Shares(NamedTuple):
    """Shares of the energy of a wall that tension and shear couple in, by the module docstring."""

    wall: float = 0.0  # w
    tension: float = 0.0  # p
    energy: float = 0.0  # p'
    shear: float = 0.0  # p' + d'
    stress: float = 0.0  # s'


def _coupled_shares(section: Laminate) -> _Shares:
    """Shares of an unbalanced layup, zero for a balanced one."""
    if section.is_balanced:
        return _Shares()
    thicknesses, a = section.thicknesses, np.linalg.inv(section.wall)
    stiffnesses = np.array([layer.stiffness for layer in section.layers])
    free = 1.0 / (a[2, 2] * section.wall[2, 2])
    # Strains (εx, εs, γ), and stresses of the layers, under a unit force, and under a unit flow.
    (stretched, pulled), (sheared, flows) = ((a[:, n], stiffnesses @ a[:, n]) for n in (0, 2))
    energies = thicknesses @ np.abs(flows * sheared) / a[2, 2]
    uneven = np.abs(flows[:, 2] - free * stiffnesses[:, 2, 2] * sheared[2])
    energy = float(energies[0] + energies[1])
    return _Shares(
        wall=float(a[0, 2] ** 2 / (a[0, 0] * a[2, 2] - a[0, 2] ** 2) + 1.0 - free),
        tension=float(thicknesses @ np.abs(pulled[:, 2] * stretched[2]) / a[0, 0]),
        energy=energy,
        shear=energy + float(thicknesses @ uneven),
        stress=float(thicknesses @ np.abs(pulled[:, 2])),
    )


def formula_band(leg: ConstantLeg, constants: SectionConstants) -> Band:
    """Softest and stiffest beam that correct textbook formulas allow for the section.

    `constants`: section constants by finite elements.
    """
    exact_beam = beam_properties(constants, leg.material)
    torsion = torsion_limits(leg)
    softer, stiffer = exact_beam, exact_beam
    for name, axis in (("GAy", 0), ("GAz", 1)):
        shear = shear_limits(leg, axis)
        if shear.of_mean_displacement:
            definition = constants.cowper_coefficients[axis] / constants.shear_coefficients[axis]
        else:
            definition = 1.0
        exact_stiffness = definition * getattr(exact_beam, name)
        softer = replace(softer, **{name: shear.limits.low * exact_stiffness})
        stiffer = replace(stiffer, **{name: shear.limits.high * exact_stiffness})
    return (
        replace(softer, GJ=torsion.low * exact_beam.GJ),
        replace(stiffer, GJ=torsion.high * exact_beam.GJ),
    )


def torsion_limits(leg: ConstantLeg) -> Limits:
    """Smallest and largest ratio of the torsion constant J by formula to the exact J."""
    section = leg.section
    if isinstance(section, HollowRectangle):
        b, h = section.width - section.thickness, section.height - section.thickness
        return Limits(1.0 - 2.0 * section.thickness / (b + h), 1.0)
    if isinstance(section, ISection):
        f, w, b = section.flange, section.web, section.width
        walls = (2.0 * b * f**3 + (section.height - f) * w**3) / 3.0
        alpha = max(0.0, -0.042 + 0.2204 * w / f - 0.0725 * (w / f) ** 2)
        joints = 2.0 * alpha * (f + w**2 / (4.0 * f)) ** 4
        ends = 0.42 * f**4 + f * w**3 / 3.0
        return Limits(walls / (walls + joints), walls / (walls - ends))
    return _EXACT


class ShearLimits(NamedTuple):
    """Smallest and largest ratio of the shear coefficient κ by formula to the exact κ.

    The exact κ follows from the mean displacement if `of_mean_displacement`, otherwise from the
    strain energy.
    """

    limits: Limits
    of_mean_displacement: bool = True


def shear_limits(leg: ConstantLeg, axis: int) -> ShearLimits:
    """Ratios of the shear coefficient κ by formula to the exact κ, along y (`axis` 0) or z (1)."""
    section = leg.section
    if isinstance(section, HollowRectangle):
        web = section.extent[axis] - section.thickness
        return ShearLimits(Limits(1.0 - section.thickness / web, 1.0))
    if isinstance(section, ISection) and axis == 1:
        joint = max(section.flange, section.web)
        return ShearLimits(Limits(1.0 - joint / (section.height - section.flange), 1.0))
    if isinstance(section, ISection):
        nu = leg.material.shear_nu
        stiffened = 1.5**2 / 1.2 * section.web / section.width
        of_nu = 12.0 * (1.0 + nu) / (12.0 + 11.0 * nu)
        limits = Limits(min(1.0, of_nu) - stiffened, max(1.0, of_nu) + stiffened)
        return ShearLimits(limits, of_mean_displacement=False)
    return ShearLimits(_EXACT, of_mean_displacement=not isinstance(section, OutlinedSection))
