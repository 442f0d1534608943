"""Saint-Venant's states of a prism of several materials, by finite elements on its section.

A prism obeys E₀u″ + Gu′ − E₂u = 0 with the 3N displacements u of a section (semi-analytical finite
elements, see `fem.couplings.section_fields`). Its polynomial solutions are tension, torsion, pure
bending in two planes and flexure by two transverse forces. In these states, parts of different
Poisson's ratios strain each other. The coefficients a_k of x^k/k! are computed from the highest k
downwards: the highest is a rigid motion, and E₂a_k = E₀a_{k+2} + Ga_{k+1} (V. Giavotto et al.,
Computers & Structures 16 (1983) 403, has the same six states for any anisotropic section). Unit
wrenches on a section are sums of the states. Their strain energies per length are the 6×6
compliance of the beam.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_array, coo_array, csc_array
from scipy.sparse.linalg import splu

from fem.sections.moduli import Moduli
from fem.sections.nonuniform_torsion import WarpingRod
from fem.sections.saint_venant import SectionQuadrature, section_quadrature
from fem.sections.waveguide import cell_matrices
from lumped.arrays import Array, SparseMatrix
from lumped.beam_properties import BeamProperties
from meshes.section.section_mesh import SectionMesh

# Index of each rigid motion that strains no section by itself, and the degree of its polynomial in
# x: tension from a displacement along x, bending and flexure from one along y and along z, torsion
# from a rotation.
_DEGREES = ((0, 1), (1, 2), (1, 3), (2, 2), (2, 3), (3, 1))
_TORSION = 5
# Couplings below this fraction of their scale are round-off. Mirror images in meshes are exact to
# 1e-10.
_SYMMETRIC = 1e-8


@dataclass(frozen=True, eq=False)
class WrenchStates:
    """States of a prism under unit wrenches on a section, about the origin of the section's mesh.

    The wrenches are in the order x y z φx φy φz. `tractions` (3N×6) are the nodal forces.
    `compliance` (6×6, in 1/N, 1/(N m), 1/(N m²)) contains the strains of the beam, conjugate to the
    wrenches. `warping` (N, in m²) are the displacements u_x in torsion of unit rate about the
    origin. `displacements` (3N×6, in m) and `slopes` (3N×6) are the displacements of the section,
    and their derivatives along the leg.
    """

    tractions: Array
    compliance: Array
    warping: Array
    displacements: Array
    slopes: Array


def wrench_states(mesh: SectionMesh, moduli: Moduli) -> WrenchStates:
    """States of a prism under unit wrenches, from a section `mesh` with the given moduli."""
    quad = section_quadrature(mesh)
    E0, E1, E2 = _matrices(quad, moduli)
    coupling = E1 - E1.T
    y, z = mesh.nodes.T
    motions = np.zeros((len(y), 3, 6))
    motions[:, :, :3] = np.eye(3)
    motions[:, 0, 4], motions[:, 0, 5] = z, -y
    motions[:, 1, 3], motions[:, 2, 3] = -z, y
    rigid = motions.reshape(-1, 6)
    null = rigid[:, :4]
    means = null.T @ E0
    bordered = splu(block_array([[E2, null], [means, np.zeros((4, 4))]], format="csc"))
    warpings, slopes = [], []
    for motion, degree in _DEGREES:
        terms = [null[:, motion], np.zeros(len(null))]
        for _ in range(degree):
            load = E0 @ terms[1] + coupling @ terms[0]
            terms.insert(0, bordered.solve(np.append(load, np.zeros(4)))[: len(null)])
        # At x = 0 the field is the lowest term, and its slope is the next one.
        warpings.append(terms[0])
        slopes.append(terms[1])
    warping, slope = np.column_stack(warpings), np.column_stack(slopes)
    forces = E0 @ slope + E1 @ warping
    to_wrenches = np.linalg.inv(rigid.T @ forces)
    energies = slope.T @ forces + warping.T @ (E1.T @ slope + E2 @ warping)
    compliance = to_wrenches.T @ energies @ to_wrenches
    return WrenchStates(
        forces @ to_wrenches,
        0.5 * (compliance + compliance.T),
        warping[::3, _TORSION],
        warping @ to_wrenches,
        slope @ to_wrenches,
    )


def composite_properties(
    mesh: SectionMesh, moduli: Moduli, *, helical: bool = False
) -> BeamProperties:
    """Timoshenko beam of a section of several materials, along the origin of its mesh.

    If parts have different Poisson's ratios, each part hinders the contraction of the other parts,
    which increases EA and EI. This effect is included. The coupling of tension and bending that it
    causes, of second order in the difference of the ratios, is neglected. `helical` is True for
    walls of helical fibres. Otherwise couplings of tension with torsion and of shear with bending
    are neglected.
    """
    compliance = wrench_states(mesh, moduli).compliance
    GJ = 1.0 / compliance[3, 3]
    # A unit force along y through the origin has the moment z_s about the shear centre, one along
    # z has −y_s.
    centre = np.array([-compliance[3, 2], compliance[3, 1]]) * GJ
    size = np.sqrt(compliance[0, 0] / np.trace(compliance[4:, 4:]))
    centre[np.abs(centre) <= _SYMMETRIC * size] = 0.0
    moments = np.array([centre[1], -centre[0]])
    shear = compliance[1:3, 1:3] - np.outer(moments, moments) / GJ
    coupling = float(shear[0, 1])
    if abs(coupling) <= _SYMMETRIC * np.trace(shear):
        coupling = 0.0
    # Curvatures φz′ and −φy′ due to Mz and −My.
    signs = np.array([[1.0, -1.0], [-1.0, 1.0]])
    bending = np.linalg.inv((signs * compliance[4:, 4:])[::-1, ::-1])
    product = float(bending[0, 1])
    if abs(product) <= _SYMMETRIC * np.trace(bending):
        product = 0.0
    mass, (first_y, first_z), inertia = _inertia(mesh, moduli)
    offset = np.array([first_y, first_z]) / mass
    offset[np.abs(offset) <= _SYMMETRIC * size] = 0.0
    inertia_yz = float(inertia[0, 1])
    if abs(inertia_yz) <= _SYMMETRIC * np.trace(inertia):
        inertia_yz = 0.0
    return BeamProperties(
        EA=1.0 / float(compliance[0, 0]),
        EIy=float(bending[1, 1]),
        EIz=float(bending[0, 0]),
        GJ=float(GJ),
        GAy=1.0 / float(shear[0, 0]),
        GAz=1.0 / float(shear[1, 1]),
        mu=mass,
        rho_J=float(np.trace(inertia)),
        rho_Iy=float(inertia[1, 1]),
        rho_Iz=float(inertia[0, 0]),
        EIyz=product,
        rho_Iyz=inertia_yz,
        shear_yz=coupling,
        centre_y=float(centre[0]),
        centre_z=float(centre[1]),
        mass_y=float(offset[0]),
        mass_z=float(offset[1]),
        twist_x=float(compliance[0, 3]) if helical else 0.0,
        turn_y=float(compliance[1, 4]) if helical else 0.0,
        turn_z=float(compliance[2, 5]) if helical else 0.0,
    )


def composite_rod(mesh: SectionMesh, moduli: Moduli) -> WarpingRod:
    """Torsion with warping of a section of several materials, about its shear centre.

    Normal stresses due to warping are computed with the modulus of tension with free contraction.
    """
    states = wrench_states(mesh, moduli)
    GJ = 1.0 / states.compliance[3, 3]
    offset_y, offset_z = -states.compliance[3, 2] * GJ, states.compliance[3, 1] * GJ
    quad = section_quadrature(mesh)
    y, z = quad.points + quad.centroid[:, None, None]
    matrices = moduli.on(quad)
    turning = np.stack([-(z - offset_z), y - offset_y], axis=-1)
    shear = matrices[..., [5, 4], :][..., [5, 4]]
    twist = quad.integral(np.einsum("mqi,mqij,mqj->mq", turning, shear, turning))
    tension: Array = np.asarray(1.0 / np.linalg.inv(matrices)[..., 0, 0], dtype=float)
    warping = quad.value(states.warping) - y * offset_z + z * offset_y
    warping -= quad.integral(tension * warping) / quad.integral(tension)
    densities = moduli.densities[:, None] * np.ones_like(y)
    return WarpingRod(
        twist=float(twist),
        shear=float(twist - GJ),
        bimoment=float(quad.integral(tension * warping**2)),
        rotary=float(quad.integral(densities * (turning**2).sum(axis=-1))),
        warping=float(quad.integral(densities * warping**2)),
    )


def _inertia(mesh: SectionMesh, moduli: Moduli) -> tuple[float, Array, Array]:
    """Mass per length (kg/m), its first moments (2) and ∫ ρ s sᵀ dA (2×2), with s = (y, z)."""
    quad = section_quadrature(mesh)
    points = quad.points + quad.centroid[:, None, None]
    densities = moduli.densities[:, None] * np.ones_like(points[0])
    second = [[quad.integral(densities * a * b) for b in points] for a in points]
    return (
        float(quad.integral(densities)),
        quad.integral(densities * points),
        np.array(second, dtype=float),
    )


def _matrices(
    quad: SectionQuadrature, moduli: Moduli
) -> tuple[SparseMatrix, SparseMatrix, SparseMatrix]:
    """Matrices E₀, E₁, E₂ (csc 3N×3N) of the strain energy per length of a section.

    Twice this energy is ∫ ε·σ dA = u′E₀u′ + 2u′E₁u + uE₂u with the nodal displacements u (3N) and
    their derivatives u′ along the axis.
    """
    E0, E1, E2 = (_assembled(quad, local) for local in cell_matrices(quad, moduli.on(quad)))
    return E0, E1, E2


def _assembled(quad: SectionQuadrature, local: Array) -> SparseMatrix:
    unknowns = (3 * quad.mesh.cells[:, :, None] + np.arange(3)).reshape(len(local), -1)
    rows, columns = np.broadcast_arrays(unknowns[:, :, None], unknowns[:, None, :])
    size = 3 * len(quad.mesh.nodes)
    places = rows.ravel(), columns.ravel()
    return csc_array(coo_array((local.ravel(), places), shape=(size, size)))
