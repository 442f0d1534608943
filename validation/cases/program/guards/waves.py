"""Guards of waves along a leg: torsional ones, from which allowances are taken, and bending."""

from collections.abc import Callable
from functools import partial

import numpy as np

from fem.sections import nonuniform_torsion
from fem.sections.section_constants import section_constants
from fem.sections.waveguide import bending_wave, torsion_wave
from lumped.legs import Material
from lumped.sections import ISection, Rectangle
from meshes.section.section_mesh import section_mesh
from validation.agreement.differences import both_refined
from validation.case import Measurement, Relative
from validation.case_group import CaseGroup
from validation.cases.program.guards.robot import SECTION
from validation.context import Context
from validation.solids.legs import CORNER_ORDER
from validation.solids.waves import prism_wave_frequency

# Walls thick enough for 3-D waves and one warping function to agree, open enough to warp.
_OPEN = ISection(width=0.1, height=0.16, flange=0.02, web=0.02)
_THIN = ISection(width=0.1, height=0.2, flange=0.004, web=0.003)
_BAR = Rectangle(width=0.06, height=0.1)
_STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
_QUARTER_WAVE = 0.8
# Divisions of the section.
_COARSE, _FINE = 2, 4

cases = CaseGroup(
    section=SECTION, group="guard.waves", unit="Hz", reference_kind="closed-form", effort=0.05
)


@cases.case(
    "guard.waves.torsion",
    "The torsional wave of an I-section by 3-D elasticity is that of a rod that warps",
    quantity="frequency of the wave of 3.2 m",
    citation="E. Reissner, J. Math. Phys. 31 (1952) 268, one warping function",
    tolerance=Relative(2e-3),
    tolerance_reason="warping raises it by 8.1 %; one function for the shear of thick walls is "
    "1.4 % of that off, whatever the wave length (measured)",
)
def _wave(_context: Context) -> Measurement:
    return _refined(_wave_and_rod)


def _wave_and_rod(divisions: int) -> tuple[float, float]:
    mesh = section_mesh(_OPEN, divisions)
    constants = section_constants(mesh, _STEEL.nu)
    k = np.pi / (2.0 * _QUARTER_WAVE)
    return (
        torsion_wave(mesh, _STEEL, k) / (2.0 * np.pi),
        nonuniform_torsion.wave_frequency(constants, _STEEL, k),
    )


def _refined(pair: Callable[[int], tuple[float, float]]) -> Measurement:
    return both_refined(pair(_COARSE), pair(_FINE), order=CORNER_ORDER, apart=CORNER_ORDER)


@cases.case(
    "guard.waves.bending",
    "The bending wave of a rectangle on a mesh of its section is that of polynomials",
    quantity="frequency of the wave six heights long, ν = 0.3",
    citation="Ritz's method on polynomials of the whole section, validation.solids.waves",
    tolerance=Relative(2e-4),
    tolerance_reason="one theory of elasticity, by elements and by polynomials; Timoshenko's is "
    "0.4 % lower",
)
def _bending(_context: Context) -> Measurement:
    return _refined(_by_elements_and_polynomials)


def _by_elements_and_polynomials(divisions: int) -> tuple[float, float]:
    k = 2.0 * np.pi / (6.0 * _BAR.height)
    wave = bending_wave(section_mesh(_BAR, divisions), _STEEL, k, "z")
    return wave / (2.0 * np.pi), prism_wave_frequency(_BAR, _STEEL, "bending", k)


@cases.case(
    "guard.waves.vlasov[{by}]",
    "The torsional wave of a thin-walled I-section is that of Vlasov's rod ({by})",
    over={"by, tolerance": (("rod", Relative(0.01)), ("solid", Relative(0.02)))},
    quantity="frequency of the wave of 8 m",
    citation="V. Z. Vlasov: ω² = (GJ k² + EΓ k⁴)/(ρI_p + ρΓ k²), shear of the walls left out",
    tolerance_reason="the shear of thin walls takes less than 1 %, their distortion no more than "
    "that",
)
def _vlasov(_context: Context, by: str) -> Measurement:
    return _refined(partial(_wave_and_vlasov, by))


def _wave_and_vlasov(by: str, divisions: int) -> tuple[float, float]:
    mesh = section_mesh(_THIN, divisions)
    constants = section_constants(mesh, 0.0)
    m, k = Material.isotropic(2.1e11, 0.0, 7850.0), np.pi / 4.0
    polar = constants.second_moment_y + constants.second_moment_z
    stiffness = m.G * constants.torsion_constant + m.E * constants.warping_constant * k**2
    inertia = m.rho * (polar + constants.warping_constant * k**2)
    found = (
        nonuniform_torsion.wave_frequency(constants, m, k)
        if by == "rod"
        else torsion_wave(mesh, m, k) / (2.0 * np.pi)
    )
    return found, float(k * np.sqrt(stiffness / inertia) / (2.0 * np.pi))
