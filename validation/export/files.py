"""Files of `run --export`: VTU, VTP, .npz, Matrix Market and a CalculiX deck.

Input: a mechanism, a preset (the mesh of the solids) and a folder. Output: fields of displacements
and modes, matrices of legs and CAD parts, and README.txt, which describes each file. A mechanism
with CAD parts is not written as beams. There is no CalculiX deck if the mechanism has CAD parts or
legs of varying section.
"""

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
from fem.calculix.leg import bar_solids, why_no_bars, with_bars
from fem.calculix.mechanism import mechanism_deck
from fem.reduction.craig_bampton import reduction
from fem.reduction.held import held_body
from lumped.arrays import Array, SparseMatrix, dense
from lumped.legs import SectionedLeg
from lumped.mechanism.body import Body
from lumped.mechanism.body_model import LegMatrices
from lumped.mechanism.kinematics.postures import posture, shown_pose
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import clamped_modes, legs_of
from lumped.system.solution import solved
from meshes.elements import ELEMENTS
from meshes.solid_mesh import VolumeMesh
from validation.context import Preset
from validation.models.leg_models import leg_matrices
from validation.models.options import DEFAULT_OPTIONS
from validation.models.reduced_parts import found_in, shape_of, unknowns_of
from validation.models.robot_bodies import sectioned_legs
from validation.models.robot_models import mechanism_modes
from validation.parts.meshes import part_mesh

# VTK takes seconds to load and needs system libraries, so it is imported only to write VTK files.
if TYPE_CHECKING:
    import pyvista
WRENCHES = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
MODES = 6
# Quadratic elements across the smaller side of the section.
DIVISIONS: dict[Preset, int] = {"quick": 2, "standard": 4, "fine": 6}
# Divisions of solids whose matrices are written for inspection and trials. With one element across
# the section they have fewer than 1000 rows.
_MATRIX_DIVISIONS = 1
# Number of points along a centreline.
_STATIONS = 41
_HEAD = """\
Models of {name}, SI units (m, N, kg, s, rad). Names of files begin with the name of their
body{legs_text}"""
_LEGS_TEXT = """. Equal
legs have one set of files with the name of the first of them:
{equal_legs}
Leg axes: x from root to tip. A leg known by a compliance is replaced by its equivalent leg of
constant section."""
# File names of a body contain an underscore, so that a body can be named "mechanism".
_MECHANISM_FILES = {
    "mechanism.vtp": (
        "All legs in base axes, {pose}: displacements under unit wrenches at the loaded point, and "
        'modes of the mechanism. Cell data "leg": number of the leg in the order of the robot file '
        "({legs})."
    ),
    "mechanism.inp": (
        "Deck of CalculiX in the same pose. Legs are solid bars of their outer size, one quadratic "
        "tetrahedron across (bricks, if they are tapered, stepped or bent), with rigid end faces. "
        "Joints are linear equations, drives are "
        "springs. Steps: six unit wrenches at the loaded point, then {modes} modes and the idle "
        "motions."
    ),
}
# Width of README.txt in characters.
_WIDTH = 96
_VECTORS = (
    '"displacement Fx" to "displacement Mz" (m per N or N m): displacements under unit wrenches at '
    'the tip. "mode 1" and on: mass-normalised shapes; their frequencies (Hz) are field data.'
)
_LINE = 'The same data along the centreline, with "rotation Fx" and on (rad).'
# Descriptions of the files of legs of constant section, by pattern of their names.
_LEG_FILES: Mapping[str, str] = {
    "*_solid.vtu": (
        "The leg as a solid, {divisions} quadratic elements across the section, with clamped root "
        f"and rigid end faces. Point data {_VECTORS}"
    ),
    "*_beam.vtp": f"The leg in beam elements (Timoshenko). {_LINE}",
    "*_segments.vtp": f"The leg in rigid segments with springs between them. {_LINE}",
    "*_[KM].*": (
        "Stiffness (K) and mass (M) of the free leg, symmetric: .npz (scipy.sparse.load_npz), .mtx "
        "(Matrix Market). Unknowns: twist of the root [x y z phi_x phi_y phi_z], twist of the "
        "tip, then unknowns of the model. The solid has a coarser mesh, {matrix_divisions} element "
        "across the section, with three displacements per inner node."
    ),
}
# Descriptions of the files of CAD parts, by pattern of their names.
_PART_FILES: Mapping[str, str] = {
    "*_part.vtu": (
        "The part on its finest mesh, in the axes of its file (m), with interfaces coupled as in "
        "the robot file and the first one clamped. For each other interface NAME, point data "
        '"displacement NAME Fx" to "displacement NAME Mz" (m per N or N m): displacements under '
        'unit wrenches there. "mode 1" and on: mass-normalised shapes; their frequencies (Hz) are '
        "field data."
    ),
    "*_reduced_[KM].*": (
        "Stiffness (K) and mass (M) of the free part on the same mesh, by Craig–Bampton reduction, "
        "symmetric: .npz (scipy.sparse.load_npz), .mtx (Matrix Market). Unknowns: twist "
        "[x y z phi_x phi_y phi_z] of each interface in the order of the robot file, then "
        "amplitudes of modes with all interfaces fixed. Without their first six rows and columns "
        "the matrices have the frequencies of the part with its first interface clamped."
    ),
}


def export_mechanism(mechanism: Mechanism, preset: Preset, folder: Path) -> None:
    """Write distinct legs, CAD parts, the mechanism as beams and a CalculiX deck to `folder`.

    The pose is the middle one of the path. A mechanism with CAD parts is not written as beams.
    There is no deck if the mechanism has CAD parts or a leg that has no mesh as a solid bar. Raises
    InputError if a part cannot be meshed, ComputationError if a model cannot be solved, and OSError
    if a file cannot be written.
    """
    middle = posture(mechanism, mechanism.poses[len(mechanism.poses) // 2])
    legs = [(leg, name) for name, leg, _ in sectioned_legs(mechanism, DEFAULT_OPTIONS)]
    names_of_leg = {leg: [name for other, name in legs if other == leg] for leg, _ in legs}
    parts = [_write_part(body, folder) for body in mechanism.parts.values()]
    for leg, names in names_of_leg.items():
        _write_leg(leg, names[0], DIVISIONS[preset], folder)
    if names_of_leg and not parts:
        _write_beams(middle, folder / "mechanism.vtp")
        bars = with_bars(middle)
        if not why_no_bars(bars.mechanism):
            deck = mechanism_deck(bars, bar_solids(bars.mechanism), MODES).deck
            (folder / "mechanism.inp").write_text(deck_text(deck), encoding="utf-8")
    equal_legs = "\n".join(f"    {', '.join(names)}" for names in names_of_leg.values())
    legs_text = _LEGS_TEXT.format(equal_legs=equal_legs) if names_of_leg else "."
    head = _HEAD.format(name=mechanism.name, legs_text=legs_text)
    values = {
        "pose": shown_pose(mechanism, middle.pose) or "reference posture",
        "legs": ", ".join(legs_of(mechanism)),
        "modes": MODES,
        "divisions": DIVISIONS[preset],
        "matrix_divisions": _MATRIX_DIVISIONS,
    }
    head = "\n".join([head, *(f"Part {part}." for part in parts)])
    templates = {**_MECHANISM_FILES, **_PART_FILES, **_LEG_FILES}
    texts = {pattern: template.format(**values) for pattern, template in templates.items()}
    _write_readme(folder, head, texts)


def _write_beams(posture: Posture, path: Path) -> None:
    (solution,) = mechanism_modes("beam", [posture], MODES)
    system, modes = solution.system, solution.modes
    deflections = solved(system).displacements(system.tool.T)
    lines, fields = [], []
    for name in legs_of(posture.mechanism):
        frame, model = posture.frames[name], system.models[name]
        if not isinstance(model, LegMatrices):
            raise TypeError(f"{name}: the beam model of the leg along its centreline")
        stations = np.linspace(0.0, model.line_length, _STATIONS)
        lines.append(frame.position + model.centreline_points(stations) @ frame.rotation.T)
        twists = model.centreline(stations)
        leg_fields = _vectors_of(
            _named_fields(
                twists @ system.body_unknowns(name, deflections),
                twists @ system.body_unknowns(name, modes.shapes),
            )
        )
        fields.append({key: field @ frame.rotation.T for key, field in leg_fields.items()})
    all_legs = {key: np.vstack([leg_fields[key] for leg_fields in fields]) for key in fields[0]}
    _save(_polyline(lines), all_legs, modes.frequencies, path)


def _write_readme(folder: Path, head: str, texts: Mapping[str, str]) -> None:
    """Write README.txt: `head`, then the names of the files in `folder` with their descriptions.

    `texts`: descriptions by shell-style pattern of names. The first pattern that fits is used.
    """
    files = sorted(path.name for path in folder.iterdir())
    blocks = [head]
    for pattern, text in texts.items():
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
    """Mesh as a VTK grid (m). Nodes and cells keep their numbers."""
    import pyvista  # noqa: PLC0415

    kind = ELEMENTS[mesh.element]
    cells = {kind.vtk_type: mesh.cells[:, list(kind.vtk_order)]}
    return pyvista.UnstructuredGrid(cells, mesh.nodes)


def _polyline(lines: Sequence[Array]) -> "pyvista.PolyData":
    """Open lines through points (n×3 each, in m), numbered from 1 in the cell data "leg"."""
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
    """Write `fields` (3 numbers per point) and `frequencies` (Hz) in VTK's binary XML format.

    Raises OSError if the file cannot be written.
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
    # If the disk is full, VTK prints a message, returns, and leaves an incomplete file.
    if not writer.Write() or writer.GetErrorCode():
        raise OSError(EIO, "VTK could not write the file; is the disk full?", str(path))


def _write_leg(leg: SectionedLeg, stem: str, divisions: int, folder: Path) -> None:
    """Write one leg with clamped root as solid, beam and segments, to files named after `stem`.

    Raises ComputationError if a model cannot be solved, and OSError if a file cannot be written.
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
    """Write a CAD part on the finest mesh of its identification. Returns a line on its interfaces.

    Raises InputError if it cannot be meshed, ComputationError if it cannot be solved, and OSError
    if a file cannot be written.
    """
    file, interfaces = found_in(body)
    mesh = part_mesh(file, interfaces, unknowns_of(body))
    meshed = meshed_part(body.name, mesh, shape_of(body).material)
    clamped = held_part(meshed, grips_of(mesh, interfaces))
    modes = clamped.modes(MODES)
    reduced = reduction(held_body(clamped), float(modes.frequencies[-1]))
    _write_matrix(reduced.stiffness, folder / f"{body.name}_reduced_K")
    _write_matrix(reduced.mass, folder / f"{body.name}_reduced_M")

    nodal_displacements = clamped.solid.transformation @ clamped.response
    names = [
        f"displacement {interface.name} {wrench}"
        for interface in interfaces[1:]
        for wrench in WRENCHES
    ]
    fields = dict(zip(names, nodal_displacements.T, strict=True))
    fields |= {f"mode {k}": shape for k, shape in enumerate(modes.shapes.T, start=1)}
    _save(grid(mesh), fields, modes.frequencies, folder / f"{body.name}_part.vtu")
    couplings = ", ".join(f"{interface.name} ({interface.coupling})" for interface in interfaces)
    return f"{body.name}: {file.path.name}, interfaces {couplings}"


def _write_solid(leg: SectionedLeg, divisions: int, path: Path) -> None:
    mesh = solid.solid_mesh(leg, divisions)
    clamped = solid.clamped_leg(solid.solid_leg(leg, mesh))
    deflections = clamped.solid.transformation @ clamped.response
    modes = clamped.modes(MODES)
    _save(grid(mesh), _named_fields(deflections, modes.shapes), modes.frequencies, path)


def _write_centreline(leg: LegMatrices, path: Path) -> None:
    stations = np.linspace(0.0, leg.line_length, _STATIONS)
    twists = leg.centreline(stations)
    clamped_stiffness = dense(leg.stiffness)[6:, 6:]
    deflections = np.zeros((leg.size, 6))
    deflections[6:] = np.linalg.solve(clamped_stiffness, np.eye(leg.size - 6, 6))
    modes = clamped_modes(leg, MODES)
    points = leg.centreline_points(stations)
    fields = _named_fields(twists @ deflections, twists @ modes.shapes)
    _save(_polyline([points]), _vectors_of(fields), modes.frequencies, path)


def _write_matrix(matrix: SparseMatrix | Array, path: Path) -> None:
    """Write a symmetric matrix to `path` with the suffixes .npz and .mtx."""
    # Matrix Market's symmetric form stores one triangle, so both triangles must be equal to the
    # last bit.
    full = csc_array((matrix + matrix.T) / 2.0)
    full.eliminate_zeros()
    full.sort_indices()
    save_npz(path.with_name(f"{path.name}.npz"), full)
    mmwrite(path.with_name(f"{path.name}.mtx"), coo_array(full), symmetry="symmetric")


def _named_fields(deflections: Array, shapes: Array) -> dict[str, Array]:
    """Columns by name: deflections under unit wrenches, then mode shapes."""
    fields = {f"displacement {w}": u for w, u in zip(WRENCHES, deflections.T, strict=True)}
    return fields | {f"mode {k}": shape for k, shape in enumerate(shapes.T, start=1)}


def _vectors_of(fields: Mapping[str, Array]) -> dict[str, Array]:
    """Displacements and rotations (n×3 each) by name, from twists (6n) along a centreline."""
    vectors = {}
    for name, field in fields.items():
        twists = np.asarray(field).reshape(-1, 6)
        vectors[name] = twists[:, :3]
        vectors[f"rotation {name.removeprefix('displacement ')}"] = twists[:, 3:]
    return vectors
