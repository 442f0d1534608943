"""Stresses in a section of several materials, at the nodes of its mesh, part by part.

They follow from the states of `fem.sections.composite`: strains from the displacements of the
section and their derivatives along the leg, stresses by the elasticity of each part. Where parts
meet, each has its own stress. If all parts have one Poisson's ratio, the normal stress is that of
beam theory, with the constants weighted by E:

    σxx = E_i (N/EA + My z/EIy − Mz y/EIz)      (axes of symmetry along y and z)

Otherwise parts strain each other, which adds stresses within the plane of the section. Where the
joint of two such parts ends at a free edge, these stresses are singular as a rule (D. B. Bogy, J.
Appl. Mech. 35 (1968) 460): they grow as r^(λ−1), λ slightly below one, without a limit. Points
nearby are left out as beside re-entrant corners.
"""

from dataclasses import dataclass

import numpy as np

from fem.sections.composite import wrench_states
from fem.sections.moduli import Moduli
from fem.sections.saint_venant import section_quadrature
from fem.sections.stresses import (
    NodalGradient,
    SectionStresses,
    apart_from,
    perimeter,
    reentrant_corners,
    rim_edges,
)
from lumped.arrays import Array, IntArray
from meshes.section.section_mesh import SectionMesh

# Poisson's ratios that differ by less are equal: round-off of elasticity matrices.
_EQUAL_RATIOS = 1e-9


@dataclass(frozen=True, eq=False)
class PartStresses(SectionStresses):
    """Stresses under unit section forces in a section of several materials.

    A node between two parts is two points, one of each part. `across` (3×N×6, in Pa) are σyy, σzz
    and τyz. `parts` (N) are the indices of the parts.
    """

    across: Array
    parts: IntArray

    def von_mises(self, forces: Array) -> Array:
        """Von Mises stress (s×N, in Pa) at all points under s sets of section forces (s×6)."""
        normal, (xy, xz) = forces @ self.normal.T, forces @ np.swapaxes(self.shear, 1, 2)
        yy, zz, yz = forces @ np.swapaxes(self.across, 1, 2)
        differences = (normal - yy) ** 2 + (yy - zz) ** 2 + (zz - normal) ** 2
        return np.asarray(np.sqrt(0.5 * differences + 3.0 * (xy**2 + xz**2 + yz**2)))

    def largest_by_part(self, forces: Array) -> Array:
        """Largest von Mises stress (Pa) in each part under the section `forces` (6)."""
        stresses = np.where(self.regular, self.von_mises(forces[None])[0], 0.0)
        return np.array([stresses[self.parts == part].max() for part in np.unique(self.parts)])


def part_stresses(mesh: SectionMesh, moduli: Moduli) -> PartStresses:
    """Stresses under unit section forces on a section `mesh` with regions.

    The forces act at the origin of the mesh. Parts have one material each. Points of all parts
    count as near a re-entrant corner of one part, near one that parts form together, and near a
    free end of the joint of two parts with different Poisson's ratios.
    """
    if mesh.regions is None:
        raise ValueError("the mesh of a section of several materials must have regions")
    states = wrench_states(mesh, moduli)
    displacements, slopes = (
        field.reshape(-1, 3, 6) for field in (states.displacements, states.slopes)
    )
    points, corners, distances, stresses, parts = [], [], [], [], []
    ratios = np.zeros(len(mesh.cells))
    for region in np.unique(mesh.regions):
        cells = np.flatnonzero(mesh.regions == region)
        nodes, renumbered = np.unique(mesh.cells[cells], return_inverse=True)
        part = SectionMesh(
            mesh.nodes[nodes], renumbered.reshape(len(cells), -1), mesh.element, None
        )
        elasticity = moduli.at(cells[:1], np.zeros((1, 1, 2)))[0, 0]
        # C₁₁ = λ + 2μ and C₁₂ = λ of an isotropic material.
        ratios[cells] = elasticity[0, 1] / (elasticity[0, 0] + elasticity[0, 1])
        strains = _strains(part, displacements[nodes], slopes[nodes])
        stresses.append(np.einsum("ij,jnf->inf", elasticity, strains))
        area = float(section_quadrature(part).weights.sum())
        distances.append(area / perimeter(part))
        corners.append(reentrant_corners(part))
        points.append(part.nodes)
        parts.append(np.full(len(nodes), region))
    # Within the thinnest part, a corner between two parts leaves points that count.
    corners += [reentrant_corners(mesh), _free_joint_ends(mesh, ratios)]
    distances += [min(distances)] * 2
    nodes_of_parts = np.vstack(points)
    regular = [
        apart_from(positions, nodes_of_parts, distance)
        for positions, distance in zip(corners, distances, strict=True)
    ]
    xx, yy, zz, yz, xz, xy = np.concatenate(stresses, axis=1)
    return PartStresses(
        nodes_of_parts,
        xx,
        np.stack([xy, xz]),
        np.all(regular, axis=0),
        np.stack([yy, zz, yz]),
        np.concatenate(parts),
    )


def _free_joint_ends(mesh: SectionMesh, ratios: Array) -> Array:
    """Nodes (e×2, in m) on the rim at which parts with different Poisson's ratios meet.

    `ratios` (M) are those of the cells.
    """
    lowest, highest = np.full(len(mesh.nodes), np.inf), np.full(len(mesh.nodes), -np.inf)
    np.minimum.at(lowest, mesh.cells, ratios[:, None])
    np.maximum.at(highest, mesh.cells, ratios[:, None])
    on_rim = np.unique(rim_edges(mesh))
    unequal = highest[on_rim] - lowest[on_rim] > _EQUAL_RATIOS
    return np.asarray(mesh.nodes[on_rim[unequal]])


def _strains(mesh: SectionMesh, displacements: Array, slopes: Array) -> Array:
    """Strains (6×N×6) at the N nodes, in the order of `fem.sections.moduli`.

    `displacements` (N×3×6) and their derivatives along the leg `slopes` (N×3×6) belong to six
    states. Derivatives in the section are means over the adjacent cells.
    """
    gradient = NodalGradient(mesh)
    by_y, by_z = np.moveaxis(
        np.array(
            [
                [gradient(displacements[:, direction, state]) for state in range(6)]
                for direction in range(3)
            ]
        ),
        2,
        0,
    ).swapaxes(2, 3)
    along = np.moveaxis(slopes, 1, 0)
    return np.stack(
        [
            along[0],
            by_y[1],
            by_z[2],
            by_z[1] + by_y[2],
            along[2] + by_z[0],
            along[1] + by_y[0],
        ]
    )
