"""Meshes of solids, and of prismatic legs with two end faces."""

from dataclasses import dataclass

import numpy as np

from lumped.arrays import Array, IntArray
from meshes.elements import SolidElement
from meshes.section.section_mesh import SectionMesh


@dataclass(frozen=True, eq=False)
class EndFace:
    """End face of a leg: its `nodes` (n node numbers of the solid), and a plane `mesh` of the face.

    Node i of the plane mesh is node `nodes[i]` of the solid. `axes` (3×3, columns) are the axes of
    the plane mesh, its normal first. None if they are the axes of the leg.
    """

    nodes: IntArray
    mesh: SectionMesh
    axes: Array | None = None


@dataclass(frozen=True, eq=False)
class VolumeMesh:
    """Mesh of a solid: `nodes` (N×3, in m), and node numbers of the `cells` (M×k).

    The nodes of a cell are in the order of `meshes.elements`, and the cells are right-handed: their
    Jacobians are positive.
    """

    nodes: Array
    cells: IntArray
    element: SolidElement


@dataclass(frozen=True, eq=False)
class SolidMesh(VolumeMesh):
    """Mesh of a leg in leg axes.

    In a prismatic leg, the centroids of the sections lie on the x axis. `root` and `tip` are its
    end faces. In a prismatic leg they lie exactly in the planes x = 0 and x = L. In an extruded or
    lofted mesh, nodes and cells are numbered slice by slice from the root, and `slices` is the
    number of slices. None for other meshes.
    """

    root: EndFace
    tip: EndFace
    slices: int | None

    @property
    def regions(self) -> IntArray | None:
        """Index (M) of the part of the section to which each cell belongs.

        None in a leg of one material.
        """
        regions = self.root.mesh.regions
        return None if regions is None or self.slices is None else np.tile(regions, self.slices)

    @property
    def length(self) -> float:
        """Distance (m) from root to tip."""
        tip = self.tip
        node = self.nodes[tip.nodes[0]]
        offset = np.zeros(3) if tip.axes is None else tip.axes[:, 1:] @ tip.mesh.nodes[0]
        return float(node[0] - offset[0])
