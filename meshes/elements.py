"""Types of finite elements for sections and solids: node coordinates, node order in other programs.

Reference cells are the unit square, the unit cube and the unit simplices. Quadrilaterals and
simplices are numbered as in scikit-fem: corners counter-clockwise, then edge midpoints, then the
centre. The hexahedron of 27 nodes is the product of a quadrilateral and a line: its nodes are the
nine nodes of the quadrilateral at ζ = 0, then at ζ = ½, then at ζ = 1. In the hexahedron of 20
nodes, the corners come first, then the edge midpoints. In an extruded leg, ξ runs along y, η along
z (both in the section) and ζ along x, so that the axes (ξ, η, ζ) are right-handed.
"""

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from lumped.arrays import Array

SectionElement: TypeAlias = Literal["quad4", "quad8", "quad9", "tri3", "tri6"]
SolidElement: TypeAlias = Literal["hex8", "hex20", "hex27", "tet4", "tet10"]
ElementName: TypeAlias = SectionElement | SolidElement


@dataclass(frozen=True, eq=False)
class ElementKind:
    """One type of finite element.

    `order` is the polynomial order of its shape functions. `nodes` (k×d) are the reference
    coordinates of its k nodes in d dimensions, `corner_nodes` the local numbers of its vertices.
    `vtk_type` is the number of the cell type in VTK. `vtk_order` contains local node numbers in the
    order of VTK, so that `cells[:, vtk_order]` is VTK's connectivity. `abaqus` is the name of the
    element in Abaqus and CalculiX, which use the node order of this module. None if these programs
    do not have the element.
    """

    name: ElementName
    order: int
    nodes: Array
    corner_nodes: tuple[int, ...]
    vtk_type: int
    vtk_order: tuple[int, ...]
    abaqus: str | None = None

    @property
    def dimension(self) -> int:
        """Dimension of the elements: 2 for sections, 3 for solids."""
        return int(self.nodes.shape[1])

    @property
    def node_count(self) -> int:
        """Number k of nodes per element."""
        return int(self.nodes.shape[0])


# Corners at the ends of each edge of a triangle (3 corners) and a tetrahedron (4), in the order in
# which the edge midpoints are numbered.
SIMPLEX_EDGES = {
    3: np.array([(0, 1), (1, 2), (0, 2)]),
    4: np.array([(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]),
}


def _with_edges(corners: Array, edges: ArrayLike) -> Array:
    return np.vstack([corners, corners[np.asarray(edges)].mean(axis=1)])


def _times_line(face: Array, zetas: tuple[float, ...]) -> Array:
    return np.vstack([np.column_stack([face, np.full(len(face), zeta)]) for zeta in zetas])


def _same(count: int) -> tuple[int, ...]:
    return tuple(range(count))


_SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
_SQUARE_8 = _with_edges(_SQUARE, [(0, 1), (1, 2), (2, 3), (3, 0)])
_SQUARE_9 = np.vstack([_SQUARE_8, [[0.5, 0.5]]])
_TRIANGLE = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
_TRIANGLE_6 = _with_edges(_TRIANGLE, SIMPLEX_EDGES[3])
_TETRAHEDRON = np.vstack([np.zeros(3), np.eye(3)])
_TETRAHEDRON_10 = _with_edges(_TETRAHEDRON, SIMPLEX_EDGES[4])
_CUBE = _times_line(_SQUARE, (0.0, 1.0))
# Edges of the faces ζ = 0 and ζ = 1, then those along ζ: VTK's and Abaqus's order.
# fmt: off
_CUBE_20 = _with_edges(_CUBE, [
    (0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7),
])
# fmt: on
# VTK's triquadratic hexahedron: corners, edges of the faces ζ = 0 and ζ = 1, edges along ζ,
# centres of the faces ξ = 0, ξ = 1, η = 0, η = 1, ζ = 0, ζ = 1, centre.
# fmt: off
_VTK_HEX_27 = (
    0, 1, 2, 3, 18, 19, 20, 21,
    4, 5, 6, 7, 22, 23, 24, 25, 9, 10, 11, 12,
    16, 14, 13, 15, 8, 26, 17,
)
# fmt: on

quad4 = ElementKind("quad4", 1, _SQUARE, _same(4), 9, _same(4))
quad8 = ElementKind("quad8", 2, _SQUARE_8, _same(4), 23, _same(8))
quad9 = ElementKind("quad9", 2, _SQUARE_9, _same(4), 28, _same(9))
tri3 = ElementKind("tri3", 1, _TRIANGLE, _same(3), 5, _same(3))
tri6 = ElementKind("tri6", 2, _TRIANGLE_6, _same(3), 22, _same(6))
hex8 = ElementKind("hex8", 1, _CUBE, _same(8), 12, _same(8), "C3D8")
hex20 = ElementKind("hex20", 2, _CUBE_20, _same(8), 25, _same(20), "C3D20")
hex27 = ElementKind(
    "hex27",
    2,
    _times_line(_SQUARE_9, (0.0, 0.5, 1.0)),
    (0, 1, 2, 3, 18, 19, 20, 21),
    29,
    _VTK_HEX_27,
)
tet4 = ElementKind("tet4", 1, _TETRAHEDRON, _same(4), 10, _same(4), "C3D4")
tet10 = ElementKind("tet10", 2, _TETRAHEDRON_10, _same(4), 24, _same(10), "C3D10")

ELEMENTS: dict[str, ElementKind] = {
    kind.name: kind for kind in (quad4, quad8, quad9, tri3, tri6, hex8, hex20, hex27, tet4, tet10)
}
