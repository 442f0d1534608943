"""The faces of a part drawn and numbered: a picture from two sides, and a scene to turn.

A number stands on a piece of its face that is seen from where the picture is taken; faces that are
seen from neither side, those of a cavity, are named below it and shown in the scene.
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

# Light, so that black numbers are read on all of them; neighbours in number differ.
_COLOURS = ("#9ecae1", "#fdd0a2", "#a1d99b", "#dadaeb", "#fee391", "#c7c7c7", "#f4b6c2", "#8dd3c7")
_UP = np.array([0.0, 0.0, 1.0])
_SIDES = (np.array([0.75, -1.0, 0.6]), np.array([-0.75, 1.0, -0.6]))
_HEIGHT = 3.6
# Letters of the scene, as a share of the part's size; pieces tried before a face counts as hidden.
_LETTER, _TRIES = 0.045, 60
_CLEAR = 26.0  # pixels between numbers
_TITLE = "Faces of {}"
_NO_EDGES = np.zeros((0, 2), dtype=np.int64)


def picture(part: PartFile) -> Picture:
    """The part from two opposite sides, its faces in colours and numbered."""
    if not can_draw():
        return Picture(left_out=MESSAGE)
    hidden = {face.number for face in part.faces}
    whole = _poly_data(part)
    scenes = []
    for toward in _SIDES:
        scene = Scene(_bodies(part), (toward, _UP))
        view = scene.view(panel_size(2, _HEIGHT))
        labels: list[Label] = []
        for face in part.faces:
            seen = _seen(part, face, view, whole)
            if len(seen):
                hidden.discard(face.number)
                place = _apart(seen, [one.place for one in labels], view)
                labels.append(Label(str(face.number), place, beside=False))
        scenes.append(replace(scene, labels=labels))
    unseen = ", ".join(map(str, sorted(hidden)))
    title = _TITLE.format(part.path.name) + f", {part.size}"
    title += f"\nseen from neither side: {unseen}" if unseen else ""
    return pictured(scenes, 2, _HEIGHT, title=title)


def scene_page(part: PartFile) -> str:
    """A page of its own, offline in any browser: the part with numbers on its faces, to turn."""
    letters = [_number(part, face) for face in part.faces]
    scene = Scene(_bodies(part), (_SIDES[0], _UP), title=part.path.name, turned=letters)
    return page(scene, _TITLE.format(part.path.name))


def _bodies(part: PartFile) -> list[DrawnBody]:
    found = []
    for face in part.faces:
        corners = face.facets.corners[:, [0, 1, 2, -1]]
        nodes, places = np.unique(corners, return_inverse=True)
        own = Surface(part.surface[nodes], places.reshape(corners.shape), _NO_EDGES)
        found.append(DrawnBody(own, _COLOURS[face.number % len(_COLOURS)]))
    return found


def _poly_data(part: PartFile) -> Any:
    import pyvista  # noqa: PLC0415  VTK must not be loaded where it cannot draw

    corners = np.concatenate([face.facets.corners for face in part.faces])
    return pyvista.PolyData.from_regular_faces(part.surface, corners).triangulate()


def _pieces(part: PartFile, face: Face) -> tuple[Array, Array]:
    """Centres (F×3) and unit normals (F×3) of a face's pieces, the nearest to its middle first."""
    vectors = area_vectors(part.surface, face.facets)
    centres = part.surface[face.facets.corners].mean(axis=1)
    order = np.argsort(np.linalg.norm(centres - face.centre, axis=1), kind="stable")
    areas = np.maximum(np.linalg.norm(vectors, axis=1), np.finfo(float).tiny)
    return centres[order], (vectors / areas[:, None])[order]


def _seen(part: PartFile, face: Face, view: View, whole: Any) -> Array:
    """Places (n×3) on the face that nothing hides from the viewer, nearest its middle first."""
    centres, normals = _pieces(part, face)
    facing = np.flatnonzero(normals @ view.toward > 0.15)
    step = max(1, len(facing) // _TRIES)
    size = max(part.extent)
    starts = centres[facing[::step]] + 1e-4 * size * view.toward
    ends = starts + 4.0 * size * view.toward
    free = [not len(whole.ray_trace(a, b)[0]) for a, b in zip(starts, ends, strict=True)]
    return np.asarray(starts[free])


def _apart(places: Array, taken: list[Array], view: View) -> Array:
    """The first of `places` whose number covers none of those `taken`; the farthest if all do."""
    if not taken:
        return np.asarray(places[0])
    away = np.abs(view.pixels(places)[:, None] - view.pixels(np.array(taken)))
    # Wider than high, as numbers are.
    clearance = np.maximum(away[..., 0] / 1.4, away[..., 1]).min(axis=1)
    free = np.flatnonzero(clearance > _CLEAR)
    return np.asarray(places[free[0] if free.size else int(np.argmax(clearance))])


def _number(part: PartFile, face: Face) -> Wire:
    """The number of a face as outlines of its digits just off its middle, along its normal."""
    centres, normals = _pieces(part, face)
    size = _LETTER * max(part.extent)
    path = TextPath((0.0, 0.0), str(face.number), size=1.0)
    digits = [np.asarray(one) for one in path.to_polygons()]
    count = np.cumsum([0, *(len(one) for one in digits)])
    flat = size * np.vstack(digits)
    flat -= 0.5 * (flat.min(axis=0) + flat.max(axis=0))
    normal = normals[0]
    across = np.cross([0.0, 0.0, 1.0] if abs(normal[2]) < 0.9 else [0.0, 1.0, 0.0], normal)
    across = across / np.linalg.norm(across)
    points = centres[0] + 0.15 * size * normal + flat @ np.array([across, np.cross(normal, across)])
    pairs = [np.arange(a, b - 1)[:, None] + [0, 1] for a, b in pairwise(count)]
    return Wire(points, np.vstack(pairs), "#000000", 2.5)
