"""Quality of the elements of section and solid meshes, with limits beyond which a mesh is refused.

Scaled Jacobian: determinant of the unit vectors along the sides that meet in a point, 1 for a
square, a cube and regular simplices, at most 0 for an inverted cell (Knupp, SIAM J. Sci. Comput. 23
(2001) 193). The minimum over the nodes and quadrature points of an element is used, so that curved
sides are taken into account. Aspect ratio: longest over shortest distance of neighbouring vertices.
"""

from math import sqrt

import numpy as np

from lumped.arrays import Array
from lumped.errors import ComputationError
from meshes.elements import ELEMENTS, ElementName
from meshes.section.section_mesh import SectionMesh
from meshes.shape_functions import gradients, quadrature
from meshes.solid_mesh import VolumeMesh

# Smallest scaled Jacobian. Interpolation errors grow with its inverse: at 0.05 the error of a cell
# is twenty times that of a square cell, long before the matrices become ill-conditioned.
LEAST_SCALED_JACOBIAN = 0.05
# Largest aspect ratio. Slender cells are accurate if the solution varies slowly along them. Beyond
# 100 the ratio of stiffnesses, which grows with the square, costs four digits of the factorisation.
LARGEST_ASPECT = 100.0

_CELLS_AT_ONCE = 20_000
# Sides that meet in each corner of a simplex, as combinations of the reference directions.
_TRIANGLE_CORNERS = np.array([[[1, 0], [0, 1]], [[-1, 1], [-1, 0]], [[0, -1], [1, -1]]], float)
_TETRAHEDRON_CORNERS = np.array(
    [
        [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
        [[-1, 0, 0], [-1, 0, 1], [-1, 1, 0]],
        [[0, -1, 0], [1, -1, 0], [0, -1, 1]],
        [[0, 0, -1], [0, 1, -1], [1, 0, -1]],
    ],
    float,
)


def quality(mesh: SectionMesh | VolumeMesh) -> tuple[Array, Array]:
    """Scaled Jacobian (M) and aspect ratio (M) of each of the M elements."""
    points, _ = quadrature(mesh.element, 2 * ELEMENTS[mesh.element].order)
    samples = np.hstack([ELEMENTS[mesh.element].nodes.T, points])
    slopes = gradients(mesh.element, samples)
    blocks = [
        mesh.nodes[mesh.cells[first : first + _CELLS_AT_ONCE]]
        for first in range(0, len(mesh.cells), _CELLS_AT_ONCE)
    ]
    return (
        np.concatenate([_scaled_jacobian(mesh.element, block, slopes) for block in blocks]),
        np.concatenate([_aspect(mesh.element, block) for block in blocks]),
    )


def check(mesh: SectionMesh | VolumeMesh, part: str) -> None:
    """Raise ComputationError if elements are too distorted. Its message contains `part`."""
    jacobians, aspects = quality(mesh)
    worst, longest = jacobians.min(), aspects.max()
    if worst < LEAST_SCALED_JACOBIAN:
        raise ComputationError(
            f"the mesh has {mesh.element} elements of scaled Jacobian {worst:.2g}, below "
            f"{LEAST_SCALED_JACOBIAN:g}: distorted or inverted; more divisions help on curved "
            "walls",
            part=part,
        )
    if longest > LARGEST_ASPECT:
        raise ComputationError(
            f"the mesh has {mesh.element} elements {longest:.3g} times as long as wide, "
            f"above {LARGEST_ASPECT:g}: take more slices or divisions, or fewer across the wall",
            part=part,
        )


def _scaled_jacobian(element: ElementName, corners: Array, slopes: Array) -> Array:
    """Smallest scaled Jacobian (M) of each element.

    `corners` (M×k×d, in m) are the positions of all k nodes of the elements, `slopes` (k×d×Q) the
    gradients of the shape functions at Q reference points.
    """
    count, dimension, points = slopes.shape
    jacobian = np.swapaxes(corners, 1, 2) @ slopes.reshape(count, dimension * points)
    jacobian = jacobian.reshape(-1, dimension, dimension, points)
    directions, regular = _corner_sides(element)
    sides = np.einsum("mijq,csj->mqcsi", jacobian, directions, optimize=True)
    largest = np.linalg.norm(sides, axis=-1).prod(axis=-1).max(axis=-1)
    determinant = np.linalg.det(np.moveaxis(jacobian, -1, 1))
    return np.asarray((regular * determinant / largest).min(axis=1))


def _corner_sides(element: ElementName) -> tuple[Array, float]:
    if element.startswith("tri"):
        return _TRIANGLE_CORNERS, 2.0 / sqrt(3.0)
    if element.startswith("tet"):
        return _TETRAHEDRON_CORNERS, sqrt(2.0)
    return np.eye(ELEMENTS[element].dimension)[None], 1.0


def _aspect(element: ElementName, nodes: Array) -> Array:
    kind = ELEMENTS[element]
    vertices = list(kind.corner_nodes)
    reference = kind.nodes[vertices]
    steps = np.abs(reference[:, None] - reference[None]).sum(axis=2)
    # In a simplex all vertices are neighbours. In squares and cubes, neighbours differ in one
    # reference coordinate.
    reach = 2 if element.startswith("t") else 1
    first, second = np.nonzero(np.triu((steps > 0) & (steps <= reach)))
    corners = nodes[:, vertices]
    lengths = np.linalg.norm(corners[:, first] - corners[:, second], axis=2)
    return np.asarray(lengths.max(axis=1) / lengths.min(axis=1))
