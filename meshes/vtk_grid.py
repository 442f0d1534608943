"""Meshes as VTK grids, for pictures and files."""

from typing import TYPE_CHECKING

import numpy as np

from meshes.elements import ELEMENTS
from meshes.section.section_mesh import SectionMesh
from meshes.solid_mesh import VolumeMesh

if TYPE_CHECKING:
    import pyvista


def grid(mesh: SectionMesh | VolumeMesh) -> "pyvista.UnstructuredGrid":
    """The mesh as a VTK grid in leg axes (m), nodes and cells in the mesh's own numbering.

    A section lies in the plane x = 0. Data per node or cell can be attached as they are.
    """
    # VTK takes seconds and system libraries to load; whoever draws nothing needs neither.
    import pyvista  # noqa: PLC0415

    kind = ELEMENTS[mesh.element]
    nodes = mesh.nodes
    if nodes.shape[1] == 2:
        nodes = np.column_stack([np.zeros(len(nodes)), nodes])
    return pyvista.UnstructuredGrid({kind.vtk_type: mesh.cells[:, list(kind.vtk_order)]}, nodes)
