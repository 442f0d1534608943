"""Guards of sections and solids: textbook constants, uniform strains, two ways through one mesh."""

from collections.abc import Iterator

import numpy as np

from fem.bodies import doubling, solid
from fem.bodies.solid import Ends
from fem.elements.elasticity import mass, stiffness
from fem.sections.section_constants import SectionConstants, beam_properties, section_constants
from lumped.arrays import Array
from lumped.legs import ConstantLeg, Material, tip_compliance
from lumped.models.chains import axis_rotation
from lumped.sections import Circle, HollowRectangle, ISection, Rectangle, Section, Tube
from meshes.elements import SolidElement
from meshes.prism.hexahedra import hexahedra
from meshes.prism.tetrahedra import tetrahedra
from meshes.section.section_mesh import section_mesh
from meshes.solid_mesh import SolidMesh
from validation.agreement.convergence import step_factor
from validation.agreement.differences import both_refined, scaled_difference
from validation.case import Absolute, Measurement, Relative, Tolerance
from validation.case_group import CaseGroup
from validation.cases.legs.beams import UNITS
from validation.cases.program.guards.robot import SECTION
from validation.context import Context
from validation.models.legs import constant_leg_of
from validation.solids.legs import CORNER_ORDER, FORMAL_ORDER, section_counts, similar_mesh, slices

COWPER = "G. R. Cowper, J. Appl. Mech. 33 (1966) 335, against finite elements on the section"
NU = 0.3
# Solid shapes and a thick tube have exact textbook constants; the others are for thin walls.
SECTIONS: dict[str, tuple[Section, int]] = {
    "rectangle": (Rectangle(0.08, 0.14), 8),
    "circle": (Circle(0.1), 8),
    "tube": (Tube(0.1, 0.02), 4),
    "hollow-rectangle": (HollowRectangle(0.1, 0.16, 0.001), 2),
    "hollow-square": (HollowRectangle(0.12, 0.12, 0.001), 2),
    "i-section": (ISection(0.12, 0.2, 0.002, 0.001), 1),
    "i-section-wide": (ISection(0.2, 0.16, 0.001, 0.002), 1),
}
_EXACT = Relative(1e-3), "closed form; quadratic elements on arcs and in shear, order four"
_THIN = Relative(0.015), "thin-wall formula: wall over side is 0.01, edges and corners count once"
_FLANGES = (
    Relative(0.15),
    "the flanges as two rectangles of their own: what the web adds is left out",
)
QUANTITIES: dict[str, tuple[str, str]] = {
    "area": ("area", "m²"),
    "Iy": ("second moment of area about y", "m⁴"),
    "Iz": ("second moment of area about z", "m⁴"),
    "J": ("torsion constant", "m⁴"),
    "κy": ("shear coefficient along y", "1"),
    "κz": ("shear coefficient along z", "1"),
}
_CUBIC = Material(E=2.1e11, G=0.6e11, nu=0.3, rho=7850.0)
_BLOCK = Rectangle(0.08, 0.14)
_BLOCK_LENGTH = 0.3
_GRADIENT = np.array([[1.0, 0.3, -0.2], [-0.5, 0.7, 0.4], [0.6, -0.1, -0.8]])
# Walls thick enough for few elements, Poisson's ratio and shear unlike along y and z.
_HOLLOW = ConstantLeg(
    0.6, HollowRectangle(0.08, 0.16, 0.016), Material.isotropic(2.1e11, NU, 7850.0)
)
_FREE_ENTRIES = (("c22", (1, 1)), ("c33", (2, 2)), ("c44", (3, 3)), ("c35", (2, 4)))
ELEMENTS: tuple[SolidElement, ...] = ("hex8", "hex27", "tet4", "tet10")

cases = CaseGroup(section=SECTION)


def _constants() -> Iterator[tuple[str, str, str, str, Tolerance, str]]:
    """Shape, name, meaning and unit of each constant, and how near its textbook formula is."""
    for shape, (section, _) in SECTIONS.items():
        for name, (meaning, unit) in QUANTITIES.items():
            thin = isinstance(section, HollowRectangle | ISection) and name in {"J", "κy", "κz"}
            near = _THIN if thin else _EXACT
            if isinstance(section, ISection) and name == "κy":
                near = _FLANGES
            yield shape, name, meaning, unit, *near


def constants_by_mesh(section: Section, divisions: int) -> SectionConstants:
    """Constants of the section by finite elements, isotropic, ν = 0.3."""
    return section_constants(section_mesh(section, divisions), NU)


@cases.case(
    "guard.section.{shape}[{name}]",
    "Textbook {quantity} of a section ({shape})",
    over={"shape, name, quantity, unit, tolerance, tolerance_reason": tuple(_constants())},
    reference_kind="independent-solver",
    citation=lambda name: (
        COWPER if name in {"κy", "κz"} else "finite elements on the section's own mesh"
    ),
    group="guard.sections",
    effort=0.02,
)
def _constant(context: Context, shape: str, name: str) -> Measurement:
    section, divisions = SECTIONS[shape]
    coarse, found = (
        _of_mesh(context.get(constants_by_mesh, section, number), name)
        for number in (divisions, 2 * divisions)
    )
    cornered = isinstance(section, HollowRectangle | ISection)
    order = CORNER_ORDER if cornered else FORMAL_ORDER
    # The isotropic material of 1 Pa makes the beam's constants those of the section.
    unit = Material.isotropic(1.0, NU, 1.0)
    beam = ConstantLeg(1.0, section, unit).timoshenko
    textbook = {
        "area": beam.EA,
        "Iy": beam.EIy,
        "Iz": beam.EIz,
        "J": beam.GJ / unit.G,
        "κy": beam.GAy / unit.G / beam.EA,
        "κz": beam.GAz / unit.G / beam.EA,
    }
    return Measurement(
        float(textbook[name]),
        found,
        reference_uncertainty=step_factor(2.0, order) * abs(found - coarse),
    )


def _of_mesh(constants: SectionConstants, name: str) -> float:
    along_y, along_z = constants.cowper_coefficients
    return float(
        {
            "area": constants.area,
            "Iy": constants.second_moment_y,
            "Iz": constants.second_moment_z,
            "J": constants.torsion_constant,
            "κy": along_y,
            "κz": along_z,
        }[name]
    )


def block(element: SolidElement) -> SolidMesh:
    """A rectangular block in one kind of element."""
    match element:
        case "hex8" | "hex27":
            return hexahedra(_BLOCK, _BLOCK_LENGTH, 1, element, slices=3)
        case "tet4":
            return tetrahedra(_BLOCK, _BLOCK_LENGTH, 1, order=1)
        case _:
            return tetrahedra(_BLOCK, _BLOCK_LENGTH, 1, order=2)


@cases.case(
    "guard.element.{kind}[{element}]",
    "{element}: {kind} energy of a linear displacement is exact (cubic material)",
    over={"element": ELEMENTS, "kind, unit": (("strain", "J"), ("kinetic", "kg m²"))},
    quantity="twice the {kind} energy",
    reference_kind="closed-form",
    citation="V (C11 Σεii² + 2 C12 Σεii εjj + C44 Σγij²), ρ∫|Hx|² dV on a rectangular block",
    tolerance=Relative(1e-9),
    tolerance_reason="every element holds linear displacements exactly (patch test)",
    group="guard.elements",
    effort=0.05,
)
def _energy(context: Context, element: SolidElement, kind: str) -> Measurement:
    mesh = context.get(block, element)
    motion = (mesh.nodes @ _GRADIENT.T).ravel()
    if kind == "strain":
        found = motion @ (stiffness(mesh, _CUBIC) @ motion)
        return Measurement(float(found), _exact_strain_energy(), exact=True)
    found = motion @ (mass(mesh, _CUBIC.rho) @ motion)
    return Measurement(float(found), _exact_kinetic_energy(), exact=True)


def _exact_strain_energy() -> float:
    E, G, nu = _CUBIC.E, _CUBIC.G, _CUBIC.nu
    # Compliance of a cubic material: εii = (σii − ν(σjj + σkk))/E, γij = τij/G.
    normal = np.linalg.inv((np.eye(3) * (1.0 + nu) - nu) / E)
    strain = np.diag(_GRADIENT)
    shears = (_GRADIENT + _GRADIENT.T)[np.triu_indices(3, 1)]
    volume = _BLOCK.width * _BLOCK.height * _BLOCK_LENGTH
    return float(volume * (strain @ normal @ strain + G * shears @ shears))


def _exact_kinetic_energy() -> float:
    b, h, l = _BLOCK.width, _BLOCK.height, _BLOCK_LENGTH
    second_moments: Array = b * h * l * np.diag([l**2 / 3.0, b**2 / 12.0, h**2 / 12.0])
    return float(_CUBIC.rho * np.trace(_GRADIENT @ second_moments @ _GRADIENT.T))


@cases.case(
    "guard.material.isotropic[{axis}]",
    "A solid of isotropic material does not know its axes: strain turned about {axis}",
    over={"axis": "xyz"},
    quantity="twice the strain energy of the strain turned by 45°",
    unit="J",
    reference_kind="closed-form",
    citation="isotropy: the energy of a strain does not depend on its direction",
    tolerance=Relative(1e-9),
    tolerance_reason="linear displacements are exact in every element",
    group="guard.elements",
    effort=0.05,
)
def _isotropy(context: Context, axis: str) -> Measurement:
    mesh = context.get(block, "hex8")
    energies = stiffness(mesh, Material.isotropic(2.1e11, NU, 7850.0))
    turned = axis_rotation(np.eye(3)["xyz".index(axis)], np.pi / 4.0)

    def energy(gradient: Array) -> float:
        motion = (mesh.nodes @ gradient.T).ravel()
        return float(motion @ (energies @ motion))

    return Measurement(energy(turned @ _GRADIENT @ turned.T), energy(_GRADIENT), exact=True)


def hollow_compliances(divisions: int) -> tuple[Array, Array]:
    """Tip compliances (6×6, SI) of a hollow leg: solid with free ends, and beam."""
    section = section_mesh(_HOLLOW.section, divisions)
    condensed = doubling.condensed_leg(_HOLLOW, section, slices(_HOLLOW, divisions))
    own = beam_properties(section_constants(section, NU), _HOLLOW.material)
    return doubling.tip_compliance(condensed, "free"), tip_compliance(own, _HOLLOW.length)


@cases.case(
    "guard.solid.free-ends[{name}]",
    "Hollow leg with ends free to warp: {name} of the solid is the beam's",
    over={"name, entry": _FREE_ENTRIES},
    quantity="compliance {name}",
    unit=lambda entry: UNITS[entry[0] > 2, entry[1] > 2],
    reference_kind="independent-solver",
    citation="Timoshenko cantilever with the constants of its own section mesh, κ by energy",
    tolerance=Relative(1e-3),
    tolerance_reason="beam theory is exact for Saint-Venant's ends; a coarse mesh of the walls",
    model="solid",
    group="guard.free-ends",
    effort=0.3,
)
def _free_ends(context: Context, entry: tuple[int, int]) -> Measurement:
    coarse, fine = (
        (float(by_solid[entry]), float(by_beam[entry]))
        for by_solid, by_beam in (context.get(hollow_compliances, number) for number in (2, 4))
    )
    # Both have the corners of one section mesh in common: what is left is smooth.
    return both_refined(coarse, fine, order=CORNER_ORDER, apart=FORMAL_ORDER)


@cases.case(
    "guard.leg{number}.two-ways[{ends}]",
    "Leg {number}: compliance by doubling and by one sparse system ({ends} ends)",
    over={"number": (1, 2), "ends": ("rigid", "free")},
    quantity="largest difference of the 6×6 in units of √(c_ii c_jj)",
    unit="1",
    reference_kind="independent-solver",
    citation="sparse Cholesky of the whole mesh (fem.bodies.solid), the same elements",
    tolerance=Absolute(1e-7),
    tolerance_reason="one discrete model solved in two ways: rounding, by the condition of a "
    "slender solid",
    group="guard.leg{number}.two-ways",
    effort=0.5,
)
def _two_ways(context: Context, number: int, ends: Ends) -> Measurement:
    leg = constant_leg_of(context, f"leg{number}")
    divisions = 1 if isinstance(leg.section, Rectangle) else 4
    counts = section_counts(leg, divisions)
    section = section_mesh(leg.section, counts)
    condensed = doubling.condensed_leg(leg, section, slices(leg, divisions))
    whole = solid.clamped_leg(solid.solid_leg(leg, similar_mesh(leg, divisions)), ends)
    return Measurement(
        scaled_difference(doubling.tip_compliance(condensed, ends), solid.tip_compliance(whole)),
        0.0,
        exact=True,
    )
