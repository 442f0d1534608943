"""Hexahedra against tetrahedra: two mesh families that share nothing but the outline.

Extruded quadratic hexahedra and gmsh's unstructured second-order tetrahedra, each refined by
itself, each with its own discretisation uncertainty; rigid end faces, root clamped. They agree
where their finest values differ by no more than both uncertainties together.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import hypot

import numpy as np

from fem.bodies.leg_modes import modes
from fem.bodies.solid import clamped_leg, solid_leg, tip_compliance
from lumped.arrays import Array
from lumped.legs import ConstantLeg, Material
from lumped.sections import Circle, Rectangle
from meshes.prism.hexahedra import hexahedra
from meshes.prism.tetrahedra import tetrahedra
from meshes.solid_mesh import SolidMesh
from validation.case import Absolute, Measurement, Skip
from validation.case_group import CaseGroup
from validation.cases.legs.beams import UNITS
from validation.context import Context, Preset
from validation.exhibits import Study
from validation.models.legs import constant_leg_of
from validation.solids.legs import FORMAL_ORDER, Refinement, section_counts

SECTION = "Mesh families"
PRESETS: tuple[Preset, ...] = ("standard", "fine")
MODES = 3
# Diagonal compliances, then frequencies: what both families compute.
QUANTITIES = {
    **{f"c{i}{i}": i - 1 for i in (2, 3, 4)},
    **{f"f{k}": 5 + k for k in range(1, MODES + 1)},
}
# Smaller sides that a refinement may fill with elements: 36 unknowns per cube of the mesh size.
_UNKNOWNS_PER_CUBE, _LARGEST = 36, 80_000


@dataclass(frozen=True)
class TwoFamilies:
    """A leg and the divisions of both families per preset."""

    leg: Callable[[Context], ConstantLeg]
    tetrahedra: dict[Preset, tuple[int, ...]]
    hexahedra: dict[Preset, tuple[int, ...]]
    meaning: str


def _rod(_context: Context) -> ConstantLeg:
    return ConstantLeg(0.12, Circle(0.1), Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0))


def _first_leg(context: Context) -> ConstantLeg:
    leg = constant_leg_of(context, "leg1")
    if not isinstance(leg.section, Rectangle):
        raise Skip(
            f"leg 1 is a {leg.section.shape}: families of equal proportions are made for solid "
            "rectangles; curved sides are compared on the round rod"
        )
    smaller, larger = sorted(leg.section.extent)
    cubes = larger * leg.length / smaller**2
    unknowns = _UNKNOWNS_PER_CUBE * cubes * SUBJECTS["leg1"].tetrahedra[context.preset][-1] ** 3
    if unknowns > _LARGEST:
        raise Skip(
            f"leg 1 is {cubes:.0f} cubes of its smaller side long and wide: about "
            f"{unknowns:.1g} unknowns on the finest mesh, more than {_LARGEST:g}"
        )
    return leg


SUBJECTS = {
    "leg1": TwoFamilies(
        _first_leg,
        {"standard": (1, 2, 3, 4), "fine": (1, 2, 3, 4, 5)},
        {"standard": (1, 2, 3), "fine": (1, 2, 3, 4)},
        "leg 1",
    ),
    # Round meshes are similar to each other for multiples of four alone; below five divisions
    # gmsh's least number of sides of a circle keeps tetrahedra as they are.
    "rod": TwoFamilies(
        _rod,
        {"standard": (5, 6, 8), "fine": (5, 6, 8, 12)},
        {"standard": (4, 8), "fine": (4, 8, 12)},
        "a short round rod",
    ),
}

cases = CaseGroup(section=SECTION)


def by_hexahedra(leg: ConstantLeg, divisions: tuple[int, ...]) -> Refinement:
    """Six diagonal compliances (SI), then frequencies (Hz), on extruded meshes (m×(6+modes))."""
    return Refinement(divisions, np.array([_solved(leg, _extruded(leg, n)) for n in divisions]))


def by_tetrahedra(leg: ConstantLeg, divisions: tuple[int, ...]) -> Refinement:
    """The same on unstructured tetrahedra."""
    meshes = (tetrahedra(leg.section, leg.length, n) for n in divisions)
    return Refinement(divisions, np.array([_solved(leg, mesh) for mesh in meshes]))


def uncertainty(found: Refinement, index: int) -> float:
    """Numerical uncertainty of the finest value, at least the last step.

    Unstructured meshes are not similar to each other: an order that is high by chance must not
    make the uncertainty smaller than what one refinement has just changed.
    """
    before, finest = found.values[-2:, index]
    return max(found.uncertainty(index), float(abs(finest - before)))


def _extruded(leg: ConstantLeg, divisions: int) -> SolidMesh:
    """Slices about as long as an element of the section is wide, as similar as the sections are."""
    slices = divisions * round(leg.length / min(leg.section.extent))
    return hexahedra(leg.section, leg.length, section_counts(leg, divisions), slices=slices)


def _solved(leg: ConstantLeg, mesh: SolidMesh) -> Array:
    clamped = clamped_leg(solid_leg(leg, mesh))
    compliance = np.diag(tip_compliance(clamped))
    return np.concatenate([compliance, modes(clamped, MODES).frequencies])


@cases.case(
    "mesh-families.{subject}[{name}]",
    lambda subject, name: (
        f"Hexahedra and tetrahedra agree on {name} of {SUBJECTS[subject].meaning}"
    ),
    over={"subject": SUBJECTS, "name": QUANTITIES},
    quantity="difference of the families over their combined numerical uncertainty",
    unit="1",
    reference_kind="finer-model",
    citation="tet10 by gmsh's unstructured mesher against extruded hex27; GCI per family "
    "(Roache 1994; Celik et al. 2008), root sum of squares",
    tolerance=Absolute(1.0),
    tolerance_reason="the stated uncertainties are the claim: no difference beyond them",
    presets=PRESETS,
    group="mesh-families.{subject}",
    effort=1.0,
)
def _compare(context: Context, subject: str, name: str) -> Measurement:
    chosen, index = SUBJECTS[subject], QUANTITIES[name]
    leg = chosen.leg(context)
    families = {
        "tetrahedra": context.get(by_tetrahedra, leg, chosen.tetrahedra[context.preset]),
        "hexahedra": context.get(by_hexahedra, leg, chosen.hexahedra[context.preset]),
    }
    tets, hexes = (float(found.values[-1, index]) for found in families.values())
    own = {family: uncertainty(found, index) for family, found in families.items()}
    combined = hypot(*own.values())
    unit = UNITS[(index > 2, index > 2)] if index < 6 else "Hz"
    return Measurement(
        (tets - hexes) / combined,
        0.0,
        value_uncertainty=own["tetrahedra"] / combined,
        reference_uncertainty=own["hexahedra"] / combined,
        # Both together, which is the unit of the value.
        judged_uncertainty=1.0,
        notes=(
            f"tetrahedra {tets:.7g} ± {own['tetrahedra']:.2g} {unit}, hexahedra {hexes:.7g} ± "
            f"{own['hexahedra']:.2g} {unit}: {100.0 * (tets / hexes - 1.0):+.2g} % apart, "
            f"{100.0 * combined / hexes:.2g} % uncertain",
        ),
        studies=tuple(
            _study(subject, name, family, found, own[family], unit)
            for family, found in families.items()
        ),
    )


def _study(subject: str, name: str, family: str, found: Refinement, own: float, unit: str) -> Study:
    index = QUANTITIES[name]
    enough = len(found.divisions) >= 4
    convergence = found.at(index) if enough else None
    order = convergence.observed_order if convergence else None
    limit = convergence.extrapolated if convergence else None
    label = f"{family} {name}"
    return Study(
        id=f"mesh-families.{subject}.{name}.{family}",
        kind="convergence",
        title=f"{SUBJECTS[subject].meaning.capitalize()} in {family}: {name}",
        x_label="divisions of the smaller side",
        y_label=f"{name} ({unit})",
        unit=unit,
        x=tuple(float(n) for n in found.divisions),
        series={label: tuple(found.values[:, index].tolist())},
        formal_order=FORMAL_ORDER,
        orders={} if order is None else {label: order},
        uncertainties={label: own},
        limits={} if limit is None else {label: limit},
        notes=() if enough else ("Too few meshes to show an order.",),
        family=f"mesh-families.{subject}.{name}",
        family_title=f"{SUBJECTS[subject].meaning.capitalize()}: {name}",
    )
