"""Encoding of scenes for a browser, in which `viewer.js` draws and turns them.

Input: a `Scene`. Output: compressed bytes, or an HTML page. Equal scenes give equal bytes. Neither
OpenGL nor VTK is needed, so these scenes also exist on machines that cannot draw pictures.
"""

import gzip
import json
from importlib.resources import files
from typing import Any

import numpy as np
from markupsafe import escape

from lumped.arrays import Array
from validation.drawing.scene import DrawnBody, Scene, Wire
from validation.drawing.style import COLOUR_MAP
from validation.drawing.text import base64
from validation.studies_and_figures import InteractiveScene

# Size (pixels) of the first view.
_SIZE = (400, 300)


def turnable(scene: Scene) -> InteractiveScene:
    """Encoded scene for the browser, including the bodies and lines in `Scene.turned`.

    The first view is that of the scene's camera. The data are compressed: a JSON header, followed
    by the numbers to which the header refers.
    """
    view, numbers = scene.view(_SIZE), _Numbers()
    header = {
        "title": scene.title,
        "motion": scene.motion,
        "camera": {
            "axes": [axis.tolist() for axis in (view.right, view.up, view.toward)],
            "centre": view.centre.tolist(),
            "half": view.half_height,
        },
        "parts": [
            numbers.part(part, scene.limits)
            for part in (*scene.bodies, *scene.wires, *scene.turned)
        ],
    }
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 4)
    content = len(text).to_bytes(4, "little") + text + bytes(numbers.content)
    return InteractiveScene(scene.title, gzip.compress(content, 9, mtime=0))


def viewer() -> str:
    """Script that draws scenes. Needed once per page."""
    return files("validation.drawing").joinpath("viewer.js").read_text(encoding="utf-8")


def page(scene: Scene, title: str) -> str:
    """HTML page with one scene that opens offline in any browser."""
    state = base64(turnable(scene).state)
    head = '<meta charset="utf-8"><link rel="icon" href="data:,">'
    style = "#scene, canvas { position: fixed; inset: 0; width: 100%; height: 100%; }"
    script = f"{viewer()}\nshowScene(document.getElementById('scene'), '{state}');"
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head>{head}'
        f"<title>{escape(title)}</title><style>{style} .veil {{ display: none; }}</style></head>"
        f'<body><div id="scene"></div><script>{script}</script></body></html>\n'
    )


class _Numbers:
    """Concatenated arrays, each identified by the position of its first byte and its size."""

    def __init__(self) -> None:
        self.content = bytearray()

    def part(self, part: DrawnBody | Wire, limits: tuple[float, float]) -> dict[str, Any]:
        """Header of one body or line for the viewer. Its numbers are appended to the content.

        Points are encoded as multiples of a step, which is finer than a pixel. `limits`: values at
        both ends of the colour map.
        """
        import matplotlib as mpl  # noqa: PLC0415  slow to import, and makes folders

        colour = [round(255.0 * share) for share in mpl.colors.to_rgb(part.colour)]
        points = part.points if isinstance(part, Wire) else part.surface.points
        common = {"colour": colour, "points": self.steps(points)}
        if part.motion is not None and np.abs(part.motion).max(initial=0.0) > 0.0:
            common["motion"] = self.steps(part.motion)
        if isinstance(part, Wire):
            return common | {"pairs": self.add(part.pairs, "<u4"), "width": part.width}
        if part.values is not None:
            shares = mpl.colors.Normalize(*limits)(part.values)
            common["colours"] = self.add(mpl.colormaps[COLOUR_MAP](shares, bytes=True)[:, :3], "u1")
        return common | {"faces": self.add(part.surface.faces, "<u4")}

    def steps(self, lengths: Array) -> dict[str, Any]:
        """Header of lengths (m). They are appended to the content as 16-bit multiples of a step."""
        step = float(np.abs(lengths).max(initial=1e-300)) / np.iinfo(np.int16).max
        return {"step": step, "values": self.add(np.round(lengths / step), "<i2")}

    def add(self, values: Any, kind: str) -> tuple[int, int]:
        """Append values as NumPy type `kind`. Returns the position (byte) and number of values."""
        array = np.ascontiguousarray(values, dtype=kind)
        first_byte = len(self.content)
        self.content += array.tobytes()
        self.content += bytes(-len(self.content) % 4)
        return first_byte, array.size
