"""Constants of a section from finite elements on its mesh, without assuming thin walls.

Bending of a prism deforms its sections because of Poisson's ratio. A mesh that cannot represent
this deformation exactly is too stiff in bending. The additional stiffness is one of the constants.
For εxx = s with s = y or z from the centroid, the deformation is

    s = y   u = −ν (½(y² − z²), yz)        s = z   u = −ν (yz, ½(z² − y²))

and σxx = E s is the only stress. Second-order cells with straight sides represent these fields
exactly. Curved cells represent them with an error O(h²) of strain, so that their prism is too stiff
by O(h⁴) of EI, times G/E. The mesh of a solid has the same error for any length of its elements.
"""

from dataclasses import dataclass

import numpy as np

from fem.sections.saint_venant import (
    SaintVenant,
    SectionQuadrature,
    saint_venant,
    solved_with,
    summed,
)
from fem.sections.waveguide import elasticity
from lumped.arrays import Array
from lumped.beam_properties import BeamProperties
from lumped.legs import Material
from lumped.memo import memo
from meshes.section.section_mesh import SectionMesh

# Strains below this fraction of ν s are round-off of the interpolation.
_ROUNDING = 1e-12
# Couplings below this fraction of their scale are round-off. Mirror images in meshes are exact to
# 1e-10.
_SYMMETRIC = 1e-8


@dataclass(frozen=True)
class SectionConstants:
    """Constants of a section, SI units, axes y and z.

    `centroid` and `shear_centre` are (y, z) in the coordinates of the mesh (m). The second moments
    of area (m⁴) are about the centroid: `second_moment_y` = ∫z² dA, `second_moment_z` = ∫y² dA,
    `product_moment` = ∫yz dA. `torsion_constant` is Saint-Venant's J (m⁴), `warping_constant` is Γ
    = ∫ω² dA (m⁶) about the shear centre. There are two definitions of the shear coefficients κ for
    shear along y and z:

    - `shear_coefficients` from strain energy, ∫τ²/G dA = V²/κGA (Renton, Int. J. Solids Struct. 27
      (1991) 1901; Pilkey, Analysis and Design of Elastic Beams, ch. 6). By Clapeyron's theorem,
      Timoshenko's beam with this κ has exactly the tip compliance of a solid with Saint-Venant's
      tractions on its ends, if the tip displacement is work conjugate to the load.
    - `cowper_coefficients` from mean displacement and mean rotation of the area, G(W′ − Φ) = V/κA
      (Cowper, J. Appl. Mech. 33 (1966) 335), for dynamics. Both are equal for ν = 0.

    `shear_coupling` is A ∫τ_y·τ_z dA for the unit forces of the first definition: the off-diagonal
    term of the matrix with 1/κ_y and 1/κ_z on its diagonal. `held_contraction` (m⁴) is added to the
    second moments about y and z in bending by a prism of this mesh, because of contraction that the
    mesh does not represent. It is zero except for curved cells.
    """

    area: float
    centroid: tuple[float, float]
    second_moment_y: float
    second_moment_z: float
    product_moment: float
    torsion_constant: float
    warping_constant: float
    shear_centre: tuple[float, float]
    shear_coefficients: tuple[float, float]
    cowper_coefficients: tuple[float, float]
    shear_coupling: float
    held_contraction: tuple[float, float]


def poisson_shear_ratio(nu: float, shear_to_young: float | None = None) -> float:
    """Ratio νG/E, on which Saint-Venant's flexure depends.

    `shear_to_young` is G/E. None for an isotropic material.
    """
    ratio = 1.0 / (2.0 * (1.0 + nu)) if shear_to_young is None else shear_to_young
    return nu * ratio


@memo(64)
def section_constants(
    mesh: SectionMesh, nu: float, shear_to_young: float | None = None
) -> SectionConstants:
    """Constants of a section from its mesh, for Poisson's ratio `nu`.

    `shear_to_young` is G/E of a cubic material. None for an isotropic material. Only the shear
    coefficients and `held_contraction` depend on the material. Raises ComputationError if the mesh
    is not connected or has inverted cells.
    """
    ratio = poisson_shear_ratio(nu, shear_to_young)
    solution = saint_venant(mesh, ratio)
    shear = 1.0 / (2.0 * (1.0 + nu)) if shear_to_young is None else shear_to_young
    return constants_of(solution, held_contraction(solution.quadrature, nu, shear))


def constants_of(solution: SaintVenant, held: Array) -> SectionConstants:
    """Constants of a section from the solution of its torsion and flexure.

    `held` (2×2, in m⁴) is the result of `held_contraction`, which is added to ∫ s sᵀ dA in bending.
    """
    quad = solution.quadrature
    kappa = [
        1.0 / (solution.area * float(quad.integral((stress**2).sum(axis=0))))
        for stress in solution.flexure_stress
    ]
    along_y, along_z = solution.flexure_stress
    mixed = (along_y * along_z).sum(axis=0)
    # A unit force through the shear centre has the moment −z_s if it is along y, y_s if along z.
    offset_z, offset_y = -solution.flexure_torque[0], solution.flexure_torque[1]
    y, z = quad.points
    about_shear_centre = quad.value(solution.warping) - y * offset_z + z * offset_y
    return SectionConstants(
        area=solution.area,
        centroid=(float(quad.centroid[0]), float(quad.centroid[1])),
        second_moment_y=float(solution.moments[1, 1]),
        second_moment_z=float(solution.moments[0, 0]),
        product_moment=float(solution.moments[0, 1]),
        torsion_constant=solution.torsion_constant,
        warping_constant=float(quad.integral(about_shear_centre**2)),
        shear_centre=(float(quad.centroid[0] + offset_y), float(quad.centroid[1] + offset_z)),
        shear_coefficients=(kappa[0], kappa[1]),
        cowper_coefficients=(_cowper(solution, 0), _cowper(solution, 1)),
        shear_coupling=solution.area * float(quad.integral(mixed)),
        held_contraction=(float(held[1, 1]), float(held[0, 0])),
    )


def _cowper(solution: SaintVenant, axis: int) -> float:
    """Cowper's κ from the mean displacement along `axis` (0 for y, 1 for z): 1/κA = G(W′ − Φ)/V.

    W′ is the rate of the mean displacement along the leg, and Φ the mean rotation. G W′ is the area
    mean of G ∂u/∂x = τ − ∂Ψ/∂s. G Φ is the integral of −Ψ, weighted with the linear field c·s.
    """
    quad = solution.quadrature
    potential = solution.flexure[axis]
    growth = solution.flexure_stress[axis, axis] - quad.gradient(potential)[axis]
    linear = np.tensordot(solution.slopes[axis], quad.points, axes=1)
    flexibility = quad.integral(growth) / solution.area + quad.integral(
        linear * quad.value(potential)
    )
    return 1.0 / (solution.area * float(flexibility))


def beam_properties(constants: SectionConstants, material: Material) -> BeamProperties:
    """Timoshenko beam of a section along the line of its centroids, with κ by strain energy.

    EI is that of a solid prism with this section mesh. Curved elements make the prism slightly
    stiffer than the exact section. Couplings that vanish in a section with an axis of symmetry are
    set to zero if they are of the size of rounding errors.
    """
    E, G, rho = material.E, material.G, material.rho
    kappa_y, kappa_z = constants.shear_coefficients
    iy, iz = constants.second_moment_y, constants.second_moment_z
    held_y, held_z = constants.held_contraction
    product, coupling = constants.product_moment, constants.shear_coupling
    offset = np.subtract(constants.shear_centre, constants.centroid)
    if abs(product) <= _SYMMETRIC * (iy + iz):
        product = 0.0
    if abs(coupling) <= _SYMMETRIC * (1.0 / kappa_y + 1.0 / kappa_z):
        coupling = 0.0
    offset[np.abs(offset) <= _SYMMETRIC * np.sqrt(constants.area)] = 0.0
    return BeamProperties(
        EA=E * constants.area,
        EIy=E * (iy + held_y),
        EIz=E * (iz + held_z),
        GJ=G * constants.torsion_constant,
        GAy=kappa_y * G * constants.area,
        GAz=kappa_z * G * constants.area,
        mu=rho * constants.area,
        rho_J=rho * (iy + iz),
        rho_Iy=rho * iy,
        rho_Iz=rho * iz,
        EIyz=E * product,
        rho_Iyz=rho * product,
        shear_yz=coupling / (G * constants.area),
        centre_y=float(offset[0]),
        centre_z=float(offset[1]),
    )


def held_contraction(quad: SectionQuadrature, nu: float, shear_to_young: float) -> Array:
    """Stiffening (2×2, in m⁴) of bending by a mesh that cannot represent the section's contraction.

    It is added to Σ = ∫ s sᵀ dA with s = (y, z). The interpolated fields deviate from the
    contraction by the strains δε. With the elasticity C and the stiffness K of the section in its
    plane, and the nodal forces r = ∫ BᵀCδε dA, the stiffening is (∫ δεᵀCδε dA − rᵀK⁻¹r)/E. This is
    positive semidefinite, and computed without a difference of second moments.
    """
    y, z = (quad.mesh.nodes - quad.centroid).T
    fields = -nu * np.array([[0.5 * (y**2 - z**2), y * z], [y * z, 0.5 * (z**2 - y**2)]])
    missed = np.array([_strains(quad, field) for field in fields])
    missed[:, :2] += nu * quad.points[:, None]
    largest = abs(nu) * np.abs(quad.points).max()
    if np.abs(missed).max() <= _ROUNDING * largest:
        return np.zeros((2, 2))
    material = Material(E=1.0, G=shear_to_young, nu=nu, rho=1.0)
    moduli = elasticity(material)[1:4, 1:4]
    stresses = np.einsum("st,ctmq->csmq", moduli, missed)
    energy = np.einsum("asmq,bsmq,mq->ab", missed, stresses, quad.weights, optimize=True)
    residual = np.column_stack([_forces(quad, stress) for stress in stresses])
    relaxed = in_plane_displacements(quad, moduli, residual)
    contraction = energy - residual.T @ relaxed
    return np.asarray(0.5 * (contraction + contraction.T))


def _strains(quad: SectionQuadrature, field: Array) -> Array:
    """In-plane strains (3×M×Q; εyy, εzz, γyz) of the nodal displacements `field` (2×N)."""
    (yy, yz), (zy, zz) = (quad.gradient(component) for component in field)
    return np.array([yy, zz, yz + zy])


def _forces(quad: SectionQuadrature, stress: Array) -> Array:
    """Nodal forces ∫ Bᵀσ dA (2N, node by node) of in-plane stresses (3×M×Q; yy, zz, yz)."""
    yy, zz, yz = stress
    along = [quad.gradient_load(np.array(row)) for row in ((yy, yz), (yz, zz))]
    return np.column_stack(along).ravel()


def in_plane_displacements(quad: SectionQuadrature, moduli: Array, forces: Array) -> Array:
    """In-plane displacements (2N×m) under nodal `forces` (2N×m) in equilibrium.

    `moduli` (3×3) relates the stresses (yy, zz, yz) to the strains.
    """
    cells, nodes = quad.mesh.cells, quad.mesh.nodes
    gradients = quad.gradients
    operator = np.zeros((*gradients.shape[:2], 2, 3, gradients.shape[-1]))
    operator[:, :, 0, 0] = operator[:, :, 1, 2] = gradients[:, :, 0]
    operator[:, :, 1, 1] = operator[:, :, 0, 2] = gradients[:, :, 1]
    size = 2 * cells.shape[1]
    operator = operator.reshape(len(cells), size, 3, -1)
    blocks = np.einsum(
        "misq,st,mjtq,mq->mij", operator, moduli, operator, quad.weights, optimize=True
    )
    unknowns = (2 * cells[:, :, None] + np.arange(2)).reshape(len(cells), size)
    # Three fixed unknowns of two distant nodes prevent rigid motions, on which the forces do no
    # work.
    far = int(np.argmax(np.abs(nodes - nodes[0]).max(axis=1)))
    across = 1 - int(np.argmax(np.abs(nodes[far] - nodes[0])))
    return solved_with(
        summed(blocks, unknowns, len(forces)), forces, fixed_rows=[0, 1, 2 * far + across]
    )
