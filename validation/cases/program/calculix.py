"""The solid model beside CalculiX on one mesh of second-order tetrahedra: an independent solver.

Both programs solve the same discrete equations, so that the last printed digit counts, but for
one integral: CalculiX sums the mass of C3D10 over the four points of its stiffness, which are
exact to degree 2 where products of shape functions have 4. Frequencies are therefore compared with
CalculiX's rule on both sides, and what the rule does to them is shown to vanish with the mesh.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from fem.bodies.leg_modes import modes
from fem.bodies.solid import clamped_leg, solid_leg, tip_compliance
from fem.calculix.leg import compliance_and_frequencies, mass_at_stiffness_points
from lumped.arrays import Array
from lumped.legs import ConstantLeg, Material
from lumped.sections import ISection, Rectangle, Tube
from meshes.prism.tetrahedra import tetrahedra
from validation.agreement.convergence import order_of_errors
from validation.agreement.differences import scaled_difference
from validation.case import Absolute, Measurement, Relation, Relative, others
from validation.case_group import CaseGroup
from validation.context import PRESETS, Context, Preset
from validation.exhibits import Study

SECTION = "CalculiX"
CITATION = "CalculiX CrunchiX, G. Dhondt, C3D10 elements, same mesh and rigid faces (*EQUATION)"
MODES = 20
# Relative rounding of seven printed digits; frequencies are roots of the printed eigenvalues.
PRINTED, PRINTED_ROOT = 5e-7, 2.5e-7
_STEEL = Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0)
# Neither shear modulus nor contraction of an isotropic material.
_CUBIC = Material(E=2.1e11, G=0.6e11, nu=0.2, rho=7850.0)
_LATER: tuple[Preset, ...] = ("standard", "fine")


@dataclass(frozen=True)
class Specimen:
    """A leg, its divisions in tetrahedra, and the presets that solve it."""

    leg: ConstantLeg
    divisions: int
    presets: tuple[Preset, ...]


# Short legs with thick walls: few elements, every kind of surface.
SPECIMENS = {
    "rectangle": Specimen(ConstantLeg(0.4, Rectangle(width=0.08, height=0.12), _STEEL), 1, PRESETS),
    "cubic": Specimen(ConstantLeg(0.3, Rectangle(width=0.08, height=0.12), _CUBIC), 1, PRESETS),
    "tube": Specimen(ConstantLeg(0.1, Tube(diameter=0.1, thickness=0.02), _STEEL), 1, _LATER),
    "i-section": Specimen(
        ConstantLeg(0.15, ISection(width=0.08, height=0.1, flange=0.025, web=0.03), _STEEL),
        1,
        _LATER,
    ),
}
# A shorter rectangle, its refinement and its modes, for what CalculiX's mass does to them.
MASS_LEG = ConstantLeg(0.24, Rectangle(width=0.08, height=0.12), _STEEL)
MASS_DIVISIONS: dict[Preset, tuple[int, ...]] = {
    "quick": (2, 3, 4),
    "standard": (2, 3, 4),
    "fine": (2, 3, 4, 5, 6),
}
MASS_MODES = 8


@dataclass(frozen=True)
class SideBySide:
    """CalculiX's and our tip compliance (6×6, SI) and frequencies (Hz) of one leg on one mesh.

    `same_mass` has our frequencies with CalculiX's mass, `frequencies` those with the exact one.
    """

    elements: int
    their_compliance: Array
    compliance: Array
    their_frequencies: Array
    frequencies: Array
    same_mass: Array


cases = CaseGroup(section=SECTION)
_specimens = cases.family(
    over={"name": SPECIMENS},
    reference_kind="independent-solver",
    citation=CITATION,
    presets=lambda name: SPECIMENS[name].presets,
    group="calculix.{name}",
    effort=1.0,
)


def side_by_side(leg: ConstantLeg, divisions: int) -> SideBySide:
    """The leg clamped with rigid end faces, by both programs; raises as `run_calculix` does."""
    mesh = tetrahedra(leg.section, leg.length, divisions)
    their_compliance, their_frequencies = compliance_and_frequencies(mesh, leg.material, MODES)
    exact = solid_leg(leg, mesh)
    clamped = clamped_leg(exact)
    coarse_mass = mass_at_stiffness_points(mesh, leg.material.rho)
    coarse = replace(clamped, mass=clamped.ends.clamped_mass(coarse_mass))
    return SideBySide(
        elements=len(mesh.cells),
        their_compliance=their_compliance,
        compliance=tip_compliance(clamped),
        their_frequencies=their_frequencies,
        frequencies=modes(clamped, MODES).frequencies,
        same_mass=modes(coarse, MODES).frequencies,
    )


def mass_rule_effect(leg: ConstantLeg, divisions: int) -> float:
    """Relative change of the first frequencies by CalculiX's mass rule, root mean square."""
    mesh = tetrahedra(leg.section, leg.length, divisions)
    clamped = clamped_leg(solid_leg(leg, mesh))
    coarse_mass = mass_at_stiffness_points(mesh, leg.material.rho)
    coarse = replace(clamped, mass=clamped.ends.clamped_mass(coarse_mass))
    exact, with_rule = (modes(model, MASS_MODES).frequencies for model in (clamped, coarse))
    return float(np.sqrt(np.mean(np.square(with_rule / exact - 1.0))))


def _solved(context: Context, name: str) -> SideBySide:
    specimen = SPECIMENS[name]
    return context.get(side_by_side, specimen.leg, specimen.divisions)


def against_printed(own: Mapping[str, Array], theirs: Array, note: str) -> Measurement:
    """Frequencies (Hz), of `own` by name the first, held against CalculiX's mode by mode."""
    names = [f"mode {k + 1}" for k in range(len(theirs))]
    judged = next(iter(own.values()))
    uncertainty = PRINTED_ROOT * theirs
    return Measurement(
        float(judged[0]),
        float(theirs[0]),
        reference_uncertainty=float(uncertainty[0]),
        elsewhere=others(names, judged, theirs, uncertainty, 0),
        notes=(note,),
        table={
            "mode": tuple(float(k) for k in range(1, len(theirs) + 1)),
            "CalculiX (Hz)": tuple(theirs.tolist()),
            **{f"{name} (Hz)": tuple(found.tolist()) for name, found in own.items()},
        },
    )


@_specimens.case(
    "calculix.{name}.compliance",
    "{name}: the tip compliance is CalculiX's on the same mesh",
    quantity="largest entry of the difference over √(Cii Cjj), all 36",
    unit="1",
    tolerance=Absolute(1e-6),
    tolerance_reason="CalculiX prints seven digits, ±5e-7; the same equations leave no more",
)
def _compliance(context: Context, name: str) -> Measurement:
    found = _solved(context, name)
    diagonals = [np.diag(matrix) for matrix in (found.compliance, found.their_compliance)]
    return Measurement(
        scaled_difference(found.their_compliance, found.compliance),
        0.0,
        reference_uncertainty=PRINTED,
        notes=(f"{found.elements} tetrahedra of second order",),
        table={
            "entry": tuple(f"c{i}{i}" for i in range(1, 7)),
            "flexproof": tuple(diagonals[0].tolist()),
            "CalculiX": tuple(diagonals[1].tolist()),
        },
    )


@_specimens.case(
    "calculix.{name}.frequencies",
    f"{{name}}: {MODES} frequencies with CalculiX's mass rule are CalculiX's on the same mesh",
    quantity=f"the natural frequency of the first {MODES} that is farthest off",
    unit="Hz",
    tolerance=Relative(1e-6),
    tolerance_reason="CalculiX prints seven digits of the eigenvalue, ±2.5e-7 of its root; with "
    "its mass rule the equations are the same",
)
def _frequency(context: Context, name: str) -> Measurement:
    found = _solved(context, name)
    theirs = found.their_frequencies
    # Frequencies with CalculiX's mass are judged; how far they are from the exact ones is the
    # business of the order case.
    apart = np.abs(found.same_mass / theirs - 1.0)
    worst = int(np.argmax(apart))
    rule = found.frequencies / found.same_mass - 1.0
    return Measurement(
        float(found.same_mass[worst]),
        float(theirs[worst]),
        reference_uncertainty=PRINTED_ROOT * float(theirs[worst]),
        notes=(
            f"mode {worst + 1} of {MODES} is farthest off, by {apart[worst]:.1g}; the mass rule "
            f"changes frequencies by up to {100.0 * np.abs(rule).max():.2g} % on this mesh",
        ),
        table={
            "mode": tuple(float(k) for k in range(1, MODES + 1)),
            "flexproof (Hz)": tuple(found.frequencies.tolist()),
            "with CalculiX's mass (Hz)": tuple(found.same_mass.tolist()),
            "CalculiX (Hz)": tuple(theirs.tolist()),
        },
    )


@cases.case(
    "calculix.mass-rule.order",
    "What CalculiX's mass rule does to frequencies vanishes with the mesh",
    quantity="fitted order in the divisions of the section",
    unit="1",
    reference_kind="closed-form",
    citation="U. Banerjee, J. E. Osborn, Numer. Math. 56 (1990) 735: a rule exact to degree "
    "2k − 2 for elements of degree k = 2 leaves eigenvalues an error of order h³",
    tolerance=Absolute(0.75),
    tolerance_reason="at least order 3 less 0.75: unstructured meshes are not similar to each "
    "other, three and more of them show their order to within a half",
    relation=Relation.AT_LEAST,
    presets=_LATER,
    group="calculix.mass-rule",
    effort=2.0,
)
def _mass_order(context: Context) -> Measurement:
    divisions = MASS_DIVISIONS[context.preset]
    effects = np.array([context.get(mass_rule_effect, MASS_LEG, number) for number in divisions])
    order = order_of_errors(1.0 / np.array(divisions, dtype=float), effects)
    label = f"first {MASS_MODES} frequencies, root mean square"
    return Measurement(
        order,
        3.0,
        # Meshes that are not similar scatter: what leaving the coarsest out changes.
        value_uncertainty=abs(
            order - order_of_errors(1.0 / np.array(divisions[1:], dtype=float), effects[1:])
        ),
        notes=(f"from {100.0 * effects[0]:.2g} % to {100.0 * effects[-1]:.2g} %",),
        studies=(
            Study(
                id="calculix.mass-rule",
                kind="convergence",
                title="What CalculiX's four-point mass of C3D10 does to frequencies",
                x_label="divisions of the smaller side",
                y_label="relative change of the frequencies",
                unit="1",
                x=tuple(float(number) for number in divisions),
                series={label: tuple(effects.tolist())},
                formal_order=3.0,
                orders={label: order},
                limits={label: 0.0},
            ),
        ),
    )
