"""Torsion with warping as a degree of freedom, which Saint-Venant's theory neglects.

The unknowns are the rotation θ(x) and the warping intensity χ(x), u_x = χ ω(y, z) (E. Reissner, J.
Math. Phys. 31 (1952) 268; Benscoter, J. Appl. Mech. 21 (1954) 25):

    2V = ∫ G I_p θ'² − 2 G(I_p − J) θ'χ + G(I_p − J) χ² + EΓ χ'² dx,   2T = ∫ ρI_p θ̇² + ρΓ χ̇² dx.

For χ = θ' this is Vlasov's rod, and without EΓ Saint-Venant's. ω and the polar moment I_p are about
the shear centre.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csr_array
from skfem import Basis, BilinearForm, ElementLineP2, MeshLine

from fem.sections.section_constants import SectionConstants
from lumped.arrays import Array, SparseMatrix
from lumped.legs import Material

# Number of quadratic elements, with which the third frequency has an error of 1e-7.
_ELEMENTS = 40
# Ratio of Γ to I_p²/A below which a section does not warp (a round one, up to round-off). The
# frequency is then that of Saint-Venant's theory.
_UNWARPED = 1e-9


@dataclass(frozen=True)
class WarpingRod:
    """Stiffnesses, and inertias per length, of a rod that twists and warps.

    `twist` is G I_p (N m²), `shear` is G(I_p − J) (N m²), `bimoment` is EΓ (N m⁴), `rotary` is ρI_p
    (kg m), and `warping` is ρΓ (kg m³).
    """

    twist: float
    shear: float
    bimoment: float
    rotary: float
    warping: float


def warping_rod(constants: SectionConstants, material: Material) -> WarpingRod:
    """Rod with warping from a section and a material, about the shear centre of the section."""
    offset = np.subtract(constants.shear_centre, constants.centroid)
    polar = constants.second_moment_y + constants.second_moment_z
    polar += constants.area * float(offset @ offset)
    return WarpingRod(
        twist=material.G * polar,
        shear=material.G * (polar - constants.torsion_constant),
        bimoment=material.E * constants.warping_constant,
        rotary=material.rho * polar,
        warping=material.rho * constants.warping_constant,
    )


def held_torsion_compliance(rod: WarpingRod, length: float) -> float:
    """Rotation of the tip per torque (rad/(N m)) if warping is prevented at both ends (χ = 0).

    `length` is L in m. From T = G I_p θ' − G(I_p − J) χ and EΓ χ″ = G(I_p − J)(χ − θ') follows (L −
    (1 − J/I_p) (2/k) tanh(kL/2)) / GJ with k² = G J (1 − J/I_p) / EΓ.
    """
    stiffness = rod.twist - rod.shear
    share = rod.shear / rod.twist
    if share * rod.bimoment <= 0.0:
        return length / stiffness
    k = np.sqrt(stiffness * share / rod.bimoment)
    return float((length - share * 2.0 / k * np.tanh(0.5 * k * length)) / stiffness)


def cantilever_frequencies(
    constants: SectionConstants, material: Material, length: float, count: int
) -> Array:
    """The lowest `count` torsional frequencies (Hz) of a rod of `length` (m) whose root is fixed.

    The rotation of the root is prevented. Both ends are free to warp.
    """
    if not _warps(constants):
        waves = (2.0 * np.arange(1, count + 1) - 1.0) * np.pi / (2.0 * length)
        return np.array([_saint_venant(constants, material, wave) for wave in waves.tolist()])
    basis = Basis(MeshLine(np.linspace(0.0, length, _ELEMENTS + 1)), ElementLineP2())
    gradients, coupling, product = (matrix.toarray() for matrix in line_products(basis))
    rod = warping_rod(constants, material)
    stiffness = np.block(
        [
            [rod.twist * gradients, -rod.shear * coupling.T],
            [-rod.shear * coupling, rod.shear * product + rod.bimoment * gradients],
        ]
    )
    zeros = np.zeros_like(product)
    mass = np.block([[rod.rotary * product, zeros], [zeros, rod.warping * product]])
    root = basis.get_dofs(lambda x: x[0] == 0.0).flatten()
    free = np.setdiff1d(np.arange(len(stiffness)), root)
    block = np.ix_(free, free)
    values = eigh(stiffness[block], mass[block], eigvals_only=True, subset_by_index=[0, count - 1])
    return np.asarray(np.sqrt(values) / (2.0 * np.pi))


def wave_frequency(constants: SectionConstants, material: Material, wave_number: float) -> float:
    """Frequency (Hz) of the torsional wave with `wave_number` (rad/m) in an infinite rod."""
    if not _warps(constants):
        return _saint_venant(constants, material, wave_number)
    rod, k = warping_rod(constants, material), wave_number
    stiffness = np.array(
        [[rod.twist * k**2, -rod.shear * k], [-rod.shear * k, rod.shear + rod.bimoment * k**2]]
    )
    values = eigh(stiffness, np.diag([rod.rotary, rod.warping]), eigvals_only=True)
    return float(np.sqrt(values[0]) / (2.0 * np.pi))


def _warps(constants: SectionConstants) -> bool:
    polar = constants.second_moment_y + constants.second_moment_z
    return constants.warping_constant * constants.area > _UNWARPED * polar**2


def torsional_speed(constants: SectionConstants, material: Material) -> float:
    """Speed (m/s) of Saint-Venant's torsional waves, √(GJ/ρI_p), for any wavelength."""
    polar = constants.second_moment_y + constants.second_moment_z
    return float(np.sqrt(material.G * constants.torsion_constant / (material.rho * polar)))


def _saint_venant(constants: SectionConstants, material: Material, wave_number: float) -> float:
    return wave_number * torsional_speed(constants, material) / (2.0 * np.pi)


def line_products(basis: Basis) -> tuple[SparseMatrix, SparseMatrix, SparseMatrix]:
    """Matrices ∫u′v′ dx, ∫u′v dx and ∫uv dx (n×n each) of a basis on a line.

    Rows belong to v and columns to u.
    """
    forms = (_gradients, _coupling, _product)
    gradients, coupling, product = (csr_array(form.assemble(basis)) for form in forms)
    return gradients, coupling, product


@BilinearForm
def _gradients(u, v, _):  # type: ignore[no-untyped-def]
    return u.grad[0] * v.grad[0]


@BilinearForm
def _coupling(u, v, _):  # type: ignore[no-untyped-def]
    return u.grad[0] * v


@BilinearForm
def _product(u, v, _):  # type: ignore[no-untyped-def]
    return u * v
