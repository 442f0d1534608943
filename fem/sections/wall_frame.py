"""Stiffness of a rectangular tube against distortion of its section, per length.

The four walls bend as a frame if the angles between them change by γ. Twice the strain energy per
length is k γ². Shear flows along the walls, of the same moment about the axis in both pairs of
walls but of opposite sense, do the work m γ with m = k γ. Walls and corners are in plane strain,
since the leg is long.
"""

import numpy as np

from fem.sections.saint_venant import section_quadrature
from fem.sections.section_constants import in_plane_displacements
from fem.sections.waveguide import elasticity
from lumped.legs import ConstantLeg, Material
from lumped.sections import HollowRectangle
from meshes.section.section_mesh import SectionMesh


def formula_frame_stiffness(prism: ConstantLeg) -> float:
    """Stiffness k (N) of thin walls with rigid corners: 24 D/(b* + h*), D = E t³/12(1 − ν²).

    b* and h* are the clear widths between the corners (V. Z. Vlasov, Thin-Walled Elastic Beams, ch.
    IV).
    """
    section, material = prism.section, prism.material
    if not isinstance(section, HollowRectangle):
        raise TypeError(f"{section.shape}: is not a rectangular tube")
    plate = material.E * section.thickness**3 / (12.0 * (1.0 - material.nu**2))
    return 24.0 * plate / (section.inner.width + section.inner.height)


def mesh_frame_stiffness(mesh: SectionMesh, material: Material) -> float:
    """Stiffness k (N) of a rectangular tube by finite elements on the `mesh` of its section.

    The centre of the section is the origin, and its sides are along y and z.
    """
    quad = section_quadrature(mesh)
    y, z = quad.points
    width, height = np.ptp(mesh.nodes, axis=0)
    flat = np.abs(z) * width > np.abs(y) * height
    along_y, along_z = np.where(flat, np.sign(z), 0.0), np.where(flat, 0.0, np.sign(y))
    moment = float(quad.integral(along_y * z))
    along_z *= moment / float(quad.integral(along_z * y))
    forces = np.column_stack([quad.load(along_y), quad.load(along_z)]).ravel()
    moduli = elasticity(material)[1:4, 1:4]
    displacements = in_plane_displacements(quad, moduli, forces[:, None])[:, 0]
    return moment**2 / float(forces @ displacements)
