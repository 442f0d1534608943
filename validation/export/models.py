"""The models of a robot as files for other programs: VTU and VTP, npz and Matrix Market."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from scipy.io import mmwrite
from scipy.sparse import coo_array, csc_array, save_npz

from fem.bodies import solid
from lumped.arrays import Array, SparseMatrix, dense
from lumped.legs import ConstantLeg
from lumped.mechanism.body_model import LegMatrices
from lumped.models.cantilever import clamped_modes
from validation.context import Preset
from validation.export.readme import OF_LEGS
from validation.export.vtk_files import grid, polyline, save
from validation.models.legs import leg_matrices

WRENCHES = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
MODES = 6
# Quadratic elements across the smaller side of the section.
DIVISIONS: dict[Preset, int] = {"quick": 2, "standard": 4, "fine": 6}
# The matrices are meant to be looked at and tried: one element across keeps them below 1000 rows.
MATRIX_DIVISIONS = 1
STATIONS = 41


def about_legs(preset: Preset) -> dict[str, str]:
    """What the files of legs hold."""
    numbers = {"divisions": DIVISIONS[preset], "matrix_divisions": MATRIX_DIVISIONS}
    return {pattern: text.format(**numbers) for pattern, text in OF_LEGS.items()}


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


def _write_solid(leg: ConstantLeg, divisions: int, path: Path) -> None:
    mesh = solid.solid_mesh(leg, divisions)
    clamped = solid.clamped_leg(solid.solid_leg(leg, mesh))
    deflections = clamped.solid.transformation @ clamped.response
    swung = clamped.modes(MODES)
    data = grid(mesh)
    for name, field in named_fields(deflections, swung.shapes).items():
        data.point_data[name] = field.reshape(-1, 3)
    data.field_data["frequencies"] = swung.frequencies
    save(data, path)


def _write_centreline(leg: LegMatrices, path: Path) -> None:
    stations = np.linspace(0.0, leg.length, STATIONS)
    twists = leg.centreline(stations)
    held = dense(leg.stiffness)[6:, 6:]
    deflections = np.zeros((leg.size, 6))
    deflections[6:] = np.linalg.solve(held, np.eye(leg.size - 6, 6))
    swung = clamped_modes(leg, MODES)
    points = np.column_stack([stations, np.zeros((STATIONS, 2))])
    fields = named_fields(twists @ deflections, twists @ swung.shapes)
    save(polyline([points], vectors_of(fields), swung.frequencies), path)


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
    named = {_DISPLACEMENT[w]: u for w, u in zip(WRENCHES, deflections.T, strict=True)}
    return named | {f"mode {k}": shape for k, shape in enumerate(shapes.T, start=1)}


_DISPLACEMENT = {wrench: f"displacement {wrench}" for wrench in WRENCHES}
_ROTATION = {_DISPLACEMENT[wrench]: f"rotation {wrench}" for wrench in WRENCHES}


def vectors_of(fields: Mapping[str, Array]) -> dict[str, Array]:
    """Twists along a centreline, flattened (6m), as displacements and rotations (m×3 each)."""
    vectors = {}
    for name, field in fields.items():
        twists = np.asarray(field).reshape(-1, 6)
        vectors[name] = twists[:, :3]
        vectors[_ROTATION.get(name, f"rotation {name}")] = twists[:, 3:]
    return vectors
