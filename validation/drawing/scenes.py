"""3-D scenes that can be turned: what trame exports, one compact and reproducible file each.

trame's serializer turns VTK's objects into the state of vtk.js; no OpenGL and no server is needed
for that, so that scenes exist where pictures cannot be drawn.
"""

import gzip
import io
import json
import re
import zipfile
from collections.abc import Sequence
from importlib import import_module
from importlib.resources import files
from typing import Any, Literal, TypeAlias

import numpy as np

from lumped.arrays import Array
from validation.drawing.rendering import Body, Scene, Wire, add_to
from validation.drawing.text import base64
from validation.exhibits import InteractiveScene

_ADDRESS = re.compile(r"(?<=[\"{])[0-9a-f]{16}(?=[\"}-])")
# The earliest date that a ZIP archive can carry.
_NO_DATE = (1980, 1, 1, 0, 0, 0)
# The viewer asks this place for an icon of its own; the report asks no network for anything.
_ICONS = b"https://kitware.github.io/vtk-js/icon/"
# It tells the console what it reads; the page wants to know it instead, to set modes in motion.
_TELLS, _KEEPS = b"console.log(Object.keys(s))", b"global.scene=s"

# How what is displaced moves: a mode swings to both sides, a load pushes to one and lets go.
Motion: TypeAlias = Literal["swing", "push"]


def interactive(
    title: str, scene: Scene, overlay: Sequence[Body | Wire] = (), motion: Motion = "swing"
) -> InteractiveScene:
    """The scene with what is drawn over it (m), as vtk.js reads it; the camera starts as its view.

    Equal scenes give equal bytes.
    """
    import pyvista  # noqa: PLC0415  VTK takes seconds to load

    plotter = pyvista.Plotter(off_screen=True)
    try:
        plotter.background_color = pyvista.Color("white")
        add_to(plotter, scene, overlay)
        plotter.camera.parallel_projection = False
        _place_camera(plotter, scene)
        state = _state(plotter.render_window) | {"motion": _motion(scene, overlay, motion)}
    finally:
        plotter.close()
    return InteractiveScene(title, _archive(_with_plain_names(json.dumps(state))))


def packed_viewer() -> str:
    """The page of vtk.js that shows scenes, gzip in base64, once for all of them.

    A browser unpacks it when the first scene is opened.
    """
    page = files("trame_vtk.tools").joinpath("static_viewer.html").read_bytes()
    page = page.replace(_ICONS, b"data:,").replace(_TELLS, _KEEPS)
    return base64(gzip.compress(page, compresslevel=9, mtime=0))


def _place_camera(plotter: Any, scene: Scene) -> None:
    """A perspective view of what the parallel projection shows."""
    view, camera = scene.view, plotter.camera
    camera.view_angle = 30.0
    camera.focal_point = view.centre
    # Perspective enlarges what is near: a little farther off, nothing is cut at the edges.
    distance = 1.2 * view.half_height / np.tan(np.radians(15.0))
    camera.position = view.centre + distance * view.toward
    camera.up = view.up
    plotter.reset_camera_clipping_range()


def _state(window: Any) -> dict[str, Any]:
    serializers = import_module("trame_vtk.modules.vtk.serializers")  # loads VTK
    serializers.initialize_serializers()
    context = serializers.SynchronizationContext()
    context.set_ignore_last_dependencies(True)
    state = serializers.serialize(None, window, serializers.reference_id(window), context, 1)
    camera = window.GetRenderers().GetFirstRenderer().GetActiveCamera()
    state["extra"] = {
        "vtkRefId": serializers.reference_id(window),
        "centerOfRotation": camera.GetFocalPoint(),
        "camera": serializers.reference_id(camera),
    }
    hashes = {
        entry["hash"]: entry
        | {"content": context.get_cached_data_array(entry["hash"], binary=False)}
        for entry in serializers.extract_array_hash(state)
    }
    return {"hashes": hashes, "scene": state}


def _motion(scene: Scene, overlay: Sequence[Body | Wire], kind: Motion) -> dict[str, Any]:
    """How the points of each part are displaced, in the order in which the parts were added."""
    surfaces = [body.surface for body in scene.bodies]
    added = [part.surface if isinstance(part, Body) else part for part in overlay]
    parts = (*surfaces, *scene.wires, *added)
    return {"kind": kind, "parts": [_packed(part.motion) for part in parts]}


def _packed(motion: Array | None) -> dict[str, Any] | None:
    """Displacements (n×3, m) as 16-bit multiples of a step: finer than a pixel, and small."""
    largest = 0.0 if motion is None else float(np.abs(motion).max())
    if motion is None or not largest > 0.0:
        return None
    step = largest / np.iinfo(np.int16).max
    values = np.round(motion / step).astype("<i2")
    return {"step": step, "values": base64(values.tobytes())}


def _with_plain_names(text: str) -> str:
    """The state with numbers in place of the addresses in memory that name VTK's objects."""
    names: dict[str, str] = {}
    return _ADDRESS.sub(lambda found: names.setdefault(found[0], f"{len(names) + 1:016x}"), text)


def _archive(text: str) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        archive.writestr(zipfile.ZipInfo("index.json", _NO_DATE), text, zipfile.ZIP_DEFLATED)
    return buffer.getvalue()
