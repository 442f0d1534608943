"""Faces of a part: what kind they are, by fitting planes and cylinders to them.

Fitted, not asked of the file: exporters write cylinders as splines, and a mesh has no kinds.
"""

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from lumped.arrays import Array
from meshes.part.boundary import Facets, area_vectors

Kind: TypeAlias = Literal["plane", "bore", "boss", "other"]

# Deviation of a face's nodes from a plane, as a share of its size, and from a cylinder, as a share
# of its radius, up to which it is one; meshes are written with seven digits, some with six.
_FLAT, _ROUND = 1e-5, 1e-4
# Normals of a cylinder lie across its axis, those of its facets nearly so: the start of the fit.
_ACROSS = 0.3


@dataclass(frozen=True, eq=False)
class Face:
    """A face of a part, lengths in m, the file's axes.

    `centre` (3) of its area. A plane's `direction` is its outward normal; that of a bore or a boss
    (a cylinder seen from inside or outside) its axis, through `centre` shifted onto it, `on_axis`.
    `name`: what the file calls it, if anything. `facets`: its pieces, on the surface's nodes.
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
    """The face that `facets` (on `nodes`, N×3, m) make up, recognised."""
    vectors = area_vectors(nodes, facets)
    areas = np.linalg.norm(vectors, axis=1)
    area = float(areas.sum())
    centre = areas @ nodes[facets.cells].mean(axis=1) / area
    # Corners lie on the true surface even where an exporter left the edges straight.
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
    """Without the rounding that would print as -0 or 1e-17."""
    return np.asarray(np.where(np.abs(direction) < 1e-9, 0.0, direction))


def _cylinder(points: Array, vectors: Array, areas: Array) -> tuple[Array, Array, float] | None:
    """Axis (3), a point on it (3) and radius of the cylinder through `points`; None if none is.

    The normals lie across the axis: it is the direction in which they spread least. The points
    are then fitted by a circle about it (Kåsa's linear fit, exact for points on a circle), and axis
    and circle improved together by Gauss and Newton.
    """
    normals = vectors / areas[:, None]
    spread, directions = np.linalg.eigh((normals * areas[:, None]).T @ normals / areas.sum())
    if np.sqrt(spread[0]) > _ACROSS or spread[1] < _ACROSS**2:
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
        # A tilt of the axis moves a point at height h across it by h times the tilt.
        unit = flat / distance[:, None]
        height = (points - centre) @ axis
        slopes = np.column_stack([height[:, None] * unit, unit, np.ones(len(unit))])
        step = np.linalg.lstsq(slopes, deviation, rcond=1e-9)[0]
        axis = axis + step[:2] @ across
        axis = axis / np.linalg.norm(axis)
    if np.abs(deviation).max() > _ROUND * radius:
        return None
    return _plain(axis), centre, radius
