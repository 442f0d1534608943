"""All five section shapes: solids with free ends against beam theory, constants by closed forms."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from fem.bodies import doubling
from fem.sections.section_constants import SectionConstants, beam_properties, section_constants
from lumped.arrays import Array
from lumped.legs import ConstantLeg, Material, tip_compliance
from lumped.sections import Circle, HollowRectangle, ISection, Rectangle, Section, Tube
from meshes.prism.hexahedra import slice_count
from meshes.section.section_mesh import section_mesh
from validation.agreement.convergence import analyse, uncertainty_of
from validation.agreement.differences import farthest_refined
from validation.case import Absolute, Measurement, Relative
from validation.case_group import CaseGroup
from validation.cases.legs.beams import ENTRIES
from validation.context import Context
from validation.solids.legs import FORMAL_ORDER

SECTION = "Section shapes"
LENGTH = 0.8
SHAPES: dict[str, Section] = {
    "rectangle": Rectangle(width=0.1, height=0.16),
    "hollow-rectangle": HollowRectangle(width=0.1, height=0.16, thickness=0.01),
    "circle": Circle(diameter=0.1),
    "tube": Tube(diameter=0.1, thickness=0.02),
    "i-section": ISection(width=0.1, height=0.16, flange=0.012, web=0.008),
}
MATERIALS = {
    "isotropic": Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0),
    # As far from isotropy as the paper's legs: G/E ≈ 2 and no contraction.
    "cubic": Material(E=2.1e11, G=4.3e11, nu=0.0, rho=7850.0),
}
_POISSON = 0.3
_ACROSS = 4
# Doubled from four, with which the meshes of every shape are similar to each other.
DIVISIONS = (4, 8, 16, 32)
_RENTON = "J. D. Renton, Int. J. Solids Struct. 27 (1991) 1901, by strain energy"
_COWPER = "G. R. Cowper, J. Appl. Mech. 33 (1966) 335, exact for this shape"
_SAINT_VENANT = "S. P. Timoshenko, J. N. Goodier, Theory of Elasticity, §§101, 109"


@dataclass(frozen=True)
class ClosedForm:
    """A constant of a shape that is known exactly: by finite elements, and its closed form."""

    quantity: str
    unit: str
    nu: float
    found: Callable[[SectionConstants], float]
    exact: float
    citation: str


cases = CaseGroup(section=SECTION, group="shape.{shape}", reference_kind="closed-form")


def free_and_beam(section: Section, material: Material, divisions: int) -> tuple[Array, Array]:
    """Diagonals of the tip compliance (6, SI): the solid with free ends, and the beam."""
    leg = ConstantLeg(LENGTH, section, material)
    mesh = section_mesh(section, divisions)
    condensed = doubling.condensed_leg(leg, mesh, slice_count(section, LENGTH, divisions))
    constants = section_constants(mesh, material.nu, material.G / material.E)
    beam = tip_compliance(beam_properties(constants, material), LENGTH)
    return np.diag(doubling.tip_compliance(condensed, "free")), np.diag(beam)


def refined_constants(section: Section, nu: float) -> tuple[SectionConstants, ...]:
    """Constants of an isotropic section on `DIVISIONS`, coarse to fine."""
    return tuple(section_constants(section_mesh(section, n), nu) for n in DIVISIONS)


@cases.case(
    "shape.{shape}.free[{material}]",
    "{shape}, {material}: with free ends the solid is the beam of its own constants",
    over={"shape": SHAPES, "material": MATERIALS},
    quantity="largest relative difference of the six diagonal tip compliances",
    unit="1",
    citation="Clapeyron's theorem on Saint-Venant's exact solution: C = ∫ of unit resultants over "
    "EA … κGA, κ by strain energy, constants by finite elements on the section",
    tolerance=Absolute(1e-4),
    tolerance_reason="nothing but the mesh is left: 8e-6 at most on these; 1e-4 is what the "
    "project asks for",
    effort=0.4,
)
def _free(context: Context, shape: str, material: str) -> Measurement:
    section, of = SHAPES[shape], MATERIALS[material]
    solid, beam = context.get(free_and_beam, section, of, _ACROSS)
    coarse_solid, coarse_beam = context.get(free_and_beam, section, of, _ACROSS // 2)
    apart, coarse = solid / beam - 1.0, coarse_solid / coarse_beam - 1.0
    return replace(
        farthest_refined(coarse, apart, order=FORMAL_ORDER),
        table={
            "compliance": tuple(name for name, (i, j, _) in ENTRIES.items() if i == j),
            "solid": tuple(solid.tolist()),
            "beam": tuple(beam.tolist()),
            "difference (%)": tuple((100.0 * apart).tolist()),
        },
    )


def _torsion(constants: SectionConstants) -> float:
    return constants.torsion_constant


def _energy_y(constants: SectionConstants) -> float:
    return constants.shear_coefficients[0]


def _energy_z(constants: SectionConstants) -> float:
    return constants.shear_coefficients[1]


def _cowper_y(constants: SectionConstants) -> float:
    return constants.cowper_coefficients[0]


def renton_rectangle(depth: float, width: float, nu: float) -> float:
    """κ of a rectangle sheared along `depth`, by strain energy, isotropic (Renton 1991)."""
    odd_and_even = np.arange(1, 60)
    ratio = width / depth
    series = ratio * float(np.sum(np.tanh(odd_and_even * np.pi / ratio) / odd_and_even**5))
    bracket = 0.2 - 18.0 / np.pi**5 * series
    return float(1.0 / (1.2 + (nu / (1.0 + nu)) ** 2 * ratio**4 * bracket))


def renton_circle(nu: float) -> float:
    """κ of a circle by strain energy: 1/κ = 7/6 + (ν/(1+ν))²/6 (Renton 1991)."""
    return 1.0 / (7.0 / 6.0 + (nu / (1.0 + nu)) ** 2 / 6.0)


def _closed_forms() -> list[tuple[str, str, ClosedForm]]:
    """Shape, name of the constant, and its form."""
    forms = []
    for shape in ("rectangle", "circle", "tube"):
        section = SHAPES[shape]
        torsion = section.torsion_constant
        forms.append(
            (
                shape,
                "J",
                ClosedForm("torsion constant", "m⁴", 0.0, _torsion, torsion, _SAINT_VENANT),
            )
        )
        for nu in (0.0, _POISSON):
            kappa, _ = section.shear_coefficients(nu)
            form = ClosedForm(
                "shear coefficient, mean displacement", "1", nu, _cowper_y, kappa, _COWPER
            )
            forms.append((shape, f"cowper,ν={nu:g}", form))
    width, height = SHAPES["rectangle"].extent
    by_energy = (
        ("rectangle", "-y", " along y", _energy_y, renton_rectangle(width, height, _POISSON)),
        ("rectangle", "-z", " along z", _energy_z, renton_rectangle(height, width, _POISSON)),
        ("circle", "", "", _energy_y, renton_circle(_POISSON)),
    )
    for shape, end, along, found, kappa in by_energy:
        quantity = f"shear coefficient{along}, strain energy"
        form = ClosedForm(quantity, "1", _POISSON, found, kappa, _RENTON)
        forms.append((shape, f"renton{end},ν={_POISSON:g}", form))
    return forms


@cases.case(
    "shape.{shape}.constant[{name}]",
    "{shape}: {form.quantity} by finite elements is the closed form",
    over={"shape, name, form": _closed_forms()},
    quantity="{form.quantity}",
    unit="{form.unit}",
    citation="{form.citation}",
    tolerance=Relative(2e-5),
    tolerance_reason="the finest mesh of 32 divisions is off by 4e-7 at most and states an "
    "uncertainty of 2e-6: ten times that",
    effort=0.1,
)
def _constant(context: Context, shape: str, form: ClosedForm) -> Measurement:
    refined = context.get(refined_constants, SHAPES[shape], form.nu)
    values = np.array([form.found(constants) for constants in refined])
    convergence = analyse(1.0 / np.array(DIVISIONS, dtype=float), values, FORMAL_ORDER)
    return Measurement(float(values[-1]), form.exact, value_uncertainty=uncertainty_of(convergence))
