"""Error limits of correct textbook formulas for section constants.

Input: a leg of constant section, and its section constants by finite elements. Output: the softest
and the stiffest beam that correct formulas allow. Rule: areas and second moments of area are exact
for all sections, and so are the torsion constants and Cowper's shear coefficients of rectangle,
circle and tube (`lumped.sections`). The constants of outlines are computed by boundary elements,
with shear coefficients by strain energy, and count as exact. Formulas for thin walls of thickness t
use the middle lines of the walls, which enclose a width b and a height h. The relative errors of
these formulas are of first order in thickness over width:

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
        Parts of different Poisson's ratios ν restrain each other's contraction. The formulas
        neglect this restraint, so they are lower bounds of EA and EI. An upper bound of EA is the
        strain energy if the whole section contracts with one ratio ν̄. Summed over the parts, it is
        Σ (E A + 4 k A (ν − ν̄)²), with the plane-strain bulk modulus k = E/2(1 + ν)(1 − 2ν) and
        ν̄ = Σ k A ν/Σ k A. The upper bounds of EI have the second moments of area of the parts
        instead of their areas A.
        Shear stiffness is computed with one mean ratio νm for all parts. The shear modulus
        G = E/2(1 + ν) of a part is then (1 + ν)/(1 + νm) times its exact value, and κ is that of a
        ratio between the smallest and the largest ν. The flexibility in shear lies between the
        bounds of both effects (minimum of complementary energy).

laminate
        The formulas add the layers of the wall as if each were a section of its own, with strains
        that all layers have in common. Layers have thicknesses tᵢ, and the wall has t = Σ tᵢ. E is
        the modulus of the wall in tension, and g the ratio of the largest shear modulus of a layer
        to the smallest.

        Tube of middle radius r: the formulas omit that layers at different radii strain each
        other along the circumference, contract across the wall, and couple tension and twist. The
        relative errors of EA, EI and GJ by this, of first order in t/r, are known from exact
        elasticity of the tube (`fem.sections.layered_ring`). The bound is their amount and (t/r)²,
        for the curved elements of coarse section meshes. Shear across the wall is softer than
        shear in the plane of the wall by up to g: the error of κ is at most g (t/r)².

        Box: at the corners, a share c = 2t/(b + h) of the area, layers of one wall end at layers of
        the next one. There they do not have common strains, or they carry a further axial stress
        with the ratio s = Σ |σ| tᵢ/Et, where σ is the stress along the circumference for a unit
        axial strain. EA and EI are in error by c (d + s) + c², where d is the relative loss of
        tensile stiffness if the layers were not bonded. The errors of J and κ are those of a box of
        one material, but g times as large and of either sign.

        Unbalanced layup: tension and shear of the wall are coupled. The formulas assume that the
        wall can shear freely under tension, and stretch freely under shear. In a tube, strains
        differ from this assumption by a ratio t/r away from the middle radius; in a box they differ
        entirely at the corners. The energy of the coupling then changes, in second order if all
        layers are alike, otherwise in first order. The following ratios of energies limit the
        change. A is the stiffness of the wall and a = A⁻¹, with index 1 along the axis, 2 along the
        circumference and 6 for shear. Stresses and strains in p are those of the wall in tension,
        in p' and d' those of the wall in shear. All are relative to the energy under that load:
        w = a16²/(a11 a66 − a16²) + 1 − 1/(a66 A66), p = Σ |τ γ| tᵢ,
        p' = Σ (|σx εx| + |σs εs|) tᵢ and d' = Σ |τ − γ Q̄66/(a66 A66)| |γ| tᵢ.
        Tube: the error of shear grows by (p' + d') t/r + w (t/r)².
        Box: EA and EI lose the share l = c (d + s + s' + w + p + p') + c², a relative error of
        l/(1 − l), where s' = Σ |τ| tᵢ/Et. For EI, c = 2t/(b + h/3) is the share of the corners in
        the second moment of area. The error of J grows by c (w + p'), and that of κ by (w + p') t
        over the height of the web.

        These expressions estimate the terms that the theory omits. Finite elements confirm them for
        layups of carbon fibres up to E1/E2 = 53, and of glass.

Cowper's coefficient follows from a mean displacement. The beam with computed section constants has
the coefficient by strain energy (`fem.sections.section_constants`). Both are known from finite
elements. Their difference is one of definition, not an inaccuracy.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import sqrt
from typing import NamedTuple, TypeAlias

import numpy as np

from fem.sections.layered_ring import ring_stiffnesses, thin_wall_stiffnesses
from fem.sections.section_constants import SectionConstants, beam_properties
from lumped.beam_properties import BeamProperties
from lumped.legs import ConstantLeg
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
    """Softest and stiffest beam that correct textbook formulas allow for the section of a leg.

    They are bounds about the section constants by finite elements, on the section mesh that the
    solid has with this number of `divisions`.
    """
    return mesh_formula_band(leg, face_mesh(leg, divisions))


def mesh_formula_band(leg: ConstantLeg, mesh: SectionMesh) -> Band:
    """Softest and stiffest beam that correct textbook formulas allow for the section of a leg.

    They are bounds about the section constants by finite elements on `mesh`.
    """
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
        name: getattr(exact, name) / _restraint_factor(section, share)
        for name, share in shares.items()
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


def _restraint_factor(section: Composite, shares: Sequence[float]) -> float:
    """Largest ratio of a stiffness to its value by formula, due to restrained contraction.

    `shares` are the areas of the parts for EA, or their second moments of area for EI. The formula
    is the sum of E × share over the parts.
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
    """Largest relative errors of the formulas for a wall of layers.

    The keys are the stiffnesses "EA", "EIy", "EIz", "GJ", "GAy" and "GAz".
    """
    thickness, thicknesses = section.thickness, section.thicknesses
    tension = float(section.tensions @ thicknesses)
    hoop = float(np.abs(section.hoop_stresses) @ thicknesses) / tension
    ratio = section.shear_ratio
    b, h = (size - thickness for size in section.extent)
    coupled = _coupled_shares(section)
    if isinstance(section, LaminateTube):
        slope = 2.0 * thickness / b
        exact = ring_stiffnesses(section)
        omitted = {
            name: abs(stiffness / exact[name] - 1.0)
            for name, stiffness in thin_wall_stiffnesses(section).items()
        }
        stretches = tuple(omitted[name] + slope**2 for name in ("EA", "EIy", "EIz"))
        twist = omitted["GJ"] + slope**2
        added = coupled.shear * slope + coupled.wall * slope**2
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
    """Ratios of energies by which the coupling of tension and shear in a wall causes errors.

    `wall` is w, `tension` is p, `energy` is p', `shear` is p' + d' and `stress` is s'. These
    symbols are defined in the module docstring under "Unbalanced layup".
    """

    wall: float = 0.0  # w
    tension: float = 0.0  # p
    energy: float = 0.0  # p'
    shear: float = 0.0  # p' + d'
    stress: float = 0.0  # s'


def _coupled_shares(section: Laminate) -> _Shares:
    """Ratios of energies of an unbalanced layup. All are zero for a balanced layup."""
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
    """Limits of the ratio of the shear coefficient κ by formula to the exact κ.

    `axis` is the direction of the shear force: 0 for y, 1 for z.
    """
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
