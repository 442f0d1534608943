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
from validation.agreement.convergence import step_factor
from validation.case import Case, Measurement, Relative
from validation.cases.program.guards.reduction import guard_case
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


def cases() -> tuple[Case, ...]:
    """Thick walls by two formulations, thin ones by the closed form."""
    return (
        guard_case(
            "waves.torsion",
            "The torsional wave of an I-section by 3-D elasticity is that of a rod that warps",
            "frequency of the wave of 3.2 m",
            "E. Reissner, J. Math. Phys. 31 (1952) 268, one warping function",
            Relative(2e-3),
            "warping raises it by 8.1 %; one function for the shear of thick walls is 1.4 % of "
            "that off, whatever the wave length (measured)",
            _wave,
            unit="Hz",
        ),
        guard_case(
            "waves.bending",
            "The bending wave of a rectangle on a mesh of its section is that of polynomials",
            "frequency of the wave six heights long, ν = 0.3",
            "Ritz's method on polynomials of the whole section, validation.solids.waves",
            Relative(2e-4),
            "one theory of elasticity, by elements and by polynomials; Timoshenko's is 0.4 % lower",
            lambda _context: _refined(_bending),
            unit="Hz",
        ),
        *(
            guard_case(
                f"waves.vlasov[{model}]",
                f"The torsional wave of a thin-walled I-section is that of Vlasov's rod ({model})",
                "frequency of the wave of 8 m",
                "V. Z. Vlasov: ω² = (GJ k² + EΓ k⁴)/(ρI_p + ρΓ k²), shear of the walls left out",
                Relative(0.01 if model == "rod" else 0.02),
                "the shear of thin walls takes less than 1 %, their distortion no more than that",
                partial(_vlasov, model=model),
                unit="Hz",
            )
            for model in ("rod", "solid")
        ),
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
    """Value and reference on the finer of two meshes, with what the step between them leaves."""
    before, after = pair(_COARSE), pair(_FINE)
    factor = step_factor(_FINE / _COARSE, CORNER_ORDER)
    own, other = (factor * abs(f - c) for c, f in zip(before, after, strict=True))
    value, reference = after
    return Measurement(
        value,
        reference,
        value_uncertainty=own,
        reference_uncertainty=other,
        # Both have the errors of one section mesh in common.
        judged_uncertainty=factor * abs((value - reference) - (before[0] - before[1])),
    )


def _bending(divisions: int) -> tuple[float, float]:
    k = 2.0 * np.pi / (6.0 * _BAR.height)
    wave = bending_wave(section_mesh(_BAR, divisions), _STEEL, k, "z")
    return wave / (2.0 * np.pi), prism_wave_frequency(_BAR, _STEEL, "bending", k)


def _vlasov(_context: Context, model: str) -> Measurement:
    return _refined(partial(_wave_and_vlasov, model))


def _wave_and_vlasov(model: str, divisions: int) -> tuple[float, float]:
    mesh = section_mesh(_THIN, divisions)
    constants = section_constants(mesh, 0.0)
    m, k = Material.isotropic(2.1e11, 0.0, 7850.0), np.pi / 4.0
    polar = constants.second_moment_y + constants.second_moment_z
    stiffness = m.G * constants.torsion_constant + m.E * constants.warping_constant * k**2
    inertia = m.rho * (polar + constants.warping_constant * k**2)
    found = (
        nonuniform_torsion.wave_frequency(constants, m, k)
        if model == "rod"
        else torsion_wave(mesh, m, k) / (2.0 * np.pi)
    )
    return found, float(k * np.sqrt(stiffness / inertia) / (2.0 * np.pi))
