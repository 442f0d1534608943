"""Distortion of a section by the inertia of a vibrating leg: walls bend in the section's plane.

A section that moves in its plane with the acceleration a has the inertia −ρ a per volume. Along the
leg, shear stresses change by ∂τ/∂x and balance this inertia: in sum over the section, but not at
each point. Webs carry the shear force of flanges, for example, so that flanges bend under their own
inertia. The in-plane forces p = ∂τ/∂x − ρ a strain the section. Their strain energy per length is
½ pᵀWp with the flexibility W of the section in plane strain, since the leg is long.

The motion has three parts, with the amplitudes g = (√m v, √m w, √(ρI_p) φ) of translations along y
and z and of the rotation about the leg, m = ρA. In a mode of angular frequency ω, the accelerations
are ω² times these motions, so that distortion has the share ω² gᵀβg of the strain energy if Σ g² is
one along the leg. A relative change of the mode's frequency is half of a change of this share
(Rayleigh). This holds for frequencies well below those at which walls resonate.
"""

import numpy as np

from fem.sections.saint_venant import saint_venant
from fem.sections.section_constants import in_plane_displacements, poisson_shear_ratio
from fem.sections.waveguide import elasticity
from lumped.arrays import Array
from lumped.legs import Material
from meshes.section.section_mesh import SectionMesh


def distortion_flexibility(mesh: SectionMesh, material: Material) -> Array:
    """Matrix β (3×3, s²) of the distortion of a section of one material, on its `mesh`.

    Stresses are those of Saint-Venant under forces along y and z through the centroid, and under a
    torque. Raises ComputationError as `saint_venant` does.
    """
    solution = saint_venant(mesh, poisson_shear_ratio(material.nu, material.G / material.E))
    quad = solution.quadrature
    y, z = quad.points
    one, none = np.ones_like(y), np.zeros_like(y)
    rigid = np.stack([[one, none], [none, one], [-z, y]])
    inertia = quad.integral((rigid**2).sum(axis=1))
    stresses = [*solution.centroid_force_stress(), solution.torsion_stress()]
    forces = []
    for stress in stresses:
        resultants = quad.integral((rigid * stress).sum(axis=1))
        density = stress - np.einsum("r,rcmq->cmq", resultants / inertia, rigid)
        forces.append(np.column_stack([quad.load(part) for part in density]).ravel())
    loads = np.column_stack(forces) * np.sqrt(material.rho * inertia)
    moduli = elasticity(material)[1:4, 1:4]
    return np.asarray(loads.T @ in_plane_displacements(quad, moduli, loads))
