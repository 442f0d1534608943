"""Pictures of a CAD part's numbered faces: from two sides, and as a scene that can be turned.

Input: a `PartFile`. Output: a PNG and an HTML page. Rule: each number stands on a facet of its face
that is visible to the viewer. Faces that are visible from neither side, such as those of a cavity,
are listed below the picture and appear in the turnable scene.
"""

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.textpath import TextPath

from lumped.arrays import Array
from meshes.part.boundary import area_vectors
from meshes.part.faces import Face
from meshes.part.reading.read import PartFile
from validation.drawing.opengl import MESSAGE, can_draw
from validation.drawing.rendering import Picture, panel_size, pictured
from validation.drawing.scene import DrawnBody, Label, Scene, View, Wire
from validation.drawing.surfaces import Surface
from validation.drawing.turnable import page

# Light colours on which black numbers are legible. Faces with consecutive numbers differ.
_COLOURS = ("#9ecae1", "#fdd0a2", "#a1d99b", "#dadaeb", "#fee391", "#c7c7c7", "#f4b6c2", "#8dd3c7")
_UP = np.array([0.0, 0.0, 1.0])
# Directions towards the viewer.
_SIDES = (np.array([0.75, -1.0, 0.6]), np.array([-0.75, 1.0, -0.6]))
_HEIGHT = 3.6  # inches
# Height of digits in the scene relative to the size of the part.
_DIGIT_HEIGHT = 0.045
# Largest number of facets whose visibility is tested before a face counts as hidden.
_TESTED_FACETS = 60
_CLEARANCE = 26.0  # pixels between numbers
_TITLE = "Faces of {}"
_NO_EDGES = np.zeros((0, 2), dtype=np.int64)


def picture(part: PartFile) -> Picture:
    """Picture of the part from two opposite sides, with coloured and numbered faces."""
    if not can_draw():
        return Picture(left_out=MESSAGE)
    hidden = {face.number for face in part.faces}
    surface = _poly_data(part)
    scenes = []
    for toward in _SIDES:
        scene = Scene(_bodies(part), (toward, _UP))
        view = scene.view(panel_size(2, _HEIGHT))
        labels: list[Label] = []
        for face in part.faces:
            visible = _visible_points(part, face, view, surface)
            if len(visible):
                hidden.discard(face.number)
                point = _label_point(visible, [label.point for label in labels], view)
                labels.append(Label(str(face.number), point, movable=False))
        scenes.append(replace(scene, labels=labels))
    hidden_numbers = ", ".join(map(str, sorted(hidden)))
    title = _TITLE.format(part.path.name) + f", {part.size}"
    title += f"\nhidden from both sides: {hidden_numbers}" if hidden_numbers else ""
    return pictured(scenes, 2, _HEIGHT, title=title)


def scene_page(part: PartFile) -> str:
    """HTML page with a scene of the part and its face numbers. The user can turn the scene.

    The page opens offline.
    """
    numbers = [_number(part, face) for face in part.faces]
    scene = Scene(_bodies(part), (_SIDES[0], _UP), title=part.path.name, turned=numbers)
    return page(scene, _TITLE.format(part.path.name))


def _bodies(part: PartFile) -> list[DrawnBody]:
    bodies = []
    for face in part.faces:
        corners = face.facets.corners[:, [0, 1, 2, -1]]
        nodes, indices = np.unique(corners, return_inverse=True)
        surface = Surface(part.surface[nodes], indices.reshape(corners.shape), _NO_EDGES)
        bodies.append(DrawnBody(surface, _COLOURS[face.number % len(_COLOURS)]))
    return bodies


def _poly_data(part: PartFile) -> Any:
    import pyvista  # noqa: PLC0415  VTK must not be loaded on a machine that cannot draw

    corners = np.concatenate([face.facets.corners for face in part.faces])
    return pyvista.PolyData.from_regular_faces(part.surface, corners).triangulate()


def _facets(part: PartFile, face: Face) -> tuple[Array, Array]:
    """Centres (F×3, m) and unit normals (F×3) of a face's facets, closest to its centre first."""
    vectors = area_vectors(part.surface, face.facets)
    centres = part.surface[face.facets.corners].mean(axis=1)
    order = np.argsort(np.linalg.norm(centres - face.centre, axis=1), kind="stable")
    areas = np.maximum(np.linalg.norm(vectors, axis=1), np.finfo(float).tiny)
    return centres[order], (vectors / areas[:, None])[order]


def _visible_points(part: PartFile, face: Face, view: View, surface: Any) -> Array:
    """Points (n×3, m) on a face that are visible to the viewer, closest to its centre first."""
    centres, normals = _facets(part, face)
    facing = np.flatnonzero(normals @ view.toward > 0.15)
    step = max(1, len(facing) // _TESTED_FACETS)
    size = max(part.extent)
    starts = centres[facing[::step]] + 1e-4 * size * view.toward
    ends = starts + 4.0 * size * view.toward
    visible = [
        not len(surface.ray_trace(start, end)[0]) for start, end in zip(starts, ends, strict=True)
    ]
    return np.asarray(starts[visible])


def _label_point(points: Array, labelled: list[Array], view: View) -> Array:
    """First of `points` at which a face number covers no point of `labelled`.

    If there is none, the point farthest from the labelled ones.
    """
    if not labelled:
        return np.asarray(points[0])
    distances = np.abs(view.pixels(points)[:, None] - view.pixels(np.array(labelled)))
    # Numbers are wider than high.
    clearance = np.maximum(distances[..., 0] / 1.4, distances[..., 1]).min(axis=1)
    clear = np.flatnonzero(clearance > _CLEARANCE)
    return np.asarray(points[clear[0] if clear.size else int(np.argmax(clearance))])


def _number(part: PartFile, face: Face) -> Wire:
    """Outlines of the digits of a face's number, slightly above its centre along the normal."""
    centres, normals = _facets(part, face)
    size = _DIGIT_HEIGHT * max(part.extent)
    path = TextPath((0.0, 0.0), str(face.number), size=1.0)
    polygons = [np.asarray(polygon) for polygon in path.to_polygons()]
    offsets = np.cumsum([0, *(len(polygon) for polygon in polygons)])
    in_plane = size * np.vstack(polygons)
    in_plane -= 0.5 * (in_plane.min(axis=0) + in_plane.max(axis=0))
    normal = normals[0]
    right = np.cross([0.0, 0.0, 1.0] if abs(normal[2]) < 0.9 else [0.0, 1.0, 0.0], normal)
    right = right / np.linalg.norm(right)
    plane_axes = np.array([right, np.cross(normal, right)])
    points = centres[0] + 0.15 * size * normal + in_plane @ plane_axes
    pairs = [np.arange(start, end - 1)[:, None] + [0, 1] for start, end in pairwise(offsets)]
    return Wire(points, np.vstack(pairs), "#000000", 2.5)
