"""Faces of a part, and their types: plane, bore, boss or other.

The types are recognised by fitting planes and cylinders. They are not read from the file, because
exporters write cylinders as splines, and a mesh file has no types.
"""

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from lumped.arrays import Array
from meshes.part.boundary import Facets, area_vectors

Kind: TypeAlias = Literal["plane", "bore", "boss", "other"]

# Largest deviation of a face's nodes from a plane, relative to its size, and from a cylinder,
# relative to its radius. Meshes are written with seven digits, some with six.
_FLAT, _ROUND = 1e-5, 1e-4
# Largest component of facet normals along the axis of a cylinder at the start of the fit. Normals
# of a cylinder are perpendicular to its axis, those of facets almost.
_ACROSS = 0.3


@dataclass(frozen=True, eq=False)
class Face:
    """A face of a part. Lengths are in m, vectors in the axes of the file.

    `centre` (3) is the centre of the area. For a plane, `direction` is the outward normal. A bore
    is a cylinder that surrounds a hole, a boss a cylinder that surrounds material. For both,
    `direction` is the axis, `on_axis` the point in the middle of the axis, and `radius` the radius.
    `radius` is zero for other faces, and `direction` is zero for faces of type "other". `name` is
    the name in the file, or "" if the file gives none. `facets` are the facets of the face, with
    indices of the nodes of the part's surface.
    """

    number: int
    kind: Kind
    area: float
    centre: Array
    direction: Array
    on_axis: Array
    radius: float
    name: str
    facets: Facets


def face_of(number: int, nodes: Array, facets: Facets, name: str = "") -> Face:
    """Face that consists of `facets` on `nodes` (N×3, in m), with its type."""
    vectors = area_vectors(nodes, facets)
    areas = np.linalg.norm(vectors, axis=1)
    area = float(areas.sum())
    centre = areas @ nodes[facets.cells].mean(axis=1) / area
    # Corner nodes lie on the true surface, even if the mesh file has straight edges.
    points = nodes[np.unique(facets.corners)]
    mean = vectors.sum(axis=0)
    normal = mean / max(float(np.linalg.norm(mean)), np.finfo(float).tiny)
    if np.abs((points - centre) @ normal).max() <= _FLAT * float(np.ptp(points, axis=0).max()):
        return Face(number, "plane", area, centre, _plain(normal), centre, 0.0, name, facets)
    fitted = _cylinder(points, vectors, areas)
    if fitted is None:
        zero = np.zeros(3)
        return Face(number, "other", area, centre, zero, centre, 0.0, name, facets)
    axis, on_axis, radius = fitted
    along = points @ axis
    # Half way along the axis.
    on_axis = on_axis + axis * ((along.min() + along.max()) / 2.0 - axis @ on_axis)
    outward = nodes[facets.cells].mean(axis=1) - on_axis
    kind: Kind = "bore" if np.einsum("ij,ij->", outward, vectors) < 0.0 else "boss"
    return Face(number, kind, area, centre, axis, on_axis, radius, name, facets)


def _plain(direction: Array) -> Array:
    """Direction (3) whose components below 1e-9 are set to zero.

    Components this small are round-off, which would be printed as -0 or 1e-17.
    """
    return np.asarray(np.where(np.abs(direction) < 1e-9, 0.0, direction))


def _cylinder(points: Array, vectors: Array, areas: Array) -> tuple[Array, Array, float] | None:
    """Axis (3), a point on it (3, in m) and radius (m) of the cylinder through `points`.

    None if they do not lie on a cylinder. `vectors` are the normals of facets times their `areas`
    (m²). The normals are perpendicular to the axis, which is therefore the direction of their
    smallest scatter. A circle about the axis is fitted to the points (Kåsa's linear fit, exact for
    points on a circle). Axis and circle are then improved together by Gauss–Newton iterations.
    """
    normals = vectors / areas[:, None]
    eigenvalues, directions = np.linalg.eigh((normals * areas[:, None]).T @ normals / areas.sum())
    if np.sqrt(eigenvalues[0]) > _ACROSS or eigenvalues[1] < _ACROSS**2:
        return None
    axis = directions[:, 0] * np.sign(directions[np.argmax(np.abs(directions[:, 0])), 0])
    centre = points.mean(axis=0)
    for _ in range(6):
        across = np.linalg.svd(axis[None])[2][1:]
        flat = (points - centre) @ across.T
        system = np.column_stack([2.0 * flat, np.ones(len(flat))])
        a, b, c = np.linalg.lstsq(system, (flat**2).sum(axis=1), rcond=None)[0]
        centre = centre + np.array([a, b]) @ across
        radius = float(np.sqrt(max(c + a * a + b * b, 0.0)))
        flat = flat - np.array([a, b])
        distance = np.linalg.norm(flat, axis=1)
        if radius == 0.0 or distance.min() == 0.0:
            return None
        deviation = distance - radius
        # A tilt of the axis changes the distance of a point at height h by h times the tilt.
        unit = flat / distance[:, None]
        height = (points - centre) @ axis
        slopes = np.column_stack([height[:, None] * unit, unit, np.ones(len(unit))])
        step = np.linalg.lstsq(slopes, deviation, rcond=1e-9)[0]
        axis = axis + step[:2] @ across
        axis = axis / np.linalg.norm(axis)
    if np.abs(deviation).max() > _ROUND * radius:
        return None
    return _plain(axis), centre, radius
