"""Meshes as VTK grids, centrelines as VTK lines, and both with fields as files."""

from collections.abc import Mapping, Sequence
from errno import EIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from lumped.arrays import Array
from meshes.elements import ELEMENTS
from meshes.solid_mesh import VolumeMesh

# VTK takes seconds and system libraries to load; whoever draws nothing needs neither.
if TYPE_CHECKING:
    import pyvista


def grid(mesh: VolumeMesh) -> "pyvista.UnstructuredGrid":
    """The mesh as a VTK grid (m), nodes and cells in the mesh's own numbering."""
    import pyvista  # noqa: PLC0415

    kind = ELEMENTS[mesh.element]
    cells = {kind.vtk_type: mesh.cells[:, list(kind.vtk_order)]}
    return pyvista.UnstructuredGrid(cells, mesh.nodes)


def polyline(lines: Sequence[Array]) -> "pyvista.PolyData":
    """Open lines through their points (m×3 each, m), numbered from 1 as cell data "leg"."""
    import pyvista  # noqa: PLC0415

    counts = [len(line) for line in lines]
    starts = np.cumsum([0, *counts[:-1]])
    cells = [
        np.r_[count, start + np.arange(count)] for count, start in zip(counts, starts, strict=True)
    ]
    data = pyvista.PolyData(np.vstack(lines), lines=np.concatenate(cells))
    data.cell_data["leg"] = np.arange(1, len(lines) + 1)
    return data


def save(
    data: "pyvista.DataSet", fields: Mapping[str, Array], frequencies: Array, path: Path
) -> None:
    """Write `fields` (3 numbers per point) and `frequencies` (Hz) in VTK's XML format, binary.

    Raises OSError where the disk refuses.
    """
    from vtkmodules.vtkIOXML import (  # noqa: PLC0415
        vtkXMLPolyDataWriter,
        vtkXMLUnstructuredGridWriter,
    )

    for name, field in fields.items():
        data.point_data[name] = np.asarray(field).reshape(-1, 3)
    data.field_data["frequencies"] = frequencies
    writer = vtkXMLPolyDataWriter() if path.suffix == ".vtp" else vtkXMLUnstructuredGridWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(data)
    # VTK prints a full disk and returns; an incomplete file must not pass for a whole one.
    if not writer.Write() or writer.GetErrorCode():
        raise OSError(EIO, "VTK could not write it (disk full?)", str(path))
