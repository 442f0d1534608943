"""Guards of what held end faces take from a leg: thin walls by Vlasov, a bar by thin slices."""

import numpy as np

from fem.bodies import doubling
from fem.couplings.end_effects import restrained_compliance
from fem.sections.section_constants import section_constants
from lumped.arrays import Array
from lumped.legs import ConstantLeg, Material
from lumped.sections import ISection, Rectangle
from meshes.section.section_mesh import section_mesh
from validation.agreement.differences import both_refined, farthest_refined
from validation.case import Absolute, Measurement, Relative
from validation.case_group import CaseGroup
from validation.cases.program.guards.robot import SECTION
from validation.context import Context

# Walls a hundredth of the side: what Vlasov leaves out (Reissner's shear) is of that order.
_THIN = ISection(width=0.1, height=0.16, flange=0.0012, web=0.0012)
_WITHOUT_CONTRACTION = Material.isotropic(2.1e11, 0.0, 7850.0)
_LENGTH = 4.0
_BAR = ConstantLeg(0.5, Rectangle(0.06, 0.1), Material.isotropic(2.1e11, 0.3, 7850.0))
_COUNTS = (2, 3)
_SLICES = (128, 256)
# Of slices as thin as that against fields that fade within a few of them, and of thin walls.
_ORDER = 2.0

cases = CaseGroup(section=SECTION, group="guard.ends", unit="1", effort=0.3)


@cases.case(
    "guard.ends.vlasov",
    "What held warping takes from the torsion of a thin-walled I-section is Vlasov's",
    quantity="part of c44 that is taken, as a share of L/GJ",
    reference_kind="closed-form",
    citation="V. Z. Vlasov (1961): −2d tanh(L/2d)/GJ with d² = EΓ/GJ, warping held at both ends",
    tolerance=Relative(0.01),
    tolerance_reason="the shear of walls a hundredth of the side thick is left out",
)
def _vlasov(_context: Context) -> Measurement:
    shares = []
    for divisions in (2, 4):
        mesh, material = section_mesh(_THIN, divisions), _WITHOUT_CONTRACTION
        constants = section_constants(mesh, 0.0)
        rigidity = material.G * constants.torsion_constant
        depth = np.sqrt(material.E * constants.warping_constant / rigidity)
        taken = restrained_compliance(mesh, material, _LENGTH)[3, 3] * rigidity / _LENGTH
        shares.append((taken, -2.0 * depth / _LENGTH * np.tanh(_LENGTH / (2.0 * depth))))
    return both_refined(*shares, order=_ORDER, apart=_ORDER)


@cases.case(
    "guard.ends.solid",
    "What held faces take from a bar is what solids of thin slices lose by them",
    quantity="largest difference on the diagonal, as a share of what is taken there",
    reference_kind="finer-model",
    citation="the bar by doubling, 256 slices, rigid less free ends (fem.bodies.doubling)",
    tolerance=Absolute(5e-3),
    tolerance_reason="one section mesh, exact along the bar in theory: slices leave less",
)
def _solid(context: Context) -> Measurement:
    taken, coarse, fine = context.get(taken_from_bar)
    before, off = (np.abs(lost / taken - 1.0) for lost in (coarse, fine))
    return farthest_refined(before, off, order=_ORDER, ratio=_SLICES[1] / _SLICES[0])


def taken_from_bar() -> tuple[Array, Array, Array]:
    """Changes of the diagonal compliances (6): in theory, by fewer slices and by more."""
    mesh = section_mesh(_BAR.section, _COUNTS)
    taken = np.diag(restrained_compliance(mesh, _BAR.material, _BAR.length))
    lost = []
    for slices in _SLICES:
        condensed = doubling.condensed_leg(_BAR, mesh, slices)
        rigid, free = (doubling.tip_compliance(condensed, ends) for ends in ("rigid", "free"))
        lost.append(np.diag(rigid - free))
    return taken, lost[0], lost[1]
