"""From gmsh's tags to arrays: connectivity in our local node order, nodes numbered from zero."""

from types import ModuleType

import numpy as np

from lumped.arrays import Array, IntArray
from meshes.elements import ElementName

_GMSH_TYPE: dict[ElementName, int] = {
    "tri3": 2,
    "quad4": 3,
    "tet4": 4,
    "tri6": 9,
    "quad9": 10,
    "tet10": 11,
}
# gmsh lists the edges (2,3) and (1,3) of a tetrahedron the other way round.
_GMSH_TET10 = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]


def connectivity(gmsh: ModuleType, element: ElementName, entity: int = -1) -> IntArray:
    """Node tags (M×k) of all elements of one kind, of one `entity` or of the whole model."""
    kind = _GMSH_TYPE[element]
    _, tags = gmsh.model.mesh.getElementsByType(kind, entity)
    _, _, _, count, _, _ = gmsh.model.mesh.getElementProperties(kind)
    cells = np.asarray(tags, dtype=np.int64).reshape(-1, count)
    return cells[:, _GMSH_TET10] if element == "tet10" else cells


def numbered(gmsh: ModuleType, cells: IntArray) -> tuple[IntArray, Array]:
    """The node tags that `cells` use, ascending, and their coordinates (N×3).

    The position of a tag in the first array is the node's number in the second.
    """
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(tags)
    used = np.unique(cells)
    places = order[np.searchsorted(tags[order], used)]
    return used, np.asarray(coordinates).reshape(-1, 3)[places]
