"""Meshes as VTK grids, centrelines as VTK lines, and VTK data as files."""

from collections.abc import Mapping, Sequence
from errno import EIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from lumped.arrays import Array
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


def polyline(
    lines: Sequence[Array], point_data: Mapping[str, Array], frequencies: Array
) -> "pyvista.PolyData":
    """Open lines through their points (m×3 each, m); data per point of all lines in their order.

    `frequencies` (Hz) become field data; the cell data "leg" number the lines from 1.
    """
    import pyvista  # noqa: PLC0415

    counts = [len(line) for line in lines]
    starts = np.cumsum([0, *counts[:-1]])
    cells = [
        np.r_[count, start + np.arange(count)] for count, start in zip(counts, starts, strict=True)
    ]
    data = pyvista.PolyData(np.vstack(lines), lines=np.concatenate(cells))
    for name, field in point_data.items():
        data.point_data[name] = field
    data.cell_data["leg"] = np.arange(1, len(lines) + 1)
    data.field_data["frequencies"] = frequencies
    return data


def save(data: "pyvista.DataSet", path: Path) -> None:
    """Write VTK's XML format (.vtu, .vtp) in binary. Raises OSError where the disk refuses."""
    from vtkmodules.vtkIOXML import (  # noqa: PLC0415
        vtkXMLPolyDataWriter,
        vtkXMLUnstructuredGridWriter,
    )

    writer = vtkXMLPolyDataWriter() if path.suffix == ".vtp" else vtkXMLUnstructuredGridWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(data)
    # VTK prints a full disk and returns; an incomplete file must not pass for a whole one.
    if not writer.Write() or writer.GetErrorCode():
        raise OSError(EIO, "VTK could not write it (disk full?)", str(path))
