"""The models of a robot as files for other programs: VTU and VTP, npz and Matrix Market."""

from collections.abc import Mapping, Sequence
from errno import EIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy.io import mmwrite
from scipy.sparse import coo_array, csc_array, save_npz

from fem.bodies import solid
from fem.bodies.part import grips_of, held_part, meshed_part
from fem.reduction.craig_bampton import reduction
from fem.reduction.held import held_body
from lumped.arrays import Array, SparseMatrix, dense
from lumped.legs import ConstantLeg
from lumped.mechanism.body import Body
from lumped.mechanism.body_model import LegMatrices
from lumped.models.cantilever import clamped_modes
from meshes.elements import ELEMENTS
from meshes.solid_mesh import VolumeMesh
from validation.context import Preset
from validation.models.legs import leg_matrices
from validation.models.parts import UNKNOWNS, found_in, shape_of
from validation.parts.meshes import part_mesh

# VTK takes seconds and system libraries to load; whoever draws nothing needs neither.
if TYPE_CHECKING:
    import pyvista
WRENCHES = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
MODES = 6
# Quadratic elements across the smaller side of the section.
DIVISIONS: dict[Preset, int] = {"quick": 2, "standard": 4, "fine": 6}
# The matrices are meant to be looked at and tried: one element across keeps them below 1000 rows.
MATRIX_DIVISIONS = 1
STATIONS = 41


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


def write_leg(leg: ConstantLeg, stem: str, divisions: int, folder: Path) -> None:
    """Write one leg as solid, beam and segments, files of the name `stem`, root clamped.

    Raises ComputationError where a model cannot be solved, OSError where the disk refuses.
    """
    _write_solid(leg, divisions, folder / f"{stem}_solid.vtu")
    coarse = solid.solid_leg(leg, solid.solid_mesh(leg, MATRIX_DIVISIONS))
    models = {
        "segments": leg_matrices("segments", leg),
        "beam": leg_matrices("beam", leg),
        "solid": solid.solid_leg_matrices(coarse),
    }
    for name, matrices in models.items():
        write_matrix(matrices.stiffness, folder / f"{stem}_{name}_K")
        write_matrix(matrices.mass, folder / f"{stem}_{name}_M")
    for name in ("segments", "beam"):
        _write_centreline(models[name], folder / f"{stem}_{name}.vtp")


def write_part(body: Body, folder: Path) -> str:
    """Write a part on the finest mesh of its identification; in a line what its interfaces are.

    Raises InputError where it cannot be meshed, ComputationError where it cannot be solved,
    OSError where the disk refuses.
    """
    file, interfaces = found_in(body)
    mesh = part_mesh(file, interfaces, UNKNOWNS)
    meshed = meshed_part(mesh, shape_of(body).material)
    held = held_part(meshed, grips_of(mesh, interfaces), body.name)
    swung = held.modes(MODES)
    reduced = reduction(held_body(held), float(swung.frequencies[-1]))
    write_matrix(reduced.stiffness, folder / f"{body.name}_reduced_K")
    write_matrix(reduced.mass, folder / f"{body.name}_reduced_M")

    at_nodes = held.solid.transformation
    others = [one.name for one in interfaces[1:]]
    names = [f"displacement {name} {wrench}" for name in others for wrench in WRENCHES]
    fields = dict(zip(names, (at_nodes @ held.response).T, strict=True))
    fields |= {f"mode {k}": shape for k, shape in enumerate(swung.shapes.T, start=1)}
    save(grid(mesh), fields, swung.frequencies, folder / f"{body.name}_part.vtu")
    held_by = ", ".join(f"{one.name} ({one.coupling})" for one in interfaces)
    return f"{body.name}: {file.path.name}, interfaces {held_by}"


def _write_solid(leg: ConstantLeg, divisions: int, path: Path) -> None:
    mesh = solid.solid_mesh(leg, divisions)
    clamped = solid.clamped_leg(solid.solid_leg(leg, mesh))
    deflections = clamped.solid.transformation @ clamped.response
    swung = clamped.modes(MODES)
    save(grid(mesh), named_fields(deflections, swung.shapes), swung.frequencies, path)


def _write_centreline(leg: LegMatrices, path: Path) -> None:
    stations = np.linspace(0.0, leg.length, STATIONS)
    twists = leg.centreline(stations)
    held = dense(leg.stiffness)[6:, 6:]
    deflections = np.zeros((leg.size, 6))
    deflections[6:] = np.linalg.solve(held, np.eye(leg.size - 6, 6))
    swung = clamped_modes(leg, MODES)
    points = np.column_stack([stations, np.zeros((STATIONS, 2))])
    fields = named_fields(twists @ deflections, twists @ swung.shapes)
    save(polyline([points]), vectors_of(fields), swung.frequencies, path)


def write_matrix(matrix: SparseMatrix | Array, path: Path) -> None:
    """Write a symmetric matrix beside `path` as .npz and .mtx."""
    # Matrix Market's symmetric form keeps one triangle: the halves are made equal to the last bit.
    full = csc_array((matrix + matrix.T) / 2.0)
    full.eliminate_zeros()
    full.sort_indices()
    save_npz(path.with_name(f"{path.name}.npz"), full)
    mmwrite(path.with_name(f"{path.name}.mtx"), coo_array(full), symmetry="symmetric")


def named_fields(deflections: Array, shapes: Array) -> dict[str, Array]:
    """Columns by name: deflections under unit wrenches, then mode shapes."""
    named = {f"displacement {w}": u for w, u in zip(WRENCHES, deflections.T, strict=True)}
    return named | {f"mode {k}": shape for k, shape in enumerate(shapes.T, start=1)}


def vectors_of(fields: Mapping[str, Array]) -> dict[str, Array]:
    """Twists along a centreline, flattened (6m), as displacements and rotations (m×3 each)."""
    vectors = {}
    for name, field in fields.items():
        twists = np.asarray(field).reshape(-1, 6)
        vectors[name] = twists[:, :3]
        vectors[f"rotation {name.removeprefix('displacement ')}"] = twists[:, 3:]
    return vectors
