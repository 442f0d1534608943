"""The models of a robot as files for other programs: VTU, VTP, npz, Matrix Market, CalculiX."""

from collections.abc import Mapping, Sequence
from errno import EIO
from fnmatch import fnmatchcase
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np
from scipy.io import mmwrite
from scipy.sparse import coo_array, csc_array, save_npz

from fem.bodies import solid
from fem.bodies.part import grips_of, held_part, meshed_part
from fem.calculix.deck import deck_text
from fem.calculix.leg import bar_solids, with_bars
from fem.calculix.mechanism import mechanism_deck
from fem.reduction.craig_bampton import reduction
from fem.reduction.held import held_body
from lumped.arrays import Array, SparseMatrix, dense
from lumped.legs import ConstantLeg
from lumped.mechanism.body import Body
from lumped.mechanism.body_model import LegMatrices
from lumped.mechanism.kinematics.postures import posture, shown_pose
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import clamped_modes, legs_of
from lumped.system.solution import solved
from meshes.elements import ELEMENTS
from meshes.solid_mesh import VolumeMesh
from validation.context import Preset
from validation.models.legs import leg_matrices
from validation.models.mechanism import constant_legs, mechanism_modes
from validation.models.options import DEFAULT_OPTIONS
from validation.models.parts import found_in, shape_of, unknowns_of
from validation.parts.meshes import part_mesh

# VTK takes seconds and system libraries to load; whoever draws nothing needs neither.
if TYPE_CHECKING:
    import pyvista
WRENCHES = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
MODES = 6
# Quadratic elements across the smaller side of the section.
DIVISIONS: dict[Preset, int] = {"quick": 2, "standard": 4, "fine": 6}
# The matrices are meant to be looked at and tried: one element across keeps them below 1000 rows.
_MATRIX_DIVISIONS = 1
_STATIONS = 41
_HEAD = """\
Models of {name}, SI units (m, N, kg, s, rad). Files begin with the name of their body{stands}"""
_OF_LEGS = """; of
bodies that are alike the first stands for all:
{alike}
Leg axes: x from root to tip. A leg given by a compliance alone is its equivalent leg of constant
section."""
# All files of bodies have an underscore after their name, which may be this one.
_MECHANISM_FILES = {
    "mechanism.vtp": (
        "All legs in base axes, {pose}: unit wrenches at the loaded point, modes of the mechanism. "
        'Cell data "leg": their number in the order of the file ({legs}).'
    ),
    "mechanism.inp": (
        "A deck of CalculiX in the same pose, legs as solid bars of their outer size, one "
        "quadratic tetrahedron across, end faces rigid; joints as linear equations, drives as "
        "springs; six unit wrenches at the loaded point, then {modes} modes and the idle motions."
    ),
}
_WIDTH = 96
_VECTORS = (
    '"displacement Fx" to "displacement Mz" (m per N or N m): unit wrenches at {where}. "mode 1" '
    "and on: mass-normalised shapes; their frequencies (Hz) are field data."
)
_LINE = 'The same data along the centreline, and "rotation Fx" and on (rad) for each.'
# Of legs of constant section, whatever the robot: what files of these names hold.
_LEG_FILES: Mapping[str, str] = {
    "*_solid.vtu": (
        "The leg as a solid, {divisions} quadratic elements across the section; root clamped, end "
        f"faces rigid. Point data {_VECTORS.format(where='the tip')}"
    ),
    "*_beam.vtp": f"The leg in beam elements (Timoshenko). {_LINE}",
    "*_segments.vtp": f"The leg in rigid segments with springs between them. {_LINE}",
    "*_[KM].*": (
        "Stiffness (K) and mass (M) of the free leg, symmetric: .npz (scipy.sparse.load_npz), .mtx "
        "(Matrix Market). Unknowns: twist of the root [x y z phi_x phi_y phi_z], twist of the "
        "tip, then the model's own. The solid is meshed more coarsely, {matrix_divisions} element "
        "across, with three displacements per inner node."
    ),
}
_PART_FILES: Mapping[str, str] = {
    "*_part.vtu": (
        "The part on its finest mesh, in the axes of its file (m), held as the robot file says, "
        "the first interface clamped. For every other interface NAME, point data "
        '"displacement NAME Fx" to "displacement NAME Mz" (m per N or N m): unit wrenches there. '
        '"mode 1" and on: mass-normalised shapes; their frequencies (Hz) are field data.'
    ),
    "*_reduced_[KM].*": (
        "Stiffness (K) and mass (M) of the free part on the same mesh, reduced by Craig and "
        "Bampton, symmetric: .npz (scipy.sparse.load_npz), .mtx (Matrix Market). Unknowns: twist "
        "[x y z phi_x phi_y phi_z] of every interface in the order of the robot file, then "
        "amplitudes of modes with all interfaces held. Without the first six rows and columns "
        "they have the frequencies of the part with its first interface clamped."
    ),
}


def export_mechanism(mechanism: Mechanism, preset: Preset, folder: Path) -> None:
    """Write every different leg and every CAD part, the mechanism as beams and its deck.

    In the middle pose of the path; a mechanism with parts has neither beams nor deck. Raises
    InputError where a part cannot be meshed, ComputationError where a model cannot be solved,
    OSError where the disk refuses.
    """
    at = posture(mechanism, mechanism.poses[len(mechanism.poses) // 2])
    # Every different leg with the bodies that have its shape.
    legs = [(leg, name) for name, leg, _ in constant_legs(mechanism, DEFAULT_OPTIONS)]
    alike = {leg: [name for other, name in legs if other == leg] for leg, _ in legs}
    parts = [_write_part(body, folder) for body in mechanism.parts.values()]
    for leg, ones in alike.items():
        _write_leg(leg, ones[0], DIVISIONS[preset], folder)
    if alike and not parts:
        _write_beams(at, folder / "mechanism.vtp")
        bars = with_bars(at)
        deck = mechanism_deck(bars, bar_solids(bars.mechanism), MODES).deck
        (folder / "mechanism.inp").write_text(deck_text(deck), encoding="utf-8")
    names = "\n".join(f"    {', '.join(ones)}" for ones in alike.values())
    head = _HEAD.format(name=mechanism.name, stands=_OF_LEGS.format(alike=names) if alike else ".")
    said = {
        "pose": shown_pose(mechanism, at.pose) or "reference posture",
        "legs": ", ".join(legs_of(mechanism)),
        "modes": MODES,
        "divisions": DIVISIONS[preset],
        "matrix_divisions": _MATRIX_DIVISIONS,
    }
    head = "\n".join([head, *(f"Part {part}." for part in parts)])
    about = {**_MECHANISM_FILES, **_PART_FILES, **_LEG_FILES}
    _write_readme(folder, head, {files: text.format(**said) for files, text in about.items()})


def _write_beams(at: Posture, path: Path) -> None:
    (found,) = mechanism_modes("beam", [at], MODES)
    system = found.system
    deflections = solved(system).displacements(system.tool.T)
    lines, fields = [], []
    for name in legs_of(at.mechanism):
        frame, model = at.frames[name], system.models[name]
        if not isinstance(model, LegMatrices):
            raise TypeError(f"{name}: the beam model of a leg has a centreline")
        stations = np.linspace(0.0, model.length, _STATIONS)
        lines.append(frame.position + np.outer(stations, frame.rotation[:, 0]))
        twists = model.centreline(stations)
        own = _vectors_of(
            _named_fields(
                twists @ system.body_unknowns(name, deflections),
                twists @ system.body_unknowns(name, found.modes.shapes),
            )
        )
        fields.append({key: field @ frame.rotation.T for key, field in own.items()})
    joined = {key: np.vstack([one[key] for one in fields]) for key in fields[0]}
    _save(_polyline(lines), joined, found.modes.frequencies, path)


def _write_readme(folder: Path, head: str, about: Mapping[str, str]) -> None:
    """Write README.txt for all files in `folder`, each under the first pattern that it matches.

    `about` maps shell-style patterns to what such files hold.
    """
    files = sorted(path.name for path in folder.iterdir())
    blocks = [head]
    for pattern, text in about.items():
        described = [name for name in files if fnmatchcase(name, pattern)]
        files = [name for name in files if name not in described]
        if described:
            blocks.append(f"{_wrapped(', '.join(described))}\n{_wrapped(text, ' ' * 4)}")
    (folder / "README.txt").write_text("\n\n".join(blocks) + "\n", encoding="utf-8")


def _wrapped(text: str, indent: str = "") -> str:
    return fill(
        text, _WIDTH, initial_indent=indent, subsequent_indent=indent, break_on_hyphens=False
    )


def grid(mesh: VolumeMesh) -> "pyvista.UnstructuredGrid":
    """The mesh as a VTK grid (m), nodes and cells in the mesh's own numbering."""
    import pyvista  # noqa: PLC0415

    kind = ELEMENTS[mesh.element]
    cells = {kind.vtk_type: mesh.cells[:, list(kind.vtk_order)]}
    return pyvista.UnstructuredGrid(cells, mesh.nodes)


def _polyline(lines: Sequence[Array]) -> "pyvista.PolyData":
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


def _save(
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


def _write_leg(leg: ConstantLeg, stem: str, divisions: int, folder: Path) -> None:
    """Write one leg as solid, beam and segments, files of the name `stem`, root clamped.

    Raises ComputationError where a model cannot be solved, OSError where the disk refuses.
    """
    _write_solid(leg, divisions, folder / f"{stem}_solid.vtu")
    coarse = solid.solid_leg(leg, solid.solid_mesh(leg, _MATRIX_DIVISIONS))
    models = {
        "segments": leg_matrices("segments", leg),
        "beam": leg_matrices("beam", leg),
        "solid": solid.solid_leg_matrices(coarse),
    }
    for name, matrices in models.items():
        _write_matrix(matrices.stiffness, folder / f"{stem}_{name}_K")
        _write_matrix(matrices.mass, folder / f"{stem}_{name}_M")
    for name in ("segments", "beam"):
        _write_centreline(models[name], folder / f"{stem}_{name}.vtp")


def _write_part(body: Body, folder: Path) -> str:
    """Write a part on the finest mesh of its identification; in a line what its interfaces are.

    Raises InputError where it cannot be meshed, ComputationError where it cannot be solved,
    OSError where the disk refuses.
    """
    file, interfaces = found_in(body)
    mesh = part_mesh(file, interfaces, unknowns_of(body))
    meshed = meshed_part(mesh, shape_of(body).material)
    held = held_part(meshed, grips_of(mesh, interfaces), body.name)
    swung = held.modes(MODES)
    reduced = reduction(held_body(held), float(swung.frequencies[-1]))
    _write_matrix(reduced.stiffness, folder / f"{body.name}_reduced_K")
    _write_matrix(reduced.mass, folder / f"{body.name}_reduced_M")

    at_nodes = held.solid.transformation
    others = [one.name for one in interfaces[1:]]
    names = [f"displacement {name} {wrench}" for name in others for wrench in WRENCHES]
    fields = dict(zip(names, (at_nodes @ held.response).T, strict=True))
    fields |= {f"mode {k}": shape for k, shape in enumerate(swung.shapes.T, start=1)}
    _save(grid(mesh), fields, swung.frequencies, folder / f"{body.name}_part.vtu")
    held_by = ", ".join(f"{one.name} ({one.coupling})" for one in interfaces)
    return f"{body.name}: {file.path.name}, interfaces {held_by}"


def _write_solid(leg: ConstantLeg, divisions: int, path: Path) -> None:
    mesh = solid.solid_mesh(leg, divisions)
    clamped = solid.clamped_leg(solid.solid_leg(leg, mesh))
    deflections = clamped.solid.transformation @ clamped.response
    swung = clamped.modes(MODES)
    _save(grid(mesh), _named_fields(deflections, swung.shapes), swung.frequencies, path)


def _write_centreline(leg: LegMatrices, path: Path) -> None:
    stations = np.linspace(0.0, leg.length, _STATIONS)
    twists = leg.centreline(stations)
    held = dense(leg.stiffness)[6:, 6:]
    deflections = np.zeros((leg.size, 6))
    deflections[6:] = np.linalg.solve(held, np.eye(leg.size - 6, 6))
    swung = clamped_modes(leg, MODES)
    points = np.column_stack([stations, np.zeros((_STATIONS, 2))])
    fields = _named_fields(twists @ deflections, twists @ swung.shapes)
    _save(_polyline([points]), _vectors_of(fields), swung.frequencies, path)


def _write_matrix(matrix: SparseMatrix | Array, path: Path) -> None:
    """Write a symmetric matrix beside `path` as .npz and .mtx."""
    # Matrix Market's symmetric form keeps one triangle: the halves are made equal to the last bit.
    full = csc_array((matrix + matrix.T) / 2.0)
    full.eliminate_zeros()
    full.sort_indices()
    save_npz(path.with_name(f"{path.name}.npz"), full)
    mmwrite(path.with_name(f"{path.name}.mtx"), coo_array(full), symmetry="symmetric")


def _named_fields(deflections: Array, shapes: Array) -> dict[str, Array]:
    """Columns by name: deflections under unit wrenches, then mode shapes."""
    named = {f"displacement {w}": u for w, u in zip(WRENCHES, deflections.T, strict=True)}
    return named | {f"mode {k}": shape for k, shape in enumerate(shapes.T, start=1)}


def _vectors_of(fields: Mapping[str, Array]) -> dict[str, Array]:
    """Twists along a centreline, flattened (6m), as displacements and rotations (m×3 each)."""
    vectors = {}
    for name, field in fields.items():
        twists = np.asarray(field).reshape(-1, 6)
        vectors[name] = twists[:, :3]
        vectors[f"rotation {name.removeprefix('displacement ')}"] = twists[:, 3:]
    return vectors
