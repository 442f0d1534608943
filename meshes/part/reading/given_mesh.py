"""Volume meshes from other programs: gmsh and VTK by meshio, Abaqus and CalculiX by `deck`.

Faces are the smooth patches of the boundary. They are divided where the file defines groups of
surface elements or node sets on them.
"""

import re
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from lumped.arrays import IntArray
from lumped.errors import InputError
from lumped.mechanism.body import METRES
from lumped.robot_file.included import DECK, LARGEST_DECK
from lumped.text import counted, cut
from meshes.elements import ELEMENTS, SolidElement
from meshes.part.boundary import Facets, PartMesh, boundary, facets_of_cells, smooth_faces
from meshes.part.reading.deck import read_deck
from meshes.part.reading.units import chosen_unit, require_plausible
from meshes.part.reading.vtu_sizes import inflated_size, inflating
from meshes.quality import quality
from meshes.solid_mesh import VolumeMesh

# Formats of meshio by suffix. They are specified because other programs use these suffixes, too.
_FORMAT = {".msh": "gmsh", ".vtu": "vtu"}
MESHES = (".msh", DECK, ".vtu")
# Largest size (bytes) of a file, and of its unpacked arrays.
LARGEST = LARGEST_DECK
# Largest number of characters in the reason why a file cannot be read.
_LONGEST = 160
_NO_NUMBER = re.compile(r"\b(?:int|float)\b.*?: (['\"].*)")
# Name of a group, and one flag per facet of the boundary: True if the facet belongs to the group.
Group: TypeAlias = tuple[str, NDArray[np.bool_]]

# Types of elements by their names in meshio, which numbers nodes as VTK does for all formats.
_ELEMENT: dict[str, SolidElement] = {
    "tetra": "tet4",
    "tetra10": "tet10",
    "hexahedron": "hex8",
    "hexahedron20": "hex20",
    "hexahedron27": "hex27",
}
_FLAT_CELLS = ("vertex", "line", "triangle", "quad")
# Distance, relative to the part's size, below which two nodes count as one. The mesh is torn there.
_SAME_PLACE = 1e-9


def read_mesh(path: Path, unit: str | None = None) -> tuple[PartMesh, str]:
    """Mesh of a part (m) from a mesh file, and the unit of length of the file.

    The unit is `unit`, or metres if it is None. Raises InputError if the file is not a mesh of one
    solid with supported elements.
    """
    source, length_unit = str(path), chosen_unit(None, unit, str(path))
    size = inflated_size(path.read_bytes()) if path.suffix.lower() == ".vtu" else 0
    if size > LARGEST:
        raise InputError(
            f"{source}: the compressed arrays of the file unpack to {size / 1e6:.6g} MB; must be "
            f"at most {LARGEST / 1e6:g} MB"
        )
    with inflating(size):
        raw = _raw(path)
    element, blocks = _solid_cells(raw, source)
    points = np.asarray(raw.points, dtype=float)
    if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
        raise InputError(f"{source}: the nodes of the mesh must have three finite coordinates each")
    cells = np.concatenate([raw.cells[block].data for block in blocks]).astype(np.int64)
    if cells.size == 0 or cells.min() < 0 or cells.max() >= len(points):
        raise InputError(f"{source}: elements of the mesh use nodes that the file does not have")
    kind = ELEMENTS[element]
    order = np.argsort(kind.vtk_order)
    used_nodes, numbers = np.unique(cells, return_inverse=True)
    nodes = METRES[length_unit] * points[used_nodes]
    mesh = VolumeMesh(nodes, numbers.reshape(cells.shape)[:, order], element)
    require_plausible([float(s) for s in np.ptp(nodes, axis=0)], length_unit, source)
    _require_one_solid(mesh, source)
    new_numbers = np.full(len(points), -1)
    new_numbers[used_nodes] = np.arange(len(used_nodes))
    facets = boundary(mesh)
    groups = _groups(raw, facets, new_numbers)
    faces, names = _named(mesh, facets, groups)
    empty_sets = tuple(title for title, inside in groups if not inside.any())
    return PartMesh(nodes, mesh.cells, element, faces, names, empty_sets), length_unit


def _raw(path: Path) -> Any:
    if path.suffix.lower() == DECK:
        return read_deck(path)
    # Slow to import, and needed only for such files.
    import meshio  # noqa: PLC0415

    name = _FORMAT[path.suffix.lower()]
    try:
        # `meshio.read` prints the fault and exits.
        return getattr(meshio, name).read(path)
    except MemoryError:
        raise
    # meshio raises any exception of its parser.
    except Exception as error:
        text = " ".join(str(error).split())
        reason = f"the file is damaged, cut off or not in the format of {name}"
        if isinstance(error, KeyError):
            reason = f"the file refers to {error.args[0]}, which it does not contain"
        elif word := _NO_NUMBER.search(text):
            reason = f"{word.group(1)} is no number"
        # The text of other errors, if any, refers to the parser.
        elif isinstance(error, meshio.ReadError) and error.args and isinstance(error.args[0], str):
            reason += f": {text}"
        raise InputError(f"{path}: cannot be read as a mesh: {cut(reason, _LONGEST)}") from error


def _solid_cells(raw: Any, source: str) -> tuple[SolidElement, list[int]]:
    kinds = {block.type for block in raw.cells if not block.type.startswith(_FLAT_CELLS)}
    if not kinds:
        raise InputError(f"{source}: has no volume elements, only a surface; a part is a solid")
    unknown = sorted(kinds - set(_ELEMENT))
    if unknown or len(kinds) > 1:
        kind_names = ", ".join(sorted(kinds))
        raise InputError(
            f"{source}: has elements of the kinds {kind_names}; must be of one kind among "
            f"{', '.join(_ELEMENT)}"
        )
    (kind,) = kinds
    return _ELEMENT[kind], [i for i, block in enumerate(raw.cells) if block.type == kind]


def _require_one_solid(mesh: VolumeMesh, source: str) -> None:
    size = float(np.ptp(mesh.nodes, axis=0).max())
    rounded = np.round(mesh.nodes / (_SAME_PLACE * size))
    _, first, counts = np.unique(rounded, axis=0, return_index=True, return_counts=True)
    if np.any(counts > 1):
        x, y, z = mesh.nodes[first[counts > 1][0]]
        subject = counted(int((counts - 1).sum()), "node coincides", "nodes coincide")
        raise InputError(
            f"{source}: {subject} with another, the first at ({x:.4g}, {y:.4g}, {z:.4g}) m: the "
            "mesh is torn there; merge them"
        )
    sorted_cells = np.sort(mesh.cells, axis=1)
    _, first, counts = np.unique(sorted_cells, axis=0, return_index=True, return_counts=True)
    if np.any(counts > 1):
        subject_text = counted(int((counts - 1).sum()), "element is", "elements are")
        raise InputError(
            f"{source}: {subject_text} given twice, the first is element "
            f"{first[counts > 1].min() + 1}; delete one of each"
        )
    # The quality is NaN if nodes coincide.
    folded = np.flatnonzero(~(quality(mesh)[0] > 0.0))
    if folded.size:
        x, y, z = mesh.nodes[mesh.cells[folded[0]]].mean(axis=0)
        raise InputError(
            f"{source}: {counted(folded.size, 'element is', 'elements are')} inverted or folded, "
            f"the first is element {folded[0] + 1} at ({x:.4g}, {y:.4g}, {z:.4g}) m"
        )
    pieces = _pieces(mesh)
    if pieces > 1:
        raise InputError(
            f"{source}: the mesh is in {pieces} pieces that share no face of an element; "
            "joined at a point or an edge alone they can turn"
        )


def _pieces(mesh: VolumeMesh) -> int:
    """Number of separate pieces of the mesh. Within a piece, elements are connected by facets."""
    sides, owner = facets_of_cells(mesh)
    _, side = np.unique(np.sort(sides.corners, axis=1), axis=0, return_inverse=True)
    count, size = len(mesh.cells), len(mesh.cells) + len(owner)
    pairs = (owner, count + side.ravel())
    graph = csr_array((np.ones(len(owner)), pairs), shape=(size, size))
    _, label = connected_components(graph, directed=False)
    return len(np.unique(label[:count]))


def _named(
    mesh: VolumeMesh, facets: Facets, groups: list[Group]
) -> tuple[dict[int, Facets], dict[int, str]]:
    """Facets of each face, and names of the faces that lie in a group of the file.

    Both are keyed by the number of the face. Faces are the smooth patches of the boundary `facets`,
    divided at the limits of `groups`.
    """
    label = np.zeros(len(facets.cells), dtype=np.int64)
    for number, rows in enumerate(smooth_faces(mesh.nodes, facets)):
        label[rows] = number
    group = np.zeros(len(facets.cells), dtype=np.int64)
    titles = [""]
    for title, inside in groups:
        titles.append(title)
        group[inside & (group == 0)] = len(titles) - 1
    faces, names = {}, {}
    keys = label * len(titles) + group
    _, first = np.unique(keys, return_index=True)
    for number, start in enumerate(sorted(first), start=1):
        faces[number] = facets.at(np.flatnonzero(keys == keys[start]))
        if group[start]:
            names[number] = titles[group[start]]
    return faces, names


def _groups(raw: Any, facets: Facets, new_numbers: IntArray) -> list[Group]:
    """Name of each group of a mesh file, and for each of the `facets` True if it is in the group.

    Groups are physical groups of surface elements (gmsh), and node sets. A group that contains all
    facets is omitted. `raw` is the mesh as read by meshio. `new_numbers` contains, for each node of
    `raw`, its number in `facets`. It is −1 for nodes that no solid element uses.
    """
    corners = np.sort(facets.corners, axis=1)
    rows = {tuple(row): i for i, row in enumerate(corners.tolist())}
    groups: list[Group] = []
    titles = {int(v[0]): name for name, v in raw.field_data.items() if int(v[1]) == 2}
    tags = raw.cell_data.get("gmsh:physical", [])
    for tag, title in titles.items():
        inside = np.zeros(len(corners), dtype=bool)
        for block, physical in zip(raw.cells, tags, strict=False):
            if not block.type.startswith(("triangle", "quad")):
                continue
            facet_nodes = np.sort(
                new_numbers[block.data[physical == tag][:, : corners.shape[1]]], axis=1
            )
            inside[[rows[row] for row in map(tuple, facet_nodes.tolist()) if row in rows]] = True
        groups.append((title, inside))
    for title, members in raw.point_sets.items():
        in_set = np.zeros(len(new_numbers), dtype=bool)
        in_set[np.asarray(members, dtype=np.int64)] = True
        nodes = np.zeros(int(new_numbers.max()) + 1, dtype=bool)
        nodes[new_numbers[in_set & (new_numbers >= 0)]] = True
        groups.append((str(title), np.asarray(nodes[corners].all(axis=1))))
    return [(title, inside) for title, inside in groups if not inside.all()]
