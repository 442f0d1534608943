"""Largest errors of textbook section constants, as known limits of correct formulas.

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

Cowper's coefficient follows from a mean displacement. The beam with computed section constants has
the coefficient by strain energy (`fem.sections.section_constants`). Both are known from finite
elements. Their difference is one of definition, not an inaccuracy.
"""

from dataclasses import replace
from typing import NamedTuple, TypeAlias

from fem.sections.section_constants import SectionConstants, beam_properties
from lumped.legs import BeamProperties, ConstantLeg
from lumped.memo import memo
from lumped.sections import HollowRectangle, ISection, OutlinedSection
from validation.solids.solid_legs import leg_constants

# Softest and stiffest beam.
Band: TypeAlias = tuple[BeamProperties, BeamProperties]


class Limits(NamedTuple):
    """Smallest and largest ratio of a textbook section constant to the exact one."""

    low: float
    high: float


_EXACT = Limits(1.0, 1.0)


@memo(16)
def leg_formula_band(leg: ConstantLeg, divisions: int) -> Band:
    """Softest and stiffest beam that correct formulas allow, on the mesh of the solid's faces."""
    return formula_band(leg, leg_constants(leg, divisions))


def formula_band(leg: ConstantLeg, constants: SectionConstants) -> Band:
    """Softest and stiffest beam that correct textbook formulas allow for the section.

    `constants` are those by finite elements of the section.
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
    """Limits of the torsion constant J by formula, over the exact one."""
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
    """Limits of the shear coefficient κ by formula, over the exact κ.

    The exact κ is that by mean displacement or by strain energy.
    """

    limits: Limits
    of_mean_displacement: bool = True


def shear_limits(leg: ConstantLeg, axis: int) -> ShearLimits:
    """Limits of the shear coefficient κ along y (`axis` 0) or z (1), over the exact one."""
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
