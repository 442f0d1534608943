"""Meshes of solids, and of legs with two end faces, which are meshes of the section."""

from dataclasses import dataclass

from lumped.arrays import Array, IntArray
from meshes.elements import SolidElement
from meshes.section.section_mesh import SectionMesh


@dataclass(frozen=True, eq=False)
class EndFace:
    """End of a leg: its `nodes` (n) in the solid, its `mesh` with nodes in the same order."""

    nodes: IntArray
    mesh: SectionMesh


@dataclass(frozen=True, eq=False)
class VolumeMesh:
    """Mesh of a solid: `nodes` (N×3, m), `cells` (M×k) node numbers, right-handed.

    The nodes of a cell are in the order of `meshes.elements`.
    """

    nodes: Array
    cells: IntArray
    element: SolidElement


@dataclass(frozen=True, eq=False)
class SolidMesh(VolumeMesh):
    """Mesh of a prismatic leg in leg axes, section centroids on the x axis.

    `root` and `tip` are the faces exactly at x = 0 and x = L. An extruded mesh of `slices` slices
    numbers nodes and cells slice by slice from the root; `slices` is None for any other mesh.
    """

    root: EndFace
    tip: EndFace
    slices: int | None

    @property
    def length(self) -> float:
        """Distance from root to tip (m)."""
        return float(self.nodes[self.tip.nodes[0], 0])
