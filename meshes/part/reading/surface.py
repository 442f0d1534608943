"""Triangles on the faces of a CAD model, and integrals over quadratic triangles."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

import numpy as np

from lumped.arrays import Array, IntArray
from meshes.elements import SIMPLEX_EDGES
from meshes.gmsh_session import connectivity, numbered
from meshes.part.boundary import Facets
from meshes.part.enclosed import (
    FaceArea,
    VolumeProperties,
    corrected,
    corrected_area,
    enclosed,
    face_area,
)
from meshes.part.reading.cad import CadModel, NotMeshedError, locating_mesh_failures

# Number in gmsh of the element type for a piece of a curve.
_LINE = 1
# Largest distance between the middles of an edge and of its chord, relative to the chord. It is
# 0.13 on arcs of 60°.
_NEAR = 0.3
# Number of points along a curve at which its extreme coordinates are searched.
_SAMPLES = 201
_NOWHERE = np.full(3, np.nan)
# Number of elements along the part in the surface mesh on which faces are recognised.
_PIECES = 25.0
# Shortest element edge relative to the part's size. At the tip of a cone the curvature is
# unbounded, and so would be the number of triangles.
_SHORTEST = 1e-3


@dataclass(frozen=True, eq=False)
class SurfaceIntegrals:
    """Integrals over the surface of a solid.

    `inside` are volume properties of the solid, `areas` the areas of the faces by face number.
    `extent` (3, in m) is the size of the bounding box.
    """

    inside: VolumeProperties
    areas: dict[int, FaceArea]
    extent: Array


def triangulate(
    path: Path, model: CadModel, sides: float, coarseness: float = 1.0
) -> dict[int, IntArray]:
    """Triangles of a mesh of the surface (F×3 node tags), by face, oriented like the face.

    `sides` is the number of element sides per full circle. Zero if element sizes do not follow the
    curvature. `coarseness` is a factor on all element sizes. Raises NotMeshedError, with the
    position of the fault, if the surface cannot be meshed.
    """
    gmsh = model.gmsh
    gmsh.model.mesh.clear()
    size = coarseness * max(model.extent)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size / _PIECES)
    gmsh.option.setNumber("Mesh.MeshSizeMin", _SHORTEST * size)
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", sides / coarseness)
    with locating_mesh_failures(path, model):
        gmsh.model.mesh.generate(2)
    triangles = {tag: connectivity(gmsh, "tri3", tag) for tag in model.faces()}
    empty_faces = [tag for tag, cells in triangles.items() if not len(cells)]
    if empty_faces:
        raise NotMeshedError(
            f"{path}: face {empty_faces[0]} cannot be meshed: the face has no area or no outline; "
            "repair it in the CAD system"
        )
    return triangles


def surface_integrals(model: CadModel, triangles: Mapping[int, IntArray]) -> SurfaceIntegrals:
    """Integrals over quadratic triangles on the surface of the model.

    Their corners are the nodes of `triangles` (F×3 node tags, by face number), and their edge
    midpoints lie on the surface.
    """
    gmsh = model.gmsh
    tags, corners = numbered(gmsh, np.concatenate(list(triangles.values())))
    middles = _middles_on_curves(gmsh)
    facets: dict[int, Facets] = {}
    middle_nodes: list[Array] = []
    count = len(corners)
    for face, cells in triangles.items():
        pairs = np.sort(cells[:, SIMPLEX_EDGES[3]].reshape(-1, 2), axis=1)
        edges, edge_numbers = np.unique(pairs, axis=0, return_inverse=True)
        edge_middles = np.array([middles.get((a, b), _NOWHERE) for a, b in edges.tolist()])
        inside = np.isnan(edge_middles[:, 0])
        edge_middles[inside] = _middles_inside(gmsh, face, edges[inside])
        rows = count + edge_numbers.reshape(-1, 3)
        facets[face] = Facets(np.hstack([np.searchsorted(tags, cells), rows]), "tri6")
        middle_nodes.append(edge_middles)
        count += len(edge_middles)
    nodes = np.concatenate([corners, *middle_nodes])
    return SurfaceIntegrals(
        enclosed(nodes, list(facets.values())),
        {face: face_area(nodes, of_face) for face, of_face in facets.items()},
        np.ptp(np.concatenate([nodes, _curve_extremes(gmsh)]), axis=0),
    )


def _middles_on_curves(gmsh: ModuleType) -> dict[tuple[int, int], Array]:
    """Points (3, in m) half way along each piece of a curve, by the node tags of its two ends."""
    middles: dict[tuple[int, int], Array] = {}
    for _, curve in gmsh.model.getEntities(1):
        _, ends = gmsh.model.mesh.getElementsByType(_LINE, curve)
        tags, _, parameters = gmsh.model.mesh.getNodes(
            1, curve, includeBoundary=True, returnParametricCoord=True
        )
        if not len(ends):
            continue
        by_tag = dict(zip(tags.tolist(), parameters.tolist(), strict=True))
        pieces = ends.reshape(-1, 2).tolist()
        parameters_of_ends = np.array([[by_tag[tag] for tag in piece] for piece in pieces])
        (low,), (high,) = gmsh.model.getParametrizationBounds(1, curve)
        # The first point of a closed curve is also the last one.
        step = np.diff(parameters_of_ends, axis=1)[:, 0]
        if pieces[0][0] == pieces[-1][1] and len(pieces) > 1:
            parameters_of_ends[-1, 1] = high if step[0] > 0.0 else low
        points = gmsh.model.getValue(1, curve, parameters_of_ends.mean(axis=1))
        for piece, point in zip(pieces, np.reshape(points, (-1, 3)), strict=True):
            middles[min(piece), max(piece)] = point
    return middles


def _middles_inside(gmsh: ModuleType, face: int, edges: IntArray) -> Array:
    """Points (E×3, in m) on a face half way between the nodes of `edges` (E×2 node tags)."""
    tags, coordinates, parameters = gmsh.model.mesh.getNodes(
        2, face, includeBoundary=True, returnParametricCoord=True
    )
    order = np.argsort(tags)
    rows = order[np.searchsorted(tags[order], edges)]
    chords = np.asarray(coordinates, dtype=float).reshape(-1, 3)[rows]
    middles: Array = chords.mean(axis=1)
    lengths = np.linalg.norm(np.diff(chords, axis=1)[:, 0], axis=1)
    if not len(edges):
        return middles
    halfway = parameters.reshape(-1, 2)[rows].mean(axis=1)
    points: Array = np.array(gmsh.model.getValue(2, face, halfway.ravel())).reshape(-1, 3)
    # A node on a seam or at a pole has several parameters.
    far = np.linalg.norm(points - middles, axis=1) > _NEAR * lengths
    if far.any():
        nearest, _ = gmsh.model.getClosestPoint(2, face, middles[far].ravel())
        points[far] = np.reshape(nearest, (-1, 3))
    return points


def _curve_extremes(gmsh: ModuleType) -> Array:
    """Largest and smallest coordinates (2×3, in m) of the curves of the model.

    Each extreme is searched among many points on a curve. A parabola through the most extreme point
    and its two neighbours then gives the value, if its vertex lies on the curve.
    """
    extremes = []
    for _, curve in gmsh.model.getEntities(1):
        (low,), (high,) = gmsh.model.getParametrizationBounds(1, curve)
        parameter_samples = np.linspace(low, high, _SAMPLES)
        points = np.reshape(gmsh.model.getValue(1, curve, parameter_samples), (-1, 3))
        for sign in (1.0, -1.0):
            heights = sign * points
            row = heights.argmax(axis=0).clip(1, _SAMPLES - 2)
            previous, top, following = (heights[row + step, range(3)] for step in (-1, 0, 1))
            curvature = 2.0 * top - previous - following
            rise = np.divide(
                (previous - following) ** 2, 8.0 * curvature, np.zeros(3), where=curvature > 0.0
            )
            # At an end of the curve the vertex of the parabola lies beyond it.
            inside = np.abs(previous - following) <= 2.0 * curvature
            extremes.append(sign * np.where(inside, top + rise, heights.max(axis=0)))
    return np.array([np.max(extremes, axis=0), np.min(extremes, axis=0)])


def corrected_integrals(
    model: CadModel, triangles: Mapping[int, IntArray], coarse: SurfaceIntegrals | None
) -> SurfaceIntegrals:
    """Integrals by the CAD kernel, or over two surface meshes if these contradict the kernel.

    The volume and each area are examined separately. `coarse` are integrals over triangles larger
    than `triangles` by the factor COARSENESS. None if the integrals of the kernel are exact. If
    `coarse` is given, the extent of the result is that of the surface mesh, because the kernel's
    bounding boxes of splines are too large.
    """
    areas = {tag: model.area(tag) for tag in model.faces()}
    kernel = SurfaceIntegrals(model.properties(), areas, np.array(model.extent))
    if coarse is None:
        return kernel
    fine = surface_integrals(model, triangles)
    return SurfaceIntegrals(
        corrected(kernel.inside, coarse.inside, fine.inside),
        {
            tag: corrected_area(kernel_area, coarse.areas[tag], fine.areas[tag])
            for tag, kernel_area in kernel.areas.items()
        },
        fine.extent,
    )
