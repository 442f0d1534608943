"""A part read from a CAD or mesh file: unit, size, and faces from which interfaces are selected."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from lumped.arrays import Array, IntArray
from lumped.errors import ComputationError, InputError
from lumped.files import require_ordinary
from lumped.mechanism.body import METRES
from lumped.robot_file.included import DECK, part_content
from lumped.text import counted
from meshes.gmsh_session import numbered
from meshes.part.boundary import Facets, PartMesh
from meshes.part.enclosed import COARSENESS, VolumeProperties
from meshes.part.faces import Face, face_of
from meshes.part.reading.cad import (
    BREP,
    STEP,
    NotMeshedError,
    cad_model,
)
from meshes.part.reading.given_mesh import LARGEST, MESHES, read_mesh
from meshes.part.reading.surface import corrected_integrals, surface_integrals, triangulate
from meshes.part.reading.units import describe
from meshes.processes import Crashed, within_limits

# Number of sides per full circle of the surface mesh on which faces are recognised.
_SIDES = 24.0
# Relative uncertainty of the volume below which gaps are only round-off.
_EXACT = 1e-9
# Limit on the CPU time (s) for reading a file, and its increase per MB. Plates with many bores need
# 17 s/MB.
_SECONDS, _SECONDS_PER_MB = 60.0, 300.0


@dataclass(frozen=True, eq=False)
class PartFile:
    """A part read from the file `path`, in metres and in the axes of the file.

    `unit` is the length unit of the file, `extent` (3, in m) the size of the part. `surface` (N×3,
    in m) are the nodes of the `faces`. `exact` are volume properties of the shape; None for a mesh
    file. `mesh` is the mesh of a mesh file; None for a CAD file. `gap` (m) is the largest distance
    between faces, edges and corners that should coincide, `unknown_share` the relative uncertainty
    of the volume due to the gap. `by_curvature` is False if gmsh cannot mesh the part with element
    sizes that follow the curvature.
    """

    path: Path
    unit: str
    extent: list[float]
    surface: Array
    faces: tuple[Face, ...]
    exact: VolumeProperties | None
    mesh: PartMesh | None
    gap: float = 0.0
    unknown_share: float = 0.0
    by_curvature: bool = True

    @property
    def size(self) -> str:
        """Text with unit, size and gaps of the part, such as "read in mm: 905 × 170 × 210 mm"."""
        text = f"read in {self.unit}: {describe(self.extent, self.unit)}"
        if not self.by_curvature:
            text += ", meshed without sizes from curvature"
        if self.unknown_share < _EXACT:
            return text
        gap = f"{self.gap / METRES[self.unit]:.2g} {self.unit}"
        return f"{text}, gaps of up to {gap} bridged (volume to {100.0 * self.unknown_share:.1g} %)"

    def face(self, number: int) -> Face:
        """Face of the part with the given number, as printed by `flexproof faces`."""
        return next(face for face in self.faces if face.number == number)


def require_file(path: Path) -> int:
    """Size (bytes) of the file of a part.

    Raises InputError if the file does not exist, has an unsupported suffix, or is too large.
    """
    kinds = (*STEP, *BREP, *MESHES)
    if path.suffix.lower() not in kinds:
        raise InputError(f"{path}: not a part; must be one of {', '.join(kinds)}")
    kind = "a CAD file or a mesh of the part"
    try:
        size = require_ordinary(path, kind)
        with path.open("rb"):
            pass
    except FileNotFoundError as error:
        raise InputError(f"{path}: no such file; must be {kind}") from error
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise InputError(f"{path}: cannot be read ({reason})") from error
    if not 0 < size <= LARGEST:
        raise InputError(
            f"{path}: is {f'larger than {LARGEST / 1e6:g} MB' if size else 'empty'}; must be {kind}"
        )
    return size


def read_part(path: Path, unit: str | None = None) -> PartFile:
    """Part from a STEP, BREP or mesh file. `unit` is the length unit for a file without one.

    A surface that cannot be meshed with element sizes that follow the curvature is meshed without.
    Raises InputError, with file and position of the fault, if the file does not contain a valid
    solid.
    """
    size = require_file(path)
    if path.suffix.lower() == DECK:
        size = len(part_content(path))
    seconds = _SECONDS + _SECONDS_PER_MB * size / 1e6
    try:
        if path.suffix.lower() in MESHES:
            return within_limits(seconds, _read_mesh, path, unit)
        try:
            return within_limits(seconds, _read_cad, path, unit, _SIDES)
        except (NotMeshedError, Crashed) as error:
            try:
                return within_limits(seconds, _read_cad, path, unit, 0.0)
            except (InputError, ComputationError):
                raise error from None
    except ComputationError as error:
        raise InputError(
            f"{path}: the reader of the file fails ({error}): the file is damaged, or much too "
            "large; export it again"
        ) from error


def _read_mesh(path: Path, unit: str | None) -> PartFile:
    mesh, length_unit = read_mesh(path, unit)
    extent = [float(side) for side in np.ptp(mesh.nodes, axis=0)]
    faces = tuple(
        face_of(number, mesh.nodes, facets, mesh.names.get(number, ""))
        for number, facets in mesh.faces.items()
    )
    return PartFile(path, length_unit, extent, mesh.nodes, faces, None, mesh)


def _read_cad(path: Path, unit: str | None, sides: float) -> PartFile:
    with cad_model(path, unit) as model:
        coarse = None
        if not model.is_elementary:
            larger = triangulate(path, model, sides, COARSENESS)
            coarse = surface_integrals(model, larger)
        triangles = triangulate(path, model, sides)
        _require_outward(path, triangles)
        tags, nodes = numbered(model.gmsh, np.concatenate(list(triangles.values())))
        integrals, names = corrected_integrals(model, triangles, coarse), model.names()
        faces = []
        for tag, cells in triangles.items():
            facets, of_face = Facets(np.searchsorted(tags, cells), "tri3"), integrals.areas[tag]
            face = face_of(tag, nodes, facets, names.get(tag, ""))
            faces.append(replace(face, area=of_face.area, centre=of_face.centre))
        return PartFile(
            path,
            model.unit,
            integrals.extent.tolist(),
            nodes,
            tuple(faces),
            integrals.inside,
            None,
            model.gap,
            model.unknown_share,
            by_curvature=sides > 0.0,
        )


def _require_outward(path: Path, triangles: Mapping[int, IntArray]) -> None:
    """Raise InputError if the normal of a face points into the solid.

    The kernel would subtract the volume below such a face instead of adding it. `triangles`
    contains the triangles of each face (F×3 node tags) by face number, oriented like the face. If
    the normals of two neighbouring faces point to the same side, their common edge runs in opposite
    directions in their triangles.
    """
    faces = np.repeat(list(triangles), [3 * len(cells) for cells in triangles.values()])
    edges = np.concatenate(list(triangles.values()))[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    _, edge_numbers, counts = np.unique(edges, axis=0, return_inverse=True, return_counts=True)
    least, largest = np.full(len(counts), faces.max()), np.zeros(len(counts), dtype=np.int64)
    np.minimum.at(least, edge_numbers.ravel(), faces)
    np.maximum.at(largest, edge_numbers.ravel(), faces)
    # An edge that runs in the same direction in two triangles of one face shows that these overlap,
    # for example at the tip of a cone.
    wrong_faces = faces[
        (counts > 1)[edge_numbers.ravel()] & (least < largest)[edge_numbers.ravel()]
    ]
    if len(wrong_faces):
        raise InputError(
            f"{path}: face {np.bincount(wrong_faces).argmax()} points inwards: its edges run in "
            f"the direction of those of its neighbours, {counted(len(wrong_faces) // 2, 'time')}; "
            "export the part again from the CAD system"
        )
