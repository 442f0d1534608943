"""Von Mises stresses in the sections of legs, by beam theory on a mesh of each section.

Input: a leg and its section forces along its length. Output: `MemberStress`, the largest stress and
its position. Rule: stresses are normal and shear stresses of Saint-Venant's theory; the half-width
of the uncertainty of a stress is the change from a coarse to a fine section mesh, scaled by the
order of convergence, plus the effect of the half-widths of the forces.
"""

from dataclasses import dataclass

import numpy as np

from fem.sections.stresses import SectionStresses, section_stresses
from lumped.arrays import Array
from lumped.legs import ConstantLeg, LineLeg
from lumped.mechanism.body import Shape
from lumped.system.members import MemberForces
from meshes.section.section_mesh import section_mesh
from validation.uncertainty.mesh_half_widths import MeshPolicy, mesh_half_widths

# Elements across the smaller side of a section on the coarse and on the fine mesh. Orders of
# convergence of stresses: that of gradients of quadratic elements, and a lower one for sections
# with re-entrant corners.
_DIVISIONS = (4, 8)
_SMOOTH, _STEEP = 2.0, 1.0
_WITHOUT_MESH = "its section has no mesh of one material"


@dataclass(frozen=True, eq=False)
class MemberStress:
    """Largest von Mises stress of a leg (Pa) with its `half_width` (Pa) and its position.

    It acts at the distance `station` (m) from the root in the point (y, z) of the section (m, from
    its centroid). There, `normal` is the normal stress σxx and `shear` the shear stress (Pa).
    `along` (s, Pa): largest stress in each of the s sections at `stations` (s, m). The half-width
    covers the mesh of the section and the half-widths of the section forces.
    """

    leg: str
    largest: float
    half_width: float
    station: float
    point: tuple[float, float]
    normal: float
    shear: float
    stations: Array
    along: Array


def reason_without_stress(shape: Shape) -> str:
    """Reason why no stresses are computed for a leg. "" if they are."""
    if isinstance(shape, LineLeg):
        return "its section varies along it"
    if not isinstance(shape, ConstantLeg):
        return "its section is not known"
    uniform = shape.section.has_outline and shape.section.is_uniform
    return "" if uniform else _WITHOUT_MESH


def member_stress(leg: ConstantLeg, member: MemberForces) -> MemberStress | None:
    """Largest von Mises stress of a leg.

    None if its section forces are statically indeterminate.
    """
    if not np.isfinite(member.forces).all():
        return None
    coarse, fine = (
        section_stresses(section_mesh(leg.section, divisions), leg.material)
        for divisions in _DIVISIONS
    )
    stresses = np.where(fine.regular, fine.von_mises(member.forces), 0.0)
    row, node = np.unravel_index(np.argmax(stresses), stresses.shape)
    largest = float(stresses[row, node])
    change = np.array(abs(largest - _largest(coarse, member.forces)))
    policy = MeshPolicy.of_order(2.0, _SMOOTH if fine.regular.all() else _STEEP)
    # The von Mises stress is a norm: it changes by at most that of the stresses due to the change
    # of the forces.
    of_forces = fine.von_mises(np.diag(member.half_width))[:, fine.regular].sum(axis=0).max()
    forces = member.forces[row]
    y, z = fine.mesh.nodes[node]
    return MemberStress(
        member.leg,
        largest,
        float(mesh_half_widths([change], policy) + of_forces),
        float(member.stations[row]),
        (float(y), float(z)),
        float(fine.normal[node] @ forces),
        float(np.linalg.norm(fine.shear[:, node] @ forces)),
        member.stations,
        stresses.max(axis=1),
    )


def _largest(stresses: SectionStresses, forces: Array) -> float:
    return float(stresses.von_mises(forces)[:, stresses.regular].max())
