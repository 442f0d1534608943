"""Mistakes in sections, materials, beam constants and equivalent legs."""

from dataclasses import replace
from math import inf, pi, tanh
from typing import Any

import numpy as np

from lumped.arrays import Array
from lumped.legs import BeamProperties, ConstantLeg, Material
from lumped.sections import Circle, HollowRectangle, Rectangle
from validation.faults.fault import Faulty, fault, fault_around, fault_in_value


def _with(**changes: Any) -> Any:
    """The beam's constants, some of them computed from the beam by a function."""

    def change(beam: BeamProperties) -> BeamProperties:
        return replace(beam, **{name: value(beam) for name, value in changes.items()})

    return change


def _first_terms(series: int, factor: float) -> Faulty:
    def torsion_constant(width: float, height: float) -> float:
        b, a = sorted((width, height))
        tail = sum(tanh(k * pi * a / (2.0 * b)) / k**5 for k in range(1, series, 2))
        return a * b**3 * (1.0 / 3.0 - factor / pi**5 * (b / a) * tail)

    return torsion_constant


@fault(
    "leg.three-for-twelve",
    "l³/3EI for l³/12EI in the compliance of a piece at its middle",
    "lumped.legs.BeamProperties.piece_compliance",
)
def _bending_of_a_piece(self: BeamProperties, length: float) -> Array:
    return np.diag(
        [
            length / self.EA,
            length**3 / (3.0 * self.EIz) + length / self.GAy,
            length**3 / (3.0 * self.EIy) + length / self.GAz,
            length / self.GJ,
            length / self.EIy,
            length / self.EIz,
        ]
    )


@fault_in_value(
    "leg.rotations-only",
    "Springs with rotations only: no l³/12EI, no shear",
    "lumped.legs.BeamProperties.piece_compliance",
)
def _rotations_only(compliance: Array) -> Array:
    pure = compliance.copy()
    pure[1, 1] = pure[2, 2] = 1e-9 * compliance[0, 0]
    return pure


@fault_around(
    "leg.whole-lever",
    "Lever arm L for L/2 in the coupling of deflection and rotation",
    "lumped.legs.tip_compliance",
)
def _full_lever(sound: Faulty, properties: BeamProperties, length: float) -> Array:
    found: Array = sound(properties, length)
    found = found.copy()
    found[1, 5], found[2, 4] = 2.0 * found[1, 5], 2.0 * found[2, 4]
    found[5, 1], found[4, 2] = found[1, 5], found[2, 4]
    return found


@fault_in_value("leg.coupling-sign", "Sign of c26 turned", "lumped.legs.tip_compliance")
def _opposite_coupling(compliance: Array) -> Array:
    sign = np.ones((6, 6))
    sign[1, 5] = sign[5, 1] = -1.0
    return compliance * sign


@fault_around(
    "equivalent.compliance-diagonal",
    "Equivalent leg from the diagonal of the compliance instead of the stiffness",
    "lumped.legs.equivalent_leg",
)
def _of_compliance(sound: Faulty, leg: Any, _by: str = "stiffness") -> ConstantLeg:
    found: ConstantLeg = sound(leg, "compliance")
    return found


@fault_around(
    "equivalent.planes-swapped",
    "K22 and K33 exchanged in the equivalent leg",
    "lumped.legs.constant_leg",
)
def _exchanged(sound: Faulty, length: float, **terms: float) -> ConstantLeg:
    terms["EIy"], terms["EIz"] = terms["EIz"], terms["EIy"]
    found: ConstantLeg = sound(length, **terms)
    return found


@fault_around(
    "equivalent.mass-per-length",
    "Density of the equivalent leg from its mass per area, the length forgotten",
    "lumped.legs.constant_leg",
)
def _mass_per_area(sound: Faulty, length: float, **terms: float) -> ConstantLeg:
    terms["mass"] *= length
    found: ConstantLeg = sound(length, **terms)
    return found


@fault_in_value(
    "equivalent.isotropic",
    "G = E/2(1+ν) for the equivalent leg, whose torsion is then not the given one",
    "lumped.legs.constant_leg",
)
def _isotropic_equivalent(leg: ConstantLeg) -> ConstantLeg:
    material = leg.material
    return replace(leg, material=Material.isotropic(material.E, 0.3, material.rho))


@fault("material.poisson-sign", "G = E/2(1 − ν)", "lumped.legs.Material.isotropic")
def _wrong_isotropic(_cls: type[Material], E: float, nu: float, rho: float) -> Material:
    return Material(E=E, G=E / (2.0 * (1.0 - nu)), nu=nu, rho=rho)


@fault(
    "section.hollow-bredt-outer",
    "Bredt's formula on the outline instead of the wall's middle line",
    "lumped.sections.HollowRectangle.torsion_constant",
)
def _solid_sides(shape: HollowRectangle) -> float:
    b, h, t = shape.width, shape.height, shape.thickness
    return 2.0 * (b * h) ** 2 * t / (b + h)


@fault(
    "section.hollow-bredt-half",
    "Factor 2 missing in Bredt's formula",
    "lumped.sections.HollowRectangle.torsion_constant",
)
def _half_bredt(shape: HollowRectangle) -> float:
    b, h = shape.width - shape.thickness, shape.height - shape.thickness
    return (b * h) ** 2 * shape.thickness / (b + h)


fault_in_value(
    "section.moments-swapped",
    "Iy and Iz swapped in the beam's constants",
    "lumped.legs.ConstantLeg.timoshenko",
)(_with(EIy=lambda b: b.EIz, EIz=lambda b: b.EIy))
fault_in_value(
    "section.shear-left-out",
    "Shear deformation left out of the Timoshenko beam",
    "lumped.legs.ConstantLeg.timoshenko",
)(_with(GAy=lambda _: inf, GAz=lambda _: inf))
fault_in_value(
    "section.rotary-inertia-left-out",
    "Rotary inertia of bending left out of the Timoshenko beam",
    "lumped.legs.ConstantLeg.timoshenko",
)(_with(rho_Iy=lambda _: 0.0, rho_Iz=lambda _: 0.0))
fault_in_value(
    "section.young-for-shear-modulus",
    "E for G in the torsional stiffness",
    "lumped.legs.ConstantLeg.timoshenko",
)(_with(GJ=lambda b: b.GJ * 2.6))
fault_in_value(
    "section.inertia-by-torsion-constant",
    "Rotary inertia about the axis from J instead of the polar moment",
    "lumped.legs.ConstantLeg.timoshenko",
)(_with(rho_J=lambda b: 0.85 * b.rho_J))
fault_in_value(
    "section.shear-along-wrong-axis",
    "Shear stiffnesses along y and z swapped",
    "lumped.legs.ConstantLeg.timoshenko",
)(_with(GAy=lambda b: b.GAz, GAz=lambda b: b.GAy))
fault(
    "section.rectangle-moment",
    "Iy of a rectangle from width³·height",
    "lumped.sections.Rectangle.second_moment_y",
)(lambda s: s.height * s.width**3 / 12.0)
fault(
    "section.rectangle-five-sixths",
    "Shear coefficient 5/6 whatever Poisson's ratio",
    "lumped.sections.Rectangle.shear_coefficients",
)(lambda _self, _nu: (5.0 / 6.0, 5.0 / 6.0))
fault(
    "section.rectangle-polar-torsion",
    "Polar moment for the torsion constant of a rectangle",
    "lumped.sections.rectangle_torsion_constant",
)(lambda b, h: (b * h**3 + h * b**3) / 12.0)
fault(
    "section.rectangle-torsion-factor",
    "Factor 2 missing in the series of the torsion constant",
    "lumped.sections.rectangle_torsion_constant",
)(_first_terms(200, 32.0))
fault(
    "section.rectangle-torsion-one-term",
    "One term of the torsion constant's series alone",
    "lumped.sections.rectangle_torsion_constant",
)(_first_terms(2, 64.0))
fault_in_value(
    "section.hollow-shear-swapped",
    "Shear coefficients of a hollow rectangle along the wrong walls",
    "lumped.sections.HollowRectangle.shear_coefficients",
)(lambda kappa: kappa[::-1])
fault(
    "section.tube-bore-forgotten",
    "Second moment of a tube without its bore",
    "lumped.sections.Tube.second_moment_y",
)(lambda s: Circle(s.diameter).second_moment_y)
fault(
    "section.tube-shear-of-circle",
    "Shear coefficient of a solid circle for a tube",
    "lumped.sections.Tube.shear_coefficients",
)(lambda s, nu: Circle(s.diameter).shear_coefficients(nu))
fault(
    "section.circle-radius-for-diameter",
    "Second moment of a circle with the diameter taken for the radius",
    "lumped.sections.Circle.second_moment_y",
)(lambda s: pi * s.diameter**4 / 4.0)
fault(
    "section.i-open-corners",
    "Torsion constant of an I with its full height as web",
    "lumped.sections.ISection.torsion_constant",
)(lambda s: (s.width * s.flange**3 + s.height * s.web**3) / 3.0)
fault(
    "section.i-rotated",
    "An I-section lying on its side: moments of area of the section turned by 90°",
    "lumped.sections.ISection.second_moment_y",
)(lambda s: s.second_moment_z)
fault(
    "leg.euler-bernoulli-shears",
    "The Euler–Bernoulli beam keeps its shear deformation",
    "lumped.legs.BeamProperties.as_euler_bernoulli",
)(lambda beam: replace(beam, rho_Iy=0.0, rho_Iz=0.0))
fault_in_value(
    "equivalent.section-rotated",
    "Equivalent rectangle turned by 90°, width for height",
    "lumped.legs.constant_leg",
)(lambda leg: replace(leg, section=Rectangle(leg.section.height, leg.section.width)))
